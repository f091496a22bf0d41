"""The pictures of the page with their words: still ones as SVG, and those that can be zoomed."""

from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.discrepancy.checks.first_checks import FirstChecks
from symhyb.discrepancy.evidence import Whiteness
from symhyb.discrepancy.results import Cloud, Diagnosis, Trace, Verdict
from symhyb.discrepancy.words.occurrence_words import place_words
from symhyb.discrepancy.words.wording import capital, quantity_text
from symhyb.errors import InputError
from symhyb.model.types import Model, On, place_text
from symhyb.model.vocabulary import KINDS
from symhyb.report import figures
from symhyb.report.animation import Animation, animation
from symhyb.report.apart import apart_figure
from symhyb.report.bars import Pair, places_figure, score_figure
from symhyb.report.coefficient_figure import coefficient_figure, coefficient_of
from symhyb.report.contract import finite
from symhyb.report.courses import course_figure
from symhyb.report.doubts import correlations_figure, whiteness_figure
from symhyb.report.live import Live, Signal, live_figures
from symhyb.report.machine_figure import machine_figure
from symhyb.report.occurring import occurrence_figure
from symhyb.report.responding import LINES_LEAST, response_figure
from symhyb.report.rivals import rivals_figure
from symhyb.report.sketch import sketch_of
from symhyb.report.tables import SCORES, place_units
from symhyb.units import Unit

# each picture costs a second and a hundred kilobytes
_TRACES_SHOWN, _CLOUDS_SHOWN, _BARS_SHOWN, _PLACES_SHOWN = 12, 5, 24, 3

_REMEMBERING = frozenset(kind.name for kind in KINDS.values() if kind.states)
_OF_TIME = frozenset(kind.name for kind in KINDS.values() if not kind.of_state)


@dataclass(frozen=True, slots=True)
class Picture:
    """An inline image with its words; ``also`` where a figure that can be zoomed shows the same."""

    source: str
    alternative: str
    caption: str
    failures: tuple[str, ...] = ()
    also: bool = False


@dataclass(frozen=True, slots=True)
class Shown:
    """A recording: what it is, its figures that can be zoomed, and the same as still pictures."""

    title: str
    live: Live
    pictures: tuple[Picture, ...]


def _image(svg: bytes) -> str:
    return f"data:image/svg+xml;base64,{b64encode(svg).decode('ascii')}"


def drawn_traces(verdict: Verdict) -> list[tuple[Trace, str]]:
    """Signals worth a picture: those that hold values, unseen recordings (the proof) first."""
    signals = [
        (trace, sensor)
        for trace in verdict.traces
        for sensor, values in trace.measured.items()
        if np.isfinite(values).any()
    ]
    return sorted(signals, key=lambda signal: signal[0].role != "holdout")[:_TRACES_SHOWN]


def drawn_clouds(diagnosis: Diagnosis) -> list[Cloud]:
    """The ΔF worth a picture: those that hold values."""
    return [cloud for cloud in diagnosis.clouds if np.isfinite(cloud.force).any()][:_CLOUDS_SHOWN]


def shown_recordings(
    verdict: Verdict,
    units: Mapping[str, Unit],
    noise: Mapping[str, float] | None = None,
    clouds: Sequence[tuple[Cloud, Unit, str]] = (),
) -> list[Shown]:
    """Draw measured and simulated signals, recording by recording. ``units`` by sensor, ``noise``
    too, in that unit; ``clouds`` with the unit of force and the words of their place."""
    drawn = drawn_traces(verdict)
    traces = list({id(trace): trace for trace, _ in drawn}.values())
    groups = [[sensor for other, sensor in drawn if other is trace] for trace in traces]
    shown = []
    for number, (trace, sensors) in enumerate(zip(traces, groups, strict=True)):
        role = "unseen" if trace.role == "holdout" else "training"
        signals = [
            Signal(s, units.get(s, Unit("SI")), finite((noise or {}).get(s))) for s in sensors
        ]
        pictures = [_trace_picture(trace, s.sensor, s.unit, s.noise) for s in signals]
        over = [cloud for cloud in clouds if _beside(trace, cloud[0])]
        live = live_figures(trace, signals, over, f"figures{number}", 1.0 / len(traces))
        shown.append(Shown(f"{trace.recording} ({role} recording)", live, tuple(pictures)))
    return shown


def _beside(trace: Trace, cloud: Cloud) -> bool:
    """Whether ΔF was got from the recording of a trace."""
    return trace.role == "train" and trace.recording == cloud.recording


def _trace_picture(trace: Trace, sensor: str, unit: Unit, noise: float | None) -> Picture:
    role = "unseen" if trace.role == "holdout" else "training"
    return Picture(
        _image(figures.trace_figure(trace, sensor, unit, noise)),
        f"{sensor} in recording {trace.recording}: measured, and simulated in a free run "
        "before and after the correction, with the residuals below.",
        f"{trace.recording} ({role} recording). Residual: simulated minus measured. Grey band: two "
        "standard deviations of the noise and of what the numbers of the correction are uncertain "
        "by.",
        trace.failures,
    )


def cloud_pictures(diagnosis: Diagnosis, verdict: Verdict, model: Model | None) -> list[Picture]:
    """ΔF over the motion and over time, with what was found, and what a curve is a factor of."""
    coefficients = [
        Picture(
            _image(coefficient_figure(effect)),
            f"The {coefficient_of(effect)} that was found {place_text(effect.element.place)}, over "
            "the stretch.",
            f"The {coefficient_of(effect)} {place_text(effect.element.place)}, which changes with "
            "the stretch: points of what was found, and a band of two of their standard "
            "deviations.",
        )
        for effect in diagnosis.found
        if coefficient_of(effect)
    ]
    return coefficients + [
        picture
        for cloud in drawn_clouds(diagnosis)
        for picture in _cloud_pictures(
            cloud,
            place_units(model, cloud.place),
            _kinds_at(cloud, diagnosis),
            _marks_at(cloud, diagnosis),
            any(_beside(trace, cloud) for trace, _ in drawn_traces(verdict)),
        )
    ]


def clouds_over_time(diagnosis: Diagnosis, model: Model | None) -> list[tuple[Cloud, Unit, str]]:
    """The drawn ΔF with the unit of force and the words of its place."""
    return [
        (cloud, place_units(model, cloud.place).force, place_text(cloud.place))
        for cloud in drawn_clouds(diagnosis)
    ]


def _kinds_at(cloud: Cloud, diagnosis: Diagnosis) -> frozenset[str]:
    """The kinds of the found laws that act on the place of a cloud."""
    elements = [effect.element for effect in diagnosis.found]
    return frozenset(
        element.kind
        for element in elements
        if element.place == cloud.place or not isinstance(element.place, On)
    )


def _marks_at(cloud: Cloud, diagnosis: Diagnosis) -> list[figures.Marks]:
    """The points of the found curves on the coordinate of a cloud, where they resist."""
    found = []
    for effect in diagnosis.found:
        element = effect.element
        alone = element.curve is not None and not coefficient_of(effect)
        if element.curve is not None and alone and element.place == cloud.place:
            along, up = (unit.factor for unit in element.curve.units)
            x, force = np.array(element.curve.points).T
            sd = np.array(dict(element.found)["sd"])
            over = element.option("over", "stretch")
            found.append(figures.Marks(over, along * x, -up * force, up * sd))
    return found


def _cloud_pictures(
    cloud: Cloud,
    units: figures.PlaceUnits,
    kinds: frozenset[str],
    marks: Sequence[figures.Marks],
    also: bool,
) -> Iterable[Picture]:
    where = place_text(cloud.place)
    timed = bool(kinds) and kinds <= _OF_TIME
    if not timed:
        yield Picture(
            _image(figures.cloud_figure(cloud, units, bool(kinds & _REMEMBERING), marks)),
            f"The force that the model leaves over {where}, against rate and against stretch, "
            "with the found law drawn through the points.",
            f"ΔF {where}, over rate and stretch ({cloud.recording}). Dots: samples; bars: their "
            "mean in narrow bins, with two of its standard deviations. "
            + ("Line: the found law, with two deviations of its numbers. " if kinds else "")
            + "Where a force jumps, the smoothing of the motion rounds ΔF.",
        )
    yield Picture(
        _image(figures.force_figure(cloud, units.force)),
        f"The force that the model leaves over {where} over time, with its band and the found law.",
        f"{f'ΔF {where},' if timed else 'The same'} over time ({cloud.recording})",
        also=also,
    )


def score_picture(verdict: Verdict) -> Picture | None:
    """Draw the scores before and after the correction, on unseen recordings if there are any."""
    scores = verdict.holdout or verdict.train
    pairs = [
        Pair(f"{words}, {name}", old.get(name), new.get(name))
        for key, _, words in SCORES
        if key != "force_nrmse"  # the residual says the same against a scale that people know
        for old, new in [(getattr(scores.before, key), getattr(scores.after, key))]
        for name in dict.fromkeys((*old, *new))
    ]
    if not pairs:
        return None
    which = "unseen recordings" if verdict.holdout else "training recordings"
    return Picture(
        _image(score_figure(pairs[:_BARS_SHOWN])),
        f"Bars of the scores before and after the correction, on {which}.",
        f"Scores on {which}: before (upper bar, hatched) and after the correction (lower bar)",
    )


def first_picture(first: FirstChecks) -> Picture | None:
    """The frequency response that the simulations miss most, if any has enough lines."""
    drawn = [one for one in first.responses if one.frequency.size >= LINES_LEAST]
    if not drawn:
        return None
    worst = max(drawn, key=lambda one: max(one.apart.values(), default=0.0))
    return Picture(
        _image(response_figure(worst)),
        f"Gain, phase and coherence of {worst.sensor} from {worst.drives[0]}, measured and "
        "simulated.",
        f"Frequency response of {worst.sensor} to {worst.drives[0]} ({first.recording}), measured "
        "and in free runs by the same estimator; in the grey the coherence is too low to trust it.",
    )


def machine_picture(diagnosis: Diagnosis, model: Model | None) -> Picture | None:
    """Draw the machine with what was found in it; None of one that cannot be drawn."""
    extended, names = _with_found(diagnosis, model)
    if extended is None:
        return None
    try:
        sketch = sketch_of(extended, shown=names)
    except (InputError, KeyError):  # a part has no place (a charge), or is not of this model
        return None
    if not {*names} & {mark.name for mark in sketch.marks}:
        return None
    return Picture(
        _image(machine_figure(sketch)),
        f"Drawing of the machine with {', '.join(names)}.",
        "The machine where simulations start. Magenta: where the found elements act; blue: where "
        "each coordinate is positive.",
    )


def machine_motion(diagnosis: Diagnosis, verdict: Verdict, model: Model | None) -> Animation | None:
    """Let the machine with what was found in it move along a recording; None where its motion is
    not known."""
    extended, names = _with_found(diagnosis, model)
    return None if extended is None else animation(verdict, extended, names)


def _with_found(diagnosis: Diagnosis, model: Model | None) -> tuple[Model | None, list[str]]:
    """The model with the elements that were found, and their names; None without any."""
    found = [effect.element for effect in diagnosis.found]
    if model is None or not found:
        return None, []
    extended = replace(model, elements=(*model.elements, *found))
    return extended, [element.name for element in found]


def place_picture(diagnosis: Diagnosis) -> Picture | None:
    """Draw how much of the mismatch each place explains."""
    if not diagnosis.places:
        return None
    found = {effect.element.place for effect in diagnosis.found}
    shown = diagnosis.places[:_BARS_SHOWN]
    rows = [(place_text(row.place), row.explained, row.place in found) for row in shown]
    return Picture(
        _image(places_figure(rows)),
        "Bars of the share of the mismatch that each place explains.",
        "How much of the mismatch any smooth function of a place's own motion explains, on data "
        "that it was not fitted to. Blue: something was found there.",
    )


def occurrence_pictures(diagnosis: Diagnosis, model: Model | None) -> list[Picture]:
    """When and at which frequencies the mismatch acts at the places that explain most of it."""
    drawn: list[Picture] = []
    for row in diagnosis.places:
        occurrence = row.occurrence
        if occurrence is None or occurrence.t.size < 2 or len(drawn) == _PLACES_SHOWN:
            continue
        where = place_text(row.place) if model is None else place_words(model, row.place)
        said = occurrence.sentence or f"{capital(where)}, the mismatch acts throughout."
        drawn.append(
            Picture(
                _image(occurrence_figure(occurrence)),
                f"What is left of the windows over time {where}, and the power of the missing "
                "force over frequency.",
                said,
            )
        )
    return drawn


def course_pictures(diagnosis: Diagnosis) -> list[Picture]:
    """Draw every number that changes with time."""
    return [
        Picture(
            _image(course_figure(one)),
            f"{one.path} over {one.over or 'the time'}, with a band, beside what the model says.",
            f"{one.sentence} Grey band: two standard deviations.",
        )
        for one in diagnosis.courses
    ]


def apart_picture(diagnosis: Diagnosis) -> Picture | None:
    """Draw which causes the recordings distinguish."""
    if diagnosis.isolability is None:
        return None
    return Picture(
        _image(apart_figure(diagnosis.isolability)),
        "Matrix of the odds with which these recordings tell each cause from each other one.",
        "How well these recordings distinguish causes, at the size found: if the cause of a row "
        "acts, the odds against that of a column. Red: below 10, they cannot tell; yellow: below "
        "100; blue: they can.",
    )


def rivals_picture(diagnosis: Diagnosis, units: Mapping[str, Unit]) -> Picture | None:
    """Draw where the most probable rivals would differ from what was chosen; ``units`` by
    sensor."""
    if not diagnosis.rivals:
        return None
    first = diagnosis.rivals[0]
    return Picture(
        _image(rivals_figure(diagnosis.rivals, units)),
        "What each rival simulates less what the chosen structure does, over time, beside the "
        "noise.",
        f"What each rival would show beyond what was chosen, along {first.recording}, in windows "
        f"of {quantity_text(first.window_s, 's', digits=3)} that each begin where that structure "
        "fits best. Grey band: two standard deviations of the noise of one sample; diamond: where "
        "the two differ most.",
    )


def whiteness_picture(verdict: Verdict) -> Picture | None:
    """Draw the correlations of what is left of the first recording that has windows."""
    first = first_whiteness(verdict)
    if not first:
        return None
    return Picture(
        _image(whiteness_figure(first)),
        "Correlation of the residuals with themselves and with the inputs over the lag.",
        f"Correlations of the residuals of the corrected model, windows of {first[0].recording}; "
        "99 % of the values of white, independent residuals lie in the grey band, others are "
        "marked by diamonds. Where the residual comes before the input (a negative lag), a value "
        "beyond tells of feedback.",
    )


def first_whiteness(verdict: Verdict) -> list[Whiteness]:
    """Those of the first recording."""
    return [one for one in verdict.whiteness if one.recording == verdict.whiteness[0].recording]


def correlations_picture(diagnosis: Diagnosis) -> Picture | None:
    """Draw the correlations of the fitted numbers."""
    if diagnosis.correlations is None:
        return None
    return Picture(
        _image(correlations_figure(diagnosis.correlations)),
        "Matrix of the correlations of the fitted numbers.",
        "Correlations of the fitted numbers: near +1 or −1 two of them trade off.",
    )

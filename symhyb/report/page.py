"""The report as one self-contained HTML page: sentences first, then pictures, then tables."""

from base64 import b64encode
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import resources

import numpy as np
from jinja2 import Environment, FunctionLoader, StrictUndefined, Template

from symhyb.discrepancy.checks.first_checks import FirstChecks
from symhyb.discrepancy.results import Cloud, Diagnosis, Trace, Verdict
from symhyb.discrepancy.words.occurrence_words import place_words
from symhyb.discrepancy.words.wording import (
    grouped_alternatives,
    measurement_phrase,
    parameter_phrase,
)
from symhyb.model.types import Model, On, place_text
from symhyb.model.vocabulary import KINDS
from symhyb.report import figures
from symhyb.report.apart import apart_figure, apart_sentence
from symhyb.report.bars import Pair, places_figure, score_figure
from symhyb.report.occurring import occurrence_figure
from symhyb.report.responding import LINES_LEAST, response_figure
from symhyb.report.sentences import (
    alternative_sentence,
    method_sentences,
    remainder_sentence,
    score_sentences,
    typeset,
)
from symhyb.report.tables import SCORES, place_table, place_units, tables
from symhyb.units import Unit

# each picture costs a second and a hundred kilobytes
_TRACES_SHOWN, _CLOUDS_SHOWN, _BARS_SHOWN, _PLACES_SHOWN = 12, 6, 24, 3

_REMEMBERING = frozenset(kind.name for kind in KINDS.values() if kind.state)
_OF_TIME = frozenset(kind.name for kind in KINDS.values() if not kind.of_state)


@dataclass(frozen=True, slots=True)
class Picture:
    """An inline image with its words."""

    source: str
    alternative: str
    caption: str
    failures: tuple[str, ...] = ()


def render_page(
    title: str,
    diagnosis: Diagnosis,
    verdict: Verdict,
    difference: str = "",
    provenance: Mapping[str, str] | None = None,
    model: Model | None = None,
    first: FirstChecks | None = None,
) -> str:
    """Write the report as HTML that needs no other file and no network.

    ``difference`` is the text of the model diff, ``provenance`` says what the result was made from
    (files, SHA-256, versions). ``model`` gives the units in which sensors and places are shown;
    without it they are shown in SI. ``first`` are the first checks of a training recording.
    """
    units = {} if model is None else {sensor.name: sensor.unit for sensor in model.sensors}
    return template("page.html.j2").render(
        title=title,
        diagnosis=diagnosis,
        verdict=verdict,
        besides=[f"{phrase}." for phrase in _besides(diagnosis)],
        alternatives=[
            alternative_sentence(*group) for group in grouped_alternatives(diagnosis.alternatives)
        ],
        scores=score_sentences(verdict, {name: unit.text for name, unit in units.items()}),
        remainder=remainder_sentence(diagnosis.remainder),
        methods=method_sentences(verdict),
        traces=trace_pictures(verdict, units),
        clouds=[
            picture
            for cloud in _drawn_clouds(diagnosis)
            for picture in _cloud_pictures(
                cloud, place_units(model, cloud.place), _kinds_at(cloud, diagnosis)
            )
        ],
        first=first,
        first_picture=first and _first_picture(first),
        score_picture=score_picture(verdict),
        place_picture=_place_picture(diagnosis),
        apart_picture=_apart_picture(diagnosis),
        apart_sentence=diagnosis.isolability and apart_sentence(diagnosis.isolability),
        omitted=_omitted(diagnosis, verdict),
        corrected=any(
            scores.before != scores.after for scores in (verdict.train, verdict.holdout) if scores
        ),
        tables=[table for table in tables(diagnosis, verdict, units) if table.rows],
        places=place_table(diagnosis, model),
        occurrences=_occurrences(diagnosis, model),
        difference=difference.strip("\n").splitlines(),
        provenance=dict(provenance or {}),
    )


def template(name: str) -> Template:
    """A page of this package, whose text is escaped and typeset."""
    folder = resources.files("symhyb.report")
    loader = FunctionLoader(lambda file: folder.joinpath(file).read_text("utf-8"))
    pages = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, loader=loader)
    pages.filters["typeset"] = typeset
    return pages.get_template(name)


def _besides(diagnosis: Diagnosis) -> Iterable[str]:
    yield from map(parameter_phrase, diagnosis.parameters)
    yield from map(measurement_phrase, diagnosis.measurement)


def _image(svg: bytes) -> str:
    return f"data:image/svg+xml;base64,{b64encode(svg).decode('ascii')}"


def _drawn_traces(verdict: Verdict) -> list[tuple[Trace, str]]:
    """Signals worth a picture: those that hold values, unseen recordings (the proof) first."""
    signals = [
        (trace, sensor)
        for trace in verdict.traces
        for sensor, values in trace.measured.items()
        if np.isfinite(values).any()
    ]
    return sorted(signals, key=lambda signal: signal[0].role != "holdout")[:_TRACES_SHOWN]


def _drawn_clouds(diagnosis: Diagnosis) -> list[Cloud]:
    return [cloud for cloud in diagnosis.clouds if np.isfinite(cloud.force).any()][:_CLOUDS_SHOWN]


def trace_pictures(verdict: Verdict, units: Mapping[str, Unit]) -> list[Picture]:
    """Draw measured and simulated signals; ``units`` by sensor."""
    return [
        _trace_picture(trace, sensor, units.get(sensor, Unit("SI")))
        for trace, sensor in _drawn_traces(verdict)
    ]


def _trace_picture(trace: Trace, sensor: str, unit: Unit) -> Picture:
    role = "unseen" if trace.role == "holdout" else "training"
    return Picture(
        _image(figures.trace_figure(trace, sensor, unit)),
        f"{sensor} in recording {trace.recording}: measured, and simulated in a free run "
        "before and after the correction, with the residuals below.",
        f"{trace.recording} ({role} recording). Residual: simulated minus measured.",
        trace.failures,
    )


def _kinds_at(cloud: Cloud, diagnosis: Diagnosis) -> frozenset[str]:
    """The kinds of the found laws that act on the place of a cloud."""
    elements = [effect.element for effect in diagnosis.found]
    return frozenset(
        element.kind
        for element in elements
        if element.place == cloud.place or not isinstance(element.place, On)
    )


def _cloud_pictures(
    cloud: Cloud, units: figures.PlaceUnits, kinds: frozenset[str]
) -> Iterable[Picture]:
    where = place_text(cloud.place)
    timed = bool(kinds) and kinds <= _OF_TIME
    if not timed:
        yield Picture(
            _image(figures.cloud_figure(cloud, units, bool(kinds & _REMEMBERING))),
            f"The force that the model leaves over {where}, against rate and against stretch, "
            "with the found law drawn through the points.",
            f"ΔF {where}, over rate and stretch ({cloud.recording})",
        )
    yield Picture(
        _image(figures.force_figure(cloud, units.force)),
        f"The force that the model leaves over {where} over time, with its band and the found law.",
        f"{f'ΔF {where},' if timed else 'The same'} over time ({cloud.recording})",
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
        f"Scores on {which}: before (upper bar, orange) and after the correction (lower bar, blue)",
    )


def _first_picture(first: FirstChecks) -> Picture | None:
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


def _place_picture(diagnosis: Diagnosis) -> Picture | None:
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


def _occurrences(diagnosis: Diagnosis, model: Model | None) -> list[Picture]:
    """When and at which frequencies the mismatch acts at the places that explain most of it."""
    drawn: list[Picture] = []
    for row in diagnosis.places:
        occurrence = row.occurrence
        if occurrence is None or occurrence.t.size < 2 or len(drawn) == _PLACES_SHOWN:
            continue
        where = place_text(row.place) if model is None else place_words(model, row.place)
        said = (
            occurrence.sentence or f"{where[:1].upper()}{where[1:]}, the mismatch acts throughout."
        )
        drawn.append(
            Picture(
                _image(occurrence_figure(occurrence)),
                f"What is left of the windows over time {where}, and the power of the missing "
                "force over frequency.",
                said,
            )
        )
    return drawn


def _apart_picture(diagnosis: Diagnosis) -> Picture | None:
    if diagnosis.isolability is None:
        return None
    return Picture(
        _image(apart_figure(diagnosis.isolability)),
        "Matrix of the odds with which these recordings tell each cause from each other one.",
        "How well these recordings distinguish causes, at the size found: if the cause of a row "
        "acts, the odds against that of a column. Red: below 10, they cannot tell; yellow: below "
        "100; blue: they can.",
    )


def _omitted(diagnosis: Diagnosis, verdict: Verdict) -> list[str]:
    """Sentences on what has no picture: it is too much, or it holds no values."""
    traces = sum(len(trace.measured) for trace in verdict.traces) - len(_drawn_traces(verdict))
    clouds = len(diagnosis.clouds) - len(_drawn_clouds(diagnosis))
    return [
        sentence
        for count, sentence in (
            (traces, f"Not drawn here, but in simulation.csv: {traces} more measured signals."),
            (clouds, f"Not drawn here: the force at {clouds} more places and recordings."),
        )
        if count
    ]

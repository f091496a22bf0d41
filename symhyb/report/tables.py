"""The tables of the report: rows of text, ready to be set."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from symhyb.discrepancy.results import Activity, Diagnosis, Estimate, Found, Score, Verdict
from symhyb.discrepancy.words.effects import amount_text
from symhyb.discrepancy.words.occurrence_words import place_words
from symhyb.discrepancy.words.wording import number_text, percent_text, quantity_text, unit_text
from symhyb.model.types import Model, Place, place_text
from symhyb.model.vocabulary import force_unit, stretch_unit
from symhyb.report.contract import finite
from symhyb.report.figures import PlaceUnits
from symhyb.report.sentences import DIGITS, error_text
from symhyb.units import Unit, parse_unit

SCORES = (  # key of a score, key of the same in the sensor's unit, words
    ("force_residual", None, "force residual"),
    ("force_nrmse", None, "force error"),
    ("window_nrmse", "window_rmse", "window error"),
    ("free_run_nrmse", "free_run_rmse", "free-run error"),
)


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text under a heading; ``numbers`` are the columns that hold numbers."""

    caption: str
    heading: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: tuple[int, ...]


def place_units(model: Model | None, place: Place) -> PlaceUnits:
    """Give the units of stretch, rate and force at a place; SI throughout without a model."""
    if model is None:
        return PlaceUnits(*(Unit("SI"),) * 3)
    stretch = stretch_unit(model, place)
    return PlaceUnits(stretch, stretch / parse_unit("s"), force_unit(model, place))


def tables(diagnosis: Diagnosis, verdict: Verdict, units: Mapping[str, Unit]) -> Iterable[Table]:
    """Give the tables of what was found, of the scores and of the noise; some may have no rows.

    ``units`` by sensor: errors and noise are given in them.
    """
    yield _found_table(diagnosis)
    yield Table(
        "Re-estimated parameters",
        ("parameter", "was", "is"),
        tuple(
            (
                parameter.name,
                quantity_text(parameter.was, parameter.unit, digits=8),
                quantity_text(parameter.value, parameter.unit, parameter.sd),
            )
            for parameter in diagnosis.parameters
        ),
        (1,),
    )
    yield Table(
        "Faults of the measurement",
        ("channel", "fault", "value"),
        tuple(
            (fault.channel, fault.kind, quantity_text(fault.value, fault.unit, fault.sd))
            for fault in diagnosis.measurement
        ),
        (2,),
    )
    yield fleet_table(diagnosis)
    yield score_table(verdict, units)
    yield Table(
        "Measured noise (one standard deviation)",
        ("sensor", "noise"),
        tuple(
            (
                sensor,
                quantity_text(sd, units[sensor].text if sensor in units else "1", digits=DIGITS),
            )
            for sensor, sd in diagnosis.noise.items()
        ),
        (1,),
    )


def _found_table(diagnosis: Diagnosis) -> Table:
    return Table(
        "Found effects",
        ("element", "term", "value", "share", "place", "stays chosen", "probability"),
        tuple(
            (
                effect.element.name,
                estimate.term,
                amount_text(estimate),
                percent_text(effect.share),
                place_text(effect.element.place),
                "" if effect.stability is None else percent_text(effect.stability),
                "" if effect.probability is None else percent_text(effect.probability),
            )
            for effect in diagnosis.found
            for estimate in effect.estimates
        ),
        (2, 3, 5, 6),
    )


def score_table(verdict: Verdict, units: Mapping[str, Unit]) -> Table:
    """Give all scores, on training and unseen recordings; ``units`` by sensor."""
    roles = [("training", verdict.train)]
    roles += [] if verdict.holdout is None else [("unseen", verdict.holdout)]
    moments = [score for _, role in roles for score in (role.before, role.after)]
    rows = [
        (words, channel, *(_score_text(score, key, in_unit, channel, units) for score in moments))
        for key, in_unit, words in SCORES
        for channel in dict.fromkeys(name for score in moments for name in getattr(score, key))
    ]
    columns = [f"{role}, {moment}" for role, _ in roles for moment in ("before", "after")]
    return Table(
        "Scores before and after", ("score", "channel", *columns), tuple(rows), (2, 3, 4, 5)
    )


def _score_text(
    score: Score, key: str, in_unit: str | None, channel: str, units: Mapping[str, Unit]
) -> str:
    share = percent_text(getattr(score, key).get(channel))
    error = None if in_unit is None else getattr(score, in_unit).get(channel)
    if finite(error) is None or channel not in units:
        return share
    return f"{share} ({error_text(error, units[channel].text)})"


def fleet_table(diagnosis: Diagnosis) -> Table:
    """Give the values that are each recording's own, or that a group of recordings shares."""
    rows = [
        (name, effect.element.name, amount_text(number))
        for effect in diagnosis.found
        for name, numbers in (*effect.own, *_of_groups(effect))
        for number in numbers
    ]
    for parameter in diagnosis.parameters:
        own = [*parameter.own, *((f"{by} {one}", v, sd) for by, one, v, sd in parameter.groups)]
        rows += [
            (name, parameter.name, quantity_text(value, parameter.unit, sd))
            for name, value, sd in own
        ]
    heading = ("recording or group", "of", "value")
    return Table("What not all recordings share", heading, tuple(rows), (2,))


def _of_groups(effect: Found) -> list[tuple[str, tuple[Estimate, ...]]]:
    """The values that groups of recordings share, by grouping and group."""
    return [(f"{by} {label}", numbers) for by, label, numbers in effect.groups]


def place_table(diagnosis: Diagnosis, model: Model | None) -> Table:
    """Give the map of the mismatch: what each place explains, and where and when it acts."""
    rows = tuple(
        (
            place_text(row.place) if model is None else place_words(model, row.place),
            percent_text(row.explained),
            *_active_text(row.active, place_units(model, row.place)),
        )
        for row in diagnosis.places
    )
    return Table(
        "Where the mismatch acts", ("place", "explains", "stretch", "rate", "time"), rows, (1,)
    )


def _active_text(active: Activity | None, units: PlaceUnits) -> Sequence[str]:
    if active is None:
        return ("", "", "")
    spans = [
        _range_text(*bounds, unit)
        for bounds, unit in ((active.stretch, units.stretch), (active.rate, units.rate))
    ]
    times = ", ".join(_range_text(start, end, Unit("s")) for start, end in active.time[:3])
    return (*spans, times + (" …" if len(active.time) > 3 else ""))


def _range_text(low: float, high: float, unit: Unit) -> str:
    bounds = (number_text(bound / unit.factor, digits=DIGITS) for bound in (low, high))
    spaced = f"{' to '.join(bounds)} {unit_text(unit.text)}".rstrip()
    return spaced.replace(" ", "\u00a0")  # a narrow column breaks between ranges, not within one

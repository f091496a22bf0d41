"""What a correction is worth, in the quantities that a person weighs."""

from collections.abc import Iterator, Mapping

from symhyb.discrepancy.results import Diagnosis, Found, Score, Verdict
from symhyb.discrepancy.words.wording import capital, joined, percent_text, quantity_text
from symhyb.model.types import place_text
from symhyb.report.contract import finite
from symhyb.report.sentences import DIGITS
from symhyb.report.series import shown_unit

_TIMES = 1.2  # an error that grows by less says nothing


def headline(verdict: Verdict, units: Mapping[str, str]) -> str:
    """What the correction does to the errors, the largest change first: of the sensor and the score
    that change most, and of the other score of that sensor; empty where nothing was corrected or
    no error could be computed. ``units`` by sensor."""
    scores = verdict.holdout or verdict.train
    if scores.before == scores.after:
        return ""
    ways = (
        ("free_run", "in a free run from start to end"),
        ("window", "over short windows"),
    )
    changes = [
        (after / before, way, words, sensor)
        for way, words in ways
        for sensor, after, before in _pairs(scores.before, scores.after, way)
    ]
    if not changes:
        return ""
    _, first, words, sensor = min(changes)
    said = [f"{_went(scores.before, scores.after, first, sensor, units)} {words}"]
    said += [
        f"{_went(scores.before, scores.after, way, sensor, units)} {other}"
        for _, way, other, name in changes
        if name == sensor and way != first
    ]
    where = "On unseen recordings" if verdict.holdout else "On the training recordings"
    return f"{where} the error of {sensor} {joined(said)}."


def _pairs(before: Score, after: Score, way: str) -> Iterator[tuple[str, float, float]]:
    """Sensor and error after and before, where both are numbers above 0."""
    for sensor, new in getattr(after, f"{way}_nrmse").items():
        old, new = finite(getattr(before, f"{way}_nrmse").get(sensor)), finite(new)
        if old and new:
            yield sensor, new, old


def _went(before: Score, after: Score, way: str, sensor: str, units: Mapping[str, str]) -> str:
    old, new = (finite(getattr(one, f"{way}_rmse").get(sensor)) for one in (before, after))
    if sensor in units and old is not None and new is not None:
        first, last = pair_text(old, new, units[sensor])
    else:
        old, new = (getattr(one, f"{way}_nrmse")[sensor] for one in (before, after))
        first, last = (percent_text(value) for value in (old, new))
    if first == last:
        return f"stays {first}"
    verb = "falls" if new < old else "rises"
    return f"{verb} from {first} to {last}"


def pair_text(first: float, last: float, unit: str) -> tuple[str, str]:
    """Two errors in one unit, that of the larger, so that they can be weighed at a glance."""
    factor, shown = shown_unit(max(abs(first), abs(last)), unit)
    if factor != 1.0 and shown.startswith("10"):
        factor, shown = 1.0, unit
    texts = [quantity_text(value / factor, shown, digits=DIGITS) for value in (first, last)]
    return texts[0], texts[1]


def certainty(diagnosis: Diagnosis) -> str:
    """The probability of what is named: of the least probable of the found effects."""
    known = [chance for effect in diagnosis.found if (chance := finite(effect.probability))]
    if not known:
        return ""
    least = min(known)
    amount = "more than 99.9 %" if least > 0.999 else percent_text(least)
    each = "each of the found effects is" if len(diagnosis.found) > 1 else "the found effect is"
    return (
        f"Probability that {each} at work, among all causes that were tried: "
        f"{'at least ' if len(known) > 1 and least <= 0.999 else ''}{amount}."
    )


def worth_sentence(effect: Found, verdict: Verdict, units: Mapping[str, str]) -> str:
    """What a found effect amounts to: its part of the dissipated energy, its peak beside the
    largest force, and what free runs err without it; empty where none of it is known."""
    said: list[str] = []
    worth = effect.worth
    energy = None if worth is None else finite(worth.energy)
    force = None if worth is None else finite(worth.force)
    if energy is not None:
        said.append(f"it takes {percent_text(energy)} of the energy that all elements dissipate")
    if force is not None:
        largest = "is the largest" if force >= 0.995 else f"is {percent_text(force)} of the largest"
        said.append(f"its peak {largest} force that acts {place_text(effect.element.place)}")
    said.extend(_without(effect.element.name, verdict, units))
    text = joined(said)
    return f"{capital(text)}." if text else ""


def _without(name: str, verdict: Verdict, units: Mapping[str, str]) -> Iterator[str]:
    """What free runs err without an element, of the sensor that misses it most."""
    scores = verdict.holdout or verdict.train
    with_it = scores.after.free_run_rmse
    for one in verdict.without:
        if one.element != name:
            continue
        ratios = [
            (new / old, sensor)
            for sensor, value in one.free_run_rmse.items()
            if (new := finite(value)) and (old := finite(with_it.get(sensor)))
        ]
        if ratios and max(ratios)[0] > _TIMES:
            _, sensor = max(ratios)
            errors = (float(one.free_run_rmse[sensor] or 0), float(with_it[sensor] or 0))
            texts = pair_text(*errors, units.get(sensor, "SI"))
            yield f"without it a free run misses {sensor} by {texts[0]} instead of {texts[1]}"

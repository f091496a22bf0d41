"""A fleet in sentences."""

import math
from collections.abc import Iterator

from symhyb.discrepancy.words.amounts import (
    joined,
    number_text,
    percent_text,
    power_text,
    quantity_text,
)
from symhyb.fleet.fleet import Common, Fleet, Own, Reason, Slope, Trend
from symhyb.fleet.rungs import Weighed
from symhyb.judgement import OUTSTANDING

LISTED = 10  # names in a sentence
SELDOM, RARE = 1e-2, 1e-9  # a smaller probability: only its size; one of tails nobody has seen


def reason_sentence(reason: Reason) -> str:
    """Why a unit is named, with how much and how probable."""
    chance = f"by chance {_chance_text(reason.probability)}"
    if reason.kind == "structure":
        return (
            f"its fit leaves {number_text(reason.times, digits=2)} times the noise that the fits of"
            " the others leave: something acts there that the others do not have, and its numbers"
            f" stand in for it ({chance}); symhyb diagnose looks for the cause"
        )
    changes = joined([_trend_text(one) for one in reason.trends])
    if reason.kind == "trend":
        return f"{changes} than the others do ({chance})"
    parts = []
    for one in reason.off:
        size = quantity_text(abs(one.by), one.unit, one.sd)
        part = "" if one.part is None else f", {percent_text(abs(one.part))},"
        parts.append(f"{one.name} is {size}{part} {'above' if one.by > 0 else 'below'}")
    text = f"{joined(parts)} what the others have under the same conditions ({chance})"
    if reason.rivals:
        others = joined([" with ".join(names) for names in reason.rivals], "or")
        text += f"; {others} in place of that explains it nearly as well"
    return f"{text}; {changes} than the others do" if changes else text


def _chance_text(probability: float) -> str:
    """A probability, a small one by the power of ten that it is below."""
    if probability > SELDOM:
        return number_text(probability, digits=1)
    decade = math.ceil(math.log10(max(probability, RARE)))
    return f"less than {power_text(decade)}"


def _trend_text(one: Trend) -> str:
    """By how much more a number of one unit changes."""
    if one.factors:
        size = f"{number_text(100 * abs(one.by), 100 * one.sd)} %"
    else:
        size = quantity_text(abs(one.by), one.unit, one.sd)
    return f"{one.name} changes with {one.condition} by {size} {'more' if one.by > 0 else 'less'}"


def slope_sentences(fleet: Fleet) -> Iterator[str]:
    """Say which numbers change with which condition, beyond three deviations."""
    for number in fleet.numbers:
        for slope in number.slopes:
            if abs(slope.value) > OUTSTANDING * slope.sd:
                yield slope_sentence(fleet, number, slope)


def slope_sentence(fleet: Fleet, number: Common, slope: Slope) -> str:
    """By how much a number changes over all that a condition varies by, and for one unit of it."""
    at = fleet.conditions.index(slope.condition)
    every = [float(one.conditions[at]) for one in fleet.units]
    low, high = min(every), max(every)
    whole, error = slope.value * (high - low), slope.sd * (high - low)
    if number.factors:
        size = f"by {number_text(100 * whole, 100 * error)} % (in logarithms)"
        each = number_text(slope.value, slope.sd)
    else:
        size = f"by {quantity_text(whole, number.unit, error)}"
        size += f" ({percent_text(abs(whole / number.mean))} of its mean)" if number.mean else ""
        each = quantity_text(slope.value, number.unit, slope.sd)
    ends = f"{number_text(low)} to {number_text(high)}"
    return f"{number.name} changes with {slope.condition}: {size} from {ends}, {each} for each"


def fleet_notes(fleet: Fleet) -> Iterator[str]:
    """What is to be said beside the numbers: what was not judged, and recordings of little use."""
    if not fleet.tested:
        yield (
            f"{len(fleet.units)} units are too few to say which of them deviate in"
            f" {len(fleet.numbers)} numbers"
        )
    if fleet.disputed:
        yield (
            f"who deviates is not said of {_names(list(fleet.disputed))}: no more than half of"
            f" {'these peers' if fleet.among else 'these'} are alike"
        )
    idle = [one.name for one in fleet.units if one.adds_nothing and one.reason is None]
    if idle:
        which = "the recordings add" if len(idle) > 1 else "the recording adds"
        yield (
            f"{which} nothing: of {_names(idle)} each number is known less than a tenth as well"
            " (by its information) as of half of the others"
        )
    ends = [one for one in fleet.units if one.bounds]
    if ends:
        yield (
            f"numbers of {_names([one.name for one in ends])} end at the bound of what is possible"
        )
    left = [(fleet.failed, "failed"), (fleet.not_run, "not run")]
    said = [f"{count} tasks are {state}" for count, state in left if count]
    if said:
        yield f"{joined(said)} and do not count; symhyb next lists them"


def common_text(number: Common) -> str:
    """The mean of a number with its deviation."""
    return quantity_text(number.mean, number.unit, number.sd)


def spread_text(number: Common) -> str:
    """The spread between units, and as a part of the mean."""
    if number.factors:
        part = number_text(100 * number.spread, 100 * number.spread_sd)
        return f"{part} %"
    size = quantity_text(number.spread, number.unit, number.spread_sd)
    return f"{size} ({percent_text(abs(number.spread / number.mean))})" if number.mean else size


def structure_texts(one: Weighed) -> tuple[str, str, str]:
    """The ln of the evidence of a structure less that of the likeliest, its probability, and in how
    many recordings it is the likeliest."""
    cannot = one.evidence == -math.inf
    behind = "cannot be simulated" if cannot else number_text(one.evidence, digits=3)
    chance = number_text(one.probability, digits=3) if one.probability > SELDOM else "< 0.01"
    return behind, chance, f"{one.likeliest} of {one.recordings}"


def unit_text(one: Own) -> str:
    """A unit with its reason."""
    return f"{one.name}: {reason_sentence(one.reason)}" if one.reason is not None else one.name


def _names(names: list[str]) -> str:
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return joined(names[:LISTED]) + more if not more else ", ".join(names[:LISTED]) + more

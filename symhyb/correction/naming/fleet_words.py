"""Several recordings in words and values: outliers, repeats, and what is each recording's own."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.by_name import ByName
from symhyb.correction.naming.findings import Named, symbol_of
from symhyb.correction.search.fleet import Outlier
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.trajectory import Refined
from symhyb.data.recording import Recording
from symhyb.discrepancy.checks.repeats import reported_repeats
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.results import Estimate, Found, Misfit, Reestimated, Repeats
from symhyb.discrepancy.words.amounts import capital, joined, number_text, quantity_text, small_text
from symhyb.judgement import OUTSTANDING
from symhyb.model.types import Model, place_text
from symhyb.model.vocabulary import key_of
from symhyb.units import ONE, Unit


def misfit(final: Refined, outlier: Outlier, recordings: Sequence[Recording]) -> Misfit:
    """Name a recording that does not fit the others, and say in what."""
    name = recordings[outlier.recording].name
    if outlier.cause < 0:
        (mine, _), (rest, _) = outlier.value, outlier.others
        said = (
            f"{name} does not fit the others: what is left of it is "
            f"{number_text(np.sqrt(mine), digits=2)}"
            f" times its noise, of the others {number_text(np.sqrt(rest), digits=2)} times"
        )
        numbers = (*outlier.value, *outlier.others)
        return Misfit(name, "remainder", *numbers, "1", outlier.chance, said + ".")
    cause = final.causes[outlier.cause]
    unit, quantity = (
        unit_of_key(final.machine.model, cause, outlier.key),
        subject_of(cause, outlier.key),
    )
    (value, sd), (rest, rest_sd) = (
        (pair[0] / unit.factor, pair[1] / unit.factor) for pair in (outlier.value, outlier.others)
    )
    first, second = small_text(value, unit.text, sd), small_text(rest, unit.text, rest_sd)
    if len(recordings) == 2:
        other = recordings[1 - outlier.recording].name
        said = f"{name} and {other} do not fit each other: {quantity} is {first} against {second}"
    else:
        said = f"{name} does not fit the others: its {quantity} is {first} against {second}"
    return Misfit(name, quantity, value, sd, rest, rest_sd, unit.text, outlier.chance, said + ".")


def drift_sentence(
    final: Refined,
    odd: Outlier,
    so: str = "the deviation that is given weighs both by how well each half tells it",
) -> str:
    """Say that a number is not the same in both halves of the recordings, and what follows."""
    cause = final.causes[odd.cause]
    unit = unit_of_key(final.machine.model, cause, odd.key)
    first, second = (
        small_text(value / unit.factor, unit.text, sd / unit.factor)
        for value, sd in (odd.others, odd.value)
    )
    where = f" in {odd.owner}" if odd.owner else ""
    return (
        f"{opening_of(cause, odd.key)}{where} is not constant: {first} in the first half of the "
        f"time, {second} in the second; {so}."
    )


def unit_of_key(model: Model, cause: Hypothesis, key: str) -> Unit:
    """The unit of a number of a cause, as the model file writes it."""
    if cause.place is not None:
        return cause.unit(model, key)
    declared = {item.path: item for item in model.all_parameters()}
    return declared[cause.path].unit if cause.path in declared else ONE


def subject_of(cause: Hypothesis, key: str) -> str:
    """A number of a cause as the subject of a sentence: ``Coulomb friction on x``."""
    if cause.place is None:
        channel = cause.path.rpartition(".")[0]
        return cause.path if cause.kind == "parameter" else f"{cause.kind} of {channel}"
    if cause.points and key in cause.terms:
        at = number_text(cause.points[cause.terms.index(key)][0], digits=3)
        over = dict(cause.options)["over"]
        return f"the value of the curve at a {over} of {at} in SI units {place_text(cause.place)}"
    return f"{noun_of(cause.kind, key)} {place_text(cause.place)}"


def opening_of(cause: Hypothesis, key: str) -> str:
    """The subject at the beginning of a sentence; a name of the model's stays as it is written."""
    words = subject_of(cause, key)
    if cause.kind == "parameter":
        return f"Parameter {words}"
    return capital(words)


def noun_of(kind: str, key: str) -> str:
    """What a key of a law is, as the subject of a sentence: ``Coulomb friction``."""
    declared = key_of(kind, key)
    return (declared.noun if declared else "") or key.replace("_", " ")


def repeats_said(prepared: Prepared) -> tuple[Repeats, ...]:
    """The repeated runs, with what they differ by in the units of the sensors."""
    return reported_repeats(prepared.model, prepared.runs, prepared.repeats)


def with_own(model: Model, final: Refined, item: Named, found: Found) -> Found:
    """A found effect with the values that are each recording's own, said behind its sentence."""
    keys = [
        (i, key)
        for i in item.causes
        for key in final.causes[i].own
        if not final.causes[i].grouping(key)
    ]
    if not final.owned or not keys:
        return found
    rows = [
        (recording.name, estimates_in(model, final, keys, which))
        for which, (recording, _) in enumerate(final.each)
    ]
    said = _each_said(item.kind, keys, rows, "Each recording")
    return replace(found, own=tuple(rows), sentence=f"{found.sentence}{said}")


def estimates_in(
    model: Model, final: Refined, keys: Sequence[tuple[int, str]], which: int
) -> tuple[Estimate, ...]:
    """The values of keys, each with the index of its cause, in one recording."""
    numbers = []
    for i, key in keys:
        unit = unit_of_key(model, final.causes[i], key)
        value, sd = final.value_of(f"cause{i}.{key}", which)
        symbol = symbol_of(model, final.causes[i].kind, key)
        numbers.append(Estimate(symbol, value / unit.factor, sd / unit.factor, unit.text, key))
    return tuple(numbers)


def _each_said(
    kind: str,
    keys: Sequence[tuple[int, str]],
    rows: Sequence[tuple[str, Sequence[Estimate]]],
    owner: str,
) -> str:
    """The values of each ``owner``, by its name, as sentences behind one."""
    named = [key for _, key in keys if key != "phase"]  # a phase says nothing of the machine
    said = "; ".join(
        f"{name} {joined([_amount(number) for number in numbers if number.term in named])}"
        for name, numbers in rows
        if _stands(numbers)
    )
    silent = joined([name for name, numbers in rows if not _stands(numbers)])
    words = joined([noun_of(kind, key) for key in named])
    sentence = ""
    if named and said:
        sentence += f" {owner} has its own {words}: {said}."
    if named and silent:
        sentence += f" Of {silent} it does not stand out of its own deviation and may be none."
    return sentence


def with_groups(model: Model, final: Refined, item: Named, found: Found) -> Found:
    """A found effect with the values that recordings share within groups, said behind its sentence.
    Its element has their mean."""
    keys = [
        (i, key, by)
        for i in item.causes
        for key in final.causes[i].own
        if (by := final.causes[i].grouping(key))
    ]
    if not final.owned or not keys:
        return found
    rows: list[tuple[str, str, tuple[Estimate, ...]]] = []
    means: dict[str, tuple[float, float, str]] = {}
    sentence = found.sentence
    for by in dict.fromkeys(by for *_, by in keys):
        mine = [(i, key) for i, key, one in keys if one == by]
        each = {
            label: estimates_in(model, final, mine, which)
            for label, which in first_of_groups(final, by).items()
        }
        rows += [(by, label, numbers) for label, numbers in each.items()]
        for number in zip(*each.values(), strict=True):
            about = f"mean of {len(number)} groups ({by}), with the sd of one more"
            means[number[0].term] = (*of_a_group([one.value for one in number]), about)
        sentence += _each_said(item.kind, mine, list(each.items()), f"Each {by}")
    estimates = [
        replace(one, value=means[one.term][0], sd=means[one.term][1]) if one.term in means else one
        for one in found.estimates
    ]
    by_symbol = {one.name: one for one in estimates if one.term in means}
    parameters = tuple(
        replace(p, value=one.value, sd=one.sd, about=means[one.term][2])
        if (one := by_symbol.get(p.name))
        else p
        for p in found.element.parameters
    )
    said = joined([f"{noun_of(item.kind, one.term)} {_amount(one)}" for one in by_symbol.values()])
    sentence += f" For a group that was not recorded: {said}, their mean and spread."
    element = replace(found.element, parameters=parameters)
    return replace(
        found,
        element=element,
        estimates=ByName(estimates),
        groups=tuple(rows),
        sentence=sentence,
    )


def first_of_groups(final: Refined, by: str) -> dict[str, int]:
    """The first recording, by its place, of each group of a grouping."""
    found: dict[str, int] = {}
    for which, (recording, _) in enumerate(final.each):
        found.setdefault(recording.groups[by], which)
    return found


def of_a_group(values: Sequence[float]) -> tuple[float, float]:
    """What is foretold of a group that is not known, from the values of G others: their mean, and
    the deviation s·sqrt(1 + 1/G) of one more, s that of the others among themselves."""
    spread = float(np.std(values, ddof=1)) if len(values) > 1 else float("inf")
    return float(np.mean(values)), spread * float(np.sqrt(1 + 1 / len(values)))


def _stands(numbers: Sequence[Estimate]) -> bool:
    """Whether a recording's first own value, the strength of a law, stands out."""
    return abs(numbers[0].value) > OUTSTANDING * numbers[0].sd or numbers[0].term == "phase"


def parameters_with_own(
    final: Refined, parameters: Sequence[Reestimated]
) -> tuple[Reestimated, ...]:
    """Re-estimated parameters with the values that are each recording's own, or each group's."""
    owned = {cause.path: cause for cause in final.causes if cause.place is None and cause.own}
    if not final.owned:
        return tuple(parameters)
    units = {item.path: item.unit for item in final.machine.model.all_parameters()}
    rows = []
    for parameter in parameters:
        if parameter.name not in owned:
            rows.append(parameter)
            continue
        by, factor = owned[parameter.name].grouping("value"), units[parameter.name].factor
        whose = {one.name: which for which, (one, _) in enumerate(final.each)}
        own = []
        for name, which in (first_of_groups(final, by) if by else whose).items():
            value, sd = final.value_of(parameter.name, which)
            own.append((name, value / factor, sd / factor))
        if by:
            value, sd = of_a_group([value for _, value, _ in own])
            groups = tuple((by, *row) for row in own)
            rows.append(replace(parameter, value=value, sd=sd, groups=groups))
        else:
            rows.append(replace(parameter, own=tuple(own)))
    return tuple(rows)


def _amount(number: Estimate) -> str:
    return quantity_text(number.value, number.unit, number.sd)

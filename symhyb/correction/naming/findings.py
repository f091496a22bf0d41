"""From a decided structure to what is reported: elements, parameters, channel faults, rivals."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.by_name import ByName
from symhyb.correction.naming.curve_points import (
    BEYOND,
    Through,
    curve_element,
    curve_values,
    value_estimates,
)
from symhyb.correction.naming.delays import late_channels
from symhyb.correction.naming.probability import probabilities
from symhyb.correction.naming.textbook import critical_share
from symhyb.correction.search.conventions import Exchange, exchange
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.score import believable
from symhyb.correction.search.trajectory import Refined, late_sensors
from symhyb.discrepancy.places.hypotheses import CurvePoint, Hypothesis
from symhyb.discrepancy.results import (
    Activity,
    Alternative,
    Estimate,
    Found,
    Measurement,
    Reestimated,
)
from symhyb.discrepancy.words.amounts import joined
from symhyb.discrepancy.words.effects import words_of
from symhyb.discrepancy.words.formula import LAW, SYMBOLS, WARNING, law_element, law_unit
from symhyb.discrepancy.words.formula import law_text as law_text_of
from symhyb.discrepancy.words.wording import alternative_phrase, effect_sentence, percent_text
from symhyb.judgement import PROBABLE, SIGNIFICANT
from symhyb.laws.sided import SKEW
from symhyb.model.actuators import CHANNEL_KINDS, SENSOR_LAG
from symhyb.model.expression import parse_expression
from symhyb.model.types import At, Between, Element, Model, On, Pair, Parameter, Place
from symhyb.model.vocabulary import KINDS, expressed, key_of, key_unit, worded


@dataclass(frozen=True, slots=True)
class Named:
    """Force causes of one kind at one place, one element to the reader: indices in the structure,
    SI values with sd by key (sd NaN for a key that was not fitted), and the words of its options;
    of a curve its ``points`` and those of what it is multiplied by, ``by_stretch``, SI.
    """

    kind: str
    place: Place
    causes: tuple[int, ...]
    values: Mapping[str, tuple[float, float]]
    options: tuple[tuple[str, str], ...] = ()
    formula: str = ""
    points: tuple[CurvePoint, ...] = ()
    by_stretch: tuple[CurvePoint, ...] = ()

    @property
    def exponent(self) -> float:
        """The n of a hysteresis, on which the units of beta and gamma depend."""
        return self.values.get("exponent", (1.0, 0.0))[0]


def named(final: Refined) -> tuple[Named, ...]:
    """The force causes of a structure as elements: springs of several orders at one place join,
    anything else stays by itself (two lines of one spectrum, a stop on either side)."""
    groups: dict[tuple[str, Place, int], list[int]] = {}
    for i, cause in enumerate(final.causes):
        if cause.place is not None:
            alone = -1 if KINDS[cause.kind].joins else i
            groups.setdefault((cause.kind, cause.place, alone), []).append(i)
    return tuple(
        Named(
            kind,
            place,
            tuple(rows),
            _values(final, rows),
            final.causes[rows[0]].options,
            final.causes[rows[0]].path,
            final.causes[rows[0]].points,
            final.causes[rows[0]].by_stretch,
        )
        for (kind, place, _), rows in groups.items()
    )


def _values(final: Refined, rows: Sequence[int]) -> dict[str, tuple[float, float]]:
    values: dict[str, tuple[float, float]] = {}
    for i in rows:
        cause = final.causes[i]
        for key, shape in cause.shape:
            values.setdefault(key, (shape, float("nan")))
        for key in cause.keys:
            values[key] = final.value(f"cause{i}.{key}")
    first = final.causes[rows[0]]
    if first.points:  # what its points cannot follow bends their values
        return values | curve_values(first, values)
    if first.kind == LAW:
        return values
    law = KINDS[first.kind]
    return law.widened({key.name: values[key.name] for key in law.keys if key.name in values})


def found_of(
    model: Model,
    item: Named,
    name: str,
    provenance: tuple[tuple[str, object], ...],
    share: float | None,
    active: Activity | None,
) -> Found:
    """Write one named effect as an element of the model file, with law, values and sentence."""
    if item.kind == LAW:
        return _empirical(model, item, name, provenance, share, active)
    if item.points:
        return _curve(model, item, name, provenance, share, active)
    own, entries, estimates = [], [], []
    for key, (value, sd) in item.values.items():
        unit = key_unit(model, item.kind, key, item.place, item.exponent)
        fitted = bool(np.isfinite(sd))
        deviation = sd / unit.factor if fitted else None
        symbol = symbol_of(model, item.kind, key)
        own.append(Parameter(symbol, value / unit.factor, unit, deviation, owner=name))
        entries.append((key, parse_expression(symbol)))
        if deviation is not None:
            estimates.append(Estimate(symbol, value / unit.factor, deviation, unit.text, key))
    entries += expressed(item.kind, item.options)
    words = worded(item.kind, item.options)
    element = Element(
        name, item.kind, item.place, tuple(entries), tuple(own), provenance, options=words
    )
    meaning = _meaning(model, item)
    sentence = effect_sentence(item.kind, item.place, estimates, share, words_of(element), meaning)
    law = KINDS[item.kind].text(item.values, dict(item.options))
    return Found(element, law, ByName(estimates), share, sentence, active)


def _empirical(
    model: Model,
    item: Named,
    name: str,
    provenance: tuple[tuple[str, object], ...],
    share: float | None,
    active: Activity | None,
) -> Found:
    """Write a product as a ``law``, with the warning that it is no law known by name."""
    assert isinstance(item.place, On)
    values = {key: value for key, (value, _) in item.values.items()}
    spreads = {key: sd for key, (_, sd) in item.values.items() if np.isfinite(sd)}
    symbols = {key: symbol_of(model, LAW, key) for key in values}
    element = replace(
        law_element(model, name, item.place, item.formula, values, symbols, spreads),
        found=provenance,
    )
    unit = law_unit(model, item.place, item.formula, "coefficient")
    value, sd = item.values["coefficient"]
    own = Estimate(
        symbols["coefficient"], value / unit.factor, sd / unit.factor, unit.text, "coefficient"
    )
    words = (("formula", item.formula),)
    sentence = effect_sentence(LAW, item.place, [own], share, words, WARNING)
    return Found(element, law_text_of(item.formula), ByName((own,)), share, sentence, active)


def _curve(
    model: Model,
    item: Named,
    name: str,
    provenance: tuple[tuple[str, object], ...],
    share: float | None,
    active: Activity | None,
) -> Found:
    """Write a curve with its values at its points."""
    curve = Through(item.place, item.options, item.points, item.by_stretch)
    values = value_estimates(model, curve, item.values)
    length = None
    if "length" in item.values:
        unit = key_unit(model, item.kind, "length", item.place)
        symbol = symbol_of(model, item.kind, "length")
        length = Parameter(symbol, item.values["length"][0] / unit.factor, unit, owner=name)
    element = curve_element(model, name, curve, values, length, provenance)
    sentence = effect_sentence(item.kind, item.place, values, share, item.options, BEYOND)
    keys = (*(["length"] if length else []), *(["by_stretch"] if item.by_stretch else []))
    law = KINDS[item.kind].text(keys, dict(item.options))
    return Found(element, law, ByName(values), share, sentence, active)


def _meaning(model: Model, item: Named) -> str:
    """The share of critical damping of a damper, where the model is a linear oscillator."""
    key = KINDS[item.kind].critical
    if not key or "asymmetry" in item.values:
        return ""
    share = critical_share(model, item.place, item.values[key][0])
    return "" if share is None else f"{percent_text(share)} of the critical damping of the model"


def symbol_of(model: Model, kind: str, key: str) -> str:
    """The name of a key's number: its usual letter, unless a coordinate or an input has it."""
    taken = {item.name for item in model.coordinates} | {item.name for item in model.inputs}
    declared = key_of(kind, key)
    symbol = (declared.symbol if declared else SYMBOLS.get(key, "")) or key
    while symbol in taken:
        symbol = key if symbol != key and key not in taken else symbol + "_"
    return symbol


def element_names(model: Model, items: Sequence[Named]) -> tuple[str, ...]:
    """Names for the elements: ``found_drag``, with the place where a kind is found twice."""
    taken = {element.name for element in model.elements}
    names: list[str] = []
    kinds = [item.kind for item in items]
    for item in items:
        base = f"found_{item.kind}"
        if kinds.count(item.kind) > 1:
            base += "_" + _place_word(item.place)
        name, count = base, 2
        while name in taken:
            name, count = f"{base}_{count}", count + 1
        taken.add(name)
        names.append(name)
    return tuple(names)


def _place_word(place: Place) -> str:
    match place:
        case On(coordinate):
            return "_".join(re.findall(r"\w+", coordinate))
        case Between(first, second):
            return f"{first}_{second}"
        case At(point):
            return point
        case Pair() as pair:
            return "_".join(_place_word(on) for on in pair.each)


def reestimated(
    model: Model, final: Refined, doubt: Collection[Hypothesis] = ()
) -> tuple[Reestimated, ...]:
    """The parameters of the model among the causes but those in doubt, in the units of the file."""
    declared = {item.path: item for item in model.all_parameters()}
    rows = []
    for cause in final.causes:
        if cause.kind == "parameter" and cause not in doubt:
            item = declared[cause.path]
            value, sd = (number / item.unit.factor for number in final.value(cause.path))
            rows.append(Reestimated(cause.path, item.value, value, sd, item.unit.text))
    return tuple(rows)


def channel_faults(final: Refined, doubt: Collection[Hypothesis] = ()) -> tuple[Measurement, ...]:
    """Gains, offsets, delays, numbers of actuators and lags of sensors among the causes, in the
    units of their channels, but those in doubt."""
    declared = {item.path: item for item in final.machine.model.all_parameters()}
    rows = []
    for cause in final.causes:
        if cause.kind in CHANNEL_KINDS and cause.kind != "delay" and cause not in doubt:
            item = declared[cause.path]
            value, sd = (number / item.unit.factor for number in final.value(cause.path))
            kind = CHANNEL_KINDS[cause.kind]
            for name in late_sensors(cause) or (item.owner,):
                rows.append(Measurement(name, kind, value, sd, item.unit.text))
    return (*rows, *late_channels(final, doubt))


def cause_phrase(cause: Hypothesis) -> str:
    """Name a cause without its numbers: ``viscous damping on x``."""
    plain = Alternative(None, cause.kind, (), 0.0)
    if cause.place is not None:
        said = alternative_phrase(replace(plain, place=cause.place, options=cause.options))
        law = KINDS[cause.kind]
        if law.joins and cause.terms != law.strengths[:1]:
            said = said.replace(law.words, f"a {cause.terms[0]} {law.words.removeprefix('a ')}")
        return said
    if cause.kind == "parameter":
        return alternative_phrase(replace(plain, parameter=cause.path))
    if cause.kind == "delay" and cause.options:
        return f"one delay of {cause.path.removesuffix('.delay')}"
    if cause.kind == SENSOR_LAG:
        return alternative_phrase(replace(plain, channel=joined(late_sensors(cause))))
    return alternative_phrase(replace(plain, channel=cause.path.split(".")[0]))


def doubtful(decision: Decision) -> tuple[Hypothesis, ...]:
    """Causes of the selected structure that are not probable enough."""
    chances = zip(decision.selected.causes, probabilities(decision), strict=True)
    return tuple(cause for cause, chance in chances if chance < PROBABLE)


def alternatives_of(
    model: Model,
    decision: Decision,
    names: Mapping[Hypothesis, str],
    doubt: Collection[Hypothesis] = (),
) -> tuple[Alternative, ...]:
    """What the data cannot rule out: causes in doubt, what is indistinguishable from what was
    found, and rivals within reach.

    ``names`` are the elements (or paths) under which certain causes of the selected structure are
    reported.
    """
    selected, unsure = decision.selected, {*doubtful(decision), *doubt}
    open_ = [cause for cause in selected.causes if cause in unsure]
    group = 1 if len(open_) > 1 else 0
    rows = [replace(alternative_of(model, selected, cause, 0.0), together=group) for cause in open_]
    for first, second in decision.equals:
        if first in selected.causes:
            rows.append(_alternative(model, second, {}, names.get(first), 0.0))
    for change, evidence, trial in rivals_of(decision):
        # what is in doubt and stays holds beside what is exchanged, and is claimed nowhere else
        stays = [cause for cause in trial.causes if cause in open_ and cause not in change.fresh]
        members, number = (*stays, *change.fresh), 0
        if len(members) > 1:
            group += 1
            number = group
        for cause in members:
            values = _fitted_values(trial, cause)
            row = _alternative(model, cause, values, names.get(change.lost[0]), max(evidence, 0.0))
            rows.append(replace(row, together=number))
    rows += _sided(model, selected, names)
    return tuple(sorted(rows, key=lambda row: row.evidence))


def alternative_of(model: Model, trial: Refined, cause: Hypothesis, evidence: float) -> Alternative:
    """One cause of a fitted structure, with its values there, as an alternative by itself."""
    return _alternative(model, cause, _fitted_values(trial, cause), None, evidence)


def _sided(
    model: Model, selected: Refined, names: Mapping[Hypothesis, str]
) -> Iterator[Alternative]:
    """Dry friction that differs by direction, in place of dry friction and a constant force on one
    coordinate: whether the place slides or holds, the two are the same."""
    at = {(cause.kind, cause.place): i for i, cause in enumerate(selected.causes)}
    for i, cause in enumerate(selected.causes):
        j = at.get(("constant", cause.place))
        if cause.kind != "friction" or cause.terms != ("coulomb",) or j is None:
            continue
        values = _values(selected, [i])
        level, spread = values["coulomb"]
        push, push_sd = selected.value(f"cause{j}.constant")
        share = -push / level
        if isinstance(cause.place, On) and abs(share) < SKEW:
            sd = float(np.hypot(push_sd, share * spread)) / level
            lopsided = {"coulomb": (level, spread), "asymmetry": (share, sd)}
            yield _alternative(model, cause, lopsided, names.get(selected.causes[j]), 0.0)


def rivals_of(decision: Decision) -> list[tuple[Exchange, float, Refined]]:
    """Trials within reach of the selected structure that replace some of its causes by laws of
    another family: what they exchange, the difference of the score, the trial; of those that
    exchange the same laws, begun at other values, the best."""
    rivals: dict[tuple[frozenset[object], ...], tuple[Exchange, float, Refined]] = {}
    for trial in decision.trials:
        change = exchange(trial.causes, decision.selected.causes)
        evidence = decision.against(trial)
        key = tuple(frozenset(one.family for one in side) for side in (change.fresh, change.lost))
        if key[0] == key[1] or not (change.fresh and change.lost):
            continue
        within = min(SIGNIFICANT, rivals[key][1] if key in rivals else np.inf)
        if evidence < within and believable(trial):
            rivals[key] = change, evidence, trial
    return list(rivals.values())


def _fitted_values(trial: Refined, cause: Hypothesis) -> dict[str, tuple[float, float]]:
    return {} if cause.place is None else _values(trial, [trial.causes.index(cause)])


def _alternative(
    model: Model,
    cause: Hypothesis,
    values: Mapping[str, tuple[float, float]],
    instead_of: str | None,
    evidence: float,
) -> Alternative:
    estimates: list[Estimate] = []
    exponent = values.get("exponent", (1.0, 0.0))[0]
    if cause.place is not None and cause.points and values:
        curve = Through(cause.place, cause.options, cause.points, cause.by_stretch)
        estimates += value_estimates(model, curve, values)
    elif cause.place is not None:
        for key, (value, sd) in values.items():
            unit = cause.unit(model, key, exponent)
            if np.isfinite(sd):
                scaled = value / unit.factor, sd / unit.factor
                estimates.append(
                    Estimate(symbol_of(model, cause.kind, key), *scaled, unit.text, key)
                )
    base = Alternative(instead_of, cause.kind, tuple(estimates), evidence)
    if cause.place is not None:
        words = (("formula", cause.path),) if cause.kind == LAW else cause.options
        return replace(base, place=cause.place, options=words)
    if cause.kind == "parameter":
        return replace(base, parameter=cause.path)
    return replace(base, channel=cause.path.split(".")[0])

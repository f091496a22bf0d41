"""A structure (a set of causes) fitted on trajectories, at full nonlinearity.

The model with its candidate elements is an ordinary model; its terms, the shapes that are worth a
number and the parametric causes are fitted by :mod:`symhyb.discrepancy.fitting.matching`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Protocol

import numpy as np

from symhyb.correction.search.owners import layout
from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.matching import TRIAL_DECREASE, TRIAL_ITERATIONS, fit
from symhyb.discrepancy.fitting.task import Fit, Task
from symhyb.discrepancy.places.hypotheses import ASSUMED, Hypothesis
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.judgement import GAIN_REACH
from symhyb.laws import LAWS
from symhyb.model.actuators import ACTUATOR_KEYS, SENSOR_LAG, usual_unit
from symhyb.model.delays import delayed_by
from symhyb.model.late import with_lag
from symhyb.model.types import Element, Input, Model, Parameter
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.known import with_known
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.windows import WindowModel

DELAY_REACH = 30  # samples, either way
ACTUATOR_REACH = 30  # times the number of an actuator that was tried, either way


@dataclass(frozen=True, slots=True)
class Refined:
    """A fitted structure: its causes, the lowered model, the parameter columns of each number
    (``paths``), the full parameter vector ``p`` (P,) in SI with the fitted values,
    and the fit. Where numbers are each recording's own, ``p`` has those of the first, ``each`` the
    vectors of all by recording, and the fit all numbers, those of ``paths`` first."""

    causes: tuple[Hypothesis, ...]
    machine: Machine
    paths: tuple[str, ...]
    p: Array
    fit: Fit
    accuracy: float = 0.0
    each: tuple[tuple[Recording, Array], ...] = ()
    owned: tuple[tuple[int, ...], ...] = ()

    @property
    def numbers(self) -> int:
        """How many numbers were fitted."""
        return int(self.fit.values.size)

    @property
    def name(self) -> str:
        """The causes, in a line of the log."""
        return " + ".join(map(str, self.causes)) or "the model as it is"

    @property
    def own_columns(self) -> dict[int, str]:
        """Columns in p of the numbers that not all recordings share, each with the grouping of
        those that do."""
        keys = [(cause, key) for cause in self.causes for key in keys_of(cause)]
        return {
            self.machine.column(path): cause.grouping(key)
            for path, (cause, key) in zip(self.paths, keys, strict=True)
            if key in cause.own
        }

    def of(self, recording: Recording) -> Array:
        """The parameter vector (P,) of a recording, SI, with what it knows; of one that was not
        fitted what its groups have, the mean over all groups for one that is not known."""
        p = next((p for known, p in self.each if known is recording), None)
        p = foreseen(self, recording) if p is None else p
        return with_known(self.machine, p, recording.parameters)

    def value_of(self, path: str, which: int) -> tuple[float, float]:
        """Fitted value and one standard deviation of a parameter in one recording, SI."""
        i = self.owned[which][self.paths.index(path)] if self.owned else self.paths.index(path)
        return self._with_accuracy(path, i)

    def value(self, path: str) -> tuple[float, float]:
        """Fitted value and one standard deviation of a parameter, SI; the relative ``accuracy``
        of the numerics is part of the deviation of a force, not of a time or a place."""
        return self._with_accuracy(path, self.paths.index(path))

    def _with_accuracy(self, path: str, i: int) -> tuple[float, float]:
        value, spread = float(self.fit.values[i]), float(np.sqrt(self.fit.covariance[i, i]))
        if path.rpartition(".")[2] in EXACT:
            return value, spread
        return value, float(np.hypot(spread, self.accuracy * abs(value)))


# what no gain can feign
EXACT = frozenset({"delay", "lag", *(key.name for law in LAWS for key in law.keys if key.exact)})


def element_name(index: int) -> str:
    """Name of the element of the i-th cause while it is on trial."""
    return f"cause{index}"


def refine(
    model: Model,
    causes: Sequence[Hypothesis],
    start: Sequence[Mapping[str, float]],
    cuts: Sequence[Cut],
    sd: Array,
    starts: Sequence[Array] | None = None,
    everything: bool = False,
    careful: bool = False,
) -> Refined:
    """Fit the causes on windows; ``start`` has the first guess of each cause by key, SI (of a
    parameter its change under "value").

    ``model`` states its channels' gains and offsets (:func:`with_channels`); ``starts`` are initial
    states (W, X) of each recording to begin with; ``everything`` fits the held windows too;
    ``careful`` iterates until the values stand.
    """
    machine = build(with_causes(model, causes, start), keep=False)
    paths = tuple(path for i, cause in enumerate(causes) for path in paths_of(i, cause))
    free = tuple(machine.column(path) for path in paths)
    p = machine.values.copy()
    for i, cause in enumerate(causes):
        if cause.place is None:
            p[machine.column(cause.path)] += start[i]["value"]
    cuts = [item.suited(machine) for item in cuts]
    owned = shared_out(causes, [item.source[0] for item in cuts])
    step = float(np.median(np.diff(cuts[0].block.t, axis=1)))
    begin = _beginning(machine, causes, start, cuts, p[list(free)])
    bounds = [gathered(row, owned) for row in limits_of(machine, causes, step)]
    lower, upper, mean, spread = bounds
    task = Task(tuple(cuts), sd, lower, upper, mean, spread, everything, own=owned, first=begin)
    if not careful:
        task = replace(task, decrease=TRIAL_DECREASE, iterations=TRIAL_ITERATIONS, rough=True)
    begun = None if starts is None else [_begun(*pair) for pair in zip(cuts, starts, strict=True)]
    fitted = fit(WindowModel(machine, free), task, p, begun)
    each = tuple(
        (item.source[0], task.filled(i, p, free, fitted.values)) for i, item in enumerate(cuts)
    )
    p[list(free)] = fitted.values[: len(free)]
    found = Refined(tuple(causes), machine, paths, p, fitted)
    return replace(found, each=each, owned=owned) if owned else found


def with_causes(
    model: Model, causes: Sequence[Hypothesis], values: Sequence[Mapping[str, float]]
) -> Model:
    """The model with the elements of the causes that are laws, of these ``values`` by key, SI, and
    with the numbers of actuators that it does not state, as nothing, and with the sensors that lag,
    by what was tried first."""
    elements: list[Element] = []
    for i, cause in enumerate(causes):
        if cause.place is not None:
            shared = {key: value for key, value in values[i].items() if "@" not in key}
            elements.append(cause.element(model, element_name(i), shared))
    inputs = tuple(_with_actuator(item, causes) for item in model.inputs)
    found = replace(model, elements=(*model.elements, *elements), inputs=inputs)
    for cause in causes:
        if cause.kind == SENSOR_LAG:
            found = with_lag(found, late_sensors(cause), dict(cause.shape)["value"])
    return found


def late_sensors(cause: Hypothesis) -> tuple[str, ...]:
    """The sensors that lag by the one time constant of a cause."""
    return tuple(name for key, name in cause.options if key == "sensor")


def delayed(trial: "_Numbered") -> tuple[str, ...]:
    """The channels whose delays a structure has, each by itself or with others."""
    paths = [cause.path for cause in trial.causes if cause.kind == "delay"]
    model = trial.machine.model
    return tuple(dict.fromkeys(name for path in paths for name in delayed_by(model, path)))


def _with_actuator(item: Input, causes: Sequence[Hypothesis]) -> Input:
    """An input with the numbers of its actuator that are causes."""
    known = {number.name: number for number in item.actuator}
    for cause in causes:
        if cause.kind in ACTUATOR_KEYS and cause.path == f"{item.name}.{cause.kind}":
            unit = usual_unit(cause.kind, item.unit)
            none = Parameter(cause.kind, 0.0, unit, about=ASSUMED, owner=item.name)
            known.setdefault(cause.kind, none)
    return replace(item, actuator=tuple(known[key] for key in ACTUATOR_KEYS if key in known))


def shared_out(
    causes: Sequence[Hypothesis], recordings: Sequence[Recording]
) -> tuple[tuple[int, ...], ...]:
    """For each recording, which of all fitted numbers its free parameters are: those of the first
    come first, then those that each other one is the first to have. Empty where all are shared."""
    keys = [(cause, key) for cause in causes for key in keys_of(cause)]
    own = {i: cause.grouping(key) for i, (cause, key) in enumerate(keys) if key in cause.own}
    if len(recordings) < 2 or not own:
        return ()
    found = layout(own, len(keys), recordings)
    return found.rows if found.apart else ()


def gathered(row: Array, owned: Sequence[Sequence[int]]) -> Array:
    """What holds for each free parameter (P,), SI, for each of all numbers."""
    if not owned:
        return row
    full = np.empty(1 + max(map(max, owned)))
    for columns in owned:
        full[list(columns)] = row
    return full


def keys_of(cause: Hypothesis) -> tuple[str, ...]:
    """The keys of a cause's numbers; of a parameter ``value``."""
    return ("value",) if cause.place is None else cause.keys


def firsts_of(causes: Sequence[Hypothesis]) -> tuple[int, ...]:
    """Where the numbers of each cause begin among those of all."""
    return tuple(accumulate((cause.numbers for cause in causes[:-1]), initial=0))[: len(causes)]


def own_key(key: str, recording: Recording) -> str:
    """Under which a start has a recording's own value of a key."""
    return f"{key}@{recording.name}"


def _beginning(
    machine: Machine,
    causes: Sequence[Hypothesis],
    start: Sequence[Mapping[str, float]],
    cuts: Sequence[Cut],
    first: Array,
) -> Array | None:
    """Where all numbers begin, SI; None if all are shared."""
    owned = shared_out(causes, [item.source[0] for item in cuts])
    if not owned:
        return None
    full = gathered(first, owned)
    for item, columns in zip(cuts, owned, strict=True):
        i = 0
        for cause, row in zip(causes, start, strict=True):
            base = machine.values[machine.column(cause.path)] if cause.place is None else 0.0
            for key in keys_of(cause):
                mine = own_key(key, item.source[0])
                if key in cause.own and mine in row:
                    full[columns[i]] = base + row[mine]
                i += 1
    return full


def _begun(item: Cut, start: Array) -> Array:
    """Initial states of another structure for windows of this one, which may have other inner
    states."""
    full = item.start.copy()
    shared = min(full.shape[1], start.shape[1])
    full[:, :shared] = start[:, :shared]
    return full


def own_values(trial: Refined, item: Cut, sd: Array) -> Array:
    """The parameters (P,), SI, of a recording that was not fitted: its own numbers are fitted to
    its windows as initial states are, all others stay, also those of its groups. A phase is tried
    all around."""
    own = tuple(column for column, by in trial.own_columns.items() if not by)
    given = with_known(trial.machine, foreseen(trial, item.source[0]), item.block.known)
    if not own:
        return given
    step = float(np.median(np.diff(item.block.t, axis=1)))
    limits = dict(
        zip(
            trial.paths,
            zip(*limits_of(trial.machine, trial.causes, step), strict=True),
            strict=True,
        )
    )
    chosen = [path for path in trial.paths if trial.machine.column(path) in own]
    lower, upper, mean, spread = np.array([limits[path] for path in chosen]).T
    task = Task((item,), sd, lower, upper, mean, spread, everything=True)
    turns = np.array([path.endswith(".phase") for path in chosen])
    best: tuple[float, Array] | None = None
    for turn in np.arange(0, 2 * np.pi, np.pi / 3) if turns.any() else [0.0]:
        p = given.copy()
        p[list(own)] += np.where(turns, turn, 0.0)
        found = fit(WindowModel(trial.machine, own), task, p)
        p[list(own)] = found.values
        if best is None or found.chi2.sum() < best[0]:
            best = float(found.chi2.sum()), p
    assert best is not None
    return best[1]


def foreseen(trial: Refined, recording: Recording) -> Array:
    """The parameters (P,), SI, of a recording that was not fitted: what the others of its group
    have of what is shared within groups, the mean over the groups if none of them is its own;
    else those of the first recording."""
    p = trial.p.copy()
    for column, by in trial.own_columns.items():
        if by and trial.each:
            known = by_group(trial, column, by)
            mean = float(np.mean(list(known.values())))
            p[column] = known.get(recording.groups.get(by, ""), mean)
    return p


def by_group(trial: Refined, column: int, by: str) -> dict[str, float]:
    """The value of a parameter of the machine, SI, in each group of a grouping."""
    return {recording.groups[by]: float(p[column]) for recording, p in trial.each}


class _Values(Protocol):
    """The numbers of a fit (F,), SI."""

    @property
    def values(self) -> Array: ...


class _Numbered(Protocol):
    """A fitted structure, along windows or along whole recordings, whose causes come first."""

    @property
    def causes(self) -> tuple[Hypothesis, ...]: ...
    @property
    def machine(self) -> Machine: ...
    @property
    def fit(self) -> _Values: ...
    @property
    def each(self) -> tuple[tuple[Recording, Array], ...]: ...
    @property
    def owned(self) -> tuple[tuple[int, ...], ...]: ...


def grouped(trial: _Numbered) -> list[dict[str, float]]:
    """Fitted values by key, SI, cause by cause; of a parameter its change. A recording's own value
    of a key follows under :func:`own_key`."""
    rows, i = [], 0
    for cause in trial.causes:
        column = None if cause.place is not None else trial.machine.column(cause.path)
        base = 0.0 if column is None else float(trial.machine.values[column])
        row = {}
        for j, key in enumerate(keys_of(cause)):
            row[key] = float(trial.fit.values[i + j]) - base
        for (recording, _), columns in zip(trial.each, trial.owned, strict=True):
            for j, key in enumerate(keys_of(cause)):
                if key in cause.own:
                    value = float(trial.fit.values[columns[i + j]])
                    row[own_key(key, recording)] = value - base
        rows.append(row)
        i += cause.numbers
    return rows


def paths_of(index: int, cause: Hypothesis) -> list[str]:
    """The paths of the numbers of the i-th cause of a structure."""
    if cause.place is None:
        return [cause.path]
    return [f"{element_name(index)}.{key}" for key in cause.keys]


def limits_of(
    machine: Machine, causes: Sequence[Hypothesis], step: float
) -> tuple[Array, Array, Array, Array]:
    """Lower and upper bounds, prior means and prior deviations (F,) of the fitted numbers, SI;
    samples lie ``step`` seconds apart."""
    declared = {item.path: item for item in machine.model.all_parameters()}
    rows: list[tuple[float, float, float, float]] = []
    for cause in causes:
        if cause.place is None:
            value, sd = declared[cause.path].si, declared[cause.path].si_sd
            if cause.shape:  # the number of an actuator, which no file states
                begins = dict(cause.shape)["value"]
                rows.append((begins / ACTUATOR_REACH, begins * ACTUATOR_REACH, 0.0, np.inf))
                continue
            low, high = 1e-6 * value if cause.positive[0] else -np.inf, np.inf
            if cause.kind == "gain":
                reach = GAIN_REACH * abs(value)
                low, high = value - reach, value + reach
            if cause.kind == "delay":
                low, high = value - DELAY_REACH * step, value + DELAY_REACH * step
            rows.append((low, high, value, np.inf if sd is None else sd))
            continue
        rows += [(*cause.limits(key), 0.0, np.inf) for key in cause.keys]
    if not rows:
        empty = np.zeros(0)
        return empty, empty, empty, empty
    lower, upper, mean, spread = (np.array(column) for column in zip(*rows, strict=True))
    return lower, upper, mean, spread

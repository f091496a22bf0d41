"""A structure (a set of causes) fitted to recordings at full nonlinearity, and its evidence.

The model with its candidate elements is an ordinary model; its numbers, the trajectory and the
noise are fitted together by :mod:`symhyb.discrepancy.likelihood.fit`. Parameters that state an sd
are free in every structure: they are uncertain, whether they are named or not.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

import numpy as np

from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.search.trajectory import (
    gathered,
    keys_of,
    limits_of,
    own_key,
    paths_of,
    shared_out,
    with_causes,
)
from symhyb.data.recording import Recording
from symhyb.discrepancy.likelihood.fit import Fit, Task, fit
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import Extra, Track, track
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.standing import uncertain_beside
from symhyb.discrepancy.results import ClassName
from symhyb.model.actuators import ActuatorKey
from symhyb.model.types import Place
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.known import with_known
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.windows import WindowModel

NOISE_FLOOR = 1e-2  # of the noise that smoothing measured: no sensor is better

Does = Literal["", "drifts", "bends", "lags", "jumps", "holds", "fades", "noisy", ActuatorKey]
Row = Mapping[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class Generic:
    """A class of effects: its ``kind``, ``where`` it acts (a place, or the name of a channel or of
    a number), its columns for ``each`` stretch with the prior deviation ``spread`` (K,) of their
    coefficients and the prior ``mean`` (K,) in such deviations, what describes the one that fits
    best (a ``figure`` in SI, or NaN), what a channel ``does``, the ``other`` coordinate of a
    coupling or inputs that are held too, ``sensors`` that together would lag as an input does, and
    out of how many sets of columns these were the best (``tried``). A force of stretch and rate is
    a function of one of them alone (``over``) where that is the likeliest."""

    kind: ClassName
    where: Place | str
    each: tuple[Extra, ...]
    spread: Array
    figure: float = float("nan")
    does: Does = ""
    other: str = ""
    sensors: tuple[str, ...] = ()
    over: Literal["", "stretch", "rate"] = ""
    tried: int = 1
    mean: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        if not self.mean.size:
            object.__setattr__(self, "mean", np.zeros_like(self.spread))

    @property
    def key(self) -> tuple[object, ...]:
        """What makes two of them the same class."""
        return self.kind, self.where, self.does, self.other


class Likely(NamedTuple):
    """A class with its posterior ``probability``, and whether it explains all that acts beyond the
    decided structure (``whole``) or only the better part of it; whether what it leaves of the
    sensors is noise (``white``)."""

    generic: Generic
    probability: float
    whole: bool = True
    white: bool = True


@dataclass(frozen=True, slots=True)
class Fitted:
    """A fitted structure: its ``causes`` and the uncertain parameters beside them, the lowered
    model, the parameter column of each number (``paths``), the full parameter vector ``p`` (P,) in
    SI with the fitted values, and the fit; ``evidence`` is ln of its marginal likelihood times the
    prior odds of its causes. Where numbers are each recording's own, ``p`` has those of the first,
    ``each`` the vectors of all by recording, and the fit all numbers, those of ``paths`` first."""

    causes: tuple[Hypothesis, ...]
    beside: tuple[Hypothesis, ...]
    machine: Machine
    paths: tuple[str, ...]
    p: Array
    fit: Fit
    evidence: float = -np.inf
    accuracy: float = 0.0
    each: tuple[tuple[Recording, Array], ...] = ()
    owned: tuple[tuple[int, ...], ...] = ()
    extra: Generic | None = None

    @property
    def all_causes(self) -> tuple[Hypothesis, ...]:
        """The causes and the uncertain parameters beside them, in the order of the numbers."""
        return (*self.causes, *self.beside)

    @property
    def numbers(self) -> int:
        """How many numbers were fitted."""
        return int(self.fit.values.size)

    def of(self, recording: Recording) -> Array:
        """The parameter vector (P,) of a recording, SI, with what it knows; of one that was not
        fitted ``p``."""
        p = next((p for known, p in self.each if known is recording), self.p)
        return with_known(self.machine, p, recording.parameters)


def fitted(
    recorded: Recorded,
    causes: Sequence[Hypothesis],
    start: Sequence[Row],
    noise: NoiseModel,
    states: Sequence[Array] | None = None,
    known_noise: bool = False,
    extra: Generic | None = None,
    others: Sequence[NoiseModel] = (),
) -> Fitted:
    """Fit the causes, and the uncertain parameters beside them; ``start`` has the first guess of
    each cause by key, SI (of a parameter its change under "value"). ``states`` (N, X) of every
    stretch begin the trajectories; a ``known_noise`` is not fitted; an ``extra`` acts beside the
    causes. The noise may begin with one of ``others``, if that is likelier."""
    beside = uncertain_beside(recorded.windows.machine.model, recorded.parametric, causes)
    every, rows = (*causes, *beside), [*start, *({"value": 0.0} for _ in beside)]
    machine = _machine(recorded, causes, start)
    paths = tuple(path for i, cause in enumerate(every) for path in paths_of(i, cause))
    free = tuple(machine.column(path) for path in paths)
    p = machine.values.copy()
    for cause, row in zip(every, rows, strict=True):
        if cause.place is None:
            p[machine.column(cause.path)] += row["value"]
    items = tuple(item.suited(machine) for item in recorded.items)
    owned = shared_out(every, recorded.each)
    first = _beginning(recorded, machine, every, rows, p[list(free)])
    lower, upper, mean, spread = (
        gathered(row, owned) for row in limits_of(machine, every, recorded.step_s)
    )
    floor = NOISE_FLOOR * recorded.sd
    task = Task(items, recorded.recording, floor, lower, upper, mean, spread, owned)
    if extra is not None:
        task = _with_columns(task, extra)
        begin = extra.mean * extra.spread
        first = np.concatenate([p[list(free)] if first is None else first, begin])
    begun = None
    if states is not None:
        begun = [_begun(item.states[0], x) for item, x in zip(items, states, strict=True)]
    done = fit(WindowModel(machine, free), task, p, noise, first, begun, known_noise, others)
    each = []
    for which, one in enumerate(recorded.each):
        each.append((one, task.filled(which, p, free, done.values)))
    p[list(free)] = done.values[: len(free)]
    found = Fitted(tuple(causes), beside, machine, paths, p, done, extra=extra)
    found = replace(found, accuracy=recorded.accuracy)
    return replace(found, each=tuple(each), owned=owned) if owned else found


def _with_columns(task: Task, extra: Generic) -> Task:
    """A task with the coefficients of some columns behind its numbers."""
    count = extra.spread.size
    return replace(
        task,
        lower=np.append(task.lower, np.full(count, -np.inf)),
        upper=np.append(task.upper, np.full(count, np.inf)),
        mean=np.append(task.mean, extra.mean * extra.spread),
        spread=np.append(task.spread, extra.spread),
        extra=extra.each,
    )


def _machine(recorded: Recorded, causes: Sequence[Hypothesis], start: Sequence[Row]) -> Machine:
    """The model with the causes, lowered."""
    return build(with_causes(recorded.windows.machine.model, causes, start), keep=False)


def _beginning(
    recorded: Recorded,
    machine: Machine,
    causes: Sequence[Hypothesis],
    start: Sequence[Row],
    p: Array,
) -> Array | None:
    """Where all numbers begin, SI; None if all are shared."""
    owned = shared_out(causes, recorded.each)
    if not owned:
        return None
    full = gathered(p, owned)
    for recording, columns in zip(recorded.each, owned, strict=True):
        i = 0
        for cause, row in zip(causes, start, strict=True):
            base = machine.values[machine.column(cause.path)] if cause.place is None else 0.0
            for key in keys_of(cause):
                if key in cause.own and own_key(key, recording) in row:
                    full[columns[i]] = base + row[own_key(key, recording)]
                i += 1
    return full


def _begun(measured: Array, states: Array) -> Array:
    """Where a trajectory (N, X) begins for a structure that may have other inner states."""
    full = measured.copy()
    shared = min(full.shape[1], states.shape[1])
    full[:, :shared] = states[:, :shared]
    return full


def tracks_of(
    recorded: Recorded, trial: Fitted, columns: Sequence[int] | None = None
) -> list[Track]:
    """A structure linearised along its trajectory; free are its own numbers, or the ``columns`` of
    p that are given."""
    if columns is None:
        columns = [trial.machine.column(path) for path in trial.paths]
    model, found = WindowModel(trial.machine, tuple(columns)), []
    more = 0 if trial.extra is None else trial.extra.spread.size
    sizes = trial.fit.values[trial.fit.values.size - more :]
    for i, (item, states) in enumerate(zip(recorded.items, trial.fit.states, strict=True)):
        p = trial.of(item.source[0])
        extra = trial.extra.each[i] if trial.extra else None
        suited = item.suited(trial.machine).in_time(model, p)
        found.append(track(model, suited, states, p, extra, sizes))
    return found

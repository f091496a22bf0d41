"""The equations of an FMU or of MuJoCo along recordings: local to the measured motion.

    M(t) q'' = c(t) + K(t) q + D(t) q' + B(t) u + ΔF

The program is asked at the measured states. What it says the same at all samples becomes a number,
so that a linear machine becomes its own equations; what varies becomes columns of the recordings,
as changes about the mean. Slopes by parameters are differences of all that. Exact are therefore
forces that are linear in coordinates, rates and inputs, each times a parameter or not; all others
are to first order in how far a simulation leaves the measured motion.
Sizes: N samples, n coordinates, k inputs, P parameters.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from symhyb.data.hosts import fmu_answers, mujoco_answers
from symhyb.data.hosts.answers import Answer, Question
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import Motion, motion_of, unplaced
from symhyb.discrepancy.recorded.signals import acting
from symhyb.errors import InputError, Problem
from symhyb.model.bare import bare
from symhyb.model.fmu import Fmu
from symhyb.model.local import COLUMN, Local, LocalTerm
from symhyb.model.mujoco import Mujoco
from symhyb.model.types import Energy, Input, Model
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import build
from symhyb.units import ONE

Engine = Fmu | Mujoco

STEP = 1e-4  # of the range of a signal: differences are exact to about 1e-8
UNRESOLVED = 1e-7  # of what acts: less is what differences leave
PARAMETER_STEP = 1e-3  # of a parameter
LEAST = 1e-300  # SI; divides
KINDS: tuple[Literal["place", "rate", "input"], ...] = ("place", "rate", "input")


def along_recordings(
    model: Model, *groups: Sequence[Recording]
) -> tuple[Model, tuple[tuple[Recording, ...], ...]]:
    """A model and groups of recordings of it: as they are, or of a model that another program
    runs with local equations, and recordings with what varies in these along them.

    Raises:
        InputError: as :func:`symhyb.data.hosts.fmu_answers.ask` and that of ``mujoco_answers``; or
            no sensor shows where a coordinate is.
    """
    if model.engine is None:
        return model, tuple(map(tuple, groups))
    engine, model = model.engine, bare(model)
    recordings = [plain(one) for group in groups for one in group]
    uncertain = _uncertain(model, engine, recordings)
    asked = [_asked(model, engine, one, uncertain) for one in recordings]
    nominal = tuple((path, _value(model, path)) for path in uncertain)
    terms, columns = _terms(asked, nominal)
    names = [term.column for term in terms if term.column]
    more = tuple(Input(name, ONE, local=True) for name in dict.fromkeys(names))
    local = replace(
        model,
        energy=Energy(),
        inputs=(*model.inputs, *more),
        local=Local(tuple(terms), nominal),
    )
    full = iter(
        replace(one, inputs={**one.inputs, **mine}, sha256=one.sha256)
        for one, mine in zip(recordings, columns, strict=True)
    )
    return local, tuple(tuple(next(full) for _ in group) for group in groups)


def beside(model: Model, local: Model) -> Model:
    """Another model of the same machine with the local equations of ``local``, in which the
    parameters that it changes are uncertain."""
    if local.local is None:
        return model
    columns = tuple(item for item in local.inputs if item.local)
    return replace(model, inputs=(*model.recorded_inputs, *columns), local=local.local)


def plain(recording: Recording) -> Recording:
    """A recording without columns of local equations."""
    kept = {name: row for name, row in recording.inputs.items() if not name.startswith(COLUMN)}
    return recording if len(kept) == len(recording.inputs) else replace(recording, inputs=kept)


def _value(model: Model, path: str) -> float:
    return next(item.si for item in model.parameters if item.path == path)


def _uncertain(model: Model, engine: Engine, recordings: Sequence[Recording]) -> tuple[str, ...]:
    """The parameters of the program that may be fitted, or that a recording knows better."""
    known = {path for one in recordings for path in one.parameters}
    stated = {item.path for item in model.parameters if item.sd is not None}
    return tuple(name for name in engine.parameter_names if name in known | stated)


class _Equations(NamedTuple):
    """M (N, n, n), c (N, n) and the slopes of the force by q, v and u (N, n, 2n + k)."""

    mass: Array
    force: Array
    slopes: Array


@dataclass(frozen=True, slots=True)
class _Asked:
    """What a program said along one recording, and the same by each uncertain parameter; ``state``
    (N, 2n + k) is where it was asked, ``inputs`` are the numbers of its inputs among those of the
    model."""

    t: Array
    state: Array
    inputs: tuple[int, ...]
    base: _Equations
    by: tuple[_Equations, ...]


def _asked(model: Model, engine: Engine, recording: Recording, uncertain: Sequence[str]) -> _Asked:
    machine = build(model)
    lost = unplaced(recording, machine)
    if lost:
        text = f"no sensor shows the place of {', '.join(lost)}, where the machine has to be asked"
        raise InputError(Problem(f"{text}; record it", "sensors", recording.name))
    motion = motion_of(recording, machine)
    names = [item.name for item in model.inputs]
    which = tuple(names.index(name) for name in engine.input_names)
    u = _acting(model, recording, acting(recording, machine))[:, list(which)]
    values = np.array([_value(model, name) for name in engine.parameter_names])
    sets, steps = [values], []
    for path in uncertain:
        i = engine.parameter_names.index(path)
        steps.append(PARAMETER_STEP * (abs(float(values[i])) or 1.0))
        for side in (steps[-1], -steps[-1]):
            sets.append(values.copy())
            sets[-1][i] += side
    moved = motion.q, motion.v, motion.a, u
    reach = _steps(motion, u), _least((motion.a,))
    question = Question(motion.t, *moved, *reach, np.array(sets))
    answer = _answer(engine, model.file, question)
    state = np.concatenate([motion.q, motion.v, u], axis=1)
    parts = [_at(answer, i, state) for i in range(len(sets))]
    by = [
        _Equations(*((up - down) / (2 * step) for up, down in zip(*parts[i : i + 2], strict=True)))
        for i, step in zip(range(1, len(sets), 2), steps, strict=True)
    ]
    return _Asked(motion.t, state, which, parts[0], tuple(by))


def _answer(engine: Engine, file: str, question: Question) -> Answer:
    path = engine.path(file)
    if isinstance(engine, Fmu):
        return fmu_answers.ask(engine, path, question)
    return mujoco_answers.ask(engine, path, question)


def _acting(model: Model, recording: Recording, u: Array) -> Array:
    """Inputs (N, k) with the gains and offsets that the model states, SI."""
    acted = u.copy()
    for i, item in enumerate(model.inputs):
        gain = 1.0 if item.gain is None else recording.parameters.get(item.gain.path, item.gain.si)
        acted[:, i] *= gain
        if item.offset is not None:
            acted[:, i] += recording.parameters.get(item.offset.path, item.offset.si)
    return acted


def _steps(motion: Motion, u: Array) -> Array:
    """How far (2n + k,) to either side the program is asked: as far as the motion is uncertain."""
    sd = np.concatenate([motion.q_sd, motion.v_sd, np.zeros(u.shape[1])])
    return np.asarray(np.fmax(_least((motion.q, motion.v, u)), sd))


def _least(parts: Sequence[Array]) -> Array:
    """A small part of the range of each column of ``parts``."""
    reach = np.concatenate([np.ptp(part, axis=0) for part in parts])
    size = np.concatenate([np.abs(part).max(axis=0, initial=0.0) for part in parts])
    return STEP * np.where(reach > 0, reach, np.where(size > 0, size, 1.0))


def _at(answer: Answer, which: int, state: Array) -> _Equations:
    """What was said with one set of parameters."""
    mass, force, slopes = answer.mass[which], answer.force[which], answer.slopes[which]
    return _Equations(mass, force - np.einsum("tij,tj->ti", slopes, state), slopes)


def _terms(
    asked: Sequence[_Asked], nominal: Sequence[tuple[str, float]]
) -> tuple[list[LocalTerm], list[dict[str, Array]]]:
    """The terms of local equations, and for each recording its columns by name; ``nominal`` are the
    uncertain parameters, SI."""
    terms: list[LocalTerm] = []
    columns: list[dict[str, Array]] = [{} for _ in asked]
    for number, (path, value) in enumerate((("", 0.0), *nominal)):
        parts = [one.base if not path else one.by[number - 1] for one in asked]
        for term, entries, weight in _entries(asked, parts, path, abs(value) or 1.0):
            made = _split(entries, weight)
            if made is None:
                continue
            mean, rest = made
            named = replace(term, value=mean)
            if rest is not None:
                named = replace(named, column=_name(term))
                for into, part in zip(columns, rest, strict=True):
                    into[named.column] = part
            terms.append(named)
            if term.kind == "mass" and rest is not None:
                swell = replace(named, kind="mass rate", value=0.0, column="")
                swell = replace(swell, column=_name(swell))
                for into, part, one in zip(columns, rest, asked, strict=True):
                    into[swell.column] = np.gradient(part, one.t)
                terms.append(swell)
    return terms, columns


def _name(term: LocalTerm) -> str:
    return f"{COLUMN}{term.kind} {term.row} {term.by} {term.path}".rstrip()


def _entries(
    asked: Sequence[_Asked], parts: Sequence[_Equations], path: str, unit: float
) -> Iterator[tuple[LocalTerm, list[Array], float]]:
    """Every entry of local equations as a term, its values (N,) along each recording, and how
    large it may be and still be what differences leave: of what acts, or ``unit`` of the parameter
    ``path`` makes act."""
    sizes = np.maximum(_rms([one.state for one in asked]), LEAST)
    mass, acts = _scales([one.base for one in asked], sizes)
    if path:
        more = _scales(parts, sizes)
        mass, acts = np.maximum(mass / unit, more[0]), np.maximum(acts / unit, more[1])
    n = acts.size
    for i in range(n):
        for j in range(n):
            values = [part.mass[:, i, j] for part in parts]
            yield LocalTerm("mass", i, j, 0.0, path=path), values, UNRESOLVED * mass[i]
        for j, size in enumerate(sizes):
            values = [part.slopes[:, i, j] for part in parts]
            by = j % n if j < 2 * n else asked[0].inputs[j - 2 * n]
            term = LocalTerm(KINDS[min(j // n, 2)], i, by, 0.0, path=path)
            yield term, values, UNRESOLVED * acts[i] / size
        force = [part.force[:, i] for part in parts]
        yield LocalTerm("force", i, 0, 0.0, path=path), force, UNRESOLVED * acts[i]


def _scales(parts: Sequence[_Equations], sizes: Array) -> tuple[Array, Array]:
    """How large masses (n,) and forces (n,) are, for states of these ``sizes`` (2n + k,)."""
    mass = _rms([np.diagonal(part.mass, axis1=1, axis2=2) for part in parts])
    acts = _rms([part.force for part in parts])
    for j, size in enumerate(sizes):
        acts = np.maximum(acts, size * _rms([part.slopes[:, :, j] for part in parts]))
    return np.maximum(mass, LEAST), np.maximum(acts, LEAST)


def _split(entries: Sequence[Array], least: float) -> tuple[float, list[Array] | None] | None:
    """An entry as a number, and columns of what varies about it; None where it is nothing."""
    joined = np.concatenate(entries)
    mean = float(np.mean(joined))
    if np.abs(joined).max() <= least:
        return None
    if np.abs(joined - mean).max() <= max(least, UNRESOLVED * abs(mean)):
        return mean, None
    return mean, [entry - mean for entry in entries]


def _rms(parts: Sequence[Array]) -> Array:
    return np.asarray(np.sqrt(np.mean(np.concatenate(parts) ** 2, axis=0)))

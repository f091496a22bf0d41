"""What a network is trained on: its inputs along the recordings, and the force that is lacking.

Sizes: N samples of all windows, I inputs, K named values.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symhyb.correction.learning.orthogonal import named_forces
from symhyb.correction.search.preparing import Prepared
from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.recorded.ends import between_ends
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """Samples of the windows, SI: what the network sees ``x`` (N, I), ΔF at its coordinate
    ``force`` (N,), what changes of named values make ``laws`` (N, K), position and speed there
    ``q``, ``v`` (N,), time ``t`` (N,) and ``run`` (N,), the recording; ``fitted`` (N,) is False in
    windows that only validate and where the smoothed motion begins or ends. ``on`` is the
    coordinate, ``inputs`` what x is, ``box`` the range of each, ``names`` the recordings."""

    on: str
    inputs: tuple[str, ...]
    x: Array
    force: Array
    laws: Array
    q: Array
    v: Array
    t: Array
    run: NDArray[np.int64]
    fitted: NDArray[np.bool_]
    names: tuple[str, ...]

    @property
    def box(self) -> tuple[tuple[float, float], ...]:
        """The range of every input in the recordings."""
        ends = zip(self.x.min(axis=0).tolist(), self.x.max(axis=0).tolist(), strict=True)
        return tuple((low, high) for low, high in ends)


def see(prepared: Prepared, cuts: Sequence[Cut], on: str | None, inputs: Sequence[str]) -> Seen:
    """The samples of some windows for a network on a coordinate (default: the only free one).

    Raises:
        InputError: an unknown coordinate or input, or an input that never changes.
    """
    model, machine = prepared.machine.model, prepared.machine
    place = _coordinate(model, on)
    names = tuple(inputs) or (place, f"{place}'")
    index = [c.name for c in model.coordinates].index(place)
    _require_known(model, names)
    parts: list[tuple[NDArray[Any], ...]] = []
    for run, item in enumerate(cuts):
        course, motion = item.course(machine), item.source[1]
        rows = item.rows[:, :-1]  # the last sample of a window is the first of the next one
        held = np.repeat(item.held, rows.shape[1])
        rows = rows.ravel()
        parts.append(
            (
                np.column_stack([_column(model, course, name) for name in names])[rows],
                discrepancy(machine, course, machine.values)[rows, index],
                named_forces(machine, course)[rows, index],
                course.q[rows, index],
                course.v[rows, index],
                course.t[rows],
                np.full(rows.size, run),
                between_ends(motion, course.t[rows]) & ~held,
            )
        )
    x, force, laws, q, v, t, run_of, fitted = map(np.concatenate, zip(*parts, strict=True))
    recordings = tuple(item.source[0].name for item in cuts)
    seen = Seen(place, names, x, force, laws, q, v, t, run_of, fitted, recordings)
    for name, (low, high) in zip(names, seen.box, strict=True):
        if not low < high:
            text = f"'{name}' never changes in these recordings: a network cannot learn from it"
            raise InputError(Problem(text))
    return seen


def _coordinate(model: Model, on: str | None) -> str:
    free = [c.name for c in model.coordinates if not c.imposed]
    if on is None and len(free) != 1:
        raise InputError(Problem(f"name the coordinate of the network: {', '.join(free)}"))
    name = on or free[0]
    if name not in free:
        raise InputError(Problem(f"'{name}' is no free coordinate; there are: {', '.join(free)}"))
    return name


def _require_known(model: Model, names: Sequence[str]) -> None:
    places = [c.name for c in model.coordinates]
    known = [*places, *(f"{name}'" for name in places), *(i.name for i in model.inputs), "t"]
    for name in names:
        if name not in known:
            text = f"a network can see {', '.join(known)}, not '{name}'{did_you_mean(name, known)}"
            raise InputError(Problem(text))
    if len(set(names)) < len(names):
        raise InputError(Problem(f"a network sees each of {', '.join(names)} once"))


def _column(model: Model, course: Course, name: str) -> Array:
    """One input (N,), SI, along a course."""
    places, signals = [c.name for c in model.coordinates], [item.name for item in model.inputs]
    if name == "t":
        return course.t
    if name in signals:  # as it acts, for so the element will see it
        item = model.inputs[signals.index(name)]
        gain = 1.0 if item.gain is None else item.gain.si
        offset = 0.0 if item.offset is None else item.offset.si
        return np.asarray(gain * course.u[:, signals.index(name)] + offset)
    table = course.v if name.endswith("'") else course.q
    return np.asarray(table[:, places.index(name.removesuffix("'"))])

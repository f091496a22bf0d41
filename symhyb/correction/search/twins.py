"""Laws that are the same as a parameter of the model, however the machine moves.

    ΔF(q, v, a; p + δ) − ΔF(q, v, a; p) = −c F(q, v, a)        at random states, for one number c

An added inertia on a coordinate is the moment of inertia that turns with it. Along a motion that is
known to its noise the two look alike, and not the same; along none can they be distinguished. The
file states the parameter with an sd, so it is known to be off, and it is the one that is named.
Sizes: S states, n coordinates, C probe columns.
"""

from collections.abc import Iterator

import numpy as np

from symhyb.correction.search.setting import Setting
from symhyb.discrepancy.places.hypotheses import Library
from symhyb.discrepancy.places.probing import PARALLEL
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine

STATES = 11
CHANGES = (0.1, -0.2)  # of a parameter: a law is the same at any size of the change
LENGTH_S = 1.0


def exact_twins(setting: Setting) -> tuple[tuple[int, int], ...]:
    """Pairs of causes, by index: a parameter that states an sd, and a law with one number that is
    the same. None of a machine with inner states, whose rates a parameter may enter."""
    machine, library = setting.windows.machine, setting.library
    if machine.inner_states:
        return ()
    laws = _laws(library)
    forces = _probe_forces(library)[:, :, [column for _, column in laws]]
    first = len(library.hypotheses)
    pairs = []
    for i, cause in enumerate(setting.parametric):
        if cause.kind != "parameter":
            continue
        changes = list(_changes(machine, machine.column(cause.path)))
        for k, (law, _) in enumerate(laws):
            if changes and all(_same(change, forces[:, :, k]) for change in changes):
                pairs.append((first + i, law))
    return tuple(pairs)


def _laws(library: Library) -> list[tuple[int, int]]:
    """The laws with one number that are linear in it: index and probe column."""
    pairs = zip(library.hypotheses, library.columns, strict=True)
    return [(i, c[0]) for i, (law, c) in enumerate(pairs) if law.numbers == len(c) == 1]


def _states(machine: Machine) -> tuple[Array, Array, Array, Array, Array]:
    """Random q, v, a (S, n), inputs (S, k) and times (S,), SI."""
    rng, start = np.random.default_rng(0), np.array(machine.model.start()[0])
    q, v, a = rng.normal(size=(3, STATES, machine.n))
    u = rng.normal(size=(STATES, len(machine.model.inputs)))
    return start + q, v, a, u, np.linspace(0, LENGTH_S, STATES)


def _probe_forces(library: Library) -> Array:
    """Generalized forces (S, n, C) of all probes at the random states, SI."""
    machine = library.machine
    q, v, a, u, t = _states(machine)
    z = np.zeros((STATES, machine.inner_states))
    (forces,) = along(machine.elements, (q, v, z, u, t, machine.values), (5,), STATES)
    (carried,) = along(machine.carried, (q, v, a, t, machine.values), (4,), STATES)
    every = (forces + carried).reshape(STATES, -1, machine.n).swapaxes(1, 2)
    return np.asarray(every[:, :, every.shape[2] - sum(map(len, library.columns)) :])


def _changes(machine: Machine, column: int) -> Iterator[Array]:
    """How a change of one parameter changes the missing force (S, n); nothing where it changes what
    sensors show, too."""
    q, v, a, u, t = _states(machine)
    z = np.zeros((STATES, 0))

    def at(values: Array) -> tuple[Array, Array]:
        arguments = (q, v, a, z, u, t, values)
        (force,) = along(machine.discrepancy, arguments, (6,), STATES)
        (shown,) = along(machine.outputs, arguments, (6,), STATES)
        return force.reshape(STATES, machine.n), shown

    base, shown = at(machine.values)
    for share in CHANGES:
        values = machine.values.copy()
        values[column] += share * (abs(values[column]) or 1.0)
        force, seen = at(values)
        if not np.array_equal(seen, shown):
            return
        yield force - base


def _same(change: Array, law: Array) -> bool:
    """Whether two forces (S, n) are the same but for one factor of either sign."""
    size = float(np.linalg.norm(law))
    if not (np.isfinite(size) and size > 0 and np.all(np.isfinite(change)) and np.any(change)):
        return False
    factor = float(np.sum(change * law)) / size**2
    return float(np.abs(change - factor * law).max()) < PARALLEL * float(np.abs(change).max())

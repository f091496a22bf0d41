"""How large the forces of a fitted structure are along the recordings, cause by cause."""

from dataclasses import replace

from symhyb.correction.search.trajectory import Refined
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along


def element_forces(
    final: Refined, recording: Recording, motion: Motion
) -> tuple[Array, Array, Array]:
    """Generalized forces (N, n, E) of all elements along a recording, stretches and rates (N, E),
    SI; those of the causes come last."""
    p = final.of(recording)
    machine = replace(final.machine, values=p)
    c = course_of(recording, machine, motion)
    given = c.q, c.v, c.z, c.u, c.t, p
    (flat,) = along(machine.elements, given, (5,), c.t.size)
    flat = flat + along(machine.carried, (c.q, c.v, c.a, c.t, p), (4,), c.t.size)[0]
    forces = flat.reshape(c.t.size, -1, machine.n).swapaxes(1, 2)
    stretch, rate, _ = along(machine.pathways, (c.q, c.v, c.t, p), (3,), c.t.size)
    return forces, stretch, rate


def changed_force(final: Refined, path: str, recording: Recording, motion: Motion) -> Array:
    """Generalized force (N, n), SI, of the change of a parameter from its value in the model to the
    fitted one along a recording; 0 of a number of a channel."""
    p = final.of(recording)
    machine = replace(final.machine, values=p)
    c = course_of(recording, machine, motion)
    before = p.copy()
    before[machine.column(path)] = final.machine.values[machine.column(path)]
    moved = c.q, c.v, c.a, c.z, c.u, c.t
    (needs, needed) = (
        along(machine.discrepancy, (*moved, row), (6,), c.t.size)[0] for row in (p, before)
    )
    return needs - needed

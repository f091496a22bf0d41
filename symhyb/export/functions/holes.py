"""Networks kept as matrices beside the laws, for code that is compiled.

Written out multiplication by multiplication, a network of 64 and 64 units is more than a megabyte
of C. Here the laws of a model have a hole h for the force of each network, and a function is put
together from  inputs → network → the rest.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import casadi as ca

from symhyb.model.types import Model, Network
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.network import FADE, fill_of


@dataclass(frozen=True, slots=True, eq=False)
class Hole:
    """A network: ``force`` stands for its force, ``inputs`` (I, 1) are what it sees, SI."""

    name: str
    network: Network
    force: ca.SX
    inputs: ca.SX

    def trust(self) -> ca.SX:
        """1 inside the trust box, falling to 0 outside as the force does."""
        inside = ca.SX(1)
        for i, (low, high) in enumerate(self.network.trust):
            beyond = ca.fmax(ca.fmax(low - self.inputs[i], self.inputs[i] - high), 0)
            share = 1 - ca.fmin(beyond / (FADE * (high - low)), 1)
            inside = inside * share**2 * (3 - 2 * share)
        return inside


@dataclass(frozen=True, slots=True, eq=False)
class Parts:
    """Symbols of a model, on them the generalized ``forces`` (n, E) of its elements with a hole for
    each network, the rates of the inner states and their values at rest; where modes are wanted,
    these (M, 1) and the ``arguments`` (M, 1) that decide them. SI."""

    q: ca.SX
    v: ca.SX
    z: ca.SX
    u: ca.SX
    t: ca.SX
    p: ca.SX
    forces: ca.SX
    inner: ca.SX
    rest: ca.SX
    holes: tuple[Hole, ...]
    modes: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    arguments: ca.SX = field(default_factory=lambda: ca.SX(0, 1))

    def at(self, q: ca.SX, v: ca.SX, u: ca.SX, t: ca.SX, p: ca.SX) -> "Parts":
        """The same on other symbols; the inner states stay."""
        given = [self.forces, self.inner, self.rest, *(hole.inputs for hole in self.holes)]
        made = ca.substitute(given, [self.q, self.v, self.u, self.t, self.p], [q, v, u, t, p])
        holes = (
            replace(hole, inputs=inputs) for hole, inputs in zip(self.holes, made[3:], strict=True)
        )
        return Parts(q, v, self.z, u, t, p, made[0], made[1], made[2], tuple(holes))


def parts_of(machine: Machine, modes: bool = False) -> Parts:
    """The elements of a machine; its networks as holes, and its ``modes`` if they are wanted, with
    what indicates them (:func:`symhyb.mechanics.opened.banded`)."""
    if modes or any(element.network for element in machine.model.elements):
        return _opened(machine.model, modes)
    n, k = machine.n, len(machine.model.inputs)
    q, v, u = (ca.SX.sym(name, size) for name, size in (("q", n), ("v", n), ("u", k)))
    z, t, p = ca.SX.sym("z", machine.inner_states), ca.SX.sym("t"), ca.SX.sym("p", _count(machine))
    here = (q, v, z, u, t, p)
    return Parts(
        *here, machine.elements(*here), machine.inner(*here), machine.inner_rest(q, v, t, p), ()
    )


def _count(machine: Machine) -> int:
    return int(machine.values.size)


def _opened(model: Model, modes: bool) -> Parts:
    from symhyb.mechanics.equations import derive  # SymPy takes half a second to import
    from symhyb.mechanics.opened import banded
    from symhyb.numeric.lowered.translate import Lowered

    holes: dict[str, Hole] = {}

    def catching(name: str, network: Network) -> Callable[[ca.SX], ca.SX]:
        def fill(inputs: ca.SX) -> ca.SX:
            holes[name] = Hole(name, network, ca.SX.sym(f"h_{name}"), inputs)
            return holes[name].force

        return fill

    fills = {e.name: catching(e.name, e.network) for e in model.elements if e.network is not None}
    equations = derive(model)
    written = banded(model, equations) if modes else equations
    low = Lowered(written, fills)
    forces = ca.densify(ca.horzcat(*low.forces))
    k = len(model.inputs)
    return Parts(
        low.q,
        low.v,
        low.z,
        low.u[:k, 0],
        low.t,
        low.p,
        forces,
        ca.densify(low.inner),
        ca.densify(low.rest),
        tuple(holes.values()),
        low.u[k:, 0],
        low.column(written.outputs[len(equations.outputs) :]),
    )


def filled(
    around: ca.Function, holes: Sequence[Hole], here: Sequence[ca.SX], model: Model
) -> ca.Function:
    """(b) -> the result of ``around``, whose arguments are b, split like ``here``, and the forces
    of the networks; b is all of ``here`` in one column."""
    sizes = [0]
    for part in here:
        sizes.append(sizes[-1] + part.numel())
    b = ca.MX.sym("b", sizes[-1])
    parts: list[Any] = [b[i:j] for i, j in pairwise(sizes)]
    forces: list[Any] = []
    for hole in holes:
        seen = ca.Function(
            f"seen_{hole.name}", list(here), [ca.densify(hole.inputs)], {"cse": True}
        )
        forces.append(
            fill_of(hole.network, model.file)(seen(*parts))
        )  # the same code for SX and MX
    return ca.Function("filled", [b], [around(*parts, ca.vertcat(*forces))])

"""A model as named CasADi functions: M, k_c, k_e, the acceleration, outputs and energies.

    M(q,t) q'' + k_c(q,q',t) = k_e(q,q',u,t) + ΔF        (ΔF is a force that acts)

CasADi differentiates T and V; SymPy never does. Source of the form: Lagrange's equations with
p = ∂T/∂v, see docs/design.md.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import casadi as ca
import numpy as np

from symhyb.asked import asked
from symhyb.model.closed import require_open
from symhyb.model.delays import shared_delays
from symhyb.model.switching import frictions, gradual
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.lowered import cache
from symhyb.numeric.lowered.assembly import assembled, constraints_key
from symhyb.numeric.lowered.constrained import loops_of, lowered_closure, solve
from symhyb.numeric.lowered.local import beside, nominal
from symhyb.numeric.lowered.network import fill_of
from symhyb.numeric.lowered.sound import require_sound
from symhyb.shown import card

if TYPE_CHECKING:
    from symhyb.numeric.lowered.translate import Lowered

Opening = Literal["closed", "switched", "banded"]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Machine:
    """A model lowered to CasADi; every number in coherent SI.

    Sizes: n coordinates (those imposed included), z declared states and, behind them, inner states
    of elements, k inputs, m sensors, P parameters, E elements, N samples.

    Attributes:
        M: (q, t, p) -> (n, n) mass matrix.
        k_c: (q, v, t, p) -> (n,) Coriolis and gyroscopic forces.
        k_e: (q, v, z, u, t, p) -> (n,) applied forces, those of potentials included.
        input_matrix: (q, v, t, p) -> (n, k) with k_e = k_e(u=0) + input_matrix·u; None where an
            input acts nonlinearly.
        acceleration: (q, v, z, u, t, p, w, b) -> (n,) q'' under an extra generalized force w; b
            are the accelerations of the imposed coordinates, which stay as they are. Constraints
            hold, and what they leave open is pulled closed
            (:mod:`symhyb.numeric.lowered.constrained`).
        inner: (q, v, z, u, t, p) -> (z,) rates of z.
        inner_rest: (q, v, t, p) -> (z,) inner states settled at q, in a machine that moves on at v,
            declared states at their start.
        outputs: (q, v, a, z, u, t, p) -> (m,) what the sensors record, without noise and delay.
        sensed: (q, v, a, z, u, t, p, w) -> the same under an extra generalized force w.
        output_slopes: the arguments of outputs -> (m, n) ∂y/∂q, ∂y/∂v and ∂y/∂a.
        discrepancy: the arguments of outputs -> (n,) M a + k_c − k_e, what has to act
            besides k_e: ΔF of a measured motion, the reaction of an imposed coordinate. With
            constraints their reactions are taken off: M (a − a of the model) where free.
        weak: (q, v, z, u, t, p) -> (n,) momentum p and (n,) ∂T/∂q + k_e, so that ΔF = p' − the
            latter.
        energy: (q, v, z, t, p) -> T, V, (E,) stored in the elements.
        elements: (q, v, z, u, t, p) -> (n, E) generalized force of each element.
        carried: (q, v, a, t, p) -> (n, E) force of the mass that an element adds, which is part
            of M and k_c and not of ``elements``.
        pathways: (q, v, t, p) -> (E,) stretch, (E,) rate, (n, E) direction ∂s/∂q; NaN at points.
        closure: (q, v, a, t, p) -> (m,) what constraints leave open, its first and second
            derivative by time, (m, n) its slopes J by q and those of its rate; None without
            constraints, as the next.
        closure_slopes: (q, v, t, p) -> (m, P) slopes of what is open and of its rate by p.
        sampled: (q, v, z, u, t, p) -> (S,) declared states after a sample, those that are not
            sampled as they are; None where none is.
        levels: (q, v, z, u, t, p) -> (3 F,) of each dry friction what it holds at most against a
            motion forwards, and backwards, N, and the rate within which it turns over, m/s, in the
            order of ``symhyb.model.switching.frictions``; None without.
        shared: (q, t, p) -> (n, n) what constraints leave of a generalized force, as in
            ``discrepancy``.
        values: (P,) parameter values in the order of ``model.all_parameters()``.
    """

    model: Model
    M: ca.Function
    k_c: ca.Function
    k_e: ca.Function
    input_matrix: ca.Function | None
    acceleration: ca.Function
    inner: ca.Function
    inner_rest: ca.Function
    outputs: ca.Function
    sensed: ca.Function
    output_slopes: ca.Function
    discrepancy: ca.Function
    weak: ca.Function
    energy: ca.Function
    elements: ca.Function
    carried: ca.Function
    pathways: ca.Function
    values: Array
    closure: ca.Function | None = None
    closure_slopes: ca.Function | None = None
    shared: ca.Function | None = None
    sampled: ca.Function | None = None
    levels: ca.Function | None = None

    def __repr__(self) -> str:
        title = self.model.title or self.model.file
        return f"<Machine '{title}': {', '.join(self._sizes())}>"

    def _repr_html_(self) -> str:
        title = f"Machine: {self.model.title or self.model.file}"
        rows = [
            (name, ", ".join(function.name_in()), "×".join(map(str, function.size_out(0))))
            for name, function in (("M", self.M), ("k_c", self.k_c), ("k_e", self.k_e))
        ]
        text = f"{', '.join(self._sizes())}; every number in SI"
        more = self.model._repr_html_()
        return card(title, text, ("function", "of", "size"), rows, self.notes, more)

    def _sizes(self) -> tuple[str, ...]:
        imposed = f" ({len(self.imposed)} imposed)" if self.imposed else ""
        counts = (
            (self.n, "coordinate", imposed),
            (len(self.model.states), "declared state", ""),
            (self.inner_states - len(self.model.states), "inner state", ""),
            (self.constraints, "constraint row", ""),
            (self.values.size, "parameter", ""),
        )
        return tuple(f"{k} {noun}{'s' * (k != 1)}{more}" for k, noun, more in counts if k)

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return len(self.model.coordinates)

    @property
    def discrepancy_slopes(self) -> ca.Function:
        """The arguments of outputs -> (n, n) ∂/∂q, ∂/∂v and ∂/∂a of ``discrepancy``; lowered when
        first asked for, as they are longer than all else and few motions need them."""
        key = ("discrepancy slopes", structure_of(self.model))
        return kept(key, lambda: _slopes(self.discrepancy))

    @property
    def inner_states(self) -> int:
        """How many declared states and inner states of elements there are."""
        return int(self.inner.size1_out(0))

    @property
    def constraints(self) -> int:
        """Number of rows of constraints, without those that repeat others."""
        return 0 if self.closure is None else int(self.closure.size1_out(0))

    @property
    def notes(self) -> tuple[str, ...]:
        """What was moved or left out so that constraints close."""
        found = self.model.assembly
        return () if found is None else (*found.moves, *found.notes)

    @property
    def free(self) -> tuple[int, ...]:
        """The coordinates that follow from forces."""
        return tuple(i for i, c in enumerate(self.model.coordinates) if not c.imposed)

    @property
    def imposed(self) -> tuple[int, ...]:
        """The coordinates whose motion is given."""
        return tuple(i for i, c in enumerate(self.model.coordinates) if c.imposed)

    def column(self, path: str) -> int:
        """Index of the parameter with this path in the vector p."""
        return [item.path for item in self.model.all_parameters()].index(path)


@asked
def build(model: Model, keep: bool = True) -> Machine:
    """Lower a checked model to a :class:`Machine`.

    Models of the same structure, whatever the values of their parameters, share their functions. To
    ``keep`` them is to write them to the user's cache, so that the next program need not lower
    them again; what is only tried need not be kept.

    Raises:
        InputError: an FMU without its equations along recordings; the mass matrix is singular at
            the start (names the coordinates without mass), a law that is infinite there, a network
            whose weights cannot be read, or constraints that do not close.
    """
    require_open(model)
    model = assembled(model)
    functions = functions_of(model, keep)
    values = np.array([item.si for item in model.all_parameters()])
    require_sound(model, functions, values)
    return Machine(model=model, values=values, **{"input_matrix": None, **functions})  # type: ignore[arg-type]


def functions_of(
    model: Model, keep: bool = True, opening: Opening = "closed"
) -> dict[str, ca.Function]:
    """The functions of a :class:`Machine` by name, SI; with what switches as inputs and outputs of
    its own if it is opened (:mod:`symhyb.mechanics.opened`)."""
    structure = structure_of(model)
    return kept(("machine", structure, opening), lambda: _from_cache(model, keep, opening))


def _from_cache(model: Model, keep: bool, opening: Opening) -> dict[str, ca.Function]:
    """The functions of a model: those on disk, else lowered, and kept there if that is wanted."""
    if not keep:
        return _lowered(model, opening)
    key = cache.key(structure_of(model), *([] if opening == "closed" else [opening]))
    found = cache.load(key)
    if found is None:
        found = _lowered(model, opening)
        cache.store(key, found)
    return found


def _lowered(model: Model, opening: Opening = "closed") -> dict[str, ca.Function]:
    from symhyb.mechanics.constraints import closures
    from symhyb.mechanics.equations import derive  # SymPy takes half a second to import
    from symhyb.mechanics.opened import banded, levels, opened
    from symhyb.numeric.lowered.translate import Lowered

    fills = {
        element.name: fill_of(element.network, model.file)
        for element in model.elements
        if element.network is not None
    }
    equations = derive(model)
    change = {"switched": opened, "banded": banded}.get(opening)
    low = Lowered(equations if change is None else change(model, equations), fills)
    q, v, a, z, u, t, p = low.q, low.v, low.a, low.z, low.u, low.t, low.p
    n, imposed = q.numel(), [i for i, c in enumerate(model.coordinates) if c.imposed]
    local = None if model.local is None else beside(low, model, model.local)
    if local is not None:
        low.kinetic += local.kinetic
    momentum = ca.cse(ca.gradient(low.kinetic, v))
    mass = ca.cse(ca.jacobian(momentum, v))
    k_c = ca.jtimes(momentum, q, v) + ca.jacobian(momentum, t) - ca.gradient(low.kinetic, q)
    gained, guidance = ca.gradient(low.kinetic, q), low.guidance
    if ca.depends_on(low.kinetic, low.when):
        gained += ca.jacobian(momentum, low.when)  # which what leaves takes along
        parts = [low.kinetic, momentum, mass, k_c, gained, guidance]
        parts = ca.substitute(parts, [low.when], [t])
        low.kinetic, momentum, mass, k_c, gained, guidance = parts
    forces = ca.horzcat(*low.forces) if low.forces else ca.SX(n, 0)
    k_e = -ca.gradient(low.potential, q) + ca.sum2(forces) + guidance
    if local is not None:
        k_e += local.force
    w, b = ca.SX.sym("w", n), ca.SX.sym("b", len(imposed))
    left_out = model.assembly.left_out if model.assembly else ()
    loops = loops_of(low, closures(model, equations.places, equations.symbols), left_out)
    acceleration = solve(mass, k_e + w - k_c, imposed, b, loops).a
    lacking = ca.mtimes(mass, a) + k_c - k_e - w
    if loops is not None:
        carried = solve(mass, k_e + w - k_c, imposed, a[imposed], loops, pulled=False).load
        lacking -= ca.mtimes(loops.slope.T, carried)
    lacking = ca.densify(lacking)
    names = [c.name for c in model.coordinates]
    if loops is None:
        sensed = low.outputs(lacking, names)
    else:
        held = loops.signs * carried
        sensed = low.outputs(ca.vertcat(lacking, held), [*names, *loops.labels])
    rest, outputs = (ca.cse(ca.substitute(part, w, ca.SX.zeros(n))) for part in (lacking, sensed))
    gained += k_e
    fixed_mass, fixed_kinetic = mass, low.kinetic
    if local is not None:
        gained += local.swelling
        fixed_mass, fixed_kinetic = nominal([mass, low.kinetic], u)
    slope = ca.jacobian(k_e, u)
    linear = not ca.depends_on(slope, u) and not ca.depends_on(slope, z)

    def function(
        name: str, arguments: list[ca.SX], results: list[ca.SX], names: str = ""
    ) -> ca.Function:
        dense = [ca.densify(result) for result in results]  # what the buffers expect
        labels = names.split() or [f"i{i}" for i in range(len(arguments))]
        made = [f"o{i}" for i in range(len(results))]
        return ca.Function(name, arguments, dense, labels, made, {"cse": True})

    here, moving = [q, v, z, u, t, p], [q, v, a, z, u, t, p]
    optional = {"input_matrix": function("input_matrix", [q, v, t, p], [slope])} if linear else {}
    if opening == "closed" and frictions(model):
        optional["levels"] = function("levels", here, [low.column(levels(model, equations))])
    if any(state.next for state in model.states):
        optional["sampled"] = function("sampled", here, [low.column(equations.nexts)])
    if loops is not None:
        optional |= lowered_closure(low, loops)
        optional["shared"] = function("shared", [q, t, p], [-ca.jacobian(lacking, w)])
    return optional | {
        "M": function("M", [q, t, p], [fixed_mass], "q t p"),
        "k_c": function("k_c", [q, v, t, p], [k_c], "q v t p"),
        "k_e": function("k_e", here, [k_e], "q v z u t p"),
        "acceleration": function(
            "acceleration",
            [*here, w, b],
            [acceleration],
            "q v z u t p w b",
        ),
        "inner": function("inner", here, [ca.densify(low.inner)], "q v z u t p"),
        "inner_rest": function("inner_rest", [q, v, t, p], [ca.densify(low.rest)], "q v t p"),
        "outputs": function("outputs", moving, [outputs], "q v a z u t p"),
        "sensed": function("sensed", [*moving, w], [sensed]),
        "output_slopes": function(
            "output_slopes", moving, [ca.densify(ca.jacobian(outputs, by)) for by in (q, v, a)]
        ),
        "discrepancy": function("discrepancy", moving, [rest]),
        "weak": function(
            "weak",
            here,
            [ca.densify(momentum), ca.densify(gained)],
        ),
        "energy": function(
            "energy", [q, v, z, t, p], [fixed_kinetic, low.potential, ca.vertcat(*low.stored)]
        ),
        "elements": function("elements", here, [ca.densify(forces)]),
        "carried": function("carried", [q, v, a, t, p], [_carried(low, n)]),
        "pathways": function("pathways", [q, v, t, p], _pathways(low, n)),
    }


def _slopes(function: ca.Function) -> ca.Function:
    """The slopes of a function of a motion (q, v, a, …) by its first three arguments."""
    moving = [ca.SX.sym(f"i{i}", function.sparsity_in(i)) for i in range(function.n_in())]
    rest = function(*moving)
    slopes = [ca.densify(ca.jacobian(rest, by)) for by in moving[:3]]
    return ca.Function(f"{function.name()}_slopes", moving, slopes, {"cse": True})


def _carried(low: "Lowered", n: int) -> ca.SX:
    """−(d/dt ∂T/∂v − ∂T/∂q) of the kinetic energy that each element adds."""
    columns = []
    for energy in low.carried:
        momentum = ca.gradient(energy, low.v)
        pull = ca.jtimes(momentum, low.q, low.v) + ca.jtimes(momentum, low.v, low.a)
        columns.append(ca.gradient(energy, low.q) - pull - ca.jacobian(momentum, low.t))
    return ca.densify(ca.horzcat(*columns)) if columns else ca.SX(n, 0)


def _pathways(low: "Lowered", n: int) -> list[ca.SX]:
    missing = (ca.SX(float("nan")), ca.SX(float("nan")), ca.SX.nan(n, 1))
    rows = [path or missing for path in low.pathways]
    if not rows:
        return [ca.SX(0, 1), ca.SX(0, 1), ca.SX(n, 0)]
    stretch, rate, direction = zip(*rows, strict=True)
    return [ca.vertcat(*stretch), ca.vertcat(*rate), ca.horzcat(*direction)]


def structure_of(model: Model) -> str:
    """All that the functions of a model depend on, as text: everything but the values of
    parameters, and what is said about things. Whether friction switches depends on what has an
    ``sd`` (:func:`symhyb.model.switching.gradual`)."""
    parts = (
        [(c.name, c.imposed) for c in model.coordinates],
        [(s.name, s.rate.tree, s.si_start, s.next and s.next.tree) for s in model.states],
        [p.path for p in model.all_parameters()],
        [(i.name, i.gain is None, i.offset is None) for i in model.inputs],
        [(s.measures.tree, s.gain is None, s.offset is None) for s in model.sensors],
        model.points,
        [replace(body, about="") for body in model.bodies],
        [
            (e.name, e.kind, e.place, [(k, x.tree) for k, x in e.values], e.options, e.network)
            for e in model.elements
        ],
        model.characteristics(),
        [e.given() for e in model.elements],
        [e.name for e in model.elements if gradual(model, e)],
        model.energy,
        model.gravity,
        model.local,
        constraints_key(model),
        model.file if any(e.network for e in model.elements) else "",
        shared_delays(model),
    )
    return repr(parts)

"""A machine, or some of its elements alone, as one function that C code can be made of.

    x', y = f(t, x, u, p)         inner states, the last of x, begin at rest(t, x, u, p)

of elements:     u = q, q' and the recorded inputs that matter, x = z, y = +ΔF: what a host *adds*
of the machine:  u = recorded inputs and imposed motion, x = (q, q', z), y = what the sensors record

With ``events``, laws that jump are in modes (:mod:`symhyb.export.functions.modes`): these are the
last of p, and what indicates them is the last of y.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.errors import InputError, Problem
from symhyb.export.functions.exportable import owners, require_force_elements, require_plain_inputs
from symhyb.export.functions.holes import Hole, Parts, filled, parts_of
from symhyb.export.functions.modes import Modes, Names, calmed
from symhyb.model.bare import bare
from symhyb.model.expression import readings
from symhyb.model.switching import modes as modes_of
from symhyb.model.types import Model
from symhyb.model.unsampled import HOST, require_unsampled
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.lowered.dynamics import StateForm, state_form
from symhyb.numeric.lowered.machine import Machine, build, functions_of

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Exported:
    """What is exported, as functions of (t, x, u, p), SI.

    ``states`` (X), ``inputs`` (U), ``outputs`` (Y) and ``parameters`` (P) say what each entry is:
    (kind, name), kind one of ``q v a u s z y dF trust p``, and with events ``event`` (the last of
    the outputs) and ``mode`` (the last of the parameters). The last ``inner`` states begin at rest,
    declared ones, ``s``, at their start.

    Attributes:
        value: (t, x, u, p) -> x' (X) and y (Y).
        forward: (t, x, u, p, seed (1 + X + U + P)) -> the derivatives of x' and y along the seed.
        adjoint: (t, x, u, p, weights (X + Y)) -> (1 + X + U + P) gradient of the weighted sum.
        rest: (t, x, u, p) -> the inner states of a machine that stands still.
        rest_forward: their derivative along a seed.
        x: where the states start (X,), SI.
        u: where the inputs start (U,), SI.
        p: values of the parameters (P,), SI.
        ways: in how many modes each of the last parameters can be: 2 or 3.
    """

    model: Model
    states: Names
    inputs: Names
    outputs: Names
    parameters: Names
    inner: int
    value: ca.Function
    forward: ca.Function
    adjoint: ca.Function
    rest: ca.Function
    rest_forward: ca.Function
    x: Array
    u: Array
    p: Array
    ways: tuple[int, ...] = ()

    @property
    def indicators(self) -> int:
        """How many of the outputs, the last ones, indicate when a mode has to change."""
        return sum(ways - 1 for ways in self.ways)

    def evaluate(self, t: float, x: Array, u: Array, p: Array) -> tuple[Array, Array]:
        """x' (X,) and y (Y,) at states x (X,), inputs u (U,) and parameters p (P,), SI."""
        rates, y = call(self.value, (t, x, u, p))
        return rates.reshape(-1), y.reshape(-1)

    def dependencies(self) -> tuple[Flags, Flags, Flags]:
        """Which of (x', y), X + Y rows, depend on which of x, u and p: three arrays of flags of
        shapes (X + Y, X), (X + Y, U) and (X + Y, P), dimensionless."""
        rows = [[_flags(self.value, out, by) for out in (0, 1)] for by in (1, 2, 3)]
        x, u, p = (np.vstack(pair) for pair in rows)
        return x, u, p

    def rest_dependencies(self) -> tuple[Flags, Flags, Flags]:
        """The same of the inner states at rest; shapes (z, X), (z, U), (z, P), dimensionless."""
        return _flags(self.rest, 0, 1), _flags(self.rest, 0, 2), _flags(self.rest, 0, 3)


def _flags(function: ca.Function, output: int, argument: int) -> Flags:
    pattern = ca.DM(function.jac_sparsity(output, argument), 1).full()
    return np.asarray(pattern != 0)


def export_elements(model: Model, names: Sequence[str], events: bool = False) -> Exported:
    """The forces of these elements alone, added up for each coordinate; laws that jump are smoothed
    or, with ``events``, in modes.

    Raises:
        InputError: an element whose force cannot be given by positions, speeds and inputs; or what
            :func:`symhyb.numeric.lowered.machine.build` refuses.
    """
    require_force_elements(model, names)
    model = bare(model)
    machine = build(model)
    parts = parts_of(machine, events)
    modes = _modes(model, parts.modes, parts.arguments) if events else None
    chosen = [i for i, element in enumerate(model.elements) if element.name in names]
    belongs = owners(model)
    holes = [hole for hole in parts.holes if hole.name in names]
    forces = ca.sum2(parts.forces[:, chosen])
    memory = _remembered(parts, belongs, forces, names)
    rows = [i for i in range(machine.n) if not forces[i].is_zero()]
    rates, rest = parts.inner[memory], parts.rest[memory]
    y = ca.vertcat(forces[rows], *(hole.trust() for hole in holes))
    deciding = [] if modes is None else [modes.that_matter(ca.vertcat(y, rates)).arguments]
    drawn = ca.vertcat(y, rates, rest, *(hole.inputs for hole in holes), *deciding)
    coordinates, recorded = _names(model)
    where = [("q", parts.q, coordinates), ("v", parts.v, coordinates), ("u", parts.u, recorded)]
    inputs, pieces, starts = _used(where, drawn, _starts(machine))
    outputs = [("dF", coordinates[i]) for i in rows] + [("trust", hole.name) for hole in holes]
    return _exported(
        machine,
        parts.p,
        parts.t,
        parts.z[memory],
        ca.vertcat(*pieces),
        rates,
        y,
        rest,
        holes,
        tuple(belongs[i] for i in memory),
        inputs,
        tuple(outputs),
        np.zeros(len(memory)),
        np.array(starts),
        modes,
    )


def _remembered(
    parts: Parts, belongs: Sequence[tuple[str, str]], forces: ca.SX, names: Sequence[str]
) -> list[int]:
    """Which entries of z go with elements: their own, and declared states on which their ``forces``
    or the rates of what goes with them depend."""
    own = (kind == "z" and name.split(".")[0] in names for kind, name in belongs)
    kept = {i for i, mine in enumerate(own) if mine}
    kept |= set(_columns(forces, parts.z))
    while more := set(_columns(parts.inner[sorted(kept)], parts.z)) - kept:
        kept |= more
    return sorted(kept)


def _modes(model: Model, symbols: ca.SX, arguments: ca.SX) -> Modes:
    named = modes_of(model)
    return Modes(symbols, arguments, tuple(n for n, _ in named), tuple(ways for _, ways in named))


def export_machine(model: Model, events: bool = False) -> Exported:
    """The whole machine: recorded inputs in, what the sensors record out; laws that jump as with
    :func:`export_elements`.

    Raises:
        InputError: an input with a delay or an actuator; or what
            :func:`symhyb.numeric.lowered.machine.build` refuses.
    """
    require_plain_inputs(model)
    require_unsampled(model, "an exported unit", HOST)
    machine = build(model)
    bare, among = _without_networks(machine)
    form = state_form(bare)
    x, d, t = form.symbols()[:3]
    p = ca.SX.sym("p", machine.values.size)
    q, v, _z, u, _b = form.unpack(x, d, p)
    pushed, holes = ca.SX.zeros(machine.n), tuple[Hole, ...]()
    if bare is not machine:
        parts = parts_of(machine).at(q, v, u, t, p)
        holes = parts.holes
        learnt = [i for i, element in enumerate(model.elements) if element.network is not None]
        pushed = ca.sum2(parts.forces[:, learnt])
    names, (free, given) = _names(model), (form.free, form.given)
    modes = None
    if events:
        rates, y, modes = _in_modes(form, x, d, t, p[among], pushed)
    else:
        rates = ca.vertcat(x[len(free) : 2 * len(free), 0], form.rates()(x, d, t, p[among], pushed))
        y, _a = form.outputs()(x, d, t, p[among], pushed)
    starts, still = _starts(machine), np.zeros(len(given))
    at = [(kind, names[0][i]) for kind in "qv" for i in free]
    inputs = [("u", name) for name in names[1]] + [(k, names[0][i]) for k in "qva" for i in given]
    outputs = [("y", s.name) for s in model.sensors] + [("trust", hole.name) for hole in holes]
    begin = [starts["q"][list(free)], starts["v"][list(free)], np.zeros(machine.inner_states)]
    driven = [starts["u"], starts["q"][list(given)], starts["v"][list(given)], still]
    return _exported(
        machine,
        p,
        t,
        x,
        d,
        rates,
        ca.vertcat(y, *(hole.trust() for hole in holes)),
        bare.inner_rest(q, v, t, p[among]),
        holes,
        (*at, *owners(model)),
        tuple(inputs),
        tuple(outputs),
        np.concatenate(begin),
        np.concatenate(driven),
        modes,
    )


def _in_modes(
    form: StateForm, x: ca.SX, d: ca.SX, t: ca.SX, p: ca.SX, w: ca.SX
) -> tuple[ca.SX, ca.SX, Modes]:
    """x', y and the modes of a machine under extra generalized forces w (n)."""
    model = form.machine.model
    banded: dict[str, Any] = {**functions_of(model, opening="banded")}
    machine = replace(form.machine, **banded)
    held = ca.SX.sym("mode", len(modes_of(model)))
    q, v, z, u, b = form.unpack(x, d, p)
    u = ca.vertcat(u, held)
    a = replace(form, machine=machine).accelerations(q, v, z, u, t, p, w, b)
    seen, f = machine.sensed(q, v, a, z, u, t, p, w), list(form.free)
    rates = ca.vertcat(x[len(f) : 2 * len(f), 0], a[f], machine.inner(q, v, z, u, t, p))
    m = len(model.sensors)
    return rates, seen[:m, 0], _modes(model, held, seen[m:, 0])


def _without_networks(machine: Machine) -> tuple[Machine, list[int]]:
    """The machine without its networks, and where its parameters are among those of all.

    Raises:
        InputError: a sensor that measures the force of a network.
    """
    model = machine.model
    learnt = {element.name for element in model.elements if element.network is not None}
    if not learnt:
        return machine, list(range(machine.values.size))
    for sensor in model.sensors:
        if any(learnt & set(reading.names) for reading in readings(sensor.measures)):
            text = "measures the force of a network, which an exported model does not offer"
            raise InputError(Problem(text, f"sensors.{sensor.name}", model.file))
    kept = tuple(element for element in model.elements if element.name not in learnt)
    bare = build(replace(model, elements=kept), keep=False)
    paths = [item.path for item in model.all_parameters()]
    return bare, [paths.index(item.path) for item in bare.model.all_parameters()]


def c_source(exported: Exported, identifier: str) -> str:
    """C99 of all functions: ``model_value`` and so on, each static; CasADi's helpers begin with
    ``identifier``. CasADi states that the code it writes may be used freely."""
    generator = ca.CodeGenerator(f"{identifier}.c", {"with_header": False})
    for function in functions(exported):
        generator.add(function)
    return str(generator.dump())


def functions(exported: Exported) -> tuple[ca.Function, ...]:
    """The functions of an export in the order in which C code holds them."""
    return (
        exported.value,
        exported.forward,
        exported.adjoint,
        exported.rest,
        exported.rest_forward,
    )


def serialised(exported: Exported) -> str:
    """The value function in CasADi's own form, which is unsafe to load where others sent it."""
    return str(exported.value.serialize())


def _exported(
    machine: Machine,
    p: ca.SX,
    t: ca.SX,
    x: ca.SX,
    u: ca.SX,
    rates: ca.SX,
    y: ca.SX,
    rest: ca.SX,
    holes: Sequence[Hole],
    states: Names,
    inputs: Names,
    outputs: Names,
    x0: Array,
    u0: Array,
    modes: Modes | None,
) -> Exported:
    """The functions, with only those parameters that matter; what jumps is smoothed or in modes."""
    x, u, rates, y, rest = (ca.reshape(part, part.numel(), 1) for part in (x, u, rates, y, rest))
    seen = [hole.inputs for hole in holes]
    paths = [item.path for item in machine.model.all_parameters()]
    if modes is not None:
        modes = modes.that_matter(ca.vertcat(rates, y))
        seen.append(modes.arguments)
    used = _columns(ca.vertcat(rates, y, rest, *seen), p)
    kept, names = ca.reshape(p[used], len(used), 1), [("p", paths[i]) for i in used]
    fixed = [i for i in range(len(paths)) if i not in used]
    if fixed:
        held = ca.DM(machine.values[fixed])
        rates, y, rest = ca.substitute([rates, y, rest], [p[fixed]], [held])
    forces = ca.vertcat(*(hole.force for hole in holes)) if holes else ca.SX(0, 1)
    calm = calmed([t, x, u, kept, forces], rates, y, modes)
    rates, y, kept = calm.rates, calm.y, ca.vertcat(kept, calm.more)
    values = [*machine.values[used], *calm.values]
    here = [t, x, u, kept]
    around = ca.Function("around", [*here, forces], [ca.vertcat(rates, y)], {"cse": True})
    if holes:
        whole = filled(around, holes, here, machine.model)
    else:
        whole = ca.Function("whole", [ca.vertcat(*here)], [ca.vertcat(rates, y)], {"cse": True})
    made = _derived(whole, rates.numel(), [part.numel() for part in here])
    rested = ca.Function("rest", [ca.vertcat(*here)], [rest])
    resting = _derived(rested, rest.numel(), [part.numel() for part in here])
    return Exported(
        machine.model,
        states,
        inputs,
        (*outputs, *calm.deciding),
        (*names, *calm.names),
        rest.numel(),
        made["value"],
        made["forward"],
        made["adjoint"],
        _first(resting["value"], "rest"),
        _first(resting["forward"], "rest_forward"),
        x0,
        u0,
        np.array(values),
        calm.ways,
    )


def _derived(whole: ca.Function, first: int, sizes: Sequence[int]) -> dict[str, ca.Function]:
    """Value, forward and adjoint derivative of b -> (x', y) as functions of the parts of b; the
    ``first`` of the results are x'. In scalars where ``whole`` is, else in matrices."""
    kind: Any = ca.SX if whole.is_a("SXFunction") else ca.MX  # the same code for both
    b, rows = kind.sym("b", whole.size1_in(0)), whole.size1_out(0)
    seed, weights = kind.sym("s", b.numel()), kind.sym("w", rows)
    value = whole(b)
    results = {
        "value": ([], value),
        "forward": ([seed], ca.jtimes(value, b, seed)),
        "adjoint": ([weights], ca.jtimes(value, b, weights, True)),
    }
    made = {}
    for name, (more, result) in results.items():
        inside = ca.Function("inside", [b, *more], [ca.densify(result)])
        here = [kind.sym(part, size) for part, size in zip("txup", sizes, strict=True)]
        done = inside(ca.vertcat(*here), *more)
        out = [done] if name == "adjoint" else [done[:first, 0], done[first:, 0]]
        made[name] = ca.Function(f"model_{name}", [*here, *more], out, {"cse": kind is ca.SX})
    return made


def _first(function: ca.Function, name: str) -> ca.Function:
    """The function with its first result alone."""
    arguments = function.sx_in()
    return ca.Function(f"model_{name}", arguments, [function(*arguments)[0]], {"cse": True})


def _names(model: Model) -> tuple[list[str], list[str]]:
    return [c.name for c in model.coordinates], [i.name for i in model.inputs]


def _starts(machine: Machine) -> dict[str, Array]:
    """Where coordinates, speeds and inputs start, SI, arrays (n,), (n,) and (k,)."""
    coordinates = machine.model.coordinates
    return {
        "q": np.array([c.start * c.unit.factor for c in coordinates]),
        "v": np.array([c.start_rate * c.unit.factor for c in coordinates]),
        "u": np.zeros(len(machine.model.inputs)),
    }


def _used(
    groups: Sequence[tuple[str, ca.SX, list[str]]], drawn: ca.SX, starts: dict[str, Array]
) -> tuple[Names, list[ca.SX], list[float]]:
    """The entries that ``drawn`` depends on: their names, symbols and starts."""
    names, pieces, begin = [], [], []
    for kind, symbol, labels in groups:
        for i in _columns(drawn, symbol):
            names.append((kind, labels[i]))
            pieces.append(symbol[i])
            begin.append(float(starts[kind][i]))
    return tuple(names), pieces, begin


def _columns(expression: ca.SX, by: ca.SX) -> list[int]:
    """The entries of ``by`` that ``expression`` depends on."""
    pattern = ca.jacobian_sparsity(expression, by)
    return sorted(set(pattern.get_triplet()[1]))

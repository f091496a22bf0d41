"""A machine, or some of its elements alone, as one function that C code can be made of.

    x', y = f(t, x, u, p)         inner states, the last of x, begin at rest(t, x, u, p)

of elements:     u = q, q' and the recorded inputs that matter, x = z, y = +ΔF: what a host *adds*
of the machine:  u = recorded inputs and imposed motion, x = (q, q', z), y = what the sensors record
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.errors import InputError, Problem
from symhyb.model.types import Model
from symhyb.numeric.buffers import Array, call
from symhyb.numeric.dynamics import state_form
from symhyb.numeric.instructions import NOTHING, UNARY, program
from symhyb.numeric.machine import Machine, build
from symhyb.numeric.network import FADE

SMOOTHING = 1e-3  # SI: width over which a jump of sgn is passed
Names = tuple[tuple[str, str], ...]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Exported:
    """What is exported, as functions of (t, x, u, p), SI.

    ``states`` (X), ``inputs`` (U), ``outputs`` (Y) and ``parameters`` (P) say what each entry is:
    (kind, name), kind one of ``q v a u z y dF trust p``. The last ``inner`` states begin at rest.

    Attributes:
        value: (t, x, u, p) -> x' (X) and y (Y).
        forward: (t, x, u, p, seed (1 + X + U + P)) -> the derivatives of x' and y along the seed.
        adjoint: (t, x, u, p, weights (X + Y)) -> (1 + X + U + P) gradient of the weighted sum.
        rest: (t, x, u, p) -> the inner states of a machine that stands still.
        rest_forward: their derivative along a seed.
        x: where the states start (X,), SI.
        u: where the inputs start (U,), SI.
        p: values of the parameters (P,), SI.
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


def export_elements(model: Model, names: Sequence[str]) -> Exported:
    """The forces of these elements alone, added up for each coordinate.

    Raises:
        InputError: an element whose force cannot be given by positions, speeds and inputs; or what
            :func:`symhyb.numeric.machine.build` refuses.
    """
    _require_force_elements(model, names)
    machine = build(model)
    q, v, t, u, p = _symbols(machine)
    z = ca.SX.sym("z", machine.inner_states)
    chosen = [i for i, element in enumerate(model.elements) if element.name in names]
    forces = ca.sum2(machine.elements(q, v, z, u, t, p)[:, chosen])
    memory = [i for i, name in enumerate(_owners(model)) if name in names]
    rows = [i for i in range(machine.n) if not forces[i].is_zero()]
    trusts = _trusts(model, names, (q, v, u, t, p))
    rates = machine.inner(q, v, z, u, t, p)[memory]
    rest = machine.inner_rest(q, t, p)[memory]
    drawn = ca.vertcat(forces[rows], *trusts.values(), rates, rest)
    labels = _names(model)
    where = [("q", q, labels[0]), ("v", v, labels[0]), ("u", u, labels[1])]
    inputs, pieces, starts = _used(where, drawn, _starts(machine))
    outputs = [("dF", labels[0][i]) for i in rows] + [("trust", name) for name in trusts]
    return _exported(
        machine, p, t, z[memory], ca.vertcat(*pieces), rates,
        ca.vertcat(forces[rows], *trusts.values()), rest,
        tuple(("z", _owners(model)[i]) for i in memory), inputs, tuple(outputs),
        np.zeros(len(memory)), np.array(starts),
    )  # fmt: skip


def export_machine(model: Model) -> Exported:
    """The whole machine: recorded inputs in, what the sensors record out.

    Raises:
        InputError: an input with a delay; or what :func:`symhyb.numeric.machine.build` refuses.
    """
    late = [i.name for i in model.inputs if i.delay is not None and i.delay.si != 0]
    if late:
        text = "has a delay, which the exported model does not hold; let the host delay the signal"
        raise InputError([Problem(text, f"inputs.{name}", model.file) for name in late])
    machine = build(model)
    form = state_form(machine)
    x, d, t, p, _ = form.symbols()
    none = ca.SX.zeros(machine.n)
    free, given = [[labels[i] for i in which] for labels in [_names(model)[0]]
                   for which in (form.free, form.given)]  # fmt: skip
    rates = ca.vertcat(x[len(free) : 2 * len(free)], form.rates()(x, d, t, p, none))
    y, _a = form.outputs()(x, d, t, p, none)
    q = form.unpack(x, d, p)[0]
    trusts = _trusts(model, [e.name for e in model.elements], (q, form.unpack(x, d, p)[1],
                     form.unpack(x, d, p)[3], t, p))  # fmt: skip
    starts = _starts(machine)
    states = [("q", n) for n in free] + [("v", n) for n in free]
    inputs = [("u", item.name) for item in model.inputs]
    inputs += [(kind, name) for kind in "qva" for name in given]
    begin = [starts["q"][i] for i in form.free] + [starts["v"][i] for i in form.free]
    driven = [0.0] * len(model.inputs) + [starts["q"][i] for i in form.given]
    driven += [starts["v"][i] for i in form.given] + [0.0] * len(given)
    return _exported(
        machine, p, t, x, d, rates, ca.vertcat(y, *trusts.values()), machine.inner_rest(q, t, p),
        (*states, *(("z", name) for name in _owners(model))), tuple(inputs),
        (*(("y", s.name) for s in model.sensors), *(("trust", name) for name in trusts)),
        np.array([*begin, *np.zeros(machine.inner_states)]), np.array(driven),
    )  # fmt: skip


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
        exported.value, exported.forward, exported.adjoint, exported.rest, exported.rest_forward
    )  # fmt: skip


def serialised(exported: Exported) -> str:
    """The value function in CasADi's own form, which is unsafe to load from strangers."""
    return str(exported.value.serialize())


def _exported(
    machine: Machine, p: ca.SX, t: ca.SX, x: ca.SX, u: ca.SX, rates: ca.SX, y: ca.SX, rest: ca.SX,
    states: Names, inputs: Names, outputs: Names, x0: Array, u0: Array,
) -> Exported:  # fmt: skip
    """The functions, with only those parameters that matter; jumps of sgn are smoothed."""
    rates, y, rest = (ca.reshape(part, part.numel(), 1) for part in (rates, y, rest))
    paths = [item.path for item in machine.model.all_parameters()]
    used = _columns(ca.vertcat(rates, y, rest), p)
    kept, names = p[used], [("p", paths[i]) for i in used]
    fixed = [i for i in range(len(paths)) if i not in used]
    rates, y, rest = ca.substitute([rates, y, rest], [p[fixed]], [ca.DM(machine.values[fixed])])
    plain = ca.Function("f", [t, x, u, kept], [ca.densify(rates), ca.densify(y)], {"cse": True})
    values = list(machine.values[used])
    width = ca.SX.sym("width")
    smooth = _smoothed(plain, [t, x, u, kept], width)
    if smooth is not None:
        (rates, y), kept = smooth, ca.vertcat(kept, width)
        names.append(("p", "smoothing"))
        values.append(SMOOTHING)
    before = ca.vertcat(t, x, u, kept)
    seed, weights = ca.SX.sym("s", before.numel()), ca.SX.sym("w", rates.numel() + y.numel())
    along = ca.jtimes(ca.vertcat(rates, y), before, seed)
    pulled = ca.jtimes(ca.vertcat(rates, y), before, weights, True)
    here = [t, x, u, kept]
    inner = rest.numel()

    def function(name: str, arguments: list[ca.SX], results: list[ca.SX]) -> ca.Function:
        return ca.Function(f"model_{name}", arguments, [ca.densify(r) for r in results],
                           {"cse": True})  # fmt: skip

    made = [along[: rates.numel()], along[rates.numel() :]]
    return Exported(
        machine.model, states, inputs, outputs, tuple(names), inner,
        function("value", here, [rates, y]),
        function("forward", [*here, seed], made),
        function("adjoint", [*here, weights], [pulled]),
        function("rest", here, [rest]),
        function("rest_forward", [*here, seed], [ca.jtimes(rest, before, seed)]),
        x0, u0, np.array(values),
    )  # fmt: skip


def _smoothed(function: ca.Function, arguments: list[ca.SX], width: ca.SX) -> list[ca.SX] | None:
    """The results with tanh(x/width) for sgn x, None where no sgn occurs; width 0 is exact.

    A solver that meets a jump makes its steps smaller and smaller and stops."""
    steps = program(function)
    if steps is None or ca.OP_SIGN not in steps.operations():
        return None
    held: dict[int, ca.SX] = {value: arguments[a][e] for value, a, e in steps.loads}
    held |= {value: ca.SX(number) for value, number in steps.constants}
    for value, operation, left, right in steps.steps:
        if operation == ca.OP_SIGN:
            soft = ca.tanh(held[left] / ca.fmax(width, 1e-300))
            held[value] = ca.if_else(width > 0, soft, ca.sign(held[left]))
        elif operation in UNARY or right == NOTHING:
            held[value] = ca.SX.unary(operation, held[left])
        else:
            held[value] = ca.SX.binary(operation, held[left], held[right])
    results = [ca.SX(size, 1) for size in steps.results]
    for output, entry, value in steps.stores:
        results[output][entry] = held[value]
    return [ca.densify(result) for result in results]


def _require_force_elements(model: Model, names: Sequence[str]) -> None:
    problems = []
    for element in model.elements:
        if element.name in names and element.kind == "added_mass":
            text = (
                "an added_mass cannot be exported as a force element: its force depends on the "
                "acceleration, which the force itself changes; give the mass to a body of the "
                "host, or export the whole model (--whole)"
            )
            problems.append(Problem(text, f"elements.{element.name}", model.file))
    late = [i.name for i in model.inputs if i.delay is not None and i.delay.si != 0]
    for element in model.elements:
        if element.name not in names:
            continue
        said = repr([value.tree for _, value in element.values]) + repr(element.network)
        for name in late:
            if f"Name(name={name!r}" in said:
                text = f"uses the input {name}, which has a delay; let the host delay the signal"
                problems.append(Problem(text, f"elements.{element.name}", model.file))
    if problems:
        raise InputError(problems)


def _owners(model: Model) -> list[str]:
    """The element that each inner state belongs to."""
    from symhyb.mechanics.symbols import symbols_of  # SymPy takes half a second to import

    return list(symbols_of(model).z)


def _trusts(
    model: Model, names: Sequence[str], at: tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]
) -> dict[str, ca.SX]:
    """For each network 1 inside its trust box, falling to 0 outside as its force does."""
    wanted = {e.name: e.network for e in model.elements if e.network and e.name in names}
    if not wanted:
        return {}
    from symhyb.mechanics.equations import derive
    from symhyb.numeric.translate import Lowered

    seen: dict[str, ca.SX] = {}

    def catching(name: str) -> object:
        def fill(inputs: ca.SX) -> ca.SX:
            seen[name] = inputs
            return ca.SX(0)

        return fill

    low = Lowered(derive(model), {e.name: catching(e.name) for e in model.elements})  # type: ignore[misc]
    symbols = [low.q, low.v, low.u, low.t, low.p]
    result = {}
    for name, network in wanted.items():
        inputs, inside = ca.substitute([seen[name]], symbols, list(at))[0], ca.SX(1)
        for i, (low_edge, high_edge) in enumerate(network.trust):
            beyond = ca.fmax(ca.fmax(low_edge - inputs[i], inputs[i] - high_edge), 0)
            share = 1 - ca.fmin(beyond / (FADE * (high_edge - low_edge)), 1)
            inside = inside * share**2 * (3 - 2 * share)
        result[name] = inside
    return result


def _symbols(machine: Machine) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
    n, k = machine.n, len(machine.model.inputs)
    q, v, u = (ca.SX.sym(name, size) for name, size in (("q", n), ("v", n), ("u", k)))
    return q, v, ca.SX.sym("t"), u, ca.SX.sym("p", machine.values.size)


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

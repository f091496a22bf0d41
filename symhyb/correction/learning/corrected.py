"""A machine with learned corrections: of its forces, or of the rates of its states.

    force    M v' + k_c = k_e + ΔF                    ΔF acts: a host adds it
    rates    x' = f(t, x, u) + Δx',   x = (q, v)      the older, *continuous* formulation

f is the model as a first-order system. Both act on free coordinates; inner states of elements keep
to their own laws. Corrections are functions of q, v, u and t, written in the names of the model.
Sizes: N samples, n coordinates of which f are free, k inputs, R rows (force: f, rates: 2f, first
Δq', then Δv'), T terms, I inputs of a network.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.expression import ExpressionError, names, parse_expression, readings
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.dynamics import StateForm, state_form
from symhyb.numeric.lowered.lengths import at_unit_length
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.network import Weights, force_of
from symhyb.numeric.runs.integrate import Trajectory, drive_at, inner_start, simulate, solve_system
from symhyb.numeric.runs.scenario import Scenario

Formulation = Literal["force", "rates"]


@dataclass(frozen=True, slots=True, eq=False)
class Terms:
    """A sum of terms: ``texts`` are expressions such as ``abs(x')*x'``, ``coefficients`` (R, T) in
    SI."""

    texts: tuple[str, ...]
    coefficients: Array


@dataclass(frozen=True, slots=True, eq=False)
class Networks:
    """A network a row, None for a row that is zero; all see ``inputs``, expressions such as ``x'``,
    and fade outside of ``trust``, a range for each; none is there: they go on outside."""

    inputs: tuple[str, ...]
    rows: tuple[Weights | None, ...]
    trust: tuple[tuple[float, float], ...] = ()


Law = Terms | Networks


@dataclass(frozen=True, slots=True, eq=False)
class Correction:
    """What is added to a model at the level of one ``formulation``: the sum of ``laws``."""

    formulation: Formulation
    laws: tuple[Law, ...]


def rows_of(machine: Machine, formulation: Formulation) -> int:
    """How many numbers a correction of a machine has."""
    return len(machine.free) * (1 if formulation == "force" else 2)


def features(machine: Machine, texts: Sequence[str]) -> ca.Function:
    """(q, v, u, t, p) -> (T,) the values of expressions in coordinates, speeds ``x'``, inputs,
    parameters of the model and ``t``, SI.

    Raises:
        InputError: what is no expression, or names that the model has not.
    """
    from symhyb.mechanics.equations import derive  # SymPy takes half a second to import
    from symhyb.mechanics.symbols import to_sympy
    from symhyb.numeric.lowered.translate import Lowered

    _require_terms(machine.model, texts)
    equations = derive(machine.model)
    low = Lowered(equations)
    scope = equations.symbols.scope
    column = low.column(to_sympy(parse_expression(text), scope) for text in texts)
    here = [low.q, low.v, low.u, low.t, low.p]
    return ca.Function("features", here, [ca.densify(column)], {"cse": True})


def value_of(machine: Machine, law: Law) -> ca.Function:
    """(q, v, u, t, p) -> (R,) one law, SI."""
    texts = law.texts if isinstance(law, Terms) else law.inputs
    seen = features(machine, texts)
    here = seen.sx_in()
    values = seen(*here)
    if isinstance(law, Terms):
        made = ca.mtimes(ca.DM(law.coefficients), values)
    else:
        parts = [ca.SX(0) if w is None else force_of(w, law.trust, values) for w in law.rows]
        made = ca.vertcat(*parts)
    return ca.Function("law", here, [ca.densify(made)], {"cse": True})


def simulate_corrected(
    machine: Machine, scenario: Scenario, correction: Correction | None = None
) -> Trajectory:
    """Integrate a machine with a correction over ``scenario.t`` by CVODES (BDF, relative 1e-8),
    with the parameters of the model; without one the machine alone.

    Raises:
        InputError: a correction with a wrong number of rows, or of a machine with constraints.
        ValueError: an input that stops before the simulation does.
    """
    laws = () if correction is None else correction.laws
    form = state_form(machine)
    _require_rows(machine, correction)
    p = machine.values
    scales = _scales(form, scenario) if scenario.scales is None else scenario.scales
    formulation = "force" if correction is None else correction.formulation
    right = _right(form, [value_of(machine, law) for law in laws], formulation, scales)
    start = form.state(scenario.q, scenario.v, inner_start(machine, scenario, p))
    rows, reason = solve_system(form, scenario, right, start / scales, p)
    d, t = drive_at(form, scenario, p), scenario.t
    q, v = at_unit_length(machine.model, *form.motion(rows * scales, d))
    z = rows[:, 2 * len(form.free) :] * scales[2 * len(form.free) :]
    a = _accelerations(form, right, (rows, d, t, p), scales)
    u = d[:, : form.inputs]
    (y,) = along(machine.outputs, (q, v, a, z, u, t, p), (6,), t.size)
    return Trajectory(t, q, v, a, y, z, reason, model=machine.model)


def _right(
    form: StateForm, laws: Sequence[ca.Function], formulation: Formulation, scales: Array
) -> ca.Function:
    """(y, d, t, p) -> y' for states over their scales."""
    x, d, t, p, _w = form.symbols()
    f, n = len(form.free), form.machine.n
    q, v, _z, u, _b = form.unpack(x, d, p)
    added = ca.SX.zeros(f if formulation == "force" else 2 * f)
    for law in laws:
        added += law(q, v, u, t, p)
    w = ca.SX.zeros(n)
    if formulation == "force":
        w[list(form.free)] = added
    rates = ca.vertcat(x[f : 2 * f, 0], form.rates()(x, d, t, p, w))
    if formulation == "rates":
        rates[: 2 * f] += added
    y = ca.SX.sym("y", form.size)
    (scaled,) = ca.substitute([rates / scales], [x], [y * scales])
    return ca.Function("right", [y, d, t, p], [ca.densify(scaled)], {"cse": True})


def _accelerations(
    form: StateForm, right: ca.Function, given: tuple[Array, Array, Array, Array], scales: Array
) -> Array:
    """v' (N, n) of the corrected system; of imposed coordinates what is given."""
    d, t, f = given[1], given[2], len(form.free)
    (rates,) = along(right, given, (3,), t.size)
    a = np.empty((t.size, form.machine.n))
    a[:, list(form.free)] = (rates * scales)[:, f : 2 * f]
    a[:, list(form.given)] = d[:, form.inputs + 2 * len(form.given) :]
    return a


def _scales(form: StateForm, scenario: Scenario) -> Array:
    """Sizes of the states of the machine alone (X,), SI: those of the corrected one are alike."""
    alone = simulate(form.machine, scenario)
    size = np.nanmax(np.abs(form.state(alone.q, alone.v, alone.z)), axis=0, initial=0.0)
    return np.asarray(np.where(size > 0, size, 1.0))


def _require_terms(model: Model, texts: Sequence[str]) -> None:
    known = {(c.name, order) for c in model.coordinates for order in (0, 1)}
    known |= {(item.name, 0) for item in model.inputs} | {("t", 0)}
    known |= {(item.name, 0) for item in model.parameters}
    listed = [name + "'" * order for name, order in sorted(known)]
    problems = []
    for text in texts:
        try:
            expression = parse_expression(text)
        except ExpressionError as error:
            problems.append(Problem(str(error)))
            continue
        said = [str(reading) for reading in readings(expression)]
        said += [str(x) for x in names(expression) if (x.name, x.order) not in known]
        for name in sorted(said):
            near = did_you_mean(name, listed)
            problems.append(Problem(f"'{name}' in '{text}' is nothing a correction can see{near}"))
    if problems:
        raise InputError(problems)


def _require_rows(machine: Machine, correction: Correction | None) -> None:
    if correction is None:
        return
    if machine.constraints:
        text = "a correction of rates or forces as a formula is not offered with constraints"
        raise InputError(Problem(text, "constraints", machine.model.file))
    wanted = rows_of(machine, correction.formulation)
    for law in correction.laws:
        rows = len(law.coefficients) if isinstance(law, Terms) else len(law.rows)
        if rows != wanted:
            text = f"a correction at the level of {correction.formulation} has {wanted} rows here"
            raise InputError(Problem(f"{text}, not {rows}"))

"""The functions of a monitor in C: those that a block of a source is reduced with.

Sizes: n coordinates, k inputs, m sensors, X states, z inner states, F free parameters, P
parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from symhyb.discrepancy.places.hypotheses import Library
from symhyb.numeric.lowered.dry_steps import step_of
from symhyb.numeric.lowered.dynamics import inner_form
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.steps import rate_slopes, rosenbrock_step
from symhyb.numeric.runs.window_steps import Steps
from symhyb.numeric.runs.windows import WindowModel


@dataclass(frozen=True, slots=True)
class Monitored:
    """The functions of a monitor, each dense, SI; ``p`` are those of the machine but where it says
    otherwise.

        model_sensed: (q, v, a, z, u, t, p) -> what sensors of motion record, its slopes by q, v, a.
        model_pathways: (q, v, t, p) -> rates of places where laws are steep, their directions.
        model_inner_rest, model_inner_step: inner states at rest; after a step along a motion.
        model_tried_rest, model_tried_step: the same of the machine with all causes, and its p.
        model_forces: (q, v, a, z, u, t, p of that) -> (n, C) force of every cause.
        model_step: (x, d0, d1, t, h, p) -> x after h seconds and in the middle.
        model_rate_slopes: (x, d, t, p) -> slopes of the rates by x, free parameters and forces.
        model_sense: (x, d, t, p) -> what sensors record, its slopes by the same.
    """

    functions: tuple[ca.Function, ...]

    def sizes(self) -> dict[str, int]:
        """Of the arrays that a call of any of them needs."""
        every = self.functions
        return {
            "SZ_ARG": max(8, *(f.sz_arg() for f in every)),
            "SZ_RES": max(5, *(f.sz_res() for f in every)),
            "SZ_IW": max(1, *(f.sz_iw() for f in every)),
            "SZ_W": max(1, *(f.sz_w() for f in every)),
        }

    def source(self, identifier: str) -> str:
        """C99 of all functions, each static; helpers begin with ``identifier``."""
        generator = ca.CodeGenerator(f"{identifier}.c", {"with_header": False})
        for function in self.functions:
            generator.add(function)
        return str(generator.dump())


def monitored(
    windows: WindowModel, library: Library, motion: Sequence[int], steep: Sequence[int]
) -> Monitored:
    """The functions of a machine prepared for windows and of all causes; ``motion`` are the sensors
    (their indices) that show the motion, ``steep`` the elements whose places' rates turn over."""
    machine, form = windows.machine, windows.form
    whole = [
        ("model_sensed", _sensed(machine, list(motion))),
        *([("model_pathways", _pathways(machine, list(steep)))] if steep else []),
        *_inner("model_inner", machine),
        *_inner("model_tried", library.machine),
        ("model_forces", _forces(library)),
        ("model_step", step_of(form)),
        ("model_rate_slopes", rate_slopes(form, list(windows.free), True)),
        ("model_sense", Steps(form, list(windows.free)).sense),
    ]
    return Monitored(tuple(_called(name, function) for name, function in whole))


def _called(name: str, function: ca.Function) -> ca.Function:
    """A function under another name, with dense results."""
    given = _arguments(function)
    made = [ca.densify(one) for one in function.call(given)]
    return ca.Function(name, given, made, {"cse": function.is_a("SXFunction")})


def _arguments(function: ca.Function) -> list[Any]:
    kind: Any = ca.SX if function.is_a("SXFunction") else ca.MX
    return [kind.sym(f"i{i}", function.size1_in(i)) for i in range(function.n_in())]


def _sensed(machine: Machine, rows: list[int]) -> ca.Function:
    given = _arguments(machine.outputs)
    y, slopes = machine.outputs(*given), machine.output_slopes.call(given)
    return ca.Function("sensed", given, [y[rows], *(one[rows, :] for one in slopes)])


def _pathways(machine: Machine, elements: list[int]) -> ca.Function:
    given = _arguments(machine.pathways)
    _, rates, ways = machine.pathways.call(given)
    return ca.Function("pathways", given, [rates[elements], ways[:, elements]])


def _inner(name: str, machine: Machine) -> list[tuple[str, ca.Function]]:
    if not machine.inner_states:
        return []
    step = rosenbrock_step(inner_form(machine))
    return [(f"{name}_rest", machine.inner_rest), (f"{name}_step", step)]


def _forces(library: Library) -> ca.Function:
    machine = library.machine
    given = _arguments(machine.elements)  # (q, v, z, u, t, p)
    q, v, z, u, t, p = given
    a = type(q).sym("a", machine.n)
    first = len(machine.model.elements) - sum(map(len, library.columns))
    each = machine.elements(*given) + machine.carried(q, v, a, t, p)
    return ca.Function("forces", [q, v, a, z, u, t, p], [each[:, first:]])

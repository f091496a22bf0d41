"""A run of every shipped model against the DOPRI5 that one writes oneself, at equal accuracy.

The contender is Dormand and Prince's method of order 5 in numba, with the last slope of a step as
the first of the next (FSAL) and dense output of order 4. It is compiled for each machine, with the
number of its states and its parameters as constants: short rates as numba's own code, which becomes
part of every stage, long ones as CasADi writes them in C. Steps end at the samples of a recorded
drive, where its slope jumps. It is told the sizes of the states, which ``simulate`` has to find,
and the loosest relative tolerance of 1, 2, 5·10ⁿ that is as accurate as ``simulate`` at its default
one, or as two runs at 1e-12 and below agree.

All is compiled outside the clock, our rates as well; all return states alone, on their
constraints. CVODES is measured once at our tolerances.
Times are of the processor. Sizes: N outputs, X states, K samples of the drive, D
entries of it, P parameters.

Source: Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I, 2nd ed. 1993, II.4 to
II.6 (the method and its code DOPRI5).
"""

import ctypes
import math
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from numba import njit
from numpy.typing import NDArray
from runs import alone, names, scenario_of, timed
from timing import Row, Work, milliseconds

from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.runs.closing import closed_rows
from symhyb.numeric.runs.cvodes import ABSOLUTE_TOLERANCE, RELATIVE_TOLERANCE
from symhyb.numeric.runs.explicit import bends, field, longest_step, rates_of
from symhyb.numeric.runs.explicit_run import Course, explicit_run
from symhyb.numeric.runs.integrate import begun, found_states

Array = NDArray[np.float64]
# (t (N,), start (X,), times (K,) and values (K, D) of the drive, relative tolerance, absolute (X,))
# -> states (N, X), NaN from where the run stopped; SI
Run = Callable[[Array, Array, Array, Array, float, Array], Array]
PART = "10 s of every model, against a DOPRI5 in numba"
# of chaotic machines and the squeezing mechanism the part, s, in which accuracies can be compared
SECONDS = {"double_pendulum": 3.0, "five_bar": 3.0, "squeezer": 0.5}
SHORT = 150  # instructions
STEPS_MOST = 20_000_000
FAST = {"contract", "reassoc", "arcp", "nsz"}  # what the compiler may do to sums
WRAPPED = """
__attribute__((nonnull)) void rate(double t, const double *x, const double *d, double *slope) {
  const double *given[3] = {x, d, &t};
  double *made[1] = {slope};
  field(given, made, 0, 0, 0);
}
"""
WRITTEN = {
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "{0} + {0}",
    ca.OP_INV: "1.0 / {0}",
    ca.OP_FABS: "abs({0})",
    ca.OP_SQRT: "math.sqrt({0})",
    ca.OP_EXP: "math.exp({0})",
    ca.OP_SIN: "math.sin({0})",
    ca.OP_COS: "math.cos({0})",
    ca.OP_TANH: "math.tanh({0})",
}


def quick(function: Any) -> Any:
    """A function compiled by numba, with all that is favourable."""
    return njit(fastmath=FAST, error_model="numpy")(function)


def rate_of(form: StateForm, p: Array) -> Any:
    """(t, x (X,), d (D,), x' (X,)), which fills the last, for the parameters ``p`` (P,), SI."""
    x, d, t, *_ = form.symbols()
    slopes = rates_of(form)(x, d, t, p)
    function = ca.Function("field", [x, d, t], [slopes], {"cse": True})
    return in_numba(function) or in_c(function)


def in_numba(function: ca.Function) -> Any:
    """The rates as code of numba; None if they are long, or need what is not in ``WRITTEN``."""
    if function.n_instructions() > SHORT:
        return None
    lines = ["def rate(t, x, d, slope):"]
    for k in range(function.n_instructions()):
        operation, to = function.instruction_id(k), function.instruction_output(k)
        given = function.instruction_input(k)
        if operation == ca.OP_OUTPUT:
            lines.append(f"slope[{to[1]}] = v{given[0]}")
        elif operation == ca.OP_INPUT:
            lines.append(f"v{to[0]} = {('x[{}]', 'd[{}]', 't')[given[0]].format(given[1])}")
        elif operation == ca.OP_CONST:
            lines.append(f"v{to[0]} = {function.instruction_constant(k)!r}")
        elif operation in WRITTEN:
            lines.append(f"v{to[0]} = {WRITTEN[operation].format(*(f'v{i}' for i in given))}")
        else:
            return None
    made: dict[str, Any] = {"math": math}
    exec("\n    ".join(lines), made)
    return quick(made["rate"])


def in_c(function: ca.Function) -> Any:
    """The rates as C code that CasADi writes."""
    code = ca.CodeGenerator("field.c")
    code.add(function)
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder) / "field.c", Path(folder) / "field.so"
        source.write_text(code.dump() + WRAPPED, encoding="utf-8")
        flags = ["-O3", "-march=native", "-fno-math-errno", "-fPIC", "-shared"]
        subprocess.run(["cc", *flags, str(source), "-o", str(library), "-lm"], check=True)
        rate = ctypes.CDLL(str(library)).rate
    rate.argtypes, rate.restype = (ctypes.c_double, *(ctypes.c_size_t,) * 3), None

    def called(t, x, d, slope):  # type: ignore[no-untyped-def]
        rate(t, x.ctypes.data, d.ctypes.data, slope.ctypes.data)

    return quick(called)


def dopri5(rate: Any, states: int, drives: int) -> Run:
    """The method for rates, as :func:`rate_of`, of so many states X along so many drives D."""
    n, m = states, drives

    @quick
    def slope(at, a, z, d, times, values, to):  # type: ignore[no-untyped-def]
        if m:
            share = (a - times[at]) / (times[at + 1] - times[at])
            for j in range(m):
                d[j] = values[at, j] + share * (values[at + 1, j] - values[at, j])
        rate(a, z, d, to)

    @quick
    def run(t, start, times, values, relative, absolute):  # type: ignore[no-untyped-def]
        x, y, z, e = np.full((t.size, n), np.nan), start.copy(), np.empty(n), np.empty(n)
        k1, k2, k3, k4 = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
        k5, k6, k7, d = np.empty(n), np.empty(n), np.empty(n), np.empty(m + 1)
        x[0], a, end, wish = start, t[0], t[-1], 1e-3
        row, at, rejected = 1, 0, False
        slope(at, a, y, d, times, values, k1)
        for _ in range(STEPS_MOST):
            if not a < end:
                break
            wall = times[at + 1]
            last = a + 1.01 * wish >= wall
            h = wall - a if last else wish
            for i in range(n):
                z[i] = y[i] + h * (1 / 5) * k1[i]
            slope(at, a + h * (1 / 5), z, d, times, values, k2)
            for i in range(n):
                z[i] = y[i] + h * (3 / 40 * k1[i] + 9 / 40 * k2[i])
            slope(at, a + h * (3 / 10), z, d, times, values, k3)
            for i in range(n):
                z[i] = y[i] + h * (44 / 45 * k1[i] - 56 / 15 * k2[i] + 32 / 9 * k3[i])
            slope(at, a + h * (4 / 5), z, d, times, values, k4)
            for i in range(n):
                z[i] = y[i] + h * (
                    19372 / 6561 * k1[i]
                    - 25360 / 2187 * k2[i]
                    + 64448 / 6561 * k3[i]
                    - 212 / 729 * k4[i]
                )
            slope(at, a + h * (8 / 9), z, d, times, values, k5)
            for i in range(n):
                z[i] = y[i] + h * (
                    9017 / 3168 * k1[i]
                    - 355 / 33 * k2[i]
                    + 46732 / 5247 * k3[i]
                    + 49 / 176 * k4[i]
                    - 5103 / 18656 * k5[i]
                )
            slope(at, a + h, z, d, times, values, k6)
            for i in range(n):
                z[i] = y[i] + h * (
                    35 / 384 * k1[i]
                    + 500 / 1113 * k3[i]
                    + 125 / 192 * k4[i]
                    - 2187 / 6784 * k5[i]
                    + 11 / 84 * k6[i]
                )
            slope(at, a + h, z, d, times, values, k7)
            square = 0.0
            for i in range(n):
                off = h * (
                    71 / 57600 * k1[i]
                    - 71 / 16695 * k3[i]
                    + 71 / 1920 * k4[i]
                    - 17253 / 339200 * k5[i]
                    + 22 / 525 * k6[i]
                    - 1 / 40 * k7[i]
                )
                square += (off / (absolute[i] + relative * max(abs(y[i]), abs(z[i])))) ** 2
            error = np.sqrt(square / n)
            if not error <= 1.0:
                wish = h * max(0.2, 0.9 * error**-0.2) if error < 1e30 else 0.2 * h
                rejected = True
                if a + 0.1 * wish == a:
                    break
                continue
            if not last or rejected or wish <= 1.2 * h:  # a wall makes no step short
                grown = max(0.2, 0.9 * max(error, 1e-10) ** -0.2)
                wish = h * min(1.0 if rejected else 10.0, grown)
            rejected, after = False, wall if last else a + h
            if t[row] < after:
                for i in range(n):
                    e[i] = h * (
                        -12715105075 / 11282082432 * k1[i]
                        + 87487479700 / 32700410799 * k3[i]
                        - 10690763975 / 1880347072 * k4[i]
                        + 701980252875 / 199316789632 * k5[i]
                        - 1453857185 / 822651844 * k6[i]
                        + 69997945 / 29380423 * k7[i]
                    )
            while row < t.size and t[row] < after:
                s = (t[row] - a) / h
                for i in range(n):
                    up = z[i] - y[i]
                    bend = h * k1[i] - up
                    inner = up - h * k7[i] - bend + (1 - s) * e[i]
                    x[row, i] = y[i] + s * (up + (1 - s) * (bend + s * inner))
                row += 1
            if row < t.size and t[row] == after:
                x[row] = z
                row += 1
            a = after
            y, z, k1, k7 = z, y, k7, k1
            if last and at + 2 < times.size:
                at += 1
        return x

    made: Run = run
    return made


def error(x: Array, truth: Array, size: Array) -> float:
    """The largest RMSE of the states (N, X) over their ``size`` (X,)."""
    return float((np.sqrt(((x - truth) ** 2).mean(axis=0)) / size).max())


def beside(works: Mapping[str, Work], repeats: int) -> dict[str, float]:
    """The medians of the times of the processor, s, in turns."""
    times: dict[str, list[float]] = {name: [] for name in works}
    for _ in range(repeats):
        for name, work in works.items():
            before = time.process_time()
            work()
            times[name].append(time.process_time() - before)
    return {name: statistics.median(row) for name, row in times.items()}


def row(name: str, seconds: float = 10.0, repeats: int = 21) -> Row | None:
    """One model; None where nothing moves freely or the run ends early."""
    machine, scenario = scenario_of(name, seconds)
    p = machine.values
    form, scenario, drive, start, reason = begun(machine, scenario, p)
    rates = field(form) if form.size and not reason else None
    if rates is None or not rates.compile():
        return None
    t, nodes = scenario.t, bends(scenario.t_u, drive)

    def ours() -> tuple[Array, str, str, str]:
        return found_states(form, scenario, drive, start, p)

    def closed(x: Array) -> Array:
        return closed_rows(form, scenario, drive, x, p, "")[0]

    def reference(relative: float, longest: float) -> Array:
        course = Course(t, start, p, scenario.t_u, drive, min(longest, longest_step(form)))
        given = relative, relative * ABSOLUTE_TOLERANCE / RELATIVE_TOLERANCE
        return closed(explicit_run(rates, course, size, given, lambda *_: False)[0].x)

    found, reason, *_ = ours()
    if reason:
        return None
    size = np.abs(found).max(axis=0)
    size = np.where(size > 0, size, 1.0)
    truth = reference(1e-12, (t[1] - t[0]) / 4)
    told = error(reference(2e-13, (t[1] - t[0]) / 6), truth, size)
    wrong, run = error(found, truth, size), dopri5(rate_of(form, p), form.size, drive.shape[1])

    def theirs(relative: float) -> Array:
        return closed(run(t, start, *nodes, relative, relative * size))

    tolerances = [a * 10.0**-n for n in range(4, 15) for a in (5, 2, 1)]
    errors = ((tol, error(theirs(tol), truth, size)) for tol in tolerances)
    alike, theirs_wrong = next(
        ((tol, e) for tol, e in errors if e <= max(wrong, 3 * told)), (0.0, math.inf)
    )
    if not alike:
        return None
    works: dict[str, Work] = {
        "ours": ours,
        "theirs": lambda: theirs(alike),
        "closing": lambda: closed(found),
    }
    took = beside(works, repeats)
    others = alone(form, scenario, drive, start, p)
    runs = [timed(others[method], 1) for method in ("bdf", "adams")]
    cvodes = min((seconds for seconds, reason in runs if not reason), default=math.inf)
    note = (
        f"{milliseconds(took['ours'])}; DOPRI5 {milliseconds(took['theirs'])} at rtol {alike:.0e}; "
        f"CVODES {milliseconds(cvodes)}; errors: ours {wrong:.0e}, DOPRI5 {theirs_wrong:.0e}, "
        f"reference {told:.0e}"
    )
    if machine.constraints:
        note += f"; {milliseconds(took['closing'])} of both moves states onto constraints"
    part = "" if seconds == 10.0 else f", {seconds:g} s"
    what = f"{name}{part}: time over the best of CVODES and DOPRI5 at equal accuracy"
    return Row(PART, what, took["ours"] / min(took["theirs"], cvodes), 1.5, False, "×", note)


def rows() -> list[Row]:
    """All models."""
    found = (row(name, SECONDS.get(name, 10.0)) for name in names())
    return [each for each in found if each is not None]

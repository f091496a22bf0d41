"""One integration step as a CasADi function of state, inputs and parameters, and the slopes of the
rates along it.

Windows of a recording are integrated on the grid of its samples. CVODES would restart at every
sample of a recorded input; an L-stable Rosenbrock method with a fixed step does not, and stands
the steep slope of dry friction.

Source: Hairer & Wanner, Solving ODEs II, RODAS4 (order 4, stiffly accurate; order 3 within the
step), with the reduction for second-order systems to as many equations as there are speeds and
inner states.
"""

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from symhyb.numeric.lowered.dynamics import StateForm

_A = (
    (),
    (1.544,),
    (0.9466785280815826, 0.2557011698983284),
    (3.314825187068521, 2.896124015972201, 0.9986419139977817),
    (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950),
    (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0),
)
_C = (
    (),
    (-5.6688,),
    (-2.430093356833875, -0.2063599157091915),
    (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
    (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160),
    (
        8.083246795921522,
        -7.981132988064893,
        -31.52159432874371,
        16.31930543123136,
        -6.058818238834054,
    ),
)
_M = (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0, 1.0)
_WITHIN = (
    (
        10.12623508344586,
        -7.487995877610167,
        -34.80091861555747,
        -7.992771707568823,
        1.025137723295662,
    ),
    (
        -0.6762803392801253,
        6.087714651680015,
        16.43084320892478,
        24.76722511418386,
        -6.594389125716872,
    ),
)
_ALPHA = (0.0, 0.386, 0.21, 0.63, 1.0, 1.0)
_GAMMA = (0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0)
_DIAGONAL = 0.25

Row = dict[int, ca.SX]  # what is not zero in a row of a matrix, by its column


Given = tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]
"""The arguments of a step: x, d0, d1, t, h, p."""
Acting = Callable[[ca.SX, ca.SX, ca.SX], ca.SX]
"""(x, d, t) -> a generalized force (n,) that acts there besides those of the machine, SI."""


@dataclass(frozen=True, slots=True)
class Stepped:
    """A step in symbols: the slopes ``by_q`` and ``by_y`` of the rates of y = (v, z) at x, and x
    ``after`` the step and in its ``middle``."""

    by_q: ca.SX
    by_y: ca.SX
    after: ca.SX
    middle: ca.SX


def rosenbrock_step(form: StateForm) -> ca.Function:
    """Return (x, d0, d1, t, h, p) -> x after h seconds, x = (q, v, z) of length X, SI.

    The drive runs linearly from d0 to d1 over the step (first-order hold). A step with h = 0
    returns x.
    """
    given = arguments(form)
    return ca.Function("step", [*given], [stepped(form, given).after], {"cse": True})


def step_and_middle(form: StateForm) -> ca.Function:
    """The same with x in the middle of the step as a second output."""
    given = arguments(form)
    step = stepped(form, given)
    return ca.Function("step", [*given], [step.after, step.middle], {"cse": True})


def arguments(form: StateForm) -> Given:
    """Fresh symbols for the arguments of a step."""
    x, d0, t, p, _ = form.symbols()
    return x, d0, ca.SX.sym("d1", form.drive), t, ca.SX.sym("h"), p


def stepped(form: StateForm, given: Given, acting: Acting | None = None) -> Stepped:
    """The step in symbols; ``acting`` is what acts along it besides the forces of the machine."""
    f, size = len(form.free), form.size
    x, d0, d1, t, h, p = given
    s, still = ca.SX.sym("s"), ca.SX.zeros(form.machine.n)
    q, y = ca.SX.sym("q", f), ca.SX.sym("y", size - f)  # y = (v, z)
    here = ca.vertcat(q, y), d0 + s * (d1 - d0), t + s * h
    value = form.rates()(*here, p, still if acting is None else acting(*here))
    rate = ca.Function("f", [q, y, s], [value], {"allow_free": True})
    slopes = ca.Function(
        "j", [q, y, s], [ca.jacobian(value, by) for by in (q, y, s)], {"allow_free": True}
    )
    q0, y0 = x[:f, 0], x[f:, 0]
    by_q, by_y, by_s = slopes(q0, y0, 0)
    step = _DIAGONAL * h
    rows = factored(implicit(by_q, by_y, step))
    stages: list[tuple[ca.SX, ca.SX]] = []
    for a, c, alpha, gamma in zip(_A, _C, _ALPHA, _GAMMA, strict=True):
        q_i, y_i = _combined(a, stages, q0, y0)
        past_q, past_y = _combined(c, stages, ca.SX(f, 1), ca.SX(size - f, 1))
        right_q = step * y_i[:f, 0] + _DIAGONAL * past_q
        right_y = step * (rate(q_i, y_i, alpha) + gamma * by_s) + _DIAGONAL * past_y
        dy = solved(rows, right_y + step * ca.mtimes(by_q, right_q))
        stages.append((right_q + step * dy[:f, 0], dy))
    after = ca.vertcat(*_combined(_M, stages, q0, y0))
    bent, more = (ca.vertcat(*_combined(row, stages[:5], 0 * q0, 0 * y0)) for row in _WITHIN)
    middle = (x + after) / 2 + (bent + more / 2) / 4
    return Stepped(by_q, by_y, after, middle)


def implicit(by_q: ca.SX, by_y: ca.SX, step: ca.SX) -> ca.SX:
    """The matrix I − h ∂y'/∂y − h² ∂y'/∂q of a linearly implicit step of h seconds, positions
    eliminated (y = (v, z))."""
    matrix = ca.SX.eye(by_y.shape[0]) - step * by_y
    matrix[:, : by_q.shape[1]] -= step**2 * by_q
    return matrix


def rate_slopes(form: StateForm, free: list[int], forces: bool) -> ca.Function:
    """(x, d, t, p) -> slopes of the rates of v_free and z by x, the ``free`` parameters (columns of
    p) and, if asked for, test ``forces``: (X − n_free, X + F + n), SI."""
    x, d, t, p, w = form.symbols()
    rates = form.rates()(x, d, t, p, w)
    parts = [ca.jacobian(rates, x), ca.jacobian(rates, p[free])]
    parts += [ca.jacobian(rates, w)] if forces else []
    slopes = ca.substitute(ca.densify(ca.horzcat(*parts)), w, 0 * w)
    return ca.Function("rate_slopes", [x, d, t, p], [slopes], {"cse": True})


def _combined(
    factors: tuple[float, ...], stages: list[tuple[ca.SX, ca.SX]], q: ca.SX, y: ca.SX
) -> tuple[ca.SX, ca.SX]:
    """q and y plus the sum of the stages with these factors."""
    for factor, (dq, dy) in zip(factors, stages, strict=True):
        q, y = q + factor * dq, y + factor * dy
    return q, y


def factored(matrix: ca.SX) -> list[Row]:
    """Both triangles of a matrix (n, n) in one, row by row, by Gaussian elimination without
    pivoting: it is I + O(h). Its zeros cost nothing: inner states of different elements do not
    meet."""
    rows: list[Row] = [{} for _ in range(matrix.shape[0])]
    for i, j in zip(*ca.sparsify(matrix).sparsity().get_triplet(), strict=True):
        rows[i][j] = matrix[i, j]
    for j, pivot in enumerate(rows):
        for row in rows[j + 1 :]:
            if j in row:
                factor = row[j] = row[j] / pivot[j]
                for k, value in pivot.items():
                    if k > j:
                        row[k] = row.get(k, ca.SX(0)) - factor * value
    return rows


def solved(rows: list[Row], right: ca.SX) -> ca.SX:
    """The solution (n,) of equations with a factored matrix and a right side (n,)."""
    found = ca.vertsplit(ca.densify(right))
    for i, row in enumerate(rows):
        for j in sorted(j for j in row if j < i):
            found[i] -= row[j] * found[j]
    for i, row in reversed([*enumerate(rows)]):
        for j in sorted(j for j in row if j > i):
            found[i] -= row[j] * found[j]
        found[i] = found[i] / row[i]
    return ca.vertcat(*found)

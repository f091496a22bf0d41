"""One integration step as a CasADi function of state, inputs, parameters and a test force.

Windows of a recording are integrated on the grid of its samples. CVODES would restart at every
sample of a recorded input; an L-stable Rosenbrock method with a fixed step does not, stands
the steep slope of dry friction, and is differentiated exactly.

Source: Hairer & Wanner, Solving ODEs II, RODAS4 (order 4, stiffly accurate), with the n×n
reduction for second-order systems.
"""

import casadi as ca

from symhyb.numeric.machine import Machine

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
    (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136,
     -6.058818238834054),
)  # fmt: skip
_M = (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0, 1.0)
_ALPHA = (0.0, 0.386, 0.21, 0.63, 1.0, 1.0)
_GAMMA = (0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0)
_DIAGONAL = 0.25


def rosenbrock_step(machine: Machine) -> ca.Function:
    """Return (x, u0, u1, t, h, p, w) -> x after h seconds, x = (q, v) of length 2n, SI.

    Inputs run linearly from u0 to u1 over the step (first-order hold); w (n) is an extra
    generalized force, constant over the step. A step with h = 0 returns x.
    """
    n, k, sizes = machine.n, len(machine.model.inputs), machine.values.size
    x, p, w = ca.SX.sym("x", 2 * n), ca.SX.sym("p", sizes), ca.SX.sym("w", n)
    u0, u1 = ca.SX.sym("u0", k), ca.SX.sym("u1", k)
    t, h, s = ca.SX.sym("t"), ca.SX.sym("h"), ca.SX.sym("s")
    q, v = ca.SX.sym("q", n), ca.SX.sym("v", n)
    held = u0 + s * (u1 - u0)
    value = machine.acceleration(q, v, held, t + s * h, p, w)
    force = ca.Function("f", [q, v, s], [value], {"allow_free": True})
    slopes = ca.Function(
        "j", [q, v, s],
        [ca.jacobian(value, q), ca.jacobian(value, v), ca.jacobian(value, s)],
        {"allow_free": True},
    )  # fmt: skip
    q0, v0 = x[:n], x[n:]
    by_q, by_v, by_s = slopes(q0, v0, 0)
    step = _DIAGONAL * h
    matrix = ca.SX.eye(n) - step * by_v - step**2 * by_q
    stages: list[tuple[ca.SX, ca.SX]] = []
    for a, c, alpha, gamma in zip(_A, _C, _ALPHA, _GAMMA, strict=True):
        q_i = q0 + sum((f * dq for f, (dq, _) in zip(a, stages, strict=True)), ca.SX(0))
        v_i = v0 + sum((f * dv for f, (_, dv) in zip(a, stages, strict=True)), ca.SX(0))
        past_q = sum((f * dq for f, (dq, _) in zip(c, stages, strict=True)), ca.SX(0))
        past_v = sum((f * dv for f, (_, dv) in zip(c, stages, strict=True)), ca.SX(0))
        right_q = step * v_i + _DIAGONAL * past_q
        right_v = step * (force(q_i, v_i, alpha) + gamma * by_s) + _DIAGONAL * past_v
        dv = _solve(matrix, right_v + step * ca.mtimes(by_q, right_q))
        stages.append((right_q + step * dv, dv))
    q1 = q0 + sum((m * dq for m, (dq, _) in zip(_M, stages, strict=True)), ca.SX(0))
    v1 = v0 + sum((m * dv for m, (_, dv) in zip(_M, stages, strict=True)), ca.SX(0))
    arguments = [x, u0, u1, t, h, p, w]
    return ca.Function("step", arguments, [ca.vertcat(q1, v1)], {"cse": True})


def _solve(matrix: ca.SX, right: ca.SX) -> ca.SX:
    """Gaussian elimination without pivoting; the matrix is I + O(h)."""
    n = matrix.shape[0]
    matrix, right = ca.SX(matrix), ca.SX(right)
    for j in range(n):
        for i in range(j + 1, n):
            factor = matrix[i, j] / matrix[j, j]
            matrix[i, j:] -= factor * matrix[j, j:]
            right[i] -= factor * right[j]
    for i in reversed(range(n)):
        for j in range(i + 1, n):
            right[i] -= matrix[i, j] * right[j]
        right[i] = right[i] / matrix[i, i]
    return right

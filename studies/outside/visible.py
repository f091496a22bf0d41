"""How clearly a change shows: above the noise, and beyond what simpler causes could absorb.

The model as its file has it is restarted from the true state every second and runs on the recorded
inputs. ``snr`` is the RMS of sensors less model over the noise. ``beyond`` is the same after a
least-squares fit, linear about the model, of everything simple: its uncertain parameters, gain,
offset and delay of every channel, and on every coordinate a constant, a stiffness, a quadratic and
a cubic one, a damper, a drag, dry friction and an added mass. No diagnosis is involved.
"""

from collections.abc import Callable, Iterator

import numpy as np
from machines import uncertain
from scipy.interpolate import CubicSpline
from shared import Array, System, Values

LENGTH = 1.0  # s of a window
SNR_LEAST = 3.0  # at each draw that has something in it
BEYOND_LEAST = 0.5  # where simple causes must not be able to explain it
SMALL = 0.01  # relative size of a difference

Push = Callable[[Array, Array], Array]  # q, v (n, W) -> Q (n, W)


class Windows:
    """The windows of a recording: true states at their beginning, recorded inputs along them."""

    def __init__(self, system: System, t: Array, q: Array, v: Array, u: Array, smooth: bool):
        """t (N,), q and v (n, N), recorded inputs u (k, N), held or smooth between samples."""
        self.system = system
        self.L = round(LENGTH * system.rate)
        self.W = (t.size - 1) // self.L
        first = np.arange(self.W) * self.L
        self.q, self.v, self.h = q[:, first], v[:, first], 1 / system.rate
        self.whole = q, v
        self.index = first[:, None] + np.arange(self.L + 1)
        self.t, self.u, self.smooth = t, u, smooth

    def run(self, p: Values, push: Push | None = None, mass: Array | None = None) -> Array:
        """Coordinates (n, W, L + 1) of the model by Runge and Kutta's method of order 4."""
        return self.driven(self.u, p, push, mass)

    def driven(
        self, u: Array, p: Values, push: Push | None = None, mass: Array | None = None
    ) -> Array:
        """The same under other inputs u (k, N)."""
        middle = self.t[:-1] + self.h / 2
        straight = (u[:, :-1] + u[:, 1:]) / 2
        half = CubicSpline(self.t, u, axis=1)(middle) if self.smooth else straight
        at, q, v, h = u[:, self.index], self.q, self.v, self.h
        between = half[:, self.index[:, :-1]]
        seen = [q]
        for j in range(self.L):
            ends = at[:, :, j], between[:, :, j], between[:, :, j], at[:, :, j + 1]
            dq, dv = np.zeros_like(q), np.zeros_like(v)
            sum_q, sum_v = np.zeros_like(q), np.zeros_like(v)
            for share, weight, force in zip((0, h / 2, h / 2, h), (1, 2, 2, 1), ends, strict=True):
                rate = v + share * dv
                dv = self._accelerate(p, q + share * dq, rate, force, push, mass)
                dq = rate
                sum_q, sum_v = sum_q + weight * dq, sum_v + weight * dv
            q, v = q + h / 6 * sum_q, v + h / 6 * sum_v
            seen.append(q)
        return np.stack(seen, axis=-1)

    def _accelerate(
        self, p: Values, q: Array, v: Array, u: Array, push: Push | None, mass: Array | None
    ) -> Array:
        Q = self.system.forces(p, q, v, u).sum(axis=0)
        M = self.system.mass(p, q)
        if push is not None:
            Q = Q + push(q, v)
        if mass is not None:
            M = M + mass[:, :, None]
        if self.system.n == 1:
            return np.asarray(Q / M[0])
        return np.asarray(np.linalg.solve(np.moveaxis(M, -1, 0), Q.T[:, :, None])[:, :, 0].T)


def _forces(system: System, q: Array, v: Array, known: Array) -> Iterator[Push]:
    """Small forces of the simple laws on every coordinate."""
    for i in range(system.n):
        slow = 0.1 * float(v[i].std())
        for law in (
            lambda s, w: np.ones_like(s),
            lambda s, w: s,
            lambda s, w: s**2,
            lambda s, w: s**3,
            lambda s, w: w,
            lambda s, w: np.abs(w) * w,
            lambda s, w, slow=slow: np.tanh(w / slow),
        ):
            size = SMALL * float(known[i]) / float(np.sqrt(np.mean(law(q[i], v[i]) ** 2)))

            def push(
                q: Array, v: Array, i: int = i, law: Callable = law, size: float = size
            ) -> Array:
                Q = np.zeros_like(q)
                Q[i] = size * law(q[i], v[i])
                return Q

            yield push


def _columns(windows: Windows, p: Values, known: Array, y: Array) -> Iterator[Array]:
    """Differences (n, W, L + 1) that simple causes make to the run y of the model."""
    system, u = windows.system, windows.u
    for name, (value, _) in uncertain(system).items():
        yield windows.run({**p, name: value * (1 + SMALL)}) - y
    for push in _forces(system, *windows.whole, known):
        yield windows.run(p, push) - y
    M = system.mass(p, windows.q).mean(axis=-1)
    for i in range(system.n):
        e = np.eye(system.n)[i]
        yield windows.run(p, mass=SMALL * M[i, i] * np.outer(e, e)) - y
    for k in range(u.shape[0]):
        rate = np.gradient(u[k], windows.t)
        for change in (u[k], np.full_like(u[k], u[k].std()), rate * u[k].std() / rate.std()):
            other = u.copy()
            other[k] = u[k] + SMALL * change
            yield windows.driven(other, p) - y
    for i in range(system.n):
        for shape in (y[i], np.ones_like(y[i]), np.gradient(y[i], axis=-1)):
            column = np.zeros_like(y)
            column[i] = shape
            yield column


def visibility(
    windows: Windows, p: Values, known: Array, shown: Array, sd: Array
) -> tuple[float, float]:
    """``snr`` and ``beyond`` of the sensors without noise ``shown`` (n, N), noise sd (n,)."""
    y = windows.run(p)
    weight = 1 / sd[:, None, None]
    left = ((shown[:, windows.index] - y) * weight).ravel()
    columns = np.array([(column * weight).ravel() for column in _columns(windows, p, known, y)])
    size = np.linalg.norm(columns, axis=1)
    columns = columns[size > 0] / size[size > 0, None]
    found = np.linalg.lstsq(columns.T, left, rcond=1e-10)[0]
    rest = left - columns.T @ found
    return float(np.sqrt(np.mean(left**2))), float(np.sqrt(np.mean(rest**2)))

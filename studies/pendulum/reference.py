"""What SciPy alone makes of the recordings: the values that expected.json states.

Nothing of symhyb but the place of the files is used.

python studies/pendulum/reference.py single            # every structure, on two thirds and on all
python studies/pendulum/reference.py double

The single pendulum is one swing with one initial state and exact dry friction: it is simulated
from reversal to reversal, with the derivatives by every number beside it. At a reversal the
derivatives of the speed are multiplied by the ratio of the accelerations after and before.

    phi'' + w2 sin phi + c1 phi' + c2 |phi'| phi' + (c0 + cs exp(-(phi'/vs)^2)) sgn phi' = 0

The double pendulum is simulated in the pieces it is published in, 2.667 s each with an initial
state of its own, all at once; dry friction is a tanh of the rate over 0.02 rad/s.
"""

import argparse
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import cos, exp, pi, sin

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.io import loadmat
from scipy.optimize import least_squares, lsq_linear

from symhyb.data.datasets import fetch

Array = NDArray[np.float64]
LEARNED = 36.6675  # s: where the published pieces to fit end
NUMBERS = ("w2", "c0", "c1", "c2", "cs", "vs", "phi", "rate", "zero")
SIZES = dict(zip(NUMBERS, (0.1, 0.05, 0.01, 2e-3, 0.05, 0.2, 0.01, 0.05, 2e-3), strict=True))
FIRST = {"c0": 0.15, "c1": 0.03, "c2": 5e-3, "cs": 0.05, "vs": 2.0}
ALONE = 0.07  # c1, where it is the only loss
SLOWEST = 0.5  # rad/s: a Stribeck speed below that is passed within a few samples
SINGLE = (
    ("c1",),
    ("c0", "c1"),
    ("c1", "c2"),
    ("c0", "c2"),
    ("c0", "c1", "c2"),
    ("c0", "cs", "vs", "c2"),
)


@dataclass(frozen=True)
class Fit:
    """Numbers by name and what they leave, RMS in mrad: in what was ``fitted``, over the ``whole``
    recording and after what was fitted (``unseen``), both in one free run."""

    numbers: dict[str, float]
    fitted: float
    whole: float = field(default=float("nan"))
    unseen: float = field(default=float("nan"))


def pieces(file: str, row: int) -> tuple[list[Array], list[Array]]:
    """Times and one row (0: the angle) of all published pieces, those to fit first, less pi."""
    data = loadmat(fetch("pendulum", file))
    cells = [*data["Time_id"].ravel(), *data["Time_vad"].ravel()]
    angles = [*data["Y_id"].ravel(), *data["Y_vad"].ravel()]
    return [one.ravel() for one in cells], [one[row] - pi for one in angles]


def swing(every: int = 20) -> tuple[Array, Array]:
    """The single pendulum: times in s and angles in rad of the whole swing, every 20th sample."""
    t, phi = pieces("SinglePendulumDataForParameterEstimation.mat", 0)
    return np.concatenate(t)[::every], np.concatenate(phi)[::every]


def simulated(p: dict[str, float], t: Array) -> tuple[Array, Array]:
    """The angle (N,) at ``t`` and its derivatives (N, 9) by ``NUMBERS``."""
    w2, c0, c1, c2, cs, vs = (p[name] for name in NUMBERS[:6])
    count = 8

    def rates(z: Array, side: float) -> Array:
        phi, v = z[0], z[1]
        bump = exp(-((v / vs) ** 2))
        out = np.empty_like(z)
        out[0] = v
        out[1] = -w2 * sin(phi) - c1 * v - c2 * abs(v) * v - side * (c0 + cs * bump)
        place, speed = z[2 : 2 + count], z[2 + count :]
        out[2 : 2 + count] = speed
        by_v = -c1 - 2 * c2 * abs(v) + 2 * side * cs * bump * v / vs**2
        own = out[2 + count :]
        own[:] = -w2 * cos(phi) * place + by_v * speed
        own[:6] -= (sin(phi), side, v, abs(v) * v, side * bump, 2 * side * cs * bump * v**2 / vs**3)
        return out

    z = np.zeros(2 + 2 * count)
    z[:2] = p["phi"], p["rate"]
    z[2 + 6] = z[2 + count + 7] = 1.0
    side = 1.0 if p["rate"] >= 0 else -1.0
    out, now, done = np.empty((t.size, 1 + count)), t[0], 0
    shown = [0, *range(2, 2 + count)]
    while done < t.size:

        def reversal(_: float, z: Array) -> float:
            return float(z[1])

        reversal.terminal, reversal.direction = True, -side  # type: ignore[attr-defined]
        run = solve_ivp(
            lambda _, z, side=side: rates(z, side),
            (now, t[-1]),
            z,
            "DOP853",
            rtol=1e-9,
            atol=1e-10,
            events=reversal,
            dense_output=True,
            first_step=min(0.02, (t[-1] - now) / 2),
        )
        end = int(np.searchsorted(t, run.t[-1], side="right"))
        if end > done:
            out[done:end] = run.sol(t[done:end])[shown].T
        done, now, z = end, run.t[-1], run.y[:, -1].copy()
        if run.status == 0 or now >= t[-1]:
            break
        before, z[1], side = rates(z, side)[1], 0.0, -side
        after = rates(z, side)[1]
        if after * side <= 0:  # it sticks
            out[done:] = z[shown]
            break
        z[2 + count :] *= after / before
    return out[:, 0] + p["zero"], np.column_stack([out[:, 1:], np.ones(t.size)])


def single(free: Sequence[str], until: float = 60.0, negative: bool = False) -> Fit:
    """Fit the coefficients ``free`` beside w2, the zero of the angle and the initial state, from
    the start to ``until`` in s, first to 6, 15 and 30 s; not below 0 unless ``negative``."""
    t, phi = swing()
    start = {**dict.fromkeys(NUMBERS, 0.0), "w2": 64.2, "phi": phi[0], "vs": 2.0}
    start["rate"] = (phi[1] - phi[0]) / (t[1] - t[0]) + 32.0 * sin(phi[0]) * (t[1] - t[0])
    start |= {name: FIRST[name] for name in free}
    if tuple(free) == ("c1",):
        start["c1"] = ALONE
    names = ["w2", "phi", "rate", "zero", *free]
    sizes = np.array([SIZES[name] for name in names])
    least = {"vs": SLOWEST} | ({} if negative else dict.fromkeys(("c0", "c1", "c2", "cs"), 0.0))
    lower = np.array([least.get(name, -np.inf) for name in names]) / sizes
    for span in (6.0, 15.0, 30.0, until):
        part = t <= min(span, until)
        left, slopes = _problem(start, names, t[part], phi[part])
        first = np.maximum([start[name] for name in names] / sizes, lower + 1e-9)
        found = least_squares(left, first, slopes, (lower, np.inf), max_nfev=40)
        start |= dict(zip(names, (found.x * sizes).tolist(), strict=True))
    error = 1e3 * (simulated(start, t)[0] - phi)
    fitted, unseen = error[t <= until], error[t > until]
    numbers = {name: start[name] for name in names}
    return Fit(numbers, _rms(fitted), _rms(error), _rms(unseen) if unseen.size else float("nan"))


def _problem(
    start: dict[str, float], names: Sequence[str], t: Array, phi: Array
) -> tuple[Callable[[Array], Array], Callable[[Array], Array]]:
    """What numbers ``names``, in units of their ``SIZES``, leave (N,) and its slopes (N, P)."""
    columns = [NUMBERS.index(name) for name in names]
    sizes = np.array([SIZES[name] for name in names])
    last: dict[bytes, tuple[Array, Array]] = {}

    def both(x: Array) -> tuple[Array, Array]:
        if x.tobytes() not in last:
            last.clear()
            p = {**start, **dict(zip(names, x * sizes, strict=True))}
            angle, slopes = simulated(p, t)
            last[x.tobytes()] = angle - phi, slopes[:, columns] * sizes
        return last[x.tobytes()]

    return lambda x: both(x)[0], lambda x: both(x)[1]


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


LINKS = {"J1": 1e-5, "J2": 1e-5, "E": 1e-3, "C": 1e-3, "zero1": 1e-3, "zero2": 1e-3}
LOSSES = {"viscous": 1e-5, "dry": 2e-5, "drag": 1e-6}  # both with steps for slopes
BEGIN = {"viscous": 1e-4, "dry": 3e-4, "drag": 5e-6}
DOUBLE = (
    ("viscous1", "viscous2"),
    ("dry1", "viscous2"),
    ("dry1", "dry2"),
    ("dry1", "dry2", "viscous1"),
    ("dry1", "dry2", "drag1"),
    ("dry1", "dry2", "drag3"),
    ("dry1", "dry2", "viscous3"),
    ("dry1", "dry2", "viscous1", "drag1", "viscous3", "drag3"),
)


def published() -> dict[str, float]:
    """The published numbers of the double pendulum, in the order of its authors' fit, SI."""
    file = fetch("pendulum", "EstimatedParameters_DoublePendulum.mat")
    values = loadmat(file)["EstimatedParameters"].ravel()
    names = ("m1", "m2", "a1", "a2", "l", "J1", "J2", "k1", "k2", "g")
    return dict(zip(names, map(float, values), strict=True))


def accelerations(z: Array, p: dict[str, Array], known: dict[str, float]) -> Array:
    """The rates of (angle 1, angle 2, rate 1, rate 2), angles from the vertical. Losses: 1 in the
    pivot, 2 in the joint between the arms, which turns by the difference, 3 on the lower arm
    against the air. ``E`` and ``C`` scale the weight of the lower arm and the coupling."""
    a, b, u, v = z
    own = p["J1"] + known["m1"] * known["a1"] ** 2 + known["m2"] * known["l"] ** 2
    low = p["J2"] + known["m2"] * known["a2"] ** 2
    both = known["m2"] * known["l"] * known["a2"] * p["C"]
    weight = (known["m1"] * known["a1"] + known["m2"] * known["l"]) * known["g"]
    below = known["m2"] * known["a2"] * known["g"] * p["E"]

    def loss(rate: Array, joint: str) -> Array:
        dry = p["dry" + joint] * np.tanh(rate / 0.02)
        return dry + (p["viscous" + joint] + p["drag" + joint] * np.abs(rate)) * rate

    c, s, inner = both * np.cos(a - b), both * np.sin(a - b), loss(v - u, "2")
    first = -s * v * v - weight * np.sin(a) - loss(u, "1") + inner
    second = s * u * u - below * np.sin(b) - inner - loss(v, "3")
    det = own * low - c * c
    return np.array([u, v, (low * first - c * second) / det, (own * second - c * first) / det])


def double(free: Sequence[str], chosen: slice = slice(0, 26), rounds: int = 8) -> Fit:
    """Fit the losses ``free``, not below 0, beside the links and the zeros of both angles, to the
    published pieces ``chosen``, each from an initial state of its own."""
    file, known = "DoublePendulumDataForParameterEstimation.mat", published()
    rows = [[one[:2658] for one in pieces(file, row)[1][chosen]] for row in range(4)]
    angles = np.array([np.array(row)[:, ::10] for row in rows[:2]])  # (2, K, T), 10 ms
    z = np.array([np.array(row)[:, 0] + (pi if i > 1 else 0.0) for i, row in enumerate(rows)])
    names = [*LINKS, *free]
    losses = [f"{kind}{place}" for kind in LOSSES for place in (1, 2, 3)]
    p = dict.fromkeys((*LINKS, *losses), 0.0) | {k: known[k] for k in ("J1", "J2")}
    steps = [LINKS.get(name) or LOSSES[name[:-1]] for name in names]
    p |= {"E": 1.0, "C": 1.0} | {name: BEGIN[name[:-1]] for name in free}
    nudges, count = np.array([1e-4, 1e-4, 1e-3, 1e-3]), len(names)
    for _ in range(rounds):
        each = {name: np.full((1 + count + 4, 1), p[name]) for name in p}
        start = np.repeat(z[:, None, :], 1 + count + 4, axis=1)
        for i, name in enumerate(names):
            each[name][1 + i] += steps[i]
        for i, nudge in enumerate(nudges):
            start[i, 1 + count + i] += nudge
        shown = np.array(list(_runs(start, each, known, angles.shape[2])))  # (T, 2, copies, K)
        shown = shown.transpose(1, 2, 3, 0) + np.array([each["zero1"], each["zero2"]])[..., None]
        left = shown[:, 0] - angles
        by = [(shown[:, 1 + i] - shown[:, 0]) / steps[i] for i in range(count)]
        by_start = [(shown[:, 1 + count + i] - shown[:, 0]) / nudges[i] for i in range(4)]
        step, back = _step(left, np.array(by), np.array(by_start), p, names)
        p |= {name: p[name] + float(d) for name, d in zip(names, step, strict=True)}
        z = z + back
    return Fit({name: p[name] for name in names}, 1e3 * _rms(left))


def _runs(z: Array, p: dict[str, Array], known: dict[str, float], count: int) -> Iterator[Array]:
    """Angles every 10 ms by the classical Runge-Kutta method at 1 ms."""
    h = 1e-3
    for k in range(10 * (count - 1) + 1):
        if k % 10 == 0:
            yield z[:2]
        one = accelerations(z, p, known)
        two = accelerations(z + h / 2 * one, p, known)
        three = accelerations(z + h / 2 * two, p, known)
        four = accelerations(z + h * three, p, known)
        z = z + h / 6 * (one + 2 * two + 2 * three + four)


def _step(
    left: Array, by: Array, by_start: Array, p: dict[str, float], names: Sequence[str]
) -> tuple[Array, Array]:
    """A Gauss-Newton step of the numbers, losses not below 0, and of the initial states (4, K)."""
    count, parts = len(names), []
    rows, wanted = [], []
    for k in range(left.shape[1]):
        a, b = by[:, :, k].reshape(count, -1).T, by_start[:, :, k].reshape(4, -1).T
        q, r = np.linalg.qr(b)
        e = left[:, k].ravel()
        rows.append(a - q @ (q.T @ a))
        wanted.append(-(e - q @ (q.T @ e)))
        parts.append((a, q, r, e))
    matrix = np.vstack(rows)
    size = np.sqrt(np.sum(matrix**2, axis=0))
    lower = [
        -p[n] * s - 1e-12 if n not in LINKS else -np.inf for n, s in zip(names, size, strict=True)
    ]
    step = lsq_linear(matrix / size, np.concatenate(wanted), (lower, np.inf)).x / size
    back = [-np.linalg.solve(r, q.T @ (e + a @ step)) for a, q, r, e in parts]
    return step, np.array(back).T


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pendulum", choices=("single", "double"))
    if parser.parse_args().pendulum == "double":
        for chosen in (slice(10, 20), slice(0, 26)):
            print(f"pieces {chosen.start + 1} to {chosen.stop}")
            for free in DOUBLE:
                _say(free, double(free, chosen))
        return
    for until in (LEARNED, 60.0):
        print(f"from 0 s to {min(until, 55.0):.1f} s")
        for free in SINGLE:
            _say(free, single(free, until))
        _say(("c0", "c1", "c2", "also negative"), single(("c0", "c1", "c2"), until, True))


def _say(free: Sequence[str], fit: Fit) -> None:
    values = ", ".join(f"{name} {value:.5g}" for name, value in fit.numbers.items())
    runs = f"whole {fit.whole:.2f}, unseen {fit.unseen:.2f}"
    print(f"{' + '.join(free)}: fitted {fit.fitted:.2f} mrad, {runs} ({values})", flush=True)


if __name__ == "__main__":
    main()

"""What is recorded: dry friction on one coordinate, by Dormand–Prince, with exact reversals.

    M(q) a = F(t, q, v) − F_c sgn(v_0) e_0        while coordinate 0 slides
    v_0 = 0                                       while |what pulls there| ≤ F_c

Between reversals SciPy's DOP853 at relative 1e-12; reversals, and where a mass that sticks is torn
off, are located. NumPy and SciPy alone: nothing of symhyb is used to make what it is tried on.

    wall |--cubic spring--[ m ]--> q       m q'' + c q^3 = F sin(2 pi f t) − dF,   F e.g. 5 N
                                           dF = d |q'| q' + m g mu sgn(q')
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
G = 9.81  # m/s²
STEP = 0.01  # s, between samples
END = 20.0  # s
TOLERANCE = 1e-12
FIRST = 1e-4  # s: first step after a reversal
HOLDS = 1 + 1e-9  # of the friction: what is torn off must slide, whatever the rounding
NOISE = 0.015  # of the largest value of a channel
TRAINED_ON = 0.7  # of the samples, drawn at random
UNSTEADY = (
    100.0  # growth of a perturbation of the start of 1e-6: beyond, no run can be distinguished
)


@dataclass(frozen=True, slots=True)
class Plant:
    """``mass`` q -> (n, n), ``force`` (t, q, v) -> (n,) all but dry friction ``coulomb`` in N on
    coordinate 0. SI."""

    mass: Callable[[Array], Array]
    force: Callable[[float, Array, Array], Array]
    coulomb: float


@dataclass(frozen=True, slots=True)
class Drive:
    """A force in N: ``amplitude`` times a sine of ``frequency`` Hz, or a step if that is 0."""

    amplitude: float
    frequency: float

    def __call__(self, t: float) -> float:
        if self.frequency == 0:
            return self.amplitude
        return float(self.amplitude * np.sin(2 * np.pi * self.frequency * t))


@dataclass(frozen=True, slots=True)
class Oscillator:
    """The oscillator of the paper: mass m kg, cubic stiffness c N/m³, missing drag d N·s²/m² and
    friction coefficient mu, start q0 m, and the drive that it is recorded under."""

    m: float
    c: float
    d: float
    mu: float
    q0: float
    drive: Drive

    @property
    def coulomb(self) -> float:
        return self.m * G * self.mu

    def missing(self, v: Array) -> Array:
        """ΔF (N,), the force that the model lacks, at speeds (N,)."""
        return -self.d * np.abs(v) * v - self.coulomb * np.sign(v)

    def plant(self, drive: Drive, complete: bool = True) -> Plant:
        """The machine under a drive, with or without what the model lacks."""
        d = self.d if complete else 0.0
        mass = np.array([[self.m]])

        def force(t: float, q: Array, v: Array) -> Array:
            return drive(t) - self.c * q**3 - d * np.abs(v) * v

        return Plant(lambda q: mass, force, self.coulomb if complete else 0.0)


Run = tuple[Array, Array, Array]  # q, v, a, each (N, n)


def simulate(plant: Plant, t: Array, q: Array, v: Array, tolerance: float = TOLERANCE) -> Run:
    """q, v, a (N, n) at times ``t`` (N,) from a start (n,), SI."""
    n, here = q.size, np.concatenate([q, v]).astype(float)
    rows = np.empty((t.size, 3 * n))
    now, side, first = float(t[0]), _side(plant, t[0], here, n), 0
    while first < t.size:

        def rate(s: float, y: Array, side: int = side) -> Array:
            return np.concatenate([y[n:], _pull(plant, s, y, side)[0]])

        def turns(s: float, y: Array, side: int = side) -> float:
            if side:
                return side * float(y[n])
            return HOLDS * plant.coulomb - abs(_pull(plant, s, y, 0)[1])

        turns.terminal, turns.direction = True, -1  # type: ignore[attr-defined]
        run = solve_ivp(
            rate,
            (now, float(t[-1])),
            here,
            "DOP853",
            dense_output=True,
            rtol=tolerance,
            atol=tolerance,
            events=turns if plant.coulomb else None,
            max_step=0.02,
            # a reversal right after one must not fall into the same step
            first_step=min(FIRST, float(t[-1]) - now) if float(t[-1]) > now else None,
        )
        if run.t[-1] <= now and first < t.size - 1:
            raise RuntimeError(f"no progress at {now:.9g} s")
        last = int(np.searchsorted(t, run.t[-1], "right"))
        for i in range(first, last):
            y = run.sol(t[i])
            if plant.coulomb and side == 0:
                y[n] = 0.0
            rows[i] = np.concatenate([y, _pull(plant, t[i], y, side)[0]])
        first, now, here = last, float(run.t[-1]), run.y[:, -1].copy()
        if plant.coulomb:
            here[n] = 0.0
            side = _side(plant, now, here, n, torn=side == 0)
    return rows[:, :n], rows[:, n : 2 * n], rows[:, 2 * n :]


def _pull(plant: Plant, t: float, y: Array, side: int) -> tuple[Array, float]:
    """Acceleration (n,), and what pulls at coordinate 0 where it is held (side 0)."""
    n = y.size // 2
    mass, force = plant.mass(y[:n]), plant.force(t, y[:n], y[n:])
    if side or not plant.coulomb:
        force = force.copy()
        force[0] -= plant.coulomb * side
        return (force / mass[0] if n == 1 else np.linalg.solve(mass, force)), 0.0
    a = np.zeros(n)
    if n > 1:
        a[1:] = np.linalg.solve(mass[1:, 1:], force[1:])
    return a, float(force[0] - mass[0] @ a)


def _side(plant: Plant, t: float, y: Array, n: int, torn: bool = False) -> int:
    """Where coordinate 0 slides to: 1, −1, or 0 if it is held."""
    if not plant.coulomb:
        return 0
    if y[n] != 0:
        return int(np.sign(y[n]))
    pull = _pull(plant, t, y, 0)[1]
    return int(np.sign(pull)) if torn or abs(pull) > HOLDS * plant.coulomb else 0


def growth(plant: Plant, t: Array, q: Array, v: Array) -> float:
    """How much a perturbation of the start by 1e-6 of coordinate 0 grows at most, dimensionless."""
    near = q.copy()
    near[0] += 1e-6
    runs = [simulate(plant, t, start, v, 1e-9)[0] for start in (near, q)]
    return float(np.abs(runs[1] - runs[0]).max() / 1e-6)


def times(end: float = END) -> Array:
    return np.arange(round(end / STEP) + 1) * STEP


def drives(drive: Drive) -> dict[str, Drive]:
    """The excitations that are tried: the one learned from, and others."""
    return {
        "as recorded": drive,
        "amplitude × 1.5": replace(drive, amplitude=1.5 * drive.amplitude),
        "amplitude × 0.6": replace(drive, amplitude=0.6 * drive.amplitude),
        "frequency × 1.4": replace(drive, frequency=1.4 * drive.frequency),
        "frequency × 0.7": replace(drive, frequency=0.7 * drive.frequency),
        "step": replace(drive, frequency=0.0),
    }


@dataclass(frozen=True, slots=True)
class Drawn:
    """A set of parameters: the ``seed`` that drew it, the machine, how many draws before it were
    ``discarded`` because a perturbation grows along one of the excitations."""

    seed: int
    machine: Oscillator
    discarded: int


def draw(seed: int) -> Drawn:
    """The parameter set of a seed; set 0 is that of the first trials (m = 1, c = 5, F = 5 …)."""
    rng, discarded = np.random.default_rng([seed, 7]), 0
    while True:
        m, f = float(np.exp(rng.uniform(np.log(0.5), np.log(2.0)))), rng.uniform(0.6, 1.4)
        drive = Drive(m * rng.uniform(3, 7), f)
        c, d, mu = m * rng.uniform(3, 10), m * rng.uniform(0.1, 0.5), rng.uniform(0.01, 0.04)
        it = Oscillator(m, c, d, mu, rng.uniform(0.3, 0.7), drive)
        if seed == 0:
            it = Oscillator(1.0, 5.0, 0.3, 0.02, 0.5, Drive(5.0, 1.0))
        if seed == 0 or steady(it):
            return Drawn(seed, it, discarded)
        discarded += 1


def steady(it: Oscillator) -> bool:
    """Whether a perturbation stays small along every excitation: a run that forgets its start
    cannot say whether a correction is right."""
    start, still, t = np.array([it.q0]), np.zeros(1), np.arange(0, END, 0.01)
    return all(
        growth(it.plant(drive), t, start, still) < UNSTEADY for drive in drives(it.drive).values()
    )


@dataclass(frozen=True, slots=True)
class Data:
    """A recording, SI: ``t`` (N,), measured ``q``, ``v``, ``a`` (N, n) with noise, what is true in
    ``exact``, noise ``sd`` (3, n), and which samples are trained on (N,)."""

    t: Array
    q: Array
    v: Array
    a: Array
    exact: Run
    sd: Array
    train: NDArray[np.bool_]


def measured(plant: Plant, t: Array, q: Array, v: Array, seed: int) -> Data:
    """A run with white noise of 1.5 % of the largest value of each channel, split 70/30 at
    random."""
    exact = simulate(plant, t, q, v)
    rng = np.random.default_rng([seed, 1])
    sd = np.array([NOISE * np.abs(part).max(axis=0) for part in exact])
    noisy = [part + s * rng.standard_normal(part.shape) for part, s in zip(exact, sd, strict=True)]
    train = np.zeros(t.size, bool)
    train[rng.permutation(t.size)[: round(TRAINED_ON * t.size)]] = True
    return Data(t, noisy[0], noisy[1], noisy[2], exact, sd, train)


def recorded(it: Oscillator, seed: int, end: float = END) -> Data:
    """The recording of an oscillator under its own drive."""
    return measured(it.plant(it.drive), times(end), np.array([it.q0]), np.zeros(1), seed)


def nrmse(found: Array, wanted: Array) -> float:
    """RMSE over the range of what is wanted (eq. 16 of the paper), dimensionless."""
    return float(np.sqrt(np.mean((found - wanted) ** 2)) / np.ptp(wanted))


def rmse(found: Array, wanted: Array) -> float:
    """Root of the mean squared difference, in the unit of both; infinite if one is not finite."""
    value = float(np.sqrt(np.mean((found - wanted) ** 2)))
    return value if np.isfinite(value) else float("inf")


def lag(t: Array, found: Run, wanted: Run, window: tuple[float, float]) -> float:
    """By how many seconds the first coordinate comes late within a window of time, to first order:
    q(t − τ) = q − τ v; NaN where it stands still."""
    rows = (t >= window[0]) & (t < window[1])
    v, apart = wanted[1][rows, 0], (found[0] - wanted[0])[rows, 0]
    return float(-np.sum(apart * v) / np.sum(v**2)) if v.any() else float("nan")

"""Falls fitted by hand: the losses that anybody would try, with NumPy and SciPy alone.

    (m l² + J) q'' = −m g l sin q − c q' − (F + mu |m g l sin q|) tanh(q'/w)

python studies/servo_pendulums/by_hand.py    # prints the errors on falls that were not fitted

Every fall starts at rest from its first angle, at its first sample or some time d later, when the
motor lets go; errors of all angles count alike. c and F are those of all falls, or those of each
mount: the falls of one weight and length.
"""

from collections.abc import Sequence

import numpy as np
from falls import LASTS, Fall, folder_of_runs, read_falls, split
from numpy.typing import NDArray
from scipy.optimize import least_squares

GRAVITY = 9.81  # m/s²
STEP = 1e-3  # s, of the midpoint rule
EVERY = 10  # steps between two angles that are compared
WIDTH = 0.02  # rad/s: within it friction turns over
SIZES = np.array([0.01, 0.02, 0.02, 0.1, 0.02])  # of the numbers: kg·m², N·m·s/rad, N·m, 1, s
NAMES = ("J", "c", "F", "mu", "d")
STRUCTURES: dict[str, tuple[int, ...]] = {
    "nothing": (),
    "viscous": (0, 1),
    "dry": (0, 2),
    "both": (0, 1, 2),
    "both, with load": (0, 1, 2, 3),
    "both, late": (0, 1, 2, 4),
    "both, with load, late": (0, 1, 2, 3, 4),
}
OF_MOUNTS: dict[str, tuple[int, ...]] = {  # beside c and F of each
    "c and F of each mount": (0,),
    "c and F of each mount, with load": (0, 3),
    "c and F of each mount, late": (0, 4),
    "c and F of each mount, with load, late": (0, 3, 4),
}

Array = NDArray[np.float64]


def measured(falls: Sequence[Fall]) -> tuple[Array, Array, Array, Array]:
    """Weights, lengths and first angles (S,), and the angles (S, N) every ``EVERY`` steps."""
    times = np.arange(0, LASTS, EVERY * STEP)
    seen = [np.isfinite(fall.q) for fall in falls]
    angles = [np.interp(times, f.t[s], f.q[s]) for f, s in zip(falls, seen, strict=True)]
    mass, length = (
        np.array([getattr(fall, name) for fall in falls]) for name in ("mass", "length")
    )
    return mass, length, np.array([fall.q[0] for fall in falls]), np.array(angles)


def simulated(
    numbers: Array,
    mass: Array,
    length: Array,
    start: Array,
    count: int,
    rising: Array | None = None,
) -> Array:
    """Angles (S, ``count``) of falls side by side, for (J, c, F, mu, d), each (1,) or (S,), SI.

    ``rising`` adds (F_s + mu_s |m g l sin q|) exp(−(|q'|/v_s)^a) to what is dry; its numbers are
    (F_s, mu_s, v_s, a)."""
    inertia, damping, dry, loaded, late = numbers
    whole = mass * length**2 + inertia

    def acceleration(q: Array, v: Array) -> Array:
        pull = mass * length * GRAVITY * np.sin(q)
        held = dry + loaded * np.abs(pull)
        if rising is not None:
            static, by_load, speed, exponent = rising
            slow = np.exp(-((np.abs(v) / speed) ** exponent))
            held = held + (static + by_load * np.abs(pull)) * slow
        return (-pull - damping * v - held * np.tanh(v / WIDTH)) / whole

    q, v, rows = start.copy(), np.zeros_like(start), [start]
    for step in range(1, EVERY * (count - 1) + 1):
        moves = np.clip(STEP * step - late, 0.0, STEP)  # of the step, the part that is no wait
        half = v + moves / 2 * acceleration(q, v)
        q, v = q + moves * half, v + moves * acceleration(q + moves / 2 * v, half)
        if step % EVERY == 0:
            rows.append(q)
    return np.array(rows).T


def fitted(falls: Sequence[Fall], free: Sequence[int]) -> Array:
    """The numbers (J, c, F, mu, d), SI, of which those ``free`` are fitted and the others are 0."""
    mass, length, start, angles = measured(falls)

    def full(shares: Array) -> Array:
        numbers = np.zeros(SIZES.size)
        numbers[list(free)] = shares * SIZES[list(free)]
        return numbers

    def left(shares: Array) -> Array:
        return (simulated(full(shares), mass, length, start, angles.shape[1]) - angles).ravel()

    if not free:
        return full(np.zeros(0))
    begin = np.full(len(free), 0.5)
    return full(least_squares(left, begin, bounds=(0, np.inf), diff_step=1e-4).x)


def mounts(falls: Sequence[Fall]) -> NDArray[np.int64]:
    """The mount (S,) of each fall, by weight and length."""
    pairs = [(fall.mass, fall.length) for fall in falls]
    return np.array([sorted(set(pairs)).index(pair) for pair in pairs])


def fitted_by_mount(falls: Sequence[Fall], shared: Sequence[int]) -> Array:
    """The numbers (J, c, F, mu, d), SI, of every mount, (5, mounts): c and F are its own, those
    ``shared`` are the same in all, the others 0."""
    mass, length, start, angles = measured(falls)
    which = mounts(falls)
    count = int(which.max()) + 1

    def full(shares: Array) -> Array:
        found = np.zeros((SIZES.size, count))
        found[list(shared)] = shares[: len(shared), None]
        found[1:3] = shares[len(shared) :].reshape(2, count)
        return SIZES[:, None] * found

    def left(shares: Array) -> Array:
        numbers = full(shares)[:, which]
        return (simulated(numbers, mass, length, start, angles.shape[1]) - angles).ravel()

    begin = np.full(len(shared) + 2 * count, 1.0)
    return full(least_squares(left, begin, bounds=(0, np.inf), diff_step=1e-4, ftol=1e-5).x)


def error(numbers: Array, falls: Sequence[Fall]) -> float:
    """RMS of the angles, in rad."""
    mass, length, start, angles = measured(falls)
    left = simulated(numbers, mass, length, start, angles.shape[1]) - angles
    return float(np.sqrt(np.mean(left**2)))


def main() -> None:
    """Fit every structure to half of the falls, and print its errors on the other half."""
    folder = folder_of_runs()
    if folder is None:
        raise SystemExit("the recordings are not on this machine")
    learned, unseen = split(read_falls(folder))
    for name, free in STRUCTURES.items():
        numbers = fitted(learned, free)
        values = ", ".join(f"{NAMES[i]} {numbers[i]:.4g}" for i in free)
        mrad = [1e3 * error(numbers, falls) for falls in (learned, unseen)]
        print(f"{name}: {mrad[0]:.1f} mrad, unseen {mrad[1]:.1f} mrad ({values})", flush=True)
    for title, shared in OF_MOUNTS.items():
        own = fitted_by_mount(learned, shared)
        mrad = [1e3 * error(own[:, mounts(falls)], falls) for falls in (learned, unseen)]
        print(f"{title}: {mrad[0]:.1f} mrad, unseen {mrad[1]:.1f} mrad", flush=True)
        for name, values in zip(NAMES, own, strict=True):
            print(f"  {name}: {', '.join(f'{value:.4g}' for value in values)}")


if __name__ == "__main__":
    main()

"""The ladder of friction models of servo actuators, fitted to falls and compared on unseen ones.

    M1  F + c |q'|                           M3  M1 + mu |load|
    M2  M1 + F_s exp(−(|q'|/v_s)^a)          M4  M3 + (F_s + mu_s |load|) exp(−(|q'|/v_s)^a)

python studies/servo_pendulums/ladder.py    # prints the errors on falls that were not fitted

The models are those of Duclusaud, Passault, Padois and Ly, "Extended friction models for the
physics simulation of servo actuators" (2024), with the bounds of v_s and a of their published code.
M5 and M6 add the torque of the motor to what loads the gear; it is off in a fall, so both are M4.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from by_hand import SIZES, Array, measured, simulated
from falls import Fall, folder_of_runs, read_falls, split
from scipy.optimize import least_squares

MODELS: Mapping[str, tuple[int, ...]] = {  # free among J, c, F, mu, d, F_s, mu_s, v_s, a
    "M1": (0, 1, 2),
    "M2": (0, 1, 2, 5, 7, 8),
    "M3": (0, 1, 2, 3),
    "M4": (0, 1, 2, 3, 5, 6, 7, 8),
}
NAMES = ("J", "c", "F", "mu", "d", "F_s", "mu_s", "v_s", "a")
SCALES = np.concatenate([SIZES, [0.02, 0.1, 0.2, 1.35]])  # the last two: where searches begin
FIRST = len(SIZES)  # of the numbers of what rises towards rest
LOWER = np.array([0.0] * (FIRST + 2) + [0.1, 1.0])  # rad/s and 1, of v_s and a
UPPER = np.array([np.inf] * (FIRST + 2) + [1.0, 10.0])


def fitted(falls: Sequence[Fall], free: Sequence[int]) -> Array:
    """The numbers of ``NAMES``, SI, of which those ``free`` are fitted; others have no effect."""
    chosen = list(free)
    none = np.zeros(SCALES.size)
    none[-2:] = SCALES[-2:]
    mass, length, start, angles = measured(falls)

    def full(shares: Array) -> Array:
        numbers = none.copy()
        numbers[chosen] = shares * SCALES[chosen]
        return numbers

    def left(shares: Array) -> Array:
        numbers = full(shares)
        run = simulated(numbers[:FIRST], mass, length, start, angles.shape[1], numbers[FIRST:])
        return (run - angles).ravel()

    bounds = LOWER[chosen] / SCALES[chosen], UPPER[chosen] / SCALES[chosen]
    begin = np.where(np.isin(chosen, (FIRST + 2, FIRST + 3)), 1.0, 0.5)
    return full(least_squares(left, begin, bounds=bounds, diff_step=1e-4, ftol=1e-6).x)


def error(numbers: Array, falls: Sequence[Fall]) -> float:
    """RMS of the angles, in rad."""
    mass, length, start, angles = measured(falls)
    run = simulated(numbers[:FIRST], mass, length, start, angles.shape[1], numbers[FIRST:])
    return float(np.sqrt(np.mean((run - angles) ** 2)))


def main() -> None:
    """Climb the ladder."""
    folder = folder_of_runs()
    if folder is None:
        raise SystemExit("the recordings are not on this machine")
    learned, unseen = split(read_falls(folder))
    for name, free in MODELS.items():
        numbers = fitted(learned, free)
        values = ", ".join(f"{NAMES[i]} {numbers[i]:.4g}" for i in free)
        mrad = [1e3 * error(numbers, falls) for falls in (learned, unseen)]
        print(f"{name}: {mrad[0]:.1f} mrad, unseen {mrad[1]:.1f} mrad ({values})", flush=True)


if __name__ == "__main__":
    main()

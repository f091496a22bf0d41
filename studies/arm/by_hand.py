"""Least squares that know what is missing: rotors, friction, and that motor 6 turns with joint 5.

python studies/arm/by_hand.py

The torque that the rigid arm of the URDF lacks is held against the columns of what is missing, both
through one zero-phase filter, as the identification of robots does it.

Source: Gautier & Poignet, Extended Kalman filtering and weighted least squares dynamic
identification of robot, Control Engineering Practice 9, 2001.
"""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from recordings import JOINTS, STEP_S, arm, required_folder, split
from scipy.signal import butter, sosfiltfilt

import symhyb as sh

Array = NDArray[np.float64]

CUT_HZ = 75.0
EVERY = 10  # samples, of which one is kept: 500 Hz
EDGE_S = 0.1  # at either end, where the filter has not settled
# what acts, by the combination of joints that turns there
TURNS = np.vstack([np.eye(JOINTS), [0, 0, 0, 0, 1, 1]])
NAMES = (*(f"joint_{i + 1}" for i in range(JOINTS)), "joint_5 + joint_6")


@dataclass(frozen=True, slots=True)
class Torques:
    """Along a part of the run, filtered: what is ``applied`` (N, 6), what the model ``lacks``
    (N, 6), and the ``columns`` (N, 6, K) of what may be missing for a number of 1, SI."""

    applied: Array
    lacks: Array
    columns: Array


def filtered(signals: Array) -> Array:
    """Signals (N, …) below 75 Hz, every tenth sample, without the ends."""
    low = butter(4, CUT_HZ, fs=1 / STEP_S, output="sos")
    edge = round(EDGE_S / STEP_S)
    return np.asarray(sosfiltfilt(low, signals, axis=0)[edge:-edge:EVERY])


def torques_of(model: sh.Model, recording: sh.Recording) -> Torques:
    """The torques of a part of the run, by the model and as columns of what may be missing."""
    found = sh.compare(model, recording)
    motion = found.motion
    v, a = motion.v @ TURNS.T, motion.a @ TURNS.T
    each = np.stack([a, v, np.sign(v)], axis=2)  # rotor, viscous, dry (N, 7, 3)
    acts = np.einsum("tj,ntk->njtk", -TURNS, each).reshape(len(v), JOINTS, -1)
    offsets = np.broadcast_to(np.eye(JOINTS), (len(v), JOINTS, JOINTS))
    applied = np.column_stack([recording.inputs[f"joint_{i + 1}_torque"] for i in range(JOINTS)])
    return Torques(
        filtered(applied),
        filtered(found.force),
        filtered(np.concatenate([acts, offsets], axis=2)),
    )


def error(left: Array, applied: Array) -> float:
    """What is left of torques (N, 6) over what was applied (N, 6)."""
    return float(np.linalg.norm(left) / np.linalg.norm(applied))


def solved(part: Torques) -> Array:
    """The numbers (K,), SI, by least squares; each joint counts by what it lacks."""
    scale = np.sqrt(np.mean(part.lacks**2, axis=0))
    matrix = (part.columns / scale[:, None]).reshape(-1, part.columns.shape[2])
    return np.asarray(np.linalg.lstsq(matrix, (part.lacks / scale).ravel(), rcond=None)[0])


def main() -> None:
    """Print the numbers and both errors on the unseen part."""
    folder = required_folder()
    with TemporaryDirectory() as scratch:
        model = arm(folder, Path(scratch) / "arm.toml")
        train, unseen = (torques_of(model, one) for one in split(folder, model))
    numbers = solved(train)
    for name, (rotor, viscous, dry) in zip(NAMES, numbers[:-JOINTS].reshape(-1, 3), strict=True):
        print(f"{name}: rotor {rotor:.4f}, viscous {viscous:.3f}, dry {dry:.3f}")
    print(f"unseen, as the URDF says: {error(unseen.lacks, unseen.applied):.3f}")
    left = unseen.lacks - unseen.columns @ numbers
    print(f"unseen, with these numbers: {error(left, unseen.applied):.3f}")


if __name__ == "__main__":
    main()

"""What the model of a falling arm lacks, beside fits by hand, on falls that neither has seen.

python studies/servo_pendulums/diagnose.py EACH shared|mounts [OUT]

The first EACH falls of every weight and length are learned from, in the order of their runs (at
most 12). All of them share what is found, or the falls of each mount share their damping and dry
friction. The model with what was found is written to OUT, as corrected.toml.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from by_hand import OF_MOUNTS, STRUCTURES, error, fitted, fitted_by_mount, mounts
from falls import MODEL, Fall, folder_of_runs, read_falls, split

import symhyb as sh


def chosen(learned: Sequence[Fall], each: int) -> list[Fall]:
    """Of every weight and length the first ``each`` falls in the order of their runs."""
    groups: dict[tuple[float, float], list[Fall]] = {}
    for fall in sorted(learned, key=lambda one: one.run):
        groups.setdefault((fall.mass, fall.length), []).append(fall)
    return [fall for group in groups.values() for fall in group[:each]]


OWN = {"shared": {}, "mounts": {"damping": "mount", "coulomb": "mount"}}


def diagnosed(
    falls: Sequence[Fall], own: Mapping[str, str] | None = None
) -> tuple[sh.Diagnosis, sh.Model]:
    """What the model lacks in some falls, and the model with it; ``own`` has what is shared within
    groups alone."""
    model = sh.read_model(MODEL)
    diagnosis = sh.diagnose(model, [fall.recording(model) for fall in falls], own=own or {})
    return diagnosis, sh.apply(model, diagnosis.found)


def open_loop(
    model: sh.Model,
    falls: Sequence[Fall],
    diagnosis: sh.Diagnosis | None = None,
    late: float = 0.0,
) -> float:
    """RMS of the angles of falls, in rad, where each is simulated from rest at its first angle,
    ``late`` by some s, with the numbers that the ``diagnosis`` has for its mount."""
    squares = []
    for fall in falls:
        recording = fall.recording(model)
        own = diagnosis.values_of(recording) if diagnosis else {}
        run = sh.simulate(model, recording, start={"q": float(fall.q[0])}, parameters=own)
        q = np.interp(fall.t - late, run.t, run.y[:, 0])  # at rest until it begins
        squares.append((q - fall.q) ** 2)
    return float(np.sqrt(np.nanmean(np.concatenate(squares))))


def main() -> None:
    """Diagnose, and print both kinds of errors."""
    folder = folder_of_runs()
    if folder is None:
        raise SystemExit("the recordings are not on this machine")
    learned, unseen = split(read_falls(folder))
    diagnosis, corrected = diagnosed(chosen(learned, int(sys.argv[1])), OWN[sys.argv[2]])
    print(diagnosis.sentence)
    by_mount = {name: fitted_by_mount(learned, which) for name, which in OF_MOUNTS.items()}
    for late in (0.0, float(by_mount["c and F of each mount, late"][4, 0])):
        mrad = 1e3 * open_loop(corrected, unseen, diagnosis, late)
        print(f"unseen falls, {1e3 * late:.0f} ms late: {mrad:.1f} mrad", flush=True)
    if len(sys.argv) > 3:
        sh.write_model(corrected, Path(sys.argv[3]) / "corrected.toml")
    for name, free in STRUCTURES.items():
        by_hand = 1e3 * error(fitted(learned, free), unseen)
        print(f"by hand, {name}: {by_hand:.1f} mrad", flush=True)
    for name, numbers in by_mount.items():
        by_hand = 1e3 * error(numbers[:, mounts(unseen)], unseen)
        print(f"by hand, {name}: {by_hand:.1f} mrad", flush=True)


if __name__ == "__main__":
    main()

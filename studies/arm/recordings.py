"""The run of an industrial arm, at its joints instead of its motors, and the model of its URDF.

python studies/arm/recordings.py OUT    # arm.toml, train.csv and unseen.csv, for the command line

What was recorded is looked for in the folder staubli_tx40 of the folder that SYMHYB_DATA names.
"""

import os
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import symhyb as sh
from symhyb.imports.deliver import Order, deliver

FOLDER = "staubli_tx40"
URDF = "tx40_mdh_modified.urdf"
JOINTS = 6
STEP_S = 2e-4
PARTS = {"train": slice(None, 30_000), "unseen": slice(30_000, None)}  # samples
# angles of motors over those of joints; motor 6 turns with joint 5, too
RATIOS = np.diag([32.0, 32.0, 45.0, -48.0, 45.0, 32.0])
RATIOS[5, 4] = 32.0
ZERO = np.array([0.0, -np.pi / 2, np.pi / 2, 0.0, 0.0, 0.0])  # of the URDF, rad


def folder_of_run() -> Path | None:
    """Where the recording is; None if it is not on this machine."""
    root = os.environ.get("SYMHYB_DATA")
    folder = Path(root or ".") / FOLDER
    return folder if root and (folder / URDF).is_file() else None


def required_folder() -> Path:
    """The same; the script ends where it is not there."""
    folder = folder_of_run()
    if folder is None:
        raise SystemExit("the recording is not on this machine")
    return folder


def recorded(folder: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angles (N, 6) in rad and torques (N, 6) in N·m of all joints."""
    angles, torques = (
        np.loadtxt(folder / name, delimiter=",", skiprows=1)
        for name in ("pos_read_data.csv", "curr_data.csv")
    )
    return angles @ np.linalg.inv(RATIOS).T + ZERO, torques @ RATIOS


def columns(folder: Path) -> dict[str, NDArray[np.float64]]:
    """The run by the channels of the model, each (N,), SI."""
    q, torque = recorded(folder)
    found = {"t": STEP_S * np.arange(len(q))}
    for i in range(JOINTS):
        found[f"joint_{i + 1}"] = q[:, i]
        found[f"joint_{i + 1}_torque"] = torque[:, i]
    return found


def arm(folder: Path, target: Path) -> sh.Model:
    """The model that the URDF gives, written to ``target``."""
    deliver(folder / URDF, Order(force=True), target)
    return sh.read_model(target)


def split(folder: Path, model: sh.Model) -> tuple[sh.Recording, sh.Recording]:
    """What is learned from, and what stays unseen."""
    run = columns(folder)
    train, unseen = (
        sh.Recording.from_frame(
            {key: values[rows] for key, values in run.items()}, model, name=name
        )
        for name, rows in PARTS.items()
    )
    return train, unseen


def main() -> None:
    """Write the model and both parts of the run."""
    folder, out = required_folder(), Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    arm(folder, out / "arm.toml")
    run = columns(folder)
    for name, rows in PARTS.items():
        table = np.column_stack([values[rows] for values in run.values()])
        heading = ",".join(run)
        np.savetxt(out / f"{name}.csv", table, "%.9g", ",", header=heading, comments="")


if __name__ == "__main__":
    main()

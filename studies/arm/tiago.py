"""The run of the arm of a mobile robot, and the model of its URDF: four joints that a diagnosis is
asked of, and a lift and three joints whose motion is given.

python studies/arm/tiago.py OUT    # tiago.toml, train.csv and unseen.csv, for the command line, and
                                   # least squares that know the structure

What was recorded is looked for in the folder tiago_arm of the folder that SYMHYB_DATA names.
"""

import os
import re
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

import symhyb as sh
from symhyb.imports.deliver import Order, deliver

FOLDER = "tiago_arm"
URDF = "tiago_48_schunk.urdf"
FREE = tuple(f"arm_{i}_joint" for i in range(1, 5))
GIVEN = ("torso_lift_joint", *(f"arm_{i}_joint" for i in range(5, 8)))
GEAR = 100.0  # of the first four joints, by figaroh's configuration
CONSTANTS = (0.136, 0.136, -0.087, -0.087)  # N·m/A, by figaroh's configuration
TRAIN_S = 55.0  # of 80 s; the rest stays unseen
BAND_HZ, ORDER, REST = 5.0, 4, 0.01  # of a zero-phase filter; rad/s over which friction turns over
ENDS = 100  # samples that the filter needs at either end


def folder_of_run() -> Path | None:
    """Where the recording is; None if it is not on this machine."""
    root = os.environ.get("SYMHYB_DATA")
    folder = Path(root or ".") / FOLDER
    return folder if root and (folder / URDF).is_file() else None


def columns(folder: Path) -> dict[str, NDArray[np.float64]]:
    """The run by the channels of the model, each (N,): s, m, rad and N·m."""
    places, currents = (
        np.genfromtxt(folder / f"tiago_{name}.csv", delimiter=",", skip_header=1)
        for name in ("position", "effort")
    )
    found = {"t": places[:, 0], "torso_lift_joint": places[:, 1]}
    for i in range(1, 8):
        found[f"arm_{i}_joint"] = places[:, i + 1]
    for i, constant in enumerate(CONSTANTS, start=1):
        found[f"arm_{i}_joint_torque"] = GEAR * constant * currents[:, i + 1]
    return found


def write_arm(folder: Path, target: Path) -> None:
    """The model that the URDF gives, without the friction of 1 N·m and the damping of 1 N·m·s/rad
    that it states of every joint alike, with the motion of the lift and of joints 5 to 7 given."""
    bare = target.with_suffix(".urdf")
    bare.write_text(re.sub(r"<dynamics [^>]*/>", "", (folder / URDF).read_text("utf-8")), "utf-8")
    order = Order(joints=(*GIVEN[:1], *FREE, *GIVEN[1:]), passive=GIVEN, force=True)
    deliver(bare, order, target)
    text = target.read_text("utf-8")
    for name in GIVEN:
        head = rf"(?m)^({name} *= {{ unit = \"\w+\", )"
        text = re.sub(head, r"\1imposed = true, ", text, count=1)
    target.write_text(text, "utf-8")


def by_hand(model: sh.Model, run: sh.Recording) -> NDArray[np.float64]:
    """Least squares of the torque of each free joint by what the rigid arm takes, rate, direction
    and a constant, all through one filter: a row a joint with what a stated N·m exerts, viscous
    (N·m·s/rad) and dry friction (N·m), and the part of the torque that is left, RMS over RMS."""
    gap = sh.compare(model, run)
    sections = butter(ORDER, BAND_HZ, fs=(run.t.size - 1) / run.duration, output="sos")
    found = []
    for name in FREE:
        i = model.coordinates.names().index(name)
        torque = np.interp(gap.motion.t, run.t, run[f"{name}_torque"])
        rate = gap.motion.v[:, i]
        lacks = gap.force[:, i]
        parts = (lacks + torque, rate, np.tanh(rate / REST), np.ones_like(rate), torque)
        kept = sosfiltfilt(sections, np.column_stack(parts), axis=0)[ENDS:-ENDS]
        columns, wanted = kept[:, :4], kept[:, 4]
        solved = np.linalg.lstsq(columns, wanted, rcond=None)[0]
        left = np.std(wanted - columns @ solved) / np.std(wanted)
        found.append((1 / solved[0], solved[1] / solved[0], solved[2] / solved[0], left))
    return np.array(found)


def main() -> None:
    """Write the model and both parts of the run, and print the least squares."""
    folder, out = folder_of_run(), Path(sys.argv[1])
    if folder is None:
        raise SystemExit("the recording is not on this machine")
    out.mkdir(parents=True, exist_ok=True)
    write_arm(folder, out / "tiago.toml")
    run = columns(folder)
    learned = run["t"] < TRAIN_S
    for name, rows in (("train", learned), ("unseen", ~learned)):
        table = np.column_stack([values[rows] for values in run.values()])
        np.savetxt(out / f"{name}.csv", table, "%.9g", ",", header=",".join(run), comments="")
    model = sh.read_model(out / "tiago.toml")
    print("joint: of a stated N·m, viscous [N·m·s/rad], dry [N·m], part of the torque that is left")
    rows = by_hand(model, sh.read_recording(out / "train.csv", model))
    for name, row in zip(FREE, rows.tolist(), strict=True):
        print(f"  {name}: {row[0]:.2f}, {row[1]:.1f}, {row[2]:.2f}, {row[3]:.2f}")


if __name__ == "__main__":
    main()

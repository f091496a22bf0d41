"""The free falls among the recordings of a hobby servo, and how they are split.

python studies/servo_pendulums/falls.py OUT    # for the command line: a CSV a fall, known.csv with
                                               # weights and lengths, mounts.csv with the mounts

The runs are looked for in the folder servo_pendulums of the folder that SYMHYB_DATA names.
"""

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.ndimage import median_filter

import symhyb as sh

FOLDER = "servo_pendulums"
MODEL = Path(__file__).with_name("machine.toml")
LASTS = 3.0  # s after the motor is off: by then every arm is at rest
JUMP = 0.2  # rad beside the median of seven samples: a read error (the fastest arm moves 0.18)


@dataclass(frozen=True, slots=True)
class Fall:
    """One fall: its run, the weight (kg) and length (m) it was made with, the gain that held the
    arm before, times (N,) s since the motor was switched off, and angles (N,) rad, NaN where the
    encoder was misread."""

    run: int
    mass: float
    length: float
    gain: float
    t: NDArray[np.float64]
    q: NDArray[np.float64]

    @property
    def known(self) -> dict[str, float]:
        """What is known of this run, in the units of the model."""
        return {"m": self.mass, "l": self.length}

    @property
    def mount(self) -> str:
        """How the weight was mounted: falls of one weight and length repeat each other."""
        return f"{self.mass:g} kg, {self.length:g} m"

    def recording(self, model: sh.Model) -> sh.Recording:
        """The fall as a recording that knows its weight and length, in the group of its mount."""
        return sh.Recording.from_frame(
            {"t": self.t, "encoder": self.q},
            model,
            name=self.name,
            parameters=self.known,
            groups={"mount": self.mount},
        )

    @property
    def name(self) -> str:
        """The name of its file."""
        return f"fall-{self.run}.csv"


def folder_of_runs() -> Path | None:
    """Where the recordings are; None if they are not on this machine."""
    root = os.environ.get("SYMHYB_DATA")
    folder = Path(root or ".") / FOLDER
    return folder if root and (folder / "runs.csv").is_file() else None


def read_falls(folder: Path) -> list[Fall]:
    """All falls, in the order of their runs: what was recorded while no torque was enabled."""
    about = pd.read_csv(folder / "runs.csv").set_index("run")
    columns = ["run", "position", "timestamp", "torque_enable"]
    rows = pd.read_csv(folder / "sts3250.csv.gz", usecols=columns)
    falls = []
    for run, part in rows[rows.torque_enable == 0].groupby("run"):
        t, q = part.timestamp.to_numpy(), part.position.to_numpy()
        t = t - t[0]
        q = np.where(np.abs(q - median_filter(q, 7, mode="nearest")) > JUMP, np.nan, q)
        kept, one = t <= LASTS, about.loc[run]
        falls.append(Fall(int(run), one.mass, one.length, one.kp, t[kept], q[kept]))
    return falls


def split(falls: Sequence[Fall]) -> tuple[list[Fall], list[Fall]]:
    """Those to learn from and those that stay unseen: of the repetitions of every combination of
    weight, length and gain, in the order of their runs, every other one."""
    groups: dict[tuple[float, ...], list[Fall]] = {}
    for fall in falls:
        groups.setdefault((fall.mass, fall.length, fall.gain), []).append(fall)
    learned = [fall for group in groups.values() for fall in group[::2]]
    unseen = [fall for group in groups.values() for fall in group[1::2]]
    return learned, unseen


def main() -> None:
    """Write every fall as a CSV, and the table of what is known of them."""
    folder, out = folder_of_runs(), Path(sys.argv[1])
    if folder is None:
        raise SystemExit(f"no {FOLDER} in the folder that SYMHYB_DATA names")
    out.mkdir(parents=True, exist_ok=True)
    rows, mounts = ["recording,m [kg],l [m]"], ["recording;mount"]
    for part, falls in zip(("learn", "unseen"), split(read_falls(folder)), strict=True):
        (out / part).mkdir(exist_ok=True)
        for fall in falls:
            frame = pd.DataFrame({"t": fall.t, "encoder": fall.q})
            frame.to_csv(out / part / fall.name, index=False)
            rows.append(f"{fall.name},{fall.mass},{fall.length}")
            mounts.append(f"{fall.name};{fall.mount}")
    (out / "known.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (out / "mounts.csv").write_text("\n".join(mounts) + "\n", encoding="utf-8")
    print(f"{out}: {len(rows) - 1} falls")


if __name__ == "__main__":
    main()

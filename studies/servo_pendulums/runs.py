"""All 960 runs of the servo as a study: what is read, what was misread, and what is written.

python studies/servo_pendulums/runs.py OUT [EVERY [WITHOUT]]   # a CSV a run, tables, two studies
symhyb run OUT/ladder.toml -o out --workers 1     # friction, by structures
symhyb fleet out --among mount,trajectory,gain
symhyb run OUT/gain.toml -o gains                 # the gain of the controller
symhyb fleet gains --among mount,trajectory,gain

EVERY takes of all mounts, trajectories and gains each so-manieth, with all its repetitions;
WITHOUT is a trajectory that is left out.
"""

import csv
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd
from falls import FOLDER, JUMP, folder_of_runs
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.ndimage import median_filter

HERE = Path(__file__).parent
TEMPERATURE = (5.0, 100.0)  # °C: what is outside is a read error, of a motor in a room
VOLTS = (9.0, 15.0)  # V: likewise, of a supply of 12 V
BACKWARDS = 1024  # of the reported duty: the bit of its direction
FULL = 1000  # of the reported duty: all of the supply
STEPS = 4096  # of the encoder, a turn
PER_RAD = 0.25 / FULL * STEPS / (2 * np.pi)  # 1/rad: duty of an error of one rad, for kp = 1
SENT = 8  # goals, the last ones, of which the servo may still have any
REACH = np.linspace(0.8, 1.25, 91)  # of the stated gain: where it is looked for
FITS = 0.5  # steps of the encoder: a duty that is further off has none of the goals
ROUNDS = 5  # of the gain and of which goals fit

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One run: weight (kg), length (m) and gain as stated, times (N,) in s, angles (N,) in rad with
    NaN where the encoder was misread, the duty (N,) of the motor with its sign, 1 for the whole
    supply, whether it is ``on`` (N,), and the wanted angle (N,) in rad. ``misread`` counts samples
    by channel; ``warm`` (°C) and ``volts`` (V) are means of the others. ``repetition`` counts the
    runs of one weight, length, gain and trajectory from 0; of the groups ``mount`` and ``gain`` it
    is whatever is stated. ``sent`` (N, L) are the goals that were sent before each sample, the last
    one first, NaN where there was none."""

    run: int
    mass: float
    length: float
    kp: float
    trajectory: str
    repetition: int
    t: Array
    q: Array
    duty: Array
    on: Array
    goal: Array
    warm: float
    volts: float
    misread: dict[str, int] = field(default_factory=dict)
    mount: str = ""
    gain: str = ""
    sent: Array = field(default_factory=lambda: np.zeros((0, SENT)))

    @property
    def name(self) -> str:
        """The name of its file."""
        return f"run-{self.run}.csv"

    @property
    def half(self) -> int:
        """0 for what the study was developed on, 1 for the runs of its figures: every other
        repetition."""
        return self.repetition % 2


def duty_of(reported: Array) -> Array:
    """The duty with its sign, of what the servo reports in hundredths of that: a positive one turns
    towards larger angles."""
    whole = np.round(100 * reported)
    size = np.where(whole >= BACKWARDS, BACKWARDS - whole, whole)
    return np.asarray(-size / FULL)


def read_runs(folder: Path) -> list[Run]:
    """All runs, in their order."""
    about = pd.read_csv(folder / "runs.csv").set_index("run")
    rows = pd.read_csv(folder / "sts3250.csv.gz")
    seen: dict[tuple[object, ...], int] = {}
    found = []
    for number, part in rows.groupby("run"):
        one = about.loc[number]
        kind = (one.mass, one.length, one.kp, one.trajectory)
        seen[kind] = seen.get(kind, -1) + 1
        found.append(_run(int(number), one, part, seen[kind]))
    return found


def _run(number: int, one: pd.Series, part: pd.DataFrame, repetition: int) -> Run:
    q = part.position.to_numpy()
    jumps = np.abs(q - median_filter(q, 7, mode="nearest")) > JUMP
    warm, cold = part.temp.to_numpy(), ~part.temp.between(*TEMPERATURE).to_numpy()
    volts, none = part.input_volts.to_numpy(), ~part.input_volts.between(*VOLTS).to_numpy()
    misread = {"position": jumps, "temperature": cold, "volts": none}
    t, goal = part.timestamp.to_numpy(), part.goal_position.to_numpy()
    return Run(
        number,
        float(one.mass),
        float(one.length),
        float(one.kp),
        str(one.trajectory),
        repetition,
        t - t[0],
        np.where(jumps, np.nan, q),
        duty_of(part.torque.to_numpy()),
        part.torque_enable.to_numpy(dtype=np.float64),
        goal,
        float(np.mean(warm[~cold])),
        float(np.mean(volts[~none])),
        {channel: int(bad.sum()) for channel, bad in misread.items() if bad.any()},
        f"{one.mass:g} kg {one.length:g} m",
        f"{one.kp:g}",
        sent_before(goal),
    )


def sent_before(goal: Array) -> Array:
    """The goals (N, L) that were sent before each sample, the last one first."""
    found = np.full((goal.size, SENT), np.nan)
    for k in range(SENT):
        found[k + 1 :, k] = goal[: max(goal.size - k - 1, 0)]
    return found


def has(run: Run) -> tuple[Array, Array]:
    """The goal (N,) in rad that the servo has at each sample, and its duty (N,) where it fits one.

    The servo takes goals in whole steps of its encoder, one every 20 ms, late. Its duty is
    g kp (goal − q) with the q that it reports; so of those sent the goal is the one next to
    q + duty/(g kp), with the g by which duties fit best, what is beyond a step counting as a step,
    and which those that fit agree on. The duty is missing where the
    motor is off or at its limit, and where none of the goals fits: it is followed by 7.5 rad/s at
    most."""
    step = 2 * np.pi / STEPS
    goals = np.floor(run.sent / step) * step
    known = np.isfinite(run.q) & np.isfinite(goals).all(axis=1)
    known &= (run.on > 0) & (abs(run.duty) < 1.0)
    if not known.any():
        return run.goal, np.full(run.t.size, np.nan)

    def next_to(gain: float) -> tuple[Array, Array]:
        off = goals[known] - (run.q + run.duty / (gain * run.kp))[known, None]
        which = abs(off).argmin(axis=1)
        rows = np.arange(which.size)
        return goals[known][rows, which], abs(off[rows, which])

    best = min(REACH * PER_RAD, key=lambda gain: float(np.minimum(next_to(gain)[1], step).sum()))
    goal, off = next_to(best)
    for _ in range(ROUNDS):
        fits = off < 4 * FITS * step
        error = goal[fits] - run.q[known][fits]
        if not error.any():
            break
        best = float(run.duty[known][fits] @ error / (error @ error)) / run.kp
        goal, off = next_to(best)
    found, duty = run.goal.copy(), np.full(run.t.size, np.nan)
    found[known], duty[known] = goal, np.where(off < FITS * step, run.duty[known], np.nan)
    return found, duty


def without_gaps(run: Run) -> Array:
    """The angles (N,), a cubic spline where they are missing and no duty is compared."""
    seen = np.isfinite(run.q)
    within = np.clip(run.t, run.t[seen][0], run.t[seen][-1])
    return np.where(seen, run.q, CubicSpline(run.t[seen], run.q[seen])(within))


def chosen(runs: Sequence[Run], every: int, without: str = "") -> list[Run]:
    """Of all mounts, trajectories and gains each so-manieth, with all its repetitions; the gains
    change from one to the next. One trajectory may be left ``without``."""
    gains = sorted({one.kp for one in runs})
    cells = sorted({(one.mass, one.length, one.trajectory) for one in runs})

    def place(one: Run) -> int:
        cell = cells.index((one.mass, one.length, one.trajectory))
        return len(gains) * cell + (gains.index(one.kp) + cell // 2) % len(gains)

    return [one for one in runs if place(one) % every == 0 and one.trajectory != without]


GROUPS = ("mount", "trajectory", "gain", "half", "repetition", "warm", "volts", "run")


def write_runs(runs: Sequence[Run], out: Path) -> None:
    """Leave a CSV a run, a table of them, the models and the studies."""
    out.mkdir(parents=True, exist_ok=True)
    for one in runs:
        columns = {"t": one.t, "encoder": one.q, "duty": one.duty, "on": one.on, "goal": one.goal}
        known = dict(zip(("seen", "has", "put"), (without_gaps(one), *has(one)), strict=True))
        frame = pd.DataFrame({**columns, **known})
        frame.to_csv(out / one.name, index=False)
    _write_table(runs, {"m": "mass", "l": "length", "kp": "kp"}, out / "runs.csv")
    _write_table(runs, {"kp": "kp"}, out / "gains.csv")
    with open(out / "misread.csv", "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["file", "channel", "samples"])
        writer.writerows([one.name, *pair] for one in runs for pair in one.misread.items())
    for name in ("motor.toml", "gain-model.toml", "ladder.toml", "gain.toml"):
        text = (HERE / name).read_text(encoding="utf-8")
        (out / name).write_text(text, encoding="utf-8")


def _write_table(runs: Sequence[Run], known: Mapping[str, str], file: Path) -> None:
    """The table of a study, with what is ``known`` of each run by the name of the parameter."""
    with open(file, "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        head = [*(f"parameters.{name}" for name in known), *(f"groups.{name}" for name in GROUPS)]
        writer.writerow(["file", *head])
        for one in runs:
            values = [f"{getattr(one, key):.8g}" for key in known.values()]
            said = [one.mount, one.trajectory, one.gain, one.half, one.repetition]
            writer.writerow([one.name, *values, *said, *_conditions(one)])


def _conditions(one: Run) -> list[float]:
    return [round(one.warm, 2), round(one.volts, 3), one.run]


def restated(run: Run, mass: float = 1.0, kp: float = 1.0) -> Run:
    """A run whose weight or gain is stated as so many times what it is."""
    return replace(run, mass=mass * run.mass, kp=kp * run.kp)


def asked(words: Sequence[str]) -> tuple[int, str]:
    """EVERY and WITHOUT of a command line."""
    return int(words[0]) if words else 1, words[1] if len(words) > 1 else ""


def main() -> None:
    """Write the folder that is named, and say what was misread."""
    folder, out = folder_of_runs(), Path(sys.argv[1])
    if folder is None:
        raise SystemExit(f"no {FOLDER} in the folder that SYMHYB_DATA names")
    runs = chosen(read_runs(folder), *asked(sys.argv[2:]))
    write_runs(runs, out)
    misread = [one for one in runs if one.misread]
    print(f"{out}: {len(runs)} runs, {len(misread)} of them with read errors, in misread.csv")


if __name__ == "__main__":
    main()

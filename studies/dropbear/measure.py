"""Follow the stiffness of a beam whose support moves, by its accelerometer alone.

    python studies/dropbear/measure.py [--data FOLDER] [-o build/dropbear]

Prints a row for every stop of the roller, and writes what was followed as CSV. The channel of the
roller says when it stood still, and nothing else; no estimate uses it.
"""

import argparse
import csv
import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

import symhyb as sh
from symhyb.data.recording import Recording

Array = NDArray[np.float64]
HERE = Path(__file__).resolve().parent
FILES = ("slow_10steps_test8.txt", "random_set0_test3.txt")
RATE = 5000  # Hz, of the files
EVERY = 10  # samples of the file to one that is used
BAND = (12.0, 70.0)  # Hz: the first mode, wherever the roller stands, and not the second at 200 Hz
BLOCK, HOP = 0.3, 0.1  # s: of what is seen, and from one estimate to the next
SETTLES = 1.0  # s of a file before the first block ends, for the filter
STANDS = 0.15  # V/s: a roller that is slower stands still
AFTER = 0.5  # s after a stop at which the stiffness is asked for, or when the roller moves again
LEAST = 0.25  # s that it stands


class Table(NamedTuple):
    """One file: times (N,), s, accelerations and places of the roller (N,), V; ``gauge`` (N,) a
    strain, where there is one."""

    t: Array
    accel: Array
    roller: Array
    gauge: Array | None


class Seen(NamedTuple):
    """An estimate from the block that ends at ``t``, s: frequency in Hz and stiffness with one
    deviation in N/m of a modal mass of 1 kg."""

    t: float
    frequency: float
    stiffness: float
    sd: float


class Stop(NamedTuple):
    """From when to when, s, the roller stood at a place, V, and the frequency, Hz, by hand."""

    begin: float
    end: float
    roller: float
    frequency: float


def read(path: Path) -> Table:
    """One file of the data set."""
    lines = path.read_text(encoding="latin-1").splitlines()
    names = lines[5].split("\t")
    rows = np.array([[float(x) for x in line.split("\t")] for line in lines[9:] if line.strip()])
    column = dict(zip(names, rows.T, strict=True))
    return Table(column["Time"], column["Accel"], column["PinLoc"], column.get("SG_300_a"))


def banded(values: Array) -> Array:
    """The band of the first mode, thinned."""
    passes = butter(4, BAND, btype="band", fs=RATE, output="sos")
    return np.asarray(sosfiltfilt(passes, values - values.mean())[::EVERY])


def followed(table: Table) -> Iterator[Seen]:
    """The stiffness from each block, of which nothing later is known, not even to the filter."""
    model = sh.read_model(HERE / "mode.toml")
    for end in np.arange(SETTLES, table.t[-1], HOP):
        past = table.t <= end
        t, accel = table.t[past][::EVERY], banded(table.accel[past])
        block = t > end - BLOCK
        run = Recording("block", t[block] - t[block][0], {}, {"accel": accel[block]}, (), "")
        try:
            stiffness = sh.finished(model, run).model.parameters["k"]
        except sh.SymhybError as error:
            print(f"{end:.2f} s: {error}")
            continue
        frequency = np.sqrt(max(stiffness.value, 0.0)) / (2 * np.pi)
        yield Seen(float(end), float(frequency), stiffness.value, stiffness.sd or np.inf)


def stops(table: Table) -> list[Stop]:
    """Where the roller stood still for a quarter of a second and longer, with the damped sine that
    fits there by least squares to the strain, or where there is none to the acceleration."""
    slow = sosfiltfilt(butter(2, 20.0, fs=RATE, output="sos"), table.roller)
    still = np.abs(np.gradient(slow, table.t)) < STANDS
    ends = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(int)))
    seen = banded(table.accel if table.gauge is None else table.gauge)
    found = []
    for begin, end in ends.reshape(-1, 2):
        lasts = (end - begin) / RATE
        if lasts >= LEAST and table.t[begin] >= SETTLES - AFTER:
            rows = slice(begin // EVERY, min(end, begin + RATE) // EVERY)
            place = float(np.median(table.roller[begin:end]))
            found.append(Stop(table.t[begin], table.t[end - 1], place, sine_of(seen[rows])))
    return found


def sine_of(values: Array) -> float:
    """The frequency, Hz, of the damped sine that fits best."""
    t = np.arange(values.size) * EVERY / RATE

    def left(frequency: float, decay: float) -> float:
        turn, size = 2 * np.pi * frequency * t, np.exp(-decay * t)
        columns = np.stack([size * np.sin(turn), size * np.cos(turn)], axis=1)
        return float(np.linalg.norm(values - columns @ np.linalg.lstsq(columns, values)[0]))

    grid = [(left(f, decay), f) for f in np.arange(20.0, 50.0, 0.1) for decay in (0.5, 2.0, 8.0)]
    return float(min(grid)[1])


def measured(name: str, folder: Path, output: Path) -> None:
    """Follow one file, and compare it with every stop."""
    table = read(folder / name)
    seen = list(followed(table))
    with (output / f"{Path(name).stem}.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["t [s]", "frequency [Hz]", "k [N/m]", "sd [N/m]", "roller [V]"])
        rollers = np.interp([one.t for one in seen], table.t, table.roller)
        writer.writerows([*one, round(float(v), 4)] for one, v in zip(seen, rollers, strict=True))
    print(f"{name}\n stop [s]  stands [s]  roller [V]  by hand [Hz]  followed [Hz]  error of k [%]")
    errors = []
    for one in stops(table):
        asked = min(one.begin + AFTER, one.end)
        then = min(seen, key=lambda each: abs(each.t - asked))
        error = 100 * ((then.frequency / one.frequency) ** 2 - 1)
        errors.append(abs(error))
        print(
            f"{one.begin:9.2f} {one.end - one.begin:11.2f} {one.roller:11.2f} "
            f"{one.frequency:13.1f} {then.frequency:14.2f} {error:15.1f}"
        )
    within = sum(error < 5 for error in errors)
    print(f"{within} of {len(errors)} within 5 %\n")


def main() -> None:
    """Measure both files."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    shared = Path(os.environ.get("SYMHYB_DATA", "."))
    parser.add_argument("--data", type=Path, default=shared / "dropbear")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/dropbear"))
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    for name in FILES:
        measured(name, options.data, options.output)


if __name__ == "__main__":
    main()

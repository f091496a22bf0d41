r"""How the time of a diagnosis grows: with the masses of a chain, and with the samples.

    wall |--/\/\/--[m]--/\/\/--[m]-- … --[m]      f pushes the first
         |---|-]---     --|-]--

m = 1 kg, 400 N/m and 1 N·s/m between neighbours; a damper of 3 N·s/m from the middle mass to the
ground is concealed. The push is a sum of twelve sines; every position is recorded, with white noise
of 0.5 % of its RMS. The chain is linear and has settled: its motion is that of its frequency
response, exactly. Diagnoses are command lines in processes of their own: their time is what these
and their children computed.
"""

import json
import math
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from timing import Row

Array = NDArray[np.float64]
MASS, STIFFNESS, DAMPING, CONCEALED = 1.0, 400.0, 1.0, 3.0
PUSH, STEP, NOISE = 5.0, 0.01, 0.005
PART = "a diagnosis grows"


class Cost(NamedTuple):
    """What a diagnosis took: computed ``seconds`` and ``bytes`` of memory at most, and how far off
    the concealed damper was, relative."""

    seconds: float
    bytes: float
    error: float


def chain(masses: int) -> str:
    """The model file, which lacks the concealed damper."""
    names = range(masses)
    lines = ["symhyb = 1", "[coordinates]", *(f'x{i} = {{ unit = "m" }}' for i in names)]
    lines += ["[parameters]", f'm = {{ value = {MASS}, unit = "kg" }}']
    lines += [f'k = {{ value = {STIFFNESS}, unit = "N/m" }}']
    lines += [f'd = {{ value = {DAMPING}, unit = "N*s/m" }}']
    lines += ['gap = { value = 5.0, unit = "m" }', "[inputs]", 'f = { unit = "N" }']
    lines += ["[points]", 'wall = ["0", "0"]']
    lines += [f'p{i} = ["{i + 1}*gap + x{i}", "0"]' for i in names]
    for i in names:
        ends = f'between = ["{f"p{i - 1}" if i else "wall"}", "p{i}"]'
        lines += [f"[bodies.b{i}]", 'mass = "m"', f'at = "p{i}"']
        lines += [f"[elements.s{i}]", 'kind = "spring"', ends, 'stiffness = "k"', 'length = "gap"']
        lines += [f"[elements.d{i}]", 'kind = "damper"', ends, 'damping = "d"']
    lines += ["[elements.push]", 'kind = "force"', 'on = "x0"', 'force = "f"', "[sensors]"]
    lines += [f's{i} = {{ measures = "x{i}", unit = "m" }}' for i in names]
    return "\n".join(lines) + "\n"


def recorded(masses: int, samples: int, noise: float = NOISE) -> Array:
    """Time, push and positions (N, 2 + masses), SI."""
    random = np.random.default_rng(7)
    springs, dampers = np.zeros((masses, masses)), np.zeros((masses, masses))
    for matrix, size in (springs, STIFFNESS), (dampers, DAMPING):
        for i in range(masses):
            matrix[i, i] += size
            if i:
                matrix[i - 1, i - 1] += size
                matrix[i - 1, i] = matrix[i, i - 1] = -size
    dampers[masses // 2, masses // 2] += CONCEALED
    fastest = 2 * math.sqrt(STIFFNESS / MASS)
    speeds, turns = random.uniform(1.0, fastest, 12), random.uniform(0, 2 * math.pi, 12)
    t = STEP * np.arange(samples)
    push, rows = np.zeros(samples), np.zeros((samples, masses))
    for speed, turn in zip(speeds, turns, strict=True):
        wave = PUSH * np.exp(1j * (speed * t + turn))
        response = np.linalg.inv(springs + 1j * speed * dampers - speed**2 * MASS * np.eye(masses))
        push += wave.imag
        rows += np.outer(wave, response[:, 0]).imag
    rows += noise * rows.std(axis=0) * random.standard_normal(rows.shape)
    return np.column_stack([t, push, rows])


def diagnosed(masses: int, samples: int, folder: Path) -> Cost:
    """Write the chain and its recording, and diagnose it.

    Raises:
        RuntimeError: the diagnosis failed, or did not name the concealed damper, or not it alone.
    """
    model, data, output = folder / "chain.toml", folder / "run.csv", folder / f"{masses}-{samples}"
    model.write_text(chain(masses), encoding="utf-8")
    header = ",".join(["t", "f", *(f"s{i}" for i in range(masses))])
    table = recorded(masses, samples)
    np.savetxt(data, table, delimiter=",", header=header, comments="", fmt="%.9g")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    code = (
        "import resource, sys; from symhyb.cli.app import main\n"
        "try: main()\n"
        "finally: print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, file=sys.stderr)"
    )
    line = [sys.executable, "-c", code, "diagnose", str(model), str(data), "-o", str(output)]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    answer = output / "diagnosis.json"
    if not answer.exists():
        raise RuntimeError(f"{masses} masses, {samples} samples: {done.stderr}")
    found = json.loads(answer.read_text(encoding="utf-8"))["found"]
    if [(one["kind"], one["place"]) for one in found] != [("damper", {"on": f"x{masses // 2}"})]:
        raise RuntimeError(f"{masses} masses, {samples} samples: {found}")
    (value,) = (one["value"] for one in found[0]["parameters"].values())
    memory = 1024.0 * float(done.stderr.split()[-1])
    return Cost(seconds, memory, abs(value / CONCEALED - 1))


def rows(masses: Sequence[int] = (2, 4, 8), samples: Sequence[int] = (10**5, 10**6)) -> list[Row]:
    """Bars of growth."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        diagnosed(1, 1000, folder)  # compiles what serves every model
        chains = [diagnosed(count, 3000, folder) for count in masses]
        long = [diagnosed(1, count, folder) for count in samples]
    # a coordinate and a spring each
    each = [cost.seconds / (2 * count) for cost, count in zip(chains, masses, strict=True)]
    power = math.log(each[-1] / each[0]) / math.log(masses[-1] / masses[0])
    worst = max(cost.error for cost in [*chains, *long])
    about = f"power of the masses, {masses[0]} to {masses[-1]}, with which the time a place grows"
    return [
        Row(PART, about, power, 1.5, note=_seconds(masses, chains)),
        Row(PART, f"peak of memory, {masses[-1]} masses", chains[-1].bytes / 1e9, unit=" GB"),
        Row(
            PART,
            f"one mass: time of {samples[-1]} samples over that of {samples[0]}",
            long[-1].seconds / long[0].seconds,
            samples[-1] / samples[0],
            unit="×",
            note=_seconds(samples, long),
        ),
        Row(
            PART,
            f"peak of memory, {samples[-1]} samples",
            long[-1].bytes / 1e9,
            2.0,
            unit=" GB",
            note=f"the damper is off by {100 * worst:.2g} % at most",
        ),
    ]


def _seconds(counts: Sequence[int], costs: Sequence[Cost]) -> str:
    return ", ".join(f"{n}: {cost.seconds:.3g} s" for n, cost in zip(counts, costs, strict=True))

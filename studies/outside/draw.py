"""Draw cases of kinds outside the vocabulary, and write them with their answers sealed.

    python studies/outside/draw.py --seeds 0-9 [--kinds magnet,gust] -o build/outside

A case is a kind and a seed: a folder with model.toml, train.csv, holdout.csv and sealed.json. Its
name does not give the kind away. Where no draw was visible it holds discarded.json alone.
"""

import argparse
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from bare import Bare, known_of, log_uniform, rms
from kinds import KINDS, TABLE, Kind
from machines import MACHINES, measured_names, uncertain
from shared import (
    Array,
    System,
    UnboundedError,
    seal,
    seeds_of,
    signal_of,
    start_of,
)
from simulate import Change, Motion, Plant, simulate
from visible import BEYOND_LEAST, SNR_LEAST, Windows, visibility

NOISE = (0.002, 0.02)  # of the RMS of each sensor
TRIES = 12
HOLDOUT = 0.6  # of the length of the training recording
WIDEST = 3.0  # times the motion without the change; beyond, it is another machine


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One recording of a case: the motion, what sensors read (n, N) without noise, the recorded
    inputs (k, N)."""

    change: Change
    motion: Motion
    shown: Array
    recorded: Array


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A drawn case: two runs, the noise (relative, and n of them), how clearly it shows."""

    kind: Kind
    seed: int
    system: System
    runs: tuple[Run, Run]
    noise: float
    sd: Array
    snr: float
    beyond: float
    discarded: int


def system_of(kind: Kind, seed: int) -> System:
    """The machine of a case; the machines of a kind take turns."""
    return MACHINES[kind.machines[seed % len(kind.machines)]]


def folder_of(kind: Kind, seed: int, build: Path) -> Path:
    """Where a case lies."""
    return build / f"{seed:04d}-{kind.number:08x}-{system_of(kind, seed).name}"


def draw(kind: Kind, seed: int) -> Case | int:
    """The case of a kind and a seed, or the number of draws after which it was given up."""
    for attempt in range(TRIES):
        try:
            case = _attempt(kind, seed, attempt)
        except UnboundedError:
            continue
        if case is not None:
            return case
    return TRIES


def _attempt(kind: Kind, seed: int, attempt: int) -> Case | None:
    system = system_of(kind, seed)
    key = [seed, kind.number, attempt]
    random = np.random.default_rng([*key, 0])
    signals = [signal_of(system, random, random.uniform(0.75, 1.3)) for _ in range(2)]
    starts = [start_of(system, random) for _ in range(2)]
    noise = log_uniform(random, *NOISE)
    values = system.values()
    lengths = (system.duration, HOLDOUT * system.duration)
    times = [np.arange(round(T * system.rate) + 1) / system.rate for T in lengths]
    free = [
        simulate(Plant(system, Change(), values, signals[i]), times[i], starts[i]) for i in range(2)
    ]
    t, q, v, u = free[0].t, free[0].q, free[0].v, free[0].u
    bare = Bare(system, values, t, q, v, u, known_of(system, values, q, v, u))
    runs = []
    for i in range(2):
        sizes, fresh = (np.random.default_rng([*key, 1, j * (i + 1)]) for j in range(2))
        change = kind.make(bare, sizes, fresh)
        motion = simulate(Plant(system, change, values, signals[i]), times[i], starts[i])
        runs.append(_run(change, motion, np.random.default_rng([*key, 2, i])))
        wide = np.any(motion.q.std(axis=1) > WIDEST * free[i].q.std(axis=1))
        if wide or system.met(values, motion.q):
            return None
    sd = noise * runs[0].shown.std(axis=1)
    snr = beyond = 0.0
    if "noise" not in kind.classes:
        snr, beyond = _visibility(bare, runs[0], sd)
        if snr < SNR_LEAST or (kind.absorbed and beyond < BEYOND_LEAST):
            return None
    return Case(kind, seed, system, (runs[0], runs[1]), noise, sd, snr, beyond, attempt)


def _run(change: Change, motion: Motion, random: np.random.Generator) -> Run:
    shown, recorded = motion.q, motion.u
    if change.show is not None:
        shown = change.show(motion.t, motion.q, motion.z)
    if change.record is not None:
        recorded = change.record(random, motion.t, motion.u)
    return Run(change, motion, shown, recorded)


def _visibility(bare: Bare, run: Run, sd: Array) -> tuple[float, float]:
    motion = run.motion
    smooth = not run.change.hold and run.change.record is None
    windows = Windows(bare.system, motion.t, motion.q, motion.v, run.recorded, smooth)
    return visibility(windows, bare.values, bare.known, run.shown, sd)


def measured(case: Case, index: int) -> tuple[list[str], Array]:
    """Column names and a recording (N, columns), noise included."""
    run = case.runs[index]
    random = np.random.default_rng([case.seed, case.kind.number, 3, index])
    t = run.motion.t
    if run.change.taint is None:
        y = run.shown + case.sd[:, None] * random.standard_normal(run.shown.shape)
    else:
        y = run.change.taint(random, t, run.shown, case.sd)
    names = ["t", *case.system.inputs, *measured_names(case.system)]
    return names, np.column_stack([t, *run.recorded, *y])


def answer(case: Case) -> dict[str, Any]:
    """What acts, for the seal."""
    change = case.runs[0].change
    return {
        "kind": case.kind.name,
        "seed": case.seed,
        "machine": case.system.name,
        "classes": case.kind.classes,
        "accepted": case.kind.accepted,
        "place": change.place,
        "facts": dict(change.facts or {}),
        "law": change.law,
        "values": {name: value for name, (value, _) in uncertain(case.system).items()},
        "noise": case.noise,
        "sd": case.sd.tolist(),
        "snr": case.snr,
        "beyond": case.beyond,
        "drive": [rms(u) for u in case.runs[0].motion.u],
        "discarded": case.discarded,
    }


def write(kind: Kind, seed: int, build: Path) -> Path | None:
    """Draw a case into its folder unless it is there; None where no draw was visible."""
    folder = folder_of(kind, seed, build)
    if (folder / "sealed.json").exists():
        return folder
    if (folder / "discarded.json").exists():
        return None
    folder.mkdir(parents=True, exist_ok=True)
    case = draw(kind, seed)
    if isinstance(case, int):
        given_up = {"kind": kind.name, "discarded": case}
        (folder / "discarded.json").write_text(seal(given_up), encoding="ascii")
        return None
    (folder / "model.toml").write_text(case.system.text(), encoding="utf-8")
    for index, name in enumerate(("train.csv", "holdout.csv")):
        header, columns = measured(case, index)
        np.savetxt(
            folder / name, columns, fmt="%.9g", delimiter=",", header=",".join(header), comments=""
        )
    (folder / "sealed.json").write_text(seal(json.loads(json.dumps(answer(case)))), "ascii")
    return folder


def kinds_of(text: str) -> list[Kind]:
    """Kinds by their names with commas, all without a name; blanks may be hyphens."""
    if not text:
        return list(TABLE)
    names = {name.replace(" ", "-").replace(",", ""): kind for name, kind in KINDS.items()}
    wanted = text.replace(" ", "-").split(",")
    unknown = [name for name in wanted if name not in names]
    if unknown:
        raise SystemExit(f"no kind {', '.join(unknown)}; there are {', '.join(names)}")
    return [names[name] for name in wanted]


def main() -> None:
    """Write the cases of some seeds and kinds."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-9")
    parser.add_argument("--kinds", default="", help="names, with commas")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/outside"))
    options = parser.parse_args()
    for seed in seeds_of(options.seeds):
        for kind in kinds_of(options.kinds):
            folder = write(kind, seed, options.output)
            print(seed, kind.name, "kept" if folder else "no visible draw", flush=True)


if __name__ == "__main__":
    main()

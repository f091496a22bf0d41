"""Does the advice help? Ambiguous recordings, what the diagnosis asks for next, and both together.

    python studies/record_next/follow.py            # every case, three seeds: writes results.json
    python studies/record_next/follow.py damping 3  # one case, one seed

Only the structured advice (``manoeuvre`` of the diagnosis) is read. What the machine does under it
is simulated by generate.py, which knows nothing of symhyb and of what the diagnosis believes.
"""

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import generate
import numpy as np
from numpy.typing import NDArray

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.discrepancy.results import Diagnosis, Manoeuvre

HERE = Path(__file__).resolve().parent
Array = NDArray[np.float64]
RATE, SETTLED, LASTING = 100.0, 20.0, 20.0  # samples a second; s until it swings evenly; s recorded
SEEDS = range(1, 4)


@dataclass(frozen=True, slots=True)
class Case:
    """What is concealed, the sine that cannot show it (Hz, N), the noise relative to the motion it
    gives, and the answers that are right, as ``kind:place or channel``."""

    hidden: Mapping[str, float]
    frequency: float
    amplitude: float
    noise: float
    right: tuple[str, ...]


CASES = {
    "damping": Case({"damping": 2.0}, 0.5, 4.0, 0.03, ("damper:x",)),
    "delay": Case({"delay": 0.02}, 0.3, 4.0, 0.03, ("delay:f", "delay:laser")),
    "mass": Case({"mass": 0.2}, 0.8, 4.0, 0.03, ("added_mass:x",)),
    "drag": Case({"drag": 6.0}, 1.0, 4.0, 0.06, ("drag:x",)),
    "relaxation": Case({"stiffness": 60.0, "time": 0.03}, 0.4, 4.0, 0.03, ("relaxation:x",)),
    "friction": Case({"coulomb": 0.15}, 1.0, 4.0, 0.06, ("friction:x",)),
}


def first_recording(case: Case, seed: int) -> tuple[Recording, float]:
    """The sine after everything has settled, and the noise of the laser in m."""
    t = np.arange(0, (SETTLED + LASTING) * RATE) / RATE

    def force(s: float) -> float:
        return case.amplitude * float(np.sin(2 * np.pi * case.frequency * s))

    x = generate.simulate(t, force, case.hidden)
    late = t >= SETTLED
    sd = case.noise * float(np.std(x[late]))
    columns = generate.recorded(t, force, x, sd, seed)
    return _recording("first.csv", {key: row[late] for key, row in columns.items()}), sd


def next_recording(case: Case, plan: Manoeuvre, sd: float, seed: int) -> Recording:
    """What the machine does under the manoeuvre that was asked for."""
    count = round(plan.duration / plan.sampling)
    t = plan.sampling * np.arange(count + 1)
    start = (plan.amplitude, 0.0) if plan.signal == "release" else (0.0, 0.0)

    def force(s: float) -> float:
        return signal(plan, s)

    x = generate.simulate(t, force, case.hidden, start)
    return _recording("next.csv", generate.recorded(t, force, x, sd, 1000 + seed))


def signal(plan: Manoeuvre, t: float) -> float:
    """The force in N at t seconds, as docs/output.md states the signals."""
    lo, hi = plan.frequency or (0.0, 0.0)
    turn = 2 * np.pi * lo * t
    if plan.signal == "release":
        return 0.0
    if plan.signal == "sine":
        wave = np.sin(turn)
    elif plan.signal == "sweep":
        octaves = np.log(hi / lo)
        wave = np.sin(
            2 * np.pi * lo * plan.duration * np.expm1(octaves * t / plan.duration) / octaves
        )
    elif plan.signal == "multisine":
        wave = _lines(lo, hi, np.array([t]))[0] / _peak(lo, hi, plan.duration, plan.sampling)
    elif plan.signal == "steps":
        wave = (1.0, 0.0, -1.0, 0.0)[int(4 * lo * t + 1e-9) % 4]
    else:
        wave = 2 / np.pi * np.arcsin(np.sin(turn))
    return plan.offset + plan.amplitude * float(wave)


def _lines(lo: float, hi: float, t: Array) -> Array:
    k = np.arange(1, 9)[:, None]
    f = lo + (k - 1) * (hi - lo) / 7
    return np.asarray(np.sin(2 * np.pi * f * t - np.pi * k * (k - 1) / 8).sum(axis=0))


def _peak(lo: float, hi: float, duration: float, step: float) -> float:
    return float(np.abs(_lines(lo, hi, np.arange(0, duration + step / 2, step))).max())


def _recording(name: str, columns: Mapping[str, Array]) -> Recording:
    t = columns["t"] - columns["t"][0]
    return Recording(name, t, {"f": columns["f"]}, {"laser": columns["laser"]}, (), "")


def claims(diagnosis: Diagnosis) -> list[str]:
    """All that a diagnosis names, as ``kind:where``."""
    effects = [f"{item.element.kind}:x" for item in diagnosis.found]
    channels = [f"{fault.kind}:{fault.channel}" for fault in diagnosis.measurement]
    return effects + channels + [f"parameter:{item.name}" for item in diagnosis.parameters]


def rivals(diagnosis: Diagnosis) -> list[str]:
    """All that it does not rule out."""
    return [f"{r.kind}:{r.channel or r.parameter or 'x'}" for r in diagnosis.alternatives]


def followed(name: str, seed: int) -> dict[str, object]:
    """Diagnose, record what is asked for, diagnose both."""
    case, model = CASES[name], sh.read_model(HERE / "machine.toml")
    first, sd = first_recording(case, seed)
    before = sh.diagnose(model, first)
    row: dict[str, object] = {
        "case": name,
        "seed": seed,
        "verdict": before.verdict,
        "named": claims(before),
        "not ruled out": rivals(before),
        "record_next": before.record_next,
    }
    if before.manoeuvre is None:
        return row
    after = sh.diagnose(model, [first, next_recording(case, before.manoeuvre, sd, seed)])
    named = claims(after)
    row |= {
        "then": after.verdict,
        "then named": named,
        "then not ruled out": rivals(after),
        "right": len(named) == 1 and named[0] in case.right,
    }
    return row


def main(arguments: list[str]) -> None:
    """Follow the advice in the cases and seeds that are asked for."""
    names = arguments[:1] or list(CASES)
    seeds = [int(text) for text in arguments[1:]] or list(SEEDS)
    rows = []
    for name in names:
        for seed in seeds:
            rows.append(followed(name, seed))
            print(json.dumps(rows[-1], ensure_ascii=False), flush=True)
    if not arguments:
        (HERE / "results.json").write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])

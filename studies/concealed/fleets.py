"""Several recordings at once: how often is one wrongly said not to fit, and how often rightly?

    python studies/concealed/fleets.py --seeds 0-99 -o build/fleets

Every seed conceals one force in a machine with one coordinate and records four runs of it and an
unseen one. It is diagnosed twice: as it is, so that any recording that is named is a false alarm,
and with the force half as large again in the third run. Resumable: one JSON a seed.
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from bars import bound
from conceal import Case, recorded, signal_of, start_of
from draw import measured, model_text
from effects import draw_effect, place_of, sensible
from hidden import Hidden, channels
from joblib import Parallel, delayed
from laws import Effect
from oracle import Run
from plans import SYSTEMS, Plan, seeds_of
from plant import UnboundedError

RUNS = 4  # and the unseen one
ODD, MORE = 2, 1.5  # the run that differs, and by how much
NOISES = (0.01, 0.05)
KEYS = {
    "spring.stiffness": "stiffness",
    "spring.cubic": "cubic",
    "damper": "damping",
    "drag": "drag",
    "friction": "coulomb",
    "constant": "constant",
}
LOW, HIGH = 0.03, 0.3  # the concealed force over the largest known one, RMS


def drawn(seed: int, odd: bool) -> Case | None:
    """Five runs of a machine with the same concealed force, or with more of it in one of them; None
    where a motion does not stay bounded."""
    random = np.random.default_rng([seed, 7])
    system = random.choice(np.array([s for s in SYSTEMS if s.n == 1], dtype=object))
    kind = str(random.choice(list(KEYS)))
    plan = Plan(seed, system, kind, float(random.choice(NOISES)), False, False)
    names = channels(system, plan.complete)
    signals = [signal_of(system, random, random.uniform(0.75, 1.3)) for _ in range(RUNS + 1)]
    starts = [start_of(system, random) for _ in range(RUNS + 1)]
    share = float(np.exp(random.uniform(np.log(LOW), np.log(HIGH))))
    runs: list[Run] = []
    try:
        bare = recorded(plan, Hidden(), signals[0], starts[0], system.duration, names, None)
        place = place_of(bare.plant, bare.motion, bare.inputs, sensible(kind, system)[0])
        effect = draw_effect(kind, place, share, random)
        for i, (signal, start) in enumerate(zip(signals, starts, strict=True)):
            here = Hidden((_more(effect, kind) if odd and i == ODD else effect,))
            sd = runs[0].sd if runs else None
            runs.append(recorded(plan, here, signal, start, system.duration, names, sd))
    except (UnboundedError, np.linalg.LinAlgError):
        return None
    return Case(plan, runs[0].hidden, tuple(runs), np.empty(0), (share,), [], 0, 0.0)


def _more(effect: Effect, kind: str) -> Effect:
    key = KEYS[kind]
    return replace(effect, keys={**effect.keys, key: MORE * effect.keys[key]})


def said(case: Case, folder: Path) -> dict[str, Any]:
    """What symhyb says of a fleet: verdict, recordings that do not fit, numbers not constant."""
    import symhyb as sh

    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "model.toml"
    path.write_text(model_text(case.plan.system, case.runs[0].names), encoding="utf-8")
    model = sh.read_model(path)
    recordings = []
    for i in range(RUNS + 1):
        header, columns = measured(case, i)
        name = folder / f"run{i}.csv"
        np.savetxt(name, columns, fmt="%.9g", delimiter=",", header=",".join(header), comments="")
        recordings.append(sh.read_recording(name, model))
    try:
        reported = sh.diagnose(model, recordings[:RUNS], recordings[RUNS])
    except (sh.InputError, sh.NumericsError) as error:
        return {"verdict": "", "failed": str(error), "misfits": [], "changes": []}
    return {
        "verdict": reported.verdict,
        "misfits": [one.recording for one in reported.misfits],
        "changes": [one for one in reported.notes if "is not constant" in one],
    }


def one(seed: int, build: Path) -> str:
    """Both diagnoses of a seed, unless they were made; what came out, in words."""
    target = build / f"{seed:05d}.json"
    if not target.exists():
        both = {}
        for arm in ("alike", "odd"):
            case = drawn(seed, arm == "odd")
            if case is None:
                both = {}
                break
            both[arm] = said(case, build / f"{seed:05d}-{arm}") | {
                "system": case.plan.system.name,
                "kind": case.plan.kind,
                "noise": case.plan.noise,
            }
        part = target.with_suffix(".part")
        part.write_text(json.dumps(both, indent=1) + "\n", encoding="utf-8")
        part.replace(target)
    both = json.loads(target.read_text(encoding="utf-8"))
    return f"{seed}: " + "; ".join(f"{k} {v['verdict']} {v['misfits']}" for k, v in both.items())


def table(build: Path, seeds: list[int]) -> str:
    """What came out, in Markdown."""
    paths = [build / f"{seed:05d}.json" for seed in seeds]
    kept = [json.loads(p.read_text(encoding="utf-8")) for p in paths if p.exists()]
    kept = [both for both in kept if both]
    lines = [
        f"{len(kept)} machines, {RUNS} runs each.",
        "",
        "| | fleets | odd run named | a run that fits named | a number said not to be constant |",
        "|---|---|---|---|---|",
    ]
    for arm, words in (("alike", "all alike"), ("odd", f"one with {MORE:g} times the force")):
        rows = [both[arm] for both in kept if both[arm]["verdict"] == "missing physics"]
        odd = [f"run{ODD}.csv" in row["misfits"] and arm == "odd" for row in rows]
        fits = [
            any(name != f"run{ODD}.csv" or arm == "alike" for name in row["misfits"])
            for row in rows
        ]
        changes = [bool(row["changes"]) for row in rows]
        said_odd = f"{sum(odd)}" if arm == "odd" else "–"
        lines.append(f"| {words} | {len(rows)} | {said_odd} | {_share(fits)} | {_share(changes)} |")
    return "\n".join(lines)


def _share(flags: list[bool]) -> str:
    return f"{sum(flags)} (at most {bound(sum(flags), len(flags)):.1%}, 95 %)"


def main() -> None:
    """Diagnose the fleets of some seeds and print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-99")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("-o", "--output", type=Path, default=Path("build/fleets"))
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    seeds = seeds_of(options.seeds)
    for line in Parallel(n_jobs=options.workers, return_as="generator")(
        delayed(one)(seed, options.output) for seed in seeds
    ):
        print(line, flush=True)
    print(table(options.output, seeds))


if __name__ == "__main__":
    main()

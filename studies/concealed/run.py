"""Diagnose drawn cases, each in a process of its own, and keep one JSON a case; resumable.

    python studies/concealed/run.py --seeds 0-99 [--systems duffing,table] [--kinds friction,null]

Nothing here opens a seal: score.py does, afterwards.
"""

import argparse
import json
import os
import subprocess
import sys
import time
import traceback
from pathlib import Path
from typing import Any

from draw import write
from joblib import Parallel, delayed
from plans import folder_of, plan_of, seeds_of

LIMIT_S = 1200.0  # of one case


def diagnose(folder: Path) -> dict[str, Any]:
    """What symhyb says of a case, the seconds it took, or how it failed."""
    import symhyb as sh
    from symhyb.report.contract import to_json

    begin = time.perf_counter()
    try:
        model = sh.read_model(folder / "model.toml")
        train, holdout = (
            sh.read_recording(folder / f"{x}.csv", model) for x in ("train", "holdout")
        )
        begin = time.perf_counter()
        diagnosis = sh.diagnose(model, train, holdout)
        seconds = time.perf_counter() - begin
        corrected = sh.apply(model, diagnosis.found, diagnosis.parameters, diagnosis.measurement)
        verdict = sh.judge(model, corrected, holdout, train=train)
        return {"seconds": seconds, "diagnosis": to_json(diagnosis, verdict)}
    except Exception as error:  # a crash is a result too: it is told, not lost
        seconds = time.perf_counter() - begin
        sort = "sentence" if isinstance(error, sh.InputError | sh.NumericsError) else "crash"
        return {"seconds": seconds, sort: str(error), "traceback": traceback.format_exc()}


def one(seed: int, build: Path, results: Path) -> str:
    """Draw and diagnose one case unless that was done; what happened, in words."""
    target = results / f"{folder_of(seed, build).name}.json"
    if target.exists():
        return f"{target.stem}: there"
    folder = write(seed, build)
    if folder is None:
        return f"{target.stem}: no complete draw"
    told = diagnose(folder)
    part = target.with_suffix(".part")
    part.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    part.replace(target)
    said = told["diagnosis"]["verdict"] if "diagnosis" in told else "failed"
    return f"{target.stem}: {said} in {told['seconds']:.0f} s"


def _apart(seed: int, options: argparse.Namespace) -> None:
    """One case in a process of its own, so that no crash takes the others along."""
    command = [sys.executable, __file__, "--one", str(seed), "-o", str(options.output),
               "--results", str(options.results)]  # fmt: skip
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    try:
        done = subprocess.run(
            command, timeout=LIMIT_S, env=environment, capture_output=True, text=True, check=False
        )
        said = done.stdout.strip() or f"{seed}: ended with {done.returncode}: {done.stderr[-300:]}"
    except subprocess.TimeoutExpired:
        said = f"{seed}: not done after {LIMIT_S:g} s"
        name = folder_of(seed, options.output).name
        told = {"seconds": LIMIT_S, "crash": said}
        (options.results / f"{name}.json").write_text(json.dumps(told) + "\n", encoding="utf-8")
    print(said, flush=True)


def wanted(options: argparse.Namespace) -> list[int]:
    """The seeds whose plan has one of the systems and kinds asked for."""
    chosen = []
    for seed in seeds_of(options.seeds):
        plan = plan_of(seed)
        systems, kinds = options.systems.split(","), options.kinds.split(",")
        if options.systems and plan.system.name not in systems:
            continue
        if options.kinds and not any(plan.kind.startswith(kind) for kind in kinds):
            continue
        chosen.append(seed)
    return chosen[: options.limit] if options.limit else chosen


def main() -> None:
    """Run the cases of some seeds."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-99")
    parser.add_argument("--systems", default="", help="names, with commas")
    parser.add_argument("--kinds", default="", help="beginnings of kinds, with commas")
    parser.add_argument("--limit", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--one", type=int, default=None, help=argparse.SUPPRESS)
    parser.add_argument("-o", "--output", type=Path, default=Path("build/concealed"))
    parser.add_argument("--results", type=Path, default=Path("build/concealed/results"))
    options = parser.parse_args()
    options.results.mkdir(parents=True, exist_ok=True)
    if options.one is not None:
        print(one(options.one, options.output, options.results))
        return
    tasks = (delayed(_apart)(seed, options) for seed in wanted(options))
    Parallel(n_jobs=options.workers, prefer="threads")(tasks)


if __name__ == "__main__":
    main()

"""Diagnose drawn cases, each in a process of its own, and keep one JSON a case; resumable.

    python studies/outside/run.py --seeds 0-9 [--kinds magnet,gust] [--limit 20] [--workers 1]
    python studies/outside/run.py --seeds 0-9 --package ../other --results build/outside/other

With ``--package`` the symhyb in that checkout diagnoses the same cases. Nothing here opens a seal:
score.py does, afterwards.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from draw import folder_of, kinds_of, write
from joblib import Parallel, delayed
from kinds import KINDS, Kind
from shared import diagnose, seeds_of

ROOT = Path(__file__).resolve().parents[2]


def one(kind: Kind, seed: int, build: Path, results: Path) -> str:
    """Draw and diagnose one case unless that was done; what happened, in words."""
    folder = write(kind, seed, build)
    if folder is None:
        return f"{folder_of(kind, seed, build).name}: no visible draw"
    reported = diagnose(folder)
    keep(reported, results / f"{folder.name}.json")
    said = reported["diagnosis"]["verdict"] if "diagnosis" in reported else "failed"
    return f"{folder.name}: {said} in {reported['seconds']:.0f} s"


def keep(reported: dict[str, Any], target: Path) -> None:
    """Write a result at once or not at all, verdict and sentence first."""
    diagnosis = reported.get("diagnosis", {})
    first = {key: diagnosis[key] for key in ("verdict", "sentence") if key in diagnosis}
    part = target.with_suffix(".part")
    part.write_text(json.dumps({**first, **reported}, indent=1) + "\n", encoding="utf-8")
    part.replace(target)


def _apart(kind: Kind, seed: int, options: argparse.Namespace) -> None:
    """One case in a process of its own, so that no crash takes the others along."""
    target = options.results / f"{folder_of(kind, seed, options.output).name}.json"
    if target.exists():
        return
    case = ["--one", kind.name, "--seeds", str(seed)]
    folders = ["-o", str(options.output), "--results", str(options.results)]
    paths = [str(options.package.resolve()), os.environ.get("PYTHONPATH", "")]
    environment = {
        **os.environ,
        "OMP_NUM_THREADS": "1",
        "PYTHONPATH": os.pathsep.join(filter(None, paths)),
    }
    try:
        done = subprocess.run(
            [sys.executable, __file__, *case, *folders],
            timeout=options.timeout,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        said = done.stdout.strip() or f"{target.stem}: ended with {done.returncode}"
        if done.returncode:
            keep({"seconds": 0.0, "crash": done.stderr[-2000:]}, target)
    except subprocess.TimeoutExpired:
        said = f"{target.stem}: not done after {options.timeout:g} s"
        keep({"seconds": options.timeout, "cpu_seconds": options.timeout, "crash": said}, target)
    print(said, flush=True)


def main() -> None:
    """Run the cases of some seeds and kinds."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-9")
    parser.add_argument("--kinds", default="", help="names, with commas")
    parser.add_argument("--limit", type=int, default=0, help="at most so many cases")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=1200.0, help="s, of a case")
    parser.add_argument("--package", type=Path, default=ROOT, help="checkout that diagnoses")
    parser.add_argument("--one", default=None, help=argparse.SUPPRESS)
    parser.add_argument("-o", "--output", type=Path, default=Path("build/outside"))
    parser.add_argument("--results", type=Path, default=Path("build/outside/results"))
    options = parser.parse_args()
    options.results.mkdir(parents=True, exist_ok=True)
    if options.one is not None:
        print(one(KINDS[options.one], int(options.seeds), options.output, options.results))
        return
    cases = [(kind, seed) for seed in seeds_of(options.seeds) for kind in kinds_of(options.kinds)]
    cases = cases[: options.limit] if options.limit else cases
    tasks = (delayed(_apart)(kind, seed, options) for kind, seed in cases)
    Parallel(n_jobs=options.workers, prefer="threads")(tasks)


if __name__ == "__main__":
    main()

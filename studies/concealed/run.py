"""Diagnose drawn cases, each in a process of its own, and keep one JSON a case; resumable.

    python studies/concealed/run.py --seeds 0-99 [--systems duffing,table] [--kinds friction,null]
    python studies/concealed/run.py --seeds 1000-2999 --concealed 300 --nulls 300
    python studies/concealed/run.py --seeds 0-99 --harder

Nothing here opens a seal: score.py does, afterwards. With ``--concealed`` and ``--nulls`` so many
cases are run, in the order of the seeds; seeds without a complete draw are replaced by later ones.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

from diagnosing import commit, diagnose
from draw import write
from joblib import Parallel, delayed
from plans import PLAIN, Sort, add_sort, folder_of, in_turn, plan_of, seeds_of

LIMIT_S = 1200.0  # of one case


def one(seed: int, build: Path, results: Path, sort: Sort = PLAIN) -> str:
    """Draw and diagnose one case unless that was done; what happened, in words."""
    target = results / f"{folder_of(seed, build).name}.json"
    if target.exists():
        return f"{target.stem}: there"
    folder = write(seed, build, sort)
    if folder is None:
        return f"{target.stem}: no complete draw"
    reported = diagnose(folder)
    part = target.with_suffix(".part")
    part.write_text(json.dumps(reported, indent=1) + "\n", encoding="utf-8")
    part.replace(target)
    said = reported["diagnosis"]["verdict"] if "diagnosis" in reported else "failed"
    return f"{target.stem}: {said} in {reported['seconds']:.0f} s"


def _apart(seed: int, options: argparse.Namespace) -> None:
    """One case in a process of its own, so that no crash takes the others along."""
    command = [
        sys.executable,
        __file__,
        "--one",
        str(seed),
        "-o",
        str(options.output),
        "--results",
        str(options.results),
        *["--harder"] * options.harder,
        *["--keep-hard"] * options.keep_hard,
    ]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    try:
        done = subprocess.run(
            command, timeout=LIMIT_S, env=environment, capture_output=True, text=True, check=False
        )
        said = done.stdout.strip() or f"{seed}: ended with {done.returncode}: {done.stderr[-300:]}"
    except subprocess.TimeoutExpired:
        said = f"{seed}: not done after {LIMIT_S:g} s"
        name = folder_of(seed, options.output).name
        reported = {"seconds": LIMIT_S, "cpu_seconds": LIMIT_S, "crash": said, "commit": commit()}
        (options.results / f"{name}.json").write_text(json.dumps(reported) + "\n", encoding="utf-8")
    print(said, flush=True)


def wanted(options: argparse.Namespace) -> list[int]:
    """The seeds whose plan has one of the systems and kinds asked for, as many as asked for."""
    systems, kinds = options.systems.split(","), options.kinds.split(",")
    turns = tuple(float(x) for x in options.turns.split(","))
    left = [_most(options.concealed), _most(options.nulls)]
    chosen = []
    for seed in seeds_of(options.seeds):
        plan, null = plan_of(seed), seed % 2
        if options.systems and plan.system.name not in systems:
            continue
        if options.kinds and not any(plan.kind.startswith(kind) for kind in kinds):
            continue
        given_up = (folder_of(seed, options.output) / "discarded.json").exists()
        if given_up or left[null] < 1 or (null and not in_turn(seed, turns)):
            continue
        left[null] -= 1
        chosen.append(seed)
    return chosen[: options.limit] if options.limit else chosen


def _most(count: int | None) -> float:
    return float("inf") if count is None else count


def waiting(options: argparse.Namespace) -> list[int]:
    """The wanted seeds that have no result yet."""
    return [
        seed
        for seed in wanted(options)
        if not (options.results / f"{folder_of(seed, options.output).name}.json").exists()
    ]


def main() -> None:
    """Run the cases of some seeds."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-99")
    parser.add_argument("--systems", default="", help="names, with commas")
    parser.add_argument("--kinds", default="", help="beginnings of kinds, with commas")
    parser.add_argument("--concealed", type=int, default=None, help="so many with something in it")
    parser.add_argument("--nulls", type=int, default=None, help="so many with nothing concealed")
    parser.add_argument(
        "--turns",
        default="1,1,1",
        help="share of the null cases that is run, of "
        "systems with one, two or three, and more coordinates",
    )
    parser.add_argument("--limit", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--one", type=int, default=None, help=argparse.SUPPRESS)
    add_sort(parser)
    parser.add_argument("--results", type=Path, help="default: results in the folder of the cases")
    options = parser.parse_args()
    sort = Sort(options.harder, options.keep_hard)
    options.output = options.output or sort.build
    options.results = options.results or options.output / "results"
    options.results.mkdir(parents=True, exist_ok=True)
    if options.one is not None:
        print(one(options.one, options.output, options.results, sort))
        return
    tried: set[int] = set()
    while seeds := [seed for seed in waiting(options) if seed not in tried]:
        tasks = (delayed(_apart)(seed, options) for seed in seeds)
        Parallel(n_jobs=options.workers, prefer="threads")(tasks)
        tried |= set(seeds)  # again, because draws that were given up are replaced by later ones


if __name__ == "__main__":
    main()

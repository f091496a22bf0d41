"""Run the frozen set with one checkout of symhyb and keep one JSON a case; resumable.

    python studies/frozen/run.py --label before [--package PATH] [--workers 2] [--quick]
    python studies/frozen/run.py --label after --package ../redesign --only emps,00002-duffing

Every case is one command line of symhyb, in a process of its own. Its cache holds what one
diagnosis of ``WARM`` leaves there (machine code for every model), so that times do not depend on
the order. ``--package`` is the root of another checkout; the cases stay those of this one.
compare.py holds two labels against each other.
"""

import argparse
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cases import BENCH, DATA, EXAMPLES, ROOT, Case, listed, missing

WARM = "00001-oscillator"  # its diagnosis fills the cache that every case begins with
LIMIT_S = 900.0  # of one case
ANSWERED = (0, 1)  # exit status of a diagnosis that ended
REFUSED = (2, 3)  # of one that ended with a sentence
BUILD = ROOT / "build" / "frozen"
DRAWN = ROOT / "build" / "concealed"


@dataclass(frozen=True, slots=True)
class Package:
    """A checkout of symhyb: its root, its commit (a + where files were changed after it) and a
    digest of its code."""

    root: Path
    commit: str
    code: str


def package_at(root: Path) -> Package:
    """The checkout at ``root``.

    Raises:
        SystemExit: there is no package symhyb.
    """
    files = sorted((root / "symhyb").rglob("*.py"))
    if not files:
        raise SystemExit(f"--package {root}: holds no folder symhyb with Python files")
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.relative_to(root).as_posix().encode() + b"\0" + file.read_bytes())
    changed = bool(_git(root, "status", "--porcelain", "--", "symhyb"))
    commit = (_git(root, "rev-parse", "--short=12", "HEAD") or "unknown") + "+" * changed
    return Package(root.resolve(), commit, digest.hexdigest()[:16])


def _git(root: Path, *words: str) -> str:
    try:
        done = subprocess.run(
            ["git", "-C", str(root), *words], capture_output=True, text=True, check=False
        )
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def command(case: Case, drawn: Path, output: Path) -> list[str]:
    """The command line of a case, behind ``python -m symhyb``."""
    if case.study:
        return ["run", str(ROOT / "studies" / case.study / "study.toml"), "-o", str(output)]
    if case.example:
        folder = Path(os.environ[EXAMPLES]).resolve() / case.example
    else:
        folder = drawn / case.name
    train = sorted(map(str, folder.glob("train*.csv")))
    model, holdout = folder / "model.toml", folder / "holdout.csv"
    return ["diagnose", str(model), *train, "--holdout", str(holdout), "-o", str(output)]


def draw(case: Case, drawn: Path) -> None:
    """Draw a concealed case unless it is there.

    Raises:
        SystemExit: the seed has no complete draw, so that the list is wrong.
    """
    if case.seed is None or (drawn / case.name / "sealed.json").exists():
        return
    script = [sys.executable, str(BENCH / "draw.py"), "--seeds", str(case.seed), "-o", str(drawn)]
    done = subprocess.run(script, capture_output=True, text=True, check=False)
    if not (drawn / case.name / "sealed.json").exists():
        raise SystemExit(f"{case.name}: could not be drawn: {done.stdout}{done.stderr[-500:]}")


def timed(
    words: list[str], environment: dict[str, str], folder: Path
) -> tuple[int | None, str, float, float]:
    """Run a command in ``folder``, where no other package lies.

    Gives the exit status (None: out of time), what was written to stderr, seconds on the clock,
    and seconds computed by the process and its children.
    """
    begin = time.perf_counter()
    with tempfile.TemporaryFile("w+", errors="replace") as said:
        process = subprocess.Popen(
            words,
            env=environment,
            cwd=folder,
            stdout=subprocess.DEVNULL,
            stderr=said,
            start_new_session=True,
        )
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            late = time.perf_counter() - begin > LIMIT_S
            if late and not pid:
                os.killpg(process.pid, signal.SIGKILL)
                _, status, usage = os.wait4(process.pid, 0)
            if pid or late:
                break
            time.sleep(0.05)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read()
    spent = usage.ru_utime + usage.ru_stime
    ended = process.returncode if pid else None
    return ended, text, time.perf_counter() - begin, spent


def warm(package: Package, results: Path, drawn: Path) -> Path:
    """The cache that every case of a label begins with; made by a diagnosis that is not kept."""
    cache = results / "cache"
    if not cache.exists():
        (case,) = (case for case in listed() if case.name == WARM)
        draw(case, drawn)
        empty = results / "cache.part"
        shutil.rmtree(empty, ignore_errors=True)
        empty.mkdir()
        diagnose(case, package, drawn, empty)
        empty.replace(cache)
    return cache


def diagnose(case: Case, package: Package, drawn: Path, cache: Path) -> dict[str, Any]:
    """What the package says of a case: its diagnosis, a sentence, or how it crashed. What it adds
    to an empty ``cache`` stays there, a full one is left as it is."""
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        own = cache
        if any(cache.iterdir()):
            own = Path(shutil.copytree(cache, scratch / "cache"))
        environment = {
            **os.environ,
            "PYTHONPATH": str(package.root),
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
            "XDG_CACHE_HOME": str(own.resolve()),
        }
        if environment.get(DATA):
            environment[DATA] = str(Path(environment[DATA]).resolve())
        words = [sys.executable, "-m", "symhyb", *command(case, drawn, scratch / "out")]
        status, text, seconds, spent = timed(words, environment, scratch)
        reported = {
            "case": case.name,
            "commit": package.commit,
            "code": package.code,
            "seconds": round(seconds, 2),
            "cpu_seconds": round(spent, 2),
            "status": status,
        }
        answer = scratch / "out" / "diagnosis.json"
        if status in ANSWERED and answer.exists():
            return {**reported, "diagnosis": json.loads(answer.read_text(encoding="utf-8"))}
    if status is None:
        return {**reported, "crash": f"not done after {LIMIT_S:g} s"}
    sort = "sentence" if status in REFUSED else "crash"
    return {**reported, sort: text.strip()[-1500:] or f"ended with {status}"}


def one(case: Case, package: Package, results: Path, drawn: Path, cache: Path) -> str:
    """Draw and run one case; what happened, in words."""
    reason = missing(case)
    if reason:
        return f"{case.name}: {reason}"
    draw(case, drawn)
    reported = diagnose(case, package, drawn, cache)
    part = results / f"{case.name}.part"
    part.write_text(json.dumps(reported, indent=1) + "\n", encoding="utf-8")
    part.replace(results / f"{case.name}.json")
    said = reported["diagnosis"]["verdict"] if "diagnosis" in reported else "no diagnosis"
    return f"{case.name}: {said}, {reported['cpu_seconds']:.1f} s computed"


def wanted(only: str, quick: bool) -> list[Case]:
    """The cases asked for, in the order of the list.

    Raises:
        SystemExit: names that are not in the list.
    """
    cases = listed()
    names = {name for name in only.split(",") if name}
    strange = names - {case.name for case in cases}
    if strange:
        raise SystemExit(f"--only: no such case in cases.toml: {', '.join(sorted(strange))}")
    return [
        case for case in cases if (case.name in names or not names) and (case.quick or not quick)
    ]


def waiting(cases: list[Case], package: Package, results: Path, again: bool) -> list[Case]:
    """The cases without a result; with ``again`` all.

    Raises:
        SystemExit: the label holds results of other code.
    """
    if again:
        return cases
    for path in sorted(results.glob("*.json")):
        reported = json.loads(path.read_text(encoding="utf-8"))
        if reported["code"] != package.code:
            raise SystemExit(
                f"{results} holds results of other code (commit {reported['commit']}, this is "
                f"{package.commit}): choose another --label, or replace them with --again"
            )
    return [case for case in cases if not (results / f"{case.name}.json").exists()]


def main() -> None:
    """Run the cases asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--label", default="here", help="name of the results in build/frozen")
    parser.add_argument("--package", type=Path, default=ROOT, help="root of a checkout of symhyb")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", default="", help="names of cases, with commas")
    parser.add_argument("--quick", action="store_true", help="the cheapest of every sort")
    parser.add_argument("--again", action="store_true", help="replace results that are there")
    options = parser.parse_args()
    package, results = package_at(options.package), BUILD / options.label
    results.mkdir(parents=True, exist_ok=True)
    cases = waiting(wanted(options.only, options.quick), package, results, options.again)
    print(f"{len(cases)} cases to run with {package.root}, commit {package.commit}", flush=True)
    cache = warm(package, results, DRAWN) if cases else results
    pool = ThreadPoolExecutor(options.workers)
    try:
        running = [pool.submit(one, case, package, results, DRAWN, cache) for case in cases]
        for done in as_completed(running):
            print(done.result(), flush=True)
    finally:
        pool.shutdown(cancel_futures=True)
    print(f"results in {results}")


if __name__ == "__main__":
    main()

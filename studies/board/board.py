"""Methods side by side on fresh cases of a bench, ours and those of others; one table.

    python studies/board/board.py --bench outside --seeds 150-151 [--kinds magnet] [--limit 20]
    python studies/board/board.py --bench concealed --fresh 40 --entry my.toml --methods mine,symhyb

Cases are drawn and sealed; every method answers every case in a process of its own, which sees
model.toml and train.csv alone. One JSON is kept a case and method, and what is there is not asked
again. After the last answer the seals are opened, and the table is written as ``board.md`` and
``board.json`` beside the answers. The README says how to enter.
"""

import argparse
import json
import secrets
import shutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, replace
from itertools import islice
from pathlib import Path
from types import ModuleType
from typing import Any

import answers
from apart import Ended, run
from benches import NAMES, Drawn, bench_of, seeds_of, unseal
from joblib import Parallel, delayed
from lines import Line, table
from methods import OURS, Method, chosen, folder_name, read

SHOWN = ("model.toml", "train.csv")
UNSEEN = Path(__file__).resolve().with_name("unseen.py")
UNSEEN_SECONDS, UNSEEN_BYTES = 300.0, 4 * 2**30
SEEDS = "seeds.json"  # the fresh ones of a folder of answers


@contextmanager
def workspace(case: Path, names: Sequence[str]) -> Iterator[Path]:
    """A folder that exists for one process: ``case`` with the named files alone, empty
    ``answer``."""
    with tempfile.TemporaryDirectory(prefix="board-", ignore_cleanup_errors=True) as made:
        folder = Path(made)
        for name in ("case", "answer"):
            (folder / name).mkdir()
        for name in names:
            shutil.copyfile(case / name, folder / "case" / name)
        yield folder


def asked(method: Method, case: Drawn, results: Path, hide: Sequence[Path]) -> None:
    """Let a method answer a case, and keep what it wrote, or why it failed."""
    target = kept(results, method, case)
    with workspace(case.folder, SHOWN) as folder:
        command = method.on(folder / "case", folder / "answer")
        memory = method.memory_mb * 2**20
        ended = run(command, folder, method.seconds, memory, [*hide, results])
        result: dict[str, Any] = {
            "command": list(method.command),
            "seconds": ended.seconds,
            "cpu_seconds": ended.cpu,
            "hidden": ended.hidden,
        }
        try:
            _require_ended(ended, method)
            result["diagnosis"] = answers.read(folder / "answer" / "diagnosis.json")
            _keep(answers.files(folder / "answer"), _beside(target))
        except answers.AnswerError as error:
            result["crash"] = str(error)
    _write(target, result)
    said = result["diagnosis"]["verdict"] if "diagnosis" in result else result["crash"]
    print(f"{case.name}, {method.name}: {said[:100]} in {ended.seconds:.0f} s", flush=True)


def _require_ended(ended: Ended, method: Method) -> None:
    if ended.status is None:
        raise answers.AnswerError(f"stopped after {method.seconds:g} s")
    if ended.status:
        how = f"status {ended.status}" if ended.status > 0 else f"signal {-ended.status}"
        raise answers.AnswerError(f"ended with {how}: {ended.words}".rstrip(": "))


def kept(results: Path, method: Method, case: Drawn) -> Path:
    """Where the answer of a method to a case is kept."""
    return results / folder_name(method.name) / f"{case.name}.json"


def _beside(target: Path) -> Path:
    """The folder of the corrected model that belongs to an answer."""
    return target.with_suffix(".files")


def _keep(files: dict[str, bytes], folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    if files:
        folder.mkdir(parents=True)
        for name, content in files.items():
            (folder / name).write_bytes(content)


def _write(target: Path, content: dict[str, Any]) -> None:
    """Write a JSON at once or not at all."""
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_suffix(".part")
    part.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    part.replace(target)


def missing(
    methods: Sequence[Method], cases: Sequence[Drawn], results: Path
) -> list[tuple[Method, Drawn]]:
    """What has not been answered yet, case by case.

    Raises:
        SystemExit: an answer is there that another command gave.
    """
    left = []
    for case in cases:
        for method in methods:
            target = kept(results, method, case)
            if not target.exists():
                left.append((method, case))
            elif json.loads(target.read_text("utf-8"))["command"] != list(method.command):
                raise SystemExit(
                    f"{target} was written by another command of '{method.name}'; "
                    "give --results another folder, or remove the old answers"
                )
    return left


def unseen(case: Drawn, target: Path, hide: Sequence[Path]) -> tuple[float | None, ...] | None:
    """Errors of the model and of what a method made of it along the unseen recording, as shares of
    its range, None for a run that ended early or cannot begin; None alone without a corrected
    model."""
    files, known = _beside(target), target.with_suffix(".unseen.json")
    if not files.is_dir():
        return None
    if (files / "corrected.toml").read_bytes() == (case.folder / "model.toml").read_bytes():
        known = target.parents[1] / ".unchanged" / known.name  # the same of all that claim nothing
    if not known.exists():
        with workspace(case.folder, (*SHOWN, "holdout.csv")) as folder:
            corrected = shutil.copytree(files, folder / "corrected") / "corrected.toml"
            out = folder / "answer" / "unseen.json"
            command = [sys.executable, str(UNSEEN), *map(str, (folder / "case", corrected, out))]
            ended = run(command, folder, UNSEEN_SECONDS, UNSEEN_BYTES, hide)
            found: dict[str, Any] = {"error": f"ended with {ended.status}: {ended.words}"}
            if out.is_file():
                found = json.loads(out.read_text("utf-8"))
            _write(known, found)
    found = json.loads(known.read_text("utf-8"))
    return found.get("before"), found.get("after")


def scored(
    bench: ModuleType, method: Method, cases: Sequence[Drawn], results: Path, hide: Sequence[Path]
) -> list[Line]:
    """The lines of a method; this opens the seals."""
    lines = []
    for case in cases:
        target = kept(results, method, case)
        result = json.loads(target.read_text("utf-8"))
        sealed = unseal(case.folder / "sealed.json")
        line: Line = bench.line(case, result, sealed)
        spent = {"seconds": result["seconds"], "cpu": result["cpu_seconds"]}
        lines.append(replace(line, unseen=unseen(case, target, hide), **spent))
    return lines


def seeds_asked(options: argparse.Namespace, bench: ModuleType) -> list[int]:
    """The seeds that were given, or fresh ones, which stay those of the folder of answers."""
    if not options.fresh:
        return list(dict.fromkeys(options.seeds))
    file = options.results / SEEDS
    known = json.loads(file.read_text("utf-8"))["seeds"] if file.exists() else []
    low, high = bench.SEEDS
    if options.fresh > high - low:
        raise SystemExit(f"--fresh {options.fresh}: there are no more than {high - low} such seeds")
    while len(known) < options.fresh:
        seed = low + secrets.randbelow(high - low + 1)
        known += [seed] * (seed not in known)
    _write(file, {"seeds": known})
    return sorted(known[: options.fresh])


def _count(text: str) -> int:
    """A whole number above 0."""
    if int(text) < 1:
        raise ValueError(text)
    return int(text)


def main() -> None:
    """Draw, ask, score."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--bench", choices=NAMES, default="outside")
    parser.add_argument("--seeds", type=seeds_of, default=[], help="as 100-101,110")
    parser.add_argument("--fresh", type=_count, default=0, help="so many seeds by chance instead")
    parser.add_argument("--kinds", default="", help="kinds of cases, with commas")
    parser.add_argument("--methods", default="", help="names, with commas; all without")
    parser.add_argument("--entry", type=Path, action="append", default=[], help="a TOML of methods")
    parser.add_argument("--limit", type=_count, default=None, help="at most so many cases")
    parser.add_argument("--workers", type=_count, default=1)
    parser.add_argument("-o", "--output", type=Path, help="cases; default: those of the bench")
    parser.add_argument("--results", type=Path, help="answers; default: build/board/BENCH")
    options = parser.parse_args()
    if bool(options.seeds) == bool(options.fresh):
        raise SystemExit("give either --seeds or --fresh")
    methods = chosen(read([OURS, *options.entry]), options.methods)
    bench = bench_of(options.bench)
    build = options.output or bench.BUILD
    options.results = options.results or Path("build/board") / options.bench
    options.results.mkdir(parents=True, exist_ok=True)
    drawn = bench.drawn(seeds_asked(options, bench), options.kinds, build)
    cases = list(islice(drawn, options.limit))
    if not cases:
        raise SystemExit("no case can be drawn of these seeds and kinds; ask for others")
    left = missing(methods, cases, options.results)
    tasks = (delayed(asked)(method, case, options.results, [build]) for method, case in left)
    Parallel(n_jobs=options.workers, prefer="threads")(tasks)
    lines = {one.name: scored(bench, one, cases, options.results, [build]) for one in methods}
    text = table(lines, [one.name for one in methods if not one.words])
    (options.results / "board.md").write_text(text, encoding="utf-8")
    rows = {name: [asdict(line) for line in own] for name, own in lines.items()}
    _write(options.results / "board.json", {"bench": options.bench, "lines": rows})
    print(f"\n{text}")


if __name__ == "__main__":
    main()

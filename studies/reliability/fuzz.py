"""Give every reader inputs that hurt, and count what becomes of them.

    python studies/reliability/fuzz.py                          # 20 000 inputs a reader
    python studies/reliability/fuzz.py --count 1000000 --readers model,csv    # a night
    python studies/reliability/fuzz.py --show model 28065       # one input, and what it does

Each input follows from its number. A worker process reads them one after the other; an input that
ends it, or keeps it for more than ten seconds, is a failure (of a native reader: contained, as in
symhyb a process of its own with limits reads such files). Counts and failures lie in
``build/reliability``; a run goes on where it was stopped. Exit status 1 if anything failed.
"""

import argparse
import gc
import json
import mmap
import os
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any
from unicodedata import category

from readers import ROOT, Reader, an_input, readers

from symhyb.limits import READER_MEMORY
from symhyb.writing import write_file

SECONDS, STUCK = 10, 20  # for one input; until a worker that does not come back is ended
MEMORY = 4 << 30  # bytes of a worker; one with a native reader has what symhyb gives it
SENTENCE = 2000  # letters of one problem
OBEYED = ("Cc", "Cs", "Zl", "Zp")  # categories of letters that a terminal or a page obeys
TURNS = "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"  # the direction of writing
BATCH = 5000  # inputs of one worker
DOCS = ROOT / "docs" / "reliability.md"
BEGIN, END = "<!-- counts: written by fuzz.py --docs -->", "<!-- end of counts -->"
_STATE = struct.Struct("<qqq")  # number that is read, accepted, refused


class TooLongError(Exception):
    """An input took more than its time."""


def main() -> int:
    """Run the readers that are asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument(
        "--count",
        type=int,
        default=20_000,
        help="inputs of each reader; of xlsx a quarter, of mf4 a twentieth",
    )
    parser.add_argument("--readers", default="", help="names, with commas")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "build" / "reliability")
    parser.add_argument("--docs", action="store_true", help="write the kept counts into the page")
    parser.add_argument("--show", nargs=2, metavar=("READER", "NUMBER"))
    parser.add_argument("--work", nargs=4, help=argparse.SUPPRESS)
    options = parser.parse_args()
    every = {reader.name: reader for reader in readers()}
    if options.work:
        name, first, last, state = options.work
        memory = READER_MEMORY if every[name].native else MEMORY
        resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        work(every[name], int(first), int(last), Path(state))
        return 0
    if options.docs:
        head, _, rest = DOCS.read_text(encoding="utf-8").partition(BEGIN)
        page = f"{head}{BEGIN}\n\n{table(options.output, every)}\n{END}"
        write_file(DOCS, page + rest.partition(END)[2])
        return 0
    if options.show:
        data = an_input(every[options.show[0]], int(options.show[1]))
        print(data.decode(errors="backslashreplace"))
        every[options.show[0]].take(data)
        return 0
    options.output.mkdir(parents=True, exist_ok=True)
    chosen = options.readers.split(",") if options.readers else list(every)
    failures = 0
    for name in chosen:
        count = round(options.count * every[name].share)
        counts = run(every[name], count, options.workers, options.output)
        failures += len(counts["failures"])
        print(line_of(counts), flush=True)
    return int(failures > 0)


def table(folder: Path, names: Iterable[str]) -> str:
    """The kept counts in Markdown."""
    lines = [
        "| reader | inputs | read | refused | contained | failed | s |",
        "|---|---|---|---|---|---|---|",
    ]
    for name in names:
        file = folder / f"{name}.json"
        if file.exists():
            counts = json.loads(file.read_text(encoding="utf-8"))
            cells = [counts[key] for key in ("inputs", "accepted", "refused", "contained")]
            cells += [len(counts["failures"]), round(counts["seconds"])]
            lines.append(
                f"| {name} | " + " | ".join(f"{cell:,}".replace(",", " ") for cell in cells) + " |"
            )
    return "\n".join(lines) + "\n"


def line_of(counts: dict[str, Any]) -> str:
    """One line of what became of the inputs of a reader."""
    text = (
        f"{counts['reader']}: {counts['inputs']} inputs, {counts['accepted']} read,"
        f" {counts['refused']} refused, {counts['contained']} contained,"
        f" {len(counts['failures'])} failed, {counts['seconds']:.0f} s"
    )
    kinds = {one["where"]: one for one in counts["failures"]}
    return "\n".join([text, *(f"  {one['number']}: {one['what']}" for one in kinds.values())])


def run(reader: Reader, count: int, workers: int, folder: Path) -> dict[str, Any]:
    """Count what becomes of the first ``count`` inputs of a reader, from where the last run was."""
    file = folder / f"{reader.name}.json"
    counts: dict[str, Any] = {"reader": reader.name, "inputs": 0, "accepted": 0, "refused": 0}
    counts |= {"contained": 0, "failures": [], "seconds": 0.0}
    if file.exists():
        counts = json.loads(file.read_text(encoding="utf-8"))
    while counts["inputs"] < count:
        begin, first = time.perf_counter(), counts["inputs"]
        last = min(first + BATCH * workers, count)
        edges = [first + (last - first) * k // workers for k in range(workers + 1)]
        with ThreadPoolExecutor(workers) as pool:
            parts = pool.map(lambda a, b: supervised(reader, a, b, folder), edges, edges[1:])
            for part in parts:
                for key, value in part.items():
                    counts[key] += value
        counts["inputs"], counts["seconds"] = last, counts["seconds"] + time.perf_counter() - begin
        write_file(file, json.dumps(counts, indent=1) + "\n")
        print(f"  {reader.name}: {last} of {count}", file=sys.stderr, flush=True)
    return counts


def supervised(reader: Reader, first: int, last: int, folder: Path) -> dict[str, Any]:
    """What becomes of the inputs ``first`` to ``last``; a worker that ends is started again."""
    total: dict[str, Any] = {"accepted": 0, "refused": 0, "contained": 0, "failures": []}
    with tempfile.TemporaryDirectory(prefix="fuzz-") as scratch:
        while first < last:
            state, log = Path(scratch) / "state", Path(scratch) / "failures"
            state.write_bytes(_STATE.pack(first, 0, 0))
            log.write_text("", encoding="utf-8")
            ended = _watched(reader.name, first, last, state, scratch)
            number, accepted, refused = _STATE.unpack(state.read_bytes())
            total["accepted"] += accepted
            total["refused"] += refused
            found = [json.loads(one) for one in log.read_text(encoding="utf-8").splitlines()]
            if ended and reader.native:
                total["contained"] += 1
            elif ended:
                found.append({"number": number, "what": ended, "where": ended})
            total["failures"] += found
            for one in found:
                kept = folder / "failures" / f"{reader.name}-{one['number']}"
                kept.parent.mkdir(exist_ok=True)
                kept.write_bytes(an_input(reader, one["number"]))
            first = number + 1 if ended else last
    return total


def _watched(name: str, first: int, last: int, state: Path, scratch: str) -> str:
    """Run a worker; why it ended early, empty if it did not."""
    command = [sys.executable, __file__, "--work", name, str(first), str(last), str(state)]
    environment = {**os.environ, "XDG_CACHE_HOME": scratch, "TMPDIR": scratch, "SYMHYB_CC": ""}
    worker = subprocess.Popen(
        command, env=environment, cwd=scratch, stderr=subprocess.PIPE, text=True
    )
    seen, since = -1, time.monotonic()
    while True:
        try:
            _, said = worker.communicate(timeout=1)
        except subprocess.TimeoutExpired:
            (number, _, _) = _STATE.unpack(state.read_bytes())
            if number != seen:
                seen, since = number, time.monotonic()
            elif time.monotonic() - since > STUCK:
                worker.kill()
                worker.communicate()
                return f"did not come back within {STUCK} s"
            continue
        if worker.returncode < 0:
            return f"ended by {signal.Signals(-worker.returncode).name}"
        return "" if not worker.returncode else f"ended: {said.strip()[-300:]}"


def work(reader: Reader, first: int, last: int, state: Path) -> None:
    """Read the inputs ``first`` to ``last``, with the number of each in the file ``state``."""
    signal.signal(signal.SIGALRM, _too_long)
    warnings.simplefilter("ignore")
    log = state.with_name("failures")
    accepted = refused = 0
    an_input(reader, first)  # loads what the corpus is made with
    gc.freeze()  # a reader that collects what it left need not look at every module again
    with open(state, "r+b") as stream, mmap.mmap(stream.fileno(), 0) as shared:
        for number in range(first, last):
            shared[:] = _STATE.pack(number, accepted, refused)
            data = an_input(reader, number)
            failure = ""
            signal.alarm(SECONDS)
            try:
                reader.take(data)
                accepted += 1
            except reader.errors as error:
                refused += 1
                failure = _unclear(error)
            except TooLongError as error:
                failure = f"more than {SECONDS} s, {_where(error)}"
            except Exception as error:
                failure = f"{type(error).__name__} {str(error)[:100]}, {_where(error)}"
            finally:
                signal.alarm(0)
            if failure:
                row = {"number": number, "what": failure, "where": failure.rsplit(", ", 1)[-1]}
                with open(log, "a", encoding="utf-8") as out:
                    out.write(json.dumps(row) + "\n")
        shared[:] = _STATE.pack(last, accepted, refused)


def _too_long(*_: object) -> None:
    raise TooLongError


def _unclear(error: Exception) -> str:
    """What is wrong with a refusal: nothing said, letters that a terminal obeys, or too many."""
    problems = [str(one) for one in getattr(error, "problems", (error,))]
    if not problems or not all(problems):
        return "" if isinstance(error, MemoryError) else "says nothing, refusal"
    letters = set("".join(problems)) - {"\n", "\t"}
    if any(category(letter) in OBEYED or letter in TURNS for letter in letters):
        return "control characters in a sentence, refusal"
    longest = max(problems, key=len)
    return (
        f"a sentence of {len(longest)} letters: {longest[:80]}, length"
        if len(longest) > SENTENCE
        else ""
    )


def _where(error: BaseException) -> str:
    """The last place in symhyb that an error passed."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [one for one in frames if "/symhyb/" in one.filename and "studies" not in one.filename]
    last = (own or frames)[-1]
    return f"{Path(last.filename).name}:{last.lineno}"


if __name__ == "__main__":
    sys.exit(main())

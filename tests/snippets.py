"""The snippets of the documentation: what a page shows is read out of its source, run and compared.

A snippet is a fenced block. ``python`` blocks of a page run one after the other in one namespace;
of ``console`` blocks every line behind ``$`` is a command, and the lines below it are what it
prints; other blocks are text. A comment of the page directly above a block says what is special:

    <!-- file: rig.toml -->         the block is written into this file of the page's folder
    <!-- output -->                 the block is what the ``python`` block before it prints
    <!-- exits with 2 -->           the last command of the block ends with this status
    <!-- not run: needs Adams -->   the block is not run, and why

and comments anywhere in a page say what holds for all of it:

    <!-- begins in an empty folder -->   else in one with ``models`` and ``studies`` of a clone
    <!-- slow: two diagnoses -->         runs with the slow tests, and why
    <!-- thorough: ten minutes -->       runs with the thorough tests, and why
    <!-- setup: … -->                    Python that runs before the first block and is not shown

``python tests/snippets.py PAGE…`` runs pages and writes what came out below their commands.
"""

import io
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[1]
BLOCK = re.compile(
    r"(?P<marks>(?:^[ ]*<!-- [^\n]* -->\n)*)^(?P<fence>`{3,})(?P<language>\{?[\w-]*\}?)[^\n]*\n"
    r"(?P<text>.*?)^(?P=fence)[ ]*$",
    re.M | re.S,
)
MARK = re.compile(r"<!-- (file|output|exits with|not run)(?:[: ]+([^\n]*?))? -->")
WHOLE = re.compile(r"^<!-- (begins|slow|thorough|setup)\b:? ?(.*?)-->$", re.M | re.S)
NUMBER = re.compile(r"(?<![\w.])[-−+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w]*\.(?:toml|csv|json))")
TOLERANCE = 0.2  # of a number: recordings are the same, rounding of processors differs
# what a diagnosis says by its status is no failure: 1 for anything but "nothing missing"
MAY_END_WITH_1 = ("diagnose", "run", "learn", "fit")
WIDTH = 100  # letters of a line of a transcript


@dataclass(frozen=True)
class Snippet:
    """One block of a page: its place in the source, its language, its text and its marks."""

    page: Path
    line: int
    start: int
    language: str
    text: str
    marks: dict[str, str]

    @property
    def name(self) -> str:
        return f"{self.page.name}:{self.line}"


@dataclass(frozen=True)
class Ran:
    """A command or a block with what it printed."""

    snippet: Snippet
    command: str
    shown: str
    printed: str


def snippets(page: Path) -> tuple[Snippet, ...]:
    """The blocks of a page in their order."""
    source = page.read_text(encoding="utf-8")
    found = []
    for match in BLOCK.finditer(source):
        marks = {kind: value or "" for kind, value in MARK.findall(match["marks"])}
        line = source.count("\n", 0, match.start("text")) + 1
        text, language = match["text"], match["language"]
        found.append(Snippet(page, line, match.start("text"), language, text, marks))
    return tuple(found)


def of_the_whole(page: Path) -> dict[str, str]:
    """What a page says of all of its blocks: its begin, its pace, its setup."""
    source = page.read_text(encoding="utf-8")
    return {kind: value.strip() for kind, value in WHOLE.findall(source)}


def runs(snippet: Snippet) -> bool:
    return "not run" not in snippet.marks and (
        snippet.language in ("python", "console") or "file" in snippet.marks
    )


def commands(text: str) -> Iterator[tuple[str, str]]:
    """The commands of a console block, each with the text that is shown below it."""
    for part in re.split(r"^\$ ", text, flags=re.M)[1:]:
        lines = part.splitlines()
        count = next(i for i, line in enumerate(lines, 1) if not line.endswith("\\"))
        command = " ".join(line.rstrip("\\").strip() for line in lines[:count])
        yield command, "\n".join(lines[count:]).strip("\n")


def run_page(page: Path, folder: Path) -> list[Ran]:
    """Run all blocks of a page in a folder; raise where one of them fails."""
    whole = of_the_whole(page)
    if "begins" not in whole:
        for name in ("models", "studies"):
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("results"))
        shutil.copy(ROOT / "pyproject.toml", folder)  # by which a study knows its project
    own = {"MPLBACKEND": "Agg", "COLUMNS": str(WIDTH), "NO_COLOR": "1"}
    own["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    ran: list[Ran] = []
    space: dict[str, object] = {"__name__": "__main__"}
    with chdir(folder), mock.patch.dict(os.environ, own):
        if "setup" in whole:
            exec(compile(whole["setup"], f"{page.name}, setup", "exec"), space)
        for snippet in snippets(page):
            if "output" in snippet.marks:
                ran[-1] = Ran(snippet, "", snippet.text, ran[-1].printed)
            if not runs(snippet):
                continue
            if "file" in snippet.marks:
                Path(snippet.marks["file"]).write_text(snippet.text, encoding="utf-8")
            elif snippet.language == "python":
                ran.append(Ran(snippet, "", "", _python(snippet, space)))
            else:
                ran.extend(run_console(snippet))
    return ran


def _python(snippet: Snippet, space: dict[str, object]) -> str:
    """Run a block of Python in the namespace of its page; what it prints. Lines of an error are
    those of the page."""
    code = "\n" * (snippet.line - 1) + textwrap.dedent(snippet.text)
    with redirect_stdout(io.StringIO()) as out:
        exec(compile(code, str(snippet.page), "exec"), space)
    return out.getvalue()


def run_console(snippet: Snippet) -> Iterator[Ran]:
    """Run the commands of a console block."""
    every = list(commands(snippet.text))
    for i, (command, shown) in enumerate(every):
        status, printed = _command(command)
        expected = {0, 1} if _may_end_with_1(command) else {0}
        if "exits with" in snippet.marks and i == len(every) - 1:
            expected = {int(snippet.marks["exits with"])}
        assert status in expected, f"{snippet.name}: {command}: status {status}\n{printed}"
        yield Ran(snippet, command, shown, printed)


def _may_end_with_1(command: str) -> bool:
    words = command.split()
    return Path(words[0]).name == "symhyb" and words[1] in MAY_END_WITH_1


def _command(command: str) -> tuple[int, str]:
    """Status and text of a command; symhyb runs in this process, which saves its start."""
    words = shlex.split(command)
    plain = not set("|><;&") & set(command)
    if not (plain and Path(words[0]).name == "symhyb"):
        done = subprocess.run(
            ["bash", "-c", command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        return done.returncode, done.stdout
    from symhyb.cli.app import main

    out, status = io.StringIO(), 0
    with (
        redirect_stdout(out),
        redirect_stderr(out),
        mock.patch("symhyb.console.progress_line.EVERY_S", math.inf),  # however slow it is here
        mock.patch.object(sys, "argv", ["symhyb", *words[1:]]),
    ):
        try:
            main()
        except SystemExit as stop:
            status = stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    return status, out.getvalue()


def differs(ran: Ran) -> str:
    """What a transcript shows and the command did not print, or nothing: words are the same,
    numbers alike; how lines are wrapped does not count, and a line ``…`` stands for any lines."""
    if not ran.shown.strip():
        return ""
    parts = [_words(part) for part in re.split(r"^[ ]*…[ ]*$", ran.shown, flags=re.M)]
    printed = _words(ran.printed)
    at = 0
    for i, part in enumerate(parts):
        first, last = i == 0, i == len(parts) - 1
        begins = [0] if first else range(at, len(printed) - len(part) + 1)
        if last and not first:
            begins = [max(at, len(printed) - len(part))]
        fits = (b for b in begins if _same(part, printed[b : b + len(part)]))
        begin = next(fits, None)
        if begin is None or (last and begin + len(part) != len(printed)):
            both = f"shown:\n{ran.shown}\nprinted:\n{ran.printed}"
            return f"{ran.snippet.name}: {ran.command}\n{both}"
        at = begin + len(part)
    return ""


def _words(text: str) -> list[str]:
    return text.split()


def _same(shown: list[str], printed: list[str]) -> bool:
    return len(shown) == len(printed) and all(
        a == b or _alike(a, b) for a, b in zip(shown, printed, strict=True)
    )


def _alike(shown: str, printed: str) -> bool:
    """Whether two words differ in their numbers alone, and by little."""
    if NUMBER.sub("#", shown) != NUMBER.sub("#", printed):
        return False
    pairs = zip(NUMBER.findall(shown), NUMBER.findall(printed), strict=True)
    both = [(float(a.replace("−", "-")), float(b.replace("−", "-"))) for a, b in pairs]
    return all(abs(a - b) <= TOLERANCE * max(abs(a), abs(b)) for a, b in both)


def written(page: Path, ran: list[Ran]) -> str:
    """The source of a page with what its commands printed; where ``…`` leaves lines out, it
    stays."""
    source = page.read_text(encoding="utf-8")
    for snippet in reversed(snippets(page)):
        own = [one for one in ran if one.snippet == snippet]
        if not any(one.shown.strip() for one in own) or any("…\n" in one.shown for one in own):
            continue
        if "output" in snippet.marks:
            text = _wrapped(own[0].printed)
        else:
            heads = re.findall(r"^\$ (?:[^\n]*\\\n)*[^\n]*\n", snippet.text, re.M)
            pairs = zip(heads, own, strict=True)
            text = "".join(h + (_wrapped(o.printed) if o.shown.strip() else "") for h, o in pairs)
        end = snippet.start + len(snippet.text)
        source = source[: snippet.start] + text + source[end:]
    return source


def _wrapped(text: str) -> str:
    lines = []
    for line in text.rstrip("\n").splitlines():
        indent = " " * (len(line) - len(line.lstrip()) + 2)
        wrapped = textwrap.wrap(line, WIDTH, subsequent_indent=indent, break_long_words=False)
        lines += wrapped if len(line) > WIDTH else [line]
    return "".join(line.rstrip() + "\n" for line in lines)


def main(pages: list[str]) -> None:
    """Run pages and write what came out into them."""
    import tempfile

    for name in pages:
        page = Path(name).resolve()
        with tempfile.TemporaryDirectory() as folder:
            ran = run_page(page, Path(folder))
        page.write_text(written(page, ran), encoding="utf-8")
        for difference in filter(None, map(differs, ran)):
            print(difference, end="\n\n")


if __name__ == "__main__":
    main(sys.argv[1:])

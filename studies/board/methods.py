"""Methods that take part: the entries of a TOML file, each a command that reads a case."""

import re
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

OURS = Path(__file__).resolve().with_name("methods.toml")
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 _.,+()-]{0,39}")
PLACEHOLDER = re.compile(r"\{(\w*)\}")
KNOWN = ("case", "answer", "python", "here")
KEYS = ("command", "seconds", "memory_mb", "words", "about")
SECONDS, MEMORY_MB = 600, 4096  # where an entry does not say
MOST = {"seconds": 86_400, "memory_mb": 1_000_000}


@dataclass(frozen=True, slots=True)
class Method:
    """A method by name: its ``command``, with ``{python}`` and ``{here}`` filled in, the limits of
    a case, and whether it has ``words`` (else its unseen error alone is scored)."""

    name: str
    command: tuple[str, ...]
    seconds: float = SECONDS
    memory_mb: int = MEMORY_MB
    words: bool = True
    about: str = ""

    def on(self, case: Path, answer: Path) -> list[str]:
        """The command for one case."""
        places = {"{case}": str(case), "{answer}": str(answer)}
        return [_filled(part, places) for part in self.command]


def read(files: Sequence[Path]) -> dict[str, Method]:
    """Methods of some files, by name.

    Raises:
        SystemExit: with all that is wrong, a line each.
    """
    found: dict[str, Method] = {}
    problems: list[str] = []
    for file in files:
        try:
            entries = tomllib.loads(file.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            problems.append(f"{file}: {error}")
            continue
        methods = entries.pop("methods", {})
        problems += [f"{file}: unknown key '{key}'; methods stand in [methods]" for key in entries]
        if not isinstance(methods, dict) or not methods:
            problems.append(f"{file}: there is no table [methods.NAME]")
            continue
        for name, entry in methods.items():
            where = f"{file}: [methods.{name}]"
            wrong = _wrong(name, entry)
            if folder_name(name) in map(folder_name, found):
                wrong.append("the name is taken; choose another one")
            problems += [f"{where}: {one}" for one in wrong]
            if not wrong:
                found[name] = _method(name, entry, file.resolve().parent)
    if problems:
        raise SystemExit("\n".join(problems))
    return found


def folder_name(name: str) -> str:
    """A name for folders and options: hyphens for blanks, no commas."""
    return name.replace(",", "").replace(" ", "-")


def chosen(known: Mapping[str, Method], names: str) -> list[Method]:
    """Methods by their names with commas, all without a name; a name with a comma in it stands
    with a blank instead.

    Raises:
        SystemExit: a name that is not there.
    """
    if not names:
        return list(known.values())
    plain = {folder_name(name): method for name, method in known.items()}
    asked = [folder_name(name.strip()) for name in names.split(",")]
    missing = [name for name in asked if name not in plain]
    if missing:
        raise SystemExit(f"no method {', '.join(missing)}; there are {', '.join(plain)}")
    return [plain[name] for name in dict.fromkeys(asked)]


def _method(name: str, entry: Mapping[str, Any], here: Path) -> Method:
    places = {"{python}": sys.executable, "{here}": str(here)}
    command = tuple(_filled(part, places) for part in entry["command"])
    return Method(name, command, **{k: v for k, v in entry.items() if k != "command"})


def _filled(part: str, places: Mapping[str, str]) -> str:
    for mark, path in places.items():
        part = part.replace(mark, path)
    return part


def _wrong(name: str, entry: Any) -> list[str]:
    """What is wrong with an entry."""
    problems = []
    if not NAME.fullmatch(name):
        problems.append("a name has 1 to 40 letters, digits, blanks or _.,+()-")
    if not isinstance(entry, dict):
        return [*problems, "is no table"]
    problems += [f"unknown key '{k}'; there are {', '.join(KEYS)}" for k in entry.keys() - {*KEYS}]
    command = entry.get("command")
    if not isinstance(command, list) or not command or not all(_word(one) for one in command):
        problems.append(f"command = {command!r}: give a list of arguments, the program first")
    else:
        marks = [mark for part in command for mark in PLACEHOLDER.findall(part)]
        unknown = [mark for mark in marks if mark not in KNOWN]
        problems += [f"unknown placeholder {{{m}}}; there are {', '.join(KNOWN)}" for m in unknown]
        missing = [mark for mark in KNOWN[:2] if mark not in marks]
        problems += [f"command has no {{{mark}}}, so it cannot know it" for mark in missing]
    for key, most in MOST.items():
        value = entry.get(key, 1)
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value <= most:
            problems.append(f"{key} = {value!r}: give a number above 0, at most {most}")
    if not isinstance(entry.get("words", True), bool):
        problems.append(f"words = {entry['words']!r}: give true or false")
    if not isinstance(entry.get("about", ""), str):
        problems.append(f"about = {entry['about']!r}: give a text")
    return problems


def _word(part: Any) -> bool:
    return isinstance(part, str) and bool(part) and "\0" not in part

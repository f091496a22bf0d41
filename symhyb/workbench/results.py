"""What a diagnosis left in a folder, read again: the answer, the laws, the errors.

The file may come from anywhere: it is held against the shape that is used here, and every
departure is said.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from symhyb.errors import InputError, Problem
from symhyb.limits import DIAGNOSIS_BYTES, content_of

DIAGNOSIS, REPORT, CORRECTED = "diagnosis.json", "report.html", "corrected.toml"
PROBLEMS_MOST = 20  # of one file that are said

ESTIMATE = {"value": float, "sd": float, "unit": str, "term": str}
NUMBERS = {"*": (float, None)}
SCORE = {"window_nrmse": NUMBERS, "free_run_nrmse": NUMBERS}
COMPARISON = {"before": SCORE, "after": SCORE}
SHAPE: Mapping[str, Any] = {
    "verdict": str,
    "sentence": str,
    "found": [
        {
            "name": str,
            "kind": str,
            "law": str,
            "sentence": str,
            "share": (float, None),
            "place": {"*": object},
            "parameters": {"*": ESTIMATE},
        }
    ],
    "parameters": [{"name": str, "was": float, "value": float, "sd": float, "unit": str}],
    "measurement": [{"channel": str, "kind": str, "value": float, "sd": float, "unit": str}],
    "record_next": (str, None),
    "scores": {"train": COMPARISON, "holdout": (COMPARISON, None)},
}
"""What is used of a diagnosis: a type, a mapping of keys (``*``: of any), a list of one thing, or
what may be either of several; ``docs/output.md`` has all of it."""


@dataclass(frozen=True, slots=True)
class Number:
    """A fitted ``value`` with one deviation ``sd`` in ``unit``: of the element, parameter or
    channel ``of``, its ``term``; ``was`` is the value before, where there was one."""

    of: str
    term: str
    value: float
    sd: float
    unit: str
    was: float | None = None

    @property
    def key(self) -> tuple[str, str]:
        """What it is the value of."""
        return self.of, self.term


@dataclass(frozen=True, slots=True)
class Law:
    """A found element: its formula, the sentence on it, its share of the error (None: not known)
    and its numbers."""

    name: str
    law: str
    sentence: str
    share: float | None
    numbers: tuple[Number, ...]


@dataclass(frozen=True, slots=True)
class Errors:
    """NRMSE of a channel on ``training`` or ``unseen`` recordings, of ``windows`` or of a ``free
    run``, before and after; None where it is not known."""

    recordings: str
    score: str
    channel: str
    before: float | None
    after: float | None

    @property
    def key(self) -> tuple[str, str, str]:
        """What it is the error of."""
        return self.recordings, self.score, self.channel


@dataclass(frozen=True, slots=True)
class Result:
    """What a diagnosis left in ``folder``; its ``name`` is that folder as text."""

    folder: Path
    name: str
    verdict: str
    sentence: str
    laws: tuple[Law, ...]
    numbers: tuple[Number, ...]
    errors: tuple[Errors, ...]
    record_next: str | None

    @property
    def report(self) -> Path | None:
        """The page of the report, if it is there."""
        path = self.folder / REPORT
        return path if path.is_file() else None

    def all_numbers(self) -> tuple[Number, ...]:
        """The numbers of the laws, then those of parameters and channels."""
        return (*(number for law in self.laws for number in law.numbers), *self.numbers)


def is_result(folder: Path) -> bool:
    """Whether a diagnosis left its files in a folder."""
    return (folder / DIAGNOSIS).is_file()


def result_folders(given: Sequence[Path]) -> tuple[Path, ...]:
    """The folders that hold results: each that was given, or the ones in it.

    Raises:
        InputError: there are none in one that was given.
    """
    found: list[Path] = []
    problems = []
    for folder in given:
        inside = [one for one in sorted(folder.iterdir()) if one.is_dir() and is_result(one)]
        here = [folder] if is_result(folder) else inside
        if not here:
            text = f"holds no {DIAGNOSIS}, and no folder in it does; symhyb diagnose -o writes one"
            problems.append(Problem(text, file=str(folder)))
        found += here
    if problems:
        raise InputError(problems)
    return tuple(dict.fromkeys(found))


def read_results(folders: Sequence[Path]) -> tuple[Result, ...]:
    """Read all results.

    Raises:
        InputError: files that are no diagnosis: all problems at once.
    """
    problems: list[Problem] = []
    results = []
    for folder in folders:
        try:
            results.append(read_result(folder))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return tuple(results)


def read_result(folder: Path) -> Result:
    """Read what a diagnosis left in a folder.

    Raises:
        InputError: the file cannot be read, is no JSON, or not in the shape of a diagnosis.
    """
    file = folder / DIAGNOSIS
    try:
        value = json.loads(content_of(file, DIAGNOSIS_BYTES), parse_constant=_refused)
    except (ValueError, RecursionError) as error:
        raise InputError(Problem(f"is no diagnosis: {error}"[:300], file=str(file))) from error
    faults = list(_departures(value, SHAPE, ""))
    if faults:
        shown = [Problem(text, place, str(file)) for place, text in faults[:PROBLEMS_MOST]]
        raise InputError(shown)
    return _result(folder, value)


def _refused(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


def _departures(value: Any, shape: Any, place: str) -> Iterator[tuple[str, str]]:
    """Where a value is not as a shape says, and what should stand there."""
    if isinstance(shape, tuple):
        if value is not None:
            yield from _departures(value, shape[0], place)
    elif isinstance(shape, list):
        if not isinstance(value, list):
            yield place, "must be a list"
            return
        for i, item in enumerate(value):
            yield from _departures(item, shape[0], f"{place}[{i}]")
    elif isinstance(shape, Mapping):
        if not isinstance(value, dict):
            yield place, "must be a mapping"
            return
        wanted = dict.fromkeys(value, shape["*"]) if "*" in shape else shape
        for key, inner in wanted.items():
            inside = f"{place}.{key}".lstrip(".")
            if key in value:
                yield from _departures(value[key], inner, inside)
            else:
                yield inside, "is missing"
    elif shape is float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            yield place, "must be a number"
    elif not isinstance(value, shape):
        yield place, "must be text"


def _result(folder: Path, value: Mapping[str, Any]) -> Result:
    laws = tuple(
        Law(one["name"], one["law"], one["sentence"], one["share"], tuple(_terms(one)))
        for one in value["found"]
    )
    numbers = [
        Number(one["name"], "value", one["value"], one["sd"], one["unit"], one["was"])
        for one in value["parameters"]
    ]
    numbers += [
        Number(one["channel"], one["kind"], one["value"], one["sd"], one["unit"])
        for one in value["measurement"]
    ]
    return Result(
        folder,
        str(folder),
        value["verdict"],
        value["sentence"],
        laws,
        tuple(numbers),
        tuple(_errors(value["scores"])),
        value["record_next"],
    )


def _terms(found: Mapping[str, Any]) -> Iterator[Number]:
    for name, one in found["parameters"].items():
        term = f"{one['term']} {name}" if "at" in one else one["term"]
        yield Number(found["name"], term, one["value"], one["sd"], one["unit"])


def _errors(scores: Mapping[str, Any]) -> Iterator[Errors]:
    groups = {"unseen": scores["holdout"], "training": scores["train"]}
    for recordings, group in groups.items():
        if group is None:
            continue
        for key, words in (("free_run_nrmse", "free run"), ("window_nrmse", "windows")):
            before, after = group["before"][key], group["after"][key]
            for channel in dict.fromkeys((*before, *after)):
                yield Errors(recordings, words, channel, before.get(channel), after.get(channel))

"""What a method wrote, read as if it were hostile: the part of ``diagnosis.json`` that is scored.

The README lists the keys. Others are dropped; what is not as it should be makes the answer a
failure, with all reasons.
"""

import json
import math
import os
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any

VERDICTS = ("missing physics", "measurement", "parameters", "nothing missing", "undecided")
SILENT = ("nothing missing", "undecided")  # with these nothing is claimed
PLACES = {"on": 1, "at": 1, "between": 2, "pair": 2}  # key and number of names
SIZE_MOST = 4 * 2**20  # bytes of a diagnosis.json
FILES_MOST = 16 * 2**20  # bytes of a corrected model with what stands beside it
LENGTH_MOST = 200  # entries of a list, characters of a name
TEXT_MOST = 2000  # characters of a sentence
CLEAR = 2.0  # sd from nothing
SHOWN = 5  # reasons that are said


class AnswerError(ValueError):
    """An answer that is not as the README asks."""


def read(path: Path) -> dict[str, Any]:
    """The scored part of a diagnosis.json.

    Raises:
        AnswerError: there is none, or it is not as it should be; all reasons in one sentence.
    """
    text = plain(path, SIZE_MOST).decode("utf-8", "replace")
    try:
        whole = json.loads(text, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        raise AnswerError(f"{path.name} is no JSON: {str(error)[:200]}") from None
    if not isinstance(whole, dict):
        raise AnswerError(f"{path.name} holds no object")
    problems: list[str] = []
    answer = _Reader(problems).answer(whole)
    if problems:
        more = f", and {len(problems) - SHOWN} more" if len(problems) > SHOWN else ""
        raise AnswerError("; ".join(problems[:SHOWN]) + more)
    return answer


def plain(path: Path, most: int) -> bytes:
    """The bytes of an ordinary file of at most ``most`` bytes; no link, pipe or device is opened.

    Raises:
        AnswerError: it is none.
    """
    try:
        kind = os.lstat(path)
        if not stat.S_ISREG(kind.st_mode):
            raise AnswerError(f"{path.name} is no ordinary file")
        if kind.st_size > most:
            raise AnswerError(f"{path.name} has {kind.st_size} bytes, at most {most} are read")
        return path.read_bytes()
    except FileNotFoundError:
        raise AnswerError(f"there is no {path.name}") from None
    except OSError as error:
        raise AnswerError(f"{path.name} cannot be read: {error.strerror}") from None


def files(folder: Path) -> dict[str, bytes]:
    """The corrected model with the ordinary files that stand beside it, by name; empty where there
    is no corrected.toml or all of it is too large."""
    if not (folder / "corrected.toml").is_file():
        return {}
    found, left = {}, FILES_MOST
    for path in sorted(folder.iterdir()):
        if path.name == "diagnosis.json" or len(path.name) > LENGTH_MOST:
            continue
        try:
            found[path.name] = plain(path, left)
        except AnswerError:
            continue
        left -= len(found[path.name])
    return found if "corrected.toml" in found else {}


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


def _clear(found: dict[str, Any]) -> bool:
    """Whether a number of a claimed element is 2 sd from nothing, or it states none: a claim whose
    deviations hold everything claims nothing, and must not be right by them."""
    numbers = found["parameters"].values()
    return not numbers or any(abs(one["value"]) >= CLEAR * one["sd"] for one in numbers)


def _clear_fault(fault: dict[str, Any]) -> bool:
    """The same of a fault of a channel; a gain counts from 1."""
    return abs(fault["value"] - (fault["kind"] == "gain")) >= CLEAR * fault["sd"]


class _Reader:
    """Reads an answer and collects what is wrong with it."""

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems

    def answer(self, whole: dict[str, Any]) -> dict[str, Any]:
        verdict = whole.get("verdict")
        if verdict not in VERDICTS:
            self.wrong("verdict", verdict, f"one of {', '.join(VERDICTS)}")
        lists: dict[str, Callable[[str, dict[str, Any]], dict[str, Any]]] = {
            "found": self.found,
            "parameters": self.parameter,
            "measurement": self.fault,
            "channels": self.channels,
            "courses": self.course,
            "classes": self.kind_of_effect,
            "alternatives": self.alternative,
            "places": self.change,
        }
        read = {key: self.several(key, whole.get(key), one) for key, one in lists.items()}
        for key, clear in (("found", _clear), ("measurement", _clear_fault)):
            read[key] = [one for one in read[key] if clear(one)]
        if verdict in SILENT:
            read |= {key: [] for key in ("found", "parameters", "measurement", "courses")}
        sentence = str(whole.get("sentence", ""))[:TEXT_MOST]
        sentence = "".join(c if c.isprintable() else " " for c in sentence)
        return {"verdict": verdict, "sentence": sentence, **read}

    def wrong(self, where: str, value: Any, wanted: str) -> None:
        self.problems.append(f"{where} is {str(value)[:60]!r}, not {wanted}")

    def several(
        self, key: str, value: Any, one: Callable[[str, dict[str, Any]], dict[str, Any]]
    ) -> list[dict[str, Any]]:
        if value is None:
            return []
        if not isinstance(value, list) or len(value) > LENGTH_MOST:
            self.wrong(key, type(value).__name__, f"a list of at most {LENGTH_MOST}")
            return []
        found = []
        for i, entry in enumerate(value):
            if isinstance(entry, dict):
                found.append(one(f"{key}[{i}]", entry))
            else:
                self.wrong(f"{key}[{i}]", entry, "an object")
        return found

    def text(self, where: str, value: Any, most: int = LENGTH_MOST) -> str:
        if isinstance(value, str) and len(value) <= most and value.isprintable():
            return value
        self.wrong(where, value, f"a text of at most {most} printable characters")
        return ""

    def number(self, where: str, value: Any, low: float = -math.inf, high: float = math.inf) -> Any:
        try:
            if not isinstance(value, bool) and isinstance(value, int | float):
                number = float(value)
                if math.isfinite(number) and low <= number <= high:
                    return number
        except OverflowError:
            pass
        bounds = "" if math.isinf(low) else f", {low:g} or more"
        bounds += "" if math.isinf(high) else f", {high:g} or less"
        self.wrong(where, value, f"a finite number{bounds}")
        return 0.0

    def amount(self, where: str, entry: dict[str, Any]) -> dict[str, float]:
        value = self.number(f"{where}.value", entry.get("value"))
        return {"value": value, "sd": self.number(f"{where}.sd", entry.get("sd"), 0.0)}

    def place(self, where: str, value: Any) -> dict[str, Any]:
        if isinstance(value, dict) and len(value) == 1:
            ((key, names),) = value.items()
            count = PLACES.get(key)
            if count == 1:
                return {key: self.text(f"{where}.{key}", names)}
            if count and isinstance(names, list) and len(names) == count:
                return {key: [self.text(f"{where}.{key}", name) for name in names]}
        self.wrong(where, value, f"an object with one of {', '.join(PLACES)}")
        return {"on": ""}

    def somewhere(self, where: str, entry: dict[str, Any]) -> dict[str, Any]:
        for key in ("channel", "parameter"):
            if key in entry:
                return {key: self.text(f"{where}.{key}", entry[key])}
        return {"place": self.place(f"{where}.place", entry.get("place"))}

    def found(self, where: str, entry: dict[str, Any]) -> dict[str, Any]:
        numbers = entry.get("parameters", {})
        if not isinstance(numbers, dict) or len(numbers) > LENGTH_MOST:
            self.wrong(f"{where}.parameters", numbers, "an object")
            numbers = {}
        parameters = {}
        for name, one in numbers.items():
            at = f"{where}.parameters.{name[:40]}"
            if not isinstance(one, dict):
                self.wrong(at, one, "an object with value and sd")
                continue
            term = self.text(f"{at}.term", one.get("term", name))
            parameters[name] = {**self.amount(at, one), "term": term}
        one = {
            "kind": self.text(f"{where}.kind", entry.get("kind")),
            "place": self.place(f"{where}.place", entry.get("place")),
            "parameters": parameters,
        }
        options = entry.get("options")
        if isinstance(options, dict) and "side" in options:
            one["options"] = {"side": self.text(f"{where}.options.side", options["side"])}
        return {**one, **self.probability(where, entry)}

    def probability(self, where: str, entry: dict[str, Any]) -> dict[str, float]:
        if entry.get("probability") is None:
            return {}
        return {"probability": self.number(f"{where}.probability", entry["probability"], 0.0, 1.0)}

    def parameter(self, where: str, entry: dict[str, Any]) -> dict[str, Any]:
        return {"name": self.text(f"{where}.name", entry.get("name")), **self.amount(where, entry)}

    def fault(self, where: str, entry: dict[str, Any]) -> dict[str, Any]:
        words = {key: self.text(f"{where}.{key}", entry.get(key)) for key in ("channel", "kind")}
        return {**words, **self.amount(where, entry)}

    def channels(self, where: str, entry: dict[str, Any]) -> dict[str, Any]:
        names = entry.get("channels")
        if not isinstance(names, list) or not 0 < len(names) <= LENGTH_MOST:
            self.wrong(f"{where}.channels", names, "a list of names")
            names = []
        kind = self.text(f"{where}.kind", entry.get("kind"))
        return {"kind": kind, "channels": [self.text(f"{where}.channels", n) for n in names]}

    def course(self, where: str, entry: dict[str, Any]) -> dict[str, Any]:
        for key in ("parameter", "channel"):
            if entry.get(key) is not None:
                return {key: self.text(f"{where}.{key}", entry[key])}
        self.wrong(where, entry, "an object with parameter or channel")
        return {"parameter": ""}

    def kind_of_effect(self, where: str, entry: dict[str, Any]) -> dict[str, Any]:
        kind = self.text(f"{where}.kind", entry.get("kind"))
        read = {"probability": 1.0, **self.probability(where, entry)}
        return {"kind": kind, **self.somewhere(where, entry), **read}

    def alternative(self, where: str, entry: dict[str, Any]) -> dict[str, Any]:
        kind = self.text(f"{where}.kind", entry.get("kind"))
        return {"kind": kind, **self.somewhere(where, entry)}

    def change(self, where: str, entry: dict[str, Any]) -> dict[str, Any]:
        change = entry.get("change")
        if not isinstance(change, dict):
            return {}
        time = self.number(f"{where}.change.time_s", change.get("time_s"))
        return {"change": {"kind": str(change.get("kind"))[:LENGTH_MOST], "time_s": time}}

"""What a study is expected to find, and whether a diagnosis did: the file ``expected.json``.

    {
      "source": "where the values and the tolerances come from",
      "verdict": "missing physics",
      "found": {"x.coulomb": {"value": 20.3935, "within": 0.05}},
      "nothing_else": true,
      "alternatives": {"x.damping": {"value": 203.5, "within": 0.15}},
      "scores": {"holdout.after.window_rmse.encoder": {"at_most": 6.0e-5}}
    }

``found`` names place.term (two points as ``anchor-tip``), the value in the unit of the diagnosis
and how far off it may be, as a part of it; ``alternatives`` says the same of causes that the
recordings cannot rule out, and that must be told there, and not found. ``scores`` are paths into
``scores`` of ``diagnosis.json``. Only that content is judged, so the expectation cannot leak into a
diagnosis.
"""

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from symhyb.errors import InputError, Problem
from symhyb.model.tables import Fault, Table, describe

SHAPES = ("length", "stribeck", "transition")
"""Terms that shape a law and are no effect of their own."""
_KEYS = ("source", "verdict", "found", "nothing_else", "alternatives", "scores")


@dataclass(frozen=True, slots=True)
class Expected:
    """What ought to come out. ``found`` and ``alternatives`` by place.term: (value, part of it that
    it may be off); ``at_most`` by path of a score; a verdict of None is not judged."""

    source: str = ""
    verdict: str | None = None
    found: Mapping[str, tuple[float, float]] | None = None
    nothing_else: bool = False
    at_most: Mapping[str, float] | None = None
    alternatives: Mapping[str, tuple[float, float]] | None = None


@dataclass(frozen=True, slots=True)
class Check:
    """One expectation against what came out."""

    subject: str
    wanted: str
    got: str
    passed: bool


def read_expected(path: str | os.PathLike[str]) -> Expected:
    """Read ``expected.json``.

    Raises:
        InputError: every problem of the file.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(Problem(f"cannot be read: {error}", file=str(path))) from None
    faults: list[Fault] = []
    if not isinstance(content, dict):
        raise InputError(Problem("must be a mapping in braces", file=str(path)))
    root = Table((), content, faults)
    root = root.checked(_KEYS)
    expected = Expected(
        source=root.text("source") or "",
        verdict=root.text("verdict"),
        found=dict(_values(root, "found")),
        nothing_else=_flag(root, "nothing_else"),
        at_most=dict(_limits(root)),
        alternatives=dict(_values(root, "alternatives")),
    )
    if faults:
        raise InputError(Problem(text, ".".join(place), str(path)) for place, text in faults)
    return expected


def check(expected: Expected, content: Mapping[str, Any]) -> tuple[Check, ...]:
    """Compare what is expected with the content of a ``diagnosis.json``."""
    return tuple(_checks(expected, content))


def found_terms(content: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Give every fitted number of the found elements of a ``diagnosis.json`` by place.term."""
    return {
        f"{_place_name(effect['place'])}.{number['term']}": number
        for effect in content["found"]
        for number in effect["parameters"].values()
    }


def alternative_terms(content: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Give every number of the alternatives that are forces, by place.term; the best of each."""
    return {
        f"{_place_name(rival['place'])}.{number['term']}": number
        for rival in reversed(content["alternatives"])
        if rival.get("place")
        for number in rival["parameters"].values()
    }


def _values(root: Table, key: str) -> Iterator[tuple[str, tuple[float, float]]]:
    for name, table in _inner(root, key, ("value", "within")):
        value, within = table.number("value", True), table.number("within", True)
        if value is not None and within is not None:
            yield name, (value, within)


def _limits(root: Table) -> Iterator[tuple[str, float]]:
    for name, table in _inner(root, "scores", ("at_most",)):
        limit = table.number("at_most", True)
        if limit is not None:
            yield name, limit


def _inner(root: Table, key: str, keys: tuple[str, ...]) -> Iterator[tuple[str, Table]]:
    around = root.table(key)
    for name in around.entries if around else ():
        table = around.table(name) if around else None
        if table is not None:
            yield name, table.checked(keys)


def _flag(root: Table, key: str) -> bool:
    value = root.entries.get(key, False)
    if not isinstance(value, bool):
        root.fault(f"must be true or false, not {describe(value)}", key)
    return value is True


def _checks(expected: Expected, content: Mapping[str, Any]) -> Iterator[Check]:
    if expected.verdict is not None:
        got = content["verdict"]
        yield Check("verdict", expected.verdict, got, got == expected.verdict)
    terms = found_terms(content)
    for name, (value, within) in (expected.found or {}).items():
        yield _value_check(name, value, within, terms.get(name))
    if expected.nothing_else:
        others = list(_others(expected, content, terms))
        yield Check("anything else", "nothing", ", ".join(others) or "nothing", not others)
    rivals = alternative_terms(content) if expected.alternatives else {}
    for name, (value, within) in (expected.alternatives or {}).items():
        one = _value_check(name, value, within, rivals.get(name))
        told = name in rivals and name not in terms
        yield replace(one, subject=f"alternative {name}", passed=one.passed and told)
    for path, limit in (expected.at_most or {}).items():
        got = _score(content["scores"], path)
        passed = got is not None and got <= limit
        yield Check(path, f"at most {limit:.4g}", "none" if got is None else f"{got:.4g}", passed)


def _value_check(name: str, value: float, within: float, number: Mapping[str, Any] | None) -> Check:
    wanted = f"{value:.6g} within {100 * within:g} %"
    if number is None:
        return Check(name, wanted, "not found", False)
    off = number["value"] / value - 1 if value else float("inf")
    got = f"{number['value']:.6g} ± {number['sd']:.2g} {number['unit']} ({100 * off:+.2f} %)"
    return Check(name, wanted, got, abs(number["value"] - value) <= within * abs(value))


def _others(
    expected: Expected, content: Mapping[str, Any], terms: Mapping[str, Mapping[str, Any]]
) -> Iterator[str]:
    """Name what was found beyond the expectation."""
    for name in terms:
        if name not in (expected.found or {}) and name.rpartition(".")[2] not in SHAPES:
            yield name
    yield from (f"parameter {changed['name']}" for changed in content["parameters"])
    yield from (f"{fault['kind']} of {fault['channel']}" for fault in content["measurement"])


def _score(scores: Any, path: str) -> float | None:
    for key in path.split("."):
        scores = scores.get(key) if isinstance(scores, Mapping) else None
    return float(scores) if isinstance(scores, int | float) else None


def _place_name(place: Mapping[str, Any]) -> str:
    (where,) = place.values()
    return where if isinstance(where, str) else "-".join(where)

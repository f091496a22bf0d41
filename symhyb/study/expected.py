"""What a study is expected to find, and whether a diagnosis did: the file ``expected.json``.

    {
      "source": "where the values and the tolerances come from",
      "verdict": "missing physics",
      "found": {"x.coulomb": {"value": 20.3935, "within": 0.05}},
      "nothing_else": true,
      "scores": {"holdout.after.window_rmse.encoder": {"at_most": 6.0e-5}},
      "published": {"source": "who", "found": {"x.coulomb": {"value": 20.3935, "unit": "N"}}}
    }

``found`` names place.term (two points as ``anchor-tip``), the value in the unit of the diagnosis
and how far off it may be, as a part of it. ``scores`` are paths into ``scores`` of
``diagnosis.json``. ``alternatives`` are causes that must stand among the rivals: a list of names
(``x.drag``: place.kind), or numbers by place.term as under ``found``. ``any_of`` are
several whole expectations of which one must be met. ``published`` is never judged: it is shown
beside what was found. Only the finished content is judged, so nothing can leak into a diagnosis.
"""

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, get_args

from symhyb.discrepancy.results import VerdictName
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.limits import text_of
from symhyb.model.tables import Fault, Table, describe
from symhyb.study.published import Published, read_published

SHAPES = ("length", "stribeck", "transition")
"""Terms that shape a law and are no effect of their own."""


VERDICTS: tuple[str, ...] = get_args(VerdictName)
KEYS = ("verdict", "found", "nothing_else", "scores", "alternatives")
"""What can be expected, at the top and in each case of ``any_of``."""


@dataclass(frozen=True, slots=True)
class Expected:
    """What ought to come out. ``found`` by place.term: (value, part of it that it may be off);
    ``at_most`` by path of a score; a verdict of None is not judged. ``alternatives`` are
    place.kind, channel.kind or parameter.name with None, or place.term with (value, part of it);
    of ``any_of``, if there are any, one must be met."""

    source: str = ""
    verdict: str | None = None
    found: Mapping[str, tuple[float, float]] | None = None
    nothing_else: bool = False
    at_most: Mapping[str, float] | None = None
    alternatives: Mapping[str, tuple[float, float] | None] | None = None
    any_of: "tuple[Expected, ...]" = ()
    published: Published | None = None


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
        content = json.loads(text_of(path))
    except (ValueError, RecursionError) as error:
        raise InputError(Problem(f"is no JSON: {error}", file=str(path))) from None
    faults: list[Fault] = []
    if not isinstance(content, dict):
        raise InputError(Problem("must be a mapping in braces", file=str(path)))
    root = Table((), content, faults)
    root = root.checked(("source", *KEYS, "any_of", "published"))
    expected = replace(
        _case(root),
        source=root.text("source") or "",
        any_of=tuple(_cases(root)),
        published=read_published(root),
    )
    if faults:
        raise InputError(Problem(text, ".".join(place), str(path)) for place, text in faults)
    return expected


def check(expected: Expected, content: Mapping[str, Any]) -> tuple[Check, ...]:
    """Compare what is expected with the content of a ``diagnosis.json``.

    Of the cases of ``any_of`` the first that is met counts, else the one that comes nearest; what
    it expects to be found is not counted as anything else.
    """
    if not expected.any_of:
        return tuple(_checks(expected, content))
    tried = [tuple(_checks(case, content)) for case in expected.any_of]
    missed = [sum(not one.passed for one in checks) / max(len(checks), 1) for checks in tried]
    nearest = missed.index(min(missed))
    always = _checks(expected, content, expected.any_of[nearest].found or ())
    name = f"case {nearest + 1} of {len(tried)}: "
    return (*always, *(replace(one, subject=name + one.subject) for one in tried[nearest]))


def found_terms(content: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Give every fitted number of a ``diagnosis.json`` by name: ``x.coulomb`` of a found element,
    ``parameter.k``, ``force.offset`` of a channel; a recording's own number as ``x.drag@a.csv``."""
    terms: dict[str, Mapping[str, Any]] = {}
    for effect in content["found"]:
        place = place_name(effect["place"])
        for recording, numbers in (("", effect["parameters"]), *effect.get("own", {}).items()):
            behind = f"@{recording}" if recording else ""
            terms |= {f"{place}.{one['term']}{behind}": one for one in numbers.values()}
    for changed in content["parameters"]:
        name = f"parameter.{changed['name']}"
        terms[name] = changed
        terms |= {
            f"{name}@{recording}": {**one, "unit": changed["unit"]}
            for recording, one in changed.get("own", {}).items()
        }
    return terms | {f"{one['channel']}.{one['kind']}": one for one in content["measurement"]}


def _case(table: Table) -> Expected:
    """Read what is expected, without source and other cases."""
    verdict = table.text("verdict")
    if verdict is not None and verdict not in VERDICTS:
        table.fault(f"'{verdict}' is no verdict{did_you_mean(verdict, VERDICTS)}", "verdict")
    return Expected(
        verdict=verdict,
        found=dict(_values(table, "found")),
        nothing_else=_flag(table, "nothing_else"),
        at_most=dict(_limits(table)),
        alternatives=_alternatives(table),
    )


def _cases(root: Table) -> Iterator[Expected]:
    """Read the list of cases under ``any_of``."""
    listed = root.entries.get("any_of", [])
    if not isinstance(listed, list) or not all(isinstance(case, dict) for case in listed):
        root.fault(f"must be a list of mappings in braces, not {describe(listed)}", "any_of")
        return
    if len(listed) == 1 or ("any_of" in root.entries and not listed):
        root.fault("must hold at least two cases", "any_of")
    for number, entries in enumerate(listed, 1):
        table = Table((f"any_of[{number}]",), entries, root.faults).checked(KEYS)
        if not entries:
            table.fault("an empty case is always met")
        yield _case(table)


def _alternatives(table: Table) -> dict[str, tuple[float, float] | None]:
    """Read causes by name alone, or numbers by place.term."""
    listed = table.entries.get("alternatives", [])
    if isinstance(listed, dict):
        return dict(_values(table, "alternatives"))
    if isinstance(listed, list) and all(isinstance(name, str) for name in listed):
        return dict.fromkeys(listed)
    said = f'must be a list of names, like ["x.drag"], or a mapping, not {describe(listed)}'
    table.fault(said, "alternatives")
    return {}


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


def _checks(
    expected: Expected, content: Mapping[str, Any], also: Iterable[str] = ()
) -> Iterator[Check]:
    if expected.verdict is not None:
        got = content["verdict"]
        yield Check("verdict", expected.verdict, got, got == expected.verdict)
    terms = found_terms(content)
    for name, (value, within) in (expected.found or {}).items():
        yield _value_check(name, value, within, terms.get(name))
    if expected.nothing_else:
        others = list(_others({*(expected.found or {}), *also}, content, terms))
        yield Check("anything else", "nothing", ", ".join(others) or "nothing", not others)
    yield from _rival_checks(expected, content, terms)
    for path, limit in (expected.at_most or {}).items():
        got = score_at(content["scores"], path)
        passed = got is not None and got <= limit
        yield Check(path, f"at most {limit:.4g}", "none" if got is None else f"{got:.4g}", passed)


def _rival_checks(
    expected: Expected, content: Mapping[str, Any], terms: Mapping[str, Mapping[str, Any]]
) -> Iterator[Check]:
    """What must stand among the alternatives, and not be found."""
    names = _rivals(content)
    numbers = {
        f"{place_name(rival['place'])}.{number['term']}": number
        for rival in reversed(content["alternatives"])  # the best of each comes last and stays
        if "place" in rival
        for number in rival["parameters"].values()
    }
    for name, value in (expected.alternatives or {}).items():
        subject = f"alternative {name}"
        if value is not None:
            one = _value_check(name, *value, numbers.get(name))
            yield replace(one, subject=subject, passed=one.passed and name not in terms)
            continue
        got = "among the alternatives" if name in names else ", ".join(names) or "none"
        yield Check(subject, "among the alternatives", got, name in names)


def _rivals(content: Mapping[str, Any]) -> list[str]:
    """Name every alternative: ``x.drag``, ``force.offset``, ``parameter.k``."""
    names = []
    for rival in content["alternatives"]:
        where = place_name(rival["place"]) if "place" in rival else rival.get("channel")
        name = f"{where}.{rival['kind']}" if where else f"parameter.{rival['parameter']}"
        names.append(name)
    return list(dict.fromkeys(names))


def _value_check(name: str, value: float, within: float, number: Mapping[str, Any] | None) -> Check:
    wanted = f"{value:.6g} within {100 * within:g} %"
    if number is None:
        return Check(name, wanted, "not found", False)
    off = number["value"] / value - 1 if value else float("inf")
    got = f"{number['value']:.6g} ± {number['sd']:.2g} {number['unit']} ({100 * off:+.2f} %)"
    return Check(name, wanted, got, abs(number["value"] - value) <= within * abs(value))


def _others(
    expected: Iterable[str], content: Mapping[str, Any], terms: Mapping[str, Mapping[str, Any]]
) -> Iterator[str]:
    """Name what was found beyond the ``expected`` terms."""
    wanted = {name.partition("@")[0] for name in expected}
    words = {
        f"parameter.{one['name']}": f"parameter {one['name']}" for one in content["parameters"]
    }
    for one in content["measurement"]:
        words[f"{one['channel']}.{one['kind']}"] = f"{one['kind']} of {one['channel']}"
    for name in terms:
        if name not in wanted and "@" not in name and name.rpartition(".")[2] not in SHAPES:
            yield words.get(name, name)


def score_at(scores: Any, path: str) -> float | None:
    """Give the number under a path like ``holdout.after.window_rmse.encoder``, None without."""
    for key in path.split("."):
        scores = scores.get(key) if isinstance(scores, Mapping) else None
    return float(scores) if isinstance(scores, int | float) else None


def place_name(place: Mapping[str, Any]) -> str:
    """A place of a ``diagnosis.json`` in one word; two points as ``anchor-tip``."""
    (where,) = place.values()
    return where if isinstance(where, str) else "-".join(where)

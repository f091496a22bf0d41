"""Tables of a result, and of two results side by side."""

from collections.abc import Iterator, Mapping
from typing import TypeVar

from symhyb.discrepancy.words.amounts import percent_text, quantity_text
from symhyb.report.contract import UNBOUNDED
from symhyb.report.tables import Table
from symhyb.workbench.results import Errors, Number, Result

NONE = "–"
Item = TypeVar("Item", Number, Errors)


def result_tables(result: Result) -> tuple[Table, ...]:
    """The numbers and the errors of one result; tables without rows are left out."""
    numbers = Table(
        "What was found",
        ("of", "term", "value", "before", "share of the error"),
        tuple(_number_rows(result)),
        (2, 3, 4),
    )
    errors = Table(
        "Errors of the simulation (NRMSE)",
        ("recordings", "score", "channel", "before", "after"),
        tuple(
            (one.recordings, one.score, one.channel, _percent(one.before), _percent(one.after))
            for one in result.errors
        ),
        (3, 4),
    )
    return tuple(table for table in (numbers, errors) if table.rows)


def compared_tables(first: Result, second: Result) -> tuple[Table, ...]:
    """Two results side by side: the answers, every number of either, and the errors of both."""
    answers = Table(
        "Answers",
        ("", "first", "second"),
        (
            ("verdict", first.verdict, second.verdict),
            ("found", _names(first), _names(second)),
        ),
        (),
    )
    mine, theirs = _keyed(first.all_numbers()), _keyed(second.all_numbers())
    numbers = Table(
        "Numbers",
        ("of", "term", "first", "second", "apart by"),
        tuple(
            (*key, _value(mine.get(key)), _value(theirs.get(key)), _apart(mine.get(key), one))
            for key, one in {**dict.fromkeys(mine), **theirs, **_common(mine, theirs)}.items()
        ),
        (2, 3, 4),
    )
    own, others = _keyed(first.errors), _keyed(second.errors)
    errors = Table(
        "Errors after the correction (NRMSE)",
        ("recordings", "score", "channel", "first", "second"),
        tuple(
            (*key, _after(own.get(key)), _after(others.get(key)))
            for key in dict.fromkeys((*own, *others))
        ),
        (3, 4),
    )
    return tuple(table for table in (answers, numbers, errors) if table.rows)


def _number_rows(result: Result) -> Iterator[tuple[str, ...]]:
    for law in result.laws:
        for i, one in enumerate(law.numbers):
            share = percent_text(law.share) if i == 0 and law.share is not None else ""
            yield one.of, one.term, _value(one), "", share
    for one in result.numbers:
        was = "" if one.was is None else quantity_text(one.was, one.unit)
        yield one.of, one.term, _value(one), was, ""


def _keyed(items: tuple[Item, ...]) -> Mapping[tuple[str, ...], Item]:
    return {one.key: one for one in items}


def _common(
    mine: Mapping[tuple[str, ...], Number], theirs: Mapping[tuple[str, ...], Number]
) -> Mapping[tuple[str, ...], Number]:
    return {key: theirs[key] for key in mine if key in theirs}


def _value(one: Number | None) -> str:
    if one is None:
        return NONE
    if one.sd >= UNBOUNDED:
        return f"{quantity_text(one.value, one.unit)} (deviation unbounded)"
    return quantity_text(one.value, one.unit, one.sd)


def _apart(first: Number | None, second: Number | None) -> str:
    """By how many deviations of both two numbers differ."""
    if first is None or second is None or first.unit != second.unit:
        return ""
    spread = float((first.sd**2 + second.sd**2) ** 0.5) if max(first.sd, second.sd) < 1e150 else 0
    return f"{abs(first.value - second.value) / spread:.2g} deviations" if spread else ""


def _names(result: Result) -> str:
    return ", ".join(law.name for law in result.laws) or NONE


def _percent(share: float | None) -> str:
    return NONE if share is None else percent_text(share)


def _after(one: Errors | None) -> str:
    return NONE if one is None else _percent(one.after)

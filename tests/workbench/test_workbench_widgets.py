"""Text on its way into the page, and the ranges of sliders."""

from dataclasses import replace

import pytest

from symhyb.model.types import Parameter
from symhyb.report.tables import Table
from symhyb.units import parse_unit
from symhyb.workbench.widgets import (
    Picker,
    copied,
    link,
    listed,
    paragraph,
    problems_of,
    slider_range,
    tables_of,
    text,
)

EVIL = "<script>alert('x')</script>"


def test_what_a_person_gave_is_text() -> None:
    table = Table(EVIL, (EVIL,), ((EVIL,),), ())
    parts = (
        paragraph(EVIL),
        listed([EVIL]),
        problems_of([EVIL]),
        copied(EVIL),
        link(f'"{EVIL}', EVIL),
        tables_of([table]),
        text(EVIL).text,
    )
    assert all("<script" not in part and "&lt;script" in part for part in parts)
    assert 'href="&#34;' in parts[4]


def test_nothing_is_nothing() -> None:
    assert not any((paragraph(""), listed([]), problems_of([]), copied("")))
    assert tables_of([Table("none", ("a",), (), ())]) == ""


def test_of_many_things_some_are_drawn_until_others_are_picked() -> None:
    changes: list[int] = []
    picker = Picker(lambda: changes.append(1))
    assert picker.picked(["a", "b"]) == (0, 1)
    assert not picker.layout.visible
    assert picker.picked("abcde") == (0, 1, 2)
    assert picker.layout.visible
    picker.layout.active = [4, 1]
    assert picker.picked("abcde") == (1, 4)
    assert changes


@pytest.mark.parametrize(
    ("value", "sd", "shown", "ends"),
    [
        (200.0, 10.0, 200.0, (150.0, 250.0)),
        (4.0, None, 4.0, (0.0, 8.0)),
        (-4.0, None, -4.0, (-8.0, 0.0)),
        (0.0, None, 0.0, (-1.0, 1.0)),
        (4.0, None, 20.0, (0.0, 20.0)),
        (4.0, None, -1.0, (-1.0, 8.0)),
    ],
)
def test_a_slider_reaches_what_may_be_and_what_was_typed(
    value: float, sd: float | None, shown: float, ends: tuple[float, float]
) -> None:
    item = replace(Parameter("k", value, parse_unit("N/m")), sd=sd)
    low, high, step = slider_range(item, shown)
    assert (low, high) == ends
    assert step == pytest.approx((high - low) / 200)

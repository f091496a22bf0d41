"""Symbols of elements: they begin and end where they should, whatever the direction."""

import numpy as np
import pytest

from symhyb.model.types import Element, On
from symhyb.report.symbols import arc, ground, symbol


def of_kind(kind: str, *words: tuple[str, str]) -> Element:
    return Element("e", kind, On("x"), (), options=words)


KINDS = ("spring", "damper", "friction", "gap", "relaxation", "law")


@pytest.mark.parametrize("kind", KINDS)
def test_a_symbol_joins_its_two_places(kind: str) -> None:
    a, b = np.array([1.0, 2.0]), np.array([-2.0, 6.0])
    lines = np.vstack(symbol(of_kind(kind), a, b, 0.5))
    for place in (a, b):
        assert np.min(np.linalg.norm(lines - place, axis=1)) < 1e-12
    along = (b - a) / 5.0
    away = (lines - a) @ np.array([-along[1], along[0]])
    assert np.abs(away).max() <= 0.25 + 1e-12


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        ((("over", "stretch"),), "spring"),
        ((("over", "rate"),), "damper"),
        ((("over", "stretch"), ("times", "rate")), "damper"),
    ],
)
def test_a_curve_is_drawn_as_what_it_does(words: tuple[tuple[str, str], ...], kind: str) -> None:
    a, b = np.zeros(2), np.array([1.0, 0.0])
    lines, others = symbol(of_kind("curve", *words), a, b, 0.5), symbol(of_kind(kind), a, b, 0.5)
    assert all(np.array_equal(x, y) for x, y in zip(lines, others, strict=True))


@pytest.mark.parametrize("kind", ["added_mass", "mode", "payload"])
def test_what_rides_is_a_box_that_hangs_on_its_place(kind: str) -> None:
    a, b = np.zeros(2), np.array([0.0, 3.0])
    box, *rest = symbol(of_kind(kind), a, b, 0.5)
    assert box.mean(axis=0) == pytest.approx(a, abs=0.06)
    assert np.ptp(box, axis=0) == pytest.approx([0.5, 0.5])
    assert rest[-1][-1] == pytest.approx(b)


def test_two_places_that_are_one_give_finite_lines() -> None:
    a = np.zeros(2)
    assert np.isfinite(np.vstack(symbol(of_kind("spring"), a, a, 0.5))).all()


def test_the_hatching_of_a_wall_is_on_its_outer_side() -> None:
    lines = np.vstack(ground(np.zeros(2), np.array([0.0, -3.0]), 1.0))
    assert lines[:, 1].max() <= 1e-12
    assert lines[:, 1].min() < -0.1


def test_an_arc_keeps_its_radius() -> None:
    points = arc(np.array([1.0, 1.0]), 2.0, 0.0, 1.0)
    assert np.linalg.norm(points - 1.0, axis=1) == pytest.approx(2.0)

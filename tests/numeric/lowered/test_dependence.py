"""Rows of constraints that hold nothing, or what others hold."""

import casadi as ca
import numpy as np

from symhyb.numeric.lowered.dependence import dependent, idle, slight

ALL = np.ones(3, dtype=bool)


def test_rows_that_repeat_others_are_named_with_these() -> None:
    rows = np.array([[1.0, 0, 0], [0, 1, 0], [1, -2, 0], [0, 0, 1]])
    assert dependent(rows, ALL, ("a", "b", "c", "d")) == {2: [0, 1]}


def test_what_rounding_leaves_of_a_zero_is_a_zero() -> None:
    """Of the length of the other rows of the same constraint; a small constraint is none."""
    rows = np.array([[1.0, 0, 0], [3e-17, 0, 2e-17], [0, 1e-13, 0]])
    assert dependent(rows, ALL, ("pin.x", "pin.y", "other")) == {1: []}
    assert dependent(rows, ALL, ("pin.x", "single", "other")) == {}


def test_what_hinges_leave_that_are_nearly_parallel_is_slight() -> None:
    """Everywhere, and of a vector alone: a small row of another constraint counts."""
    labels, vectors = ("pin.x", "pin.y", "single"), ["pin"]
    nearly, more = (np.array([[1.0, 0, 0], [0, y, 0], [0, 0, 1e-6]]) for y in (1e-4, 1e-3))
    assert slight([nearly], labels, vectors) == (1,)
    assert slight([nearly, more], labels, vectors) == ()
    assert slight([nearly], labels, []) == ()
    assert slight([nearly], labels, vectors, 1e-5) == ()


def test_what_is_imposed_does_not_count() -> None:
    rows = np.array([[1.0, 1, 0], [1, 2, 0]])
    assert dependent(rows, np.array([True, False, True]), ("a", "b")) == {1: [0]}


def test_parts_that_hold_nothing_are_idle_unless_the_others_hold() -> None:
    q, t, p = ca.SX.sym("q", 3), ca.SX.sym("t"), ca.SX.sym("p")
    still = ca.SX.sym("v", 3)
    gap = ca.vertcat(q[0] - p, 0, q[2] - q[2], ca.sin(t), p, q[1])
    labels = ("pin.x", "pin.y", "rod", "moved", "led.x", "led.y")
    given = [q, still, ca.SX.sym("a", 3), t, p]
    closure = ca.Function("closure", given, [gap, ca.jtimes(gap, q, still)])
    assert idle(closure, labels, ALL) == ["rod", "moved"]
    assert idle(closure, labels, np.array([True, False, True])) == [
        "rod",
        "moved",
        "led.x",
        "led.y",
    ]

"""Whether links and joints are a tree, and the order in which it is walked."""

import time

from symhyb.imports.robot import Joint, Link
from symhyb.imports.tree import COMPARED, nearest, tree_problems, walk


def links(*names: str) -> dict[str, Link]:
    return {name: Link(name, line=7) for name in names}


def joints(*ends: tuple[str, str]) -> list[Joint]:
    return [Joint(f"{a}{b}", "fixed", a, b, line=9) for a, b in ends]


def said(known: dict[str, Link], tied: list[Joint]) -> list[str]:
    return [str(problem) for problem in tree_problems(known, tied, "f")]


def test_a_parent_comes_before_its_children() -> None:
    tied = joints(("b", "c"), ("a", "b"), ("a", "d"), ("c", "e"))
    root, order = walk(links(*"abcde"), tied)
    assert root == "a"
    assert [joint.name for joint in order] == ["ab", "bc", "ce", "ad"]
    assert said(links(*"abcde"), tied) == []


def test_each_thing_that_is_no_tree_is_said_once() -> None:
    assert said({}, []) == ["f: has no link"]
    (roots,) = said(links(*"abc"), joints(("a", "b")))
    assert roots.startswith("f: has 2 links that hang on nothing (a, c); one is the root")
    (twice,) = said(links(*"abc"), joints(("a", "b"), ("a", "c"), ("c", "b")))
    assert twice.startswith("f:9: joint.cb.child: 'b' hangs on the joint 'ab' already")
    assert "closed loop is a constraint" in twice
    (circle,) = said(links(*"abcd"), joints(("a", "b"), ("c", "d"), ("d", "c")))
    assert circle.startswith("f:7: link.c: the links c, d hang on each other in a circle")
    (alone,) = said(links("a"), joints(("a", "a")))
    assert "in a circle" in alone


def test_links_that_are_not_there_are_said_with_the_nearest() -> None:
    found = said(links("base", "arm"), joints(("base", "arn"), ("bse", "arm")))
    assert found[0] == "f:9: joint.basearn.child: 'arn' is not a link; did you mean 'arm'?"
    assert found[1] == "f:9: joint.bsearm.parent: 'bse' is not a link; did you mean 'base'?"
    assert len(found) == 2


def test_many_names_are_not_compared() -> None:
    assert nearest("x1", [f"x{k}" for k in range(COMPARED + 1)]) == ""


def test_a_chain_of_any_length_is_walked() -> None:
    count = 20_000
    known = links(*(str(k) for k in range(count)))
    tied = joints(*((str(k), str(k + 1)) for k in range(count - 1)))
    begin = time.process_time()
    assert said(known, tied) == []
    assert len(walk(known, tied)[1]) == count - 1
    assert time.process_time() - begin < 5

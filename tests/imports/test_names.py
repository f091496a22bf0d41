"""Names of a robot become names of a model file, none twice."""

import re

import pytest

from symhyb.imports.names import LONGEST, identifier, stems


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("joint_1", "joint_1"),
        ("_odd_", "_odd_"),
        ("joint 1-2", "joint_1_2"),
        ("joint.0.0", "joint_0_0"),
        ("1st", "joint_1st"),
        ("t", "joint_t"),
        ("sin", "joint_sin"),
        ("class", "joint_class"),
        ("größe", "gr_e"),
        ("\u202e\n#[x]", "x"),
        ("", "joint"),
        ("…", "joint"),
    ],
)
def test_the_nearest_name(name: str, expected: str) -> None:
    assert identifier(name, "joint") == expected


def test_long_names_leave_room_for_a_suffix() -> None:
    name = identifier("x" * 500, "joint")
    assert len(name) == LONGEST
    assert len(identifier("9" * 500, "joint") + "_2_friction") <= 60


def test_no_stem_with_a_suffix_is_another() -> None:
    """A joint 'a_m' beside a link 'a', whose mass is a_m, and names that become one."""
    taken = {"g"}
    joints = stems(["a", "a_m", "a m", "g"], ("", "_m"), taken, "joint")
    assert joints["a"] == "a"
    given = [stem + suffix for stem in joints.values() for suffix in ("", "_m")]
    assert len(set(given)) == len(given) == 8
    assert "g" not in given
    assert stems(["a"], ("_m",), taken, "link")["a"] == "a_2"


def test_reserved_words_are_met_with_any_suffix() -> None:
    found = stems(["sin", "t"], ("", "h"), set(), "joint")
    assert all(re.fullmatch(r"joint_\w+", stem) for stem in found.values())

"""What is welded is one body; what is locked, driven or idle is said."""

import numpy as np
import pytest
from robots import ARM, joint, link, robot

from symhyb.errors import InputError
from symhyb.imports.reduction import Drive, Reduced, Wish, reduced
from symhyb.imports.rigid import ball, joined, moved
from symhyb.imports.urdf import parse_urdf


def of(text: str, wish: Wish | None = None) -> Reduced:
    return reduced(parse_urdf(text.encode(), "f"), wish)


def problems(text: str, wish: Wish) -> list[str]:
    with pytest.raises(InputError) as error:
        of(text, wish)
    return [str(problem) for problem in error.value.problems]


def test_welded_links_are_in_the_body_that_carries_them() -> None:
    found = of(ARM)
    assert [(one.name, one.carrier, one.links) for one in found.bodies] == [
        ("upper", "", ("plate",)),
        ("fore", "upper", ()),
        ("slide", "fore", ()),
        ("tool", "slide", ()),
        ("finger", "tool", ()),
    ]
    assert found.grounded == ("base",)
    assert dict(found.locked) == {}
    upper = found.bodies[0].inertial
    assert upper is not None
    assert upper.mass == pytest.approx(3.4)


def test_joints_are_locked_where_they_are_told() -> None:
    found = of(ARM, Wish(("elbow",), {"twist": 0.4, "elbow": 0.2}))
    assert [body.name for body in found.bodies] == ["fore"]
    assert dict(found.locked) == {"shoulder": 0, "reach": 0, "twist": 0.4, "grip": 0}
    assert found.start["elbow"] == 0.2
    assert set(found.grounded) == {"base", "upper", "plate"}


def test_zero_outside_the_travel_is_no_place_to_start() -> None:
    limit = '<limit lower="0.5" upper="1.5"/>'
    text = robot(link("a"), link("b"), joint("j", "revolute", "a", "b", more=limit))
    assert of(text).start["j"] == 1.0
    assert of(text, Wish(positions={"j": 0.0})).start["j"] == 0.0


def test_followers_of_followers_are_driven_by_the_first() -> None:
    text = robot(
        *(link(name) for name in "abcd"),
        joint("j", "revolute", "a", "b"),
        joint("k", "revolute", "b", "c", more='<mimic joint="j" multiplier="2" offset="1"/>'),
        joint("m", "revolute", "c", "d", more='<mimic joint="k" multiplier="3" offset="-2"/>'),
    )
    drives = [body.drive for body in of(text).bodies]
    assert drives == [Drive("j"), Drive("j", 2, 1), Drive("j", 6, 1)]
    assert [body.own for body in of(text).bodies] == [True, False, False]
    (said,) = problems(text, Wish(("m",)))
    assert said == "f: --joints: 'm' follows the joint 'j'; name that one"


def test_a_follower_of_what_stands_is_locked() -> None:
    text = robot(
        *(link(name) for name in "abcd"),
        joint("j", "fixed", "a", "b"),
        joint("k", "revolute", "b", "c", more='<mimic joint="j" multiplier="2" offset="1"/>'),
        joint("m", "revolute", "c", "d"),
    )
    found = of(text)
    assert [body.name for body in found.bodies] == ["d"]
    assert dict(found.locked) == {"k": 1.0}


def test_a_mass_without_inertia_is_a_ball() -> None:
    nothing = (0.0,) * 6
    text = robot(link("a"), link("b", 0.2, tensor=nothing), joint("j", "revolute", "a", "b"))
    found = of(text)
    inertial = found.bodies[0].inertial
    assert inertial is not None
    assert np.allclose(inertial.tensor, ball(0.2) * np.eye(3), rtol=1e-3)
    assert "gets 5.43e-05 kg·m² about every axis" in found.notes[0]


def test_points_that_are_welded_apart_are_a_body_without_a_note() -> None:
    nothing = (0.0,) * 6
    text = robot(
        link("a"),
        link("b", 0.2, (0, 0, 0), nothing),
        link("c", 0.3, (0, 0, 0), nothing),
        joint("j", "revolute", "a", "b"),
        joint("w", "fixed", "b", "c", (0.5, 0, 0)),
    )
    found = of(text)
    assert found.notes == ()
    assert found.bodies[0].inertial is not None
    assert found.bodies[0].inertial.tensor[2, 2] == pytest.approx(0.2 * 0.3 / 0.5 * 0.25)


def test_joints_that_move_nothing_are_locked_with_a_note() -> None:
    rod = (0.0, 0.0, 0.0, 0.1, 0.0, 0.1)
    text = robot(
        link("a"),
        link("b"),
        '<link name="wheel"/>',
        link("rod", 1.0, (0.1, 0, 0), rod),
        joint("j", "revolute", "a", "b"),
        joint("spin", "continuous", "b", "wheel"),
        joint("roll", "revolute", "b", "rod", axis=(1, 0, 0)),
    )
    found = of(text)
    assert [body.name for body in found.bodies] == ["b"]
    assert dict(found.locked) == {"spin": 0, "roll": 0}
    assert set(found.notes) == {
        f"the joint '{name}' moves nothing that has inertia: it is locked"
        for name in ("spin", "roll")
    }


def test_a_joint_without_mass_of_its_own_moves_what_hangs_on_it() -> None:
    text = robot(
        link("a"),
        '<link name="cross"/>',
        link("b"),
        joint("j", "revolute", "a", "cross", axis=(1, 0, 0)),
        joint("k", "revolute", "cross", "b", axis=(0, 1, 0)),
    )
    assert [(one.name, one.inertial is None) for one in of(text).bodies] == [
        ("cross", True),
        ("b", False),
    ]


def test_a_free_root_floats() -> None:
    found = of(ARM, Wish(("elbow",), free=True))
    assert [(one.name, one.joint.kind) for one in found.bodies] == [
        ("base", "floating"),
        ("fore", "continuous"),
    ]
    assert found.grounded == ()
    assert found.bodies[0].joint.name == "base"


def test_what_cannot_be_wished_is_said_at_once() -> None:
    found = problems(ARM, Wish(("elbo", "weld"), {"base": 1.0}))
    assert found[0] == "f: --joints: 'elbo' is not a joint that can move; did you mean 'elbow'?"
    assert found[1].startswith("f: --joints: 'weld' is not a joint that can move")
    assert found[2].startswith("f: --at: 'base' is not a joint that can move")
    planar = robot(link("a"), link("b"), joint("j", "planar", "a", "b"))
    assert "j' is planar; a position is" in problems(planar, Wish(positions={"j": 1.0}))[0]


def test_nothing_that_moves() -> None:
    text = robot(link("a"), link("b"), joint("j", "fixed", "a", "b"))
    assert problems(text, Wish()) == [
        "f: has no joint that moves anything with mass; --floating-base lets the root move in space"
    ]


def test_all_mass_is_somewhere() -> None:
    """The bodies of a robot that floats weigh what its links weigh, with one centre."""
    robot_ = parse_urdf(ARM.encode())
    found = reduced(robot_, Wish((), free=True))
    (one,) = found.bodies
    assert one.inertial is not None
    assert one.inertial.mass == pytest.approx(
        sum(part.inertial.mass for part in robot_.links.values() if part.inertial is not None)
    )
    assert joined([moved(one.inertial, one.pose)]).mass == one.inertial.mass

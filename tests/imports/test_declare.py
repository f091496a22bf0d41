"""What a model file says of a robot: names, units, expressions, limits."""

from robots import ARM, joint, link, robot

from symhyb.imports.declare import Declared, declare
from symhyb.imports.reduction import Wish, reduced
from symhyb.imports.urdf import parse_urdf


def declared(text: str, wish: Wish | None = None, **options: object) -> Declared:
    robot_ = parse_urdf(text.encode())
    return declare(robot_, reduced(robot_, wish), **options)


def test_motors_sensors_and_limits() -> None:
    limit = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'
    text = robot(
        *(link(name) for name in "abc"),
        joint("j", "revolute", "a", "b", more=limit),
        joint("s", "prismatic", "b", "c", more=limit),
    )
    model = declared(text, rates=True).model
    assert [(one.name, str(one.unit)) for one in model.inputs] == [
        ("j_torque", "N*m"),
        ("s_force", "N"),
    ]
    assert [(one.name, one.measures.text, str(one.unit)) for one in model.sensors] == [
        ("j", "j", "rad"),
        ("j_rate", "j'", "rad/s"),
        ("s", "s", "m"),
        ("s_rate", "s'", "m/s"),
    ]
    assert {one.name: (one.between, one.rate) for one in model.limits} == {
        "j": ((-1, 2), 3),
        "s": ((-1, 2), 3),
        "j_torque": ((-4, 4), None),
        "s_force": ((-4, 4), None),
    }
    passive = declared(text, passive=("s",)).model
    assert [one.name for one in passive.inputs] == ["j_torque"]
    assert [one.name for one in passive.elements] == ["j_motor"]
    assert len(passive.coordinates) == 2


def test_each_body_knows_its_parameters() -> None:
    found = declared(ARM)
    names = [one.name for one in found.model.parameters]
    grouped = [name for group in found.groups.values() for name in group]
    assert names == ["g", *grouped]
    assert found.groups["slide"][:3] == ("reach_oy", "reach_oz", "reach_yaw")


def test_a_body_without_any_mass_is_a_frame_or_nothing() -> None:
    """A cross of a universal joint is a frame; a follower that moves no mass is left out."""
    text = robot(
        link("a"),
        '<link name="cross"/>',
        link("b"),
        '<link name="hand"/>',
        joint("j", "revolute", "a", "cross", axis=(1, 0, 0)),
        joint("k", "revolute", "cross", "b", axis=(0, 1, 0)),
        joint("m", "revolute", "a", "hand", more='<mimic joint="j"/>'),
    )
    bodies = declared(text).model.bodies
    assert [(body.name, body.mass.text) for body in bodies] == [("cross", "0"), ("b", "b_m")]


def test_a_ball_has_one_moment_of_inertia_and_a_rod_three() -> None:
    def tensor(*values: float) -> str:
        text = robot(link("a"), link("b", tensor=values), joint("j", "revolute", "a", "b"))
        (body,) = declared(text).model.bodies
        return body.inertia.text if body.inertia else ",".join(one.text for one in body.tensor)

    assert tensor(2, 0, 0, 2, 0, 2) == "b_J"
    assert tensor(2, 0, 0, 2, 0, 1) == "b_Jxx,b_Jyy,b_Jzz"
    assert tensor(2, 0, 0.1, 2, 0, 1) == "b_Jxx,b_Jyy,b_Jzz,0,b_Jxz,0"

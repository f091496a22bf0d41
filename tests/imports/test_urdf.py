"""What a URDF says is read, what it does not say has its default, and all mistakes come at once."""

import time
from math import pi

import numpy as np
import pytest
from robots import joint, link, robot

from symhyb.errors import InputError
from symhyb.imports.robot import Mimic, Range, Robot
from symhyb.imports.urdf import parse_urdf
from symhyb.limits import DECLARED


def read(text: str) -> Robot:
    return parse_urdf(text.encode(), "f.urdf")


def problems(text: str) -> list[str]:
    with pytest.raises(InputError) as error:
        read(text)
    return [str(problem) for problem in error.value.problems]


def hinge(more: str = "", kind: str = "revolute", axis: str = '<axis xyz="0 0 1"/>') -> str:
    ends = '<parent link="a"/><child link="b"/>'
    return f'<joint name="j" type="{kind}">{ends}{axis}{more}</joint>'


def with_joint(text: str) -> str:
    return robot(link("a"), link("b"), text)


def test_a_robot_is_read() -> None:
    limit = '<limit lower="-1" upper="2.5" velocity="3" effort="4"/>'
    dynamics = '<dynamics damping="0.1" friction="0.2"/>'
    text = robot(
        link("a"),
        link("b", 2.0, (1, 2, 3), (3, 0, 0, 2, 0, 1.5), (0, 0, pi / 2)),
        joint("j", "revolute", "a", "b", (1, 2, 3), (4, 5, 6), (0, 3, 4), limit + dynamics),
    )
    found = read(text)
    assert (found.name, found.root, found.file) == ("robot", "a", "f.urdf")
    (one,) = found.joints
    assert (one.kind, one.parent, one.child) == ("revolute", "a", "b")
    assert (one.xyz, one.rpy, one.axis) == ((1, 2, 3), (4, 5, 6), (0, 0.6, 0.8))
    assert (one.damping, one.friction, one.range) == (0.1, 0.2, Range((-1, 2.5), 3, 4))
    inertial = found.links["b"].inertial
    assert inertial is not None
    assert inertial.mass == 2.0
    assert inertial.centre.tolist() == [1, 2, 3]
    assert np.allclose(inertial.tensor, np.diag([2, 3, 1.5]))  # turned by a right angle about z


def test_what_is_not_said_has_its_default() -> None:
    (one,) = read(with_joint(hinge(axis=""))).joints
    assert (one.xyz, one.rpy, one.axis) == ((0, 0, 0), (0, 0, 0), (1, 0, 0))
    assert (one.damping, one.friction, one.range, one.mimic) == (0, 0, Range(), None)
    assert read(with_joint(hinge("<limit/>"))).joints[0].range == Range()
    endless = '<limit lower="-inf" upper="inf" velocity="1e16" effort="0"/>'
    assert read(with_joint(hinge(endless))).joints[0].range == Range()
    bare = '<robot name="r"><link name="a"/></robot>'
    assert read(bare).links["a"].inertial is None


def test_joints_that_follow_and_gears() -> None:
    follow = '<mimic joint="j" multiplier="2" offset="-1"/>'
    more = (
        joint("k", "prismatic", "b", "c", more=follow)
        + '<transmission name="m"><joint name="j"/><actuator name="x">'
        "<mechanicalReduction> 50 </mechanicalReduction></actuator></transmission>"
    )
    found = read(robot(link("a"), link("b"), link("c"), hinge(), more))
    assert found.joints[1].mimic == Mimic("j", 2, -1)
    assert dict(found.gears) == {"j": 50}


def test_shapes_and_what_others_add_are_not_read() -> None:
    mesh = '<visual><geometry><mesh filename="../../../etc/passwd"/></geometry></visual>'
    more = '<gazebo><link/></gazebo><material name="m"/><unknown/>'
    text = f'<robot name="r"><link name="a">{mesh}</link>{more}</robot>'
    assert list(read(text).links) == ["a"]


def test_inertia_that_no_body_has_is_repaired_with_a_note() -> None:
    found = read(robot(link("a"), link("b", tensor=(1, 0, 0, 1, 0, 3)), hinge()))
    assert np.allclose(found.links["b"].inertial.tensor, np.diag([1.5, 1.5, 3]))
    ((about, note),) = found.notes
    assert about == "b"
    assert note.startswith("the inertia of the link 'b' is that of no body: its principal moments")
    assert "1, 1 and 3 kg·m²" in note
    assert note.endswith("are taken: 1.5, 1.5, 3")


def test_a_mass_without_inertia_is_a_point() -> None:
    text = with_joint(hinge()).replace('name="b"><inertial>', 'name="b"><inertial><x/>')
    start = text.index("<inertia ", text.index('name="b"'))
    end = text.index("/>", start) + 2
    found = read(text[:start] + text[end:])
    assert not found.links["b"].inertial.tensor.any()
    assert found.notes == (("b", "the link 'b' states no <inertia>; it is taken as 0"),)


BAD = {
    "kind": (hinge(kind="revolut"), "'revolut' is not a kind of joint; did you mean 'revolute'?"),
    "no kind": (hinge().replace('type="revolute"', ""), "j.type: is missing"),
    "no parent": (hinge().replace('<parent link="a"/>', ""), "j.parent: is missing; write <parent"),
    "axis 0": (hinge(axis='<axis xyz="0 0 0"/>'), "j.axis.xyz: has the length 0"),
    "axis of two": (hinge(axis='<axis xyz="0 1"/>'), "must be three numbers, not '0 1'"),
    "axis no number": (hinge(axis='<axis xyz="0 0 z"/>'), "must be a finite number, not 'z'"),
    "NaN": (hinge('<origin xyz="nan 0 0"/>'), "j.origin.xyz: must be a finite number, not 'nan'"),
    "infinite": (hinge('<origin rpy="0 0 inf"/>'), "must be a finite number, not 'inf'"),
    "too large": (hinge('<origin xyz="1e200 0 0"/>'), "is '1e200'; no robot has more than"),
    "macro": (hinge('<origin xyz="${a} 0 0"/>'), "expand the xacro file first"),
    "limits": (hinge('<limit lower="1" upper="-1"/>'), "j.limit: lower is 1 and upper -1"),
    "damping": (hinge('<dynamics damping="-1"/>'), "j.dynamics.damping: is -1; it would drive"),
    "mimic of none": (hinge('<mimic joint="h"/>'), "j.mimic: 'h' is not a joint"),
    "mimic of itself": (hinge('<mimic joint="j"/>'), "j.mimic: follows itself"),
    "mimic without": (hinge("<mimic/>"), "j.mimic.joint: is missing"),
    "no name": (hinge().replace('name="j"', ""), "joint: has no name"),
    "twice": (hinge() + hinge(), "joint.j: there is already a joint of this name"),
}


@pytest.mark.parametrize("case", BAD)
def test_each_mistake_is_one_sentence(case: str) -> None:
    text, said = BAD[case]
    found = problems(with_joint(text))
    assert len(found) == 1
    assert found[0].startswith("f.urdf:4: joint")
    assert said in found[0]


def test_mistakes_of_links() -> None:
    text = with_joint(hinge())
    assert "link.a.inertial.mass.value: is -1 kg" in problems(text.replace('"1.0"', '"-1"', 1))[0]
    assert "'value' is missing" in problems(text.replace('value="1.0"', "", 1))[0]
    assert "'ixy' is missing" in problems(text.replace('ixy="0.001"', "", 1))[0]
    turned = text.replace('rpy="0.0 0.0 0.0"', 'rpy="0 0 nan"', 1)
    assert "link.a.inertial.origin.rpy: must be a finite" in problems(turned)[0]
    assert "<mass> is missing" in problems(text.replace('<mass value="1.0"/>', "", 1))[0]
    twice = problems(robot(link("a"), link("a")))
    assert twice == ["f.urdf:3: link.a: there is already a link of this name; rename one of them"]


def test_all_mistakes_come_at_once_with_their_lines() -> None:
    text = with_joint(hinge('<origin xyz="a b c"/>', "hinge")).replace('mass value="1.0"', "mass")
    found = problems(text)
    assert len(found) == 6  # two masses, a kind, three numbers
    assert [one.split(":")[1] for one in found] == ["2", "3", "4", "4", "4", "4"]


def test_mimics_in_a_circle() -> None:
    def follow(name: str) -> str:
        return f'<mimic joint="{name}"/>'

    text = robot(
        *(link(name) for name in "abc"),
        joint("j", "revolute", "a", "b", more=follow("k")),
        joint("k", "revolute", "b", "c", more=follow("j")),
    )
    assert sum("follows itself" in one for one in problems(text)) == 2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<sdf/>", "is SDF, the format of Gazebo; a URDF begins with <robot>"),
        ("<html/>", "begins with <html>; a URDF begins with <robot>"),
        ('<robot name="r"><xacro:include filename="x"/></robot>', "xacro robot.urdf.xacro >"),
        ('<robot name="r"/>', "f.urdf: has no link"),
    ],
)
def test_other_files_are_named(text: str, said: str) -> None:
    (found,) = problems(text)
    assert said in found


def test_a_hundred_thousand_links_are_one_sentence_at_once() -> None:
    begin = time.process_time()
    (found,) = problems("<robot>" + '<link name="x"/>' * 100_000 + "</robot>")
    assert found == f"f.urdf: has 100000 links; at most {DECLARED} are read"
    assert time.process_time() - begin < 10


def test_many_mistakes_take_no_long_time() -> None:
    count = DECLARED - 1
    parts = [f'<link name="x{k}"/>' for k in range(count)]
    parts += [joint(f"j{k}", "fixed", f"y{k}", f"x{k}") for k in range(count)]
    begin = time.process_time()
    assert len(problems(robot(*parts))) == count
    assert time.process_time() - begin < 10

"""MuJoCo asked along a motion: what closed forms and its own forward dynamics say, and one sentence
for every file that cannot be asked."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from symhyb.data.hosts.answers import Answer, Question
from symhyb.data.hosts.mujoco_answers import ask
from symhyb.errors import InputError
from symhyb.model.types import Model
from tests.mujoco_rigs import FINGER, PRESS, finger, press, written

# A rod that swings about its end, with all that a joint can have; x along it, y is its axis.
ROD = """<mujoco><compiler angle="radian"/><option gravity="0 0 -9.81"/>
<worldbody><site name="above" pos="0 0 2"/>
 <body name="rod"><inertial pos="0.4 0 0" mass="1.5" diaginertia="0.01 0.08 0.08"/>
  <joint name="hinge" axis="0 -1 0" damping="0.3" armature="0.02" stiffness="2" springref="0.1"/>
  <site name="tip" pos="0.9 0 0"/></body></worldbody>
<tendon><fixed name="belt"><joint joint="hinge" coef="0.05"/></fixed></tendon>
<actuator><position name="servo" joint="hinge" kp="7"/><motor name="motor" joint="hinge" gear="3"/>
</actuator></mujoco>"""
TEXT = """symhyb = 1
[mujoco]
file = "machine.xml"
[mujoco.coordinates]
phi = "hinge"
[mujoco.inputs]
wanted = "servo"
torque = { joint = "hinge" }
lift = { site = "tip", along = [0, 0, 2] }
belt = { tendon = "belt" }
[mujoco.parameters]
NUMBER
[coordinates]
phi = { unit = "rad" }
[parameters]
p = { value = 1.0, unit = "UNIT" }
[inputs]
wanted = { unit = "rad" }
torque = { unit = "N*m" }
lift = { unit = "N" }
belt = { unit = "N" }
[sensors]
angle = { measures = "phi", unit = "rad" }
"""
INERTIA = 0.08 + 1.5 * 0.4**2 + 0.02


def rod(folder: Path, number: str = "", unit: str = "1") -> Model:
    return written(folder, ROD, TEXT.replace("NUMBER", number).replace("UNIT", unit))


def motion(n: int, k: int, samples: int = 4, values: tuple[float, ...] = ()) -> Question:
    random = np.random.default_rng(3)
    t = np.linspace(0, 1, samples)
    q, v, a = random.uniform(-1, 1, (3, samples, n))
    u, sets = random.uniform(-1, 1, (samples, k)), np.array(values).reshape(-1, 1)
    sets = sets if values else np.zeros((1, 0))
    return Question(t, q, v, a, u, np.full(2 * n + k, 1e-5), np.full(n, 1e-3), sets)


def answer(model: Model, question: Question) -> Answer:
    assert model.mujoco is not None
    return ask(model.mujoco, model.mujoco.path(model.file), question)


def refused(model: Model) -> str:
    with pytest.raises(InputError) as caught:
        answer(model, motion(len(model.coordinates), len(model.inputs)))
    return str(caught.value)


def test_a_rod_has_the_equation_of_a_rod(tmp_path: Path) -> None:
    """(J + m s² + armature) φ'' = −m g s cos φ − k (φ − φ0) − d φ' + kp (w − φ) + τ + l cos φ F."""
    asked = motion(1, 4)
    found = answer(rod(tmp_path), asked)
    q, v, a = asked.q[:, 0], asked.v[:, 0], asked.a[:, 0]
    wanted, torque, lift, belt = asked.u.T
    np.testing.assert_allclose(found.mass[0, :, 0, 0], INERTIA, rtol=1e-9)
    weight, arm = 1.5 * 9.81 * 0.4, 0.9
    force = -weight * np.cos(q) - 2 * (q - 0.1) - 0.3 * v + 7 * (wanted - q)
    force += torque + arm * np.cos(q) * lift + 0.05 * belt
    np.testing.assert_allclose(found.force[0, :, 0], force, rtol=1e-7, atol=1e-9)
    slopes = found.slopes[0, :, 0]
    stiffness = weight * np.sin(q) - 2 - 7 - arm * np.sin(q) * lift
    np.testing.assert_allclose(slopes[:, 0], stiffness, atol=1e-6)
    np.testing.assert_allclose(slopes[:, 1], -0.3, atol=1e-7)
    by_inputs = np.stack([7 + 0 * q, 1 + 0 * q, arm * np.cos(q), 0.05 + 0 * q], axis=1)
    np.testing.assert_allclose(slopes[:, 2:], by_inputs, atol=1e-7)
    assert np.abs(a).min() > 0.01  # it was asked with accelerations


@pytest.mark.parametrize(
    ("number", "unit", "values", "mass", "force"),
    [
        ('{ joint = "hinge", field = "damping" }', "N*m*s/rad", (1.3, 0.3), 0, "v"),
        ('{ joint = "hinge", field = "stiffness" }', "N*m/rad", (3.0, 2.0), 0, "q"),
        ('{ joint = "hinge", field = "springref" }', "rad", (0.6, 0.1), 0, "2"),
        ('{ joint = "hinge", field = "armature" }', "kg*m^2/rad^2", (1.02, 0.02), 1, "0"),
        ('{ body = "rod", field = "mass" }', "kg", (2.5, 1.5), 0.16, "weight"),
        ('{ tendon = "belt", field = "damping" }', "N*s/m", (4.0, 0.0), 0, "belt"),
    ],
)
def test_a_parameter_sets_what_it_names(
    number: str, unit: str, values: tuple[float, ...], mass: float, force: str, tmp_path: Path
) -> None:
    """The difference that a change makes; signs and units are those of the closed form."""
    asked = motion(1, 4, values=values)
    found = answer(rod(tmp_path, f"p = {number}", unit), asked)
    q, v, change = asked.q[:, 0], asked.v[:, 0], values[0] - values[1]
    by = {
        "v": -v,
        "q": 0.1 - q,
        "2": 2 + 0 * q,
        "0": 0 * q,
        "weight": -9.81 * 0.4 * np.cos(q),
        "belt": -(0.05**2) * v,
    }[force]
    heavier = found.mass[0] - found.mass[1]
    np.testing.assert_allclose(heavier[:, 0, 0], change * mass, atol=1e-9)
    pushed = found.force[0, :, 0] - found.force[1, :, 0]
    np.testing.assert_allclose(pushed, change * by, atol=1e-8)


@pytest.mark.parametrize(("make", "xml"), [(finger, FINGER), (press, PRESS)])
def test_what_mujoco_makes_lacks_nothing(make, xml: str, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    """Under the accelerations of its forward dynamics, with a tendon and with a contact; and beside
    them the slopes are those of the forward dynamics."""
    engine = mujoco.MjModel.from_xml_string(xml)
    data, random = mujoco.MjData(engine), np.random.default_rng(1)

    def pulled(state: np.ndarray) -> float:
        data.qpos[0], data.qvel[0], data.ctrl[0] = state
        mujoco.mj_forward(engine, data)
        return float(data.qacc[0])

    low, high = (0.3, 0.9) if make is finger else (-8e-4, -1e-4)
    states = np.stack([random.uniform(low, high, 6), *random.uniform(-0.01, 0.01, (2, 6))], axis=1)
    a = np.array([pulled(one) for one in states])
    q, v, u = (states[:, [i]] for i in range(3))
    sizes = np.array([1e-6, 1e-6, 1e-4])
    asked = Question(np.arange(6.0), q, v, a[:, None], u, sizes, np.full(1, 1e-4), np.zeros((1, 0)))
    found = answer(make(tmp_path), asked)
    mass = found.mass[0, :, 0, 0]
    np.testing.assert_allclose(found.force[0, :, 0], mass * a, rtol=1e-6, atol=1e-6)
    for j, size in enumerate(sizes):
        side = size * np.eye(3)[j]
        by = [(pulled(one + side) - pulled(one - side)) / (2 * size) for one in states]
        slope = found.slopes[0, :, 0, j] / mass
        np.testing.assert_allclose(slope, by, rtol=1e-4, atol=1e-4 * max(1, np.abs(by).max()))
    if make is press:
        assert np.all(mass > 5)  # the contact has inertia, as MuJoCo's contacts have


def test_the_mass_matrix_of_an_arm_is_mujocos(tmp_path: Path) -> None:
    folder = Path(__file__).parents[2] / "studies" / "mujoco_arm"
    xml = (folder / "arm.xml").read_text()
    engine = mujoco.MjModel.from_xml_string(xml)
    names = [engine.joint(i).name for i in range(engine.njnt)][::-1]  # in another order
    coordinates = "\n".join(f'{name} = {{ unit = "rad" }}' for name in names)
    head = f'symhyb = 1\n[mujoco]\nfile = "machine.xml"\n[coordinates]\n{coordinates}\n'
    model = written(tmp_path, xml, head)
    asked = motion(len(names), 0)
    found = answer(model, asked)
    data = mujoco.MjData(engine)
    for i in range(asked.t.size):
        data.qpos[:] = asked.q[i, ::-1]
        mujoco.mj_forward(engine, data)
        full = np.zeros((engine.nv, engine.nv))
        mujoco.mj_fullM(engine, data, full)
        np.testing.assert_allclose(found.mass[0, i], full[::-1, ::-1], rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"hinge"', '"hing"', "has no joint 'hinge'; did you mean 'hing'?"),
        ('name="servo"', 'name="serve"', "has no actuator 'servo'; did you mean 'serve'?"),
        ('name="tip"', 'name="top"', "has no site 'tip'; did you mean 'top'?"),
        ('name="belt"', 'name="rope"', "has no tendon 'belt'"),
        (
            "</body></worldbody>",
            '<body name="b"><joint name="k"/><geom size="0.1"/></body></body></worldbody>',
            "joint 'k' moves and is no coordinate; declare one for it, with a sensor",
        ),
        (
            "</worldbody>",
            '<body name="b"><freejoint name="k"/><geom size="0.1"/></body></worldbody>',
            "joint 'k' is neither hinge nor slide; only these are coordinates",
        ),
        (
            "</actuator>",
            '<general joint="hinge" dyntype="filter" dynprm="0.1"/></actuator>',
            "has actuators with states of their own, which cannot be asked at one state",
        ),
        ('gear="3"', 'gear="3" delay="0.01" nsample="9"', "has delays of actuators"),
        ('gravity="0 0 -9.81"', 'noslip_iterations="3"', "has noslip_iterations"),
    ],
)
def test_what_cannot_be_asked_is_one_sentence(
    old: str, new: str, said: str, tmp_path: Path
) -> None:
    model = rod(tmp_path)
    assert old in ROD
    (tmp_path / "machine.xml").write_text(ROD.replace(old, new))
    assert said in refused(model)


@pytest.mark.parametrize(
    ("xml", "said"),
    [
        ("", "is not well-formed XML"),
        (ROD[:100], "is not well-formed XML"),
        ("<!DOCTYPE m [<!ENTITY a 'b'>]><mujoco/>", "declares a document type or entities"),
        ("<robot/>", "is no MJCF: its outermost element is <robot>"),
        (ROD.replace("<body", '<include file="/etc/passwd"/><body', 1), "<include> is not read"),
        (
            ROD.replace("<compiler", '<extension><plugin plugin="p"/></extension><compiler'),
            "<plugin> is not read; remove it",
        ),
        (ROD.replace('mass="1.5"', 'mass="heavy"'), "MuJoCo says:"),
        (ROD.replace('diaginertia="0.01 0.08', 'diaginertia="9 0.08'), "MuJoCo says:"),
    ],
    ids=["empty", "cut", "entities", "other", "include", "plugin", "word", "inertia"],
)
def test_a_file_that_is_broken_or_hostile_is_one_sentence(
    xml: str, said: str, tmp_path: Path
) -> None:
    model = rod(tmp_path)
    (tmp_path / "machine.xml").write_text(xml)
    assert said in refused(model)


SKIN = '<asset><mesh name="skin" file="../../secret.stl"/></asset><worldbody>'
WORN = '<site name="tip" pos="0.9 0 0"/><geom type="mesh" mesh="skin"'


def skinned(more: str) -> str:
    dressed = ROD.replace("<worldbody>", SKIN)
    return dressed.replace('<site name="tip" pos="0.9 0 0"/>', f"{WORN} {more}/>")


def test_no_file_that_it_names_is_opened(tmp_path: Path) -> None:
    """A mesh that is only seen is taken out; one that touches or weighs is refused."""
    model, asked = rod(tmp_path), motion(1, 4)
    plain = answer(model, asked)
    (tmp_path / "machine.xml").write_text(skinned('contype="0" conaffinity="0"'))
    np.testing.assert_array_equal(answer(model, asked).force, plain.force)
    (tmp_path / "machine.xml").write_text(skinned('name="hull"'))
    assert "geom.hull: is a mesh or a field of heights that can touch others" in refused(model)
    light = skinned('contype="0" conaffinity="0"')
    start, end = light.index("<inertial"), light.index("/>", light.index("<inertial")) + 2
    (tmp_path / "machine.xml").write_text(light[:start] + light[end:])
    assert "body.rod: its mass is that of a mesh" in refused(model)


def test_a_file_that_is_not_there_is_said(tmp_path: Path) -> None:
    model = rod(tmp_path)
    (tmp_path / "machine.xml").unlink()
    assert "machine.xml: there is no such file" in refused(model)


def test_mujoco_leaves_no_file_where_it_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It writes its warnings into a log beside the program, if nobody takes them."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    model = rod(tmp_path)
    asked = motion(1, 4)
    asked.q[0, 0] = np.nan
    with pytest.raises(InputError, match="MuJoCo gives a force that is not finite at 0 s"):
        answer(model, asked)
    assert not list((tmp_path / "here").iterdir())

"""A model file is written whole, narrated, and checked; what was changed is said in it."""

from pathlib import Path

import pytest
from robots import ARM, joint, link, robot

from symhyb.errors import InputError
from symhyb.imports.deliver import Order, deliver, model_of, read_robot
from symhyb.imports.urdf import parse_urdf
from symhyb.limits import ROBOT_BYTES
from symhyb.model.read import read_model


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    return path


def text_of(text: str, order: Order | None = None) -> str:
    return model_of(parse_urdf(text.encode()), order or Order())[0].text


def test_the_file_reads_back(arm: Path, tmp_path: Path) -> None:
    target = tmp_path / "new" / "arm.toml"
    done = deliver(arm, Order(), target)
    assert read_model(target) == done.model
    assert done.sentence.startswith(f"{target}: 5 coordinates, 5 bodies; next: symhyb check")
    assert done.notes == ()


def test_a_file_that_is_there_is_kept_unless_forced(arm: Path, tmp_path: Path) -> None:
    target = tmp_path / "arm.toml"
    target.write_text("mine")
    with pytest.raises(InputError, match="is there already; --force replaces it"):
        deliver(arm, Order(), target)
    assert target.read_text() == "mine"
    deliver(arm, Order(force=True), target)
    assert "[bodies.upper]" in target.read_text()


def test_the_robot_itself_is_never_replaced(arm: Path) -> None:
    with pytest.raises(InputError, match="is the robot that is read; name another file"):
        deliver(arm, Order(force=True), arm)
    assert arm.read_text() == ARM


def test_nothing_is_written_of_a_robot_with_a_mistake(arm: Path, tmp_path: Path) -> None:
    arm.write_text(ARM.replace('type="prismatic"', 'type="slider"'))
    before = set(tmp_path.iterdir())
    with pytest.raises(InputError, match="'slider' is not a kind of joint"):
        deliver(arm, Order(), tmp_path / "arm.toml")
    assert set(tmp_path.iterdir()) == before


def test_the_head_draws_the_tree_and_says_what_is_locked() -> None:
    text = text_of(ARM, Order(joints=("shoulder", "elbow", "grip"), at=("reach=0.25",)))
    head = text[: text.index("symhyb  = 1")]
    assert "# arm, from a URDF with 7 links: 3 coordinates\n" in head
    assert "# ground: base\n# `- shoulder, revolute about y: upper\n" in head
    assert "\n#    `- elbow, continuous about (0.4364, 0.8729, -0.2182): fore\n" in head
    assert "\n#       `- grip, revolute about (0.6, 0, 0.8): finger\n" in head
    assert "# Locked: reach at 0.25, twist at 0." in head
    assert "the rotors of the motors" in head
    assert "# rigid with it: plate\n[bodies.upper]\n" in text
    assert "# upper, behind the joint shoulder (revolute)\nshoulder_ox " in text


def test_names_that_a_model_cannot_have_are_changed_and_said() -> None:
    text = robot(link("a"), link("1st arm"), joint("sin", "revolute", "a", "1st arm"))
    model, notes = model_of(parse_urdf(text.encode()), Order())
    assert [one.name for one in model.coordinates] == ["joint_sin"]
    assert [one.name for one in model.bodies] == ["link_1st_arm"]
    assert notes == (
        "the joint 'sin' is called joint_sin here",
        "the link '1st arm' is called link_1st_arm here",
    )
    assert "# - the joint 'sin' is called joint_sin here\n" in model.text


def test_names_cannot_write_into_the_file() -> None:
    """Line ends, quotes and letters that turn the direction of writing stay words of a comment."""
    name = "a&#10;[parameters]&#10;x = 1 &quot;&quot;&quot; \u202e#"
    text = robot(link("a"), link(name), joint(f"j{name}", "revolute", "a", name))
    model, _ = model_of(parse_urdf(text.encode()), Order())
    assert [one.name for one in model.coordinates] == ["ja_parameters_x_1_u202e"]
    assert "\u202e" not in model.text
    assert model.text.count("\n[parameters]\n") == 1


def test_gears_are_told_beside_the_inputs() -> None:
    gear = (
        '<transmission name="t"><joint name="grip"/><actuator name="m">'
        "<mechanicalReduction>120</mechanicalReduction></actuator></transmission></robot>"
    )
    assert "# Ratios of gears in the URDF: grip 120.\n" in text_of(ARM.replace("</robot>", gear))
    assert "Ratios" not in text_of(ARM)


@pytest.mark.parametrize(
    ("order", "said"),
    [
        (Order(at=("reach",)), "--at reach: write it as joint=number"),
        (Order(at=("reach=up",)), "--at reach=up: write it as joint=number"),
        (Order(at=("reach=nan",)), "--at reach=nan: write it as joint=number"),
        (Order(at=("reach=1", "reach=2")), "--at reach=2: 'reach' stands twice"),
        (
            Order(at=("reech=1",)),
            "--at: 'reech' is not a joint that can move; did you mean 'reach'",
        ),
        (Order(joints=("arm",)), "--joints: 'arm' is not a joint that can move"),
        (Order(passive=("weld",)), "--passive: 'weld' is not a joint that moves"),
    ],
)
def test_orders_that_the_robot_does_not_know(order: Order, said: str) -> None:
    with pytest.raises(InputError) as error:
        text_of(ARM, order)
    assert len(error.value.problems) == 1
    assert said in str(error.value)


def test_a_chain_without_mass_is_as_deep_as_a_model_may_be() -> None:
    def chain(deep: int) -> str:
        parts = [f'<link name="l{k}"/>' for k in range(deep)] + [link(f"l{deep}")]
        parts += [joint(f"j{k}", "revolute", f"l{k}", f"l{k + 1}") for k in range(deep)]
        return robot(*parts)

    assert "[bodies.l100]" in text_of(chain(100))
    with pytest.raises(InputError) as error:
        text_of(chain(480))
    assert len(error.value.problems) == 1
    assert "hangs below 100 others; at most 99 are computed" in str(error.value)


def test_a_chain_beyond_the_limits_is_one_sentence_each() -> None:
    count = 600
    parts = [link(f"l{k}") for k in range(count)]
    parts += [joint(f"j{k}", "revolute", f"l{k}", f"l{k + 1}") for k in range(count - 1)]
    with pytest.raises(InputError) as error:
        text_of(robot(*parts))
    coordinates, parameters = (str(problem) for problem in error.value.problems)
    assert coordinates.startswith("needs 599 coordinates; a machine has at most 500; name those")
    assert parameters.startswith("needs 5991 parameters; a machine has at most 2000; name those")


def test_a_file_that_is_not_there_or_too_large(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        read_robot(tmp_path / "no.urdf")
    large = tmp_path / "large.urdf"
    with large.open("wb") as stream:
        stream.truncate(ROBOT_BYTES + 1)
    with pytest.raises(InputError, match="is larger than"):
        read_robot(large)

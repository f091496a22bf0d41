"""A drawing that moves: walls stand, bodies go where they were, what is too small is enlarged."""

from pathlib import Path

import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.model.read import parse_model, read_model
from symhyb.model.types import Model
from symhyb.report.sketch import sketch_of
from symhyb.report.sketch_moving import Moving, Part, moving

ROOT = Path(__file__).parents[2]
MODELS = sorted(ROOT.glob("models/*.toml"))


def model_of(name: str) -> Model:
    return read_model(ROOT / "models" / f"{name}.toml")


def parts(made: Moving, role: str, name: str, shape: str) -> list[Part]:
    return [
        one
        for one in made.parts
        if (one.mark.role, one.mark.name, one.mark.shape) == (role, name, shape)
    ]


def swing(model: Model, size: float, rows: int = 9) -> np.ndarray:
    start = np.array(model.start()[0])
    return np.asarray(start + size * np.sin(np.linspace(0, 2 * np.pi, rows))[:, None])


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_every_machine_moves_as_it_is_drawn(path: Path) -> None:
    model = read_model(path)
    q = swing(model, 0.2)
    made = moving(model, q, q)
    marks = sketch_of(model).marks
    assert [one.mark.name for one in made.parts] == [mark.name for mark in marks]
    assert [one.mark.shape for one in made.parts] == [mark.shape for mark in marks]
    assert all(len(one.at) == 9 and np.isfinite(one.at).all() for one in made.parts)
    assert all(np.isfinite(one.at).all() for one in made.ghost)


def test_a_body_goes_where_it_was_measured_and_its_wall_stays() -> None:
    model = model_of("oscillator")
    q = np.array([[0.0], [0.4], [-0.4]])
    made = moving(model, q, None)
    (body,) = parts(made, "body", "mass", "body")
    middle = body.at.mean(axis=1)
    assert middle - middle[0] == pytest.approx(np.array([[0, 0], [0.4, 0], [-0.4, 0]]))
    _, spring = parts(made, "element", "spring", "line")  # after the plate that it holds
    assert np.ptp(spring.at[:, 0], axis=0) == pytest.approx([0, 0])
    assert spring.at[:, -1] - spring.at[0, -1] == pytest.approx(middle - middle[0])
    assert (
        spring.at[:, 0, 0] < spring.at[:, -1, 0] - 3 * made.size
    ).all()  # never turned inside out
    assert all(np.ptp(one.at, axis=0).max() == 0 for one in parts(made, "ground", "spring", "line"))
    assert (made.size, made.times) == (pytest.approx(0.2), 1.0)
    assert made.ghost == ()


def test_a_body_turns_with_its_angle() -> None:
    model = model_of("pendulum")
    start = float(model.start()[0][0])
    made = moving(model, np.array([[start], [start + 0.5]]), None)
    (body,) = [one for one in made.parts if one.mark.shape == "body"]
    first, second = body.at[:, 1] - body.at[:, 0]
    angles = np.arctan2([first[1], second[1]], [first[0], second[0]])
    assert angles[1] - angles[0] == pytest.approx(0.5)


def test_small_motion_is_enlarged_and_that_is_said() -> None:
    model = model_of("quarter_car")
    q = swing(model, 0.01)
    made, large = moving(model, q, q), moving(model, swing(model, 0.2), None)
    assert large.times == 1.0
    assert made.times == 5.0
    (body,) = parts(made, "body", "body", "body")
    assert np.ptp(body.at[:, 0, 1]) == pytest.approx(0.1, rel=1e-6)
    (ghost,) = [one for one in made.ghost if one.mark.name == "body" and one.mark.role == "body"]
    assert ghost.at == pytest.approx(body.at)


def test_loops_are_never_enlarged() -> None:
    model = model_of("four_bar")
    assert moving(model, swing(model, 1e-5), None).times == 1.0


def test_a_ghost_that_stopped_has_no_place() -> None:
    model = model_of("cartpole")
    q = swing(model, 0.2)
    ghost = q.copy()
    ghost[5:], ghost[4] = np.nan, 1e12
    made = moving(model, q, ghost)
    assert {one.mark.role for one in made.ghost} == {"body", "link"}
    for one in made.ghost:
        assert np.isfinite(one.at[:4]).all()
        assert np.isnan(one.at[4:]).all()


def test_what_is_drawn_in_another_way_on_the_way_stays_as_it_was() -> None:
    """A link of no length is not drawn: the arm is folded onto its pivot for one instant."""
    model = parse_model(
        """
symhyb = 1
title = "a telescope"
[coordinates]
r = { unit = "m", start = 1.0 }
[parameters]
m = { value = 1.0, unit = "kg" }
[bodies.tube]
mass = "m"
at = ["r", "0"]
joint = ["0", "0"]
angle = "0"
[sensors]
s = { measures = "r", unit = "m" }
""",
        "telescope.toml",
    )
    made = moving(model, np.array([[1.0], [0.0], [0.5]]), None)
    (link,) = parts(made, "link", "tube", "line")
    assert link.at[:, 1, 0] == pytest.approx([1.0, 1.0, 0.5])


def test_a_machine_that_leaves_every_place_is_refused() -> None:
    model = model_of("cartpole")
    with pytest.raises(InputError, match="has no place"):
        moving(model, np.array([[0.0, 0.0], [1e12, 0.0]]), None)

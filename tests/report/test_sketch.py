"""The drawing of a machine: what is where, which way is positive, for every shipped model."""

from pathlib import Path

import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.mechanics.kinematics import geometry
from symhyb.mechanics.symbols import symbols_of
from symhyb.model.read import parse_model, read_model
from symhyb.model.types import Model
from symhyb.report.machine_figure import machine_figure
from symhyb.report.placing import placed
from symhyb.report.sketch import Sketch, roles, sketch_of
from symhyb.report.sketch_draft import LETTER

ROOT = Path(__file__).parents[2]
MODELS = sorted(ROOT.glob("models/*.toml"))


def marks(sketch: Sketch, role: str, name: str, shape: str) -> list[np.ndarray]:
    return [m.at for m in sketch.marks if (m.role, m.name, m.shape) == (role, name, shape)]


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_every_body_element_and_coordinate_is_drawn_or_named_as_left_out(path: Path) -> None:
    model = read_model(path)
    sketch = sketch_of(model)
    drawn = {name for names in roles(sketch).values() for name in names}
    left = " ".join(sketch.left_out)
    assert {body.name for body in model.bodies} <= drawn
    for thing in (*model.elements, *model.constraints):
        assert thing.name in drawn or f"{thing.name} (" in left, thing.name
    quaternion = {"qw", "qx", "qy", "qz"} if path.stem == "quadrotor" else set()
    for coordinate in model.coordinates:
        missing = f"{coordinate.name} moves nothing" in left
        assert coordinate.name in drawn or missing or coordinate.name in quaternion
    assert all(np.isfinite(mark.at).all() and mark.at.shape[1] == 2 for mark in sketch.marks)


@pytest.mark.parametrize(
    "stem", ["four_bar", "furuta_pendulum", "six_joint_arm", "pendulum_on_cart"]
)
def test_places_are_those_of_the_equations(stem: str) -> None:
    """The numbers of the drawing beside the symbols of the mechanics, away from the start."""
    model = read_model(ROOT / "models" / f"{stem}.toml")
    q = 0.3 + 0.1 * np.arange(len(model.coordinates))
    symbols = symbols_of(model)
    values = dict(zip(symbols.q, q, strict=True))
    values |= {symbols.scope[p.name, 0]: p.si for p in model.parameters}
    exact, here = geometry(model, symbols), placed(model, q)
    for name, place in exact.centres.items():
        wanted = [float(part.subs(values)) for part in place]
        assert here.centres[name] == pytest.approx(wanted, abs=1e-12)
    for name, place in exact.points.items():
        wanted = [float(part.subs(values)) for part in place]
        assert here.points[name] == pytest.approx(wanted, abs=1e-12)


def oscillator(at: str = '["x", "0"]') -> Model:
    text = (ROOT / "symhyb" / "drafting" / "templates" / "oscillator.toml").read_text()
    return parse_model(text.replace('["x", "0"]', at))


@pytest.mark.parametrize(
    ("at", "way"), [('["x", "0"]', [1, 0]), ('["0", "-x"]', [0, -1]), ('["-x", "0"]', [-1, 0])]
)
def test_the_arrow_of_a_coordinate_points_where_it_is_positive(at: str, way: list[int]) -> None:
    sketch = sketch_of(oscillator(at))
    (arrow,) = marks(sketch, "coordinate", "x", "arrow")
    along = (arrow[-1] - arrow[0]) / np.linalg.norm(arrow[-1] - arrow[0])
    assert along == pytest.approx(way, abs=1e-6)
    spring = np.vstack(marks(sketch, "element", "spring", "line"))
    assert np.max(spring @ way) <= 1e-9  # between the body and a wall behind it
    wall = np.vstack(marks(sketch, "ground", "spring", "line"))
    assert np.max(wall @ way) < np.min(spring @ way) + 1e-6


SIDE_BY_SIDE = """
symhyb = 1
[coordinates]
upper = { unit = "m" }
lower = { unit = "m" }
[parameters]
m = { value = 1.0, unit = "kg" }
d = { value = 1.0, unit = "N*s/m" }
[bodies.a]
mass = "m"
at = ["0", "upper + 1 m"]
[bodies.b]
mass = "m"
at = ["0", "lower"]
[sensors]
gap = { measures = "upper - lower", unit = "m" }
"""


@pytest.mark.parametrize("on", ["upper - lower", "upper"])
def test_names_of_elements_side_by_side_do_not_meet_symbols(on: str) -> None:
    names = ["a", "rather_a_long_name", "short", "another_long_name", "last"]
    element = '[elements.{}]\nkind = "damper"\non = "{}"\ndamping = "d"\n'
    model = parse_model(SIDE_BY_SIDE + "".join(element.format(name, on) for name in names))
    sketch = sketch_of(model)
    for name in names:
        (text,) = (m for m in sketch.marks if m.shape == "text" and m.name == name)
        ends = text.at[0, 0] + np.array([0.0, text.away[0] * LETTER * len(name) * sketch.size])
        left, right = sorted(ends)
        for other in names:
            for line in marks(sketch, "element", other, "line"):
                if np.ptp(line[:, 0]) < 1e-9:  # upright
                    assert not left < line[0, 0] < right, (name, other)


@pytest.mark.parametrize(("angle", "sign"), [("phi", 1.0), ("-phi", -1.0)])
def test_the_arc_of_an_angle_turns_as_it_is_positive(angle: str, sign: float) -> None:
    text = (ROOT / "symhyb" / "drafting" / "templates" / "pendulum.toml").read_text()
    sketch = sketch_of(parse_model(text.replace('angle   = "phi"', f'angle = "{angle}"')))
    (arc,) = marks(sketch, "coordinate", "phi", "arrow")
    first, last = arc[0], arc[-1]  # about the origin
    assert np.sign(first[0] * last[1] - first[1] * last[0]) == sign


def test_points_that_a_turning_body_carries_are_linked_to_it() -> None:
    model = read_model(ROOT / "models" / "cartpole.toml")
    sketch = sketch_of(model)
    here = placed(model, np.array(model.start()[0]))
    ends = [line[-1] for line in marks(sketch, "link", "pole", "line")]
    assert any(np.allclose(end, here.points["tip"]) for end in ends)
    assert any(np.allclose(end, here.points["pivot"]) for end in ends)
    assert not any(np.allclose(end, here.points["post"]) for end in ends)
    assert marks(sketch, "ground", "post", "line")
    assert not marks(sketch, "ground", "tip", "line")


def test_masses_on_one_place_are_drawn_apart() -> None:
    model = read_model(ROOT / "symhyb" / "drafting" / "templates" / "backlash.toml")
    sketch = sketch_of(model)
    (first,), (second,) = (
        marks(sketch, "body", "first", "body"),
        marks(sketch, "body", "second", "body"),
    )
    assert second[0, 0] - first[0, 0] > 3 * sketch.size


def test_what_is_emphasised_is_marked_in_colour() -> None:
    sketch = sketch_of(oscillator(), shown=["damper"])
    assert {mark.name for mark in sketch.marks if mark.shown} == {"damper"}
    assert machine_figure(sketch) != machine_figure(sketch_of(oscillator()))


def test_a_machine_at_another_place() -> None:
    model = oscillator()
    (body,) = marks(sketch_of(model, np.array([0.7])), "body", "mass", "body")
    assert body[0] == pytest.approx([0.7, 0.0])


@pytest.mark.parametrize("at", ['["sqrt(-x*x)", "0"]', '["exp(1e4*x/x)*x", "0"]'])
def test_a_body_without_a_place_is_refused(at: str) -> None:
    with pytest.raises(InputError, match=r"bodies\.mass: has no place that can be drawn"):
        sketch_of(oscillator(at), np.array([0.5]))

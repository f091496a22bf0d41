"""Places that nobody named: sums and differences of coordinates that a model couples."""

from pathlib import Path

import numpy as np
import pytest
from builders import Entries, cart_pole, double_pendulum, model_of, oscillator, spring

from symhyb.discrepancy.places.placements import places_of
from symhyb.discrepancy.places.points import moving_points
from symhyb.discrepancy.places.probing import proportional, pushed
from symhyb.discrepancy.places.stretches import coupled_stretches, written_stretches
from symhyb.model.read import read_model
from symhyb.model.types import At, Model, On, place_text

MODELS = Path(__file__).parents[2] / "models"


def masses(count: int = 2, unit: str = "m", **sections: Entries) -> Model:
    """Masses on one line, each by its own coordinate x, y, z."""
    names = "xyz"[:count]
    return model_of(
        coordinates={name: {"unit": unit} for name in names},
        parameters={
            "m": (2.0, "kg"),
            "k": (300.0, "N/m"),
            "k3": (9e3, "N/m^3"),
            "d": (4.0, "N*s/m"),
            "n": (2.5, "1"),
            "far": (1.0, "m"),
        },
        points={f"p_{name}": [name, "0"] for name in names},
        bodies={name: {"mass": "m", "at": f"p_{name}"} for name in names},
        **sections,
    )


def law(on: str, force: str) -> Entries:
    return {"kind": "law", "on": on, "force": force}


def unnamed(model: Model) -> list[str]:
    found = [place for place in places_of(model) if isinstance(place, On) and not place.plain]
    return [place.coordinate for place in found]


@pytest.mark.parametrize(
    ("sections", "expected"),
    [
        ({}, []),
        ({"elements": {"x": spring("k"), "y": spring("k", on="y")}}, []),
        # written in the energy, in laws, with numbers and parameters, of places and of rates
        ({"energy": {"potential": "k/2*(x - y)**2"}}, ["x - y"]),
        ({"energy": {"potential": "k/2*(y - x - far)**2 + k*x**2"}}, ["y - x"]),
        ({"energy": {"potential": "k/2*(x - n*y)**2"}}, ["x - n*y"]),
        ({"energy": {"potential": "k/2*(n*y - x)**2"}}, ["x - n*y"]),
        ({"energy": {"potential": "k/2*(2*x - 3*y)**2"}}, ["x - 3/2*y"]),
        (
            {"elements": {"one": law("x", "-d*(x' - y')"), "two": law("y", "d*(x' - y')")}},
            ["x - y"],
        ),
        ({"elements": {"one": law("x", "-k*(x + y/n)"), "two": law("y", "-k/n*(x + y/n)")}}, None),
        # expanded, so that only the Jacobians tell
        ({"energy": {"potential": "k/2*x**2 - k*x*y + k/2*y**2"}}, ["x - y"]),
        ({"energy": {"potential": "k/2*x**2 + k*x*y + k/2*y**2"}}, ["x + y"]),
        ({"energy": {"potential": "k/2*x**2 - k*n*x*y + k/2*n**2*y**2"}}, ["x - n*y"]),
        ({"energy": {"potential": "2*k*x**2 - k*x*y + k*y**2"}}, ["x - y"]),
        ({"elements": {"one": law("x", "d*y' - d*x'"), "two": law("y", "d*x' - d*y'")}}, ["x - y"]),
        (
            {"energy": {"potential": "k3*(x**4 - 8*x**3*y + 24*x*x*y*y - 32*x*y**3 + 16*y**4)"}},
            ["x - 2*y"],
        ),
        # of one side alone: a controller, not a connection; only as it is written
        ({"elements": {"one": law("x", "k*y")}}, []),
    ],
)
def test_two_masses_that_are_coupled(sections: dict[str, Entries], expected: object) -> None:
    found = unnamed(masses(**sections))
    assert found == (["x + y/n"] if expected is None else expected)


def test_what_elements_join_is_named_once() -> None:
    tie = {"kind": "spring", "between": ["p_x", "p_y"], "stiffness": "k", "length": "far"}
    model = masses(elements={"tie": tie}, energy={"potential": "k/2*(x - y)**2"})
    assert [place_text(place) for place in places_of(model)] == [
        "on x",
        "on y",
        "between p_x and p_y",
    ]
    model = masses(elements={"tie": spring("k", on="y - x")}, energy={"potential": "k*(x - y)**2"})
    assert places_of(model) == (On("x"), On("y"), On("y - x"))


def test_an_expression_that_moves_as_a_coordinate_is_that_coordinate() -> None:
    model = masses(elements={"one": spring("k", on="2*x"), "two": spring("k", on="y - far")})
    assert places_of(model) == (On("x"), On("y"))
    model = masses(elements={"one": spring("k", on="far*sin(x/far)")})
    assert places_of(model) == (On("x"), On("y"), On("far*sin(x/far)"))


def test_a_chain_offers_neighbours_and_not_the_ends() -> None:
    potential = "k/2*(x**2 - 2*x*y + 2*y**2 - 2*y*z + z**2)"
    assert unnamed(masses(3, energy={"potential": potential})) == ["x - y", "y - z"]


def test_units_of_coordinates_do_not_change_the_places() -> None:
    for unit in ("mm", "km"):
        assert unnamed(masses(unit=unit, energy={"potential": "k/2*(x - y)**2"})) == ["x - y"]
        expanded = {"potential": "k/2*x**2 - k*x*y + k/2*y**2"}
        assert unnamed(masses(unit=unit, energy=expanded)) == ["x - y"]


def belt(potential: str) -> Model:
    """A carriage x on a belt from a wheel phi of radius r."""
    return model_of(
        coordinates={"x": {"unit": "mm"}, "phi": {"unit": "deg"}},
        parameters={
            "m": (2.0, "kg"),
            "J": (0.01, "kg*m^2"),
            "k": (900.0, "N/m"),
            "r": (0.04, "m"),
        },
        bodies={
            "carriage": {"mass": "m", "at": ["x", "0"]},
            "wheel": {"mass": "m", "at": ["0", "0"], "inertia": "J", "angle": "phi"},
        },
        energy={"potential": potential},
    )


@pytest.mark.parametrize(
    ("potential", "expected"),
    [
        ("k/2*(x - r*phi)**2", ["x - r*phi"]),
        ("k/2*x**2 - k*r*x*phi + k/2*(r*phi)**2", ["x - r*phi"]),
        ("k*x**2 - k*r*x*phi + k/2*(r*phi)**2", ["x - r*phi"]),
        ("k*x**2 - 0.017*k*r*x*phi + k*(r*phi)**2", []),
    ],
)
def test_a_belt_joins_a_length_and_an_angle_by_its_radius(
    potential: str, expected: list[str]
) -> None:
    assert unnamed(belt(potential)) == expected


def test_absolute_and_relative_angles() -> None:
    """Weight and inertia couple the rods of any pendulum, and nothing is joined at the sum or the
    difference of their angles; the shaft of a motor is."""
    assert unnamed(double_pendulum()) == []
    assert unnamed(read_model(MODELS / "double_pendulum.toml")) == []


@pytest.mark.parametrize("name", ["quarter_car", "half_car", "chain_of_masses", "cartpole"])
def test_models_whose_elements_stand_where_they_couple_get_nothing_more(name: str) -> None:
    assert unnamed(read_model(MODELS / f"{name}.toml")) == []


def test_no_model_gets_many() -> None:
    for path in sorted(MODELS.glob("*.toml")):
        model = read_model(path)
        assert len(unnamed(model)) <= max(len(model.coordinates) - 1, 0), path.name
    assert unnamed(cart_pole()) == []
    assert unnamed(oscillator({"hold": spring("k")}, {"k": (5.0, "N/m")})) == []


def test_a_point_that_moves_as_a_sum_does_is_that_sum() -> None:
    """Mass 2 by its travel from mass 1: its place is x + s, also where a point is named there."""
    model = model_of(
        coordinates={"x": {"unit": "m"}, "s": {"unit": "m"}},
        parameters={"m": (2.0, "kg"), "k": (9.0, "N/m")},
        points={"one": ["x", "0"], "two": ["x + s", "0"], "above": ["x", "s"]},
        bodies={"one": {"mass": "m", "at": "one"}, "two": {"mass": "m", "at": "two"}},
        elements={"tie": spring("k", on="s")},
    )
    assert places_of(model) == (On("x"), On("s"), On("x + s"))
    assert moving_points(model) == (At("above"),)


def test_places_are_compared_by_how_they_move() -> None:
    model = masses()
    places = [On("x - y"), On("2*y - 2*x"), On("x + y"), On("x - n*y"), On("far*x/far - far*y/far")]
    ways = [way for way in pushed(model, places) if way is not None]
    assert [proportional(ways[0], way) for way in ways] == [True, True, False, False, True]


def test_both_ways_of_looking_agree() -> None:
    model = masses(energy={"potential": "k/2*(x - y)**2 + k3*(x - y)**4"})
    assert written_stretches(model) == coupled_stretches(model, ["x", "y"]) == (On("x - y"),)
    assert coupled_stretches(model, ["x"]) == ()
    assert np.isfinite([way for way in pushed(model, [On("x - y")]) if way is not None]).all()

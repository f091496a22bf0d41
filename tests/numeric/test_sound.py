"""Machines that cannot be computed are refused with a place, a reason and a cure."""

from collections.abc import Mapping
from dataclasses import replace

import pytest
from builders import Entries, damper, model_of, oscillator, push, spring

from symhyb.errors import InputError
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build


def refused(model: Model) -> list[str]:
    with pytest.raises(InputError) as caught:
        build(model)
    return [str(problem) for problem in caught.value.problems]


LAWS: Mapping[str, tuple[Entries, float]] = {
    "division": ({"kind": "law", "on": "x", "force": "c*l/x"}, 0.0),
    "root": ({"kind": "law", "on": "x", "force": "c*sqrt(x/l)"}, -0.1),
    "logarithm": ({"kind": "law", "on": "x", "force": "c*log(x/l)"}, 0.0),
}


@pytest.mark.parametrize(("element", "start"), LAWS.values(), ids=LAWS)
def test_a_law_that_is_infinite_at_the_start_is_named(element: Entries, start: float) -> None:
    more = {"c": (2.0, "N"), "l": (1.0, "m")}
    elements = {"odd": element, "fine": push("c")}
    (problem,) = refused(oscillator(elements, more, start=start))
    assert problem.startswith("test.toml: elements.odd: the ")
    assert "is not finite at the start" in problem
    assert "change the start or the law" in problem
    build(oscillator(elements, more, start=start + 0.5))


def test_two_points_that_coincide_have_no_direction() -> None:
    """A band from the origin to a ball that starts there."""
    sections: Mapping[str, Entries] = {
        "parameters": {"m": (1.0, "kg"), "k": (5.0, "N/m"), "l": (1.0, "m")},
        "points": {"post": ["0", "0"], "tip": ["x", "y"]},
        "bodies": {"ball": {"mass": "m", "at": "tip"}},
        "elements": {
            "band": {"kind": "spring", "between": ["post", "tip"], "stiffness": "k", "length": "l"}
        },
    }
    places: Entries = {"x": {"unit": "m"}, "y": {"unit": "m"}}
    (problem,) = refused(model_of(coordinates=places, **sections))
    assert "elements.band: the spring is not finite at the start" in problem
    assert "two points that coincide" in problem
    build(model_of(coordinates={**places, "y": {"unit": "m", "start": 1.0}}, **sections))


def test_every_infinite_law_is_named() -> None:
    odd = {"kind": "law", "on": "x", "force": "c*l/x"}
    model = oscillator(
        {"one": odd, "fine": push("c"), "two": odd}, {"c": (2.0, "N"), "l": (1.0, "m")}
    )
    assert [problem.split(": ")[1] for problem in refused(model)] == [
        "elements.one",
        "elements.two",
    ]


def test_an_input_may_stand_in_a_denominator() -> None:
    """A recorded pressure of 0 before the recording begins is no fault of the law."""
    model = oscillator({"valve": push("c*c/f")}, {"c": (2.0, "N")}, inputs={"f": {"unit": "N"}})
    assert build(model).n == 1


def test_an_inner_state_that_is_infinite_is_reported() -> None:
    slow = {"kind": "relaxation", "on": "x", "stiffness": "k", "damping": "d"}
    model = oscillator({"slow": slow}, {"k": (5.0, "N/m"), "d": (1.0, "N*s/m")})
    assert build(model).inner_states == 1
    *kept, d = model.parameters
    (problem,) = refused(replace(model, parameters=(*kept, replace(d, value=0.0))))
    assert "inner state is not finite at the start; look for a division by zero" in problem


def two(imposed: bool) -> Model:
    """x with mass, y with a spring alone."""
    return model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m", "imposed": imposed}},
        parameters={"m": (1.0, "kg"), "k": (5.0, "N/m")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={"hold": spring("k", on="y")},
    )


def test_a_coordinate_without_mass_may_be_imposed() -> None:
    (problem,) = refused(two(imposed=False))
    assert "nothing that moves with y has mass; give a body there a mass" in problem
    assert build(two(imposed=True)).imposed == (1,)


def test_added_mass_is_mass() -> None:
    model = two(imposed=False)
    lump = {"kind": "added_mass", "on": "x", "mass": "m"}
    more = oscillator({"lump": lump}).elements[0]
    on_y = replace(more, place=replace(more.place, coordinate="y"))
    assert build(replace(model, elements=(*model.elements, on_y))).n == 2


def test_a_negative_mass_is_refused() -> None:
    model = oscillator({"oil": damper("d")}, {"d": (1.0, "N*s/m"), "less": (-2.0, "kg")})
    lump = {"kind": "added_mass", "on": "x", "mass": "less"}
    text = oscillator({"lump": lump}, {"less": (-2.0, "kg")})
    assert build(model).n == 1
    (problem,) = refused(text)
    assert "singular or not positive definite in x" in problem

"""Model files made to hurt: each ends in sentences with the place, and not in a traceback."""

import pytest

from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import build
from tests.builders import DRIVEN_MASS


def complaints(text: str) -> str:
    with pytest.raises(InputError) as caught:
        build(parse_model(text, "sent.toml"))
    return str(caught.value)


def test_a_power_of_a_place_that_no_unit_has() -> None:
    """Twelve metres in a row, squared for an energy."""
    text = DRIVEN_MASS.replace('at = ["x", "0"]', f'at = ["{"*".join("x" * 12)}", "0"]')
    assert "bodies.mass.at: gives no unit of energy" in complaints(
        text.replace('unit = "m" }\n[parameters]', 'unit = "kg" }\n[parameters]')
    )


def test_a_wheel_at_a_point_that_cannot_be_read() -> None:
    wheel = """[points.hub]
at = ["x", "0"]
body = { name = "mass" }
[constraints.front]
kind = "wheel"
point = "hub"
axle = "y"
radius = "k"
"""
    said = complaints(DRIVEN_MASS + wheel)
    assert "points.hub.body: must be text in quotes" in said
    assert "constraints.front.kind" in said


@pytest.mark.parametrize("stiffness", ["k*log(0)", "k/(1 - 1)", "k*tan(0)**-1"])
def test_a_law_that_divides_by_zero_wherever_it_is(stiffness: str) -> None:
    text = DRIVEN_MASS.replace('stiffness = "k"', f'stiffness = "{stiffness}"')
    with pytest.raises(InputError, match=r"spring is not finite|divi"):
        build(parse_model(text, "sent.toml"))

"""How stiff a model is along a place, by its springs and by a declared potential."""

import pytest

from symhyb.discrepancy.places.stiffness import stiffness_at
from symhyb.model.read import parse_model
from symhyb.model.types import Model, On

CHAIN = """symhyb = 1
[coordinates]
a = {{ unit = "deg", start = 20 }}
b = {{ unit = "deg" }}
[parameters]
j = {{ value = 0.1, unit = "kg*m^2" }}
k = {{ value = 4.0, unit = "N*m/rad" }}
hold = {{ value = 2.5, unit = "N*m/rad" }}
one = {{ value = 1.0, unit = "1" }}
[inputs]
warm = {{ unit = "1" }}
[energy]
kinetic = "j*a'**2/2 + j*b'**2/2"
{potential}
[sensors]
first = {{ measures = "a", unit = "deg" }}
second = {{ measures = "b", unit = "deg" }}
"""
SHAFT = "k*(a - b)**2/2"


def chain(potential: str = "", elements: str = "") -> Model:
    line = f'potential = "{potential}"' if potential else ""
    return parse_model(CHAIN.format(potential=line) + elements, "chain.toml")


def spring(name: str, place: str, stiffness: str) -> str:
    return f'[elements.{name}]\nkind = "spring"\non = "{place}"\nstiffness = "{stiffness}"\n'


@pytest.mark.parametrize(
    ("potential", "of_twist", "of_first", "of_second"),
    [
        (SHAFT, 4.0, 0.0, 0.0),
        (f"{SHAFT} + hold*a**2/2", 4.0, 2.5, 1 / (1 / 4.0 + 1 / 2.5)),
        ("hold*a**2/2", 0.0, 2.5, 0.0),
        (f"-{SHAFT}", 0.0, 0.0, 0.0),
        ("hold/b**2", 0.0, 0.0, 0.0),  # infinite at the start
        ("", 0.0, 0.0, 0.0),
    ],
)
def test_a_potential_is_as_stiff_as_the_springs_that_it_is(
    potential: str, of_twist: float, of_first: float, of_second: float
) -> None:
    model = chain(potential)
    found = [stiffness_at(model, On(place)) for place in ("a - b", "a", "b")]
    assert found == pytest.approx([of_twist, of_first, of_second], rel=1e-5)


def test_springs_at_a_place_are_added_to_what_is_declared() -> None:
    twice = spring("shaft", "a - b", "k") + spring("beside", "a - b", "hold")
    assert stiffness_at(chain(elements=twice), On("a - b")) == pytest.approx(6.5)
    assert stiffness_at(chain(SHAFT, twice), On("a - b")) == pytest.approx(10.5, rel=1e-5)
    assert stiffness_at(chain(elements=twice), On("a")) == 0.0


def test_what_an_input_changes_has_no_known_stiffness() -> None:
    varying = spring("varying", "a", "k*warm") + spring("beside", "a", "hold")
    assert stiffness_at(chain(elements=varying), On("a")) == 0.0
    assert stiffness_at(chain(SHAFT, varying), On("a")) == 0.0

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
    """The twelfth power of a length, squared for an energy."""
    text = DRIVEN_MASS.replace('at = ["x", "0"]', f'at = ["{"*".join("x" * 12)}", "0"]')
    assert "bodies.mass.at: gives no unit of energy" in complaints(text)


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


@pytest.mark.parametrize("tower", ["9**9**9", "2**2**2**2**2**2", "0**-1", "(-2)**0.5"])
def test_a_tower_of_powers_is_a_number_or_none(tower: str) -> None:
    """SymPy would write 9**9**9 out, all of its 370 million digits."""
    text = DRIVEN_MASS.replace('stiffness = "k"', f'stiffness = "k*{tower}"')
    with pytest.raises(InputError, match="spring is not finite"):
        build(parse_model(text, "sent.toml"))


def test_powers_of_numbers_are_numbers() -> None:
    text = DRIVEN_MASS.replace('stiffness = "k"', 'stiffness = "k*2**3/4**0.5"')
    build(parse_model(text, "sent.toml"))


@pytest.mark.parametrize("stiffness", ["k*log(0)", "k/(1 - 1)", "k*tan(0)**-1"])
def test_a_law_that_divides_by_zero_wherever_it_is(stiffness: str) -> None:
    text = DRIVEN_MASS.replace('stiffness = "k"', f'stiffness = "{stiffness}"')
    with pytest.raises(InputError, match=r"spring is not finite|divi"):
        build(parse_model(text, "sent.toml"))


@pytest.mark.parametrize("letter", ["\x1b", "\x07", "\x9b", "\u202e", "\u2028", "\uffff", "\x00"])
def test_a_text_holds_letters_alone(letter: str) -> None:
    """No escape sequence reaches a terminal, a page or a file, not by the complaint either."""
    escaped = f"\\u{ord(letter):04x}"
    said = complaints(DRIVEN_MASS.replace("symhyb = 1", f'symhyb = 1\ntitle = "a{escaped}[2Jb"'))
    assert f"title: holds {escaped}" in said
    assert letter not in said


def test_text_of_any_language_is_text() -> None:
    title = "Dämpfer\\tπ/2 \\n中文 עברית नमस्ते 👩‍🔧 « »"
    model = parse_model(DRIVEN_MASS.replace("symhyb = 1", f'symhyb = 1\ntitle = "{title}"'), "m")
    assert "👩‍🔧" in model.title


def test_a_key_that_is_no_text_is_complained_of_in_visible_letters() -> None:
    said = complaints(DRIVEN_MASS + '"a\\u001b[31m" = 1\n')
    assert "\x1b" not in said
    assert "\\u001b[31m" in said


def test_a_machine_of_more_coordinates_than_any_has() -> None:
    many = "\n".join(f'more{i} = {{ unit = "m" }}' for i in range(500))
    text = DRIVEN_MASS.replace("[coordinates]", f"[coordinates]\n{many}")
    assert "coordinates: are 501; a machine has at most 500" in complaints(text)


def test_a_machine_of_more_elements_than_any_has() -> None:
    many = "\n".join(
        f'e{i} = {{ kind = "spring", on = "x", stiffness = "k" }}' for i in range(2000)
    )
    text = DRIVEN_MASS.replace("[elements.", f"[elements]\n{many}\n[elements.", 1)
    assert "elements: are 2003; a machine has at most 2000" in complaints(text)


@pytest.mark.parametrize("stiffness", ["k*sqrt(-1)", "k*asin(2)", "k*log(-1)", "k*acos(9)**2"])
def test_a_number_that_is_not_real_is_none(stiffness: str) -> None:
    text = DRIVEN_MASS.replace('stiffness = "k"', f'stiffness = "{stiffness}"')
    assert "spring is not finite" in complaints(text)


def test_a_root_of_what_is_never_positive_is_not_finite() -> None:
    """SymPy writes sqrt(-k²) as a multiple of the imaginary unit."""
    text = DRIVEN_MASS.replace('stiffness = "k"', 'stiffness = "sqrt(-k**2)"')
    assert "spring is not finite" in complaints(text)

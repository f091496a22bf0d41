"""The drawing of the machine on the page: what was found stands out; what has no place is none."""

from base64 import b64decode
from types import SimpleNamespace

from snippets import ROOT

from symhyb.model.read import parse_model, read_model
from symhyb.model.types import Model
from symhyb.report.pictures import machine_picture

FOUND = """
[elements.found_friction]
kind = "friction"
on = "{on}"
coulomb = "F"
[elements.found_friction.parameters]
F = {{ value = 0.5, unit = "{unit}" }}
"""


def found(model: Model, on: str, unit: str) -> SimpleNamespace:
    """A diagnosis that found friction on a coordinate."""
    element = parse_model(model.text + FOUND.format(on=on, unit=unit)).elements[-1]
    return SimpleNamespace(found=(SimpleNamespace(element=element),))


def test_the_machine_is_drawn_with_what_was_found_in_it() -> None:
    model = read_model(ROOT / "models" / "cartpole.toml")
    picture = machine_picture(found(model, "x", "N"), model)
    assert picture is not None
    assert "found_friction" in picture.alternative
    drawn = b64decode(picture.source.split(",", 1)[1])
    assert drawn.startswith(b"<?xml")
    assert b"found_friction" in drawn


def test_nothing_is_drawn_where_nothing_was_found_or_the_machine_is_not_known() -> None:
    model = read_model(ROOT / "models" / "cartpole.toml")
    assert machine_picture(SimpleNamespace(found=()), model) is None
    assert machine_picture(found(model, "x", "N"), None) is None

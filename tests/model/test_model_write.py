"""Writing: the original stays byte for byte, and what is written reads back equal."""

from dataclasses import replace
from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.model.expression import parse_expression
from symhyb.model.read import parse_model, read_model
from symhyb.model.render import render
from symhyb.model.types import At, Element, Model, On, Parameter
from symhyb.model.write import append_elements, replace_parameters, text_of, write_model
from symhyb.units import parse_unit

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture
def duffing() -> Model:
    return read_model(MODELS / "duffing.toml")


@pytest.fixture
def cartpole() -> Model:
    return read_model(MODELS / "cartpole.toml")


def found_drag(value: float = 0.42, sd: float = 0.03) -> Element:
    unit = parse_unit("N*s^2/m^2")
    own = Parameter("b", value, unit, sd, "drag quadratic in speed", owner="found_drag")
    provenance = (("by", "sparse"), ("from", "sweep_03.csv"), ("nrmse", (0.213, 0.021)))
    values = (("drag", parse_expression("b")),)
    return Element("found_drag", "drag", On("x"), values, (own,), provenance)


CORRECTION = """
[elements.found_drag]
kind  = "drag"
on    = "x"
drag  = "b"
found = { by = "sparse", from = "sweep_03.csv", nrmse = [0.213, 0.021] }
[elements.found_drag.parameters]
b = { value = 0.42, sd = 0.03, unit = "N*s^2/m^2", about = "drag quadratic in speed" }
"""


def test_a_correction_is_appended_text(duffing: Model) -> None:
    corrected = append_elements(duffing, [found_drag()])
    assert corrected.text == duffing.text + CORRECTION
    assert corrected.elements == (*duffing.elements, found_drag())
    assert parse_model(corrected.text, duffing.file) == corrected


def test_numbers_read_back_within_fifteen_digits(duffing: Model) -> None:
    value = 0.123456789012345678
    element = append_elements(duffing, [found_drag(value)]).elements[-1]
    assert element.parameters[0].value == pytest.approx(value, rel=1e-14, abs=0.0)


def test_line_ends_of_the_original_are_kept(duffing: Model) -> None:
    original = parse_model(duffing.text.replace("\n", "\r\n").rstrip())
    text = append_elements(original, [found_drag()]).text
    assert text.startswith(original.text)
    assert "\n" not in text.replace("\r\n", "")


def test_a_name_that_is_taken_or_a_wrong_unit_is_refused(duffing: Model) -> None:
    with pytest.raises(InputError, match="already an element 'spring'"):
        append_elements(duffing, [replace(found_drag(), name="spring")])
    wrong = replace(found_drag().parameters[0], unit=parse_unit("N"))
    with pytest.raises(InputError, match="'b' is N, needs N"):
        append_elements(duffing, [replace(found_drag(), parameters=(wrong,))])


def test_awkward_words_are_quoted(duffing: Model) -> None:
    about = 'says "b = 1"\n[elements.evil]\\ \t ∆ é'
    (own,) = found_drag().parameters
    element = replace(found_drag(), parameters=(replace(own, about=about),), about=about)
    assert append_elements(duffing, [element]).elements[-1] == element


def test_forces_at_points_read_back(cartpole: Model) -> None:
    values = (("force.x", parse_expression("-push")), ("force.y", parse_expression(0)))
    element = Element("wind", "force", At("tip"), values)
    assert append_elements(cartpole, [element]).elements[-1] == element


def test_a_re_estimate_changes_one_line_and_keeps_its_past(duffing: Model) -> None:
    changed = replace_parameters(duffing, {"k": (1010.25, 12.0)})
    k = changed.parameters[1]
    assert (k.value, k.sd, k.was) == (1010.25, 12.0, 980.0)
    before, after = duffing.text.splitlines(), changed.text.splitlines()
    (pair,) = [(old, new) for old, new in zip(before, after, strict=True) if old != new]
    assert pair[0].startswith("k = { value = 980.0,")
    assert pair[1].startswith("k = { value = 1010.25, was = 980.0,")
    again = replace_parameters(changed, {"k": (990.0, None)}).parameters[1]
    assert (again.value, again.sd, again.was) == (990.0, 12.0, 1010.25)


def test_own_parameters_and_channels_are_re_estimated(duffing: Model) -> None:
    model = append_elements(duffing, [found_drag()])
    values = {"found_drag.b": (0.5, 0.01), "f.gain": (1.02, 0.005), "laser.offset": (2e-4, None)}
    changed = replace_parameters(model, values)
    found = {parameter.path: parameter for parameter in changed.all_parameters()}
    assert (found["found_drag.b"].value, found["found_drag.b"].was) == (0.5, 0.42)
    assert (found["f.gain"].value, found["f.gain"].sd, found["f.gain"].was) == (1.02, 0.005, 1.0)
    assert (found["laser.offset"].value, found["laser.offset"].was) == (2e-4, 0.0)
    twice = replace_parameters(changed, {"f.gain": (1.03, 0.004)}).inputs[0].gain
    assert twice is not None
    assert (twice.value, twice.sd, twice.was) == (1.03, 0.004, 1.02)


HEAD = """\
symhyb = 1
coordinates.x.unit = "m"
inputs.f = { unit = "N", gain = 1.5 }
bodies.mass = { mass = "m", at = ["x", "0"] }
"""


@pytest.mark.parametrize(
    "style",
    [
        '[parameters.m]\nvalue = 3 # three\nunit = "kg"\n',
        '[parameters]\nm.value = 3\nm.unit = "kg"\n',
        '[parameters]\nm = { unit = "kg", value = 3 }\n',
        'parameters = { m = { value = 3, unit = "kg" } }\n',
        '[parameters]\nm.unit = "kg"\nm.value = 3',
        '[ parameters . "m" ]\r\n"value"=3\r\nunit="kg"\r\n',
    ],
    ids=["table", "dotted", "inline", "nested", "last line", "quoted"],
)
def test_every_way_to_write_a_parameter_can_be_changed(style: str) -> None:
    changed = replace_parameters(parse_model(HEAD + style), {"m": (4.5, 0.5), "f.gain": (1.6, 0.1)})
    (m,) = changed.parameters
    assert (m.value, m.sd, m.was) == (4.5, 0.5, 3.0)
    assert changed.inputs[0].gain is not None
    assert changed.inputs[0].gain.was == 1.5


def test_an_unknown_path_is_refused_with_the_nearest(duffing: Model) -> None:
    with pytest.raises(InputError, match=r"no parameter 'kk'; did you mean 'k'"):
        replace_parameters(duffing, {"kk": (1.0, None)})


@pytest.mark.parametrize("name", ["oscillator", "duffing", "emps", "pendulum", "cartpole"])
def test_a_model_without_text_is_rendered_whole(name: str) -> None:
    model = read_model(MODELS / f"{name}.toml")
    bare = replace(model, text="", file="")
    assert replace(parse_model(render(bare)), text="") == bare


def test_text_that_no_longer_says_the_same_is_not_written(duffing: Model) -> None:
    heavier = replace(duffing.parameters[0], value=2.5)
    changed = replace(duffing, parameters=(heavier, *duffing.parameters[1:]))
    assert text_of(duffing) == duffing.text
    assert parse_model(text_of(changed)).parameters[0].value == 2.5


def test_writing_is_whole_or_not_at_all(duffing: Model, tmp_path: Path) -> None:
    target = tmp_path / "out.toml"
    write_model(duffing, target)
    assert target.read_bytes() == (MODELS / "duffing.toml").read_bytes()
    assert list(tmp_path.iterdir()) == [target]
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="is a folder; name a file in it"):
        write_model(duffing, tmp_path / "folder")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder", "out.toml"]


def test_comments_stand_above_what_they_are_about(duffing: Model) -> None:
    said = {
        "": ("two lines", "", "of the head"),
        "parameters": ("numbers",),
        "parameters.k": ("of the spring",),
        "elements.spring": ("an element\nwith \u202e what no terminal shows",),
    }
    text = render(duffing, said)
    assert text.startswith("# two lines\n#\n# of the head\n\nsymhyb")
    assert "\n# numbers\n[parameters]\n" in text
    assert "\n# of the spring\nk" in text
    assert "\n# an element with \\u202e what no terminal shows\n[elements.spring]\n" in text
    bare = parse_model(render(duffing))
    assert replace(parse_model(text), text=bare.text) == bare

"""Characteristic curves in a model file: in points or beside it, by name, and what is refused."""

import hashlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.limits import CURVE_BYTES, CURVE_POINTS
from symhyb.model.diff import changes
from symhyb.model.read import parse_model, read_model
from symhyb.model.render import render
from symhyb.model.types import Model
from symhyb.model.write import append_elements, write_model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from tests.builders import DRIVEN_MASS

STRUT = """[elements.strut]
kind = "curve"
on = "x"
over = "rate"
units = ["mm/s", "N"]
points = [[-300, -9], [0, 0], [400, 3.5]]
"""
FROM_FILE = """[elements.strut]
kind = "curve"
on = "x"
over = "rate"
file = "strut.csv"
"""
CSV = "speed [mm/s],force [N]\n-300,-9\n0,0\n400,3.5\n"
NAMED = """[curves.valve]
units = ["mm/s", "N"]
points = [[-300, -9], [0, 0], [400, 3.5]]
[elements.strut]
kind = "curve"
on = "x"
over = "rate"
curve = "valve"
"""


BY_STRETCH = (
    STRUT
    + 'by_stretch = { points = [[-40, 3.0], [0, 1.0], [30, 2.0]], units = ["mm", "1"], '
    + 'extrapolation = "hold" }\n'
)
BY_NAME = (
    """[curves.zone]
points = [[-40, 3.0], [0, 1.0], [30, 2.0]]
units = ["mm", "1"]
"""
    + STRUT
    + 'by_stretch = "zone"\n'
)


def problems(text: str, file: str = "m.toml") -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_model(DRIVEN_MASS + text, file)
    return [str(problem).partition(": ")[2] for problem in caught.value.problems]


def in_folder(folder: Path, text: str = FROM_FILE, csv: str = CSV) -> Path:
    (folder / "strut.csv").write_bytes(csv.encode())
    path = folder / "model.toml"
    path.write_bytes((DRIVEN_MASS + text).encode())
    return path


def strut(model: Model):  # type: ignore[no-untyped-def]
    return next(element.curve for element in model.elements if element.name == "strut")


def test_points_are_read_in_their_units() -> None:
    curve = strut(parse_model(DRIVEN_MASS + STRUT))
    assert curve.points == ((-300.0, -9.0), (0.0, 0.0), (400.0, 3.5))
    assert (curve.interpolation, curve.extrapolation) == ("monotone", "line")
    assert float(curve.characteristic(0.4)) == pytest.approx(3.5)
    assert curve.owned
    assert curve.smooth


def test_a_curve_of_the_model_is_found_by_its_name() -> None:
    model = parse_model(DRIVEN_MASS + NAMED)
    assert strut(model) is model.curves[0]
    assert not model.curves[0].owned


def test_a_file_beside_the_model_gives_the_same_points(tmp_path: Path) -> None:
    curve = strut(read_model(in_folder(tmp_path, csv="\ufeff" + CSV.replace("\n", "\r\n"))))
    assert curve.points == strut(parse_model(DRIVEN_MASS + STRUT)).points
    assert [unit.text for unit in curve.units] == ["mm/s", "N"]
    assert curve.file == "strut.csv"
    assert curve.sha256 == hashlib.sha256((tmp_path / "strut.csv").read_bytes()).hexdigest()


def test_units_may_stand_in_the_model_and_columns_be_named(tmp_path: Path) -> None:
    text = FROM_FILE + 'columns = ["v", "F"]\nunits = ["mm/s", "N"]\n'
    csv = "t,F,v\n0,-9,-300\n1,0,0\n2,3.5,400\n"
    curve = strut(read_model(in_folder(tmp_path, text, csv)))
    assert curve.points == strut(parse_model(DRIVEN_MASS + STRUT)).points


@pytest.mark.parametrize(
    "text",
    [STRUT, NAMED, FROM_FILE, BY_STRETCH, BY_NAME],
    ids=["own", "named", "file", "by stretch", "by the name of a curve"],
)
def test_what_is_written_reads_back(text: str, tmp_path: Path) -> None:
    text += 'about = "measured at 20 °C"\n'
    model = read_model(in_folder(tmp_path, text))
    bare = replace(model, text="")
    again = parse_model(render(bare), str(tmp_path / "model.toml"))
    assert replace(again, text="") == bare
    assert changes(model, again) == ()


def test_an_appended_element_brings_its_points(tmp_path: Path) -> None:
    model = read_model(in_folder(tmp_path, STRUT + 'interpolation = "linear"\n'))
    plain = parse_model(DRIVEN_MASS)
    element = next(element for element in model.elements if element.name == "strut")
    corrected = append_elements(plain, [element])
    assert corrected.text.startswith(DRIVEN_MASS)
    assert strut(corrected) == strut(model)


def test_writing_elsewhere_takes_the_points_along(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    model = read_model(in_folder(tmp_path))
    target = tmp_path / "there" / "model.toml"
    write_model(model, target)
    assert strut(read_model(target)) == strut(model)
    assert (tmp_path / "there" / "strut.csv").read_bytes() == (tmp_path / "strut.csv").read_bytes()
    (tmp_path / "there" / "strut.csv").write_text(CSV.replace("-9", "-8"))
    with pytest.raises(InputError, match="holds other points"):
        write_model(model, target)


def test_a_difference_of_points_is_told() -> None:
    first = parse_model(DRIVEN_MASS + STRUT)
    second = parse_model(DRIVEN_MASS + STRUT.replace("3.5", "3.25"))
    (said,) = changes(first, second)
    assert said.startswith("~ element strut: points 3 from -300 to 400 mm/s, in N, hash ")


@pytest.mark.parametrize("text", [BY_STRETCH, BY_NAME], ids=["own", "named"])
def test_a_curve_over_the_rate_is_multiplied_by_one_over_the_stretch(text: str) -> None:
    machine = build(parse_model(DRIVEN_MASS + text))
    factors = {-0.04: 3.0, 0.0: 1.0, 0.03: 2.0, **({-0.06: 3.0} if text is BY_STRETCH else {})}
    for x, factor in factors.items():
        given = np.array([x]), np.array([0.4]), np.zeros(0), np.zeros(1), 0.0, machine.values
        (forces,) = call(machine.elements, given)
        assert forces.ravel()[-1] == pytest.approx(-3.5 * factor)  # it resists


def test_a_difference_of_what_it_is_multiplied_by_is_told() -> None:
    first = parse_model(DRIVEN_MASS + BY_STRETCH)
    second = parse_model(DRIVEN_MASS + BY_STRETCH.replace("[30, 2.0]", "[30, 2.5]"))
    (said,) = changes(first, second)
    assert said.startswith("~ element strut: by_stretch points 3 from -40 to 30 mm, in 1, hash ")


FAULTS = {
    "factor of a curve over the stretch": (
        STRUT,
        BY_STRETCH.replace("rate", "stretch").replace('"mm/s"', '"mm"'),
        [
            "elements.strut.by_stretch: is a factor of a curve over the rate; state over = 'rate', "
            "or leave it out"
        ],
    ),
    "factor with a unit": (
        STRUT,
        BY_STRETCH.replace('["mm", "1"]', '["mm/s", "N"]'),
        [
            "elements.strut.by_stretch: x of the curve is mm/s, needs m",
            "elements.strut.by_stretch: y of the curve is N, needs 1",
        ],
    ),
    "factor that is no curve": (
        STRUT,
        STRUT + "by_stretch = 2.0\n",
        [
            "elements.strut.by_stretch: must be a table with points and units, or the name of a "
            "curve, not the number 2"
        ],
    ),
    "factor of an unknown name": (
        STRUT,
        BY_NAME.replace('by_stretch = "zone"', 'by_stretch = "zoen"'),
        [
            "elements.strut.by_stretch: 'zoen' is not a known curve; did you mean 'zone'?",
        ],
    ),
    "no points": (
        "points = [[-300, -9], [0, 0], [400, 3.5]]",
        "",
        ["elements.strut: 'points' is missing: a list of [x, y], or 'file' with such points"],
    ),
    "misspelt": (
        "points",
        "pionts",
        ["elements.strut.pionts: 'pionts' is not a key here; did you mean 'points'?"],
    ),
    "no units": (
        'units = ["mm/s", "N"]',
        "",
        [
            'elements.strut: the unit of x is missing: units = ["m/s", "N"]',
            'elements.strut: the unit of y is missing: units = ["m/s", "N"]',
        ],
    ),
    "units of another place": (
        '["mm/s", "N"]',
        '["mm", "N*m"]',
        [
            "elements.strut.units: x of the curve is mm, needs m/s",
            "elements.strut.units: y of the curve is N*m, needs N",
        ],
    ),
    "over the other": (
        'over = "rate"',
        'over = "stretch"',
        ["elements.strut.units: x of the curve is mm/s, needs m"],
    ),
    "a factor of the speed over the rate": (
        'over = "rate"',
        'over = "rate"\ntimes = "rate"',
        [
            "elements.strut.times: is for a curve over the stretch; one over the rate is a force "
            "by itself"
        ],
    ),
    "a factor of the speed in newtons": (
        'over = "rate"\nunits = ["mm/s", "N"]',
        'over = "stretch"\ntimes = "square"\nunits = ["mm", "N"]',
        ["elements.strut.units: y of the curve is N, needs N*s^2/m^2"],
    ),
    "no factor": (
        'over = "rate"',
        'over = "rate"\ntimes = "load"',
        ["elements.strut.times: 'load' is not a word for it; it is one of rate, square"],
    ),
    "over nothing": (
        'over = "rate"\n',
        "",
        [
            "elements.strut: kind 'curve' needs 'over': what the force is a function of,"
            " stretch or rate",
            "elements.strut.units: x of the curve is mm/s, needs m",
        ],
    ),
    "no unit": (
        "mm/s",
        "mn/q",
        ["elements.strut.units: 'mn' is not a known unit"],
    ),
    "no list": (
        "[[-300, -9], [0, 0], [400, 3.5]]",
        '"here"',
        ["elements.strut.points: must be a list of [x, y], not the text 'here'"],
    ),
    "one point": (
        "[-300, -9], [0, 0], ",
        "",
        ["elements.strut.points: holds one point; a curve has two at least"],
    ),
    "every wrong point": (
        "[-300, -9], [0, 0]",
        "[-300, nan], [0], 7, [true, 1]",
        [
            "elements.strut.points: point 1 holds the number nan, not a finite number",
            "elements.strut.points: point 2 must be [x, y], not a list of 1",
            "elements.strut.points: point 3 must be [x, y], not the number 7",
            "elements.strut.points: point 4 holds the truth value true, not a finite number",
        ],
    ),
    "order": (
        "[0, 0], [400",
        "[0, 0], [0, 1], [-20, 1], [400",
        [
            "elements.strut.points: point 3 x = 0 is stated twice",
            "elements.strut.points: point 4 x = -20 comes after 0; x must increase",
        ],
    ),
    "no measurement": (
        "3.5",
        "1e101",
        ["elements.strut.points: y = 1e+101 is no measurement; at most 1e+100 in SI"],
    ),
    "no slope": (
        "[0, 0], [400",
        "[0, 0], [5e-324, 1e9], [400",
        [
            "elements.strut.points: holds points so close to each other that no slope is finite"
            " between them"
        ],
    ),
    "words": (
        "points",
        'interpolation = "cubic"\nextrapolation = "holds"\npoints',
        [
            "elements.strut.interpolation: must be monotone or linear, not 'cubic'"
            "; known: monotone, linear",
            "elements.strut.extrapolation: must be line or hold, not 'holds'; did you mean 'hold'?",
        ],
    ),
    "columns of no file": (
        "points",
        'columns = ["a", "b"]\npoints',
        ["elements.strut.columns: names columns of a 'file', which is not stated"],
    ),
    "both": (
        "points",
        'file = "strut.csv"\npoints',
        ["elements.strut: states 'points' and 'file'; a curve has one of them"],
    ),
    "at a point": (
        'on = "x"',
        'at = "p"',
        ["elements.strut.at: kind 'curve' cannot stand 'at'; it needs 'on' or 'between'"],
    ),
    "own and named": (
        "points",
        'curve = "valve"\npoints',
        [
            "elements.strut.units: 'units' belongs to the curve, which [curves] states by 'curve'",
            "elements.strut.points: 'points' belongs to the curve, which [curves] states by"
            " 'curve'",
        ],
    ),
}


@pytest.mark.parametrize(("old", "new", "said"), FAULTS.values(), ids=FAULTS)
def test_every_fault_is_told(old: str, new: str, said: list[str]) -> None:
    assert old in STRUT
    found = problems(STRUT.replace(old, new, 1))
    assert len(found) == len(said), found
    for sentence, begin in zip(found, said, strict=True):
        assert sentence.startswith(begin)


def test_too_many_points_are_refused_and_the_rest_of_a_long_list_counted() -> None:
    many = ", ".join(f"[{i}, 0]" for i in range(CURVE_POINTS + 1))
    text = STRUT.replace("[-300, -9], [0, 0], [400, 3.5]", many)
    (said,) = problems(text)
    assert said.endswith("holds 101 points; a curve has at most 100: thin it out")
    wrong = ", ".join("[0, 0]" for _ in range(50))
    found = problems(STRUT.replace("[-300, -9], [0, 0], [400, 3.5]", wrong))
    assert len(found) == 11
    assert found[-1] == "elements.strut.points: and 39 more like these"


def test_an_unknown_curve_is_told_with_those_that_there_are() -> None:
    (said,) = problems(NAMED.replace('curve = "valve"', 'curve = "vavle"'))
    assert said == "elements.strut.curve: 'vavle' is not a known curve; did you mean 'valve'?"
    (said,) = problems(NAMED.replace("[400, 3.5]", "[0, 3.5]"))
    assert said == "curves.valve.points: point 3 x = 0 is stated twice"


def test_a_curve_of_the_model_has_the_units_of_where_it_is_used() -> None:
    (said,) = problems(NAMED.replace('"N"]', '"N*m"]'))
    assert said == "elements.strut.curve: y of the curve is N*m, needs N"


MORE = """[curves.valve]
units = ["m/s", "N"]
points = [[-0.3, -9], [0, 0], [0.4, 3.5]]
[curves.pad]
units = ["mm", "N"]
points = [[-300, -9], [0, 0], [400, 3.5]]
interpolation = "linear"
"""


def test_a_curve_may_stand_in_any_expression() -> None:
    model = parse_model(
        DRIVEN_MASS
        + MORE
        + """[points]
tip = ["x", "curve(rail, x)"]
[curves.rail]
units = ["m", "m"]
points = [[0, 0], [1, 0.2]]
[energy]
potential = "l*curve(pad, x)"
[elements.odd]
kind = "law"
on = "x"
force = "-curve(valve, x')*curve(pad, x)/n"
[parameters.l]
value = 1.0
unit = "m"
[parameters.n]
value = 1.0
unit = "N"
"""
    )
    assert [curve.name for curve in model.curves] == ["valve", "pad", "rail"]
    bare = replace(model, text="")
    assert replace(parse_model(render(bare)), text="") == bare


IN_EXPRESSIONS = {
    "unknown": ("curve(vavle, x')", "'vavle' is not a known curve; did you mean 'valve'?"),
    "wrong value": ("curve(valve, x)", "the curve 'valve' takes m/s, but 'x' is in m"),
    "wrong result": ("x*curve(valve, x')", "'x*curve(valve, x')' is m*N, needs N"),
    "unknown name": ("curve(valve, w)", "'w' is not a known name"),
    "no name": ("curve(x')", "'curve' takes the name of a curve and a value"),
}


@pytest.mark.parametrize(("force", "said"), IN_EXPRESSIONS.values(), ids=IN_EXPRESSIONS)
def test_a_fault_in_an_expression_is_told(force: str, said: str) -> None:
    text = f'[elements.odd]\nkind = "law"\non = "x"\nforce = "{force}"\n'
    (found,) = problems(MORE + text)
    assert said in found


def test_a_curve_that_cannot_be_read_is_told_once() -> None:
    text = '[elements.odd]\nkind = "law"\non = "x"\nforce = "curve(valve, x\')"\n'
    (found,) = problems((MORE + text).replace("[0, 0], [0.4", "[0, 0], [0, 1], [0.4", 1))
    assert found == "curves.valve.points: point 3 x = 0 is stated twice"


def test_a_place_needs_a_curve_without_kinks() -> None:
    (found,) = problems(MORE + '[points]\ntip = ["x", "curve(pad, x)/k"]\n')
    assert "'curve(pad, x)' has no smooth speed, which a position needs" in found
    assert found.endswith("let the curve be monotone, and a line beyond its points")


NAMES = {
    "absolute": ("/etc/passwd", "must be a file beside the model file or below it"),
    "upwards": ("../strut.csv", "must be a file beside the model file or below it"),
    "windows": ("C:/strut.csv", "must be a file beside the model file or below it"),
    "backslash": ("a\\..\\..\\strut.csv", "must be a file beside the model file or below it"),
    "none": ("other.csv", "there is no such file"),
    "no points": ("model.toml", "must end in .csv"),
    "a result": ("Simulation.csv", "'simulation.csv' is a result of symhyb"),
    "folder": ("folder.csv", "is a folder, not a file"),
    "too long": ("a" * 5000 + ".csv", "cannot be"),
}


@pytest.mark.parametrize(("name", "said"), NAMES.values(), ids=NAMES)
def test_a_file_that_leads_elsewhere_is_refused(name: str, said: str, tmp_path: Path) -> None:
    name = name.replace("\\", "\\\\")
    path = in_folder(tmp_path, FROM_FILE.replace('"strut.csv"', f'"{name}"'))
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(InputError, match=said) as caught:
        read_model(path)
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize("whole", [True, False])
def test_a_link_out_of_the_folder_is_refused(whole: bool, tmp_path: Path) -> None:
    home, other = tmp_path / "home", tmp_path / "other"
    home.mkdir()
    other.mkdir()
    path, text = home / "model.toml", FROM_FILE
    (other / "strut.csv").write_text(CSV)
    if whole:
        (home / "sub").symlink_to(other)
        text = text.replace("strut.csv", "sub/strut.csv")
    else:
        (home / "strut.csv").symlink_to(other / "strut.csv")
    path.write_text(DRIVEN_MASS + text)
    with pytest.raises(InputError, match="leads out of the folder of the model file"):
        read_model(path)


def test_a_link_within_the_folder_is_followed(tmp_path: Path) -> None:
    path = in_folder(tmp_path, FROM_FILE.replace("strut.csv", "link.csv"))
    (tmp_path / "link.csv").symlink_to(tmp_path / "strut.csv")
    assert strut(read_model(path)).points[0] == (-300.0, -9.0)


FILES = {
    "large": ("#" * (CURVE_BYTES + 1), ["is larger than 0.1 MB"]),
    "every line": (
        CSV + "500\n500,x\n",
        ["strut.csv:5: has 1 cells; the first line has 2", "strut.csv:6: 'x' is not a number"],
    ),
    "order": (CSV + "400,1\n", ["strut.csv:5: x = 400 is stated twice"]),
    "too few": (CSV[:30], ["holds one point; a curve has two at least"]),
    "other units": (CSV, ["'mm/s' of x is 'm/s' in strut.csv; state it once"]),
    "no units": ("v,F\n0,0\n1,1\n", ["the unit of x is missing", "the unit of y is missing"]),
    "strange unit": (CSV.replace("mm/s", "mm/\x1bs"), ["is not a unit"]),
}


@pytest.mark.parametrize(("csv", "said"), FILES.values(), ids=FILES)
def test_every_fault_of_a_file_is_told(csv: str, said: list[str], tmp_path: Path) -> None:
    other = said[0].startswith("'mm/s'")
    text = FROM_FILE + ('units = ["mm/s", "N"]\n' if other else "")
    path = in_folder(tmp_path, text, csv.replace("mm/s", "m/s") if other else csv)
    with pytest.raises(InputError) as caught:
        read_model(path)
    found = [str(problem) for problem in caught.value.problems]
    assert len(found) == len(said), found
    for sentence, part in zip(found, said, strict=True):
        assert part in sentence
        assert "\x1b" not in sentence


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = in_folder(tmp_path)
    (tmp_path / "strut.csv").write_bytes(b"v,F\n\xff,1\n")
    with pytest.raises(InputError, match="is not UTF-8 text"):
        read_model(path)


def test_a_text_without_a_file_has_nothing_beside_it() -> None:
    with pytest.raises(InputError, match="lies beside a model file, and this text is none"):
        parse_model(DRIVEN_MASS + FROM_FILE)

"""Maps in a model file: a grid in it or beside it, by name, and what is refused."""

import hashlib
from dataclasses import replace
from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.limits import CURVE_BYTES, MAP_PLACES
from symhyb.model.diff import changes
from symhyb.model.maps import Map
from symhyb.model.read import parse_model, read_model
from symhyb.model.render import render
from symhyb.model.types import Model
from symhyb.model.varied import written_with_factor
from symhyb.model.write import append_elements, write_model
from symhyb.study.provenance import table_hashes
from tests.builders import DRIVEN_MASS

STRUT = """[elements.strut]
kind = "map"
on = "x"
units = ["mm", "m/s", "N"]
x = [-40, 0, 40]
y = [-0.5, 0.5]
values = [[-900, 400], [-300.5, 250], [-800, 500]]
"""
FROM_FILE = """[elements.strut]
kind = "map"
on = "x"
units = ["mm", "m/s", "N"]
file = "strut.csv"
"""
CSV = "mm \\ m/s,-0.5,0.5\n-40,-900,400\n# at rest\n0,-300.5,250\n\n40,-800,500\n"
NAMED = """[maps.valve]
units = ["mm", "m/s", "N"]
x = [-40, 0, 40]
y = [-0.5, 0.5]
values = [[-900, 400], [-300.5, 250], [-800, 500]]
extrapolation = "hold"
[elements.strut]
kind = "map"
on = "x"
map = "valve"
"""


def problems(text: str, file: str = "m.toml") -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_model(DRIVEN_MASS + text, file)
    return [str(problem).partition(": ")[2] for problem in caught.value.problems]


def in_folder(folder: Path, text: str = FROM_FILE, csv: str = CSV) -> Path:
    (folder / "strut.csv").write_bytes(csv.encode())
    path = folder / "model.toml"
    path.write_bytes((DRIVEN_MASS + text).encode())
    return path


def strut(model: Model) -> Map:
    found = model.elements["strut"].map
    assert found is not None
    return found


def test_a_grid_is_read_in_its_units() -> None:
    found = strut(parse_model(DRIVEN_MASS + STRUT))
    assert (found.x, found.y) == ((-40.0, 0.0, 40.0), (-0.5, 0.5))
    assert found.values == ((-900.0, 400.0), (-300.5, 250.0), (-800.0, 500.0))
    assert (found.extrapolation, found.owned, found.smooth) == ("line", True, False)
    assert float(found.surface(0.04, 0.5)) == pytest.approx(500.0)
    assert float(found.surface(-0.02, 0.0)) == pytest.approx((-900 - 300.5 + 400 + 250) / 4)


def test_a_map_of_the_model_is_found_by_its_name() -> None:
    model = parse_model(DRIVEN_MASS + NAMED)
    assert strut(model) is model.maps[0]
    assert not model.maps[0].owned


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_file_beside_the_model_gives_the_same_grid(separator: str, tmp_path: Path) -> None:
    csv = "\ufeff" + CSV.replace("\n", "\r\n").replace(",", separator)
    found = strut(read_model(in_folder(tmp_path, csv=csv)))
    other = strut(parse_model(DRIVEN_MASS + STRUT))
    assert (found.x, found.y, found.values) == (other.x, other.y, other.values)
    assert found.sha256 == hashlib.sha256((tmp_path / "strut.csv").read_bytes()).hexdigest()


@pytest.mark.parametrize("text", [STRUT, NAMED, FROM_FILE], ids=["own", "named", "file"])
def test_what_is_written_reads_back(text: str, tmp_path: Path) -> None:
    model = read_model(in_folder(tmp_path, text + 'about = "measured at 20 °C"\nscale = 1.5\n'))
    bare = replace(model, text="")
    again = parse_model(render(bare), str(tmp_path / "model.toml"))
    assert replace(again, text="") == bare
    assert changes(model, again) == ()


def test_an_appended_element_brings_its_grid() -> None:
    model = parse_model(DRIVEN_MASS + STRUT + 'extrapolation = "hold"\n')
    corrected = append_elements(parse_model(DRIVEN_MASS), [model.elements["strut"]])
    assert corrected.text.startswith(DRIVEN_MASS)
    assert strut(corrected) == strut(model)


def test_writing_elsewhere_takes_the_file_along(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    model = read_model(in_folder(tmp_path))
    target = tmp_path / "there" / "model.toml"
    write_model(model, target)
    assert strut(read_model(target)) == strut(model)
    assert (tmp_path / "there" / "strut.csv").read_bytes() == (tmp_path / "strut.csv").read_bytes()
    (tmp_path / "there" / "strut.csv").write_text(CSV.replace("-900", "-800"))
    with pytest.raises(InputError, match="holds other points than the map"):
        write_model(model, target)


def test_files_of_maps_stand_in_the_manifest_with_their_hashes(tmp_path: Path) -> None:
    digest = hashlib.sha256(CSV.encode()).hexdigest()
    stated = table_hashes(read_model(in_folder(tmp_path)))
    assert stated == {"maps": [{"file": "strut.csv", "sha256": digest}]}


def test_a_difference_of_values_is_one_sentence() -> None:
    first = parse_model(DRIVEN_MASS + STRUT)
    second = parse_model(DRIVEN_MASS + STRUT.replace("500", "501"))
    (said,) = changes(first, second)
    spans = "grid 3 from -40 to 40 mm by 2 from -0.5 to 0.5 m/s, in N, hash "
    assert said.startswith(f"~ element strut: {spans}")
    named = parse_model(DRIVEN_MASS + NAMED)
    (more,) = changes(named, parse_model(DRIVEN_MASS + NAMED.replace('"hold"', '"line"')))
    assert more == "~ map valve: extrapolation hold -> line"


def test_the_name_of_a_map_is_no_number_that_gets_a_factor() -> None:
    text = NAMED.replace("valve", "k") + (
        '[elements.more]\nkind = "law"\non = "x"\nforce = "k*x + map(k, x, x\')"\n'
    )
    model = written_with_factor(parse_model(DRIVEN_MASS + text), "k", "2")
    assert model.elements["more"].value("force").text == "(k*2)*x + map(k, x, x')"
    assert 'map = "k"' in model.text
    assert strut(model).name == "k"


FAULTS = {
    "nothing": (
        "x = [-40, 0, 40]\ny = [-0.5, 0.5]\nvalues = [[-900, 400], [-300.5, 250], [-800, 500]]\n",
        "",
        [
            "elements.strut: 'x' and 'y' and 'values' are missing: x and y with a row of 'values' "
            "for each x, or 'file' with such a grid"
        ],
    ),
    "misspelt": (
        "values =",
        "valeus =",
        ["elements.strut.valeus: 'valeus' is not a key here; did you mean 'values'?"],
    ),
    "no units": (
        'units = ["mm", "m/s", "N"]\n',
        "",
        [
            'elements.strut: the units are missing: units = ["mm", "m/s", "N"], of x, y and value',
        ],
    ),
    "two units": (
        '"mm", "m/s", "N"',
        '"m/s", "N"',
        ["elements.strut.units: must be a list of three texts, of x, y and value, not a list of 2"],
    ),
    "no unit": ("m/s", "mn/q", ["elements.strut.units: 'mn' is not a known unit"]),
    "units of another place": (
        '"mm", "m/s", "N"',
        '"m/s", "mm", "N*m"',
        [
            "elements.strut.units: x of the map is m/s, needs m",
            "elements.strut.units: y of the map is mm, needs m/s",
            "elements.strut.units: the value of the map is N*m, needs N",
        ],
    ),
    "rows of unequal length": (
        "[-900, 400], [-300.5, 250]",
        "[-900, 400, 1], [-300.5]",
        [
            "elements.strut.values: row 1 holds 3 values; y has 2 places",
            "elements.strut.values: row 2 holds 1 values; y has 2 places",
        ],
    ),
    "a row too few": (
        "[-900, 400], ",
        "",
        ["elements.strut.values: must be 3 rows, one for each x, not a list of 2"],
    ),
    "no rows": (
        "[[-900, 400], [-300.5, 250], [-800, 500]]",
        "[1, [nan, 2], [3, true]]",
        [
            "elements.strut.values: row 1 must be a list of 2 numbers, not the number 1",
            "elements.strut.values: row 2 holds the number nan, not a finite number",
            "elements.strut.values: row 3 holds the truth value true, not a finite number",
        ],
    ),
    "no list": (
        "[-40, 0, 40]",
        '"here"',
        ["elements.strut.x: must be a list of numbers, not the text 'here'"],
    ),
    "places that are none": (
        "[-0.5, 0.5]",
        "[inf, 'a']",
        [
            "elements.strut.y: place 1 is inf, not a finite number",
            "elements.strut.y: place 2 is the text 'a', not a finite number",
        ],
    ),
    "order": (
        "[-40, 0, 40]",
        "[0, 0, -40]",
        [
            "elements.strut.x: place 2 x = 0 is stated twice",
            "elements.strut.x: place 3 x = -40 comes after 0; x must increase",
        ],
    ),
    "one place": (
        "[-0.5, 0.5]",
        "[0.5]",
        ["elements.strut.y: holds one place of y; a map has two at least"],
    ),
    "no place": ("[-0.5, 0.5]", "[]", ["elements.strut.y: holds no place of y; a map has two at"]),
    "too many places": (
        "[-40, 0, 40]",
        f"{list(range(MAP_PLACES + 1))}",
        [f"elements.strut.x: holds {MAP_PLACES + 1} places of x; a map has at most {MAP_PLACES}"],
    ),
    "no measurement": (
        "500]]",
        "1e101]]",
        ["elements.strut.values: value = 1e+101 is no measurement; at most 1e+100 in SI"],
    ),
    "too close": (
        "[-40, 0, 40]",
        "[-40, 0, 5e-324]",
        ["elements.strut.values: holds places so close to each other that no slope is finite"],
    ),
    "word": (
        "x = [",
        'extrapolation = "holds"\nx = [',
        ["elements.strut.extrapolation: must be line or hold, not 'holds'; did you mean 'hold'?"],
    ),
    "both": (
        "x = [",
        'file = "strut.csv"\nx = [',
        ["elements.strut: states 'x' and 'file'; the grid of a map stands in one place"],
    ),
    "own and named": (
        "x = [-40, 0, 40]\n",
        'map = "valve"\n',
        [
            f"elements.strut.{key}: '{key}' belongs to the map, which [maps] states by 'map'"
            for key in ("units", "y", "values")
        ],
    ),
    "at a point": (
        'on = "x"',
        'at = "p"',
        ["elements.strut.at: kind 'map' cannot stand 'at'; it needs 'on' or 'between'"],
    ),
    "the key of a curve": (
        "x = [",
        'over = "rate"\nx = [',
        ["elements.strut.over: 'over' is not a key here"],
    ),
}


@pytest.mark.parametrize(("old", "new", "said"), FAULTS.values(), ids=FAULTS)
def test_every_fault_is_named(old: str, new: str, said: list[str]) -> None:
    assert old in STRUT
    found = problems(STRUT.replace(old, new))
    assert len(found) == len(said), found
    for sentence, begin in zip(found, said, strict=True):
        assert sentence.startswith(begin)


def test_names_of_maps_are_looked_for_among_maps() -> None:
    unknown = NAMED.replace('map = "valve"', 'map = "valves"')
    assert problems(unknown) == [
        "elements.strut.map: 'valves' is not a known map; did you mean 'valve'?"
    ]
    curve = '[curves.valve]\nunits = ["mm", "N"]\npoints = [[0, 0], [1, 1]]\n'
    stated = '[elements.strut]\nkind = "map"\non = "x"\nmap = "valve"\n'
    assert problems(curve + stated) == [
        "elements.strut.map: 'valve' is not a known map; state it under [maps]"
    ]


def test_a_map_that_cannot_be_read_is_reported_once() -> None:
    law = '[elements.more]\nkind = "law"\non = "x"\nforce = "map(valve, x, x\')"\n'
    found = problems(NAMED.replace("-300.5, 250", "-300.5") + law)
    assert found == ["maps.valve.values: row 2 holds 1 values; y has 2 places"]


EXPRESSIONS = {
    "unknown": ("map(valva, x, x')", "'valva' is not a known map; did you mean 'valve'?"),
    "of a curve": ("curve(valve, x)", "'valve' is not a known curve; state it under [curves]"),
    "units": ("map(valve, x', x)", "the map 'valve' takes mm, but 'x'' is in m/s"),
    "result": ("x*map(valve, x, x')", "is m*N, needs N"),
    "accelerations": ("map(valve, x, x'')", "x'' is an acceleration"),
}


@pytest.mark.parametrize(("force", "said"), EXPRESSIONS.values(), ids=EXPRESSIONS)
def test_a_fault_in_an_expression_is_named(force: str, said: str) -> None:
    law = f'[elements.more]\nkind = "law"\non = "x"\nforce = "{force}"\n'
    (found,) = problems(NAMED + law)
    assert said in found.replace("N*m", "m*N")


def test_where_a_speed_follows_a_map_has_kinks() -> None:
    grid = (
        '[maps.cam]\nunits = ["m", "s", "m"]\nx = [0, 1]\ny = [0, 1]\nvalues = [[0, 1], [2, 3]]\n'
    )
    point = '[points]\ntip = ["map(cam, x, t)", "0"]\n'
    assert problems(grid + point) == [
        "points.tip: 'map(cam, x, t)' has no smooth speed, which a position needs; a map has a kink"
        " at each place of its grid; use curves, which may be smooth"
    ]
    parse_model(DRIVEN_MASS + grid + point.replace("x, t", "1 m, 1 s"))  # nothing moves in it


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("../strut.csv", "must be a file beside the model file or below it"),
        ("/strut.csv", "must be a file beside the model file or below it"),
        ("strut.toml", "is no name of a file of points"),
        ("simulation.csv", "is no name of a file of points"),
        ("other.csv", "there is no such file"),
    ],
)
def test_a_file_that_is_none_is_refused(name: str, said: str, tmp_path: Path) -> None:
    path = in_folder(tmp_path, FROM_FILE.replace("strut.csv", name))
    with pytest.raises(InputError, match=said) as caught:
        read_model(path)
    assert len(caught.value.problems) == 1


def test_a_link_out_of_the_folder_is_refused(tmp_path: Path) -> None:
    home, other = tmp_path / "home", tmp_path / "other"
    home.mkdir()
    other.mkdir()
    (other / "strut.csv").write_text(CSV)
    (home / "strut.csv").symlink_to(other / "strut.csv")
    (home / "model.toml").write_text(DRIVEN_MASS + FROM_FILE)
    with pytest.raises(InputError, match="leads out of the folder of the model file"):
        read_model(home / "model.toml")


def test_a_text_without_a_file_has_nothing_beside_it() -> None:
    with pytest.raises(InputError, match="lies beside a model file, and this text is none"):
        parse_model(DRIVEN_MASS + FROM_FILE)


FILES = {
    "large": ("#" * (CURVE_BYTES + 1), ["is larger than 0.1 MB"]),
    "empty": ("# nothing\n\n", ["strut.csv: holds no line of numbers"]),
    "unequal rows": (
        CSV.replace("0,-300.5,250", "0,-300.5").replace("40,-800,500", "40,-800,500,1"),
        [
            "strut.csv:4: has 2 cells; the first line has 3",
            "strut.csv:6: has 4 cells; the first line has 3",
        ],
    ),
    "no numbers": (
        CSV.replace("400", "nan").replace("0.5\n", "x\n").replace("250", ""),
        [
            "strut.csv:1: 'x' is not a number",
            "strut.csv:2: 'nan' is not a number",
            "strut.csv:4: a cell is empty",
        ],
    ),
    "decimal commas": (
        CSV.replace(",", ";").replace("300.5", "300,5"),
        ["strut.csv:4: '-300,5' is not a number; write a decimal point"],
    ),
    "order": (
        CSV.replace("-0.5,0.5", "0.5,-0.5") + "40,1,1\n",
        [
            "strut.csv:7: x = 40 is stated twice",
            "strut.csv:1: y = -0.5 comes after 0.5; y must increase",
        ],
    ),
    "one row": (CSV[: CSV.index("#")], ["holds one place of x; a map has two at least"]),
    "head alone": (CSV[: CSV.index("-40")], ["holds no place of x; a map has two at least"]),
    "wide": (
        f"x,{','.join(map(str, range(60)))}\n" + f"1{',0' * 60}\n2{',0' * 60}\n",
        [f"holds 60 places of y; a map has at most {MAP_PLACES}: thin it out"],
    ),
    "strange": (CSV.replace("-900", "-9\x1b00"), ["strut.csv:2: "]),
}


@pytest.mark.parametrize(("csv", "said"), FILES.values(), ids=FILES)
def test_every_fault_of_a_file_is_named(csv: str, said: list[str], tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read_model(in_folder(tmp_path, csv=csv))
    found = [str(problem) for problem in caught.value.problems]
    assert len(found) == len(said), found
    for sentence, part in zip(found, said, strict=True):
        assert part in sentence
        assert "\x1b" not in sentence


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = in_folder(tmp_path)
    (tmp_path / "strut.csv").write_bytes(b"x,1,2\n\xff,1,2\n")
    with pytest.raises(InputError, match="is not UTF-8 text"):
        read_model(path)

"""``symhyb new`` as a person calls it: by options, and by questions."""

import io
import re
import sys
from pathlib import Path

import pytest
from command import Call

from symhyb.drafting.templates import TEMPLATES
from symhyb.model.read import read_model

ROOT = Path(__file__).parents[2]
TRAIN = ROOT / "studies" / "oscillator" / "train.csv"

LOGGER = """time [ms],Kraft (N),pos mm,acc [g],speed [mm/s],temp [degC],gain
0,0.1,0.0,0.01,1,20,3
1,0.2,0.1,0.02,2,20,3
2,0.3,0.2,0.01,3,20,3
"""


@pytest.mark.parametrize("template", TEMPLATES)
def test_every_template_passes_check_and_marks_its_guesses(
    symhyb: Call, tmp_path: Path, template: str
) -> None:
    target = tmp_path / "new" / "model.toml"
    done = symhyb("new", "--template", template, "-o", target)
    assert done.status == 0, done.err
    assert symhyb("check", target).status == 0
    text = target.read_text(encoding="utf-8")
    section = text.partition("[parameters]")[2].partition("\n[")[0].strip().splitlines()[1:]
    guessed = [line for line in section if not line.startswith("g ")]
    assert all(line.endswith("# guessed: put in your own") for line in guessed)
    assert f"{len(guessed)} guesses in it are marked" in done.out


def test_columns_become_sensors_and_inputs_with_what_is_guessed(
    symhyb: Call, tmp_path: Path
) -> None:
    recording, target = tmp_path / "log.csv", tmp_path / "m.toml"
    recording.write_text(LOGGER, encoding="utf-8")
    options = ("--template", "oscillator", "--set", "m=2.5", "--set", "k=80±4", "--set", "d=1e-2")
    done = symhyb("new", *options, "--from", recording, "-o", target)
    assert done.status == 0, done.err
    text = target.read_text(encoding="utf-8")
    model = read_model(target)
    sensors = {sensor.name: (sensor.measures.text, sensor.unit.text) for sensor in model.sensors}
    assert sensors == {
        "pos_mm": ("x", "m"),
        "acc": ("x''", "m/s^2"),
        "speed": ("x'", "mm/s"),
    }
    assert "guessed: that it measures x, and its unit" in text
    assert '# column "temp [degC]" is not used' in text
    assert "time" not in sensors
    assert '#   f is column "Kraft (N)"' in text
    assert "--map 'f=Kraft (N)'" in done.out
    (k,) = [item for item in model.parameters if item.name == "k"]
    assert (k.value, k.sd) == (80.0, 4.0)
    assert "guessed" not in next(line for line in text.splitlines() if line.startswith("k ="))


def test_what_was_written_reads_its_recording(symhyb: Call, tmp_path: Path) -> None:
    target = tmp_path / "m.toml"
    done = symhyb("new", "--template", "oscillator", "--from", TRAIN, "-o", target)
    assert done.status == 0, done.err
    done = symhyb("look", TRAIN, "--model", target, "--end", "5", "--json")
    assert done.status == 0, done.err


def test_columns_are_what_options_say(symhyb: Call, tmp_path: Path) -> None:
    recording, target = tmp_path / "log.csv", tmp_path / "m.toml"
    recording.write_text(LOGGER, encoding="utf-8")
    said = ["pos mm=x [mm]", "acc=-", "speed=-", "gain=-", "temp=-", "Kraft=input f"]
    columns = [part for one in said for part in ("--column", one)]
    numbers = ("--set", "m=1", "--set", "k=2", "--set", "d=3")
    options = ("--template", "oscillator", *numbers, "--from", recording, *columns)
    done = symhyb("new", *options, "-o", target, "--title", 'My "rig"')
    assert done.status == 0, done.err
    assert 'My "rig"; nothing is guessed' in done.out
    (sensor,) = read_model(target).sensors
    assert (sensor.measures.text, sensor.unit.text) == ("x", "mm")


def test_bodies_in_a_line(symhyb: Call, tmp_path: Path) -> None:
    target = tmp_path / "m.toml"
    line = ("--coordinate", "a [mm]", "--coordinate", "b [mm]", "--coordinate", "turn [deg]")
    done = symhyb("new", *line, "--set", "k_b=0", "--set", "d_b=0", "-o", target)
    assert done.status == 0, done.err
    assert symhyb("check", target).status == 0
    model = read_model(target)
    names = {element.name for element in model.elements}
    assert {"spring_a", "spring_a_b", "damper_turn", "drive_turn"} <= names
    assert not {"spring_b", "damper_b", "spring_b_turn"} & names
    assert "k_b" not in {item.name for item in model.parameters}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "say what to begin with"),
        (["--template", "oscilator"], "did you mean 'oscillator'"),
        (["--template", "drive", "--coordinate", "x"], "not both"),
        (["--coordinate", "x [kg]"], "neither a length nor an angle"),
        (["--coordinate", "3x"], "write it as NAME"),
        (["--template", "drive", "--set", "kk=1"], "did you mean 'k'"),
        (["--template", "drive", "--set", "k=a lot"], "NAME=NUMBER"),
        (["--template", "drive", "--set", "k=1±-2"], "NAME=NUMBER"),
        (["--template", "drive", "--column", "a=x"], "--from"),
        (["--template", "drive", "--from", "nowhere.csv"], "does not exist"),
        (["--template", "oscillator", "--from", TRAIN, "--column", "sped=x'"], "'speed'"),
        (["--template", "oscillator", "--from", TRAIN, "--column", "f=input g"], "no input 'g'"),
        (["--template", "oscillator", "--from", TRAIN, "--column", "speed=v"], "'v'"),
    ],
)
def test_orders_that_cannot_be_carried_out(
    symhyb: Call, tmp_path: Path, options: list[str], said: str
) -> None:
    done = symhyb("new", *options, "-o", tmp_path / "m.toml")
    assert (done.status, done.out) == (2, "")
    assert said in done.err
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_there_stays(symhyb: Call, tmp_path: Path) -> None:
    target = tmp_path / "m.toml"
    target.write_text("mine", encoding="utf-8")
    done = symhyb("new", "--template", "drive", "-o", target)
    assert (done.status, target.read_text(encoding="utf-8")) == (2, "mine")
    assert "--force replaces it" in done.err
    assert symhyb("new", "--template", "drive", "-o", target, "--force").status == 0
    assert target.read_text(encoding="utf-8") != "mine"


def test_the_list_names_every_template(symhyb: Call) -> None:
    out = symhyb("new", "--list").out
    assert [line.split()[0] for line in out.splitlines()] == list(TEMPLATES)


def test_questions_lead_to_the_same_file(
    symhyb: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wrong answers are said and asked again; an empty one takes the guess."""
    answers = [
        *("oscilator", "oscillator", "Shaker table", "nowhere.csv", str(TRAIN)),
        *("1.2", "much", "80 ± 4", ""),  # m, k (wrong, then right), d
        *("input g", "input f", "x", "mm", "x'", "mm/s"),  # the three columns
    ]
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n".join([*answers, ""])))
    target = tmp_path / "asked.toml"
    done = symhyb("new", "--ask", "-o", target)
    assert done.status == 0, done.err
    for said in ("there is no 'oscilator'", "nowhere.csv: does not exist", "no input 'g'"):
        assert said in done.out
    model = read_model(target)
    assert model.title == "Shaker table"
    values = {item.name: (item.value, item.sd) for item in model.parameters}
    assert values == {"m": (1.2, None), "k": (80.0, 4.0), "d": (0.5, 0.2)}
    units = {sensor.name: sensor.unit.text for sensor in model.sensors}
    assert units == {"position": "mm", "speed": "mm/s"}
    text = target.read_text(encoding="utf-8")
    assert [line[:3] for line in text.splitlines() if "# guessed" in line] == ["d ="]
    assert re.search(r"1 guesses in it are marked|1 guess", done.out)


def test_questions_for_bodies_in_a_line_end_where_the_answers_end(
    symhyb: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = ["line", "u [kg]", "u [m]", "", "", "", "3", "", ""]
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n".join([*answers, ""])))
    target = tmp_path / "m.toml"
    done = symhyb("new", "--ask", "-o", target)
    assert done.status == 0, done.err
    assert "neither a length nor an angle" in done.out
    assert [c.name for c in read_model(target).coordinates] == ["u"]
    monkeypatch.setattr(sys, "stdin", io.StringIO("line\n"))
    done = symhyb("new", "--ask", "-o", tmp_path / "other.toml")
    assert done.status == 130 or done.status == 1
    assert not (tmp_path / "other.toml").exists()

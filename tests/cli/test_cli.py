"""The command line: every verb, every exit status, bad input without half-written output."""

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from command import Call, Done
from fakes import NOTHING, Fake, fake_diagnosis, friction

from symhyb.errors import NumericsError
from symhyb.model.read import read_model

ROOT = Path(__file__).parents[2]
OSCILLATOR = str(ROOT / "models" / "oscillator.toml")
TRAIN, HOLDOUT = (str(ROOT / "studies" / "oscillator" / f"{n}.csv") for n in ("train", "holdout"))
SCHEMA = ROOT / "symhyb" / "report" / "diagnosis.schema.json"
VERBS = (
    "new",
    "check",
    "draw",
    "equations",
    "simulate",
    "look",
    "scan",
    "compare",
    "fit",
    "diagnose",
    "doctor",
    "learn",
    "diff",
    "run",
    "results",
    "compare-studies",
    "fleet",
    "next",
    "watch",
    "view",
    "import",
    "data list",
    "data show",
    "data fetch",
)
FILES = {"corrected.toml", "diagnosis.json", "report.html", "simulation.csv"}

FREE = """\
symhyb = 1
title = "a mass on a spring"
[coordinates]
x = { unit = "mm", start = 20.0 }
[parameters]
m = { value = 2.0, unit = "kg" }
k = { value = 50.0, unit = "N/m" }
[inputs]
f = { unit = "N" }
[bodies.mass]
mass = "m"
at = ["x", "0"]
[elements.spring]
kind = "spring"
on = "x"
stiffness = "k"
[elements.push]
kind = "force"
on = "x"
force = "f"
[sensors]
laser = { measures = "x", unit = "m" }
"""

FIVE_FAULTS = """\
symhyb = 1
title = "five faults"
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 1.0, unit = "kgg" }
k = { value = 1.0, unit = "N/m" }
[bodies.mass]
mass = "m"
at = ["x", "0"]
[elements.spring]
kind = "sprng"
on = "x"
stiffness = "k"
[elements.damper]
kind = "damper"
on = "y"
damping = "k"
[elements.second]
kind = "spring"
on = "x"
stiffness = "kk"
[sensors]
laser = { measures = "x", unit = "s" }
"""


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> Fake:
    return fake_diagnosis(monkeypatch)


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str, str | bytes], Path]:
    def write_file(name: str, content: str | bytes) -> Path:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write_file


Write = Callable[[str, str | bytes], Path]


def rows(change: Callable[[np.ndarray], None] = lambda table: None, header: str = "") -> str:
    """A recording of the oscillator as text: t, f, position, speed; ``change`` spoils the table."""
    table = np.loadtxt(TRAIN, delimiter=",", skiprows=1)[:400]
    change(table)
    lines = [",".join("" if np.isnan(x) else repr(float(x)) for x in row) for row in table]
    return "\n".join([header or "t,f,position,speed", *lines]) + "\n"


# --- help ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("verb", VERBS)
def test_each_verb_has_one_page_of_help_with_an_example(symhyb: Call, verb: str) -> None:
    done = symhyb(*verb.split(), "--help")
    assert done.status == 0
    assert symhyb(*verb.split(), "-h").out == done.out
    assert f"Example:\n    symhyb {verb} " in done.out or f"symhyb {verb}\n" in done.out
    assert len(done.out.splitlines()) <= 45
    assert all(len(line) <= 90 for line in done.out.splitlines())


def test_the_version_is_that_of_the_package(symhyb: Call) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert symhyb("--version").out == f"symhyb {project['version']}\n"


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash")
@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("symhyb di", {"diagnose", "diff"}),
        ("symhyb data f", {"fetch"}),
        ("symhyb diagnose --ho", {"--holdout"}),
    ],
)
def test_bash_completes_verbs_and_options(tmp_path: Path, line: str, offered: set[str]) -> None:
    """As bash does it: the script that --show-completion prints, and what it offers for a line."""
    command = tmp_path / "symhyb"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m symhyb "$@"\n', encoding="utf-8")
    command.chmod(0o755)
    script = (
        "source <(symhyb --show-completion bash)\n"
        f"COMP_WORDS=({line}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))\n"
        '_symhyb_completion symhyb; printf "%s\\n" "${COMPREPLY[@]}"; complete -p symhyb\n'
    )
    path = f"{tmp_path}{os.pathsep}{os.environ['PATH']}"
    known = {**os.environ, "PATH": path, "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    done = subprocess.run(
        ["bash", "--norc", "-c", script], capture_output=True, text=True, env=known, cwd=ROOT
    )
    *words, registered = done.stdout.splitlines()
    assert set(words) == offered, done.stderr
    assert "-o default" in registered  # and names of files


def test_python_runs_the_package_as_the_command() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "symhyb", "check", OSCILLATOR],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stderr


def test_help_lists_every_verb_and_answers_at_once() -> None:
    code = (
        "import atexit, sys, time; from symhyb.cli.app import main; "
        "atexit.register(lambda: print(time.process_time(), file=sys.stderr)); main()"
    )

    def computed() -> float:
        """Seconds of the whole process, whatever else the machine does."""
        done = subprocess.run(
            [sys.executable, "-c", code, "--help"], capture_output=True, text=True, check=True
        )
        assert all(f"\n  {verb} " in done.stdout for verb in {v.split()[0] for v in VERBS})
        return float(done.stderr)

    assert min(computed() for _ in range(5)) < 0.5


def test_help_loads_no_numerics() -> None:
    """What takes time to load is loaded where it is used, whatever the machine."""
    code = (
        "import atexit, sys; from symhyb.cli.app import main; "
        "atexit.register(lambda: print(*sys.modules, file=sys.stderr)); main()"
    )
    command = [sys.executable, "-c", code, "--help"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert {"numpy", "sympy", "casadi", "symhyb.data"}.isdisjoint(done.stderr.split())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["chek", "x"], "No such command"),
        (["check"], "Missing argument"),
        (["check", OSCILLATOR, "--jsn"], "No such option"),
        (["simulate", OSCILLATOR, "--end", "soon", "-o", "run.csv"], "'--end'"),
        (["diagnose", OSCILLATOR, TRAIN], "Missing option"),
    ],
)
def test_misuse_ends_with_status_2(symhyb: Call, arguments: list[str], said: str) -> None:
    done = symhyb(*arguments)
    assert done.status == 2
    assert said in done.err
    assert done.out == ""


# --- check, equations, diff ---------------------------------------------------------------------


@pytest.mark.parametrize("model", sorted(ROOT.glob("models/*.toml")), ids=lambda path: path.stem)
def test_check_accepts_the_models_that_are_shipped(symhyb: Call, model: Path) -> None:
    done = symhyb("check", model)
    assert done.status == 0
    assert done.out.startswith(f"{model}: no problem found\n")
    assert done.err == ""


def test_check_prints_json(symhyb: Call) -> None:
    facts = json.loads(symhyb("check", OSCILLATOR, "--json").out)
    assert facts["ok"] is True
    assert facts["parameters"]["c"] == {"value": 100.0, "sd": None, "unit": "N/m^3"}
    assert facts["elements"]["spring"] == {"kind": "spring", "place": "on q"}


def test_check_reports_five_different_faults_at_once(symhyb: Call, write: Write) -> None:
    path = write("five.toml", FIVE_FAULTS)
    done = symhyb("check", path)
    assert done.status == 2
    lines = done.err.splitlines()
    assert all(line.startswith(f"{path}:") for line in lines)
    numbers = [int(line.removeprefix(f"{path}:").split(":")[0]) for line in lines]
    assert numbers == sorted(numbers)
    for place, said in (
        (":6: parameters.m.unit: ", "did you mean 'kg'"),
        (":12: elements.spring.kind: ", "did you mean 'spring'"),
        (":17: elements.damper.on: ", "'y'"),
        (":22: elements.second.stiffness: ", "did you mean 'k'"),
        (":24: sensors.laser", ""),
    ):
        assert [line for line in lines if place in line and said in line], place
    problems = json.loads(symhyb("check", path, "--json").out)["problems"]
    assert [problem["line"] for problem in problems] == numbers


def test_check_finds_a_singular_mass_matrix(symhyb: Call, write: Write) -> None:
    two = FREE.replace("[parameters]", 'y = { unit = "m" }\n[parameters]')
    done = symhyb("check", write("singular.toml", two))
    assert done.status == 2
    assert "mass matrix is singular" in done.err
    assert "y" in done.err


def test_a_model_that_is_not_there(symhyb: Call) -> None:
    done = symhyb("check", "nowhere.toml")
    assert (done.status, done.out) == (2, "")
    assert done.err == "nowhere.toml: there is no such file\n"


def test_equations_in_text_and_latex(symhyb: Call) -> None:
    plain, latex = symhyb("equations", OSCILLATOR), symhyb("equations", OSCILLATOR, "--latex")
    assert plain.status == latex.status == 0
    assert "elements.spring" in plain.out
    assert r"\ddot" in latex.out


def test_diff_of_a_model_with_itself_and_with_another(symhyb: Call, write: Write) -> None:
    other = write("other.toml", Path(OSCILLATOR).read_text().replace("100.0", "110.0"))
    assert symhyb("diff", OSCILLATOR, OSCILLATOR).out == "The two models say the same.\n"
    done = symhyb("diff", OSCILLATOR, other)
    assert done.status == 0
    assert done.out.startswith("~ parameter c: 100 -> 110 N/m^3\n")


def test_a_pipe_that_does_not_know_every_letter_still_gets_its_sentences() -> None:
    model = str(ROOT / "models" / "cartpole.toml")
    done = subprocess.run(
        [sys.executable, "-c", "from symhyb.cli.app import main; main()", "check", model],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"g = 9.81 m/s? (held)" in done.stdout


# --- simulate -----------------------------------------------------------------------------------


def table(path: Path) -> dict[str, np.ndarray]:
    header, *lines = path.read_text().splitlines()
    columns = np.array([[float(cell) for cell in line.split(",")] for line in lines]).T
    return dict(zip(header.split(","), columns, strict=True))


def test_simulate_without_inputs_is_the_free_oscillation(
    symhyb: Call, write: Write, tmp_path: Path
) -> None:
    run = tmp_path / "new" / "run.csv"
    done = symhyb("simulate", write("free.toml", FREE), "--end", "4", "--step", "0.1", "-o", run)
    assert (done.status, done.err) == (0, "")
    columns = table(run)
    t = columns["t [s]"]
    assert t == pytest.approx(np.arange(41) / 10)
    assert columns["laser [m]"] == pytest.approx(0.02 * np.cos(5 * t), abs=1e-7)
    assert columns["x [mm]"] == pytest.approx(20 * np.cos(5 * t), abs=1e-4)
    assert columns["x' [mm/s]"] == pytest.approx(-100 * np.sin(5 * t), abs=1e-3)
    assert columns["f [N]"] == pytest.approx(0)
    assert [path.name for path in run.parent.iterdir()] == ["run.csv"]
    assert "41 rows from 0 to 4 s, by " in done.out
    assert "Runge-Kutta" in done.out or "CVODES (Adams)" in done.out


def test_simulate_with_recorded_inputs_covers_the_recording(
    symhyb: Call, write: Write, tmp_path: Path
) -> None:
    """A constant force on a mass at rest on a spring: x = f/k·(1 − cos ωt)."""
    t = 2 + np.arange(200) / 100
    text = "\n".join(["time,u", *(f"{x:.2f},1.5" for x in t)]) + "\n"
    recording = write("input.csv", text)
    model, run = write("free.toml", FREE.replace("20.0", "0.0")), tmp_path / "run.csv"
    maps = ["--map", "t=time", "--map", "f=2*u", "--map", "laser=nothing"]
    done = symhyb("simulate", model, "--input", recording, *maps, "-o", run)
    assert done.status == 0, done.err
    columns = table(run)
    assert columns["t [s]"] == pytest.approx(t)
    wave = 3 / 50 * (1 - np.cos(5 * (t - 2)))
    assert columns["laser [m]"] == pytest.approx(wave, abs=1e-6)
    assert "input f is constant" in done.err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--input", TRAIN, "--end", "41"], "the inputs stop at 40 s"),
        ([], "--end"),
        (["--end", "-1"], "must come after the start"),
        (["--end", "1", "--step", "2"], "does not fit"),
        (["--end", "1", "--step", "1e-9"], "rows"),
        (["--input", "nowhere.csv"], "does not exist"),
        (["--input", TRAIN, "--map", "g=f"], "has no input or sensor 'g'"),
    ],
)
def test_simulate_refuses_what_makes_no_run(
    symhyb: Call, tmp_path: Path, options: list[str], said: str
) -> None:
    done = symhyb("simulate", OSCILLATOR, *options, "-o", tmp_path / "new" / "run.csv")
    assert done.status == 2
    assert said in done.err
    assert list(tmp_path.iterdir()) == []


def test_simulate_says_why_the_numerics_failed(symhyb: Call, write: Write, tmp_path: Path) -> None:
    """x'' = +c x³ from 1 m reaches infinity in finite time."""
    text = FREE.replace("stiffness", "cubic").replace('50.0, unit = "N/m"', '-5e3, unit = "N/m^3"')
    model = write("blow.toml", text.replace("20.0", "1000.0"))
    done = symhyb("simulate", model, "--end", "10", "-o", tmp_path / "run.csv")
    assert done.status == 3
    assert done.err.splitlines()[-1].startswith("the numerics failed: CVODES")
    assert list(tmp_path.iterdir()) == [model]


def test_simulate_does_not_overwrite_a_folder(symhyb: Call, tmp_path: Path) -> None:
    done = symhyb("simulate", OSCILLATOR, "--end", "1", "-o", tmp_path)
    assert (done.status, done.err) == (2, f"{tmp_path}: is a folder; name a file in it\n")


RUBBED = (
    FREE
    + """
[elements.rail]
kind = "friction"
on = "x"
coulomb = "R"
[elements.rail.parameters]
R = { value = 0.3, unit = "N" }
"""
)


def test_simulate_exactly_tells_its_events(symhyb: Call, write: Write, tmp_path: Path) -> None:
    """2 kg on 50 N/m from 20 mm under 0.3 N: two half swings of amplitude 14 and 2 mm, then rest
    at −4 mm to the last digit."""
    run, events = tmp_path / "out" / "run.csv", tmp_path / "told" / "events.csv"
    model = write("rubbed.toml", RUBBED)
    done = symhyb("simulate", model, "--end", "4", "--step", "0.1", "-o", run, "--events", events)
    assert (done.status, done.err) == (0, "")
    header, *rows = events.read_text().splitlines()
    assert header == "t [s],element,transition"
    found = [row.split(",") for row in rows]
    half = np.pi / 5
    assert [row[2] for row in found] == ["slides +", "sticks"]
    assert [float(row[0]) for row in found] == pytest.approx([half, 2 * half], abs=1e-9)
    assert "2 transitions located; rail slides + 1×, sticks 1×" in done.out
    place = table(run)["x [mm]"]
    assert set(place[table(run)["t [s]"] > 2 * half]) == {place[-1]}
    assert place[-1] == pytest.approx(-4.0, abs=1e-6)


def test_simulate_exactly_locates_what_the_file_writes_as_a_jump(
    symhyb: Call, write: Write, tmp_path: Path
) -> None:
    text = RUBBED.replace('kind = "friction"', 'kind = "law"').replace(
        'coulomb = "R"', 'force = "-R*sign(x\')"'
    )
    model, run = write("hand.toml", text), tmp_path / "run.csv"
    done = symhyb("simulate", model, "--end", "0.3", "--step", "0.1", "-o", run, "--exact")
    assert done.status == 0, done.err
    assert "stay" not in done.err
    assert "0 transitions located" in done.out


def test_simulate_needs_two_files_for_two_tables(symhyb: Call, tmp_path: Path) -> None:
    run = tmp_path / "run.csv"
    done = symhyb("simulate", OSCILLATOR, "--end", "1", "-o", run, "--events", run)
    assert done.status == 2
    assert "name another for the events" in done.err


# --- compare, and recordings that cannot be used ------------------------------------------------


def test_compare_says_how_large_the_missing_force_is(symhyb: Call) -> None:
    done = symhyb("compare", OSCILLATOR, TRAIN, HOLDOUT)
    assert done.status == 0
    assert done.out.count("structure, not noise") == 2
    assert done.out.count("first checks:") == 2
    assert "lost beyond what the model knows" in done.out
    assert "speed against the other sensors: no delay" in done.out


def test_compare_prints_json_and_cuts(symhyb: Call) -> None:
    done = symhyb("compare", OSCILLATOR, TRAIN, "--start", "5", "--end", "15", "--json")
    (facts,) = json.loads(done.out)["recordings"]
    assert facts["rms"]["q"]["force"] > 5 * facts["rms"]["q"]["noise"]
    assert facts["rms"]["q"]["unit"] == "N"
    assert any("5 … 15 s" in note or "outside" in note for note in facts["notes"])
    checks = facts["first_checks"]
    assert checks["sampling"]["rate"] == pytest.approx(100.0)
    assert checks["energy"]["unaccounted"] < 0
    assert "stand still" in checks["skipped"]["rest"]


def test_compare_maps_columns(symhyb: Call, write: Write) -> None:
    recording = write("mapped.csv", rows(header="clock,motor,x,w"))
    maps = ["t=clock", "f=1*motor", "position=x [m]", "speed=w"]
    options = [part for text in maps for part in ("--map", text)]
    assert symhyb("compare", OSCILLATOR, recording, *options).status == 0


def hole(column: int) -> Callable[[np.ndarray], None]:
    def change(recording: np.ndarray) -> None:
        recording[100:150, column] = np.nan

    return change


def test_a_block_of_missing_samples_of_a_sensor_is_noted(symhyb: Call, write: Write) -> None:
    done = symhyb("compare", OSCILLATOR, write("holes.csv", rows(hole(2))))
    assert done.status == 0
    assert "position: 50 of 400 samples are missing" in done.out


def backwards(recording: np.ndarray) -> None:
    recording[200, 0] = recording[190, 0]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("no_input.csv", rows(header="t,force,position,speed"), "input f: has no column"),
        ("no_sensor.csv", rows(header="t,f,a,b"), "no sensor of the model (position, speed)"),
        ("backwards.csv", rows(backwards), "increase"),
        ("hole.csv", rows(hole(1)), "input f"),
        ("empty.csv", "", "the file is empty"),
        ("header.csv", "t,f,position,speed\n", "header.csv"),
        ("text.csv", rows().replace("-0.010833689", "oops"), "oops"),
        ("unit.csv", rows(header="t,f [m],position,speed"), "the model declares N"),
        ("cut.mat", b"MATLAB 5.0 MAT-file, cut" + b" " * 130, "cut.mat"),
        ("table.ods", "t", "not a readable format"),
    ],
)
@pytest.mark.parametrize("verb", ["compare", "diagnose"])
def test_unusable_recordings_are_refused_with_one_clear_message(
    symhyb: Call, write: Write, verb: str, name: str, content: str | bytes, said: str
) -> None:
    path = write(name, content)
    output = ["-o", path.parent / "out"] if verb == "diagnose" else []
    done = symhyb(verb, OSCILLATOR, path, *output)
    assert (done.status, done.out) == (2, "")
    assert said in done.err
    assert all(line.startswith(str(path)) for line in done.err.splitlines())
    assert [file.name for file in path.parent.iterdir()] == [name]


def test_a_truncated_mat_file_is_refused(symhyb: Call, write: Write, tmp_path: Path) -> None:
    from scipy.io import savemat

    names, whole = ("t", "f", "position", "speed"), tmp_path / "whole.mat"
    recording = np.loadtxt(TRAIN, delimiter=",", skiprows=1)[:400]
    savemat(whole, dict(zip(names, recording.T, strict=True)))
    assert symhyb("compare", OSCILLATOR, whole).status == 0
    cut = write("cut.mat", whole.read_bytes()[:5000])
    done = symhyb("compare", OSCILLATOR, cut)
    assert done.status == 2
    assert done.err.startswith(f"{cut}: ")


@pytest.mark.parametrize(
    ("maps", "said"),
    [
        (["f"], "--map f: write it as channel=column"),
        (["=f"], "--map =f: write it as channel=column"),
        (["f=f", "f=position"], "'f' is mapped twice"),
        (["positon=position"], "did you mean 'position'?"),
        (["f=speed*"], "speed*"),
    ],
)
def test_maps_that_cannot_be_used(symhyb: Call, maps: list[str], said: str) -> None:
    options = [part for text in maps for part in ("--map", text)]
    done = symhyb("compare", OSCILLATOR, TRAIN, *options)
    assert done.status == 2
    assert said in done.err


# --- diagnose -----------------------------------------------------------------------------------


def diagnose(symhyb: Call, output: Path, *options: object) -> Done:
    return symhyb("diagnose", OSCILLATOR, TRAIN, "--holdout", HOLDOUT, "-o", output, *options)


def test_diagnose_prints_the_answer_first_and_leaves_four_files(
    symhyb: Call, fake: Fake, tmp_path: Path
) -> None:
    fake(friction())
    done = diagnose(symhyb, tmp_path / "deep" / "out")
    assert (done.status, done.err) == (1, "")
    lines = done.out.splitlines()
    assert lines[0] == "On q the model lacks dry friction."
    effect = "  found_friction: friction on q, coulomb = 0.490 ± 0.006 N (share 40 %)"
    assert lines[1] == effect
    assert lines.index("Not ruled out by these recordings:") < lines.index(
        "Record next: Record a slower sine."
    )
    assert any("error of position falls from 5 % to 0.74 %" in line for line in lines)
    assert lines[-1] == f"Report: {tmp_path / 'deep' / 'out' / 'report.html'}"
    assert {path.name for path in (tmp_path / "deep" / "out").iterdir()} == FILES
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["out"]


def test_what_diagnose_leaves_behind_is_valid(symhyb: Call, fake: Fake, tmp_path: Path) -> None:
    fake(friction())
    done = diagnose(symhyb, tmp_path, "--json")
    content = json.loads((tmp_path / "diagnosis.json").read_text())
    assert json.loads(done.out) == content
    jsonschema.validate(content, json.loads(SCHEMA.read_text()))
    corrected = read_model(tmp_path / "corrected.toml")
    assert corrected.elements[-1].kind == "friction"
    assert corrected.text.startswith(Path(OSCILLATOR).read_text())
    page = (tmp_path / "report.html").read_text()
    assert "SHA-256" in page
    assert str(ROOT) not in page


def test_nothing_missing_is_status_0(symhyb: Call, fake: Fake, tmp_path: Path) -> None:
    fake(NOTHING)
    assert diagnose(symhyb, tmp_path).status == 0
    assert (tmp_path / "corrected.toml").read_text() == Path(OSCILLATOR).read_text()


def test_diagnose_replaces_its_own_files_and_no_others(
    symhyb: Call, fake: Fake, tmp_path: Path
) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "report.html").write_text("old")
    fake(friction())
    assert diagnose(symhyb, tmp_path).status == 1
    assert {path.name for path in tmp_path.iterdir()} == FILES | {"mine.txt"}
    assert (tmp_path / "report.html").read_text() != "old"
    assert (tmp_path / "mine.txt").read_text() == "mine"


def test_diagnose_cuts_the_recordings_but_not_the_unseen_ones(
    symhyb: Call, fake: Fake, tmp_path: Path
) -> None:
    asked = fake(NOTHING)
    diagnose(symhyb, tmp_path, "--start", "5", "--end", "15")
    (_, (train,), (holdout,)), *_ = asked
    assert (train.t[0], train.t[-1]) == (5, 15)  # type: ignore[attr-defined]
    assert holdout.t[-1] > 19  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (NumericsError("the step became too small"), 3, "the numerics failed: the step became"),
        (KeyboardInterrupt(), 130, "interrupted; nothing more was written"),
        (ZeroDivisionError("inside"), 3, "a fault of symhyb itself"),
    ],
)
def test_a_diagnosis_that_fails_leaves_nothing(
    symhyb: Call,
    fake: Fake,
    tmp_path: Path,
    tmp_path_factory: pytest.TempPathFactory,
    monkeypatch: pytest.MonkeyPatch,
    error: BaseException,
    status: int,
    said: str,
) -> None:
    fake(error=error)
    here = tmp_path_factory.mktemp("here")
    monkeypatch.chdir(here)
    done = diagnose(symhyb, tmp_path / "out")
    assert done.status == status
    assert said in done.err
    assert list(tmp_path.iterdir()) == []
    assert [one.name for one in here.iterdir()] == ["symhyb-fault.txt"] * ("fault" in said)


@pytest.mark.parametrize("as_json", [False, True])
def test_a_diagnosis_that_is_interrupted_after_its_files_are_left_is_printed(
    symhyb: Call, fake: Fake, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, as_json: bool
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    fake(friction())
    monkeypatch.setattr("symhyb.study.run.advised", interrupted)
    done = diagnose(symhyb, tmp_path / "out", *["--json"] * as_json)
    assert done.status == 130
    assert "so far: the diagnosis, which is written" in done.err
    assert {file.name for file in (tmp_path / "out").iterdir()} == FILES
    printed = done.out.startswith("On q the model lacks dry friction.")
    assert printed == (not as_json)
    assert as_json == (done.out == "")


def test_a_report_that_fails_leaves_nothing(symhyb: Call, fake: Fake, tmp_path: Path) -> None:
    fake(friction(float("nan")))
    done = diagnose(symhyb, tmp_path / "out")
    assert done.status in (2, 3)
    assert list(tmp_path.iterdir()) == []


def test_diagnose_refuses_a_file_for_a_folder_before_it_works(
    symhyb: Call, fake: Fake, tmp_path: Path
) -> None:
    asked = fake(NOTHING)
    (tmp_path / "out").write_text("a file")
    for output in (tmp_path / "out", tmp_path / "out" / "deeper"):
        done = diagnose(symhyb, output)
        assert (done.status, done.err) == (2, f"{tmp_path / 'out'}: is a file, not a folder\n")
    assert asked == []


def test_what_was_learned_from_proves_nothing(symhyb: Call, fake: Fake, tmp_path: Path) -> None:
    fake(NOTHING)
    same = ["diagnose", OSCILLATOR, TRAIN, "--holdout", TRAIN, "-o", tmp_path / "out"]
    done = symhyb(*same)
    assert done.status == 2
    assert "is a training recording too" in done.err
    assert symhyb(*same, "--end", "-1").status == 2


def test_all_problems_of_all_recordings_come_at_once(symhyb: Call, write: Write) -> None:
    first, second = write("a.csv", ""), write("b.csv", rows(header="t,force,position,speed"))
    done = symhyb("diagnose", OSCILLATOR, first, "--holdout", second, "-o", first.parent / "out")
    assert [line.split(":")[0] for line in done.err.splitlines()] == [str(first), str(second)]


# --- run and data -------------------------------------------------------------------------------


def test_run_says_what_was_expected_and_ends_with_the_status_of_the_diagnosis(
    symhyb: Call, fake: Fake, tmp_path: Path
) -> None:
    fake(NOTHING)
    done = symhyb("run", ROOT / "studies" / "null" / "study.toml", "-o", tmp_path)
    assert done.status == 0
    assert re.search(r"verdict +nothing missing +nothing missing +passed", done.out)
    assert done.out.endswith("as expected\n")
    assert {path.name for path in tmp_path.iterdir()} == FILES | {"manifest.json"}


def test_run_fails_where_the_expectation_does(symhyb: Call, fake: Fake, tmp_path: Path) -> None:
    fake(friction())
    done = symhyb("run", ROOT / "studies" / "null" / "study.toml", "-o", tmp_path)
    assert done.status == 1
    assert done.out.endswith("2 of 2 expectations failed\n")
    assert re.search(r"anything else +nothing +q\.coulomb +FAILED", done.out)


def test_data_lists_shows_and_fetches(
    symhyb: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SYMHYB_DATA", str(tmp_path))
    assert "emps: Electro-mechanical" in symhyb("data", "list").out
    known = json.loads(symhyb("data", "list", "--json").out)
    assert "emps" in [dataset["name"] for dataset in known]
    shown = symhyb("data", "show", "emps").out
    assert shown.startswith("emps: ")
    assert "SHA-256" in shown
    assert "silverbox" not in shown
    for name in ("emp", "emps/DATA_EMP.mat"):
        done = symhyb("data", "fetch", name)
        assert done.status == 2
        assert "did you mean" in done.err
    (tmp_path / "emps").mkdir()
    (tmp_path / "emps" / "DATA_EMPS.mat").write_text("another file")
    done = symhyb("data", "fetch", "emps/DATA_EMPS.mat")
    assert done.status == 2
    assert "is not the known file" in done.err

"""`symhyb export`: files whole or not at all, and one clear sentence where it cannot be done."""

import subprocess
import sys
from pathlib import Path

import pytest
from fmus import FOUND, machine

from symhyb.errors import InputError
from symhyb.export import build
from symhyb.export.deliver import Order, deliver

MODEL = Path(__file__).parents[2] / "models" / "oscillator.toml"
DRAG = """
[elements.found_drag]
kind  = "drag"
on    = "q"
drag  = "b"
found = { by = "sparse", from = "train.csv", nrmse = [0.2, 0.02] }
[elements.found_drag.parameters]
b = { value = 0.8, sd = 0.03, unit = "N*s^2/m^2", about = "drag quadratic in speed" }
"""


def symhyb(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", "from symhyb.cli.app import main; main()", *arguments],
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_found_elements_are_exported_from_the_command_line(tmp_path: Path) -> None:
    corrected = tmp_path / "corrected.toml"
    corrected.write_text(MODEL.read_text(encoding="utf-8") + DRAG, encoding="utf-8")
    done = symhyb("export", str(corrected), "--to", "c", "-o", str(tmp_path / "drag"))
    assert (done.returncode, done.stderr) == (0, "")
    assert "inputs: v.q [m/s]" in done.stdout
    assert "outputs: dF.q [N]" in done.stdout
    assert sorted(file.name for file in (tmp_path / "drag").iterdir()) == [
        "drag.c",
        "drag.h",
        "drag_check.c",
    ]


def test_a_mistake_is_one_sentence_and_leaves_no_file(tmp_path: Path) -> None:
    done = symhyb("export", str(MODEL), "--to", "fmu", "-o", str(tmp_path / "none.fmu"))
    assert done.returncode == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert "--element" in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("order", "name", "text"),
    [
        (Order("step", FOUND), "a", "known: fmu, c"),
        (Order("fmu", FOUND), "my law.fmu", "--name my_law"),
        (Order("fmu", FOUND, platforms=("amiga",)), "a.fmu", "no platform"),
        (Order("fmu", FOUND, fmi=1), "a.fmu", "FMI 1"),
        (Order("adams", FOUND), "a", "inner state"),
        (Order("c", ("rubb",)), "a", "no such element"),
    ],
)
def test_orders_that_cannot_be_met(order: Order, name: str, text: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=text):
        deliver(machine(), order, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("to", ["fmu", "c", "casadi", "latex"])
def test_a_place_that_cannot_be_written_to(to: str, tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("here", encoding="utf-8")
    with pytest.raises(InputError, match="is a file"):
        deliver(machine(), Order(to, FOUND), file / "out")
    assert file.read_text(encoding="utf-8") == "here"


def test_no_permission_is_said_before_any_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(InputError, match="may not be written to"):
        deliver(machine(), Order("fmu", FOUND), tmp_path / "a.fmu")
    assert list(tmp_path.iterdir()) == []


def test_without_a_compiler_there_is_a_clear_sentence_and_c_still_works(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(build, "find_compiler", lambda: None)
    monkeypatch.setattr(build, "find_spec", lambda name: None)
    monkeypatch.setattr("shutil.which", lambda name: None)
    with pytest.raises(InputError, match=r"no C compiler .*symhyb\[zig\].*--to c"):
        deliver(machine(), Order("fmu", FOUND), tmp_path / "a.fmu")
    assert list(tmp_path.iterdir()) == []
    deliver(machine(), Order("c", FOUND), tmp_path / "a")
    assert (tmp_path / "a" / "a.h").exists()


def test_without_the_headers_the_cure_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(build, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install 'symhyb\[fmi\]'"):
        build.headers()


def test_code_that_does_not_compile_is_reported_with_the_compilers_words() -> None:
    with pytest.raises(InputError, match=r"linux64.*error"):
        build.shared_library("int f( {", "broken", "linux64")


def test_the_casadi_form_comes_with_a_warning(tmp_path: Path) -> None:
    import casadi as ca

    said = deliver(machine(), Order("casadi", FOUND), tmp_path / "law.casadi")
    assert "only those you wrote yourself" in said[0]
    law = ca.Function.deserialize((tmp_path / "law.casadi").read_text(encoding="utf-8"))
    assert law.size1_in(2) == 2


def test_latex_is_that_of_the_model(tmp_path: Path) -> None:
    deliver(machine(), Order("latex"), tmp_path / "model.tex")
    assert "\\ddot" in (tmp_path / "model.tex").read_text(encoding="utf-8")

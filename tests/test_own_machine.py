"""The tutorial on one's own machine, with a recording that its own script did not make.

That recording is not shipped. It is ``quarter_car`` in the folder that ``SYMHYB_EXAMPLES`` names,
or beside the recordings that ``SYMHYB_DATA`` names; where it is not there, the test is skipped. The
page itself runs with recordings that its own script writes (test_docs_snippets.py).
"""

import json
import os
import shutil
from contextlib import chdir
from pathlib import Path

import pytest
from snippets import ROOT, run_console, snippets

PAGE = ROOT / "docs" / "tutorials" / "own-machine.md"
BESIDE = Path(os.environ.get("SYMHYB_DATA", ROOT)).parent / "examples"
CASE = Path(os.environ.get("SYMHYB_EXAMPLES", BESIDE)) / "quarter_car"
WITHIN = 0.05  # of a concealed value


@pytest.mark.slow
@pytest.mark.skipif(not (CASE / "train.csv").is_file(), reason="the recording is not here")
def test_the_model_and_the_commands_of_the_page_find_what_a_rig_conceals(tmp_path: Path) -> None:
    blocks = snippets(PAGE)
    (model,) = (one for one in blocks if one.marks.get("file") == "rig.toml")
    (command,) = (one for one in blocks if "$ symhyb diagnose" in one.text)
    (tmp_path / "rig.toml").write_text(model.text, encoding="utf-8")
    for name in ("train.csv", "holdout.csv"):
        shutil.copy(CASE / name, tmp_path)
    with chdir(tmp_path):
        list(run_console(command))
    answer = json.loads((tmp_path / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    truth = json.loads((CASE / "truth.json").read_text(encoding="utf-8"))
    assert answer["verdict"] == truth["verdict"]
    found = {(one["kind"], *one["place"].values()): one for one in answer["found"]}
    assert set(found) == {("friction", "z_b - z_w"), ("damper", "z_b - z_w")}
    numbers = found["friction", "z_b - z_w"]["parameters"].values()
    (coulomb,) = (one["value"] for one in numbers if one["term"] == "coulomb")
    assert coulomb == pytest.approx(truth["found"]["s.coulomb"], rel=WITHIN)
    values = {one["name"]: one["value"] for one in answer["parameters"]}
    assert values["k_s"] == pytest.approx(truth["parameters"]["k_s"], rel=WITHIN)


def test_the_columns_that_the_page_shows_are_those_of_its_script() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert text.count("t,h,acc_body,acc_wheel,travel") == 3  # shown, written, printed

"""The tutorial on one's own machine, with the recording of which it shows the transcript.

That recording is not shipped. It is ``quarter_car`` in the folder that ``SYMHYB_EXAMPLES`` names,
or beside the recordings that ``SYMHYB_DATA`` names; where it is not there, the test is skipped. The
page itself runs with recordings that its own script writes (test_docs_snippets.py).
"""

import os
import shutil
from contextlib import chdir
from pathlib import Path

import pytest
from snippets import ROOT, differs, run_console, snippets

PAGE = ROOT / "docs" / "tutorials" / "own-machine.md"
BESIDE = Path(os.environ.get("SYMHYB_DATA", ROOT)).parent / "examples"
CASE = Path(os.environ.get("SYMHYB_EXAMPLES", BESIDE)) / "quarter_car"


@pytest.mark.thorough
@pytest.mark.skipif(not (CASE / "train.csv").is_file(), reason="the recording is not here")
def test_the_transcript_of_the_rig_is_what_comes_out(tmp_path: Path) -> None:
    blocks = snippets(PAGE)
    (model,) = (one for one in blocks if one.marks.get("file") == "rig.toml")
    (shown,) = (one for one in blocks if "test_own_machine.py" in one.marks.get("not run", ""))
    (tmp_path / "rig.toml").write_text(model.text, encoding="utf-8")
    for name in ("train.csv", "holdout.csv"):
        shutil.copy(CASE / name, tmp_path)
    with chdir(tmp_path):
        ran = list(run_console(shown))
    assert ran
    assert [text for text in map(differs, ran) if text] == []


def test_the_columns_that_the_page_shows_are_those_of_its_script() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert text.count("t,h,acc_body,acc_wheel,travel") == 3  # shown, written, printed

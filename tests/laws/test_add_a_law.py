"""The page on adding a law: its code, put into a copy of the program, is found in a recording."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "add-a-law.md").read_text(encoding="utf-8")
FOUND = """
import symhyb as sh
from law_rigs import driven
from rigs import spring_model

STRENGTH, DISTANCE = 0.02, 0.12

def magnet(x, v, z, f):
    return STRENGTH / (DISTANCE - x) ** 2, 0.0

train, test = (driven(magnet, seed, duration=10.0, size=3.0) for seed in (33, 34))
diagnosis = sh.diagnose(spring_model(), train, holdout=test)
assert diagnosis.verdict == "missing physics", diagnosis.sentence
(found,) = diagnosis.found
assert found.element.kind == "magnet", found.sentence
for estimate, truth in zip(found.estimates, (STRENGTH, DISTANCE), strict=True):
    assert abs(estimate.value - truth) < 4 * estimate.sd < 0.1 * truth, estimate
assert "On x, a magnet of 0.0" in found.sentence, found.sentence
corrected = sh.apply(spring_model(), diagnosis.found)
scores = sh.judge(spring_model(), corrected, on=test).holdout
before, after = (side.free_run_nrmse["laser"] for side in (scores.before, scores.after))
assert after < 0.1 * before, (before, after)
"""


def block(language: str) -> str:
    (text,) = re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.M | re.S)
    return str(text)


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the program with the law of the page, entered as the page says."""
    folder = tmp_path_factory.mktemp("extended")
    unneeded = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "symhyb", folder / "symhyb", ignore=unneeded)
    for name in ("rigs.py", "law_rigs.py", "laws/test_each_law.py"):
        shutil.copy(ROOT / "tests" / name, folder)
    (folder / "symhyb" / "laws" / "magnet.py").write_text(block("python"), encoding="utf-8")
    (folder / "entry.diff").write_text(block("diff"), encoding="utf-8")
    run(folder, "git", "apply", "--unidiff-zero", "entry.diff")
    return folder


def run(folder: Path, *command: str) -> str:
    own = {**os.environ, "PYTHONPATH": str(folder)}
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=own)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.slow
def test_the_law_of_the_page_passes_the_tests_of_every_law(extended: Path) -> None:
    command = (sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "error")
    reported = run(extended, *command, "-k", "magnet", "test_each_law.py")
    assert re.search(r"\b(9|1\d) passed", reported)


def test_the_law_of_the_page_is_written_as_all_code_is(extended: Path) -> None:
    config = str(ROOT / "pyproject.toml")
    magnet = "symhyb/laws/magnet.py"
    for check in (("check",), ("format", "--check")):
        run(extended, sys.executable, "-m", "ruff", *check, "--config", config, magnet)


@pytest.mark.thorough
def test_the_law_of_the_page_is_found_in_a_recording(extended: Path) -> None:
    run(extended, sys.executable, "-c", FOUND)

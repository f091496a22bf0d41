"""Files that others made to hurt: a status of the contract, a sentence, little time and memory.

The folder is ``hostile`` in the examples that ``SYMHYB_EXAMPLES`` names, or beside the recordings
of ``SYMHYB_DATA``; without it these tests are skipped.
"""

import os
import re
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

SECONDS = 15  # of a processor: ten are promised, and others may slow it down
MEMORY = 2 << 30  # bytes
STATUSES = (0, 1, 2, 3)
NO_INPUT = (".md", ".py")
STUDY = """
symhyb = 1
model = "model.toml"
[[train]]
file = "none.csv"
"""
MODEL = Path(__file__).parents[1] / "models" / "oscillator.toml"


def _folder() -> Path | None:
    data = os.environ.get("SYMHYB_DATA", "")
    beside = Path(data).parent / "examples" if data else None
    places = (os.environ.get("SYMHYB_EXAMPLES"), beside)
    found = (Path(place) / "hostile" for place in places if place)
    return next((place for place in found if place.is_dir()), None)


FOLDER = _folder()
FILES = sorted(one.name for one in FOLDER.iterdir() if one.suffix not in NO_INPUT) if FOLDER else []


def _bounded() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))


@pytest.mark.skipif(not FILES, reason="SYMHYB_EXAMPLES names no folder with hostile files")
@pytest.mark.parametrize("name", FILES or ["none"])
def test_a_hostile_file_gets_a_sentence(name: str, tmp_path: Path) -> None:
    assert FOLDER is not None
    work, out = tmp_path / "work", tmp_path / "out"
    work.mkdir()
    shutil.copy(MODEL, work / "model.toml")
    shutil.copy(FOLDER / name, work / name)
    if name.startswith("study_"):
        verb = ["run", name, "-o", str(out)]
    elif name.startswith("expected_"):
        shutil.copy(FOLDER / name, work / "expected.json")
        (work / "study.toml").write_text(
            'symhyb = 1\nmodel = "model.toml"\n[[train]]\nfile = "no"\n'
        )
        verb = ["run", "study.toml", "-o", str(out)]
    elif name.endswith(".toml"):
        verb = ["check", name]
    else:
        verb = ["compare", "model.toml", name]
    before = sorted(one.name for one in work.iterdir())
    command = [sys.executable, "-m", "symhyb", *verb]
    done = subprocess.run(
        command, cwd=work, capture_output=True, text=True, preexec_fn=_bounded, timeout=300
    )
    said = done.stdout + done.stderr
    assert done.returncode in STATUSES, said[-500:]
    assert "Traceback" not in said, said[-500:]
    assert said.strip()
    assert len(said) < 20_000
    assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]", said)
    assert sorted(one.name for one in work.iterdir()) == before
    assert not out.exists() or done.returncode in (0, 1)
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert children.ru_maxrss * 1024 < MEMORY  # of the largest so far

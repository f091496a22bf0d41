"""What is distributed: the wheel holds every file of the package, and runs from where it lies."""

import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
BUILT = ROOT / "build" / "package"
FIRST = "import sys; sys.path.insert(0, sys.argv.pop(1)); "

pytestmark = pytest.mark.package


def committed() -> set[str]:
    """The files of the package by name."""
    git = ["git", "-c", "safe.directory=*", "ls-files", "symhyb"]
    listed = subprocess.run(git, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return set(listed.split())


def test_the_wheel_holds_the_package_and_nothing_else() -> None:
    (wheel,) = BUILT.glob("*.whl")
    names = set(zipfile.ZipFile(wheel).namelist())
    about = {name for name in names if ".dist-info/" in name}
    assert names - about == committed()
    assert any(name.endswith("licenses/LICENSE") for name in about)


def test_the_source_distribution_holds_the_package() -> None:
    (archive,) = BUILT.glob("*.tar.gz")
    with tarfile.open(archive) as source:
        names = {name.partition("/")[2] for name in source.getnames()}
    assert committed() | {"LICENSE", "README.md", "pyproject.toml"} <= names


def test_what_is_in_the_wheel_runs(tmp_path: Path) -> None:
    """The whole diagnosis with its page, from the wheel alone."""
    (wheel,) = BUILT.glob("*.whl")
    zipfile.ZipFile(wheel).extractall(tmp_path / "installed")

    def run(code: str, *words: object) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-c", FIRST + code, tmp_path / "installed", *words]
        return subprocess.run(
            [str(word) for word in command], cwd=tmp_path, capture_output=True, text=True
        )

    told = run("import symhyb; print(symhyb.__file__)").stdout
    assert Path(told.strip()).is_relative_to(tmp_path)
    model, record = ROOT / "models" / "oscillator.toml", ROOT / "studies/oscillator/train.csv"
    done = run("from symhyb.cli.app import main; main()", "diagnose", model, record, "-o", "out")
    assert done.returncode == 1, done.stderr
    assert "drag" in done.stdout
    left = {file.name for file in (tmp_path / "out").iterdir()}
    assert left == {"corrected.toml", "diagnosis.json", "report.html", "simulation.csv"}

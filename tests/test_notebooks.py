"""The notebooks: stored without outputs, and their code runs from top to bottom.

The cells are run as plain Python, one after the other in one namespace. A kernel would add four
packages and some seconds a notebook, and what it would show besides (displayed tables and figures)
is not compared anyway; so no cell may use the magics of IPython.
"""

import json
import shutil
from contextlib import chdir
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))


def cells(notebook: Path) -> list[dict[str, object]]:
    book = json.loads(notebook.read_text(encoding="utf-8"))
    assert (book["nbformat"], book["nbformat_minor"]) == (4, 5)
    return list(book["cells"])


def code(cell: dict[str, object]) -> str:
    source = cell["source"]
    assert isinstance(source, list)
    return "".join(map(str, source))


def test_there_are_three() -> None:
    assert {file.stem for file in NOTEBOOKS} == {"first_diagnosis", "own_machine", "paper"}


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_is_stored_without_outputs(notebook: Path) -> None:
    every = cells(notebook)
    assert every[0]["cell_type"] == "markdown"
    assert len({cell["id"] for cell in every}) == len(every)
    for cell in every:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            assert cell["execution_count"] is None
            assert not code(cell).lstrip().startswith(("%", "!"))


def paced(notebook: Path) -> object:
    """A notebook as a parameter: the first makes the diagnosis that docs/tutorials/start.md makes
    among the slow tests, too, so that it is tried with the thorough ones."""
    pace = pytest.mark.thorough if notebook.stem == "first_diagnosis" else pytest.mark.slow
    return pytest.param(notebook, marks=pace, id=notebook.stem)


@pytest.mark.parametrize("notebook", [paced(notebook) for notebook in NOTEBOOKS])
def test_a_notebook_runs(notebook: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("models", "studies/oscillator"):
        shutil.copytree(ROOT / name, tmp_path / name)
    folder = tmp_path / "docs" / "notebooks"
    folder.mkdir(parents=True)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    from matplotlib import pyplot as plt

    plt.switch_backend("Agg")
    space: dict[str, object] = {"__name__": "__main__"}
    try:
        with chdir(folder):
            for cell in cells(notebook):
                if cell["cell_type"] == "code":
                    name = f"{notebook.stem}, cell {cell['id']}"
                    exec(compile(code(cell), name, "exec"), space)
        assert plt.get_fignums()
    finally:
        plt.close("all")

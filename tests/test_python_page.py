"""docs/python.md: every block runs, and what its comments promise comes out."""

import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S)
LONG = next(i for i, block in enumerate(BLOCKS) if "sh.diagnose(" in block)


@pytest.fixture
def beside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with the models and recordings, pictures that open no window."""
    import matplotlib.pyplot as plt

    for folder in ("models", "studies/oscillator"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.chdir(tmp_path)
    plt.switch_backend("Agg")


def run(blocks: list[str]) -> dict[str, Any]:
    """The names that the blocks leave, run one after the other."""
    names: dict[str, Any] = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
    return names


@pytest.mark.usefixtures("beside")
def test_what_needs_no_diagnosis_runs(capsys: pytest.CaptureFixture[str]) -> None:
    names = run(BLOCKS[:LONG])
    out = capsys.readouterr().out
    printing = ("    print(error)", "print(frame.attrs")
    lines = [line for line in PAGE.splitlines() if line.startswith(printing)]
    promised = [line.partition("# ")[2] for line in lines]
    assert len(promised) == 2
    assert all(text in out for text in promised), out
    assert "sensor speed has no column: left out" in out
    np.testing.assert_allclose(names["bench"]["position"], names["train"]["position"])
    np.testing.assert_allclose(names["bench"].t, names["train"].t)
    assert names["run"].complete
    assert names["driven"].t[-1] == 40.0
    assert list(names["missing"]) == ["q", "q'", "q''", "dF_q", "dF_q_sd", "k_e_q"]
    said = "recordings' must be a Recording or a list of Recordings"
    assert said in PAGE
    with pytest.raises(TypeError, match=said):
        names["sh"].diagnose(names["model"], "train.csv")


@pytest.mark.slow
@pytest.mark.usefixtures("beside")
def test_the_whole_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    import matplotlib.pyplot as plt

    names = run(BLOCKS)
    plt.close("all")
    out = capsys.readouterr().out
    drag = names["drag"].drag
    assert drag.term == "drag"
    assert f"{drag.value} {drag.sd} {drag.unit}" in out
    table = names["diagnosis"].to_frame()
    columns = re.search(r"has the columns (.*?);", PAGE)[1].replace(" and ", ", ").split(", ")
    assert list(table) == columns
    row = table[(table["kind"] == "drag") & (table["term"] == "drag")].iloc[0]
    assert (row["value"], row["sd"], row["unit"]) == (drag.value, drag.sd, drag.unit)
    posterior = names["posterior"]
    np.testing.assert_allclose(posterior.sd, table["sd"], rtol=1e-12)
    np.testing.assert_array_equal(posterior.mean, table["value"])
    assert np.linalg.eigvalsh(posterior.correlation).min() > 0
    assert np.abs(posterior.correlation - np.eye(posterior.mean.size)).max() > 0.01
    assert set(names["tree"]["posterior"].data_vars) == set(posterior.names)
    scores = names["verdict"].to_frame().set_index(["recordings", "score", "of"])
    free = scores.loc[("holdout", "free_run_nrmse", "position")]
    assert free["after"] < 0.2 * free["before"]
    assert free["before"] == names["verdict"].holdout.before.free_run_nrmse["position"]
    assert names["law"].score(names["missing"][["q", "q'"]], names["missing"]["dF_q"]) > 0.9
    assert len(names["left"].lines) == 1
    assert len(names["right"].lines) == 3
    for shown in ("model", "train", "run", "gap", "diagnosis", "verdict"):
        html = names[shown]._repr_html_()
        assert "<script" not in html
        assert len(html) < 20_000

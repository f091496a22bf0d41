"""``symhyb fit`` as a person calls it."""

import json
import re
from pathlib import Path

import pytest
from command import Call

from symhyb.model.read import read_model

ROOT = Path(__file__).parents[2]
MODEL = str(ROOT / "models" / "oscillator.toml")
TRAIN = str(ROOT / "studies" / "null" / "train.csv")


def test_fit_prints_values_and_writes_them(symhyb: Call, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(Path(MODEL).read_text(encoding="utf-8").replace("100.0", "110.0"))
    target = tmp_path / "fitted.toml"
    options = ("--free", "c,m", "--end", "8")
    done = symhyb("fit", wrong, TRAIN, *options, "-o", target)
    assert done.status == 0, done.err
    rows = {line.split()[0]: line for line in done.out.splitlines() if "(was" in line}
    assert set(rows) == {"c", "m"}
    assert "±" in rows["c"]
    assert "(was 110 N/m³)" in rows["c"]
    (left,) = re.findall(r"fitted it leaves ([\d.]+) times the noise", done.out)
    assert float(left) < 1.2
    assert "correlation" in done.out
    assert "falls from" in done.out
    stiffness = {item.name: item for item in read_model(target).parameters}["c"]
    assert abs(stiffness.value - 100.0) < 4 * (stiffness.sd or 0.0)
    assert stiffness.was == 110.0
    assert symhyb("check", target).status == 0
    again = symhyb("fit", wrong, TRAIN, *options, "-o", target)
    assert (again.status, again.out) == (2, "")
    assert "--force replaces it" in again.err


def test_fit_prints_json(symhyb: Call) -> None:
    done = symhyb("fit", MODEL, TRAIN, "--free", "c", "--end", "6", "--json")
    assert done.status == 0, done.err
    facts = json.loads(done.out)
    (one,) = facts["parameters"]
    assert (one["name"], one["was"], one["stated_sd"]) == ("c", 100.0, None)
    assert facts["correlation"] == {"c": {"c": 1.0}}
    assert facts["noise_multiple"]["after"] < 1.3
    assert facts["scores"]["train"]["after"]["window_nrmse"]["position"] < 0.03


def test_fit_says_what_cannot_be_fitted(symhyb: Call, tmp_path: Path) -> None:
    done = symhyb("fit", MODEL, TRAIN)
    assert (done.status, done.out) == (2, "")
    assert "no parameter states an sd" in done.err
    done = symhyb("fit", MODEL, TRAIN, "--free", "cc")
    assert "did you mean 'c'" in done.err
    done = symhyb("fit", MODEL, TRAIN, "--free", "c", "-o", tmp_path)
    assert "is a folder" in done.err


def test_a_fit_that_is_interrupted_says_its_values(
    symhyb: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("symhyb.fitted_run.judge", interrupted)
    target = tmp_path / "fitted.toml"
    done = symhyb("fit", MODEL, TRAIN, "--free", "c", "--end", "6", "-o", target)
    assert (done.status, target.exists()) == (130, False)
    assert re.search(r"so far: c = [\d.]+ ± [\d.]+ N/m³", done.err)

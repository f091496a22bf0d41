"""``symhyb view`` as a person calls it, as far as it refuses."""

from pathlib import Path

from command import Call

ROOT = Path(__file__).parents[2]
MODEL = ROOT / "models" / "oscillator.toml"
TRAIN = ROOT / "studies" / "oscillator" / "train.csv"


def test_all_that_is_wrong_is_said_before_a_server_starts(symhyb: Call, tmp_path: Path) -> None:
    (tmp_path / "wrong.toml").write_text("titel = 1\n", encoding="utf-8")
    done = symhyb("view", tmp_path / "wrong.toml", tmp_path / "none.csv")
    assert (done.status, done.out) == (2, "")
    assert "titel" in done.err
    assert "none.csv" in done.err
    assert symhyb("view", MODEL).status == 2
    assert symhyb("view", MODEL, TRAIN, "--map", "laser").status == 2


def test_a_folder_without_results_is_refused(symhyb: Call, tmp_path: Path) -> None:
    done = symhyb("view", tmp_path)
    assert (done.status, done.out) == (2, "")
    assert "holds no diagnosis.json" in done.err

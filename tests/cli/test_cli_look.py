"""``symhyb look`` as a person calls it."""

import json
from pathlib import Path

import numpy as np
import pytest
from command import Call

ROOT = Path(__file__).parents[2]
MODEL = ROOT / "models" / "oscillator.toml"
TRAIN = ROOT / "studies" / "oscillator" / "train.csv"


def write(path: Path, t: np.ndarray, header: str = "t,pos [mm],state", word: str = "on") -> Path:
    """A mass that stands still for 2 s and then swings at 3 Hz; noise 0.02 mm."""
    noise = 0.02 * np.random.default_rng(1).standard_normal(t.size)
    x = np.where(t > 2, 5 * np.sin(2 * np.pi * 3 * (t - 2)), 0.0) + noise
    rows = [f"{a:.6f},{b:.6f},{word}" for a, b in zip(t, x, strict=True)]
    path.write_text("\n".join([header, *rows, ""]), encoding="utf-8")
    return path


def test_a_recording_is_looked_at_without_a_model(symhyb: Call, tmp_path: Path) -> None:
    t = np.arange(0, 10, 0.005)
    t = t[(t < 6) | (t > 7)]
    path = write(tmp_path / "log.csv", t)
    done = symhyb("look", path)
    assert done.status == 0, done.err
    assert "200 Hz, evenly sampled" in done.out
    assert "gaps in time: 5.995 … 7.005 s" in done.out
    assert "pos [mm]" in done.out
    assert "state: " in done.out  # no signal
    facts = json.loads(symhyb("look", path, "--json").out)
    one = facts["channels"]["pos"]
    assert one["unit"] == "mm"
    assert one["noise"] == pytest.approx(0.02, rel=0.25)
    assert one["peaks"][0]["frequency"] == pytest.approx(3.0, abs=0.5)
    (rest,) = one["rest"]
    assert rest == pytest.approx([0.0, 2.0], abs=0.2)
    assert facts["gaps"] == [[5.995, 7.005]]


def test_jitter_is_said(symhyb: Call, tmp_path: Path) -> None:
    t = np.arange(0, 10, 0.005)
    t = t + 0.001 * np.random.default_rng(0).uniform(-1, 1, t.size)
    done = symhyb("look", write(tmp_path / "log.csv", np.sort(t)))
    assert " Hz; steps differ by 1" in done.out


def test_seconds_since_1970_have_digits_that_tell_them_apart(symhyb: Call, tmp_path: Path) -> None:
    t = 1709646312.345 + np.arange(2000) / 1000
    done = symhyb("look", write(tmp_path / "log.csv", t))
    assert "from 1709646312.345 to 1709646314.344 s, 1000 Hz" in done.out


def test_a_model_adds_units_and_checks(symhyb: Call) -> None:
    done = symhyb("look", TRAIN, "--model", MODEL, "--end", "8")
    assert done.status == 0, done.err
    assert "position [m]" in done.out
    assert "Against the model:" in done.out
    assert "energy" in done.out


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_a_figure_of_all_channels(symhyb: Call, tmp_path: Path, suffix: str) -> None:
    target = tmp_path / f"all{suffix}"
    done = symhyb("look", TRAIN, "--figure", target)
    assert done.status == 0, done.err
    content = target.read_bytes()
    assert content.startswith(b"\x89PNG") if suffix == ".png" else b"<svg" in content
    again = symhyb("look", TRAIN, "--figure", target)
    assert (again.status, again.out) == (2, "")
    assert "--force replaces it" in again.err


@pytest.mark.parametrize(
    ("content", "options", "said"),
    [
        ("a,b\n" + "1,2\n" * 30, (), "time t"),
        ("t,b\n" + "1,2\n" * 30, (), "usable samples: 1;"),
        ("t\n" + "".join(f"{i}\n" for i in range(30)), (), "no column of numbers beside time"),
        ("t,b\n" + "".join(f"{i},x\n" for i in range(30)), (), "no column of numbers beside time"),
        ("t,b\n" + "".join(f"{i},2\n" for i in range(30)), ("--figure", "x.pdf"), "'.pdf'"),
    ],
)
def test_what_cannot_be_looked_at(
    symhyb: Call, tmp_path: Path, content: str, options: tuple[str, ...], said: str
) -> None:
    path = tmp_path / "log.csv"
    path.write_text(content, encoding="utf-8")
    done = symhyb("look", path, *options)
    assert (done.status, done.out) == (2, "")
    assert said in done.err


def test_time_can_be_said(symhyb: Call, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("a,b\n" + "".join(f"{i % 7},{i}\n" for i in range(40)), encoding="utf-8")
    done = symhyb("look", path, "--map", "t=index/50", "--map", "sum=a+b")
    assert done.status == 0, done.err
    assert "50 Hz, evenly sampled" in done.out
    assert "\n  sum" in done.out

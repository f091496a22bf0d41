"""All runs of a hobby servo as a study: what is read and misread, written, and altered by hand."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pandas as pd
import pytest

from symhyb.study.file import read_study
from symhyb.tasks.expand import tasks_of
from tests.scripts import scripts

NUMBERS = {"J": 0.011, "c": 0.03, "F": 0.03, "mu": 0.2}
N = 60


@pytest.fixture(scope="module")
def parts() -> Iterator[Mapping[str, ModuleType]]:
    with scripts("servo_pendulums", ("falls", "runs", "altered")) as found:
        yield found


def rows_of(run: int, **changes: object) -> pd.DataFrame:
    """What a log has of a servo that stands still at 0.1 rad."""
    columns = {
        "run": run,
        "position": 0.1,
        "torque": 10.34,
        "input_volts": 12.0,
        "temp": 30.0,
        "timestamp": 0.5 + 0.01 * np.arange(N),
        "goal_position": 0.2,
        "torque_enable": 1,
    }
    return pd.DataFrame({**columns, **changes})


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Six runs: three repetitions of two gains; of the first one channel after the other was
    misread."""
    bad = rows_of(1)
    bad.loc[20, "position"], bad.loc[30, "temp"], bad.loc[40:41, "input_volts"] = -3.14, 150.0, 0.0
    rows = pd.concat([bad, *(rows_of(run) for run in range(2, 7))])
    rows.to_csv(tmp_path / "sts3250.csv.gz", index=False)
    about = pd.DataFrame(
        {
            "run": range(1, 7),
            "mass": 0.535,
            "length": 0.1,
            "kp": [4, 4, 4, 8, 8, 8],
            "trajectory": "sin_sin",
        }
    )
    about.to_csv(tmp_path / "runs.csv", index=False)
    return tmp_path


def test_what_was_misread_is_named_and_missing(parts, folder: Path) -> None:
    first, *others = parts["runs"].read_runs(folder)
    assert first.misread == {"position": 1, "temperature": 1, "volts": 2}
    assert np.flatnonzero(np.isnan(first.q)).tolist() == [20]
    assert (first.warm, first.volts) == (30.0, 12.0)
    assert not any(one.misread for one in others)
    assert [one.repetition for one in (first, *others)] == [0, 1, 2, 0, 1, 2]
    assert (first.mount, first.gain, first.half) == ("0.535 kg 0.1 m", "4", 0)
    assert first.t[0] == 0.0


def test_the_duty_has_its_sign_and_is_a_part_of_the_supply(parts) -> None:
    reported = np.array([0.0, 0.04, 10.28, 20.24, 10.0])
    assert parts["runs"].duty_of(reported) == pytest.approx([0, -0.004, 0.004, 1.0, -1.0])


def test_each_so_manieth_is_taken_with_all_repetitions(parts, folder: Path) -> None:
    runs = parts["runs"].read_runs(folder)
    assert [one.run for one in parts["runs"].chosen(runs, 2)] == [1, 2, 3]
    assert len(parts["runs"].chosen(runs, 1)) == 6


def test_the_studies_that_are_written_can_be_run(parts, folder: Path, tmp_path: Path) -> None:
    runs = parts["runs"].read_runs(folder)
    out = tmp_path / "out"
    parts["runs"].write_runs(runs, out)
    for name, count in (("ladder.toml", 4), ("gain.toml", 0)):
        tasks = tasks_of(read_study(out / name))
        assert len(tasks) == 6
        assert len(tasks[0].study.structures) == count
        assert dict(tasks[0].study.train[0].groups)["gain"] == "4"
    lines = (out / "misread.csv").read_text().splitlines()
    assert lines[1:] == ["run-1.csv,position,1", "run-1.csv,temperature,1", "run-1.csv,volts,2"]


def standing(parts, **changes: object):  # type: ignore[no-untyped-def]
    """A run that is held at its wanted angle, then let go to another one."""
    t = 0.01 * np.arange(200)
    goal, still = np.where(t < 0.5, 0.0, 0.6), np.zeros(200)
    run = parts["runs"].Run(
        1, 0.535, 0.1, 8.0, "step", 0, t, still, still, np.ones(200), goal, 30.0, 12.0
    )
    return replace(run, **changes)


def test_a_run_comes_to_where_friction_holds_it(parts) -> None:
    run = standing(parts)
    angles, duties = parts["altered"].simulated(run, NUMBERS)
    assert abs(angles[:50]).max() < 1e-9
    pull = 0.535 * 9.81 * 0.1 * np.sin(angles[-1])
    left = 9.6 * duties[-1] - pull
    assert abs(left) < NUMBERS["F"] + NUMBERS["mu"] * pull + 1e-3
    assert duties[-1] == pytest.approx(parts["runs"].PER_RAD * 8 * (0.6 - angles[-1]))


def test_without_friction_and_motor_energy_is_kept(parts) -> None:
    falling = standing(parts, on=np.zeros(200), q=np.full(200, 0.5))
    none = dict.fromkeys(NUMBERS, 0.0)
    angles, duties = parts["altered"].simulated(falling, none)
    assert not duties.any()
    assert angles.min() == pytest.approx(-0.5, abs=2e-3)


def test_more_friction_alters_what_was_recorded(parts) -> None:
    run = standing(parts)
    more = parts["altered"].with_friction(run, NUMBERS)
    assert abs(more.q[:50]).max() < 1e-9
    assert abs(more.q).max() > 0.003
    none = parts["altered"].with_friction(run, {**dict.fromkeys(NUMBERS, 0.0), "J": 0.011})
    assert abs(none.q).max() < 1e-12


def test_what_is_stated_is_altered_and_the_groups_stay(parts, folder: Path) -> None:
    runs = [replace(one, mass=one.mass) for one in parts["runs"].read_runs(folder)]
    weights = [0.535, 0.741, 1.168]
    heavy = parts["altered"].altered(runs[1], "mass", weights, NUMBERS)
    assert (heavy.mass, heavy.mount) == (0.741, runs[1].mount)
    assert parts["altered"].next_weight(1.168, weights) == 0.741
    weak = parts["altered"].altered(runs[1], "gain", weights, NUMBERS)
    assert weak.kp == pytest.approx(4 / 1.03)
    assert weak.gain == "4"


def swung(parts, gain: float = 1.0):  # type: ignore[no-untyped-def]
    """A run whose servo takes a goal two and three samples late, in steps of its encoder, and
    states a gain of 8 where it has so many times that; read every 10 ms, refreshed every 8."""
    step = 2 * np.pi / 4096
    t = 0.01 * np.arange(400)
    goal = np.cos(4 * t)
    fresh = np.floor(t / 0.008) * 0.008
    q = step * np.round(0.8 * np.cos(4 * fresh - 0.3) / step)
    sent = parts["runs"].sent_before(goal)
    late = np.where(np.arange(400) % 2, sent[:, 1], sent[:, 2])
    goal_had = np.floor(late / step) * step
    duty = gain * parts["runs"].PER_RAD * 8 * np.nan_to_num(goal_had - q)
    run = parts["runs"].Run(
        1, 0.535, 0.1, 8.0, "sin", 0, t, q, duty, np.ones(400), goal, 30.0, 12.0, sent=sent
    )
    return run, goal_had


def test_the_goal_that_a_servo_has_is_found_whatever_its_gain(parts) -> None:
    for gain in (1.0, 1.03, 0.9):
        run, wanted = swung(parts, gain)
        found, put = parts["runs"].has(run)
        seen = np.isfinite(put)
        assert seen.mean() > 0.9
        assert found[seen] == pytest.approx(wanted[seen])
        error = 8 * (found - run.q)[seen]
        fitted = put[seen] @ error / (error @ error) / parts["runs"].PER_RAD
        assert fitted == pytest.approx(gain, rel=1e-4)


def test_a_duty_that_fits_no_goal_is_missing(parts) -> None:
    run, _ = swung(parts)
    duty = run.duty.copy()
    duty[100:110] += 0.003
    duty[200:210] = 1.0
    _, put = parts["runs"].has(replace(run, duty=duty, on=np.where(run.t < 3, 1.0, 0.0)))
    assert np.isnan(put[[*range(100, 110), *range(200, 210), *range(300, 400)]]).all()
    assert np.isfinite(put[110:200]).mean() > 0.9


def test_other_runs_are_drawn_with_a_seed(parts, folder: Path) -> None:
    runs = parts["runs"].read_runs(folder)
    assert sorted(parts["altered"].picked(runs, 0).values()) == ["friction", "mass"]
    drawn = [tuple(parts["altered"].picked(runs, seed)) for seed in range(8)]
    assert set(drawn) == {(2, 5), (5, 2)}

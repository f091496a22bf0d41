"""Harder recordings of the bench: exact where a closed form is known, and the same machine else."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from tests.concealed_bench import Study, answer_of, modules, reported


@pytest.fixture(scope="module")
def study() -> Iterator[Study]:
    """The modules of the bench."""
    with modules() as found:
        yield found


def free_mass(study: Study, rate: float, amplitude: float, frequency: float, **more: Any) -> Any:
    """A mass of 2 kg under a sine of force, without a controller."""
    systems, plant = study["systems"], study["plant"]
    mass = systems.SLED
    drive = systems.Drive((0.1, 1.0), 1.0)
    system = systems.System("mass", ("x",), mass.mass, mass.forces, drive, rate=rate)
    signal = plant.Signal(np.array([[amplitude]]), np.array([frequency]), np.zeros((1, 1)))
    return plant.Plant(system, {"m": 2.0}, (), signal, np.ones(1), np.zeros(1), **more)


@pytest.mark.parametrize("delay", [0.0, 0.033])
def test_a_held_input_moves_a_mass_along_parabolas(study: Study, delay: float) -> None:
    """Between two samples the force is constant: q grows by v·h + F·h²/2m, v by F·h/m."""
    machine = free_mass(study, 20.0, 3.0, 1.5, held=True, delay=delay)
    t = np.arange(0, 4, 0.05)
    motion = study["plant"].simulate(machine, t, np.zeros(2))
    begin = -study["plant"].BEFORE
    edges = np.arange(-10, 90) * 0.05 + delay
    times = np.unique(np.concatenate([[begin], edges[(edges > begin) & (edges < t[-1])], t]))
    q, v, seen = 0.0, 0.0, {}
    for now, later in zip(times, np.append(times[1:], np.inf), strict=True):
        seen[round(float(now), 9)] = q
        held = machine.signal.at(np.floor((now - delay) / 0.05 + 1e-6) * 0.05)[0]
        h = later - now
        q, v = q + v * h + held / 4 * h**2, v + held / 2 * h
    expected = [seen[round(float(time), 9)] for time in t]
    assert motion.q[0] == pytest.approx(expected, abs=1e-7)
    smooth = study["plant"].simulate(replace(machine, held=False), t, np.zeros(2))
    assert np.abs(smooth.q - motion.q).max() > 1e-3


def test_a_controller_with_a_held_output_is_a_sampled_one(study: Study) -> None:
    """What is recorded of the sled is what acted, sample by sample: m Δv = Σ F h."""
    systems, plant, hidden = study["systems"], study["plant"], study["hidden"]
    random = np.random.default_rng(1)
    signal = study["conceal"].signal_of(systems.SLED, random, 1.0)
    machine = replace(hidden.plant_of(systems.SLED, hidden.Hidden(), signal), held=True)
    t = np.arange(400) / systems.SLED.rate
    motion = plant.simulate(machine, t, np.zeros(2))
    force = machine.recorded(t, motion.q, motion.v)[0]
    gained = np.cumsum(force[:-1]) / systems.SLED.rate / machine.values["m"]
    assert motion.v[0, 1:] - motion.v[0, 0] == pytest.approx(gained, abs=1e-7)


def test_a_jump_of_the_held_input_releases_a_stuck_mass(study: Study) -> None:
    """The sine passes the friction of 2 N between two samples: the mass starts at the next one."""
    machine = free_mass(study, 4.0, 4.0, 0.1, held=True)
    rub = study["laws"].Effect("friction", "x", {"coulomb": 2.0})
    t = np.arange(0, 3, 0.01)
    motion = study["plant"].simulate(replace(machine, effects=(rub,)), t, np.zeros(2))
    first = t[np.flatnonzero(np.abs(motion.v[0]) > 1e-9)[0]]
    samples = np.arange(0, 3, 0.25)
    release = samples[4 * np.sin(2 * np.pi * 0.1 * samples) > 2][0]
    assert first == pytest.approx(release + 0.01, abs=0.0051)


def test_an_unmeasured_force_moves_a_mass_as_its_integrals_say(study: Study) -> None:
    plant = study["plant"]
    times = np.linspace(-0.5, 3.5, 60)
    force = CubicSpline(times, np.random.default_rng(2).normal(size=60))
    pushed = plant.Unmeasured("x", force)
    t = np.arange(0, 3, 0.01)
    motion = plant.simulate(free_mass(study, 100.0, 0.0, 1.0, unmeasured=pushed), t, np.zeros(2))
    rate = force.antiderivative()
    gained = (rate(t) - rate(-plant.BEFORE)) / 2.0
    assert motion.v[0] == pytest.approx(gained, abs=1e-6)


def test_the_force_cell_of_the_rig_reads_the_unmeasured_force(study: Study) -> None:
    plant, hidden, rig = study["plant"], study["hidden"], study["plans"].RIG
    signal = study["conceal"].signal_of(rig, np.random.default_rng(3), 1.0)
    machine = hidden.plant_of(rig, hidden.Hidden(), signal)
    t = np.arange(200) / rig.rate
    motion = plant.simulate(machine, t, np.empty(0))
    pushed = replace(machine, unmeasured=plant.Unmeasured("x", np.cos))
    change = plant.reaction(pushed, motion) - plant.reaction(machine, motion)
    assert change == pytest.approx(-np.cos(t), abs=1e-12)


def test_the_unmeasured_force_wanders_with_its_size_and_time(study: Study) -> None:
    """RMS 1 and a correlation of 1/e after the correlation time, here 25 points."""
    walk = study["harder"]._wandering(np.random.default_rng(4), 400_000, float(np.exp(-1 / 25)))
    assert walk.std() == pytest.approx(1.0, abs=0.02)
    assert np.mean(walk[25:] * walk[:-25]) == pytest.approx(np.exp(-1), abs=0.03)


@pytest.fixture
def short(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    """Machines that are recorded for 5 s or less."""
    systems = study["plans"].SYSTEMS
    brief = tuple(replace(s, duration=min(s.duration, 5.0)) for s in systems)
    monkeypatch.setattr(study["plans"], "SYSTEMS", brief)


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize(
    ("seed", "sort"),
    [
        (9, "coloured"),
        pytest.param(5, "held", marks=pytest.mark.thorough),
        pytest.param(3, "unmeasured", marks=pytest.mark.thorough),
        (10, "unmeasured"),
    ],
)
def test_a_harder_case_conceals_the_same(study: Study, seed: int, sort: str) -> None:
    plain = study["conceal"].draw(seed)
    hard = study["harder"].harder(plain)
    assert hard.hidden is plain.hidden
    assert hard.rivals is plain.rivals
    assert study["harder"].harder(plain).hardship == hard.hardship
    answer = study["draw"].answer(hard)
    assert answer["hardship"]["sort"] == sort
    assert answer["kind"] == (f"null.{sort}" if seed % 2 else plain.plan.kind)
    shown = [study["draw"].measured(case, 0)[1][:, -1] for case in (plain, hard)]
    assert 1e-4 < np.std(shown[0] - shown[1]) / np.std(shown[0]) < 0.3
    moved = np.abs(hard.runs[0].motion.q - plain.runs[0].motion.q).max()
    assert (moved > 0) == (sort != "coloured" and not plain.plan.system.imposed)
    assert (2 <= hard.colour <= 15) if sort == "coloured" else (hard.colour == 0)
    if sort == "unmeasured":
        run, said = hard.runs[0], hard.hardship
        assert 0.01 <= said["share"] <= 0.05
        force = run.plant.unmeasured.at(run.motion.t)
        assert 0.2 < np.sqrt(np.mean(force**2)) / said["rms"] < 3


def test_half_a_sample_of_delay_is_what_holding_amounts_to(study: Study) -> None:
    score = study["claims"].score_case
    result = reported("drag", "x", "drag", 0.81, 0.01)
    hardship = {"sort": "held", "inputs": ["f"], "delay": 0.0025}
    for value, answer, wrong in (
        (0.00253, answer_of(hardship=hardship), 0),
        (0.00500, answer_of(hardship=hardship), 1),
        (0.00253, answer_of(), 1),
    ):
        late = {"channel": "f", "kind": "delay", "value": value, "sd": 1e-6}
        result["diagnosis"]["measurement"] = [late]
        row = score("a", result, answer, 1)
        assert (row.name, row.structure, len(row.wrong)) == (1, not wrong, wrong)


def test_no_input_of_the_rig_is_held(study: Study) -> None:
    rig = study["plans"].RIG
    plan = replace(study["plans"].plan_of(11), kind="null.white")
    system = replace(rig, duration=1.0)
    for seed in range(11, 400, 32):
        own = replace(plan, seed=seed, system=system)
        case = study["conceal"]._attempt(own, np.random.default_rng(seed), 0, False)
        assert study["harder"].harder(case).hardship["sort"] in ("coloured", "unmeasured")


@pytest.mark.thorough
def test_incomplete_draws_are_kept_where_asked(study: Study, tmp_path: Path) -> None:
    """Seed 34 has no complete draw, seed 10 has one at once."""
    draw, plans = study["draw"], study["plans"]
    kept = plans.Sort(keep_hard=True)
    assert (plans.PLAIN.build.name, kept.build.name) == ("concealed", "concealed-kept")
    answers = {}
    for seed in (10, 34):
        folder = draw.write(seed, tmp_path, kept)
        answers[seed] = study["seal"].unseal(folder / "sealed.json")
    assert answers[34]["may_refuse"]
    assert answers[34]["discarded"] == 0
    reached = [one["relative_sd"] for one in answers[34]["oracle"]]
    assert any(sd is None or sd > 0.05 for sd in reached)
    assert not answers[10]["may_refuse"]
    plain = draw.write(10, tmp_path / "plain")
    again = tmp_path / plain.name
    assert (plain / "train.csv").read_bytes() == (again / "train.csv").read_bytes()

"""The mount that is designed: the optimum stands without symhyb, and every way leads to it."""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from symhyb.numeric.kernels import compiled
from tests.scripts import scripts

FOLDER = Path(__file__).parents[2] / "studies" / "machine_mount"
needs_compiler = pytest.mark.skipif(compiled.find_compiler() is None, reason="no C compiler")


@pytest.fixture(scope="module")
def study() -> Iterator[ModuleType]:
    """The study, a script beside its generator."""
    with scripts("machine_mount", ("generate", "design")) as found:
        yield found["design"]


@pytest.fixture(scope="module")
def kept() -> dict:
    return json.loads((FOLDER / "results.json").read_text(encoding="utf-8"))


def test_the_recording_is_what_the_generator_makes(study: ModuleType) -> None:
    made, file = sys.modules["generate"].recorded(), study.excitation()
    assert np.abs(made - file).max(axis=0) == pytest.approx(0, abs=6e-3)
    assert (FOLDER / "excitation.csv").stat().st_size < 300_000


def test_the_unbalance_is_the_second_derivative_of_its_place(study: ModuleType) -> None:
    """me·sin(angle) differentiated twice by differences, as the machine feels it."""
    generate, h = sys.modules["generate"], 1e-4
    t = np.linspace(0.5, 23.0, 400)
    before, here, after = (np.sin(generate.rotor(t + i * h)[0]) for i in (-1, 0, 1))
    known = -generate.UNBALANCE * (after - 2 * here + before) / h**2
    assert generate.blocked_force(t) == pytest.approx(known, abs=0.05)


def test_the_machine_without_symhyb_swings_as_on_paper(study: ModuleType) -> None:
    """Under a constant force from rest, below and above critical damping."""
    t = np.arange(801) / 400
    record = np.column_stack([t, 0 * t, 0 * t + 60.0])
    k, m = 2e5, study.MASS
    for d in (800.0, 30e3):
        z = study.filtered(k, d, record)[:, 0]
        w, rate = np.sqrt(complex(k / m - (d / 2 / m) ** 2)), d / 2 / m
        swing = np.exp(-rate * t) * (np.cos(w * t) + rate / w * np.sin(w * t))
        assert z == pytest.approx(60.0 / k * (1 - swing.real), abs=1e-10 * 60 / k)


@needs_compiler
def test_runs_and_gradients_are_those_without_symhyb(study: ModuleType) -> None:
    run, record = study.rig(), study.excitation()
    theta = np.array([220e3, 1.9e3])
    y, known = run(theta), study.filtered(*theta, record)
    assert (np.abs(y - known).max(axis=0) < 1e-10 * np.abs(known).max(axis=0)).all()
    value, weights = study.rms(y)
    slopes, jacobian = run.pull_back(weights, theta).free, run.jacobian(theta)
    for i, way in enumerate(np.diag(1e-4 * theta)):
        near, far = (
            [study.filtered(*(theta + side * n * way), record) for side in (1, -1)] for n in (1, 2)
        )
        rise = (8 * (near[0] - near[1]) - (far[0] - far[1])) / (12 * way[i])
        assert slopes[i] == pytest.approx(np.sum(weights * rise), rel=1e-8)
        worst = np.abs(jacobian[:, :, i] - rise).max(axis=0)
        assert (worst < 1e-8 * np.abs(rise).max(axis=0)).all()
    assert value == pytest.approx(study.rms(known)[0], rel=1e-12)


@needs_compiler
@pytest.mark.slow
def test_slsqp_finds_the_mount_and_none_nearby_is_better(study: ModuleType, kept: dict) -> None:
    found, record = study.by_slsqp(study.rig()), study.excitation()
    other = kept["ways"]["without symhyb"]
    assert found.k == pytest.approx(other["k"], rel=1e-6)
    assert found.d == pytest.approx(other["d"], rel=1e-6)
    assert found.felt == pytest.approx(other["felt"], rel=1e-7)
    assert found.felt < 0.5 * kept["ways"]["as delivered"]["felt"]
    rng = np.random.default_rng(5)
    for size in (1e-3, 1e-2, 1e-1):
        for way in size * rng.normal(size=(100, 2)):
            y = study.filtered(found.k * (1 + way[0]), found.d * (1 + way[1]), record)
            kept_room = np.abs(y[:, 0]).max() <= study.ROOM
            assert not kept_room or study.rms(y)[0] > found.felt


@pytest.mark.thorough
@needs_compiler
def test_every_way_leads_to_the_same_mount(study: ModuleType, kept: dict) -> None:
    run = study.rig()
    ways = [study.by_opti(run), study.by_evolution(run, 3), study.by_filter(study.excitation())]
    first = study.by_slsqp(run)
    for found in ways:
        assert found.k == pytest.approx(first.k, rel=1e-6)
        assert found.d == pytest.approx(first.d, rel=1e-6)
        assert found.felt == pytest.approx(first.felt, rel=1e-6)
        assert found.travel <= study.ROOM * (1 + 1e-7)


def test_the_kept_trade_off_agrees_with_the_one_without_symhyb(kept: dict) -> None:
    assert len(kept["trade_off"]) == 6
    for point in kept["trade_off"]:
        other = point["without symhyb"]
        assert point["felt"] == pytest.approx(other["felt"], rel=1e-7)
        assert [point["k"], point["d"]] == pytest.approx([other["k"], other["d"]], rel=1e-6)
    felt = [point["felt"] for point in kept["trade_off"]]
    assert felt == sorted(felt, reverse=True)

"""The studies of the real pendulums: what they say, and that the reference they cite holds."""

import importlib.util
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from symhyb.model.types import At, On
from symhyb.study.expected import read_expected
from symhyb.study.file import read_study
from symhyb.study.run import run_study

STUDY = Path(__file__).parents[2] / "studies" / "pendulum"
INERTIA = 0.1476 * 9.81 * 0.1478 / 64.045  # of the arm about its pivot, kg·m²
Public = Callable[..., Path]


@pytest.fixture(scope="module")
def reference() -> ModuleType:
    """The fits by SciPy alone."""
    spec = importlib.util.spec_from_file_location("pendulum_reference", STUDY / "reference.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_study_is_valid() -> None:
    study = read_study(STUDY / "single" / "study.toml")
    assert (len(study.train), len(study.holdout)) == (1, 1)
    assert read_expected(STUDY / "single" / "expected.json").source


def test_the_slopes_of_the_reference_are_those_of_its_simulation(reference: ModuleType) -> None:
    p = dict.fromkeys(reference.NUMBERS, 0.0)
    p |= {
        "w2": 64.0,
        "c0": 0.1,
        "c1": 0.02,
        "c2": 0.004,
        "cs": 0.1,
        "vs": 2.5,
        "phi": -1.6,
        "rate": 0.5,
    }
    t = np.arange(0, 4, 0.02)
    slopes = reference.simulated(p, t)[1]
    for column, name in enumerate(reference.NUMBERS):
        step = 1e-4 * reference.SIZES[name]
        ends = [reference.simulated({**p, name: p[name] + s}, t)[0] for s in (-step, step)]
        numeric = (ends[1] - ends[0]) / (2 * step)
        np.testing.assert_allclose(slopes[:, column], numeric, atol=2e-3 * np.abs(numeric).max())


@pytest.mark.slow
def test_the_reference_leaves_what_the_readme_says(
    reference: ModuleType, public_file: Public
) -> None:
    public_file("pendulum", "SinglePendulumDataForParameterEstimation.mat")
    both = reference.single(("c0", "c2"), reference.LEARNED)
    assert both.fitted == pytest.approx(2.6, abs=0.1)
    expected = read_expected(STUDY / "single" / "expected.json").found
    assert both.numbers["c0"] * INERTIA == pytest.approx(expected["phi.coulomb"][0], rel=0.01)
    assert both.numbers["c2"] * INERTIA == pytest.approx(expected["phi.drag"][0], rel=0.01)
    assert reference.single(("c1",), reference.LEARNED).fitted == pytest.approx(9.4, abs=0.3)


@pytest.mark.thorough
def test_the_single_pendulum_rubs_dry_and_drags(tmp_path: Path, public_file: Public) -> None:
    public_file("pendulum", "SinglePendulumDataForParameterEstimation.mat")
    result = run_study(STUDY / "single" / "study.toml", tmp_path)
    assert [one for one in result.checks if not one.passed] == []
    assert len(result.checks) >= 5
    assert "damper" not in {found.element.kind for found in result.diagnosis.found}


@pytest.mark.slow
def test_both_joints_of_the_double_pendulum_rub_dry(tmp_path: Path, public_file: Public) -> None:
    """And the air damps the lower arm; the zeros of the encoders are those of the fit by hand."""
    public_file("pendulum", "DoublePendulumDataForParameterEstimation.mat")
    result = run_study(STUDY / "double" / "study.toml", tmp_path)
    assert [one for one in result.checks if not one.passed] == []
    found = {(one.element.kind, one.element.place) for one in result.diagnosis.found}
    losses = {("friction", On("alpha")), ("friction", On("beta")), ("damper", At("below"))}
    assert found >= losses
    # weights and inertias are free in the fit by hand, too
    assert {kind for kind, _ in found - losses} <= {"added_mass", "spring"}
    zeros = {one.channel: one.value for one in result.diagnosis.measurement}
    assert zeros == pytest.approx({"first": -0.53e-3, "second": 1.13e-3}, rel=0.1)
    proof = result.verdict.holdout
    assert proof is not None
    before, after = (one.free_run_nrmse["first"] for one in (proof.before, proof.after))
    assert before is not None
    assert after is not None
    assert after < before / 4


@pytest.mark.slow
def test_by_hand_both_joints_of_the_double_pendulum_rub_dry(
    reference: ModuleType, public_file: Public
) -> None:
    public_file("pendulum", "DoublePendulumDataForParameterEstimation.mat")
    pieces = slice(10, 20)
    dry = reference.double(("dry1", "dry2"), pieces, rounds=6)
    viscous = reference.double(("viscous1", "viscous2"), pieces, rounds=6)
    assert dry.fitted == pytest.approx(1.68, abs=0.05)
    assert viscous.fitted == pytest.approx(2.27, abs=0.05)
    assert dry.numbers["dry1"] == pytest.approx(6.7e-4, rel=0.03)
    assert dry.numbers["dry2"] == pytest.approx(1.34e-4, rel=0.03)

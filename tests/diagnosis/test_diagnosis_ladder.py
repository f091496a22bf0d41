r"""Whole diagnoses of a mass on a spring with a ladder of Maxwell branches that nobody modelled.

wall |--/\/\/--[1 kg]--▶ x
     |--/\/\--[===]--|        one, two or three: time constants a decade apart
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lsim

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.discrepancy.results import Diagnosis
from tests.pushed import DAMPING, NOISE, STEP, STIFFNESS, pushed_model, pushing

FINER = 10  # steps of the simulation a sample: the push is smooth between samples
Branch = tuple[float, float]
"""Stiffness, N/m, and time constant, s."""


def laddered(branches: Sequence[Branch], noise: float, samples: int = 1500) -> Recording:
    """The pushed mass with branches, by SciPy."""
    n = len(branches)
    A = np.zeros((2 + n, 2 + n))
    A[0, 1], A[1, :2] = 1.0, (-STIFFNESS, -DAMPING)
    for i, (k, time_s) in enumerate(branches, 2):
        A[1, 0] -= k
        A[1, i] = k
        A[i, [0, i]] = 1 / time_s, -1 / time_s
    B = np.eye(2 + n)[:, [1]]
    t = STEP / FINER * np.arange(FINER * samples)
    push = pushing(np.random.default_rng(3), t)
    _, x, _ = lsim((A, B, np.eye(1, 2 + n), np.zeros((1, 1))), push, t)
    t, push, x = (values[::FINER] for values in (t, push, x))
    seen = x + noise * np.random.default_rng(903).standard_normal(samples)
    return Recording("made.csv", t, {"f": push}, {"laser": seen}, (), "")


def holds(diagnosis: Diagnosis, branches: Sequence[Branch], deviations: float = 3.0) -> None:
    """Nothing is claimed but the branches, each number within so many deviations of the truth."""
    assert [one.element.kind for one in diagnosis.found] == ["relaxation"] * len(branches)
    assert (diagnosis.parameters, diagnosis.measurement, diagnosis.classes) == ((), (), ())
    values = [
        {one.term: (one.value, one.sd) for one in found.estimates} for found in diagnosis.found
    ]
    values.sort(key=lambda row: row["damping"][0] / row["stiffness"][0])
    for row, (k, time_s) in zip(values, sorted(branches, key=lambda one: one[1]), strict=True):
        for key, true in (("stiffness", k), ("damping", k * time_s)):
            value, sd = row[key]
            assert abs(value - true) < deviations * sd < 0.3 * true, (key, true, value, sd)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("branches", "noise"),
    [
        ([(15.0, 0.15)], NOISE),
        ([(10.0, 0.5)], NOISE),
        ([(10.0, 0.5), (10.0, 0.05)], NOISE),
        ([(10.0, 1.0), (10.0, 0.15), (10.0, 0.03)], NOISE / 10),
    ],
)
def test_a_ladder_is_found_with_as_many_branches_as_it_has(
    branches: list[Branch], noise: float
) -> None:
    holds(sh.diagnose(pushed_model(), laddered(branches, noise)), branches)


@pytest.mark.slow
def test_what_was_found_can_be_written_and_read(tmp_path: Path) -> None:
    branches = [(10.0, 0.5), (10.0, 0.05)]
    model, made = pushed_model(), laddered(branches, NOISE, samples=1000)
    corrected = sh.apply(model, sh.diagnose(model, made).found)
    sh.write_model(corrected, tmp_path / "corrected.toml")
    kinds = [one.kind for one in sh.read_model(tmp_path / "corrected.toml").elements]
    assert kinds == ["spring", "damper", "force", "relaxation", "relaxation"]

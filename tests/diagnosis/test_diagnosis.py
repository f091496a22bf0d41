"""The diagnosis on concealed effects: named, measured, proven, or honestly nothing."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

import symhyb as sh
from symhyb.discrepancy.results import Diagnosis
from tests.rigs import spring_model, spring_recording


def terms(diagnosis: Diagnosis) -> dict[str, tuple[float, float]]:
    return {
        estimate.term: (estimate.value, estimate.sd)
        for found in diagnosis.found
        for estimate in found.estimates
    }


@pytest.mark.parametrize(
    "hidden",
    [
        {"coulomb": 1.0},
        pytest.param({"drag": 2.0}, marks=pytest.mark.slow),
        pytest.param({"coulomb": 0.8, "cubic": 8000.0}, marks=pytest.mark.slow),
        pytest.param({"constant": 1.0}, marks=pytest.mark.slow),
    ],
    ids=lambda hidden: "+".join(hidden),
)
def test_concealed_effects_are_named_and_measured(hidden: Mapping[str, float]) -> None:
    train, unseen = spring_recording(1, hidden), spring_recording(2, hidden)
    diagnosis = sh.diagnose(spring_model(), train, unseen)
    assert diagnosis.verdict == "missing physics"
    found = terms(diagnosis)
    assert set(found) == set(hidden)
    for term, truth in hidden.items():
        value, sd = found[term]
        assert value == pytest.approx(truth, rel=0.05)
        assert abs(value - truth) < 4 * sd
    assert diagnosis.remainder is not None
    assert diagnosis.remainder < 0.01
    if diagnosis.remainder == 0.0:  # of nothing, no law explains a part
        assert not any("of what is left" in note for note in diagnosis.remainder_notes)


@pytest.mark.parametrize("seed", [11, 12, 13])
def test_nothing_missing_is_said_when_nothing_is(seed: int) -> None:
    diagnosis = sh.diagnose(spring_model(), spring_recording(seed, {}, noise=0.02))
    assert diagnosis.verdict == "nothing missing"
    assert (diagnosis.found, diagnosis.parameters, diagnosis.measurement) == ((), (), ())


def test_a_wrong_parameter_is_no_missing_physics() -> None:
    model = spring_model(stiffness=220.0, sd=20.0)
    diagnosis = sh.diagnose(model, spring_recording(3, {}))
    assert diagnosis.verdict == "parameters"
    (stiffness,) = diagnosis.parameters
    assert stiffness.name == "k"
    assert stiffness.was == 220.0
    assert stiffness.value == pytest.approx(200.0, rel=0.01)


def test_a_wrong_gain_is_no_missing_physics() -> None:
    diagnosis = sh.diagnose(spring_model(), spring_recording(4, {}, gain=1.1))
    assert diagnosis.verdict == "measurement"
    (fault,) = diagnosis.measurement
    # gains of input and sensor are the same thing for a linear machine: the input's is named
    assert (fault.channel, fault.kind) == ("f", "gain")
    assert fault.value == pytest.approx(1.1, rel=0.01)
    assert any(rival.channel == "laser" for rival in diagnosis.alternatives)


@pytest.mark.slow
def test_the_unseen_recording_proves_and_never_chooses() -> None:
    hidden = {"coulomb": 1.0}
    train, unseen = spring_recording(5, hidden), spring_recording(6, hidden)
    random = np.random.default_rng(0)
    noise = replace(unseen, sensors={"laser": random.standard_normal(unseen.t.size)})
    with_truth = sh.diagnose(spring_model(), train, unseen)
    with_noise = sh.diagnose(spring_model(), train, noise)
    assert terms(with_truth) == terms(with_noise)
    assert with_truth.found[0].share != with_noise.found[0].share


@pytest.mark.slow
def test_the_corrected_model_predicts_the_unseen_recording() -> None:
    hidden = {"coulomb": 1.0}
    model, train, unseen = spring_model(), spring_recording(7, hidden), spring_recording(8, hidden)
    diagnosis = sh.diagnose(model, train, unseen)
    corrected = sh.apply(model, diagnosis.found, diagnosis.parameters, diagnosis.measurement)
    assert corrected.text.startswith(model.text)
    verdict = sh.judge(model, corrected, unseen, train=train)
    assert verdict.holdout is not None
    before, after = verdict.holdout.before, verdict.holdout.after
    x = unseen.sensors["laser"]
    floor = 0.01 * x.std() / np.ptp(x)
    for scores in ("window_nrmse", "free_run_nrmse"):
        first, second = getattr(before, scores)["laser"], getattr(after, scores)["laser"]
        assert second < 0.6 * first
        assert second < 1.2 * floor
    assert after.force_nrmse["x"] < before.force_nrmse["x"]


@pytest.mark.slow
def test_two_recordings_share_one_truth() -> None:
    hidden = {"drag": 2.0}
    runs = [spring_recording(seed, hidden, duration=8.0, name=f"{seed}.csv") for seed in (21, 22)]
    found = terms(sh.diagnose(spring_model(), runs))
    assert set(found) == {"drag"}
    assert found["drag"][0] == pytest.approx(2.0, rel=0.03)


def test_no_recording_is_one_clear_error() -> None:
    with pytest.raises(sh.InputError, match="no recording"):
        sh.diagnose(spring_model(), [])


@pytest.mark.parametrize(
    ("seconds", "noise", "why"),
    [(0.3, 0.01, "less than 100"), (5.0, 30.0, "few times its noise")],
    ids=["too short", "all noise"],
)
def test_a_recording_that_cannot_tell_is_no_proof_of_a_model(
    seconds: float, noise: float, why: str
) -> None:
    run = spring_recording(9, {}, noise=noise, duration=seconds)
    diagnosis = sh.diagnose(spring_model(), run)
    assert diagnosis.verdict == "undecided"
    assert why in diagnosis.sentence
    assert diagnosis.record_next is not None
    assert diagnosis.found == ()


def test_a_recording_in_which_nothing_moves_ends_in_a_sentence() -> None:
    run = spring_recording(9, {}, duration=5.0)
    still = replace(run, inputs={"f": 0 * run.t}, sensors={"laser": 0 * run.t})
    assert sh.diagnose(spring_model(), still).verdict == "undecided"

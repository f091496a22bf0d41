"""Unseen recordings prove and never choose: replaced by noise, what is found stays the same."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fakes import friction

import symhyb as sh
from symhyb.study.file import read_study
from tests.rigs import made, spring_model, spring_recording
from tests.unseen import assert_unseen_chooses_nothing, claims, noise_like, with_and_without

STUDIES = Path(__file__).parents[2] / "studies"


def studies() -> list[Path]:
    """Every study that has unseen recordings."""
    return [file for file in sorted(STUDIES.glob("**/study*.toml")) if read_study(file).holdout]


@pytest.mark.slow
def test_noise_in_the_place_of_a_recording_changes_nothing_that_is_found() -> None:
    hidden = {"coulomb": 1.0}
    train, unseen = (spring_recording(seed, hidden, duration=4) for seed in (1, 2))
    as_it_is, with_noise = with_and_without(spring_model(), [train], [unseen])
    assert "coulomb" in as_it_is["found"][0]
    assert with_noise == as_it_is


def test_what_is_compared_is_all_but_the_shares() -> None:
    diagnosis = friction(0.5)
    (effect,) = diagnosis.found
    proven = replace(diagnosis, found=(replace(effect, share=0.1, sentence="It acts."),))
    assert claims(proven) == claims(diagnosis)
    assert claims(friction(0.5001)) != claims(diagnosis)
    assert claims(replace(diagnosis, verdict="undecided")) != claims(diagnosis)
    assert claims(replace(diagnosis, alternatives=())) != claims(diagnosis)


def test_noise_is_noise_of_the_same_size() -> None:
    recording = spring_recording(1, {}, duration=5)
    noise = noise_like(recording)
    for name, values in {**recording.sensors, **recording.inputs}.items():
        drawn = {**noise.sensors, **noise.inputs}[name]
        assert drawn.std() == pytest.approx(values.std(), rel=0.1)
        assert abs(np.corrcoef(drawn, values)[0, 1]) < 0.1
    assert not recording.shares(noise)


@pytest.mark.thorough
def test_a_correction_that_runs_away_unseen_is_reported_and_not_withdrawn() -> None:
    """Found at small swings, a softening cubic has no place of rest beyond 0.42 m."""

    def swing(seed: int, size: float) -> sh.Recording:
        return made(seed, lambda x, v: 200 / 6 * np.sin(6 * x), size=size, duration=8.0)

    train, small, large = swing(1, 3.5), swing(2, 3.5), swing(2, 9.0)
    calm, wild, noise = (
        sh.diagnose(spring_model(), train, one)
        for one in (small, large, noise_like(small, scale=30.0))
    )
    assert calm.verdict == "missing physics"
    assert claims(wild) == claims(noise) == claims(calm)
    for diagnosis in (wild, noise):
        assert "which it has not seen, the corrected model leaves the" in diagnosis.sentence
        assert any("holds within the motion that it was learned from" in x for x in diagnosis.notes)
    assert "has not seen" not in calm.sentence


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("stiffness", "verdict"), [(60.0, "missing physics"), (-30.0, "undecided")]
)
def test_a_correction_that_runs_away_is_refused(stiffness: float, verdict: str) -> None:
    """A spring that pushes is found under position control: alone, 60 N/m in all hold the mass and
    −30 N/m do not, so that the corrected model runs away from the recording."""
    loop = made(1, lambda x, v: stiffness * x, control=(600.0, 6.0), size=12.0, duration=6.0)
    diagnosis = sh.diagnose(spring_model(), loop)
    assert diagnosis.verdict == verdict
    if verdict == "missing physics":
        ((number,),) = [one.estimates for one in diagnosis.found]
        assert "unstable" not in diagnosis.sentence
    else:
        assert diagnosis.found == ()
        assert "refused, for it makes the model unstable: simulated along" in diagnosis.sentence
        assert diagnosis.remainder == 1.0
        (number,) = diagnosis.alternatives[0].estimates
    assert number.term == "stiffness"
    assert number.value == pytest.approx(stiffness - 200.0, abs=4 * number.sd + 0.5)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "path", studies(), ids=lambda path: "-".join(path.relative_to(STUDIES).parts[:-1])
)
def test_the_studies_do_not_choose_by_what_is_unseen(
    path: Path, public_file: Callable[..., Path]
) -> None:
    study = read_study(path)
    for source in (*study.train, *study.holdout):
        if source.data:
            public_file(*source.data.split("/", 1))
    assert_unseen_chooses_nothing(path)

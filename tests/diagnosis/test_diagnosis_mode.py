"""A whole diagnosis of a machine on which a mass rides that nobody modelled."""

from pathlib import Path

import pytest

import symhyb as sh
from symhyb.model.types import On
from tests.correction.adequacy.test_named_mode import ridden
from tests.pushed import pushed_model

MASS, LINE, RATIO = 0.15, 1.6, 0.05


@pytest.mark.slow
def test_a_mass_that_rides_is_named_and_the_model_follows_unseen_data(tmp_path: Path) -> None:
    seen, unseen = (ridden([(MASS, LINE, RATIO)], seed, samples=1200) for seed in (3, 4))
    model = pushed_model()
    diagnosis = sh.diagnose(model, seen)
    (found,) = diagnosis.found
    assert (found.element.kind, found.element.place) == ("mode", On("x"))
    for key, true in (("mass", MASS), ("frequency", LINE), ("damping_ratio", RATIO)):
        number = next(one for one in found.estimates if one.term == key)
        assert abs(number.value - true) < 3 * number.sd < true, key
    assert (
        "a mode of 1.5997 ± 0.0006 Hz, 4.97 ± 0.04 % damping and 0.1501 ± 0.0004 kg"
        in found.sentence
    )
    assert not diagnosis.classes
    assert any("accelerometer on what swings there near 1.6 Hz" in note for note in diagnosis.notes)
    corrected = sh.apply(model, diagnosis.found)
    verdict = sh.judge(model, corrected, on=unseen)
    assert verdict.holdout is not None
    before, after = verdict.holdout.before, verdict.holdout.after
    assert after.free_run_nrmse["laser"] < 0.02 * before.free_run_nrmse["laser"]  # type: ignore[operator]
    sh.write_model(corrected, tmp_path / "corrected.toml")
    again = sh.read_model(tmp_path / "corrected.toml").elements[-1]
    assert (again.kind, again.place) == ("mode", On("x"))
    sh.write_report(tmp_path / "report.html", diagnosis, verdict)

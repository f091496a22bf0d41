"""Physics outside the vocabulary gets no name inside it; what lies at its edge gets its own."""

import pytest
from law_rigs import absorber, bouc_wen, dead_zone, driven, numbers
from rigs import STIFFNESS, spring_model

import symhyb as sh

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize(
    ("mass", "stiffness", "said"),
    [
        (0.3, 60.0, "What acts on x looks like a hidden mode"),
        (0.2, 15.0, "these recordings cannot tell the causes apart"),
    ],
    ids=["above resonance", "below it"],
)
def test_a_second_mass_that_the_model_lacks_gets_no_name(
    mass: float, stiffness: float, said: str
) -> None:
    """It was reported as an added mass, and as a harmonic force."""
    law = absorber(mass, stiffness, 0.5)
    diagnosis = sh.diagnose(spring_model(), driven(law, 1, inner=2))
    assert diagnosis.verdict == "undecided"
    assert said in diagnosis.sentence
    assert not any((diagnosis.found, diagnosis.parameters, diagnosis.measurement))


def test_an_input_that_acts_only_beyond_a_threshold_has_a_dead_band() -> None:
    """With another excitation a gain of 0.86 took most of it, and was reported."""
    diagnosis = sh.diagnose(spring_model(), driven(dead_zone(1.5), 1))
    assert diagnosis.verdict == "missing physics"
    assert not any((diagnosis.found, diagnosis.parameters, diagnosis.classes))
    (band,) = diagnosis.measurement
    assert (band.channel, band.kind, band.unit) == ("f", "dead_band", "N")
    assert band.value == pytest.approx(1.5, abs=3 * band.sd)
    assert band.sd < 0.03


def test_hysteresis_that_hardens_is_measured() -> None:
    """The shape of the published benchmark (Noël and Schoukens, 2016): gamma below zero."""
    law = bouc_wen(150.0, 8.0, -11.0)
    found = numbers(sh.diagnose(spring_model(), driven(law, 1)))
    assert {key.split(".")[0] for key in found} == {"hysteresis"}
    for key, truth in (("stiffness", 150.0), ("beta", 8.0), ("gamma", -11.0)):
        value, sd = found[f"hysteresis.{key}"]
        assert value == pytest.approx(truth, abs=max(3 * sd, 0.01 * abs(truth)))
        assert sd < 0.2 * abs(truth)


def test_a_stop_without_clearance_is_reported_as_one() -> None:
    def law(x: float, v: float, z: float, f: float) -> tuple[float, float]:
        return 0.2 * STIFFNESS * max(x, 0.0), 0.0

    found = numbers(sh.diagnose(spring_model(), driven(law, 1)))
    assert {key.split(".")[0] for key in found} == {"gap"}
    assert found["gap.stiffness"][0] == pytest.approx(0.2 * STIFFNESS, rel=0.02)
    value, sd = found["gap.clearance"]
    assert abs(value) < max(3 * sd, 1e-4)

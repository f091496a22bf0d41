"""Variants of a law: tried where something is left, named with their numbers, and only then."""

from dataclasses import replace

import numpy as np
import pytest
from law_rigs import RIG, Law, bouc_wen, driven, lugre, numbers, on_rig, stop
from rigs import spring_model

import symhyb as sh
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.variants import variants_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.read import parse_model
from symhyb.model.types import On
from symhyb.model.vocabulary import KINDS

X = On("x")


def diagnosed(law: Law, seed: int = 1, **more: float) -> dict[str, tuple[float, float]]:
    """What is found on the rig, by kind and key; the sentence has to be certain."""
    diagnosis = sh.diagnose(parse_model(RIG, "rig.toml"), on_rig(law, seed, **more))
    assert diagnosis.verdict == "missing physics"
    assert len(diagnosis.found) == 1
    return dict(numbers(diagnosis))


def assert_close(found: dict[str, tuple[float, float]], truth: dict[str, float]) -> None:
    assert set(found) == set(truth)
    for key, value in truth.items():
        assert found[key][0] == pytest.approx(value, rel=0.05), key
        assert abs(found[key][0] - value) < 4 * found[key][1], key


@pytest.mark.thorough
def test_an_exponent_of_hysteresis_is_found() -> None:
    found = diagnosed(bouc_wen(150.0, 1.6e4, 1e4, exponent=2.0))
    truth = {"stiffness": 150.0, "beta": 1.6e4, "gamma": 1e4, "exponent": 2.0}
    assert_close(found, {f"hysteresis.{key}": value for key, value in truth.items()})


@pytest.mark.thorough
def test_play_in_series_with_hysteresis_is_found() -> None:
    found = diagnosed(bouc_wen(300.0, 100.0, 40.0, play=0.004))
    truth = {"stiffness": 300.0, "beta": 100.0, "gamma": 40.0, "play": 0.004}
    assert_close(found, {f"hysteresis.{key}": value for key, value in truth.items()})


@pytest.mark.thorough
def test_micro_damping_is_found() -> None:
    found = diagnosed(lugre(1.0, 600.0, micro=8.0))
    truth = {"coulomb": 1.0, "stiffness": 600.0, "micro_damping": 8.0}
    assert_close(found, {f"friction_dynamic.{key}": value for key, value in truth.items()})


@pytest.mark.thorough
def test_damping_of_a_stop_is_found() -> None:
    found = diagnosed(stop(800.0, 0.012, damping=6.0))
    truth = {"stiffness": 800.0, "clearance": 0.012, "damping": 6.0}
    assert_close(found, {f"gap.{key}": value for key, value in truth.items()})


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("law", "truth"),
    [
        (bouc_wen(150.0, 100.0, 60.0), {"hysteresis": 3}),
        (lugre(1.0, 600.0), {"friction_dynamic": 2}),
        (stop(800.0, 0.012), {"gap": 2}),
    ],
    ids=["Bouc-Wen", "Dahl", "stop"],
)
def test_plain_laws_stay_plain(law: Law, truth: dict[str, int]) -> None:
    """Nothing is added to a law that explains the recording."""
    found = diagnosed(law, seed=3)
    assert {key.split(".")[0]: len(found) for key in found} == truth


def test_variants_begin_at_the_law_that_was_found() -> None:
    """One key more each, known to the vocabulary, within the limits of its key; the force at which
    a hysteresis saturates stays where it was."""
    setting = settle(prepare(parse_model(RIG, "rig.toml"), on_rig(lugre(1.0, 600.0), 1)))
    rows = {
        "hysteresis": {"stiffness": 150.0, "beta": 100.0, "gamma": -20.0},
        "friction_dynamic": {"coulomb": 1.0, "stiffness": 600.0},
        "gap": {"stiffness": 800.0, "clearance": 0.02},
    }
    for kind, row in rows.items():
        plain = next(h for h in setting.hypotheses if h.kind == kind and h.place == X)
        found = list(variants_of(setting, plain, row))
        assert {key for h, _ in found for key in h.added} == {
            "hysteresis": {"exponent", "play", "gamma"},
            "friction_dynamic": {
                "micro_damping",
                "static",
                "stribeck",
                "exponent",
                "play",
                "gamma",
            },
            "gap": {"damping"},
        }[kind]
        for variant, first in found:
            assert set(first) == set(variant.keys) <= {key.name for key in KINDS[variant.kind].keys}
            assert variant not in setting.hypotheses
            for key, number in first.items():
                low, high = variant.limits(key)
                assert low <= number <= high
                assert key != "gamma" or (low < 0) == ("gamma" in variant.added)
            if kind == "hysteresis" and "gamma" in variant.added:
                assert first["gamma"] < 0
            elif kind == "hysteresis":
                n = first.get("exponent", 1.0)
                level = (first["beta"] + first["gamma"]) ** (-1 / n) - first.get("play", 0.0)
                assert 150.0 * level == pytest.approx(150.0 / 80.0)


def test_variants_stack_and_no_key_is_added_twice() -> None:
    setting = settle(prepare(parse_model(RIG, "rig.toml"), on_rig(lugre(1.0, 600.0), 1)))
    plain = next(h for h in setting.hypotheses if h.kind == "hysteresis")
    row = {"stiffness": 150.0, "beta": 100.0, "gamma": 50.0}
    (knee, first), *_ = variants_of(setting, plain, row)
    assert knee.added == ("exponent",)
    twice = {h.added for h, _ in variants_of(setting, knee, first)}
    assert twice == {("exponent", "play")}
    other = Hypothesis("hysteresis", On("y"), ("stiffness",), (True,))
    assert list(variants_of(setting, other, row)) == []
    assert np.all([h.variant for h, _ in variants_of(setting, plain, row)])


KNOWN_DAMPER = """
[parameters.d]
value = 30.0
unit = "N*s/m"
sd = 5.0
[elements.damper]
kind = "damper"
on = "x"
damping = "d"
"""


@pytest.mark.parametrize("seed", [1, 2])
def test_a_damper_by_direction_beside_a_damping_that_may_be_estimated(seed: int) -> None:
    """A plain damper is indistinguishable from the parameter; what differs by direction is named
    all the same, and no constant force in its place."""
    d, skew = 37.0, -0.09

    def law(_: float, rate: float, *__: float) -> tuple[float, float]:
        return d * rate * (1 + skew * np.sign(rate)), 0.0

    model = parse_model(RIG + KNOWN_DAMPER, "rig.toml")
    diagnosis = sh.diagnose(model, on_rig(law, seed, noise=0.02))
    assert [(one.element.kind, one.element.place) for one in diagnosis.found] == [("damper", X)]
    assert diagnosis.parameters == ()
    reported = {one.term: (one.value, one.sd) for one in diagnosis.found[0].estimates}
    assert reported["damping"][0] == pytest.approx(d - 30.0, abs=0.5)
    product = reported["damping"][0] * reported["asymmetry"][0]
    assert product == pytest.approx(d * skew, rel=0.1)


@pytest.mark.parametrize("seed", [1, 2])
def test_friction_that_falls_with_speed_beside_a_damping_that_may_be_estimated(seed: int) -> None:
    """Plain friction with less damping comes near it, and so does drag beside both."""
    low, high, speed = 0.6, 1.0, 0.08

    def law(_: float, rate: float, *__: float) -> tuple[float, float]:
        level = low + (high - low) * np.exp(-((rate / speed) ** 2))
        return 30.0 * rate + level * np.sign(rate), 0.0

    model = parse_model(RIG + KNOWN_DAMPER, "rig.toml")
    diagnosis = sh.diagnose(model, on_rig(law, seed, noise=0.02))
    assert diagnosis.parameters == ()
    found = numbers(diagnosis)
    truth = {"friction.coulomb": low, "friction.static": high, "friction.stribeck": speed}
    assert set(found) == set(truth)
    for key, value in truth.items():
        assert abs(found[key][0] - value) < 4 * found[key][1], key


def test_a_variant_that_says_a_product_is_tried_for_that_alone() -> None:
    """x·sgn x' beside dry friction on x is friction whose level changes along the travel."""
    model, run = spring_model(), driven(lambda x, v, z, f: (1.5 * np.tanh(v / 1e-4), 0.0), 1)
    setting = settle(prepare(model, [run]))
    plain = Hypothesis("friction", X, ("coulomb",), (True,), (("transition", 1e-3),))
    said = Hypothesis("law", X, ("coefficient",), (False,), path="x*tanh(x'/transition)")
    row = {"coulomb": 1.5}
    ((sloped, first),) = variants_of(setting, plain, row, said)
    assert (sloped.keys, sloped.added) == (("coulomb", "slope"), ("slope",))
    assert first == {"coulomb": 1.5, "slope": pytest.approx(sloped.limits("slope")[1] / 30)}
    assert sloped.limits("slope")[0] == -sloped.limits("slope")[1]
    assert "slope" not in [key for h, _ in variants_of(setting, plain, row) for key in h.added]
    for path in ("abs(x)*tanh(x'/transition)", "x*x'"):
        assert list(variants_of(setting, plain, row, replace(said, path=path))) == []

"""Losses that are neither friction nor viscous nor quadratic: what they do, and what they are told
as. The rig moves a part of 0.5 kg and measures what that takes; see ``law_rigs.py``."""

import numpy as np
import pytest
from law_rigs import RIG, Law, driven, numbers, on_rig
from pushed import pushed_model, resisted
from rigs import spring_model

import symhyb as sh
from symhyb.correction.search.formulas import candidates
from symhyb.correction.search.preparing import prepare, settle
from symhyb.discrepancy.places.quantities import smooth
from symhyb.laws import LAWS, damper, damper_kinked, eddy_brake, friction, power
from symhyb.laws.base import Law as Kind
from symhyb.laws.maths import NUMPY, Motion
from symhyb.laws.variants import Load, Pace
from symhyb.model.read import parse_model
from symhyb.model.switching import gradual
from symhyb.model.vocabulary import KINDS

RATE = np.linspace(-2, 2, 41)
ZERO = np.zeros(41)
STIFFNESS = 400.0
SPRUNG = (
    RIG.replace("[bodies", f'k = {{ value = {STIFFNESS}, unit = "N/m" }}\n[bodies', 1)
    + '[elements.spring]\nkind = "spring"\non = "x"\nstiffness = "k"\n'
)


def force(law: Kind, **values: float) -> np.ndarray:
    assert law.action is not None
    does = law.action(NUMPY, Motion(ZERO, RATE, (), ZERO), values, {})
    return np.asarray(does.force)


@pytest.mark.parametrize(("exponent", "kind"), [(1.0, "damper"), (2.0, "drag")])
def test_a_power_of_one_and_of_two_are_damper_and_drag(exponent: float, kind: str) -> None:
    mine = force(power.LAW, coefficient=3.0, exponent=exponent, speed=0.5, transition=1e-9)
    (key,) = KINDS[kind].strengths
    assert mine == pytest.approx(force(KINDS[kind], **{key: 3.0 / 0.5**exponent}))


def test_the_coefficient_of_a_power_is_its_force_at_the_reference_speed() -> None:
    for exponent in (0.3, 1.5, 2.7):
        mine = force(power.LAW, coefficient=3.0, exponent=exponent, speed=1.2)
        assert np.interp(1.2, RATE, mine) == pytest.approx(3.0, rel=1e-6)
        assert np.interp(-1.2, RATE, mine) == pytest.approx(-3.0, rel=1e-6)


def test_a_root_of_the_speed_has_a_finite_slope_at_rest() -> None:
    small = Motion(0.0, np.array([0.0, 1e-12]), (), 0.0)
    assert power.LAW.action is not None
    does = power.LAW.action(
        NUMPY, small, {"coefficient": 1.0, "exponent": 0.2, "speed": 1.0, "transition": 1e-3}, {}
    )
    assert does.force[0] == 0.0
    assert does.force[1] == pytest.approx(1e-12 * 1e-3**-0.8)


def test_a_knee_turns_from_one_damping_to_another() -> None:
    values = {"damping": 8.0, "beyond": 2.0, "knee": 0.2}
    soft = force(damper_kinked.LAW, **values)
    assert soft == pytest.approx(2 * RATE + 6 * RATE / (1 + np.abs(RATE) / 0.2))
    sharp = force(damper_kinked.LAW, **values, sharpness=20.0)
    lines = 2 * RATE + 6 * np.clip(RATE, -0.2, 0.2)
    assert np.max(np.abs(sharp - lines)) < 0.05
    assert force(damper_kinked.LAW, damping=8.0, knee=1e9) == pytest.approx(8 * RATE)


def test_an_eddy_brake_is_strongest_at_its_critical_speed() -> None:
    mine = force(eddy_brake.LAW, peak=3.0, critical=0.5)
    assert RATE[np.argmax(mine)] == pytest.approx(0.5)
    assert mine.max() == pytest.approx(3.0)
    assert mine[-1] < 0.6 * 3.0


def test_friction_grows_with_the_size_of_its_load() -> None:
    plain = force(friction.LAW, coulomb=2.0, transition=0.01)
    for load in (-5.0, 5.0):
        grown = force(friction.LAW, coulomb=2.0, transition=0.01, load=load, load_coefficient=0.1)
        assert grown == pytest.approx(1.25 * plain)


def test_friction_is_tried_with_each_load_that_is_known_and_begins_at_half() -> None:
    pace = Pace(1.0, 1.5, 0.2, (Load("-k*x", 4.0), Load("f", 2.0)))
    found = list(friction.LAW.variants({"coulomb": 3.0}, pace, ("slope",)))
    assert [one.options for one in found] == [(("load", "-k*x"),), (("load", "f"),)]
    assert [one.first["load_coefficient"] for one in found] == [0.375, 0.75]
    assert not list(friction.LAW.variants({"coulomb": 3.0}, pace, ("load_coefficient", "slope")))


def test_friction_by_place_changes_along_the_stretch_and_never_drives() -> None:
    values = {"coulomb": 2.0, "slope": 10.0, "around": 0.1, "transition": 0.01}
    stretch = np.array([0.1, 0.2, -0.05, -0.3])
    assert friction.LAW.action is not None
    for rate in (-0.5, 0.5):
        does = friction.LAW.action(NUMPY, Motion(stretch, 0 * stretch + rate, (), 0.0), values, {})
        assert does.force == pytest.approx(np.sign(rate) * np.array([2.0, 3.0, 0.5, 0.0]))


@pytest.mark.parametrize(("middle", "around"), [(0.1, ()), (-1.234, (("around", -1.2),))])
def test_friction_by_place_is_tried_once_about_the_middle_of_a_travel_that_is_far_from_0(
    middle: float, around: tuple[tuple[str, float], ...]
) -> None:
    pace = Pace(1.0, 1.5, 0.2, middle=middle)  # the stretch has an RMS of 0.2
    (found,) = friction.LAW.variants({"coulomb": 3.0}, pace, ())
    assert found.first == {"coulomb": 3.0, "slope": pytest.approx(7.5)}
    assert (found.added, found.shape) == (("slope",), around)
    ((key, lower, upper),) = found.bounds
    assert key == "slope"
    assert (lower, upper) == (-upper, pytest.approx(225.0))
    assert not list(friction.LAW.variants({"coulomb": 3.0}, pace, ("slope",)))
    assert not list(friction.LAW.variants({"coulomb": 3.0}, Pace(0.0, 0.0, 0.0), ()))


@pytest.mark.parametrize("reversals", [1.0, -1.0])
def test_friction_with_a_wide_transition_is_a_damper_below_it_and_dry_beyond(
    reversals: float,
) -> None:
    slow, fast = np.array([1e-3, 2e-3, 5e-3]), np.array([2.0, 5.0, 50.0])
    values = {"coulomb": 3.0, "transition": 0.2}
    assert friction.LAW.action is not None
    for rate, expected in ((slow, 3.0 / 0.2 * slow), (fast, 3.0 + 0 * fast)):
        at = Motion(0 * rate, reversals * rate, (), 0.0)
        made = friction.LAW.action(NUMPY, at, values, {}).force
        assert made == pytest.approx(reversals * expected, rel=1e-3)
        assert np.all(made * at.r > 0)  # it only takes energy


def test_a_wide_transition_is_tried_between_the_narrow_one_and_the_largest_speed() -> None:
    pace = Pace(1.0, 1.5, 0.2, turning=1e-3)
    row = {"coulomb": 3.0}
    wide = [one for one in friction.LAW.variants(row, pace, ()) if not one.product]
    assert [one.added for one in wide] == [("transition",)] * 2
    assert [one.first["transition"] for one in wide] == pytest.approx([0.075, 0.3])
    assert {one.bounds for one in wide} == {(("transition", 1e-3, 1.5),)}
    for known in ({**row, "transition": 0.1}, {**row, "static": 4.0, "stribeck": 0.1}):
        assert not [
            key for one in friction.LAW.variants(known, pace, ("slope",)) for key in one.added
        ]
    assert not list(friction.LAW.variants(row, Pace(1.0, 1.5, 0.2), ("slope",)))


def test_friction_with_a_fitted_transition_bends_between_two_laws_and_is_not_searched_for() -> None:
    setting = settle(prepare(spring_model(), [driven(lambda x, v, z, f: (0.0, 0.0), 1)]))
    tried = [one for one in setting.hypotheses if one.kind == "friction"]
    plain, *wide = [one for one in tried if one.terms == ("coulomb",)]
    assert [one.keys for one in wide] == [("coulomb", "transition")] * 2
    assert all(one.bent and smooth(one) and one.extends(plain) for one in wide)
    assert not plain.bent
    assert not smooth(plain)
    assert {setting.hypotheses.index(one) for one in wide} <= setting.bent
    width = dict(plain.shape)["transition"]
    assert {one.limits("transition")[0] for one in wide} == {width}
    # a product with friction turns over as the narrow law does
    products = [one for one in candidates(setting).hypotheses if "transition" in one.path]
    assert {one.shape for one in products} == {(("transition", width),)}


def test_a_damper_may_stand_for_friction_by_each_load() -> None:
    pace = Pace(2.0, 3.0, 0.2, (Load("-m*g*sin(q)", 4.0), Load("f", 2.0)), turning=0.01)
    found = list(damper.LAW.variants({"damping": 3.0}, pace, ()))
    assert [one.options for one in found] == [(("load", "-m*g*sin(q)"),), (("load", "f"),)]
    assert {one.law for one in found} == {"friction"}
    assert [one.first["coulomb"] for one in found] == [3.0, 3.0]  # half of 6 N at 2 m/s
    assert [one.first["load_coefficient"] for one in found] == [0.75, 1.5]
    assert found[0].candidate is not None
    assert dict(found[0].candidate.shape) == {"transition": 0.01}
    by_side = {"damping": 3.0, "asymmetry": 0.2}
    assert not list(damper.LAW.variants(by_side, pace, ()))
    assert not list(damper.LAW.variants({"damping": 0.0}, pace, ()))
    nowhere = Pace(2.0, 3.0, 0.2, (Load("f", 2.0),))  # no friction is tried there
    assert not list(damper.LAW.variants({"damping": 3.0}, nowhere, ()))


def test_friction_by_a_weight_takes_the_same_share_of_every_swing() -> None:
    """As viscous damping does, so that one stands for the other; friction of one level takes a
    larger share the smaller the swing is."""
    turn = np.linspace(0, 2 * np.pi, 4001)

    def share(law: Kind, amplitude: float, **values: float) -> float:
        q, v = amplitude * np.cos(turn), -amplitude * np.sin(turn)
        assert law.action is not None
        load = {"load": 9.81 * np.sin(q)} if "load_coefficient" in values else {}
        does = law.action(NUMPY, Motion(q, v, (), turn), {**values, **load}, {})
        return float(np.trapezoid(does.force * v, turn)) / amplitude**2

    loaded = {"load_coefficient": 0.1, "transition": 1e-4}
    of_loaded = [share(friction.LAW, a, **loaded) for a in (0.05, 0.2)]
    of_damped = [share(damper.LAW, a, damping=0.3) for a in (0.05, 0.2)]
    of_dry = [share(friction.LAW, a, coulomb=0.1, transition=1e-4) for a in (0.05, 0.2)]
    assert of_loaded[1] == pytest.approx(of_loaded[0], rel=0.01)
    assert of_damped[1] == pytest.approx(of_damped[0], rel=1e-6)
    assert of_dry[1] == pytest.approx(of_dry[0] / 4, rel=0.02)


def test_every_value_at_which_a_law_is_another_one_lies_within_what_is_tried() -> None:
    listed = [(law.name, key.listed) for law in LAWS for key in law.keys if key.listed]
    assert listed == [("power", (0.0, 1.0, 2.0))]


def found_on_rig(law: Law, text: str = RIG) -> tuple[sh.Diagnosis, dict[str, tuple[float, float]]]:
    diagnosis = sh.diagnose(parse_model(text, "rig.toml"), on_rig(law, 1, duration=5.0))
    assert diagnosis.verdict == "missing physics", diagnosis.sentence
    assert len(diagnosis.found) == 1
    return diagnosis, dict(numbers(diagnosis))


def assert_close(found: dict[str, tuple[float, float]], truth: dict[str, float]) -> None:
    assert set(found) == set(truth)
    for key, value in truth.items():
        assert found[key][0] == pytest.approx(value, rel=0.1), key
        assert abs(found[key][0] - value) < 4 * found[key][1], key


@pytest.mark.slow
def test_a_power_is_found_with_its_exponent() -> None:
    """Simpler laws do not explain it, and a curve through points is no likelier."""
    run = resisted(2, lambda x, v: 0.8 * abs(v) ** 0.5 * v)
    diagnosis = sh.diagnose(pushed_model(), run)
    assert [one.element.kind for one in diagnosis.found] == ["power"]
    assert_close(dict(numbers(diagnosis)), {"power.coefficient": 0.8, "power.exponent": 1.5})
    assert "at 1 m/s that grows with the power 1.505" in diagnosis.sentence


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "truth"),
    [
        (
            lambda x, v, z, f: (2 * v + 28 * v / (1 + abs(v) / 0.08), 0.0),
            {"damping": 30.0, "beyond": 2.0, "knee": 0.08},
        ),
        (
            lambda x, v, z, f: (6 * (v / 0.1) / (1 + (v / 0.1) ** 2), 0.0),
            {"peak": 3.0, "critical": 0.1},
        ),
    ],
    ids=["damper_kinked", "eddy_brake"],
)
def test_a_loss_that_bends_is_not_given_the_names_of_simpler_ones(
    law: Law, truth: dict[str, float], request: pytest.FixtureRequest
) -> None:
    kind = request.node.callspec.id
    diagnosis = sh.diagnose(parse_model(RIG, "rig.toml"), on_rig(law, 1, duration=5.0))
    assert [one.element.kind for one in diagnosis.found] == [kind]
    found = numbers(diagnosis)
    for key, value in truth.items():
        assert found[f"{kind}.{key}"][0] == pytest.approx(value, rel=0.01)
        assert abs(found[f"{kind}.{key}"][0] - value) < 3 * found[f"{kind}.{key}"][1]


@pytest.mark.slow
def test_friction_by_a_load_is_found_and_written_as_a_model_that_can_be_read() -> None:
    def law(x: float, v: float, z: float, f: float) -> tuple[float, float]:
        pull = STIFFNESS * x
        return float(pull + (0.5 + 0.2 * abs(pull)) * np.tanh(v / 1e-4)), 0.0

    diagnosis, found = found_on_rig(law, SPRUNG)
    assert {key: found[key][0] for key in found} == pytest.approx(
        {"friction.coulomb": 0.5, "friction.load_coefficient": 0.2}, rel=0.05
    )
    assert "of the load -k*x" in diagnosis.sentence
    corrected = sh.apply(parse_model(SPRUNG, "rig.toml"), diagnosis.found)
    again = parse_model(corrected.text, "rig.toml")
    assert again.elements == corrected.elements
    assert str(again.elements[-1].value("load")) == "-k*x"


@pytest.mark.slow
@pytest.mark.parametrize("slope", [12.0, 0.0])
def test_friction_by_place_is_found_where_it_changes_and_written_as_a_model(slope: float) -> None:
    def law(x: float, v: float, z: float, f: float) -> tuple[float, float]:
        return float(max(1.5 + slope * x, 0.0) * np.tanh(v / 1e-4)), 0.0

    diagnosis = sh.diagnose(spring_model(), driven(law, 1, duration=8.0))
    assert diagnosis.verdict == "missing physics", diagnosis.sentence
    truth = {"friction.coulomb": 1.5, **({"friction.slope": slope} if slope else {})}
    assert_close(dict(numbers(diagnosis)), truth)
    assert ("at 0 m that changes by" in diagnosis.sentence) == (slope > 0)
    assert not any("friction on x would" in one for one in diagnosis.remainder_notes)
    corrected = sh.apply(spring_model(), diagnosis.found)
    again = parse_model(corrected.text, "rig.toml")
    assert again.elements == corrected.elements
    assert (again.elements[-1].value("slope") is not None) == (slope > 0)


@pytest.mark.slow
def test_friction_that_saturates_is_named_with_the_speed_within_which_it_turns_over() -> None:
    """In proportion to the speed up to 0.09 m/s, 5 % of the fastest, and constant beyond: no tanh,
    but as far as the recording knows it is one. The level is that beyond."""

    def law(x: float, v: float, z: float, f: float) -> tuple[float, float]:
        return 1.5 * float(np.clip(v / 0.09, -1.0, 1.0)), 0.0

    diagnosis = sh.diagnose(spring_model(), driven(law, 1, duration=8.0))
    assert diagnosis.verdict == "missing physics", diagnosis.sentence
    found = dict(numbers(diagnosis))
    assert set(found) == {"friction.coulomb", "friction.transition"}
    assert found["friction.coulomb"][0] == pytest.approx(1.5, rel=0.01)
    # where a tanh and the broken line lose the same energy over many speeds
    assert 0.7 * 0.09 < found["friction.transition"][0] < 0.09
    assert "that turns over within 0.0" in diagnosis.sentence
    corrected = sh.apply(spring_model(), diagnosis.found)
    again = parse_model(corrected.text, "rig.toml")
    assert again.elements == corrected.elements
    assert gradual(again, again.elements[-1])

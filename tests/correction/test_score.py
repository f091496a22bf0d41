"""The one score: what is left, what numbers and causes cost, and which values can be believed."""

from dataclasses import replace

import numpy as np
import pytest
from builders import model_of, spring

from symhyb.correction.search.score import (
    believable,
    cost,
    part_left,
    piece_of,
    plain,
    price,
    score,
    standing,
    unit_of,
    weak,
    weak_together,
)
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.hypotheses import Hypothesis, wrong_parameter
from symhyb.judgement import NEAR_NOISE, PIECES
from symhyb.model.types import On
from symhyb.numeric.lowered.machine import build

X = On("x")
DAMPER = Hypothesis("damper", X, ("damping",), (True,))
SKEWED = Hypothesis("damper", X, ("damping", "skew"), (True, False))
SAME_COLUMN = (("spring", "stiffness"), ("added_mass", "mass"))
POWER = Hypothesis(
    "power",
    X,
    ("coefficient",),
    (True,),
    (("exponent", 1.5),),
    ("exponent",),
    bounds=(("exponent", 0.2, 3.0),),
)
WIDE = Hypothesis(
    "friction",
    X,
    ("coulomb",),
    (True,),
    (("transition", 0.1),),
    ("transition",),
    bounds=(("transition", 1e-3, 1.0),),
)
FRICTION = Hypothesis("friction", X, ("coulomb", "static"), (True, True))
UNSURE = model_of(
    coordinates={"x": {"unit": "m"}},
    parameters={"m": (1.0, "kg"), "k": (6.0, "N/m", 0.3)},
    energy={"kinetic": "m*x'**2/2"},
    elements={"spring": spring("k")},
    sensors={"place": {"measures": "x", "unit": "m"}},
)
MACHINE = build(UNSURE)
W, EACH = 12, 100


def trial(
    *causes: Hypothesis,
    chi2: float = 1.0,
    correlation: float = 1.0,
    values: tuple[float, ...] | None = None,
    sd: float = 1e-2,
    prior: float = 0.0,
) -> Refined:
    """Causes that leave so much χ² per sample in each window."""
    numbers = sum(cause.numbers for cause in causes)
    fitted = np.array(values or (1.0,) * numbers)
    fit = Fit(
        fitted,
        sd**2 * np.eye(numbers),
        np.full(W, chi2 * EACH),
        np.full(W, EACH),
        np.arange(W) % 3 == 2,
        correlation,
        (),
        prior=prior,
    )
    paths, p = [], MACHINE.values.copy()
    for i, cause in enumerate(causes):
        paths += [cause.path] if cause.place is None else [f"cause{i}.{key}" for key in cause.keys]
    return Refined(causes, MACHINE, tuple(paths), p, fit)


def test_what_is_left_is_counted_in_the_unit_and_over_all_windows() -> None:
    one = trial(DAMPER, chi2=2.0)
    assert score(one, 4.0, 30) == pytest.approx(2 * W * EACH / 4 + price(one, 30))


def test_a_number_costs_the_logarithm_of_the_samples_and_a_cause_its_choice() -> None:
    one = trial(DAMPER)
    assert cost(one) == pytest.approx(np.log(W * EACH))
    assert price(one, 30) == pytest.approx(np.log(W * EACH) + 2 * np.log(30))


def test_a_law_that_bends_between_two_costs_the_choice_of_both() -> None:
    """Else a power of 0.5 would be cheaper than the friction and the damping it stands for."""
    both = trial(DAMPER, Hypothesis("friction", X, ("coulomb",), (True,)))
    assert price(trial(POWER), 30) == pytest.approx(price(both, 30))


@pytest.mark.parametrize(
    ("exponent", "said"),
    [
        (1.02, False),
        (0.98, False),
        (2.029, False),
        (0.21, False),
        (2.98, False),
        (1.5, True),
        (0.9, True),
    ],
)
def test_a_power_that_another_law_says_too_is_not_believed(exponent: float, said: bool) -> None:
    one = trial(POWER, values=(1.0, exponent), sd=1e-2)
    assert weak(one) == (() if said else (0,))
    assert believable(one) == said
    assert price(trial(), 30) == 0


@pytest.mark.parametrize(
    ("transition", "said"), [(2e-3, False), (0.03, False), (0.04, True), (0.9, True), (0.98, False)]
)
def test_friction_between_dry_and_viscous_is_believed_where_it_is_neither(
    transition: float, said: bool
) -> None:
    """Its transition stands three deviations off both: at the narrow one it is dry friction, at the
    largest speed a damper."""
    one = trial(WIDE, values=(1.0, transition), sd=1e-2)
    assert weak(one) == (() if said else (0,))
    assert believable(one) == said


def test_a_parameter_that_states_its_sd_pays_its_prior_up_to_what_a_law_costs() -> None:
    cause = wrong_parameter(next(item for item in UNSURE.parameters if item.sd))
    near, far = trial(cause, prior=3.0), trial(cause, prior=1e4)
    assert price(near, 30) == pytest.approx(cost(near) + 3.0)
    assert price(far, 30) == pytest.approx(cost(far) + np.log(W * EACH) + 2 * np.log(30))


def test_residuals_at_the_noise_are_pieces_of_their_own() -> None:
    assert piece_of(trial(chi2=1.0)) == 1.0
    assert piece_of(trial(chi2=1.0, correlation=4.0)) == unit_of(trial(correlation=4.0)) == 4.0


def test_what_is_more_than_noise_comes_in_few_pieces() -> None:
    one = trial(chi2=50.0)
    assert piece_of(one) == pytest.approx((50.0 - NEAR_NOISE) * W * EACH / PIECES)
    assert piece_of(trial(chi2=50.0, correlation=1e3)) == 5e4


def test_what_repeated_runs_differ_by_is_no_better_known_for_many_samples() -> None:
    one = trial(chi2=3.0)
    spread = replace(one, fit=replace(one.fit, floor=4.0))
    assert piece_of(spread) == pytest.approx(4.0 * W * EACH / PIECES)


def test_where_something_is_lacking_a_cause_must_take_about_half() -> None:
    """One number chosen among 30, where what is left is a hundred times the noise."""
    base = trial(chi2=100.0)
    for taken, better in ((0.35, False), (0.6, True)):
        larger = trial(DAMPER, chi2=100.0 * (1 - taken))
        unit = piece_of(larger)
        assert (score(larger, unit, 30) < score(base, unit, 30)) is better


@pytest.mark.parametrize(("chi2", "share"), [(1.0, 0.0), (100.0, 1.0), (50.5, 0.5)])
def test_the_share_that_is_left_has_the_noise_taken_off(chi2: float, share: float) -> None:
    assert part_left(trial(chi2=chi2), trial(chi2=100.0)) == pytest.approx(share)


def test_a_strength_within_three_deviations_is_weak() -> None:
    assert weak(trial(DAMPER, values=(0.029,))) == (0,)
    assert weak(trial(DAMPER, values=(0.031,))) == ()


def test_what_the_numerics_cannot_tell_does_not_stand_out() -> None:
    """A stiffness of 6 N/m that is off by 0.02 N/m, where forces are known to 0.2 %."""
    cause = wrong_parameter(next(item for item in UNSURE.parameters if item.sd))
    one = trial(cause, values=(6.02,), sd=1e-3)
    assert weak(one) == ()
    assert weak(replace(one, accuracy=2e-3)) == (0,)
    assert not believable(trial(DAMPER, values=(0.029,)))


def test_direction_is_claimed_only_where_it_explains_down_to_the_noise() -> None:
    assert believable(trial(SKEWED))
    assert not believable(trial(SKEWED, chi2=1.2))


def test_breakaway_below_sliding_friction_is_no_friction() -> None:
    assert believable(trial(FRICTION, values=(1.0, 1.2)))
    assert not believable(trial(FRICTION, values=(1.2, 1.0)))


def test_friction_of_which_only_the_difference_of_its_levels_is_known_is_none() -> None:
    """As where two of them act at one place: one may be any size if the other takes it back."""
    one = trial(FRICTION, values=(1.0, 1.2))
    assert believable(one)
    together = np.full((2, 2), 25.0) + 1e-4 * np.eye(2)
    assert not believable(replace(one, fit=replace(one.fit, covariance=together)))


def test_a_fit_that_failed_is_not_believed() -> None:
    one = trial(DAMPER)
    assert not believable(replace(one, fit=replace(one.fit, reason="ran away")))


def test_a_law_is_plain_whose_other_numbers_may_be_nothing() -> None:
    assert plain(trial(DAMPER, SKEWED, values=(1.0, 1.0, 0.02))) == (0, 1)
    assert plain(trial(DAMPER, SKEWED, values=(1.0, 1.0, -0.04))) == (0,)
    breakaway = replace(FRICTION, added=("static",))
    assert plain(trial(breakaway, values=(1.0, 1.02))) == (0,)  # as much as when it slides
    assert plain(trial(breakaway, values=(1.0, 1.1))) == ()


def test_without_a_cause_more_is_left_by_the_square_of_how_far_it_stands_out() -> None:
    one = trial(DAMPER, values=(0.05,), sd=0.01)
    assert standing(one, 0) == pytest.approx(25.0)
    coarse = replace(one, accuracy=0.2)  # of the numerics: as large as the deviation
    assert standing(coarse, 0) == pytest.approx(12.5)


def test_of_two_causes_that_stand_for_each_other_one_stays() -> None:
    spring_, mass = (Hypothesis(kind, X, (key,), (False,)) for kind, key in SAME_COLUMN)
    both = trial(DAMPER, spring_, mass, values=(5.0, 1.0, 2.0), sd=1.0)
    covariance = np.eye(3)
    covariance[1, 2] = covariance[2, 1] = -0.99  # what one gains the other loses
    both = replace(both, fit=replace(both.fit, covariance=covariance))
    assert weak(both) == (1, 2)
    assert weak_together(both) == (1,)  # then the mass is 3.0 (2 + 0.99) with a deviation of 0.14

    apart = replace(both, fit=replace(both.fit, covariance=np.eye(3)))
    assert weak_together(apart) == weak(apart) == (1, 2)

"""Exchanges that the linear problem promises, on the decay of a pendulum: two losses in place of
the one that imitates them, and nothing where nothing is better."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import model_of, recording
from scipy.integrate import solve_ivp

from symhyb.correction.search.decide import _further
from symhyb.correction.search.exchanges import Offer, exchanges
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.score import left, piece_of, score
from symhyb.correction.search.selection import solve
from symhyb.correction.search.setting import around, effects, exchanged
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Trials
from symhyb.data.recording import Recording
from symhyb.judgement import PIECES
from symhyb.model.types import Model

WEIGHT, NOISE, STEP = 64.0, 2e-5, 0.01
Loss = Callable[[float], float]


@cache
def pendulum() -> Model:
    """A pendulum of 1 kg·m² in its angle alone."""
    return model_of(
        coordinates={"phi": {"unit": "rad"}},
        parameters={"J": (1.0, "kg*m^2"), "W": (WEIGHT, "N*m")},
        energy={"kinetic": "J*phi'**2/2", "potential": "-W*cos(phi)"},
        sensors={"encoder": {"measures": "phi", "unit": "rad"}},
    )


def swing(loss: Loss) -> Recording:
    """It swings out from 1.6 rad for 36 s under a loss N·m of its speed."""

    def rate(_: float, state: np.ndarray) -> list[float]:
        return [state[1], -WEIGHT * np.sin(state[0]) - loss(state[1])]

    t = np.arange(0, 36, STEP)
    phi = solve_ivp(rate, (0, 36), [1.6, 0], "DOP853", t, rtol=1e-8, atol=1e-10, max_step=0.02).y[0]
    return recording(t, encoder=phi + NOISE * np.random.default_rng(1).standard_normal(t.size))


def dry(v: float) -> float:
    """Dry friction of 0.14 N·m that falls from 0.20 (which no plain law does)."""
    return float((0.14 + 0.06 * np.exp(-((v / 1.5) ** 2))) * np.tanh(v / 1e-3))


def fitted(kinds: tuple[str, ...], one: Recording) -> tuple[Trials, Refined]:
    """Plain laws of these kinds, fitted to a recording."""
    setting = settle(prepare(pendulum(), one))
    trials, known = Trials(setting, lambda line: None), setting.hypotheses
    chosen = [
        next(i for i, c in enumerate(known) if c.kind == kind and c.numbers == 1) for kind in kinds
    ]
    return trials, trials.refined(chosen, [known[cause].values([0.02]) for cause in chosen])


def kinds_of(trials: Trials, offer: Offer) -> set[str]:
    return {trials.known[cause].kind for cause in offer.causes}


def test_dry_friction_and_drag_come_for_the_damping_that_imitates_them() -> None:
    trials, damped = fitted(("damper",), swing(lambda v: dry(v) + 0.004 * abs(v) * v))
    offer = next(
        o for o in exchanges(trials, damped) if kinds_of(trials, o) == {"friction", "drag"}
    )
    assert offer.gain > 0
    both = trials.refined(offer.causes, offer.rows, damped.fit.starts)
    unit = piece_of(both)
    assert score(both, unit, trials.count) < score(damped, unit, trials.count)
    found = {cause.kind: row for cause, row in zip(both.causes, grouped(both), strict=True)}
    assert found["friction"]["coulomb"] == pytest.approx(0.15, rel=0.07)
    assert found["drag"]["drag"] == pytest.approx(0.004, rel=0.07)


def test_what_takes_nearly_all_pays_though_it_costs_more_than_the_pieces_of_what_is_left() -> None:
    """Two causes at once cost more than there are independent pieces in what nothing explains."""
    trials = Trials(settle(prepare(pendulum(), swing(lambda v: dry(v) + 0.004 * abs(v) * v))), str)
    nothing = trials.refined(())
    best = max(exchanges(trials, nothing, as_predicted=True), key=lambda offer: offer.taken)
    assert len(best.causes) == 2
    assert best.price > PIECES
    assert best.gain > 0
    assert best.unit < 0.01 * piece_of(nothing)
    assert best.taken / piece_of(nothing) < best.price


def test_the_search_goes_on_by_what_pays_only_if_it_keeps_its_promise() -> None:
    """From the model as it is to both losses at once, of which a search by one cause took one."""
    trials = Trials(settle(prepare(pendulum(), swing(lambda v: dry(v) + 0.004 * abs(v) * v))), str)
    nothing = trials.refined(())
    found = _further(trials, nothing)
    assert {cause.kind for cause in found.causes} == {"friction", "drag"}
    assert left(found) < 0.01 * left(nothing)


def test_the_best_come_first_and_each_set_of_laws_once() -> None:
    trials, damped = fitted(("damper",), swing(lambda v: dry(v) + 0.004 * abs(v) * v))
    offered = list(exchanges(trials, damped))
    gains = [offer.gain for offer in offered]
    assert gains == sorted(gains, reverse=True)
    sets = [frozenset(trials.known[c].family for c in offer.causes) for offer in offered]
    assert len(set(sets)) == len(sets)


def test_nothing_that_comes_beside_or_for_the_true_law_promises_to_be_better() -> None:
    trials, damped = fitted(("damper",), swing(lambda v: 0.05 * v))
    assert all(offer.gain < 0 for offer in exchanges(trials, damped))


def test_a_cause_that_goes_puts_its_effect_back_into_the_residual() -> None:
    """And as candidates the same laws take it away again, but for how sharp friction is sampled."""
    trials, both = fitted(("friction", "drag"), swing(lambda v: dry(v) + 0.004 * abs(v) * v))
    along = around(trials.setting, both)
    parts = effects(trials.setting, both, along)
    still = solve(exchanged(along, parts, ()), ())
    gone = solve(exchanged(along, parts, (0, 1)), ())
    assert still is not None
    assert gone is not None
    assert gone.chi2 > 100 * still.chi2
    back = solve(exchanged(along, parts, (0, 1)), trials.causes(both))
    assert back is not None
    assert back.chi2 - still.chi2 < 1e-3 * (gone.chi2 - still.chi2)
    assert back.values == pytest.approx(
        [both.value("cause0.coulomb")[0], both.value("cause1.drag")[0]], rel=0.01
    )


def test_a_law_that_stays_does_not_come_again_in_the_shape_in_which_it_was_tried() -> None:
    """Its Stribeck speed has moved in the fit: what it began at would be a law of its own."""
    wider = swing(lambda v: dry(v) + 0.1 * np.exp(-((v / 5) ** 2)) * np.tanh(v / 1e-3))
    trials = Trials(settle(prepare(pendulum(), wider)), lambda line: None)
    falling = max(i for i, cause in enumerate(trials.known) if "stribeck" in cause.keys)
    law = trials.known[falling]
    base = trials.refined([falling], [law.values([0.14, 0.2])])
    assert grouped(base)[0]["stribeck"] > 2 * dict(law.shape)["stribeck"]
    offered = list(exchanges(trials, base))
    assert offered
    assert all(len({*offer.causes}) == len(offer.causes) for offer in offered)


def test_of_two_fits_of_one_structure_the_better_is_kept() -> None:
    trials, damped = fitted(("damper",), swing(lambda v: 0.05 * v))
    (key,) = trials.done
    minimum = replace(damped, fit=replace(damped.fit, chi2=3 * damped.fit.chi2))
    trials.done[key] = minimum  # as if it had ended in a minimum of its own
    found = trials.again(key, grouped(damped), damped.fit.starts)
    assert found.fit.train == pytest.approx(damped.fit.train, rel=1e-6)
    better = replace(found, fit=replace(found.fit, chi2=found.fit.chi2 / 3))
    trials.done[key] = better
    assert trials.again(key, grouped(damped), damped.fit.starts) is better

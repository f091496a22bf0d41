"""Errors of an input that act through a declared state, against the linear machine by hand."""

import numpy as np
from motors import K, L, R, motor, recorded
from numpy.typing import NDArray
from scipy.signal import lsim

from symhyb.correction.adequacy.classes.columns import pushes
from symhyb.correction.adequacy.classes.erring_input import erring, spared_by
from symhyb.correction.adequacy.recorded import Recorded
from tests.pushed import pushed, pushed_model, setting_of

Array = NDArray[np.float64]


def ground(ammeter: bool = False) -> Recorded:
    return setting_of(motor(ammeter=ammeter), recorded(ammeter, samples=800))


def waves(at: Recorded) -> Array:
    t = at.items[0].block.t[0]
    return np.stack([np.sin(9.0 * t), np.ones_like(t)], axis=1)


def test_an_error_goes_through_the_state() -> None:
    """Of a voltage c the current takes di' = (c − R di)/L, begun at what it settles to."""
    at = ground(ammeter=True)
    t, errors = at.items[0].block.t[0], waves(at)
    (extra,) = erring(at, 0, [errors])
    for column, error in enumerate(errors.T):
        current = lsim(([-R / L], [1 / L], [1.0], [0.0]), error, t - t[0], X0=[error[0] / R])[1]
        np.testing.assert_allclose(extra.force[:, 0, column], K * current, atol=2e-3 * K)
        np.testing.assert_allclose(extra.output[:, 1, column], current, atol=2e-3)
        assert not extra.output[:, 0].any()


def test_a_jump_is_felt_as_its_mean() -> None:
    at = ground()
    errors = waves(at)
    (held,) = erring(at, 0, [0 * errors], [2 * errors])
    (mean,) = erring(at, 0, [errors])
    np.testing.assert_allclose(held.force, mean.force, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(held.arriving, mean.force, rtol=1e-6, atol=1e-12)


def test_without_states_it_is_the_push_alone() -> None:
    at = setting_of(pushed_model(), pushed(1))
    ((_, push),) = pushes(at, 0)
    errors = np.linspace(0, 1, len(push))[:, None]
    (extra,) = erring(at, 0, [errors])
    np.testing.assert_array_equal(extra.force, push[:, :, None] * errors[:, None])
    assert not extra.output.any()


def test_an_input_that_acts_through_a_state_spares_nothing() -> None:
    at = ground()
    assert spared_by(at, 0) == []
    assert spared_by(at, 0, at_once=True) == [0]

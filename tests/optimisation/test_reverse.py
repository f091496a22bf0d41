"""The steps of a run backwards, against the closed form of a decay under a drive."""

import casadi as ca
import numpy as np
import pytest

from symhyb.errors import NumericsError
from symhyb.numeric.kernels import compiled
from symhyb.numeric.runs.explicit import Field, Tape, Tolerances, field_of
from symhyb.optimisation import reverse

RATE, START, END, PUSH = 0.7, 2.0, 3.0, 0.4
needs_compiler = pytest.mark.skipif(compiled.find_compiler() is None, reason="no C compiler")


def decay() -> tuple[Field, Field]:
    """x' = d − p x, and (x, w) -> w times its slopes by x, d and p."""
    x, d, t, p, w = (ca.SX.sym(name) for name in "xdtpw")
    rates = field_of(ca.Function("field", [x, d, t, p], [d - p * x]))
    both = ca.vertcat(x, w)
    slopes = field_of(ca.Function("pulled", [both, d, t, p], [w * ca.vertcat(-p, 1, -x)]))
    assert rates is not None
    assert slopes is not None
    return rates, slopes


@needs_compiler
def test_slopes_of_a_decay() -> None:
    rates, slopes = decay()
    t, p, tape = np.linspace(0, END, 4), np.array([RATE]), Tape(1000, 1)
    nodes = t[[0, -1]], np.full((2, 1), PUSH)
    limits = Tolerances(1e-12, np.full(1, 1e-14), np.full(1, np.inf), 1000)
    run = rates.integrate(t, np.array([START]), p, nodes, limits, tape)
    left = np.exp(-RATE * t)
    np.testing.assert_allclose(run.x[:, 0], PUSH / RATE + (START - PUSH / RATE) * left, rtol=1e-11)
    seed = np.array([[0.0], [0.5], [0.0], [1.0]])  # one output within the run, and its end
    back, by_p, by_d = reverse.pulled_back(slopes, tape, run.accepted, seed, p, t, nodes)
    weights = seed[:, 0]
    np.testing.assert_allclose(back, weights @ left, rtol=1e-9)
    by_rate = -PUSH / RATE**2 * (1 - left) - t * (START - PUSH / RATE) * left
    np.testing.assert_allclose(by_p, weights @ by_rate, rtol=1e-9)
    np.testing.assert_allclose(by_d.sum(), weights @ (1 - left) / RATE, rtol=1e-9)


@needs_compiler
def test_without_a_library_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    _, slopes = decay()
    monkeypatch.setattr(reverse, "_library", lambda: None)
    nothing, t = np.zeros((1, 1)), np.zeros(1)
    with pytest.raises(NumericsError, match="need a C compiler"):
        reverse.pulled_back(slopes, Tape(1, 1), 0, nothing, np.zeros(1), t, (t, nothing))

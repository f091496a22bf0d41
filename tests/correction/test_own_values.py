"""What every recording has its own value of: who lacks the cause, and what a number costs."""

import numpy as np
import pytest

from symhyb.correction.search.score import cost, weak
from symhyb.correction.search.selection import Problem, solve
from symhyb.correction.search.trajectory import Refined
from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from symhyb.numeric.lowered.machine import build
from tests.rigs import spring_model

X = On("x")
N = 200
DRAG = Hypothesis("drag", X, ("drag",), (True,), own=("drag",))
MACHINE = build(spring_model())


def fleet(strengths: list[float], own: bool) -> Problem:
    """One cause in recordings of ``N`` samples each: a column for each, or one for all."""
    random = np.random.default_rng(3)
    size = len(strengths)
    wide = np.zeros((N * size, size))
    for i in range(size):
        wide[i * N : (i + 1) * N, i] = random.standard_normal(N)
    right = wide @ strengths + 0.1 * random.standard_normal(N * size)
    columns = wide if own else wide.sum(axis=1, keepdims=True)
    joined = np.column_stack([columns, right])
    count = columns.shape[1]
    gram = joined.T @ joined
    return Problem(
        gram,
        gram,
        (DRAG,),
        (tuple(range(count)),),
        (),
        np.zeros(count),
        np.zeros(count),
        np.full(count, np.inf),
        np.zeros(count),
        tuple("abcd"[:size]),
    )


def test_a_machine_of_the_wrong_sign_lacks_the_cause_and_the_others_keep_theirs() -> None:
    subset = solve(fleet([2.0, -0.05, 1.0], own=True), (0,))
    assert subset is not None
    assert subset.values[1] == 0.0
    assert subset.values[[0, 2]] == pytest.approx([2.0, 1.0], abs=0.03)
    assert subset.chi2 == pytest.approx(3 * N * 0.1**2, rel=0.2)


def test_a_cause_that_no_machine_may_have_is_none() -> None:
    assert solve(fleet([-1.0, -0.5], own=True), (0,)) is None
    assert solve(fleet([-1.0, -0.5], own=False), (0,)) is None


def structure(values: list[float], sd: float) -> Refined:
    """Drag with a number for every recording, each known to ``sd``; 100 samples fitted of each."""
    size = len(values)
    t = np.linspace(0, 1, 5)
    names = [Recording(f"{i}.csv", t, {}, {}, (), "") for i in range(size)]
    fit = Fit(
        np.array(values),
        sd**2 * np.eye(size),
        np.full(size, 100.0),
        np.full(size, 100),
        np.zeros(size, bool),
        1.0,
        (),
    )
    each = tuple((name, MACHINE.values) for name in names)
    owned = tuple((i,) for i in range(size))
    return Refined((DRAG,), MACHINE, ("cause0.drag",), MACHINE.values, fit, 0.0, each, owned)


def test_not_every_machine_need_show_a_cause() -> None:
    assert weak(structure([0.0, 1.0, 0.0], 0.1)) == ()
    assert weak(structure([0.29, 0.0, 0.0], 0.1)) == (0,)


def test_the_largest_of_many_must_stand_out_further() -> None:
    assert weak(structure([0.31, 0.0], 0.1)) == (0,)
    assert weak(structure([0.33, 0.0], 0.1)) == ()
    assert weak(structure([0.33, *[0.0] * 30], 0.1)) == (0,)


def test_an_own_number_costs_what_its_recording_knows() -> None:
    assert cost(structure([1.0, 2.0, 3.0], 0.1)) == pytest.approx(3 * np.log(100))

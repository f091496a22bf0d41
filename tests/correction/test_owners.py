"""Which recordings share a number, and what follows for its price and for one that is unseen."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.correction.naming.fleet_words import of_a_group
from symhyb.correction.search.owners import layout, own_terms
from symhyb.correction.search.score import cost, standing, weak
from symhyb.correction.search.screen import apart
from symhyb.correction.search.trajectory import Refined, foreseen, shared_out
from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from symhyb.numeric.lowered.machine import build
from tests.rigs import spring_model

X = On("x")
DRAG = Hypothesis("drag", X, ("drag",), (True,), own=("drag",), by=(("drag", "mount"),))
EACH = replace(DRAG, by=())
FRICTION = Hypothesis(
    "friction", X, ("coulomb", "load_coefficient"), (True, True), own=("coulomb",),
    by=(("coulomb", "mount"),),
)  # fmt: off
MACHINE = build(spring_model())


def run(name: str, mount: str) -> Recording:
    t = np.linspace(0, 1, 5)
    return Recording(name, t, {}, {}, (), "", groups={"mount": mount})


RUNS = [run("1", "a"), run("2", "b"), run("3", "a"), run("4", "c"), run("5", "b")]


def test_recordings_of_a_group_share_a_number_and_others_have_their_own() -> None:
    assert shared_out([FRICTION], RUNS) == ((0, 1), (2, 1), (0, 1), (3, 1), (2, 1))
    assert shared_out([EACH], RUNS) == ((0,), (1,), (2,), (3,), (4,))
    assert shared_out([DRAG, EACH], RUNS[:3]) == ((0, 1), (2, 3), (0, 4))


def test_nothing_is_apart_where_all_are_of_one_group() -> None:
    assert shared_out([DRAG], [RUNS[0], RUNS[2]]) == ()
    assert shared_out([DRAG], RUNS[:1]) == ()


def test_columns_of_a_group_stand_together_and_the_shared_ones_stay() -> None:
    places = layout({0: "mount"}, 2, RUNS)
    assert places.source == (0, 1, 0, 0)
    assert places.first == (0, 0, 1, 3)
    assert places.widened((0, 1)) == (0, 1, 2, 3)
    assert places.widened((1,)) == (1,)
    one = np.arange(6.0).reshape(1, 3, 1, 2)
    wide = apart(one, places, 4)  # the second of mount b
    np.testing.assert_array_equal(wide[..., 2], one[..., 0])
    np.testing.assert_array_equal(wide[..., 1], one[..., 1])
    assert not wide[..., [0, 3]].any()


def test_only_own_terms_are_apart_but_all_where_keys_are_made_of_several() -> None:
    assert own_terms(FRICTION) == ((0, "mount"),)
    wave = Hypothesis("harmonic", X, ("sine", "cosine"), (False, False), own=("phase",))
    assert own_terms(wave) == ((0, ""), (1, ""))
    assert own_terms(replace(DRAG, own=(), by=())) == ()


def structure(values: list[float], sd: float) -> Refined:
    """Drag with a number for each mount, each known to ``sd``; 100 samples of a recording."""
    owned = shared_out([DRAG], RUNS)
    machine = replace(MACHINE)
    fit = Fit(
        np.array(values),
        sd**2 * np.eye(3),
        np.full(5, 100.0),
        np.full(5, 100),
        np.zeros(5, bool),
        1.0,
        (),
    )
    each = tuple((one, np.array([values[row[0]]])) for one, row in zip(RUNS, owned, strict=True))
    return Refined((DRAG,), machine, ("cause0.drag",), np.array(values[:1]), fit, 0.0, each, owned)


def test_a_number_of_a_group_costs_what_its_recordings_know() -> None:
    wanted = np.log(200) + np.log(200) + np.log(100)  # mounts a and b have two recordings each
    assert cost(structure([1.0, 2.0, 3.0], 0.1)) == pytest.approx(wanted)


def test_a_group_counts_once_however_many_recordings_it_has() -> None:
    trial = structure([0.31, 0.0, 0.0], 0.1)
    assert weak(trial) == (0,)  # the largest of three is further out by chance
    assert weak(structure([0.35, 0.0, 0.0], 0.1)) == ()
    assert standing(trial, 0) == pytest.approx(3.1**2)


def test_an_unseen_recording_has_what_its_group_has_or_the_mean(monkeypatch) -> None:
    trial = structure([1.0, 2.0, 6.0], 0.1)
    monkeypatch.setattr(Refined, "own_columns", property(lambda self: {0: "mount"}))
    assert foreseen(trial, run("6", "c")) == pytest.approx([6.0])
    assert foreseen(trial, run("7", "d")) == pytest.approx([3.0])
    assert foreseen(trial, run("8", "a")) == pytest.approx([1.0])


def test_one_more_group_is_foretold_by_the_mean_and_the_spread_of_the_others() -> None:
    mean, sd = of_a_group([1.0, 2.0, 6.0])
    assert mean == pytest.approx(3.0)
    assert sd == pytest.approx(np.sqrt(7.0) * np.sqrt(1 + 1 / 3))
    drawn = np.random.default_rng(0).normal(5.0, 2.0, (40_000, 4))
    off = [row[-1] - of_a_group(row[:-1])[0] for row in drawn]
    known = [of_a_group(row[:-1])[1] ** 2 for row in drawn]
    assert np.var(off) == pytest.approx(np.mean(known), rel=0.05)

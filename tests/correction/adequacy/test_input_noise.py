"""Noise of a measured input counts in windows: its size is found, residuals become white, and what
is fitted is as far from the truth as its deviation says."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import symhyb as sh
from symhyb.correction.adequacy.beyond import NOTHING, Beyond
from symhyb.correction.adequacy.input_noise import stands, with_input_noise
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.recorded import recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, Likely, fitted
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined, refine
from symhyb.discrepancy.places.hypotheses import Hypothesis
from tests.builders import DRIVEN_MASS
from tests.plate import PLATE, plate, with_noisy_inputs
from tests.pushed import NOISE, pushed, pushed_model

SIZE = 0.4  # N, a tenth of the force
SAMPLES = 1500
UNCERTAIN = DRIVEN_MASS.replace("sd = 0.5", "sd = 3.0")


@dataclass(frozen=True)
class Case:
    """A pushed mass whose force is measured with noise, and its windows with and without it."""

    prepared: Prepared
    plain: Setting
    noisy: Setting


def case(seed: int, size: float = SIZE) -> Case:
    rng = np.random.default_rng(100 + seed)
    made = pushed(seed, samples=SAMPLES, beside=size * rng.standard_normal(SAMPLES))
    prepared = prepare(pushed_model(UNCERTAIN), (made,))
    plain = settle(prepared)
    ground = recorded(prepared, plain)
    assert ground is not None
    base = fitted(ground, (), (), ground.first_noise())
    left = Beyond(np.ones(1), np.ones(1), 0.01, 100.0)
    here = Generic("input", "f", (), np.zeros(0), does="noisy")
    judged = Adequacy(left, (Likely(here, 1.0),), structure=base)
    noisy = with_input_noise(prepared, plain, judged)
    assert noisy is not None
    return Case(prepared, plain, noisy)


def test_the_noise_of_each_of_two_inputs_is_measured() -> None:
    sizes = 0.8, 0.5
    prepared = prepare(PLATE, (with_noisy_inputs(plate(), sizes, 12),))
    plain = settle(prepared)
    ground = recorded(prepared, plain)
    assert ground is not None
    base = fitted(ground, (), (), ground.first_noise())
    each = [Generic("input", name, (), np.zeros(0), does="noisy") for name in ("f", "g")]
    judged = Adequacy(NOTHING, tuple(Likely(one, 1.0) for one in each), structure=base)
    noisy = with_input_noise(prepared, plain, judged)
    assert noisy is not None
    known = noisy.stages[-1].cuts[0].noise
    assert known is not None
    assert known.inputs == (0, 1)
    np.testing.assert_allclose(known.size, sizes, rtol=0.15)
    np.testing.assert_allclose(noisy.sd, NOISE, rtol=0.15)


def stiffness(one: Case, setting: Setting) -> Refined:
    (cause,) = (h for h in setting.parametric if h.kind == "parameter" and h.path == "k")
    cuts = setting.stages[-1].cuts
    return refine(
        one.prepared.model,
        (cause,),
        [{"value": 0.5}],
        cuts,
        setting.sd,
        everything=True,
        careful=True,
    )


@pytest.fixture(scope="module")
def drawn() -> list[Case]:
    return [case(seed) for seed in range(1, 7)]


def test_the_size_of_the_noise_is_found(drawn: list[Case]) -> None:
    for one in drawn:
        noise = one.noisy.stages[-1].cuts[0].noise
        assert noise is not None
        assert noise.size == pytest.approx([SIZE], rel=0.15)  # type: ignore[attr-defined]
        assert one.noisy.sd == pytest.approx([NOISE], rel=0.1)


def test_windows_are_explained_down_to_the_noise_and_deviations_hold(drawn: list[Case]) -> None:
    worse, off = [], []
    for one in drawn:
        plain, noisy = (stiffness(one, setting).fit for setting in (one.plain, one.noisy))
        worse.append(plain.chi2.sum() / plain.count.sum() / (noisy.chi2.sum() / noisy.count.sum()))
        assert noisy.chi2.sum() / noisy.count.sum() == pytest.approx(1.0, abs=0.1)
        assert noisy.correlation < 1.2
        off.append((noisy.values[0] - 25.0) / np.sqrt(noisy.covariance[0, 0]))
    assert np.abs(off).max() < 3.0
    assert np.sqrt(np.mean(np.square(off))) < 1.6
    assert min(worse) > 1.1


def test_no_other_answer_asks_for_it() -> None:
    prepared, setting = _plain()
    left = Beyond(np.ones(1), np.ones(1), 0.3, 100.0)
    late = Generic("lag", "f", (), np.zeros(0), does="lags")
    for classes in ((), (Likely(late, 1.0),)):
        assert with_input_noise(prepared, setting, Adequacy(left, classes)) is None


def _fits() -> tuple[Hypothesis, Fitted, Fitted]:
    """A parameter, and fits without and with it, of evidence 0."""
    prepared, setting = _plain()
    ground = recorded(prepared, setting)
    assert ground is not None
    bare = fitted(ground, (), (), ground.first_noise())
    (cause,) = (h for h in setting.parametric if h.kind == "parameter" and h.path == "k")
    more = fitted(ground, (cause,), ({"value": 0.1},), ground.first_noise())
    return cause, replace(bare, evidence=0.0), replace(more, evidence=0.0)


def test_noise_explains_doubts_away_and_nothing_else() -> None:
    cause, bare, more = _fits()
    less, named = (Adequacy(NOTHING, structure=one) for one in (bare, more))
    doubted = replace(named, doubt=frozenset({cause}))
    assert stands(named, named)
    assert not stands(less, named)
    assert stands(less, doubted)
    assert not stands(doubted, named)
    assert not stands(named, less)
    assert not stands(replace(named, structure=None), named)


@pytest.mark.parametrize(("gained", "stays"), [(3.0, True), (-3.0, True), (-6.0, False)])
def test_less_stands_where_it_is_as_likely(gained: float, stays: bool) -> None:
    cause, bare, more = _fits()
    before = Adequacy(NOTHING, structure=more, doubt=frozenset({cause}))
    less = Adequacy(NOTHING, structure=replace(bare, evidence=gained))
    assert stands(less, before) == stays
    assert stands(replace(before, structure=replace(more, evidence=gained)), before)


def _plain() -> tuple[Prepared, Setting]:
    prepared = prepare(pushed_model(), (pushed(1, samples=400),))
    return prepared, settle(prepared)


@pytest.mark.slow
def test_a_spring_is_named_beside_a_noisy_input() -> None:
    rng = np.random.default_rng(5)
    made = pushed(
        5, samples=SAMPLES, damping=0.9, beside=SIZE * rng.standard_normal(SAMPLES), noise=NOISE / 4
    )
    found = sh.diagnose(pushed_model(), made)
    assert [one.element.kind for one in found.found] == ["damper"]
    assert "looks noisy" in found.sentence
    (entry,) = found.found[0].estimates
    assert entry.sd is not None
    assert abs(entry.value - 0.3) < 3 * entry.sd

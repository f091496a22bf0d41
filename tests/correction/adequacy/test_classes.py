"""Generic classes of effects: each planted effect is of its class, and a law by name beats them."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.signal import cont2discrete

from symhyb.correction.adequacy.classes.catalogue import classes_of
from symhyb.correction.adequacy.classes.columns import smooth
from symhyb.correction.adequacy.classes.erring_input import spared_by
from symhyb.correction.adequacy.classes.held_input import _steps, held_input
from symhyb.correction.adequacy.classes.law import law
from symhyb.correction.adequacy.classes.worth import around, best_of, worth_of, worths_of
from symhyb.correction.adequacy.evidence import evidence
from symhyb.correction.adequacy.explained import may_take
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, Likely, fitted
from symhyb.correction.naming.classes import class_found, classes_said
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from tests.plate import PLATE, plate
from tests.pushed import DAMPING, NOISE, STEP, STIFFNESS, pushed, pushed_model, pushing, setting_of

Array = NDArray[np.float64]
SAMPLES = 1000


def seen(x: Array, force: Array, seed: int) -> Recording:
    noise = NOISE * np.random.default_rng(900 + seed).standard_normal(x.size)
    t = STEP * np.arange(x.size)
    return Recording("made.csv", t, {"f": force}, {"laser": x + noise}, (), "")


def moved(
    seed: int,
    acting: Callable[..., float],
    inner: int = 0,
    rate: Callable[..., list[float]] | None = None,
) -> tuple[Array, Array]:
    """Positions under the recorded push (second) and forces ``acting`` (t, x, v, f) in place of the
    push; ``rate`` are the rates of ``inner`` further states, from (t, state, f)."""
    t = STEP * np.arange(SAMPLES)
    force = pushing(np.random.default_rng(seed), t)
    push = CubicSpline(t, force)

    def rates(time: float, state: Array) -> list[float]:
        x, v = state[:2]
        f = float(push(time))
        total = acting(time, *state, f) - STIFFNESS * x - DAMPING * v
        return [v, total, *(rate(time, state, f) if rate else [])]

    start = np.zeros(2 + inner)
    run = solve_ivp(rates, (0, t[-1]), start, t_eval=t, rtol=1e-8, atol=1e-10, max_step=STEP)
    return run.y[0], force


def saturating() -> Recording:
    return seen(*moved(1, lambda t, x, v, f: 5.0 * np.tanh(f / 5.0)), 1)


def lagging() -> Recording:
    return seen(*moved(2, lambda t, x, v, a, f: a, 1, lambda t, s, f: [(f - s[2]) / 0.08]), 2)


def with_hidden_mode() -> Recording:
    """A mass of 0.15 kg hangs on a spring, 2.9 Hz by itself."""
    w, mass = 2 * np.pi * 2.9, 0.15

    def tension(y: float, u: float, x: float, v: float) -> float:
        return mass * (w**2 * (y - x) + 0.1 * w * (u - v))

    def rate(t: float, s: Array, f: float) -> list[float]:
        return [s[3], -tension(s[2], s[3], s[0], s[1]) / mass]

    return seen(*moved(3, lambda t, x, v, y, u, f: f + tension(y, u, x, v), 2, rate), 3)


def pulsating() -> Recording:
    """The stiffness swings by a tenth at 0.37 Hz."""
    return seen(*moved(4, lambda t, x, v, f: f - 2.5 * np.sin(2 * np.pi * 0.37 * t) * x), 4)


def drifting() -> Recording:
    x, force = moved(5, lambda t, x, v, f: f)
    t = STEP * np.arange(SAMPLES)
    return seen(x + 0.08 * np.sin(2 * np.pi * t / 25), force, 5)


def fading() -> Recording:
    """The gain of the sensor swings by a fifth."""
    x, force = moved(6, lambda t, x, v, f: f)
    t = STEP * np.arange(SAMPLES)
    return seen(x * (1 + 0.2 * np.sin(2 * np.pi * t / 8)), force, 6)


def tried(setting: Recorded) -> tuple[Fitted, list[tuple[float, Generic]]]:
    """The model as it is, and every class with its gain, the largest first."""
    nothing = fitted(setting, (), (), setting.first_noise())
    nothing = replace(nothing, evidence=evidence(setting, nothing))
    start = around(setting, nothing)
    made = [one.make(start) for one in classes_of(setting)]
    gains = [worth_of(start, generic) - np.log(generic.tried) for generic in made]
    order = sorted(range(len(made)), key=lambda i: -gains[i])
    return nothing, [(gains[i], made[i]) for i in order]


def with_class(setting: Recorded, base: Fitted, generic: Generic) -> Fitted:
    noise = setting.revived(base.fit.noise)
    found = fitted(setting, (), (), noise, base.fit.states, extra=generic)
    return replace(found, evidence=evidence(setting, found))


@pytest.mark.parametrize(
    ("made", "kind", "where", "figure"),
    [
        (saturating, "input", "f", None),
        (lagging, "lag", "f", (0.05, 0.13)),  # of 0.08 s, one of five times that are tried
        (with_hidden_mode, "hidden mode", On("x"), (2.5, 3.3)),
        (pulsating, "time-varying", "k", (0.34, 0.40)),
        (drifting, "sensor", "laser", None),
        (fading, "sensor", "laser", None),
    ],
)
def test_a_planted_effect_is_of_its_class(
    made: Callable[[], Recording],
    kind: str,
    where: object,
    figure: tuple[float, float] | None,
) -> None:
    """Of the three classes that the linear problem puts first it has the best evidence by far, and
    leaves less than a fifth of the unknown force; a sensor leaves none that is worth a word."""
    setting = setting_of(pushed_model(), made())
    nothing, offered = tried(setting)
    assert nothing.fit.noise.force[0] > 0.5
    found = [with_class(setting, nothing, generic) for _, generic in offered[:3]]
    found.sort(key=lambda one: -one.evidence)
    best, second = found[:2]
    assert best.extra is not None
    assert (best.extra.kind, best.extra.where) == (kind, where)
    assert best.evidence - max(second.evidence, nothing.evidence) > 20
    if figure is not None:
        assert figure[0] < best.extra.figure < figure[1]
    if kind != "sensor":
        assert best.fit.noise.force[0] < 0.2 * nothing.fit.noise.force[0]


@pytest.mark.parametrize("seed", [6, 7])
def test_no_class_is_worth_its_price_where_nothing_is_missing(seed: int) -> None:
    setting = setting_of(pushed_model(), pushed(seed, samples=SAMPLES))
    nothing, offered = tried(setting)
    assert offered[0][0] < 0
    assert with_class(setting, nothing, offered[0][1]).evidence < nothing.evidence


def test_a_law_by_name_beats_the_class_of_laws() -> None:
    """A hardening spring, at largest as strong as the linear one."""
    setting = setting_of(pushed_model(), seen(*moved(8, lambda t, x, v, f: f - 30.0 * x**3, 0), 8))
    nothing, offered = tried(setting)
    law = next(generic for _, generic in offered if generic.kind == "law")
    generic = with_class(setting, nothing, law)
    cause = Hypothesis("spring", On("x"), ("cubic",), (False,))
    named = fitted(setting, (cause,), ({"cubic": 10.0},), setting.first_noise())
    named = replace(named, evidence=evidence(setting, named))
    assert generic.evidence > nothing.evidence + 20
    assert named.evidence > generic.evidence + 20
    spread = float(np.sqrt(named.fit.covariance[0, 0]))
    assert abs(named.fit.values[0] - 30.0) < 3 * spread


def test_a_damper_is_a_part_of_the_class_of_laws_and_not_needed_beside_it() -> None:
    """A loss that grows with speed to the power of 1.5, which no listed law is."""

    def acting(t: float, x: float, v: float, f: float) -> float:
        return f - 1.2 * np.sign(v) * np.abs(v) ** 1.5

    setting = setting_of(pushed_model(), seen(*moved(9, acting), 9))
    nothing, offered = tried(setting)
    generic = next(one for _, one in offered if one.kind == "law")
    alone = with_class(setting, nothing, generic)
    noise = setting.revived(nothing.fit.noise)
    cause = Hypothesis("damper", On("x"), ("damping",), (True,))
    beside = fitted(setting, (cause,), ({"damping": 0.5},), noise, extra=generic)
    assert alone.evidence > evidence(setting, beside)
    assert alone.fit.noise.force[0] < 0.1 * nothing.fit.noise.force[0]


def ringing() -> Recording:
    """A mass of 0.15 kg on a spring, 2.9 Hz by itself and in motion when the recording begins, as
    it shows on a machine that follows no input."""
    w, t = 2 * np.pi * 2.9, STEP * np.arange(SAMPLES)
    swing = 6.0 * np.exp(-0.01 * w * t) * np.cos(w * t)
    return pushed(10, samples=SAMPLES, beside=swing)


def test_a_mode_may_be_in_motion_when_a_recording_begins() -> None:
    setting = setting_of(pushed_model(), ringing())
    nothing, offered = tried(setting)
    mode = next(one for _, one in offered if one.kind == "hidden mode")
    assert mode.figure == pytest.approx(2.9, rel=0.02)
    assert mode.spread.size == 10  # two of them for how the recording begins
    found = with_class(setting, nothing, mode)
    assert found.evidence > nothing.evidence + 100


def held(samples: int) -> Recording:
    """The machine sees each value of the recorded push for as many samples."""
    t = STEP * np.arange(SAMPLES)
    force = pushing(np.random.default_rng(21), t)
    steps = force[np.arange(SAMPLES) // samples * samples]
    fine = np.repeat(steps, 10)[: 10 * (SAMPLES - 1) + 1]
    times = STEP / 10 * np.arange(fine.size)
    A, B = np.array([[0.0, 1.0], [-STIFFNESS, -DAMPING]]), np.array([[0.0], [1.0]])
    Ad, Bd, *_ = cont2discrete((A, B, np.eye(2), np.zeros((2, 1))), times[1], "zoh")
    states = [np.zeros(2)]
    for value in fine[:-1]:
        states.append(Ad @ states[-1] + Bd[:, 0] * value)
    return seen(np.array(states)[::10, 0], force, 21)


@pytest.mark.parametrize("samples", [2, 4])
def test_a_staircase_is_reported_with_the_time_of_its_steps(samples: int) -> None:
    setting = setting_of(pushed_model(), held(samples))
    nothing, offered = tried(setting)
    best = with_class(setting, nothing, offered[0][1])
    assert best.extra is not None
    assert (best.extra.kind, best.extra.does) == ("input", "holds")
    assert best.extra.figure == pytest.approx(samples * STEP)
    assert best.fit.values[-1] == pytest.approx(1.0, abs=0.02)  # a staircase has no size of its own
    assert best.fit.noise.force[0] < 0.05 * nothing.fit.noise.force[0]


def test_inputs_that_one_clock_holds_are_one_class() -> None:
    setting = setting_of(PLATE, plate(0.0, 0.0))
    nothing = fitted(setting, (), (), setting.first_noise())
    both = held_input(around(setting, nothing), (0, 1))
    assert (both.where, both.other, both.spread.size) == ("f", "g", 2)
    assert class_found(Likely(both, 0.99)).sentence.startswith("The inputs f and g act as")
    assert both.key != held_input(around(setting, nothing), (0,)).key


def test_a_staircase_takes_the_place_of_a_smooth_curve_too() -> None:
    """Between two samples it must act by what it holds, whatever the model has there."""
    t = STEP * np.arange(400)
    values = np.sin(2 * np.pi * 3.0 * t)
    curve = CubicSpline(t, values)
    after, before = _steps(values, 1, 0, bent=True)
    acting = np.array([curve.integrate(a, b) for a, b in pairwise(t)])
    added = STEP * (after[:-1] + before[1:]) / 2
    lines = STEP * (values[:-1] + values[1:]) / 2
    inner = slice(1, -1)
    assert (acting + added)[inner] == pytest.approx((STEP * values[:-1])[inner], abs=1e-5)
    assert np.abs(lines - acting)[inner].max() > 1e-4  # what a line would be off by


def test_a_class_is_made_where_it_could_take_half_of_the_unknown_force() -> None:
    setting = setting_of(PLATE, plate(0.0, 0.0))
    offered = classes_of(setting)
    made = {(one.make.func.__name__, one.pushes) for one in offered}  # type: ignore[attr-defined]
    first, second, both = frozenset((0,)), frozenset((1,)), frozenset((0, 1))
    assert {("law", first), ("law", second), ("hidden_mode", second)} <= made
    assert {("coupling", both), ("input_lag", first), ("crossing_input", second)} <= made
    assert {("sensor_drift", None)} <= made
    nothing = fitted(setting, (), (), setting.first_noise())

    def acting(*force: float, colour: float = 0.0) -> Fitted:
        noise = nothing.fit.noise
        noise = replace(noise, force=np.array(force), colour=np.full_like(noise.colour, colour))
        return replace(nothing, fit=replace(nothing.fit, noise=noise))

    here = acting(0.1, 0.01)
    assert [may_take(setting, here, one) for one in (first, second, both, None)] == [1, 0, 1, 1]
    assert may_take(setting, acting(0.1, 0.01, colour=1e-3), second)
    assert may_take(setting, acting(0.0, 0.0), second)


@pytest.mark.parametrize(
    ("gyroscopic", "leak", "where"), [(0.5, 0.0, On("a")), (0.0, 0.1, "f")], ids=["motion", "input"]
)
def test_a_coupling_is_reported(gyroscopic: float, leak: float, where: object) -> None:
    setting = setting_of(PLATE, plate(gyroscopic, leak))
    assert [spared_by(setting, which) for which in (0, 1)] == [[1], [0]]
    nothing, offered = tried(setting)
    best = offered[0][1]
    assert (best.kind, best.where) == ("coupling", where)
    found = with_class(setting, nothing, best)
    assert found.evidence - nothing.evidence > 100
    if leak:
        assert found.fit.values[-1] == pytest.approx(leak, abs=0.01)
    else:
        assert found.fit.values[[1, 3]] == pytest.approx([-gyroscopic, gyroscopic], abs=0.05)


def test_a_smooth_function_is_a_gaussian_process() -> None:
    """Its covariance is Matern 5/2, and beyond its ends it is constant."""
    values = np.array([-4.0, -1.0, 0.0, 0.5, 3.0, 9.0])
    columns = smooth(values, -1.0, 3.0, 0.4)
    at = np.clip((2 * values - 2.0) / 4.0, -1, 1)
    far = np.sqrt(5) * np.abs(at[:, None] - at) / 0.4
    assert columns @ columns.T == pytest.approx((1 + far + far**2 / 3) * np.exp(-far), abs=2e-3)


def test_what_a_group_is_worth_is_that_of_its_columns_alone() -> None:
    setting = setting_of(pushed_model(), saturating())
    nothing = fitted(setting, (), (), setting.first_noise())
    start = around(setting, nothing)
    made = law(start, 0)
    for rows in (range(2), range(2, 5)):
        each = tuple(
            replace(o, force=o.force[:, :, rows], output=o.output[:, :, rows]) for o in made.each
        )
        alone = replace(made, each=each, spread=made.spread[rows], mean=made.mean[rows])
        grouped = worths_of(start, made, [rows])
        assert worth_of(start, alone) == pytest.approx(float(grouped[0]), rel=1e-6)


def test_the_best_of_several_pays_for_all() -> None:
    setting = setting_of(pushed_model(), saturating())
    start = around(setting, fitted(setting, (), (), setting.first_noise()))
    first = law(start, 0)
    worse = replace(first, each=tuple(replace(o, force=0 * o.force) for o in first.each))
    chosen = best_of(start, [worse, first, worse])
    assert chosen.each is first.each
    assert chosen.tried == 3


def test_coefficients_that_are_known_cost_nothing() -> None:
    """A column with a prior that is narrow about its true size is worth more than a free one."""
    setting = setting_of(pushed_model(), held(2))
    start = around(setting, fitted(setting, (), (), setting.first_noise()))
    stairs = next(g for g in (one.make(start) for one in classes_of(setting)) if g.does == "holds")
    free = replace(stairs, spread=np.array([1.0]), mean=np.zeros(1))
    wrong = replace(stairs, mean=-stairs.mean)
    assert worth_of(start, stairs) > worth_of(start, free) > 100 > worth_of(start, wrong)


def test_all_noisy_inputs_are_one_sentence() -> None:
    noisy = [
        Likely(Generic("input", name, (), np.zeros(0), does="noisy"), chance)
        for name, chance in (("f", 0.99), ("g", 0.97), ("h", 0.98))
    ]
    drifts = Likely(Generic("sensor", "laser", (), np.zeros(0), does="drifts"), 0.96)
    assert classes_said([*noisy, drifts]) == [
        "The records of the inputs f, g and h look noisy: other forces act (probability 97 %).",
        class_found(drifts).sentence,
    ]
    assert classes_said(noisy[:1]) == [class_found(noisy[0]).sentence]

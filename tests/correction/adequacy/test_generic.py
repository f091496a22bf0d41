"""Generic classes of effects: each planted effect is of its class, and a law by name beats them."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from symhyb.correction.adequacy.evidence import evidence
from symhyb.correction.adequacy.generic import classes_of, gain_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, fitted
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
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


def tried(setting: Recorded) -> tuple[Fitted, list[tuple[float, Generic]]]:
    """The model as it is, and every class with its gain, the largest first."""
    nothing = fitted(setting, (), (), setting.first_noise())
    nothing = replace(nothing, evidence=evidence(setting, nothing))
    made = [maker(setting, nothing) for maker in classes_of(setting)]
    gains = [float(gain_of(setting, nothing, generic)[0]) for generic in made]
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


def test_a_gain_is_that_of_the_group_alone() -> None:
    """The gain of a pair of columns is that of a class of these two."""
    setting = setting_of(pushed_model(), saturating())
    nothing = fitted(setting, (), (), setting.first_noise())
    pair = next(m(setting, nothing) for m in classes_of(setting) if m.keywords == {"which": 0})
    size = pair.spread.size // 2 * 2
    each = tuple(
        replace(one, force=one.force[:, :, :size], output=one.output[:, :, :size])
        for one in pair.each
    )
    even = replace(pair, each=each, spread=pair.spread[:size])
    grouped = gain_of(setting, nothing, even, 2)
    assert grouped.shape == (size // 2,)
    for i in (0, size // 2 - 1):
        cut = slice(2 * i, 2 * i + 2)
        alone = replace(
            even,
            each=tuple(
                replace(o, force=o.force[:, :, cut], output=o.output[:, :, cut]) for o in each
            ),
            spread=even.spread[cut],
        )
        assert gain_of(setting, nothing, alone)[0] == pytest.approx(grouped[i], rel=1e-6)

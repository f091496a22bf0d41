"""Viscous damping that stands for dry friction and drag together, in the decay of a pendulum."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from builders import model_of, recording
from scipy.integrate import solve_ivp

from symhyb.correction.search.conventions import exchange
from symhyb.correction.search.evidence import NEAR_NOISE
from symhyb.correction.search.losses import two_for_one
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.selection import Problem
from symhyb.correction.search.setting import along_motion
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Trials
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import Model, On

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


def instead_of(kinds: tuple[str, ...], one: Recording, model: Model | None = None) -> list[Refined]:
    """What takes the place of plain laws of these kinds, fitted to a recording."""
    trials, winner, problem = fitted(kinds, one, model)
    return list(two_for_one(trials, winner, problem))


def fitted(
    kinds: tuple[str, ...], one: Recording, model: Model | None = None
) -> tuple[Trials, Refined, Problem]:
    """Plain laws of these kinds, fitted to a recording."""
    setting = settle(prepare(model or pendulum(), one))
    variants = {i for i, cause in enumerate(setting.hypotheses) if cause.variant}
    trials = Trials(setting, variants, lambda line: None)
    known = setting.hypotheses
    chosen = [
        next(i for i, c in enumerate(known) if c.kind == kind and c.numbers == 1) for kind in kinds
    ]
    problem = along_motion(setting, setting.stages[-1])
    first = {"damper": "damping", "friction": "coulomb", "drag": "drag"}
    rows = [{first[kind]: 0.02} for kind in kinds]
    for cause, row in zip(chosen, rows, strict=True):
        row |= {key: value for key, value in known[cause].values([0.02]).items() if key not in row}
    return trials, trials.refined(chosen, rows), problem


def test_dry_friction_and_drag_take_the_place_of_the_damping_that_imitates_them() -> None:
    (found,) = instead_of(("damper",), swing(lambda v: dry(v) + 0.004 * abs(v) * v))
    values = dict(zip((cause.kind for cause in found.causes), grouped(found), strict=True))
    assert set(values) == {"friction", "drag"}
    assert values["friction"]["coulomb"] == pytest.approx(0.15, rel=0.07)
    assert values["drag"]["drag"] == pytest.approx(0.004, rel=0.07)


def test_they_do_so_where_the_damping_alone_comes_down_to_the_noise() -> None:
    """A machine that is shaken at one frequency, so that its amplitude hardly changes."""
    m, c, b, level, push, f = 1.96, 13.8, 0.77, 0.29, 12.9, 1.1

    def acceleration(t: float, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        loss = b * np.abs(v) * v + level * np.tanh(v / 1e-3)
        return np.asarray((push * np.sin(2 * np.pi * f * t) - c * x**3 - loss) / m)

    def rate(t: float, y: np.ndarray) -> list[float]:
        return [y[1], float(acceleration(t, y[0], y[1]))]

    t = np.arange(0, 14, STEP)
    x, v = solve_ivp(rate, (0, 14), [0.4, 0], "DOP853", t, rtol=1e-8, atol=1e-10, max_step=5e-3).y
    random = np.random.default_rng(3)
    noisy = (
        y + 0.025 * np.abs(y).max() * random.standard_normal(t.size)
        for y in (x, v, acceleration(t, x, v))
    )
    shaken = model_of(
        coordinates={"q": {"unit": "m"}},
        parameters={"m": (m, "kg"), "c": (c, "N/m^3"), "F": (push, "N"), "f": (f, "Hz")},
        energy={"kinetic": "m*q'**2/2", "potential": "c*q**4/4"},
        elements={"s": {"kind": "harmonic", "on": "q", "amplitude": "F", "frequency": "f"}},
        sensors={
            "x": {"measures": "q", "unit": "m"},
            "v": {"measures": "q'", "unit": "m/s"},
            "a": {"measures": "q''", "unit": "m/s^2"},
        },
    )
    one = recording(t, **dict(zip("xva", noisy, strict=True)))
    assert fitted(("damper",), one, shaken)[1].fit.scale < NEAR_NOISE
    (found,) = instead_of(("damper",), one, shaken)
    values = dict(zip((cause.kind for cause in found.causes), grouped(found), strict=True))
    assert values["friction"]["coulomb"] == pytest.approx(level, rel=0.15)
    assert values["drag"]["drag"] == pytest.approx(b, rel=0.15)


def test_friction_and_drag_are_a_rival_of_the_damping_that_imitates_them() -> None:
    def law(kind: str, on: str = "x", numbers: int = 1) -> Hypothesis:
        return Hypothesis(kind, On(on), ("damping",) * numbers, (True,) * numbers)

    both = (law("friction"), law("drag"))
    assert exchange(both, (law("damper"),)).imitated
    assert not exchange((*both, law("spring")), (law("damper"),)).imitated
    assert not exchange((law("friction", "y"), law("drag")), (law("damper"),)).imitated
    assert not exchange((law("friction"), law("drag")), (law("spring"),)).imitated
    assert not exchange((law("friction", numbers=2), law("drag")), (law("damper"),)).imitated


def test_viscous_damping_stays_where_something_else_is_left() -> None:
    def loss(v: float) -> float:
        return 0.05 * v + 0.03 * np.tanh(v / 2)

    assert instead_of(("damper",), swing(loss)) == []


def test_damping_beside_another_loss_and_damping_that_says_it_all_stay() -> None:
    both = swing(lambda v: dry(v) + 0.03 * v)
    assert instead_of(("damper", "friction"), both) == []
    assert instead_of(("drag",), both) == []
    assert instead_of(("damper",), swing(lambda v: 0.05 * v)) == []

"""One cause more over whole recordings: a weak damping beside a strong one in a free decay."""

from functools import cache

import numpy as np
import pytest
from builders import model_of, recording, spring
from scipy.integrate import solve_ivp

from symhyb.correction.search.decision import Decision
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.trajectory import Refined, refine
from symhyb.correction.verdict.choice import Choice
from symhyb.correction.verdict.whole import Completed, completed_over_all, forgets, whole_of
from symhyb.correction.verdict.whole_words import added_alternatives, added_sentence
from symhyb.data.recording import Recording
from symhyb.model.types import Model

DRAG, STIFFNESS, NOISE, STEP = 0.1, 6.0, 2e-4, 0.05


@cache
def roll() -> Model:
    """An inertia of 1 kg·m² on a spring, in its angle alone."""
    return model_of(
        coordinates={"phi": {"unit": "rad"}},
        parameters={"J": (1.0, "kg*m^2"), "K": (STIFFNESS, "N*m")},
        energy={"kinetic": "J*phi'**2/2"},
        elements={"righting": spring("K", "phi")},
        sensors={"roll": {"measures": "phi", "unit": "rad"}},
    )


def decay(size: float, power: float) -> Recording:
    """A free decay of 60 s under drag and a loss of ``size`` times a power of the speed, with
    white noise of 0.2 mrad."""

    def rate(_: float, state: np.ndarray) -> list[float]:
        x, v = state
        lost = DRAG * abs(v) * v + size * np.tanh(v / 1e-4) * abs(v) ** power
        return [v, -STIFFNESS * x - lost]

    t = np.arange(0, 60, STEP)
    x = solve_ivp(rate, (0, 60), [0.3, 0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=0.02).y[0]
    return recording(t, roll=x + NOISE * np.random.default_rng(1).standard_normal(t.size))


def chosen(one: Recording) -> tuple[Prepared, Choice]:
    """The recording with the drag alone chosen, at the windows that decide."""
    prepared = prepare(roll(), one)
    setting = settle(prepared)
    (drag,) = [cause for cause in setting.hypotheses if cause.kind == "drag"]
    cuts, model = setting.stages[-1].cuts, prepared.model
    nothing = refine(model, (), (), cuts, setting.sd)
    selected = refine(model, (drag,), ({"drag": DRAG},), cuts, setting.sd, careful=True)
    decision = Decision(selected, nothing, (selected,), (), ())
    return prepared, Choice(setting, decision, (), None, ())


def completed(one: Recording) -> Completed | None:
    return completed_over_all(*chosen(one), lambda line: None)


def value_of(trial: Refined, key: str) -> tuple[float, float]:
    return trial.value(next(path for path in trial.paths if path.endswith(f".{key}")))


@pytest.mark.parametrize(
    ("size", "power", "kind", "key"),
    [(0.006, 1.0, "damper", "damping"), (0.002, 0.0, "friction", "coulomb")],
)
def test_a_weak_loss_beside_drag_is_reported_over_the_whole_decay(
    size: float, power: float, kind: str, key: str
) -> None:
    found = completed(decay(size, power))
    assert found is not None
    assert (found.added.kind, found.rivals) == (kind, ())
    value, sd = value_of(found.final, key)
    assert abs(value - size) < 4 * sd < 0.3 * size
    drag, sd = value_of(found.final, "drag")
    assert abs(drag - DRAG) < 4 * sd < 0.1 * DRAG  # alone it came out a tenth too large
    assert added_alternatives(roll(), found) == ()
    assert "shows only over the whole" in added_sentence(roll(), found)


def test_of_two_losses_that_leave_as_much_none_is_reported() -> None:
    """A loss with the root of the speed is half way between dry and linear."""
    found = completed(decay(0.006, 0.5))
    assert found is not None
    both = added_alternatives(roll(), found)
    assert {row.kind for row in both} == {"friction", "damper"}
    assert [row.evidence for row in both] == sorted(row.evidence for row in both)
    assert "cannot tell which" in added_sentence(roll(), found)


def test_nothing_is_added_where_nothing_is_left() -> None:
    assert completed(decay(0.0, 1.0)) is None


def test_a_mass_without_a_spring_does_not_forget_where_it_began() -> None:
    free = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "d": (0.5, "N*s/m")},
        energy={"kinetic": "m*x'**2/2"},
        inputs={"f": {"unit": "N"}},
        elements={
            "push": {"kind": "force", "on": "x", "force": "f"},
            "oil": {"kind": "damper", "on": "x", "damping": "d"},
        },
        sensors={"x": {"measures": "x", "unit": "m"}},
    )
    t = np.arange(0, 30, STEP)
    f = np.sin(2 * t)
    at = -0.4 * np.exp(-0.5 * t) - (4 * np.sin(2 * t) + np.cos(2 * t)) / 17
    noise = 1e-4 * np.random.default_rng(2).standard_normal(t.size)
    assert not _forgotten(free, recording(t, {"f": f}, x=at + noise))
    assert _forgotten(roll_with_damping(), decay(0.1, 1.0))


def roll_with_damping() -> Model:
    return model_of(
        coordinates={"phi": {"unit": "rad"}},
        parameters={"J": (1.0, "kg*m^2"), "K": (STIFFNESS, "N*m"), "d": (0.1, "N*m*s/rad")},
        energy={"kinetic": "J*phi'**2/2"},
        elements={
            "righting": spring("K", "phi"),
            "oil": {"kind": "damper", "on": "phi", "damping": "d"},
        },
        sensors={"roll": {"measures": "phi", "unit": "rad"}},
    )


def _forgotten(model: Model, one: Recording) -> bool:
    prepared = prepare(model, one)
    setting = settle(prepared)
    stage = whole_of(prepared, setting)
    assert stage is not None
    assert [len(item.start) for item in stage.cuts] == [1]
    return forgets(refine(prepared.model, (), (), stage.cuts, setting.sd, everything=True), stage)

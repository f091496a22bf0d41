"""The structures that a search begins with: parameters that are known to their sd alone are fitted
along, and what jumps is carried from short windows to long ones."""

from functools import cache

import numpy as np
import pytest
from builders import model_of, recording
from scipy.integrate import solve_ivp

from symhyb.correction.search import first_structures
from symhyb.correction.search.first_structures import begun_along
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.selection import Problem, Subset
from symhyb.correction.search.setting import Setting, along_motion
from symhyb.correction.search.trials import Trials

PLAY, STIFFNESS, BEARING, LOAD = 0.06, 230.0, 0.8, 1.5
NOISE = 3e-5  # rad


def torque(t: float) -> float:
    """What drives the motor, N·m."""
    return float(
        4 * np.sin(2 * np.pi * 0.45 * t)
        + 3 * np.sin(2 * np.pi * 1.1 * t + 1)
        + 2 * np.sin(2 * np.pi * 0.2 * t)
    )


@cache
def geared(stated: bool = True) -> Setting:
    """A shaft with play, recorded for 40 s; the model has none, and states or does not state an sd
    of the shaft and two bearings, which are off."""

    def off(value: float, unit: str, sd: float) -> dict[str, object]:
        return {"value": value, "unit": unit, **({"sd": sd} if stated else {})}

    model = model_of(
        coordinates={"a": {"unit": "rad"}, "b": {"unit": "rad"}},
        parameters={
            "J": (1.0, "kg*m^2"),
            "I": (2.0, "kg*m^2"),
            "k": off(200.0, "N*m/rad", 30.0),
            "c": off(0.5, "N*m*s/rad", 0.25),
            "d": off(1.0, "N*m*s/rad", 0.3),
        },
        inputs={"M": {"unit": "N*m", "between": "smooth"}},
        energy={"kinetic": "J*a'**2/2 + I*b'**2/2", "potential": "k*(a-b)**2/2"},
        elements={
            "drive": {"kind": "law", "on": "a", "torque": "M"},
            "bearing": {"kind": "damper", "on": "a", "damping": "c"},
            "load": {"kind": "damper", "on": "b", "damping": "d"},
        },
        sensors={
            "ea": {"measures": "a", "unit": "rad"},
            "eb": {"measures": "b", "unit": "rad"},
        },
    )

    def rate(t: float, state: np.ndarray) -> list[float]:
        a, b, v, w = state
        f = STIFFNESS * (a - b - np.clip(a - b, -PLAY, PLAY))
        return [v, w, torque(t) - BEARING * v - f, (f - LOAD * w) / 2]

    t = np.arange(0, 40, 0.01)
    motion = solve_ivp(rate, (0, 40), [0] * 4, "DOP853", t, rtol=1e-9, atol=1e-11, max_step=0.005).y
    noise = NOISE * np.random.default_rng(1).standard_normal((2, t.size))
    drive = np.array([torque(one) for one in t])
    rows = recording(t, {"M": drive}, ea=motion[0] + noise[0], eb=motion[1] + noise[1])
    return settle(prepare(model, rows))


@pytest.mark.slow
def test_play_is_carried_to_long_windows_with_all_parameters_that_state_an_sd() -> None:
    setting = geared()
    trials, told = Trials(setting, lambda line: None), setting.stages
    problems = [along_motion(setting, stage) for stage in told]
    begun = list(begun_along(trials, trials.refined(()), problems))
    every = {"k", "c", "d"}
    for causes, _ in begun:
        assert {trials.known[i].path for i in causes if trials.known[i].place is None} == every
    assert [len(causes) for causes, _ in begun] == sorted(len(causes) for causes, _ in begun)
    causes, rows = next((c, r) for c, r in begun if any(trials.known[i].kind == "gap" for i in c))
    kinds = [trials.known[i].path or trials.known[i].kind for i in causes]
    found = dict(zip(kinds, trials.carried(causes, rows), strict=True))
    assert found["gap"]["clearance"] == pytest.approx(PLAY, rel=1e-3)
    assert found["gap"]["stiffness"] == pytest.approx(STIFFNESS, rel=1e-3)
    assert found["k"]["value"] == pytest.approx(-200, rel=1e-3)
    assert found["c"]["value"] == pytest.approx(BEARING - 0.5, rel=0.01)
    assert found["d"]["value"] == pytest.approx(LOAD - 1.0, rel=0.01)


@pytest.mark.slow
def test_without_a_stated_sd_nothing_more_is_begun_with() -> None:
    setting = geared(stated=False)
    trials = Trials(setting, lambda line: None)
    problems = [along_motion(setting, setting.stages[0])]
    assert not list(begun_along(trials, trials.refined(()), problems))


@pytest.mark.slow
def test_a_parameter_that_is_in_every_structure_is_in_none_twice(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What is known to its sd can be told from itself, so that a screen may choose it once more."""
    setting = geared()
    trials = Trials(setting, lambda line: None)
    problem = along_motion(setting, setting.stages[0])
    first = next(i for i, one in enumerate(problem.hypotheses) if one.kind == "parameter")

    def greedy(problem: Problem, largest: int) -> list[list[Subset]]:
        nothing = Subset((), np.empty(0), 1e12, 0.0, 0)
        return [[nothing], [Subset((first,), np.zeros(1), 1.0, 0.0, 1)]][: largest + 1]

    monkeypatch.setattr(first_structures, "best_subsets", greedy)
    for causes, _ in begun_along(trials, trials.refined(()), [problem]):
        assert len({*causes}) == len(causes)

"""Least squares of forces: rows of the weak form, and as many causes as act."""

import numpy as np
import pytest
from builders import model_of
from law_rigs import RIG, on_rig
from rigs import spring_model, spring_recording
from scipy.integrate import solve_ivp

from symhyb.correction.search import force_screen as screens
from symhyb.correction.search.force_screen import ForceScreen, force_screen, weak_rows
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.setting import Setting
from symhyb.data.recording import Recording
from symhyb.model.read import parse_model
from symhyb.model.types import Model

BAND = 5.0
MASSES = 4
STIFFNESS = 300.0  # N/m, between neighbours and to the ground
LACKING = (0.5, 1.0, 0.8, 0.6)  # kg, beside 1 kg each: half of the machine is not in the model
DAMPING = (2.0, 1.0, 3.0, 1.5)  # N·s/m, each on the ground


def rig() -> tuple[Prepared, Setting]:
    prepared = prepare(spring_model(), spring_recording(5, {"drag": 2.0}, duration=6.0))
    return prepared, settle(prepared)


def chain() -> Model:
    """Four masses in a row, each pushed, of which the model knows 1 kg each and no loss."""
    names = [f"x{i}" for i in range(MASSES)]
    springs = {
        f"spring{i}": {
            "kind": "spring",
            "on": names[i] if i == 0 else f"{names[i]} - {names[i - 1]}",
            "stiffness": "k",
        }
        for i in range(MASSES)
    }
    shakers = {
        f"shaker{i}": {"kind": "force", "on": names[i], "force": f"f{i}"} for i in range(MASSES)
    }
    return model_of(
        coordinates={name: {"unit": "m"} for name in names},
        parameters={"k": (STIFFNESS, "N/m"), "m": (1.0, "kg")},
        inputs={f"f{i}": {"unit": "N", "between": "smooth"} for i in range(MASSES)},
        bodies={f"mass{i}": {"mass": "m", "at": [names[i], "0"]} for i in range(MASSES)},
        elements={**springs, **shakers},
        sensors={f"laser{i}": {"measures": names[i], "unit": "m"} for i in range(MASSES)},
    )


def recorded() -> Recording:
    random = np.random.default_rng(2)
    t = np.arange(0, 12.0, 0.01)
    lines = np.linspace(0.4, 4.0, 12)
    phases = random.uniform(0, 2 * np.pi, (MASSES, 12))
    mass, damping = 1.0 + np.array(LACKING), np.array(DAMPING)
    stiffness = STIFFNESS * (np.diag([2.0] * (MASSES - 1) + [1.0]) - np.eye(MASSES, k=1))
    stiffness -= STIFFNESS * np.eye(MASSES, k=-1)

    def force(time: float) -> np.ndarray:
        return 3 * np.sin(2 * np.pi * lines * time + phases).sum(axis=1)

    def rate(time: float, state: np.ndarray) -> np.ndarray:
        x, v = state[:MASSES], state[MASSES:]
        return np.concatenate([v, (force(time) - stiffness @ x - damping * v) / mass])

    run = solve_ivp(rate, (0, t[-1]), np.zeros(2 * MASSES), t_eval=t, rtol=1e-9, atol=1e-11)
    x = run.y[:MASSES]
    seen = x + 2e-4 * x.std() * random.standard_normal(x.shape)
    pushed = np.array([force(time) for time in t]).T
    return Recording(
        "chain.csv",
        t,
        {f"f{i}": pushed[i] for i in range(MASSES)},
        {f"laser{i}": seen[i] for i in range(MASSES)},
        (),
        "",
    )


def screened(prepared: Prepared, setting: Setting) -> ForceScreen | None:
    cuts = setting.stages[0].cuts
    return force_screen(prepared.machine, setting.library, cuts, BAND / prepared.shortest)


def test_rows_by_blocks_are_the_same_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    prepared, setting = rig()
    given = prepared.machine, setting.library, setting.stages[0].cuts[0], BAND / prepared.shortest
    whole = list(weak_rows(*given))
    monkeypatch.setattr(screens, "BLOCK", 1)
    parts = list(weak_rows(*given))
    assert len(parts) == len(given[2].rows) > len(whole)
    for i in range(2):
        joined = [np.concatenate([pair[i] for pair in pairs]) for pairs in (whole, parts)]
        np.testing.assert_allclose(joined[1], joined[0], rtol=1e-12, atol=1e-14)


def test_what_is_left_is_that_of_the_rows() -> None:
    prepared, setting = rig()
    found = screened(prepared, setting)
    assert found is not None
    given = prepared.machine, setting.library, setting.stages[0].cuts[0], BAND / prepared.shortest
    rows = np.concatenate([part.reshape(-1, part.shape[3]) for _, part in weak_rows(*given)])
    assert 0.2 * len(rows) < found.rows < len(rows)
    best = found.whole(5.0, set())
    assert best is not None
    names = [str(found.hypotheses[i]) for i in best.causes]
    assert "drag (drag) on x" in names
    columns = [c for i in best.causes for c in found.columns[i]]
    left = float(np.sum((rows[:, -1] - rows[:, columns] @ best.values) ** 2))
    assert found.left(best) == pytest.approx([left], rel=1e-6)


@pytest.mark.thorough
def test_every_mass_and_loss_of_a_chain_is_seen_at_once() -> None:
    prepared = prepare(chain(), recorded())
    setting = settle(prepared)
    found = screened(prepared, setting)
    assert found is not None
    best = found.whole(2 * np.log(len(found.hypotheses)), set())
    assert best is not None
    values = dict(zip([str(found.hypotheses[i]) for i in best.causes], best.values, strict=True))
    expected = {f"added_mass (mass) on x{i}": LACKING[i] for i in range(MASSES)}
    expected |= {f"damper (damping) on x{i}": DAMPING[i] for i in range(MASSES)}
    assert values.keys() == expected.keys()
    for name, value in expected.items():
        assert values[name] == pytest.approx(value, rel=0.05), name


def test_what_may_not_be_chosen_is_not() -> None:
    prepared, setting = rig()
    found = screened(prepared, setting)
    assert found is not None
    (drag,) = [i for i, h in enumerate(found.hypotheses) if str(h) == "drag (drag) on x"]
    best = found.whole(5.0, {drag})
    assert best is None or drag not in best.causes


def test_rows_that_are_not_finite_show_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    prepared, setting = rig()
    size = sum(map(len, setting.library.columns)) + 1
    nothing = np.zeros(3, bool), np.full((3, 3, 1, size), np.nan)
    monkeypatch.setattr(screens, "weak_rows", lambda *_: iter([nothing]))
    assert screened(prepared, setting) is None


def test_a_machine_whose_motion_is_imposed_has_no_screen() -> None:
    sliding = on_rig(lambda x, v, z, f: (2.0 * np.tanh(v / 1e-3), 0.0), 1, duration=4.0)
    prepared = prepare(parse_model(RIG, "rig.toml"), sliding)
    assert screened(prepared, settle(prepared)) is None

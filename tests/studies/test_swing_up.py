"""The pole that is swung up: the engine is right, and the kept forces do what the page says."""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.numeric.kernels import compiled
from tests.scripts import scripts

FOLDER = Path(__file__).parents[2] / "studies" / "swing_up"
NAMES = ("engine", "generate", "plan", "feedback", "swing")
needs_compiler = pytest.mark.skipif(compiled.find_compiler() is None, reason="no C compiler")


@pytest.fixture(scope="module")
def study() -> Iterator[ModuleType]:
    """The study, scripts beside each other."""
    with scripts("swing_up", NAMES) as found:
        yield found["swing"]


@pytest.fixture(scope="module")
def engine(study: ModuleType) -> ModuleType:
    return sys.modules["engine"]


@pytest.fixture(scope="module")
def kept() -> dict:
    return json.loads((FOLDER / "results.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def pushes() -> dict[str, np.ndarray]:
    """The forces (K,) that were planned, by model."""
    columns = np.genfromtxt(FOLDER / "plans.csv", delimiter=",", names=True)
    return {name.replace("_", " "): columns[name] for name in columns.dtype.names}


def test_without_friction_the_engine_moves_as_lagrange_says(engine: ModuleType) -> None:
    """(m_c + m_p) x'' + m_p a (φ'' cos φ − φ'² sin φ) = u,  (J + m_p a²) φ'' + m_p a (x'' cos φ +
    g sin φ) = −d φ'."""
    e, t = engine, np.linspace(0, 3, 301)
    push = 4 * np.sin(5 * t)

    def rates(s: float, y: np.ndarray) -> np.ndarray:
        _, phi, v, w = y
        arm, total = e.POLE * e.ARM, e.CART + e.POLE
        cross = arm * np.cos(phi)
        mass = np.array([[total, cross], [cross, e.INERTIA + arm * e.ARM]])
        turning = -0.01 * w - arm * e.GRAVITY * np.sin(phi)
        acting = [np.interp(s, t, push) + arm * w**2 * np.sin(phi), turning]
        return np.array([v, w, *np.linalg.solve(mass, acting)])

    start = np.array([0.1, 2.0, -0.3, 1.0])
    known = solve_ivp(rates, (0, 3), start, "DOP853", t, rtol=1e-10, atol=1e-12, max_step=0.01)
    found = e.replay(e.Machine(0.0, 0.01), start, push, 0.01)
    assert found == pytest.approx(known.y.T, abs=1e-6)


def test_dry_friction_holds_and_takes_the_energy_that_it_must(engine: ModuleType) -> None:
    e, h = engine, 1e-3
    real, hanging = e.Machine(), np.zeros(4)
    still = e.replay(real, hanging, np.full(50, 0.99 * e.COULOMB), 0.01)
    assert (still == 0).all()
    assert e.replay(real, hanging, np.full(50, 1.01 * e.COULOMB), 0.01)[-1, 0] > 0
    t = h * np.arange(1501)
    push = 5 * np.sin(7 * t)
    states = e.replay(real, hanging, push, h)
    x, phi, v, w = states.T
    assert (v == 0).sum() > 10  # it sticks at times
    arm = e.POLE * e.ARM
    energy = (
        0.5 * (e.CART + e.POLE) * v**2 + arm * v * w * np.cos(phi) - arm * e.GRAVITY * np.cos(phi)
    )
    energy += 0.5 * (e.INERTIA + arm * e.ARM) * w**2
    supplied = np.sum(0.5 * (push[1:] * v[1:] + push[:-1] * v[:-1])) * h
    rubbed = e.COULOMB * np.sum(np.abs(np.diff(x))) + e.DAMPING * np.sum(w**2) * h
    assert energy[-1] - energy[0] == pytest.approx(supplied - rubbed, abs=1e-3 * supplied)


@pytest.mark.parametrize("name", ["holdout.csv", pytest.param("train.csv", marks=pytest.mark.slow)])
def test_the_recordings_are_what_the_generator_makes(
    study: ModuleType, engine: ModuleType, name: str
) -> None:
    rows = sys.modules["generate"].recording(engine.Machine(), name)
    file = np.loadtxt(FOLDER / name, delimiter=",", skiprows=1)
    assert file == pytest.approx(rows, abs=1e-4)


def test_the_correction_is_appended_and_names_what_is_concealed(engine: ModuleType) -> None:
    given, text = (
        (FOLDER / name).read_text(encoding="utf-8") for name in ("machine.toml", "corrected.toml")
    )
    assert text.startswith(given)
    corrected = sh.read_model(FOLDER / "corrected.toml")
    added = {item.name: item for item in corrected.elements if item.found}
    assert {item.kind for item in added.values()} == {"friction", "damper"}
    machine = sh.build(corrected)
    friction = machine.values[machine.column("found_friction.F_c")]
    damping = machine.values[machine.column("found_damper.d")]
    assert friction == pytest.approx(engine.COULOMB, rel=0.01)
    assert damping == pytest.approx(engine.DAMPING, rel=0.02)


def test_the_kept_forces_do_in_the_engine_what_is_reported(
    study: ModuleType, engine: ModuleType, kept: dict, pushes: dict[str, np.ndarray]
) -> None:
    """The engine alone: the pole comes upright with the corrected model's force, and only so."""
    feedback = sys.modules["feedback"]
    for name in ("as given", "corrected", "concealed values"):
        states = engine.replay(engine.Machine(), np.zeros(4), pushes[name], feedback.STEP)
        place, angle, _, _ = feedback.off(states[-1])
        reported = kept[name]["force alone"]
        assert angle == pytest.approx(reported["angle"], abs=1e-4)
        assert place == pytest.approx(reported["place"], abs=1e-4)
        assert np.abs(pushes[name]).max() < 8.05
    assert abs(kept["as given"]["force alone"]["angle"]) > 1.0
    assert not kept["as given"]["force alone"]["held"]
    assert abs(kept["corrected"]["force alone"]["angle"]) < np.radians(2)
    assert abs(kept["corrected"]["force alone"]["place"]) < 5e-3
    assert kept["corrected"]["force alone"]["held"]


def test_what_was_learned_with_other_noise_swings_up_too(kept: dict) -> None:
    rows = [row for name, row in kept.items() if name.startswith("noise ")]
    assert rows
    for row in rows:
        assert "friction of 1.5" in row["sentence"]
        assert "viscous damping of 0.0040" in row["sentence"]
        assert abs(row["force alone"]["angle"]) < np.radians(5)
        assert row["force alone"]["held"]


@needs_compiler
def test_each_model_promises_that_its_force_ends_upright(
    study: ModuleType, pushes: dict[str, np.ndarray]
) -> None:
    """Runs with error control; of the force of the other plan they say no such thing."""
    for name, file in (("as given", "machine.toml"), ("corrected", "corrected.toml")):
        machine = sh.build(sh.read_model(FOLDER / file))
        t = np.arange(pushes[name].size) * sys.modules["feedback"].STEP
        ends = {}
        for other in ("as given", "corrected"):
            u = pushes[other][:, None]
            run = sh.simulate(machine, sh.Scenario(t, np.zeros(2), np.zeros(2), t, u))
            assert run.complete
            ends[other] = np.abs([*run.q[-1] - [0, np.pi], *run.v[-1]])
        assert ends.pop(name).max() < 1e-3
        (foreign,) = ends.values()
        assert foreign[1] > 0.5


@pytest.mark.slow
@needs_compiler
def test_planning_and_playing_again_gives_what_is_kept(study: ModuleType, kept: dict) -> None:
    """Both plans anew, alone and with feedback along them."""
    for name, file in (("as given", "machine.toml"), ("corrected", "corrected.toml")):
        played, _ = study.play(study.planned(sh.read_model(FOLDER / file)))
        for way, one in played.items():
            reported = kept[name][way]
            assert one.angle == pytest.approx(reported["angle"], abs=2e-3)
            assert one.place == pytest.approx(reported["place"], abs=2e-3)
            assert one.held == reported["held"]

"""The simulated fleet of drives: the generator is right, and its score counts as it says."""

from collections.abc import Iterator, Mapping
from types import ModuleType

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.scripts import scripts


@pytest.fixture(scope="module")
def study() -> Iterator[Mapping[str, ModuleType]]:
    with scripts("fleet", ("generate", "score")) as found:
        yield found


def short(monkeypatch: pytest.MonkeyPatch, make: ModuleType, step: float = 1e-4) -> None:
    monkeypatch.setattr(make, "LASTS", 0.2)
    monkeypatch.setattr(make, "STEP", step)


def test_a_drive_moves_as_its_equation_says(
    study: Mapping[str, ModuleType], monkeypatch: pytest.MonkeyPatch
) -> None:
    make = study["generate"]
    short(monkeypatch, make)
    one = make.Drive("a", 0.06, 0.3, 0.4, 1.01, 1.0, 25.0, 0.0, stiffness=0.7)
    t, torques, angles, speeds = make.simulate([one], 5)
    sizes, frequencies, phases = (part[0] for part in make.torque(5, 1))

    def rates(time: float, x: np.ndarray) -> list[float]:
        drive = np.sum(sizes * np.sin(2 * np.pi * frequencies * time + phases))
        held = 2.0 * 9.81 * 0.15 * np.sin(x[0]) + 0.7 * x[0]
        loss = 0.3 * x[1] + 0.4 * np.tanh(x[1] / 0.05)
        return [x[1], (1.01 * drive - loss - held) / (0.06 + 2.0 * 0.15**2)]

    run = solve_ivp(rates, (0, t[-1]), [0, 0], t_eval=t, rtol=1e-9, atol=1e-12, max_step=1e-3)
    assert np.ptp(angles) > 0.02
    assert angles[:, 0] == pytest.approx(run.y[0], abs=1e-6)
    assert speeds[:, 0] == pytest.approx(run.y[1], abs=1e-5)
    assert torques[7, 0] == pytest.approx(
        np.sum(sizes * np.sin(2 * np.pi * frequencies * t[7] + phases))
    )


def test_play_lets_the_motor_run_ahead_and_then_carries_the_load(
    study: Mapping[str, ModuleType], monkeypatch: pytest.MonkeyPatch
) -> None:
    make = study["generate"]
    short(monkeypatch, make)
    base = {"inertia": 0.06, "viscous": 0.3, "dry": 0.4, "torque_gain": 1.0, "tacho_gain": 1.0}
    stiff = make.Drive("a", **base, temperature=25.0, hours=0.0)
    loose = make.Drive("b", **base, temperature=25.0, hours=0.0, play=0.02)
    tight = make.Drive("c", **base, temperature=25.0, hours=0.0, play=1e-9)
    monkeypatch.setattr(make, "torque", lambda seed, count: same(make, seed, count))
    _, _, angles, _ = make.simulate([stiff, loose, tight], 5)
    assert abs(angles[:, 2] - angles[:, 0]).max() < 4e-3  # only the shaft yields
    assert 2e-3 < abs(angles[:, 1] - angles[:, 0]).max() < 0.1


def same(make: ModuleType, seed: int, count: int) -> tuple[np.ndarray, ...]:
    chance = np.random.default_rng(seed)
    frequencies, phases = np.array([0.9, 3.1]), chance.uniform(0, 6, 2)
    return tuple(np.tile(row, (count, 1)) for row in (np.array([3.0, 2.0]), frequencies, phases))


def test_ten_of_two_hundred_are_odd(study: Mapping[str, ModuleType]) -> None:
    make = study["generate"]
    fleet = make.drives(0)
    odd = [one.odd for one in fleet if one.odd]
    assert sorted(odd) == sorted(make.KINDS)
    others = np.array([(one.inertia, one.torque_gain) for one in fleet if not one.odd])
    assert others.std(axis=0) / others.mean(axis=0) == pytest.approx([0.02, 0.004], rel=0.2)
    assert [one.odd for one in make.drives(0, 24) if one.odd] == ["inertia"]
    assert make.drives(1)[0] != fleet[0]


def test_a_score_counts_what_is_named_right_exact_and_false(
    study: Mapping[str, ModuleType],
) -> None:
    def unit(name: str, kind: str = "", *off: tuple[str, float]) -> dict[str, object]:
        rows = [{"name": name, "by": by, "sd": 1.0} for name, by in off]
        reason = {"kind": kind, "off": rows, "sentence": "so"} if kind else None
        return {"name": name, "reason": reason}

    truth = {"a": ["inertia", "J"], "b": ["play", "structure"], "c": ["dry friction", "F"]}
    truth["d"] = ["inertia", "J"]
    units = [
        unit("a", "numbers", ("F", 4.0), ("J", -9.0)),
        unit("b", "structure"),
        unit("c", "numbers", ("J", 5.0)),
        unit("d"),
        unit("e", "numbers", ("J", 4.0)),
    ]
    counts = study["score"].score(truth, {"units": units})
    lines = counts.pop("lines")
    assert counts == {"found": 3, "right": 2, "exact": 1, "false": 1}
    assert "d  inertia: missed" in lines
    assert "e  false: so" in lines

"""The explicit method: coefficients, accuracy and fallbacks, with CVODES as the other engine."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from builders import (
    cart_pole,
    damper,
    double_pendulum,
    model_of,
    oscillator,
    pendulum,
    push,
    run,
    spring,
)
from numpy.typing import NDArray

from symhyb.model.types import Model
from symhyb.numeric.kernels import compiled
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs import explicit
from symhyb.numeric.runs.dormand_prince import DENSE, ERRORS, NODES, STAGES
from symhyb.numeric.runs.explicit import Field, Steps, Tolerances, bends, field
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import LEFT, Scenario

Array = NDArray[np.float64]
INPUT = {"f": {"unit": "N"}}
needs_compiler = pytest.mark.skipif(compiled.find_compiler() is None, reason="no C compiler")


def swing() -> Machine:
    """1.2 kg on 300 N/m, undamped."""
    return build(oscillator({"hold": spring("k")}, {"k": (300.0, "N/m")}))


def steps_of(
    machine: Machine, t: Array, start: Array, relative: float, rates: Field | None = None
) -> Steps:
    """A run without inputs."""
    rates = rates or field(state_form(machine))
    assert rates is not None
    limits = Tolerances(
        relative, np.full(start.size, relative / 100), np.full(start.size, 1e9), 10**6
    )
    return rates.integrate(t, start, machine.values, (t[[0, -1]], np.zeros((2, 0))), limits)


def test_the_coefficients_fulfil_the_conditions_of_their_order() -> None:
    """Row sums are the nodes; Σ b c^k = 1/(k + 1) and the errors' weights vanish on low powers;
    the polynomial integrates t^k to the places of the extra stages."""
    c = np.array(NODES)
    for place, row in zip(NODES, STAGES, strict=True):
        assert sum(a for _, a in row) == pytest.approx(place, abs=1e-14)
    weights = dict(STAGES[12])
    for k in range(8):
        assert sum(b * c[j] ** k for j, b in weights.items()) == pytest.approx(1 / (k + 1))
        for order, row in zip((3, 5), ERRORS, strict=True):
            wrong = sum(e * c[j] ** k for j, e in row)
            assert (abs(wrong) < 1e-12) == (k < order)
    for k in range(7):  # y' = t^k over a step of length 1 from 0, at every place between
        slopes, s = c**k, np.linspace(0, 1, 9)
        rise = 1 / (k + 1)
        upper = [sum(d * slopes[j] for j, d in row) for row in DENSE]
        parts = [rise, slopes[0] - rise, 2 * rise - slopes[12] - slopes[0], *upper]
        y = np.zeros_like(s)
        for i, part in enumerate(reversed(parts)):
            y = (y + part) * (s if i % 2 == 0 else 1 - s)
        assert y == pytest.approx(s ** (k + 1) * rise, abs=1e-12)


@needs_compiler
def test_the_error_falls_with_the_tolerance_at_outputs_between_the_steps_too() -> None:
    """x = x0 cos ωt over a hundred periods."""
    machine, t = swing(), np.linspace(0, 40, 5001)
    omega = np.sqrt(300 / 1.2)
    errors = []
    for relative in (1e-6, 1e-9, 1e-12):
        found = steps_of(machine, t, np.array([0.02, 0.0]), relative)
        assert found.reason == ""
        assert found.accepted < 5000
        errors.append(np.abs(found.x[:, 0] / 0.02 - np.cos(omega * t)).max())
    assert errors[0] < 1e-3
    assert errors[1] < 1e-6
    assert errors[2] < 1e-9


@needs_compiler
@pytest.mark.parametrize(
    "model", [pendulum(), double_pendulum(), cart_pole()], ids=["one", "two", "cart"]
)
def test_interpreted_and_compiled_rates_give_the_same_numbers_to_the_last_bit(
    model: Model,
) -> None:
    machine = build(model)
    code = field(state_form(machine))
    assert code is not None
    fresh = Field(code.code, code._library)
    t, start = np.linspace(0, 1, 101), np.linspace(0.3, 0.5, 2 * machine.n)
    nodes = t, np.sin(5 * t)[:, None] * np.ones(len(machine.model.inputs))
    limits = Tolerances(1e-8, np.full(start.size, 1e-10), np.full(start.size, 1e9), 10**5)
    first = fresh.integrate(t, start, machine.values, nodes, limits)
    assert not fresh.compiled
    assert fresh.compile()
    second = fresh.integrate(t, start, machine.values, nodes, limits)
    assert first.reason == second.reason == ""
    assert np.array_equal(first.x, second.x)
    assert (first.accepted, first.evaluations) == (second.accepted, second.evaluations)
    here = fresh.along(t, first.x, nodes[1], machine.values)
    again = Field(code.code, code._library).along(t, first.x, nodes[1], machine.values)
    assert np.array_equal(here, again)
    assert here[:, : machine.n] == pytest.approx(first.x[:, machine.n :])


@needs_compiler
def test_rates_that_run_long_are_compiled_in_the_middle_of_a_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With the same numbers as if they were not."""
    monkeypatch.setattr(explicit, "COMPILING", 1000)
    monkeypatch.setattr(explicit, "COMPILING_EACH", 0)
    machine, t = swing(), np.linspace(0, 1, 11)
    code = field(state_form(machine))
    assert code is not None
    rates = Field(code.code, code._library)
    slow = Field(code.code, code._library)
    slow._tried = True  # never compiled
    found = steps_of(machine, t, np.array([0.02, 0.0]), 1e-8, rates)
    as_listed = steps_of(machine, t, np.array([0.02, 0.0]), 1e-8, slow)
    assert (rates.compiled, slow.compiled) == (True, False)
    assert found.evaluations * len(code.code.steps) > 2000  # well after it was compiled
    assert found.evaluations == as_listed.evaluations
    assert np.array_equal(found.x, as_listed.x)


@needs_compiler
def test_threads_may_integrate_one_machine_at_once() -> None:
    machine, t = build(double_pendulum()), np.linspace(0, 2, 201)
    starts = [np.array([0.1 * i, 0.5, 0.0, 0.0]) for i in range(8)]
    alone = [steps_of(machine, t, start, 1e-8).x for start in starts]
    with ThreadPoolExecutor(4) as pool:
        shared = list(pool.map(lambda start: steps_of(machine, t, start, 1e-8).x, starts))
    for one, other in zip(alone, shared, strict=True):
        assert np.array_equal(one, other)


MACHINES = {
    "double pendulum": (double_pendulum(), [1.0, 0.5], 2.0),
    "cart and pole, driven, with dry friction": (cart_pole(), [0.0, 0.4], 2.0),
    "slow relaxation": (
        oscillator(
            {
                "it": {"kind": "relaxation", "on": "x", "stiffness": "k", "damping": "d"},
                "motor": push("f"),
            },
            {"k": (60.0, "N/m"), "d": (6.0, "N*s/m")},
            inputs=INPUT,
        ),
        [0.05],
        3.0,
    ),
    "a stop": (
        model_of(
            gravity=["0", "-g"],
            coordinates={"y": {"unit": "m"}},
            parameters={"g": (9.81, "m/s^2"), "m": (0.2, "kg"), "k": (5e3, "N/m")},
            bodies={"ball": {"mass": "m", "at": ["0", "y"]}},
            elements={"floor": {"kind": "gap", "on": "y", "stiffness": "k", "side": "lower"}},
        ),
        [0.4],
        3.0,
    ),
}


@needs_compiler
@pytest.mark.parametrize(("model", "start", "end"), MACHINES.values(), ids=MACHINES)
def test_runs_agree_with_cvodes(
    model: Model, start: list[float], end: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    t = np.linspace(0, end, 401)
    u = np.repeat(np.sin(4 * t)[:, None], len(model.inputs), 1)
    u[200:] += 0.3 * u[:1].size
    by_steps = run(model, t, start, 0.1, u)
    monkeypatch.setattr("symhyb.numeric.runs.integrate.field", lambda form: None)
    by_cvodes = run(model, t, start, 0.1, u)
    assert by_steps.method == "explicit"
    assert by_cvodes.method in ("adams", "bdf")
    reach = np.abs(by_cvodes.q).max(axis=0)
    assert np.all(np.abs(by_steps.q - by_cvodes.q) < 2e-5 * reach)
    assert by_steps.z == pytest.approx(by_cvodes.z, abs=1e-6)
    assert by_steps.y.shape == by_cvodes.y.shape


def test_a_drive_is_straight_between_its_bends() -> None:
    t = np.array([0.0, 0.5, 1.0, 2.0, 3.0, 3.5, 4.0])
    drive = np.column_stack([np.interp(t, [0, 1, 4], [0, 2, 1]), np.full(7, 7.0)])
    times, values = bends(t, drive)
    assert times.tolist() == [0, 1, 4]
    assert values.tolist() == [[0, 7], [2, 7], [1, 7]]
    times, values = bends(t, np.empty((7, 0)))
    assert times.tolist() == [0, 4]
    assert values.shape == (2, 0)


@needs_compiler
@pytest.mark.parametrize(("damping", "stiff"), [(1e3, False), (1e8, True)])
def test_a_machine_that_is_too_stiff_is_handed_to_bdf(damping: float, stiff: bool) -> None:
    """A decay within 10 ns would take 10⁷ steps."""
    model = oscillator(
        {"oil": damper("d"), "motor": push("f")}, {"d": (damping, "N*s/m")}, inputs=INPUT
    )
    t = np.linspace(0, 1, 11)
    result = run(model, t, 0.0, 0.0, np.full(11, 5.0))
    assert result.complete
    assert ("stiff" in result.note) == stiff
    assert result.q[-1, 0] == pytest.approx(5 / damping * (1 - 1.2 / damping), rel=1e-6)


@pytest.fixture
def named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache of this test's own, and nothing remembered of compilers; the cache folder."""
    import platformdirs

    caches = (compiled.find_compiler, compiled.cache_folder, explicit._library)
    monkeypatch.setattr(platformdirs, "user_cache_path", lambda name: tmp_path / name)
    for cache in caches:
        cache.cache_clear()
    yield tmp_path / "symhyb" / "compiled"
    monkeypatch.undo()
    for cache in caches:
        cache.cache_clear()


def test_without_a_compiler_cvodes_takes_over_silently(
    named: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SYMHYB_CC", "")
    result = run(pendulum(), np.linspace(0, 1, 11), 0.5)
    assert (result.method, result.note, result.reason) == ("adams", "", "")
    assert list(named.iterdir()) == []


def test_a_compiler_that_fails_is_reported_and_leaves_nothing(
    named: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = tmp_path / "brokencc"
    broken.write_text('#!/bin/sh\n[ "$1" = --version ] && echo "broken 1.0" && exit 0\nexit 1\n')
    broken.chmod(0o755)
    monkeypatch.setenv("SYMHYB_CC", str(broken))
    result = run(pendulum(), np.linspace(0, 1, 11), 0.5)
    assert (result.method, result.reason) == ("adams", "")
    assert result.note.startswith("the C compiler brokencc could not compile")
    assert [file.name for file in named.iterdir()] == [compiled.LOCK]


@pytest.mark.parametrize("compiler", [True, False])
def test_a_run_ends_where_it_leaves_its_bound(
    compiler: bool, named: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """x'' = 9 x/1.2 from x = 1: x = cosh(√7.5 t) reaches 50 at arcosh(50)/√7.5 = 1.682 s."""
    if not compiler:
        monkeypatch.setenv("SYMHYB_CC", "")
    model = oscillator({"fall": spring("k")}, {"k": (-9.0, "N/m")})
    t = np.linspace(0, 10, 1001)
    place, speed = np.ones(1), np.zeros(1)
    bound = np.array([50.0, 1e6])
    scenario = Scenario(t, place, speed, t, np.empty((t.size, 0)), bound=bound)
    result = simulate(build(model), scenario)
    assert result.reason.startswith(LEFT)
    good = np.isfinite(result.q[:, 0])
    last = t[good][-1]
    assert last == pytest.approx(np.arccosh(50) / np.sqrt(7.5), abs=0.011)
    assert not good[np.argmin(good) :].any()
    assert result.q[good, 0] == pytest.approx(np.cosh(np.sqrt(7.5) * t[good]), rel=1e-5)

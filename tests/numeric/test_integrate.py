"""Simulation against closed forms and another engine; energy; failure as an outcome."""

import re
import time
from collections.abc import Callable

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
    value,
)
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson, solve_ivp
from scipy.special import ellipj, ellipk

from symhyb.model.types import Model
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

Array = NDArray[np.float64]
INPUT = {"f": {"unit": "N"}}


def test_damped_oscillator_against_its_closed_form() -> None:
    """x = e^(−δt) (x0 cos ωt + (v0 + δx0)/ω sin ωt), δ = d/2m, ω² = k/m − δ²."""
    m, k, d, x0, v0 = 1.2, 300.0, 1.5, 0.02, -0.4
    model = oscillator(
        {"hold": spring("k"), "oil": damper("d")}, {"k": (k, "N/m"), "d": (d, "N*s/m")}
    )
    t = np.linspace(0, 5, 301)
    result = run(model, t, x0, v0)
    decay = d / (2 * m)
    omega = np.sqrt(k / m - decay**2)
    s, c = np.sin(omega * t), np.cos(omega * t)
    x = np.exp(-decay * t) * (x0 * c + (v0 + decay * x0) / omega * s)
    v = np.exp(-decay * t) * (v0 * c - (decay * v0 + (decay**2 + omega**2) * x0) / omega * s)
    assert result.complete
    assert result.q[:, 0] == pytest.approx(x, abs=1e-7)
    assert result.v[:, 0] == pytest.approx(v, abs=2e-6)
    assert result.a[:, 0] == pytest.approx((-k * x - d * v) / m, abs=3e-5)
    assert result.y[:, 0] == pytest.approx(result.q[:, 0])


@pytest.mark.parametrize(("tolerance", "error"), [(1e-8, 1e-4), (1e-12, 1e-7)])
def test_pendulum_against_elliptic_functions(
    tolerance: float, error: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """sin(phi/2) = κ sn(K(κ²) − ω t, κ²), κ = sin(phi0/2), ω² = m g l/(J + m l²).

    The error that is left is the solver's: it falls with the tolerance.
    """
    monkeypatch.setattr("symhyb.numeric.runs.turns.RELATIVE_TOLERANCE", tolerance)
    monkeypatch.setattr("symhyb.numeric.runs.turns.ABSOLUTE_TOLERANCE", tolerance / 100)
    start = 2.5
    result = run(pendulum(), t := np.linspace(0, 8, 401), start)
    omega = np.sqrt(0.4 * 9.81 * 0.3 / (0.01 + 0.4 * 0.3**2))
    m = np.sin(start / 2) ** 2
    sn, cn, dn, _ = ellipj(ellipk(m) - omega * t, m)
    phi = 2 * np.arcsin(np.sqrt(m) * sn)
    rate = -2 * np.sqrt(m) * omega * cn  # from phi' cos(phi/2) = −2κω cn dn, cos(phi/2) = dn
    assert np.min(dn) > 0.3
    assert result.q[:, 0] == pytest.approx(phi, abs=error)
    assert result.v[:, 0] == pytest.approx(rate, abs=10 * error)


def test_duffing_against_elliptic_functions() -> None:
    """m x'' + k x + c x³ = 0 from rest:  x = A cn(ω t, μ), ω² = (k + cA²)/m, μ = cA²/(2mω²)."""
    m, k, c, A = 1.2, 80.0, 900.0, 0.35
    model = oscillator({"hold": spring("k", cubic="c")}, {"k": (k, "N/m"), "c": (c, "N/m^3")})
    result = run(model, t := np.linspace(0, 6, 401), A)
    omega2 = (k + c * A**2) / m
    mu = c * A**2 / (2 * m * omega2)
    sn, cn, dn, _ = ellipj(np.sqrt(omega2) * t, mu)
    assert result.q[:, 0] == pytest.approx(A * cn, abs=1e-5)
    assert result.v[:, 0] == pytest.approx(-A * np.sqrt(omega2) * sn * dn, abs=2e-4)


def by_scipy(machine: Machine, t: Array, x0: Array, t_u: Array, u: Array) -> Array:
    """The same run by DOP853, its step bounded so that no corner of the input is stepped over."""
    n = machine.n

    def rate(time: float, x: Array) -> Array:
        held = [np.interp(time, t_u, column) for column in u.T]
        a = value(
            machine.acceleration, x[:n], x[n:], [], held, time, machine.values, np.zeros(n), []
        )
        return np.concatenate([x[n:], np.atleast_1d(a)])

    longest = float(np.diff(t_u).min())
    done = solve_ivp(rate, (t[0], t[-1]), x0, "DOP853", t, rtol=1e-10, atol=1e-11, max_step=longest)
    assert done.success
    return np.asarray(done.y.T)


def test_cart_and_pole_with_a_recorded_input_against_dop853() -> None:
    """Uneven input times, another grid for the output: the input runs linearly between."""
    machine = build(cart_pole())
    rng = np.random.default_rng(5)
    t_u = np.cumsum(rng.uniform(0.02, 0.06, 60)) - 0.1
    u = 2 * np.sin(3 * t_u)[:, None] + 0.2 * rng.normal(size=(60, 1))
    t = np.linspace(0, 1.5, 61)
    result = run(machine, t, [0.05, 0.6], [0.2, -1.0], u, t_u)
    expected = by_scipy(machine, t, np.array([0.05, 0.6, 0.2, -1.0]), t_u, u)
    assert result.complete
    assert np.hstack([result.q, result.v]) == pytest.approx(expected, abs=1e-5)


def test_a_jump_of_the_input_is_met_where_it_is() -> None:
    """A free mass under a force that jumps within one sample of 1 ms, then rests."""
    model = oscillator({"motor": push("f")}, inputs=INPUT)
    t = np.arange(0, 1.0005, 0.001)
    f = np.where(t < 0.5, 0.0, 2.4)
    result = run(model, t, 0.0, 0.3, f)
    step = 0.001  # first-order hold: the force rises from 0.499 to 0.5 s
    late = t >= 0.5
    after = t[late] - 0.5
    ramp = 2.4 / 1.2 * step / 2
    v = 0.3 + np.where(late, 0, 0.0)
    v[late] += ramp + 2.0 * after
    x = 0.3 * t
    x[late] += 2.0 * step**2 / 6 + ramp * after + after**2
    assert result.v[:, 0] == pytest.approx(v, abs=1e-8)
    assert result.q[:, 0] == pytest.approx(x, abs=1e-8)


@pytest.mark.parametrize("share", [0.05, 1.0])
def test_a_square_wave_on_an_oscillator_against_dop853(share: float) -> None:
    """Many jumps; with ``share`` small the wave rides on a large ramp and no jump is declared."""
    model = oscillator(
        {"hold": spring("k"), "oil": damper("d"), "motor": push("f")},
        {"k": (300.0, "N/m"), "d": (1.5, "N*s/m")},
        inputs=INPUT,
    )
    machine = build(model)
    t = np.arange(0, 1.001, 0.01)
    f = share * np.where(np.floor(t / 0.13) % 2 == 0, 1.0, -1.0) + (1 - share) * 5 * t
    result = run(machine, t, 0.0, 0.0, f)
    expected = by_scipy(machine, t, np.zeros(2), t, f[:, None])
    assert np.hstack([result.q, result.v]) == pytest.approx(expected, abs=1e-7)


def test_a_jump_between_two_outputs_is_not_stepped_over() -> None:
    t_u = np.arange(0, 1.0005, 0.001)
    f = np.where((t_u > 0.5) & (t_u < 0.503), 1000.0, 0.0)
    model = oscillator({"motor": push("f")}, inputs=INPUT)
    result = run(model, np.linspace(0, 1, 11), 0.0, 0.0, f, t_u)
    assert result.v[-1, 0] == pytest.approx(np.trapezoid(f, t_u) / 1.2, rel=1e-5)


def test_several_inputs_keep_their_columns() -> None:
    inputs = {"f": {"unit": "N"}, "g": {"unit": "N"}}
    model = oscillator({"one": push("f"), "two": push("-2*g")}, inputs=inputs)
    t = np.linspace(0, 1, 11)
    result = run(model, t, 0.0, 0.0, np.column_stack([2.4 * t, 0.6 * np.ones(11)]))
    assert result.v[:, 0] == pytest.approx(t**2 - t, abs=1e-8)


@pytest.mark.parametrize("begin", [0.0, 60.0, 1e5])
def test_times_that_were_rounded_when_written_are_good_enough(begin: float) -> None:
    """A file states 1/300 s with nine digits; a recording may begin late."""
    t = begin + np.round(np.arange(600) / 300, 9)
    model = oscillator({"motor": push("f")}, inputs=INPUT)
    result = run(model, t, 0.0, 0.0, np.sin(t - begin))
    assert result.v[:, 0] == pytest.approx((1 - np.cos(t - begin)) / 1.2, abs=1e-5)


def test_a_force_that_depends_on_time_and_a_moving_support() -> None:
    """m (x + A sin w t)'' = F cos w t, at rest in space: x = F/(m w²)(1 − cos w t) − A sin w t."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.2, "kg"), "A": (0.1, "m"), "w": (3.0, "1/s"), "F": (2.0, "N")},
        bodies={"block": {"mass": "m", "at": ["x + A*sin(w*t)", "0"]}},
        elements={"wind": push("F*cos(w*t)")},
    )
    result = run(model, t := np.linspace(0, 4, 100), 0.0, -0.3)
    x = 2 / (1.2 * 9) * (1 - np.cos(3 * t)) - 0.1 * np.sin(3 * t)
    assert result.q[:, 0] == pytest.approx(x, abs=1e-6)


def test_parameters_may_be_given() -> None:
    model = oscillator({"hold": spring("k")}, {"k": (300.0, "N/m")})
    machine = build(model)
    p = machine.values.copy()
    p[machine.column("k")] = 100.0
    t = np.linspace(0, 2, 50)
    scenario = Scenario(t, np.array([0.1]), np.zeros(1), t, np.empty((50, 0)))
    result = simulate(machine, scenario, p)
    assert result.q[:, 0] == pytest.approx(0.1 * np.cos(np.sqrt(100 / 1.2) * t), abs=1e-7)


def test_scales_make_small_motions_as_accurate_as_large_ones() -> None:
    """A linear machine at 1e-7 of the amplitude is the same machine if its scales say so."""
    model = oscillator({"hold": spring("k")}, {"k": (300.0, "N/m")})
    machine = build(model)
    t = np.linspace(0, 2, 50)
    size = 1e-7
    scenario = Scenario(
        t, np.array([size]), np.zeros(1), t, np.empty((50, 0)), size * np.array([1.0, 16.0])
    )
    result = simulate(machine, scenario)
    assert result.q[:, 0] / size == pytest.approx(np.cos(np.sqrt(300 / 1.2) * t), abs=5e-6)


def energy(machine: Machine, result: Trajectory) -> Array:
    """T + V + what the elements store, along a trajectory, J."""
    given = (result.q, result.v, result.z, result.t, machine.values)
    T, V, stored = along(machine.energy, given, (4,), result.t.size)
    return np.asarray(T[:, 0] + V[:, 0] + stored.sum(axis=1))


@pytest.mark.parametrize("model", [pendulum(), double_pendulum()], ids=["pendulum", "double"])
def test_conservative_machines_keep_their_energy(model: Model) -> None:
    machine = build(model)
    result = run(machine, np.linspace(0, 5, 200), 2.0)
    held = energy(machine, result)
    assert np.ptp(held) < 2e-5 * np.abs(held).max()
    assert np.ptp(result.q) > 1.0


def test_conservative_springs_keep_energy() -> None:
    elements = {
        "near": spring("k", quadratic="k2", cubic="k3"),
        "far": {"kind": "spring", "between": ["post", "tip"], "stiffness": "k", "length": "l"},
    }
    model = model_of(
        gravity=["0", "-g"],
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={
            "m": (1.2, "kg"),
            "g": (9.81, "m/s^2"),
            "l": (0.5, "m"),
            "k": (60.0, "N/m"),
            "k2": (20.0, "N/m^2"),
            "k3": (90.0, "N/m^3"),
        },
        points={"post": ["0", "l"], "tip": ["x", "y"]},
        bodies={"ball": {"mass": "m", "at": "tip"}},
        elements=elements,
    )
    machine = build(model)
    result = run(machine, np.linspace(0, 4, 200), [0.2, -0.3], [0.5, 0.0])
    kinetic = 0.6 * np.sum(result.v**2, axis=1)
    assert np.ptp(energy(machine, result)) < 2e-5 * np.ptp(kinetic)


def test_energy_changes_by_the_power_of_what_is_not_conservative() -> None:
    """dE/dt = Σ Q·q' of motor, damper, friction and drag, and for each of them Q·q' = −F s'."""
    machine = build(cart_pole())
    t = np.linspace(0, 2, 4001)
    u = 3 * np.sin(4 * t) + 1
    result = run(machine, t, [0.0, 0.4], [0.1, 0.0], u)
    given = (result.q, result.v, result.z, u, t, machine.values)
    (flat,) = along(machine.elements, given, (5,), t.size)
    forces = flat.reshape(t.size, 5, 2)
    power = np.einsum("nei,ni->ne", forces, result.v)
    x, phi = result.v.T
    p = {item.name: item.si for item in machine.model.parameters}
    assert power[:, 0] == pytest.approx(u * x)
    assert power[:, 1] == pytest.approx(-p["d"] * phi**2)
    assert power[:, 3] == pytest.approx(-p["c"] * np.tanh(x / p["w"]) * x)
    assert power[:, 4] == pytest.approx(-p["b"] * np.abs(x) ** 3)
    work = cumulative_simpson(power[:, [0, 1, 3, 4]].sum(axis=1), x=t, initial=0)
    held = energy(machine, result)
    assert np.ptp(held) > 0.5
    assert held - held[0] == pytest.approx(work, abs=1e-6)


def elapsed(task: Callable[[], Trajectory]) -> tuple[Trajectory, float]:
    begin = time.process_time()
    result = task()
    return result, time.process_time() - begin


def test_a_motion_that_grows_without_bound_ends_with_a_reason() -> None:
    model = oscillator(
        {"soft": {"kind": "spring", "on": "x", "cubic": "c"}}, {"c": (-50.0, "N/m^3")}
    )
    result, seconds = elapsed(lambda: run(model, np.linspace(0, 20, 201), 0.3))
    assert not result.complete
    assert re.search(r"between 0\.9\d* and 1 s", result.reason)
    assert "grows without bound" in result.reason
    good = np.isfinite(result.q[:, 0])
    assert good.sum() == 10
    assert not good[np.argmin(good) :].any()
    assert np.isnan(result.a[~good]).all()
    assert seconds < 30  # a bound on endlessness, not on speed


def test_a_machine_that_leaves_the_domain_of_its_law_ends_with_a_reason() -> None:
    """log(x) of a mass that moves through zero."""
    law = {"kind": "law", "on": "x", "force": "c*log(x/l) - c"}
    model = oscillator({"odd": law}, {"c": (2.0, "N"), "l": (1.0, "m")}, start=0.5)
    result = run(model, np.linspace(0, 10, 101), 0.5)
    assert result.reason
    assert np.isfinite(result.q[0]).all()
    assert np.isnan(result.q[-1]).all()


def test_an_input_that_stops_before_the_simulation_is_refused() -> None:
    model = oscillator({"motor": push("f")}, inputs=INPUT)
    t = np.linspace(0, 2, 21)
    with pytest.raises(ValueError, match=r"cover 0 to 1\.9 s.*runs from 0 to 2 s"):
        run(model, t, 0.0, 0.0, np.zeros(20), t[:20])
    with pytest.raises(ValueError, match=r"cover 0\.1 to 2 s"):
        run(model, t, 0.0, 0.0, np.zeros(20), t[1:])


def test_times_that_do_not_increase_are_refused() -> None:
    for last in (1.0, 0.5, np.nan):
        with pytest.raises(ValueError, match="must increase"):
            run(oscillator({}), [0.0, 1.0, last], 0.0)


def test_a_start_that_is_not_a_number_ends_with_a_reason() -> None:
    result = run(oscillator({}), [0.0, 1.0], np.nan)
    assert "between 0 and 1 s" in result.reason


def test_a_single_output_time_is_the_start() -> None:
    result = run(oscillator({}), [0.5], 0.1, 0.2)
    assert (result.q.tolist(), result.v.tolist(), result.reason) == ([[0.1]], [[0.2]], "")


def free_mass() -> Model:
    """1.2 kg that nothing holds, pushed by an input."""
    return oscillator({"motor": push("f")}, inputs={"f": {"unit": "N"}})


def test_a_short_pulse_at_rest_is_not_stepped_over() -> None:
    """1.5 N for five samples, long before a ramp that makes the pulse small."""
    t = np.arange(0, 10, 0.001)
    f = np.where(t > 8, 5 * (t - 8), 0.0)
    f[4000:4005] = 1.5
    result = run(free_mass(), t, 0.0, 0.0, f)
    assert result.v[7000, 0] == pytest.approx(np.trapezoid(f[:7000], t[:7000]) / 1.2, rel=1e-4)


def test_a_jump_between_two_outputs_is_met() -> None:
    t_u = np.arange(0, 1.0005, 0.001)
    f = np.where((t_u > 0.5) & (t_u < 0.5035), 1000.0, 0.0)
    result = run(free_mass(), [0.0, 1.0], 0.0, 0.0, f, t_u)
    assert result.v[-1, 0] == pytest.approx(np.trapezoid(f, t_u) / 1.2, rel=1e-6)

"""Inner states along a motion that is given: closed forms, and no energy out of nothing."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from builders import oscillator, run
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from symhyb.model.types import Model
from symhyb.numeric.kernels import vector
from symhyb.numeric.lowered import inner
from symhyb.numeric.lowered.inner import inner_along
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario

Array = NDArray[np.float64]
Keys = Mapping[str, tuple[float, str]]


def rig(kind: str, keys: Keys, **more: object) -> Model:
    """The oscillator with one element on x whose keys are parameters of its own; it shows F."""
    return oscillator(
        {"it": {"kind": kind, "on": "x", "parameters": dict(keys), **{k: k for k in keys}, **more}},
        sensors={"cell": {"measures": "force(it)", "unit": "N"}},
    )


def bent(n: float = 1.0, stiffness: float = 60.0, beta: float = 6.0, gamma: float = 3.0) -> Keys:
    unit = "1/m" if n == 1 else f"1/m^{n:g}" if n == int(n) else "1/m^1.5"
    keys = {"stiffness": (stiffness, "N/m"), "beta": (beta, unit), "gamma": (gamma, unit)}
    return keys if n == 1 else {**keys, "exponent": (n, "1")}


def along(machine: Machine, t: Array, s: Array, r: Array) -> tuple[Array, Array, Array]:
    """z (N,), F (N,) and stored energy (N,) of the element along a given motion."""
    a = np.gradient(r, t)
    motion, u = (s[:, None], r[:, None], a[:, None]), np.empty((t.size, 0))
    z = inner_along(machine, t, motion, u, machine.values)
    p = machine.values
    (y,) = vector.along(machine.outputs, (*motion, z, u, t, p), (6,), t.size)
    stored = vector.along(machine.energy, (motion[0], motion[1], z, t, p), (4,), t.size)[2]
    return z[:, 0] if z.shape[1] else np.zeros(t.size), y[:, 0], stored[:, 0]


def ramp(machine: Machine, speed: float = 0.2, until: float = 5.0) -> tuple[Array, Array, Array]:
    """s, z and F along a steady motion that begins suddenly at 0."""
    t = np.linspace(0, until, 1001)
    z, force, _ = along(machine, t, speed * t, np.full(t.size, speed))
    return speed * t, z, force


def test_a_hysteresis_saturates() -> None:
    """z → (1/(beta + gamma))^(1/n), F → stiffness times that, to either side."""
    for n in (1.0, 1.5, 2.0):
        machine = build(rig("hysteresis", bent(n)))
        for sign in (1, -1):
            _, z, force = ramp(machine, sign * 0.5)
            limit = sign * (1 / 9) ** (1 / n)
            assert z[-1] == pytest.approx(limit, rel=1e-6)
            assert force[-1] == pytest.approx(60 * limit, rel=1e-6)
            assert np.abs(z).max() <= abs(limit) * (1 + 1e-6)


def test_a_hysteresis_loaded_for_the_first_time_against_closed_forms() -> None:
    """z = (1 − e^(−(β+γ)s))/(β+γ) for n = 1, tanh(√(β+γ) s)/√(β+γ) for n = 2."""
    s, z, _ = ramp(build(rig("hysteresis", bent(1.0))))
    assert z == pytest.approx((1 - np.exp(-9 * s)) / 9, abs=1e-7)
    s, z, _ = ramp(build(rig("hysteresis", bent(2.0))))
    assert z == pytest.approx(np.tanh(3 * s) / 3, abs=1e-7)


def test_play_lies_in_series_with_the_hysteresis() -> None:
    keys = {**bent(), "play": (0.04, "m")}
    s, z, force = ramp(build(rig("hysteresis", keys)))
    assert z == pytest.approx((1 - np.exp(-9 * s)) / 9, abs=1e-7)
    assert force == pytest.approx(60 * np.maximum(z - 0.04, 0), abs=1e-6)
    assert force[z < 0.04] == pytest.approx(0)


def test_unloading_a_hysteresis_is_stiff_again() -> None:
    """Saturated and turned round, with β = γ: z' = s' while z > 0 and s' < 0."""
    machine = build(rig("hysteresis", bent(beta=4.5, gamma=4.5)))
    t = np.linspace(0, 4, 2001)
    s = np.where(t < 3.9, t, 7.8 - t)
    _, force, _ = along(machine, t, s, np.where(t < 3.9, 1.0, -1.0))
    back = t >= 3.91
    assert np.diff(force[back]) / np.diff(s[back]) == pytest.approx(60, rel=1e-3)
    assert force[t < 3.9][-1] == pytest.approx(60 / 9, rel=1e-6)


def test_presliding_against_the_closed_form_of_dahl() -> None:
    """At steady speed F = Fc (1 − e^(−σ s/Fc))."""
    keys = {"coulomb": (0.8, "N"), "stiffness": (400.0, "N/m")}
    s, z, force = ramp(build(rig("friction_dynamic", keys)), speed=0.01, until=2.0)
    expected = 0.8 * (1 - np.exp(-400 * s / 0.8))
    assert force == pytest.approx(expected, abs=1e-5)
    assert z == pytest.approx(expected / 400, abs=3e-8)


BRISTLES: Keys = {
    "coulomb": (0.8, "N"),
    "static": (1.2, "N"),
    "stribeck": (0.02, "m/s"),
    "stiffness": (4000.0, "N/m"),
    "micro_damping": (20.0, "N*s/m"),
}


def test_presliding_friction_breaks_away_at_its_static_level() -> None:
    """A force that grows by 0.2 N/s: held by its bristles, x = −(g/σ) ln(1 − f/g) with the
    static level g, until that is reached; then the mass runs off and friction falls to coulomb."""
    law = {"kind": "law", "on": "x", "force": "f*t"}
    model = rig("friction_dynamic", BRISTLES)
    pushed = oscillator({"push": law}, {"f": (0.2, "N/s")})
    model = replace(
        model,
        parameters=pushed.parameters,
        elements=(*model.elements, *pushed.elements),
    )
    t = np.linspace(0, 7, 1401)
    result = run(build(model), t, 0.0)
    held, friction = (t > 0.5) & (t < 4), result.y[:, 0]
    given = -1.2 / 4000 * np.log(1 - 0.2 * t[held] / 1.2)
    assert result.complete
    assert result.method != "adams"
    assert result.q[held, 0] == pytest.approx(given, rel=0.02)
    assert friction.max() == pytest.approx(1.2, rel=0.03)
    assert t[np.argmax(friction)] == pytest.approx(6.0, abs=0.2)
    assert result.v[-1, 0] > 0.05
    assert friction[-1] < 0.85


def test_a_relaxing_spring_pulled_steadily_against_its_closed_form() -> None:
    """F = d v (1 − e^(−k t/d))."""
    keys = {"stiffness": (60.0, "N/m"), "damping": (6.0, "N*s/m")}
    s, _, force = ramp(build(rig("relaxation", keys)), speed=0.2)
    assert force == pytest.approx(6 * 0.2 * (1 - np.exp(-10 * s / 0.2)), abs=1e-6)


def test_a_relaxing_spring_held_loses_its_force() -> None:
    """F = k s e^(−k t/d) at a stretch that was reached in an instant; begun at rest it is slack."""
    keys = {"stiffness": (60.0, "N/m"), "damping": (6.0, "N*s/m")}
    model = rig("relaxation", keys)
    held = replace(model, coordinates=(replace(model.coordinates[0], imposed=True),))
    machine, t = build(held), np.linspace(0, 0.6, 61)
    given = np.tile([0.05, 0.0, 0.0], (61, 1))
    q, v, u = np.array([0.05]), np.zeros(1), np.empty((61, 0))
    scenario = Scenario(t, q, v, t, u, z=np.zeros(1), given=given)
    result = simulate(machine, scenario)
    assert result.complete
    assert result.y[:, 0] == pytest.approx(3 * np.exp(-10 * t), abs=1e-6)
    rest = simulate(machine, replace(scenario, z=None))
    assert rest.y[:, 0] == pytest.approx(0, abs=1e-9)
    assert rest.z[:, 0] == pytest.approx(0.05)


def test_a_machine_that_does_not_remember_has_no_inner_states() -> None:
    machine = build(rig("spring", {"stiffness": (5.0, "N/m")}))
    t = np.linspace(0, 1, 5)
    motion = (t[:, None],) * 3
    assert inner_along(machine, t, motion, np.empty((5, 0)), machine.values).shape == (5, 0)
    remembers = build(rig("hysteresis", bent()))
    nothing = tuple(np.empty((0, 1)) for _ in range(3))
    empty = inner_along(remembers, t[:0], nothing, np.empty((0, 0)), remembers.values)
    assert empty.shape == (0, 1)


def test_inner_states_along_a_motion_are_those_of_the_simulation() -> None:
    """The same element in a simulation, and along the motion that this simulation shows."""
    model = rig("hysteresis", bent(1.5))
    model = replace(
        model, elements=(*model.elements, *_spring().elements), parameters=_spring().parameters
    )
    machine, t = build(model), np.linspace(0, 2, 801)
    result = run(machine, t, 0.0, 3.0)
    u = np.empty((t.size, 0))
    z = inner_along(machine, t, (result.q, result.v, result.a), u, machine.values)
    assert np.ptp(result.z) > 0.1
    assert z == pytest.approx(result.z, abs=2e-5)


@pytest.mark.parametrize("chunk", [7, 400, 10_000])
def test_pieces_of_a_long_recording_are_as_the_whole(
    chunk: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    machine, t = build(rig("hysteresis", bent())), np.linspace(0, 4, 401)
    s = 0.3 * np.sin(3 * t)
    whole = along(machine, t, s, np.gradient(s, t))
    monkeypatch.setattr(inner, "CHUNK", chunk)
    for one, two in zip(along(machine, t, s, np.gradient(s, t)), whole, strict=True):
        assert np.array_equal(one, two)


def _spring() -> Model:
    hold = {"kind": "spring", "on": "x", "stiffness": "k"}
    return oscillator({"hold": hold}, {"k": (60.0, "N/m")})


# --- passivity -------------------------------------------------------------------------------


def cycle(random: np.random.Generator) -> tuple[Array, Array, Array]:
    """Times, stretch and rate of a closed motion of random harmonics, begun at zero."""
    t = np.linspace(0, 4, 4001)
    s, r = np.zeros(t.size), np.zeros(t.size)
    for turns in range(1, 7):
        size, phase = random.normal() * 0.2 / turns, random.uniform(0, 2 * np.pi)
        w = 2 * np.pi * turns / 4
        s += size * (np.sin(w * t + phase) - np.sin(phase))
        r += size * w * np.cos(w * t + phase)
    return t, s, r


def some(random: np.random.Generator, kind: str) -> tuple[Keys, dict[str, object]]:
    """Random keys of a passive kind, within what its physics allows."""
    u = random.uniform
    k = (float(10 ** u(1, 3)), "N/m")
    d = (float(10 ** u(-1, 1)), "N*s/m")
    slip = {
        "coulomb": (c := float(u(0.2, 2)), "N"),
        "static": (c * float(u(1, 2)), "N"),
        "stribeck": (float(u(0.01, 0.5)), "m/s"),
    }
    sided = {"asymmetry": (float(u(-0.9, 0.9)), "1")}
    beta = float(u(1, 20))
    gamma = beta * float(u(-1, 1))
    match kind:
        case "damper":
            return {"damping": d, **sided}, {}
        case "drag":
            return {"drag": (d[0], "N*s^2/m^2")}, {}
        case "friction":
            return {**slip, "transition": (float(u(0.01, 0.1)), "m/s"), **sided}, {}
        case "gap":
            side = str(random.choice(["upper", "lower", "both"]))
            return {"stiffness": k, "clearance": (float(u(0, 0.2)), "m"), "damping": d}, {
                "side": side
            }
        case "hysteresis":
            play = {"play": (float(u(0, 0.1)), "m")}
            return {**bent(random.choice([1.0, 1.5, 2.0]), k[0], beta, gamma), **play}, {}
        case "friction_dynamic":  # micro_damping·|s'| stays below 4·coulomb: the known condition
            return {**slip, "stiffness": k, "micro_damping": (0.1 * c, "N*s/m")}, {}
        case "relaxation":
            return {"stiffness": k, "damping": d}, {}
    return {"stiffness": k, "cubic": (k[0], "N/m^3")}, {}


PASSIVE = (
    "spring",
    "damper",
    "drag",
    "friction",
    "gap",
    "hysteresis",
    "friction_dynamic",
    "relaxation",
)


@pytest.mark.parametrize("kind", PASSIVE)
def test_no_passive_kind_returns_more_energy_than_it_took(kind: str) -> None:
    """∫ F ds ≥ stored(t) − stored(0) at every time of a random closed motion; a spring gives back
    just what it took."""
    random = np.random.default_rng(7)
    for _ in range(8):
        keys, more = some(random, kind)
        machine = build(rig(kind, keys, **more))
        t, s, r = cycle(random)
        assert s[-1] == pytest.approx(s[0], abs=1e-12)
        assert np.abs(r).max() < 4 / 0.1
        _, force, stored = along(machine, t, s, r)
        work = cumulative_trapezoid(force * r, t, initial=0)
        lost = work - (stored - stored[0])
        size = cumulative_trapezoid(np.abs(force * r), t)[-1]
        assert lost.min() > -1e-3 * size
        assert np.diff(lost).min() > -1e-5 * size
        if kind == "spring":
            assert abs(lost[-1]) < 1e-4 * size

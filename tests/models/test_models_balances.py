"""Energy of every shipped model, and that neither units nor the order of coordinates matter.

    d/dt (p·v − T + V + S) = Σ Q·v + R·v + ∂(V − T)/∂t

S is stored in conservative elements, Q the force of the others, R what drives imposed motion.
"""

import re

import casadi as ca
import numpy as np
import pytest
from shipped import (
    NAMES,
    PERIODS,
    SPREAD,
    acting,
    close,
    imposed_motion,
    inertial_size,
    knots,
    machine_of,
    random_states,
    shipped,
    start_of,
)
from textbook import Array

from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario

NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)
PANELS = 10  # from one knot of the inputs to the next
FINE = {"half_car": 400, "quarter_car": 100, "two_inertia_backlash": 400}
"""Where tyres lift off and teeth meet, the power has edges, across which Gauss is poor."""


def balance_of(machine: Machine) -> ca.Function:
    """(q, v, a, z, u, t, p) -> energy, its power, and d/dt of the energy by the chain rule."""
    n, m = machine.n, machine.model
    q, v, a = (ca.SX.sym(name, n) for name in "qva")
    z, u = ca.SX.sym("z", machine.inner_states), ca.SX.sym("u", len(m.inputs))
    t, p = ca.SX.sym("t"), ca.SX.sym("p", machine.values.size)
    here = (q, v, z, u, t, p)
    kinetic, potential, stored = machine.energy(q, v, z, t, p)
    momentum, _ = machine.weak(*here)
    kept = [i for i, e in enumerate(m.elements) if KINDS[e.kind].energy == "conservative"]
    lost = [i for i in range(len(m.elements)) if i not in kept]
    energy = ca.dot(momentum, v) - kinetic + potential + ca.sum1(stored[kept, 0])
    power = ca.dot(v, ca.sum2(machine.elements(*here)[:, lost]))
    power += ca.jacobian(potential - kinetic, t)
    for i in machine.imposed:
        power += machine.discrepancy(q, v, a, z, u, t, p)[i] * v[i]
    slope = ca.jtimes(energy, q, v) + ca.jtimes(energy, v, a) + ca.jacobian(energy, t)
    if machine.inner_states:
        slope += ca.jtimes(energy, z, machine.inner(*here))
    outputs = [ca.densify(item) for item in (energy, power, slope)]
    return ca.Function("balance", [q, v, a, z, u, t, p], outputs)


@pytest.mark.parametrize("name", NAMES)
def test_energy_changes_by_the_power_of_what_is_not_conservative(name: str) -> None:
    machine = machine_of(name)
    balance, s = balance_of(machine), random_states(machine, name, 300, seed=4)
    rng = np.random.default_rng(5)
    far, period, _ = SPREAD[name]
    rows = []
    for q, v, z, u, t in zip(s.q, s.v, s.z, s.u, s.t, strict=True):
        given = rng.normal(size=len(machine.imposed)) * np.array(far)[list(machine.imposed)]
        at = (q, v, z, u, t, machine.values, np.zeros(machine.n), given / period**2)
        a = call(machine.acceleration, at)[0][0]
        rows.append([x.item() for x in call(balance, (q, v, a, z, u, t, machine.values))])
    energy, power, slope = np.array(rows).T
    floor = 1e-13 * float(np.abs(energy).max()) / period
    assert close(slope, power, 1e-9, floor)


@pytest.mark.parametrize(
    "name", [name for name in NAMES if name not in ("damper_rig", "rig_alone")]
)
def test_the_energy_of_a_run_is_the_work_that_was_done(name: str) -> None:
    end, machine, start = PERIODS * SPREAD[name][1], machine_of(name), start_of(name)
    t_u, u = knots(name, end)
    edge, forced = acting(name, t_u, u)
    edges = np.linspace(0, end, FINE.get(name, PANELS) * (edge.size - 1) + 1)
    half = edges[1] / 2
    inside = (edges[:-1, None] + half * (1 + NODES)).ravel()
    t = np.sort(np.concatenate([edges, inside]))
    given = imposed_motion(name, t_u)
    run = simulate(machine, Scenario(t, start, np.zeros(start.size), t_u, u, given=given))
    assert run.complete, run.reason
    inputs = np.array([np.interp(t, edge, column) for column in forced.T]).reshape(-1, t.size).T
    here = (run.q, run.v, run.a, run.z, inputs, t, machine.values)
    energy, power, _ = along(balance_of(machine), here, (6,), t.size)
    at_edges, at_nodes = np.isin(t, edges), np.isin(t, inside)
    work = half * power[at_nodes, 0].reshape(-1, NODES.size) @ WEIGHTS
    gained = np.diff(energy[at_edges, 0])
    kinetic = along(machine.energy, (run.q, run.v, run.z, t, machine.values), (4,), t.size)
    moved = float(np.ptp(kinetic[0]))
    assert moved > 0
    assert np.abs(np.cumsum(gained - work)).max() < (1e-5 if name in FINE else 1e-6) * moved


# --- what must not matter -----------------------------------------------------------------------

OTHER = {
    "kg": ("g", 1e3),
    "g": ("kg", 1e-3),
    "m": ("mm", 1e3),
    "mm": ("m", 1e-3),
    "um": ("mm", 1e-3),
    "s": ("ms", 1e3),
    "rad": ("deg", 180 / np.pi),
    "deg": ("rad", np.pi / 180),
    "N": ("kN", 1e-3),
    "kN": ("N", 1e3),
    "V": ("mV", 1e3),
    "A": ("mA", 1e3),
    "C": ("mC", 1e3),
    "ohm": ("V/A", 1.0),
    "mH": ("H", 1e-3),
    "rpm": ("rad/s", np.pi / 30),
    "1": ("1", 1.0),
}


def other_unit(text: str) -> tuple[str, float]:
    """A unit written with other prefixes, and by what its numbers are then multiplied."""
    factor, parts = 1.0, []
    for mark, name, power in re.findall(r"([*/]?)([A-Za-z0-9]+)(?:\^(\d))?", text):
        new, by = OTHER[name]
        exponent = int(power or 1)
        factor *= by ** (-exponent if mark == "/" else exponent)
        parts.append(mark + new + (f"^{exponent}" if exponent > 1 else ""))
    return "".join(parts), factor


def in_other_units(text: str) -> str:
    """A model file with every number of its tables in another unit."""

    def line(found: re.Match[str]) -> str:
        unit, factor = other_unit(found["unit"])

        def number(part: re.Match[str]) -> str:
            return f"{part[1]}{float(part[2]) * factor!r}"

        new = re.sub(r"(\b(?:value|start|sd) = )([-+.\deE]+)", number, found[0])
        return new.replace(f'unit = "{found["unit"]}"', f'unit = "{unit}"')

    return re.sub(r'^.*unit = "(?P<unit>[^"]+)".*$', line, text, flags=re.M)


def in_other_order(text: str) -> str:
    """A model file with its coordinates and parameters listed from last to first."""

    def reverse(found: re.Match[str]) -> str:
        lines = [line for line in found[2].splitlines() if line]
        return found[1] + "\n".join(reversed(lines)) + "\n\n"

    return re.sub(r"(?ms)^(\[(?:coordinates|parameters)\][^\n]*\n)(.*?)(?=^\[)", reverse, text)


def answers(machine: Machine, name: str) -> tuple[Array, ...]:
    """M, k_c, k_e and sensors at random states that belong to the coordinates by name."""
    names = [coordinate.name for coordinate in shipped(name).coordinates]
    order = [names.index(coordinate.name) for coordinate in machine.model.coordinates]
    s, p = random_states(machine, name, 50, seed=9), machine.values
    back, rows = np.argsort(order), []
    for q, v, z, u, t in zip(s.q[:, order], s.v[:, order], s.z, s.u, s.t, strict=True):
        a = 10 * v
        rows.append(
            (
                call(machine.M, (q, t, p))[0][np.ix_(back, back)],
                call(machine.k_c, (q, v, t, p))[0][0, back],
                call(machine.k_e, (q, v, z, u, t, p))[0][0, back],
                call(machine.outputs, (q, v, a, z, u, t, p))[0][0],
            )
        )
    return tuple(np.array(column) for column in zip(*rows, strict=True))


@pytest.mark.parametrize("name", NAMES)
def test_units_do_not_change_the_machine(name: str) -> None:
    model = shipped(name)
    changed = parse_model(in_other_units(model.text))
    for old, new in zip(model.parameters, changed.parameters, strict=True):
        assert new.unit.text != old.unit.text or new.unit.text == "1"
        assert new.si == pytest.approx(old.si, rel=1e-14)
        assert (new.si_sd or 0.0) == pytest.approx(old.si_sd or 0.0, rel=1e-14)
    _same(name, model, changed)


@pytest.mark.parametrize("name", [name for name in NAMES if name != "emps"])
def test_the_order_of_coordinates_does_not_change_the_machine(name: str) -> None:
    model = shipped(name)
    changed = parse_model(in_other_order(model.text))
    assert [c.name for c in changed.coordinates] == [c.name for c in model.coordinates][::-1]
    assert [p.name for p in changed.parameters] == [p.name for p in model.parameters][::-1]
    _same(name, model, changed)


def _same(name: str, model: Model, changed: Model) -> None:
    machine = build(model)
    floors = (0.0, *2 * [1e-14 * inertial_size(machine, name)], 0.0)
    original, other = (answers(each, name) for each in (machine, build(changed)))
    for wanted, found, floor in zip(original, other, floors, strict=True):
        assert close(found, wanted, 1e-9, floor)

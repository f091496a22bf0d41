"""Every shipped model against its mechanics written by hand: M, k_c, k_e, and whole runs."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from mechanisms import MECHANISMS
from scipy.integrate import solve_ivp
from shipped import (
    IN_SPACE,
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
    start_of,
)
from textbook import MODELS, WRITTEN, Array, Textbook, entries, textbook

from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario

STATES = 1000
BETWEEN = 8  # outputs from one knot of the inputs to the next
TOLERANCE = {"pendulum_on_cart": 1e-5, "two_inertia_backlash": 1e-4}
"""Of the largest motion, where dry friction or the edges of a play amplify what is rounded."""


@cache
def by_hand(name: str) -> Textbook:
    return textbook(name)


def test_every_shipped_model_is_verified() -> None:
    # test_models_in_space.py, tests/numeric/test_constraints.py, test_models_five_bar.py, …_car.py
    others = IN_SPACE | {*MECHANISMS, "squeezer", "five_bar", "car"}
    assert {path.stem for path in MODELS.glob("*.toml")} - others == set(NAMES) == set(WRITTEN)


@pytest.mark.parametrize(
    "name",
    [pytest.param(x, marks=pytest.mark.slow) if x == "triple_pendulum" else x for x in NAMES],
)
def test_equations_agree_with_lagranges_method_at_random_states(name: str) -> None:
    machine, book = machine_of(name), by_hand(name)
    s, p = random_states(machine, name, STATES), machine.values
    pairs: dict[str, list[tuple[Array, Array]]] = {"M": [], "k_c": [], "k_e": [], "z'": []}
    for q, v, z, u, t in zip(s.q, s.v, s.z, s.u, s.t, strict=True):
        inner = z if z.size else [0.0]
        at, here = (q, v, inner, u, t), (q, v, z, u, t, p)
        pairs["M"].append((call(machine.M, (q, t, p))[0], book.mass(q, t)))
        pairs["k_c"].append((call(machine.k_c, (q, v, t, p))[0], book.coriolis(q, v, t)))
        pairs["k_e"].append((call(machine.k_e, here)[0], book.applied(*at)))
        pairs["z'"].append((call(machine.inner, here)[0], book.inner(q, v, inner)))
    n, inertial = machine.n, inertial_size(machine, name)
    for what, both in pairs.items():
        shape = (STATES, -1) if what != "M" else (STATES, n, n)
        found, wanted = (np.array(each).reshape(shape) for each in zip(*both, strict=True))
        floor = 1e-14 * inertial if what in ("k_c", "k_e") else 0.0
        assert close(found, wanted, 1e-9, floor), what


def hand_run(name: str, t: Array, t_u: Array, drive: Array) -> tuple[Array, Array, Array]:
    """q, v (N, n) and z (N, z) by DOP853 to 1e-12 on the equations written by hand.

    ``drive`` (K, ·) runs straight from knot to knot: inputs, then place, speed and acceleration of
    what is imposed.
    """
    book, k = by_hand(name), len(SPREAD[name][2])
    given = np.array([bool(c.get("imposed")) for c in entries(name, "coordinates").values()])
    free, n, g = ~given, given.size, int(given.sum())
    f = n - g
    inner = int(book.inner(np.zeros(n), np.zeros(n), [0.0]).size)

    def motion(time: float, x: Array) -> tuple[Array, Array, Array]:
        d = np.array([np.interp(time, t_u, column) for column in drive.T])
        q, v = np.empty(n), np.empty(n)
        q[free], v[free] = x[:f], x[f : 2 * f]
        q[given], v[given] = d[k : k + g], d[k + g : k + 2 * g]
        return q, v, d

    def rate(time: float, x: Array) -> Array:
        q, v, d = motion(time, x)
        z = x[2 * f :] if inner else [0.0]
        force = (book.applied(q, v, z, d[:k], time) - book.coriolis(q, v, time)).reshape(-1)
        mass, b = book.mass(q, time), d[k + 2 * g :]
        a = np.linalg.solve(mass[np.ix_(free, free)], force[free] - mass[np.ix_(free, given)] @ b)
        return np.concatenate([v[free], a, book.inner(q, v, z).reshape(-1)[:inner]])

    start = start_of(name)
    x = np.concatenate([start[free], np.zeros(f), np.zeros(inner)])
    states = [x]
    for begin, end in pairwise(t_u):
        rows = t[(t > begin + 1e-12) & (t < end + 1e-12)]
        rows[-1] = end
        run = solve_ivp(
            rate, (begin, end), states[-1], "DOP853", rows, rtol=1e-12, atol=1e-12 * _size(name)
        )
        assert run.success, run.message
        states.extend(run.y.T)
    rows = [motion(time, x) for time, x in zip(t, states, strict=True)]
    q, v = (np.array([row[i] for row in rows]) for i in range(2))
    return q, v, np.array(states)[:, 2 * f :]


def _size(name: str) -> float:
    return min(SPREAD[name][0])


@pytest.mark.parametrize("name", NAMES)
def test_runs_agree_with_an_independent_integration(name: str) -> None:
    end = PERIODS * SPREAD[name][1]
    t_u, u = knots(name, end)
    lines = acting(name, t_u, u)
    t = np.linspace(0, end, BETWEEN * (lines[0].size - 1) + 1)
    given, machine = imposed_motion(name, t_u), machine_of(name)
    start = start_of(name)
    run = simulate(machine, Scenario(t, start, np.zeros(start.size), t_u, u, given=given))
    assert run.complete, run.reason
    q, v, z = hand_run(name, t, *(lines if given is None else (t_u, np.column_stack([u, given]))))
    allowed = TOLERANCE.get(name, 1e-6)
    for found, wanted in ((run.q, q), (run.v, v)):
        moved = np.abs(wanted - wanted[0]).max(axis=0)
        assert np.all(np.abs(found - wanted) <= allowed * moved)
    assert run.z == pytest.approx(z, rel=1e-6, abs=1e-8)

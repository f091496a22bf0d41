"""A machine with something in it that no model file can say, and its exact simulation.

    (M(q) + mass) q'' = Q(q, q', act(u)) + push(t, q, q', z, u),   z' = flow(t, q, q', z, u)

u is what is asked of the actuators, z what the change remembers. A held input is constant between
its instants, and the integration restarts at each of them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from shared import Array, Signal, System, UnboundedError, Values

RTOL, ATOL = 1e-9, 1e-11
LONGEST = 0.05  # s, a step of the integration
FARTHEST = 1e3  # a state beyond has left every machine here


@dataclass(frozen=True, slots=True, eq=False)
class Change:
    """What a kind does to a machine; whatever is None is as the model file says.

    ``begin(q, v, u)`` gives the first z; ``numbers(t)`` the parameters that differ at t;
    ``show(t, q, z)`` (n, N) what the sensors read; ``record(random, t, u)`` (k, N) the recorded
    inputs; ``taint(random, t, y, sd)`` (n, N) the noise of sensors in place of white noise.
    """

    push: Callable[[float, Array, Array, Array, Array], Array] | None = None
    flow: Callable[[float, Array, Array, Array, Array], Array] | None = None
    begin: Callable[[Array, Array, Array], Array] | None = None
    act: Callable[[float, Array, Array], Array] | None = None
    numbers: Callable[[float], Mapping[str, float]] | None = None
    mass: Array | None = None
    hold: int = 0  # samples
    step: float = LONGEST  # s, less where there are kinks or pulses
    show: Callable[[Array, Array, Array], Array] | None = None
    record: Callable[[np.random.Generator, Array, Array], Array] | None = None
    taint: Callable[[np.random.Generator, Array, Array, Array], Array] | None = None
    place: str = ""  # or channel, where it acts
    facts: Mapping[str, float] | None = None  # drawn sizes
    law: tuple[str, str, str, float] | None = None  # kind, place, key, value of a listed law


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """An exact run: t (N,), q and v (n, N), z (·, N), u (k, N) as asked of the actuators."""

    t: Array
    q: Array
    v: Array
    z: Array
    u: Array


@dataclass(frozen=True, slots=True, eq=False)
class Plant:
    """A machine with a change, its parameter values and its excitation."""

    system: System
    change: Change
    values: Values
    signal: Signal

    def asked(self, t: Array | float, q: Array, v: Array) -> Array:
        """The inputs asked for (k, …): the signal, or what the controller makes of it."""
        drive = self.system.drive
        if not drive.closed:
            return self.signal.at(t)
        asked = drive.stiffness * (self.signal.at(t) - q[:1]) - drive.damping * v[:1]
        return np.asarray(asked)

    def slope(self, t: float, y: Array, held: Array | None = None) -> Array:
        """Rates of the state y = [q, v, z]."""
        n, change = self.system.n, self.change
        q, v, z = y[:n], y[n : 2 * n], y[2 * n :]
        u = self.asked(t, q, v) if held is None else held
        p = self.values if change.numbers is None else {**self.values, **change.numbers(t)}
        acting = u if change.act is None else change.act(t, u, z)
        Q = self.system.forces(p, q, v, acting).sum(axis=0)
        M = self.system.mass(p, q)
        if change.push is not None:
            Q = Q + change.push(t, q, v, z, u)
        if change.mass is not None:
            M = M + change.mass
        a = Q / M[0] if n == 1 else np.linalg.solve(M, Q)
        if change.flow is None:
            return np.concatenate([v, a])
        return np.concatenate([v, a, change.flow(t, q, v, z, u)])


def simulate(plant: Plant, t: Array, start: Array) -> Motion:
    """The run from the state ``start`` (2n,) over the samples t (N,)."""
    n, change = plant.system.n, plant.change
    q, v = start[:n], start[n:]
    u = plant.asked(float(t[0]), q, v)
    inner = np.empty(0) if change.begin is None else change.begin(q, v, u)
    y = np.concatenate([start, inner])
    if change.hold:
        states, asked = _held(plant, t, y)
    else:
        states = _span(plant, t, y, None)
        asked = plant.asked(t, states[:n], states[n : 2 * n])
    return Motion(t, states[:n], states[n : 2 * n], states[2 * n :], asked)


def _held(plant: Plant, t: Array, y: Array) -> tuple[Array, Array]:
    """States and inputs (k, N) where the inputs stay as they are for some samples."""
    n, states, asked = plant.system.n, [y[:, None]], []
    for first in range(0, t.size, plant.change.hold):
        last = min(first + plant.change.hold, t.size - 1)
        u = plant.asked(float(t[first]), y[:n], y[n : 2 * n])
        asked.append(np.repeat(u[:, None], plant.change.hold, axis=1))
        if last > first:
            states.append(_span(plant, t[first : last + 1], y, u)[:, 1:])
            y = states[-1][:, -1]
    return np.hstack(states), np.hstack(asked)[:, : t.size]


def _span(plant: Plant, t: Array, y: Array, held: Array | None) -> Array:
    """States (·, N) at t from y."""
    done = solve_ivp(
        lambda time, state: plant.slope(time, state, held),
        (t[0], t[-1]),
        y,
        method="DOP853",
        t_eval=t,
        rtol=RTOL,
        atol=ATOL,
        max_step=plant.change.step,
        events=_left,
    )
    if not done.success or done.status == 1 or not np.all(np.isfinite(done.y)):
        raise UnboundedError("the machine left every bound")
    return np.asarray(done.y)


def _left(t: float, y: Array) -> float:
    return FARTHEST - float(np.max(np.abs(y)))


_left.terminal = True  # type: ignore[attr-defined]

"""A machine with what is concealed in it, and its exact simulation.

Dry friction is exact: every element of it is in one of three modes, sliding one way, sliding the
other way, or sticking; reversals and releases are located as events, and a stuck place is held by
the force that keeps its rate at zero. Nothing is smeared by a smooth sign.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from laws import Array, Effect, drift, force, level
from scipy.integrate import solve_ivp
from systems import System

EXCESS = 1e-9  # of the holding level: the force at release, so that a released place does move
SEGMENTS_MOST = 20000
BEFORE = 0.25  # s that are simulated before the recording starts, for delays


@dataclass(frozen=True, slots=True, eq=False)
class Signal:
    """A sum of sines: ``amplitude`` (k, L), ``frequency`` (L,) Hz, ``phase`` (k, L) rad."""

    amplitude: Array
    frequency: Array
    phase: Array

    def at(self, t: Array | float, derivative: int = 0) -> Array:
        """Its value at t (k, …), or its first or second derivative in 1/s, 1/s²."""
        turn = 2 * np.pi * self.frequency
        angle = np.multiply.outer(turn, t) + self.phase.reshape(
            self.phase.shape + (1,) * np.ndim(t)
        )
        waves = np.sin(angle + derivative * np.pi / 2)
        return np.asarray(np.einsum("kl,kl...->k...", self.amplitude * turn**derivative, waves))


@dataclass(frozen=True, slots=True, eq=False)
class Unmeasured:
    """A force in N that nobody records, at a place: it pushes a coordinate, or two points apart."""

    place: str
    at: Callable[[Any], Any]  # time in s (…) -> N (…)


@dataclass(frozen=True, slots=True, eq=False)
class Plant:
    """The machine that is recorded: true parameter ``values``, concealed ``effects``, the input
    that acts = gain·recorded(t − delay) + offset by ``gain``, ``offset`` (k,), ``delay`` s.

    ``held``: the input that acts is the staircase of the recorded samples; ``hold`` (k,) is the
    sample that acts now, None where the input is continuous."""

    system: System
    values: Mapping[str, float]
    effects: tuple[Effect, ...]
    signal: Signal
    gain: Array
    offset: Array
    delay: float = 0.0
    held: bool = False
    hold: Array | None = None
    unmeasured: Unmeasured | None = None

    @property
    def rubbing(self) -> tuple[Effect, ...]:
        """The elements of dry friction."""
        return tuple(e for e in self.effects if e.kind == "friction")

    @property
    def memory(self) -> tuple[Effect, ...]:
        """The elements with an inner state, in the order of the states."""
        return tuple(e for e in self.effects if e.remembers)

    def recorded(self, t: Array | float, q: Array, v: Array) -> Array:
        """The inputs as they are recorded (k, …): the signal, or what the controller asks for."""
        drive = self.system.drive
        if not drive.closed:
            return self.signal.at(t)
        asked = drive.stiffness * (self.signal.at(t) - q[:1]) - drive.damping * v[:1]
        return np.asarray(asked)

    def acting(self, t: float, q: Array, v: Array) -> Array:
        """The inputs that act (k,) at one time."""
        recorded = self.recorded(t - self.delay, q, v) if self.hold is None else self.hold
        return self.gain * recorded + self.offset

    def free(self, t: float, q: Array, v: Array, z: Array) -> tuple[Array, Array, Array]:
        """M (n, n), Q (n,) of everything but dry friction, and the rates of the inner states."""
        p, system = self.values, self.system
        Q = system.forces(p, q, v, self.acting(t, q, v)).sum(axis=0)
        M = system.mass(p, q)
        if self.unmeasured is not None:
            _, J = system.path(p, q, self.unmeasured.place)
            Q = Q + J * float(self.unmeasured.at(t))
        rates, k = np.zeros(z.size), 0
        for effect in self.effects:
            if effect.kind == "friction":
                continue
            s, J = system.path(p, q, effect.place)
            r = float(J @ v)
            if effect.kind == "added_mass":
                M = M + effect.keys["mass"] * np.outer(J, J)
                Q = Q - effect.keys["mass"] * J * turning(self, q, v, effect.place)
                continue
            inner = 0.0
            if effect.remembers:
                inner = float(z[k])
                rates[k] = drift(effect, s, r, inner)
                k += 1
            Q = Q + effect.sign * J * force(effect, s, r, inner, t, 0.0)
        return M, Q, rates


def turning(plant: Plant, q: Array, v: Array, place: str) -> float:
    """J̇·v of a place: its part of s'' that does not come from q''."""
    if place in plant.system.coordinates:
        return 0.0
    step = 1e-5 / (1.0 + float(np.abs(v).max()))
    (_, ahead), (_, behind) = (
        plant.system.path(plant.values, q + side * step * v, place) for side in (1, -1)
    )
    return float((ahead - behind) @ v) / (2 * step)


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """What really happened, at the times ``t`` (N,): q, v, a (n, N) and inner states z (K, N)."""

    t: Array
    q: Array
    v: Array
    a: Array
    z: Array
    sticks: float  # share of the time in which some friction holds


class UnboundedError(Exception):
    """The machine ran away or could not be simulated."""


def accelerate(
    plant: Plant, t: float, y: Array, modes: tuple[int, ...]
) -> tuple[Array, Array, Array]:
    """q'' (n,), the rates of the inner states, and the holding force of every stuck friction."""
    n = plant.system.n
    q, v, z = y[:n], y[n : 2 * n], y[2 * n :]
    M, Q, rates = plant.free(t, q, v, z)
    held = []
    for effect, mode in zip(plant.rubbing, modes, strict=True):
        _, J = plant.system.path(plant.values, q, effect.place)
        if mode:
            Q = Q - J * mode * level(effect, float(J @ v))
        else:
            held.append((J, turning(plant, q, v, effect.place)))
    if not held:
        return np.asarray(np.linalg.solve(M, Q)), rates, np.empty(0)
    J = np.array([j for j, _ in held])
    free = np.linalg.solve(M, Q)
    across = np.linalg.solve(M, J.T)
    hold = np.linalg.solve(J @ across, J @ free + np.array([c for _, c in held]))
    return np.asarray(free - across @ hold), rates, hold


def _settle(plant: Plant, t: float, y: Array, modes: list[int], slow: Array) -> tuple[int, ...]:
    """The modes that follow where the places in ``slow`` have just come to rest: they stick unless
    what would hold them is above their level; the most overloaded one goes first."""
    for k in np.flatnonzero(slow):
        modes[k] = 0
    while 0 in modes:
        _, _, hold = accelerate(plant, t, y, tuple(modes))
        stuck = [k for k, mode in enumerate(modes) if mode == 0]
        limits = np.array([float(level(plant.rubbing[k], 0.0)) for k in stuck])
        over = np.abs(hold) / limits
        worst = int(np.argmax(over))
        if over[worst] < 1 + EXCESS * 0.99:
            break
        modes[stuck[worst]] = int(np.sign(hold[worst]))
    return tuple(modes)


def _events(plant: Plant, modes: tuple[int, ...], now: float) -> list[Callable[..., float]]:
    """One event a friction: its reversal while it slides, its release while it sticks.

    A place that starts to slide ``now`` does so from rate 0, which is not its next reversal, even
    if that comes within one step.
    """
    found = []
    for k, (effect, mode) in enumerate(zip(plant.rubbing, modes, strict=True)):
        place, order = effect.place, sum(1 for m in modes[:k] if m == 0)

        def reversal(t: float, y: Array, place: str = place, mode: int = mode) -> float:
            return _rate(plant, y, place) * mode if t > now else 1.0

        def release(t: float, y: Array, effect: Effect = effect, order: int = order) -> float:
            hold = accelerate(plant, t, y, modes)[2][order]
            return float(level(effect, 0.0)) * (1 + EXCESS) - abs(float(hold))

        event: Any = reversal if mode else release
        event.terminal, event.direction = True, -1
        found.append(event)
    return found


def simulate(plant: Plant, t: Array, start: Array) -> Motion:
    """Solve from ``start`` (2n,) at ``t[0] − BEFORE``; exact to the tolerance of DOP853.

    Raises:
        UnboundedError: the motion runs away or never ends a segment.
    """
    if plant.system.imposed:
        return _imposed(plant, t)
    y = np.concatenate([start, np.zeros(len(plant.memory))])
    now, end = float(t[0]) - BEFORE, float(t[-1])
    rates = np.array([_rate(plant, y, effect.place) for effect in plant.rubbing])
    given, until = _held(plant, now, end, y)
    modes = _settle(given, now, y, [int(np.sign(r)) for r in rates], rates == 0)
    out, sticks = np.zeros((y.size, t.size)), 0.0
    accelerations = np.zeros((plant.system.n, t.size))
    for _ in range(SEGMENTS_MOST):
        if now >= end:
            return _motion(plant, t, out, accelerations, sticks / (end - float(t[0])))
        later, last, hit = _segment(given, now, until, y, modes, t, out, accelerations)
        sticks += (later - now) * (0 in modes)
        y, slow = _rested(given, last, modes, hit)
        if later >= until:
            given, until = _held(plant, later, end, y)
        modes = _settle(given, later, y, list(modes), slow)
        now = later
    raise UnboundedError("the friction changes its mode without end")


def _held(plant: Plant, now: float, end: float, y: Array) -> tuple[Plant, float]:
    """The plant with the sample of the input that acts from ``now`` on, and until when."""
    if not plant.held:
        return plant, end
    step, n = 1 / plant.system.rate, plant.system.n
    sample = np.floor((now - plant.delay) / step + 1e-6)
    hold = plant.recorded(sample * step, y[:n], y[n : 2 * n])
    return replace(plant, hold=hold), min((sample + 1) * step + plant.delay, end)


def _motion(plant: Plant, t: Array, out: Array, a: Array, sticks: float) -> Motion:
    n = plant.system.n
    return Motion(t, out[:n], out[n : 2 * n], a, out[2 * n :], sticks)


def _rate(plant: Plant, y: Array, place: str) -> float:
    n = plant.system.n
    _, J = plant.system.path(plant.values, y[:n], place)
    return float(J @ y[n : 2 * n])


def _segment(
    plant: Plant,
    now: float,
    end: float,
    y: Array,
    modes: tuple[int, ...],
    t: Array,
    out: Array,
    accelerations: Array,
) -> tuple[float, Array, int | None]:
    """Solve to the next event and fill in what lies before it; which friction it was, or None."""
    step = 1.0 / plant.system.rate

    def rate(t: float, y: Array) -> Array:
        a, inner, _ = accelerate(plant, t, y, modes)
        n = plant.system.n
        if not np.all(np.abs(y) < 1e6):
            raise UnboundedError("the motion runs away")
        return np.concatenate([y[n : 2 * n], a, inner])

    found = solve_ivp(
        rate,
        (now, end),
        y,
        method="DOP853",
        rtol=1e-8,
        atol=1e-10,
        max_step=2 * step,
        events=_events(plant, modes, now) or None,
        dense_output=True,
    )
    if not found.success:
        raise UnboundedError(found.message)
    later = float(found.t[-1])
    rows = np.flatnonzero((t >= now) & (t <= later))
    if rows.size:
        out[:, rows] = found.sol(t[rows])
        for i in rows:
            accelerations[:, i] = accelerate(plant, float(t[i]), out[:, i], modes)[0]
    hit = None
    if found.status == 1:
        hit = next(k for k, times in enumerate(found.t_events) if times.size)
    return later, found.y[:, -1].copy(), hit


def _rested(plant: Plant, y: Array, modes: tuple[int, ...], hit: int | None) -> tuple[Array, Array]:
    """The state with rate 0 at every place that holds or has just come to rest, and which did."""
    slow = np.zeros(len(modes), dtype=bool)
    if hit is None:
        return y, slow
    if modes[hit]:
        slow[hit] = True
    n = plant.system.n
    still = [
        e.place for e, mode, s in zip(plant.rubbing, modes, slow, strict=True) if s or not mode
    ]
    if still:
        J = np.array([plant.system.path(plant.values, y[:n], place)[1] for place in still])
        M = plant.free(0.0, y[:n], y[n : 2 * n], y[2 * n :])[0]
        across = np.linalg.solve(M, J.T)
        y[n : 2 * n] -= across @ np.linalg.solve(J @ across, J @ y[n : 2 * n])
    return y, slow


def _imposed(plant: Plant, t: Array) -> Motion:
    """The motion that a rig imposes; only the memory of the laws is integrated."""
    q, v, a = (plant.signal.at(t, k) for k in range(3))
    memory = plant.memory
    z = np.zeros((len(memory), t.size))
    if memory:

        def rate(time: float, inner: Array) -> Array:
            s, r = float(plant.signal.at(time)[0]), float(plant.signal.at(time, 1)[0])
            return np.array([drift(e, s, r, x) for e, x in zip(memory, inner, strict=True)])

        found = solve_ivp(
            rate,
            (t[0] - BEFORE, t[-1]),
            np.zeros(len(memory)),
            method="DOP853",
            t_eval=t,
            rtol=1e-8,
            atol=1e-10,
            max_step=2 / plant.system.rate,
        )
        if not found.success:
            raise UnboundedError(found.message)
        z = found.y
    return Motion(t, q, v, a, z, 0.0)


def reaction(plant: Plant, motion: Motion) -> Array:
    """The force (N,) of the rig on an imposed coordinate: m·x'' − Q of all forces."""
    p, q, v = plant.values, motion.q, motion.v
    total = plant.system.mass(p, q)[0, 0] * motion.a[0]
    total = total - plant.system.forces(p, q, v, np.empty((0, q.shape[1]))).sum(axis=0)[0]
    if plant.unmeasured is not None:
        total = total - plant.unmeasured.at(motion.t)
    rows = iter(motion.z)
    for effect in plant.effects:
        z = next(rows) if effect.remembers else 0.0
        if effect.kind == "added_mass":
            total = total + effect.keys["mass"] * motion.a[0]
        else:
            law = force(effect, q[0], v[0], z, motion.t, np.sign(v[0]))
            total = total - effect.sign * law
    return np.asarray(total)

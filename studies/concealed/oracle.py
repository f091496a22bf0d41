"""What an oracle that knows the structure could know: standard deviations, twins.

A smooth surrogate of the machine (friction rounded within 2 % of the RMS rate) is integrated with
Runge-Kutta from states of the exact motion, over windows whose initial states are free, and
differentiated by finite differences. Fisher's information of the recording then says how well each
concealed number can be known at best, and which other single cause would show the same.
Sizes: W windows, L samples a window, m channels, n coordinates.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from hidden import Fault, Hidden, Target, plant_of, seen, targets
from laws import Array, Effect, drift, force
from numpy.typing import NDArray
from plant import Motion, Plant, simulate
from scipy.interpolate import CubicSpline
from systems import System

WINDOWS = 12
QUICK = ("friction_dynamic", "hysteresis", "relaxation", "gap")  # two Runge-Kutta steps a sample
ROUNDED = 0.02  # of the RMS rate: the width of smooth friction
STEP = 1e-4
LINEAR = (
    ("spring", "stiffness"),
    ("damper", "damping"),
    ("constant", "constant"),
    ("added_mass", "mass"),
)


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One exact simulation: the plant, its motion, the recorded inputs (k, N), channel names, the
    noise ``sd`` (m,) of each, and the state ``start`` (2n,) from which it was simulated."""

    system: System
    hidden: Hidden
    plant: Plant
    motion: Motion
    inputs: Array
    names: tuple[str, ...]
    sd: Array
    start: Array = field(default_factory=lambda: np.empty(0))


def _acceleration(
    plant: Plant, t: Array, y: Array, u: Array, rounded: dict[str, float]
) -> tuple[Array, Array]:
    """q'' (n, B) and z' (K, B) of the smooth surrogate for B states."""
    n, p, system = plant.system.n, plant.values, plant.system
    q, v = y[:n], y[n : 2 * n]
    Q = system.forces(p, q, v, u).sum(axis=0)
    M = system.mass(p, q)
    rates, k = np.zeros((y.shape[0] - 2 * n, y.shape[1])), 0
    for effect in plant.effects:
        s, J = system.path(p, q, effect.place)
        r = np.einsum("ib,ib->b", J, v)
        if effect.kind == "added_mass":
            step = 1e-5 / (1 + np.abs(v).max())
            after, before = (system.path(p, q + h * v, effect.place)[1] for h in (step, -step))
            bend = np.einsum("ib,ib->b", (after - before) / (2 * step), v)
            M = M + effect.keys["mass"] * np.einsum("ib,jb->ijb", J, J)
            Q = Q - effect.keys["mass"] * J * bend
            continue
        inner: Array | float = 0.0
        if effect.remembers:
            inner = y[2 * n + k]
            rates[k] = drift(effect, s, r, inner)
            k += 1
        soft = np.tanh(r / rounded.get(effect.place, 1.0))
        Q = Q + effect.sign * J * force(effect, s, r, inner, t, soft)
    a = np.linalg.solve(np.moveaxis(M, (0, 1), (-2, -1)), np.moveaxis(Q, 0, -1)[..., None])
    return np.moveaxis(a[..., 0], -1, 0), rates


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """Windows of a run: first samples (W,), samples ``length`` a window, states there (X, W)."""

    run: Run
    first: NDArray[np.int64]
    length: int
    start: Array
    rounded: dict[str, float]


def lay(run: Run) -> Windows:
    """Cut a run into windows."""
    total = run.motion.t.size
    length = total // WINDOWS
    first = np.arange(WINDOWS, dtype=np.int64) * length
    m = run.motion
    rounded = {}
    for place in run.system.places:
        _, J = run.system.path(run.plant.values, m.q, place)
        rounded[place] = ROUNDED * float(np.sqrt(np.mean(np.einsum("in,in->n", J, m.v) ** 2)))
    start = np.concatenate([m.q, m.v, m.z])[:, first]
    return Windows(run, first, length, start, rounded)


def _integrate(windows: Windows, hidden: Hidden, start: Array, repeat: int = 1) -> Array:
    """The states (X, L, B) from those at the starts (X, B), B = W·repeat windows."""
    run = windows.run
    parts = 2 if any(effect.kind in QUICK for effect in hidden.effects) else 1
    plant = plant_of(run.system, hidden, run.plant.signal)
    t_all, n = run.motion.t, run.system.n
    h = (t_all[1] - t_all[0]) / parts
    t = np.tile(t_all[windows.first], repeat)
    names = run.system.inputs
    recorded = CubicSpline(t_all, run.inputs, axis=1)  # smooth, so that a delay has a derivative

    def inputs(time: Array) -> Array:
        rows = [
            hidden.fault(name, "gain") * recorded(time - hidden.fault(name, "delay"))[row]
            + hidden.fault(name, "offset")
            for row, name in enumerate(names)
        ]
        return np.array(rows).reshape(len(names), time.size)

    def rate(time: Array, y: Array, u: Array) -> Array:
        a, inner = _acceleration(plant, time, y, u, windows.rounded)
        return np.concatenate([y[n : 2 * n], a, inner])

    y, shown = start, []
    u = inputs(t)
    for i in range(windows.length * parts):
        if i % parts == 0:
            shown.append(y)
        middle, later = inputs(t + h / 2), inputs(t + h)
        k_1 = rate(t, y, u)
        k_2 = rate(t + h / 2, y + h / 2 * k_1, middle)
        k_3 = rate(t + h / 2, y + h / 2 * k_2, middle)
        k_4 = rate(t + h, y + h * k_3, later)
        y, t, u = y + h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + k_4), t + h, later
    return np.array(shown).transpose(1, 0, 2)


def _shown(run: Run, hidden: Hidden, states: Array) -> Array:
    """Channels (m, L, B) of states (X, L, B), late where a sensor is."""
    n, plant = run.system.n, run.plant
    motion = Motion(run.motion.t, states[:n], states[n : 2 * n], states[:n], states[2 * n :], 0.0)
    y = seen(plant, motion, hidden, run.names)
    step = run.motion.t[1] - run.motion.t[0]
    for row, name in enumerate(run.names):
        y[row] = _later(y[row], step, hidden.fault(name, "delay"))
    return y


def _later(y: Array, step: float, late: float) -> Array:
    """Samples (L, …), ``step`` s apart, as a channel that is ``late`` s shows them; 0 at the start,
    where it shows what was before the window, unless that is less than half a sample."""
    if late == 0:
        return y
    t = step * np.arange(y.shape[0])
    shifted = np.asarray(CubicSpline(t, y)(t - late))
    if late > 0.5 * step:
        shifted[: round(late / step) + 2] = 0.0
    return shifted


def _white(run: Run, y: Array) -> Array:
    return y / run.sd.reshape(-1, *(1,) * (y.ndim - 1))


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """``columns`` of the concealed numbers in units of noise, initial states removed, and what
    makes such a column for any other change."""

    columns: Array
    of: Callable[[Hidden, Hidden, float], Array]


def look(run: Run) -> Sight:
    """Differentiate what the sensors show by every concealed number."""
    view = _rig(run) if run.system.imposed else _windows(run)
    rows = [view(*_change(run, target)) for target in targets(run.hidden)]
    return Sight(np.array(rows).T if rows else np.empty((0, 0)), view)


def _change(run: Run, target: Target) -> tuple[Hidden, Hidden, float]:
    value = target.value(run.hidden)
    step = STEP * (target.scale(run.hidden, run.system.values()) or 1.0)
    ahead, behind = (target.at(run.hidden, value + side * step) for side in (1, -1))
    return ahead, behind, 2 * step


def _rig(run: Run) -> Callable[[Hidden, Hidden, float], Array]:
    def column(ahead: Hidden, behind: Hidden, step: float) -> Array:
        shown = []
        for hidden in (ahead, behind):
            plant = plant_of(run.system, hidden, run.plant.signal)
            motion = simulate(plant, run.motion.t, np.empty(0))
            y = seen(plant, motion, hidden, run.names)
            late = hidden.fault("cell", "delay")
            shown.append(_later(y.T, motion.t[1] - motion.t[0], late).T)
        return _white(run, (shown[0] - shown[1]) / step).ravel()

    return column


def _windows(run: Run) -> Callable[[Hidden, Hidden, float], Array]:
    windows = lay(run)
    X, W = windows.start.shape
    size = np.sqrt(np.mean(windows.start**2, axis=1)) + 1e-9
    many = np.repeat(windows.start[:, None, :], 2 * X, axis=1)
    for i in range(X):
        many[i, 2 * i] += STEP * size[i]
        many[i, 2 * i + 1] -= STEP * size[i]
    states = _integrate(windows, run.hidden, many.reshape(X, -1), 2 * X)
    y = _white(run, _shown(run, run.hidden, states))
    y = y.reshape(len(run.names), windows.length, 2 * X, W)
    free = (y[:, :, 0::2] - y[:, :, 1::2]).transpose(3, 0, 1, 2).reshape(W, -1, X)
    bases = [
        np.linalg.qr(block / np.maximum(np.linalg.norm(block, axis=0), 1e-12))[0] for block in free
    ]

    kept: dict[str, Array] = {}  # what a sensor shows otherwise needs no other motion

    def shown(hidden: Hidden) -> Array:
        moving = [f for f in hidden.faults if f.channel in run.system.inputs]
        key = repr((hidden.effects, hidden.parameters, moving))
        if key not in kept:
            kept[key] = _integrate(windows, hidden, _start(windows, hidden))
        return _shown(run, hidden, kept[key])

    def column(ahead: Hidden, behind: Hidden, step: float) -> Array:
        first, second = shown(ahead), shown(behind)
        moved = _white(run, (first - second) / step)
        blocks = moved.transpose(2, 0, 1).reshape(W, -1)
        return np.concatenate([b - Q @ (Q.T @ b) for b, Q in zip(blocks, bases, strict=True)])

    return column


def _start(windows: Windows, hidden: Hidden) -> Array:
    """The states at the window starts, with the inner states of a tried effect at rest."""
    wanted = 2 * windows.run.system.n + sum(e.remembers for e in hidden.effects)
    missing = wanted - windows.start.shape[0]
    return np.concatenate([windows.start, np.zeros((missing, windows.start.shape[1]))])


def deviations(run: Run, sight: Sight) -> Array:
    """The relative standard deviation that the oracle reaches on each concealed number."""
    goals = targets(run.hidden)
    scale = np.array([g.scale(run.hidden, run.system.values()) for g in goals])
    columns = sight.columns * scale
    size = np.linalg.norm(columns, axis=0)
    if np.any(size == 0) or not np.all(np.isfinite(columns)):
        return np.full(len(goals), np.inf)
    triangle = np.linalg.qr(columns / size)[1]
    if np.min(np.abs(np.diag(triangle))) < 1e-6:
        return np.full(len(goals), np.inf)
    inverse = np.linalg.inv(triangle)
    return np.asarray(np.sqrt(np.sum(inverse**2, axis=1)) / size)


def rivals(run: Run, sight: Sight, known: dict[str, float]) -> list[dict[str, object]]:
    """Single causes that show what one concealed number shows, with their correlation and the
    evidence (half of Δχ²) that would still tell them apart.

    ``known`` is the size of the known forces at each place. Only concealed causes of one number
    are compared: those of several numbers have no exact partner of one.
    """
    stated = run.system.values()
    singles = [
        (row, goal)
        for row, goal in enumerate(targets(run.hidden))
        if goal.sort != "effect" or len(run.hidden.effects[goal.index].keys) == 1
    ]
    if not singles:
        return []
    found = []
    for name, ahead, behind, step in _single_causes(run, known):
        column = sight.of(ahead, behind, step)
        power = float(column @ column)
        for row, goal in singles:
            planted = sight.columns[:, row] * goal.scale(run.hidden, stated)
            size = float(planted @ planted)
            rho = float(planted @ column) ** 2 / max(size * power, 1e-300)
            evidence = 0.5 * size * (1 - rho)
            if 1 - rho < 1e-6 or evidence < 6.0:
                found.append(
                    {
                        "of": row,
                        "instead": name,
                        "apart": 1 - rho,
                        "evidence": evidence,
                    }
                )
    return found


def _single_causes(
    run: Run, known: dict[str, float]
) -> list[tuple[dict[str, str], Hidden, Hidden, float]]:
    """Parameters with sd, channel faults and linear forces, each a small step to both sides."""
    hidden = run.hidden
    tried: list[tuple[dict[str, str], Callable[[float], Hidden], float]] = []
    for name, entry in run.system.parameters().items():
        if "sd" in entry and name not in hidden.parameters:
            value = float(entry["value"])
            make = partial(_off, hidden, Target("parameter", key=name), value)
            tried.append(({"parameter": name}, make, STEP * value))
    taken = {(f.channel, f.kind) for f in hidden.faults}
    for channel in (*run.system.inputs, *run.names):
        for kind in ("gain", "offset", "delay"):
            if (channel, kind) not in taken:
                step = STEP * (_size(run, channel) if kind == "offset" else 1.0)
                fault = Fault(channel, kind, float(kind == "gain"))
                tried.append(
                    ({"channel": channel, "kind": kind}, partial(_faulty, hidden, fault), step)
                )
    used = {(e.kind, e.place) for e in hidden.effects}
    for place in run.system.places:
        for kind, key in LINEAR:
            if (kind, place) not in used:
                make = partial(_forced, hidden, kind, place, key)
                tried.append(({"place": place, "kind": kind}, make, 0.1 * STEP * known[place]))
    return [(name, make(step), make(-step), 2 * step) for name, make, step in tried]


def _off(hidden: Hidden, target: Target, value: float, step: float) -> Hidden:
    return target.at(hidden, value + step)


def _faulty(hidden: Hidden, fault: Fault, step: float) -> Hidden:
    return replace(hidden, faults=(*hidden.faults, replace(fault, value=fault.value + step)))


def _forced(hidden: Hidden, kind: str, place: str, key: str, step: float) -> Hidden:
    return replace(hidden, effects=(*hidden.effects, Effect(kind, place, {key: step})))


def _size(run: Run, channel: str) -> float:
    if channel in run.system.inputs:
        return float(np.std(run.inputs[run.system.inputs.index(channel)]))
    return float(run.sd[run.names.index(channel)])

"""Draw a case: conceal something, excite, simulate exactly, and ask the oracle whether it shows.

A draw is kept if an oracle that knows the structure reaches a standard deviation of at most 5 % on
every concealed value; the others are discarded, drawn again with the same plan, and counted. With
``keep_hard`` they are kept instead: nobody has to find there what is concealed.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from effects import DULL, FORCES, NULLS, Place, along, draw_dull, draw_effect, place_of, sensible
from hidden import Hidden, channels, plant_of, seen, targets
from laws import Array, Effect
from oracle import Run, deviations, look, rivals
from plans import Plan, plan_of
from plant import Signal, UnboundedError, simulate
from systems import System

COMPLETE = 0.05  # relative standard deviation that the oracle has to reach
LARGEST = 0.5  # share of a concealed force as it really moved; beyond, little is left to mask it
TRIES = 8


def signal_of(system: System, random: np.random.Generator, factor: float) -> Signal:
    """An excitation: a few lines, a sweep (Schroeder's phases) or many lines like noise."""
    low, high = system.drive.band
    sort = random.choice(["lines", "sweep", "noise"])
    count = {"lines": 14, "sweep": 40, "noise": 60}[sort]
    frequency = np.linspace(low, high, count) + random.uniform(0, 0.02 * (high - low))
    k = max(len(system.inputs), 1)
    size = np.ones((k, count))
    phase = random.uniform(0, 2 * np.pi, (k, count))
    if sort == "sweep":
        order = np.arange(1, count + 1)
        phase = -np.pi * order * (order - 1) / count + random.uniform(0, 2 * np.pi, (k, 1))
    if sort == "noise":
        size = random.rayleigh(0.8, (k, count))
        frequency = np.sort(random.uniform(low, high, count))
    size = size / np.sqrt(np.sum(size**2, axis=1, keepdims=True) / 2)
    return Signal(factor * system.drive.size * size, frequency, phase)


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A drawn case: plan, what is concealed, exact runs (one to learn from and an unseen one; of a
    fleet more), the oracle's words; whether the draw was incomplete, so that a diagnosis
    ``may_refuse``; what makes its recordings harder, by name (:mod:`harder`)."""

    plan: Plan
    hidden: Hidden
    runs: tuple[Run, ...]
    sd: Array
    share: tuple[float, ...]
    rivals: list[dict[str, object]]
    discarded: int
    colour: float
    may_refuse: bool = False
    hardship: Mapping[str, object] = field(default_factory=dict)


def draw(seed: int, keep_hard: bool = False) -> Case | int:
    """The case of a seed, or the number of draws after which it was given up; with ``keep_hard`` a
    draw that is not complete is kept."""
    plan = plan_of(seed)
    discarded = 0
    for attempt in range(TRIES):
        random = np.random.default_rng([seed, 2, attempt])
        try:
            case = _attempt(plan, random, discarded, keep_hard)
        except (UnboundedError, np.linalg.LinAlgError):
            case = None
        except LookupError:
            return discarded
        if case is not None:
            return case
        discarded += 1
    return discarded


def _attempt(
    plan: Plan, random: np.random.Generator, discarded: int, keep_hard: bool
) -> Case | None:
    system = plan.system
    names = channels(system, plan.complete)
    signals = [signal_of(system, random, random.uniform(0.75, 1.3)) for _ in range(2)]
    starts = [start_of(system, random) for _ in range(2)]
    bare = recorded(plan, Hidden(), signals[0], starts[0], system.duration, names, None)
    hidden = _conceal(plan, bare, random)
    train = recorded(plan, hidden, signals[0], starts[0], system.duration, names, None)
    unseen = 0.6 * system.duration
    runs = [train, recorded(plan, hidden, signals[1], starts[1], unseen, names, train.sd)]
    share = tuple(_share(runs[0], i) for i in range(len(hidden.effects)))
    if any(size > LARGEST for size in share):
        return None
    if any(system.met(run.plant.values, run.motion.q) for run in runs):
        return None
    if not targets(hidden):
        colour = random.uniform(2, 15) if plan.kind == "null.coloured" else 0.0
        return Case(plan, hidden, (runs[0], runs[1]), np.empty(0), share, [], discarded, colour)
    sight = look(runs[0])
    sd = deviations(runs[0], sight)
    hard = not np.all(sd <= COMPLETE)
    if hard and not keep_hard:
        return None
    known = {name: _place(bare, name).known for name in system.places}
    rival = rivals(runs[0], sight, known)
    return Case(plan, hidden, (runs[0], runs[1]), sd, share, rival, discarded, 0.0, hard)


def start_of(system: System, random: np.random.Generator) -> Array:
    """The initial state of a run: where the machine begins, in part."""
    start = np.zeros(2 * system.n)
    start[: len(system.start)] = system.start
    return start * random.uniform(0.5, 1.0)


def recorded(
    plan: Plan,
    hidden: Hidden,
    signal: Signal,
    start: Array,
    duration: float,
    names: tuple[str, ...],
    sd: Array | None,
) -> Run:
    """One exact run; without ``sd`` the noise is ``plan.noise`` of the RMS of each channel."""
    system = plan.system
    t = np.arange(round(duration * system.rate) + 1) / system.rate
    plant = plant_of(system, hidden, signal)
    motion = simulate(plant, t, start)
    inputs = plant.recorded(t, motion.q, motion.v) if system.inputs else np.empty((0, t.size))
    if sd is None:
        sd = plan.noise * seen(plant, motion, hidden, names).std(axis=1)
    return Run(system, hidden, plant, motion, inputs, names, sd, start)


def _place(run: Run, name: str) -> Place:
    return place_of(run.plant, run.motion, run.inputs, name)


def _conceal(plan: Plan, bare: Run, random: np.random.Generator) -> Hidden:
    if plan.kind in NULLS:
        return Hidden()
    if plan.kind in DULL:
        return _dull(plan.kind, bare, random)
    if plan.kind == "mixed":
        dull = _dull(str(random.choice(DULL[:5])), bare, random)
        return replace(dull, effects=(_effect(str(random.choice(FORCES)), plan, bare, random),))
    if plan.kind != "two":
        return Hidden((_effect(plan.kind, plan, bare, random),))
    kinds = random.choice(FORCES, 2, replace=False)
    both = tuple(_effect(str(kind), plan, bare, random) for kind in kinds)
    rubbing = {"friction", "friction_dynamic", "hysteresis"}
    if both[0].place == both[1].place and {e.kind for e in both} <= rubbing:
        raise UnboundedError("two frictions in one place are one friction")
    return Hidden(both)


def _effect(kind: str, plan: Plan, bare: Run, random: np.random.Generator) -> Effect:
    low, high = (0.003, 0.03) if plan.masked else (0.03, 0.3)
    share = float(np.exp(random.uniform(np.log(low), np.log(high))))
    place = str(random.choice(sensible(kind, bare.system)))
    return draw_effect(kind, _place(bare, place), share, random)


def _dull(kind: str, bare: Run, random: np.random.Generator) -> Hidden:
    shown = seen(bare.plant, bare.motion, Hidden(), bare.names).std(axis=1)
    sizes = dict(zip(bare.names, shown, strict=True))
    sizes |= dict(zip(bare.system.inputs, bare.inputs.std(axis=1), strict=True))
    return draw_dull(kind, bare.system, sizes, bare.names, random)


def _share(run: Run, index: int) -> float:
    """RMS of a concealed force over the largest known one at its place, as it really moved."""
    effect = run.hidden.effects[index]
    place = _place(run, effect.place)
    if effect.kind == "added_mass":
        size = effect.keys["mass"] * float(np.sqrt(np.mean(place.a**2)))
    else:
        size = float(np.sqrt(np.mean(along(effect, place) ** 2)))
    return float(size / place.known)

"""Manoeuvres that are worth asking of a machine: what drove it, and a little beyond.

Amplitudes follow what was recorded, frequencies the machine's own and those recorded. Sizes: n
coordinates.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import floor, log10

import numpy as np

from symhyb.correction.advice.signals import SMOOTH
from symhyb.correction.search.preparing import Prepared
from symhyb.discrepancy.results import Manoeuvre, SignalName
from symhyb.judgement import LARGE
from symhyb.model.types import Coordinate, Input
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.linear import free_slope
from symhyb.numeric.lowered.machine import Machine

FACTORS = (0.3, 1.0, 2.0, 3.0)  # of the amplitude that was recorded
EXERTION = {
    0.3: 1.1,
    1.0: 1.0,
    2.0: 1.5,
    3.0: 2.0,
}  # what a second costs; little shows little
SLOWER, FASTER = 4.0, 2.0  # than anything recorded or natural
PERIODS, HOLD, SLOW_PERIODS = 10, 3, 2  # of a sine; of a step, in natural periods; of a triangle
SAMPLES_PERIOD = 20  # of the fastest part of a manoeuvre
SAMPLES_LEAST, SAMPLES_MOST = 400, 8000  # of a manoeuvre
LONGEST = 3.0  # times the longest recording


@dataclass(frozen=True, slots=True)
class Pace:
    """How slow and fast a machine may move, Hz: ``slow`` and ``fast`` ends, its ``natural``
    frequency and that of most of what was ``recorded``; one sample every ``step`` s, at most
    ``longest`` s in a run."""

    slow: float
    fast: float
    natural: float
    recorded: float
    step: float
    longest: float

    def lasting(self, seconds: float) -> float:
        """A duration in round numbers, s, within what is recorded at a time."""
        least, most = SAMPLES_LEAST * self.step, min(self.longest, SAMPLES_MOST * self.step)
        return rounded(max(min(seconds, most), least))

    def signals(self) -> Iterator[tuple[SignalName, float, float, float]]:
        """Kinds of signals with the ends of their band (Hz) and duration (s)."""
        own = {rounded(f) for f in (self.slow, self.recorded, self.natural, self.fast)}
        for f in sorted(own):
            yield "sine", f, f, self.lasting(PERIODS / f)
        lo, hi = rounded(self.slow), rounded(self.fast)
        middle = (lo * hi) ** 0.5
        if hi > lo:
            yield "sweep", lo, hi, self.lasting(PERIODS / middle)
            yield "sweep", lo, hi, self.lasting(PERIODS / lo)
            yield "multisine", lo, hi, self.lasting(PERIODS / middle)
        step = rounded(self.natural / (4 * HOLD))
        yield "steps", step, step, self.lasting(SLOW_PERIODS / step)
        yield "triangle", lo, lo, self.lasting(SLOW_PERIODS / lo)


def offers(prepared: Prepared, machine: Machine) -> list[Manoeuvre]:
    """Manoeuvres, the cheapest first: a second costs more where the machine must give more than it
    gave."""
    pace = pace_of(prepared, machine)
    found = [*_driven(prepared, machine, pace), *_released(prepared, machine, pace)]
    return [plan for _, plan in sorted(found, key=lambda offer: offer[0])]


def _driven(prepared: Prepared, machine: Machine, pace: Pace) -> Iterator[tuple[float, Manoeuvre]]:
    """Signals on every channel that was driven, with their cost."""
    imposed = {machine.model.coordinates[i].name for i in machine.imposed}
    for channel, unit, level, peak in _channels(prepared, machine):
        for factor in FACTORS:
            for signal, lo, hi, duration in pace.signals():
                if channel in imposed and signal not in SMOOTH:
                    continue
                yield (
                    duration * EXERTION[factor],
                    Manoeuvre(
                        channel,
                        signal,
                        rounded(factor * peak),
                        unit,
                        duration,
                        pace.step,
                        (lo, hi),
                        level,
                        beyond=factor > 1,
                    ),
                )


def _released(
    prepared: Prepared, machine: Machine, pace: Pace
) -> Iterator[tuple[float, Manoeuvre]]:
    """Every free coordinate pulled away and let go, with the cost."""
    _, reach = rest_of(prepared)
    duration = pace.lasting(PERIODS / pace.natural)
    for i in machine.free:
        item = machine.model.coordinates[i]
        for factor in FACTORS:
            size = rounded(factor * float(reach[i]) / 2 / item.unit.factor)
            if size > 0:
                yield (
                    duration * EXERTION[factor],
                    Manoeuvre(
                        item.name,
                        "release",
                        size,
                        item.unit.text,
                        duration,
                        pace.step,
                        beyond=factor > 1,
                    ),
                )


def pace_of(prepared: Prepared, machine: Machine) -> Pace:
    """How slow and fast a machine has moved, and would by itself."""
    runs = prepared.runs
    step = float(f"{max(np.median(np.diff(run.recording.t)) for run in runs):.6g}")
    longest = LONGEST * max(run.recording.duration for run in runs)
    slowest, fastest = SLOW_PERIODS / longest, 1 / (SAMPLES_PERIOD * step)
    seen = [1 / float(period) for run in runs for period in run.motion.periods()]
    modes = natural_frequencies(prepared, machine)
    own = np.clip([*seen, *modes], slowest, fastest)
    recorded = float(np.median(np.clip(seen, slowest, fastest)))
    natural = float(np.median([f for f in modes if f < fastest] or [recorded]))
    slow, fast = float(own.min()) / SLOWER, float(own.max()) * FASTER
    return Pace(max(slow, slowest), min(fast, fastest), natural, recorded, step, longest)


def natural_frequencies(prepared: Prepared, machine: Machine) -> tuple[float, ...]:
    """Frequencies (Hz) at which the undamped machine swings by itself about where it was recorded,
    from M and −∂k_e/∂q there; none of what nothing holds."""
    q, reach = rest_of(prepared)
    free, p = list(machine.free), machine.values
    if not free:
        return ()
    if machine.constraints:  # the median of a loop need not close, and its reactions hold it too
        return _swings_closed(prepared, machine)
    z = call(machine.inner_rest, (q, np.zeros_like(q), 0.0, p))[0].reshape(-1)
    u = np.array([resting(prepared, item.name) for item in machine.model.inputs])

    def force(place: Array) -> Array:
        return call(machine.k_e, (place, np.zeros_like(q), z, u, 0.0, p))[0].reshape(-1)

    steps = 1e-3 * np.where(reach > 0, reach, 1.0)
    moved = np.diag(steps)
    slopes = [
        (force(q - row) - force(q + row)) / (2 * h) for row, h in zip(moved, steps, strict=True)
    ]
    stiffness = np.column_stack(slopes)[np.ix_(free, free)]
    (mass,) = call(machine.M, (q, 0.0, p))
    roots = np.linalg.eigvals(np.linalg.solve(mass[np.ix_(free, free)], stiffness)).real
    return tuple(sorted(float(np.sqrt(root)) / (2 * np.pi) for root in roots if root > 0))


def _swings_closed(prepared: Prepared, machine: Machine) -> tuple[float, ...]:
    """The same from the linearised machine, in the directions that constraints leave, at the
    sample nearest to the median."""
    places, form = np.concatenate([run.motion.q for run in prepared.runs]), state_form(machine)
    apart = np.abs(places - np.median(places, axis=0)) / np.maximum(np.ptp(places, axis=0), 1e-12)
    q, p = places[int(np.argmin(apart.sum(axis=1)))], machine.values
    z = call(machine.inner_rest, (q, np.zeros_like(q), 0.0, p))[0].reshape(-1)
    u = np.array([resting(prepared, item.name) for item in machine.model.inputs])
    still = np.zeros_like(q)
    slope = free_slope(form, form.state(q, still, z), form.driven(u, q, still, still), 0.0, p)
    roots = np.linalg.eigvals(slope)
    return tuple(sorted(float(abs(root)) / (2 * np.pi) for root in roots if root.imag > 0))


def _channels(prepared: Prepared, machine: Machine) -> Iterator[tuple[str, str, float, float]]:
    """What can be driven: name, unit, the level it stayed about and how far it went from there, in
    its own unit."""
    model = machine.model
    imposed = [model.coordinates[i] for i in machine.imposed]
    channels: list[Input | Coordinate] = [*model.inputs, *imposed]
    for item in channels:
        level = resting(prepared, item.name)
        signals = [run.recording.inputs[item.name] for run in prepared.runs]
        peak = max(float(np.abs(signal - level).max()) for signal in signals)
        if peak > 0:
            yield item.name, item.unit.text, level / item.unit.factor, peak / item.unit.factor


def peaks(prepared: Prepared, machine: Machine) -> dict[str, float]:
    """How far from its level every input and imposed coordinate was driven, and half the travel of
    every free one, each in its own unit."""
    _, reach = rest_of(prepared)
    found = {name: peak for name, _, _, peak in _channels(prepared, machine)}
    for i in machine.free:
        item = machine.model.coordinates[i]
        found[item.name] = float(reach[i]) / 2 / item.unit.factor
    return found


def resting(prepared: Prepared, name: str) -> float:
    """The level about which an input was driven, SI, in two digits; 0 if it is small against the
    drive."""
    values = np.concatenate([run.recording.inputs[name] for run in prepared.runs])
    level = float(np.mean(values))
    return rounded(level) if abs(level) > LARGE * float(np.abs(values).max(initial=0.0)) else 0.0


def rest_of(prepared: Prepared) -> tuple[Array, Array]:
    """Where the machine was (n,), median, and its travel (n,) in the recordings, SI."""
    q = np.concatenate([run.motion.q for run in prepared.runs])
    return np.median(q, axis=0), np.ptp(q, axis=0)


def factor_of(machine: Machine, name: str) -> float:
    """SI units in one unit of an input or a coordinate."""
    channels: list[Input | Coordinate] = [*machine.model.inputs, *machine.model.coordinates]
    return next(item.unit.factor for item in channels if item.name == name)


def rounded(value: float) -> float:
    """Two digits, towards zero: never more than was meant."""
    if value == 0 or not np.isfinite(value):
        return value
    digit = 10.0 ** (floor(log10(abs(value))) - 1)
    return float(f"{np.trunc(value / digit + 1e-9 * np.sign(value)) * digit:.3g}")

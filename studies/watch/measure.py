"""How soon a watch tells changes, how it names them, and how often it tells what is none.

    python studies/watch/measure.py [--first 40] [--changes 40] [--nulls 10] [--null-s 600] [--in-c]

A slide with dry friction is simulated here, by equations of its own: under a multisine whose lines
and phases a seed draws. After 90 s one thing changes. Every change is drawn: which, and how large.
With --in-c the runs without a change are watched by the monitor in C, which is as good as silent
after its first alarm and costs next to nothing. Prints a table; nothing here is a test.
"""

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from in_c import played_in_c
from numba import njit
from numpy.typing import NDArray

from symhyb.model.read import read_model
from symhyb.monitoring.events import Event
from symhyb.monitoring.watching import Watch, watch

Array = NDArray[np.float64]
MODEL = Path(__file__).parent / "model.toml"
RATE, REFERENCE_S, AT_S, AFTER_S = 200, 60.0, 90.0, 20.0
MASS, TURNS = 2.0, 1e-3  # kg; m/s, within which dry friction turns over
STEPS = 20  # of the simulation from one row to the next: 0.25 ms; friction turns over in 3.3 ms
GOOD = {"k": 200.0, "c": 1.0, "mu": 0.6, "gain": 1.0, "play": 0.0}
CHANGES = {
    "friction": ("mu", 0.3, 0.5),  # of what it was
    "stiffness": ("k", 0.03, 0.10),
    "damping": ("c", 0.3, 1.0),
    "gain": ("gain", 0.02, 0.05),
    "play": ("play", 1e-3, 4e-3),  # m to each side
}
NAMES = {
    "friction": ("mu", "friction"),
    "stiffness": ("parameter k", "spring on x"),
    "damping": ("parameter c", "damping on x"),
    "gain": ("gain in channel f",),
    "play": ("play in the spring on x",),
}
"""The names that are right; of a gain of the input and of the sensor a linear machine shows the
ratio, dry friction tells them apart."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """What a seed draws: the change, by which share of what it was, or play in m."""

    kind: str
    size: float

    def __str__(self) -> str:
        by = f"{1e3 * self.size:.1f} mm" if self.kind == "play" else f"{self.size:.1%}"
        return f"{self.kind} + {by}"


def drawn(seed: int) -> Drawn:
    """The change of a seed."""
    rng = np.random.default_rng(seed)
    kind = list(CHANGES)[seed % len(CHANGES)]
    _, low, high = CHANGES[kind]
    return Drawn(kind, float(rng.uniform(low, high)))


@njit
def pushed(t: float, waves: Array, phases: Array) -> float:
    """The force of the drive, N."""
    force = 0.0
    for w in range(waves.size):
        force += 4 * np.sin(2 * np.pi * waves[w] * t + phases[w])
    return force


@njit
def accelerated(x: float, v: float, force: float, numbers: Array) -> float:
    """The acceleration of the slide, m/s², under numbers (k, c, mu, gain, play)."""
    k, c, mu, gain, play = numbers
    pressed = max(x - play, 0.0) + min(x + play, 0.0)
    return (gain * force - k * pressed - c * v - mu * np.tanh(v / TURNS)) / MASS


@njit
def recorded(waves: Array, phases: Array, before: Array, after: Array, count: int) -> Array:
    """Force, N, and place of the slide, m, at the samples of a logger (2, count), under numbers
    ``before`` and ``after`` a change, by Runge and Kutta's method of order 4."""
    dt = 1.0 / RATE / STEPS
    found = np.empty((2, count))
    x, v = 0.0, 0.0
    for i in range(count):
        numbers = after if i >= AT_S * RATE else before
        force = pushed(i / RATE, waves, phases)
        found[0, i], found[1, i] = force, x
        for j in range(STEPS):
            now = i / RATE + j * dt
            half, end = pushed(now + dt / 2, waves, phases), pushed(now + dt, waves, phases)
            a1 = accelerated(x, v, force, numbers)
            v2 = v + dt / 2 * a1
            a2 = accelerated(x + dt / 2 * v, v2, half, numbers)
            v3 = v + dt / 2 * a2
            a3 = accelerated(x + dt / 2 * v2, v3, half, numbers)
            v4 = v + dt * a3
            a4 = accelerated(x + dt * v3, v4, end, numbers)
            x += dt * (v + 2 * v2 + 2 * v3 + v4) / 6
            v += dt * (a1 + 2 * a2 + 2 * a3 + a4) / 6
            force = end
    return found


def lines(seed: int, seconds: float, change: Drawn | None) -> Iterator[str]:
    """The rows of a logger."""
    rng = np.random.default_rng(10_000 + seed)
    t = np.arange(0, seconds, 1 / RATE)
    waves, phases = rng.uniform(0.3, 3.0, 8), rng.uniform(0, 2 * np.pi, 8)
    before, after = (np.array(list(one.values())) for one in (GOOD, changed(change)))
    force, place = recorded(waves, phases, before, after, t.size)
    place += 1e-4 * rng.standard_normal(t.size)
    yield "t,f,pos"
    rows = zip(t.tolist(), force.tolist(), place.tolist(), strict=True)
    yield from (f"{a:.4f},{b:.6f},{c:.7f}" for a, b, c in rows)


def changed(change: Drawn | None) -> dict[str, float]:
    """The numbers of the slide after a change."""
    if change is None:
        return GOOD
    key, was = CHANGES[change.kind][0], GOOD[CHANGES[change.kind][0]]
    return {**GOOD, key: was * (1 + change.size) if was else change.size}


def told(seed: int, change: Drawn | None, seconds: float) -> tuple[list[Event], float]:
    """The events of a run, and the seconds of processor for each second of the source."""
    rows = list(lines(seed, seconds, change))
    begun = time.process_time()
    events = list(watch(Watch(read_model(MODEL), REFERENCE_S), rows))
    return events, (time.process_time() - begun) / seconds


def alarms_in_c(seed: int, seconds: float) -> tuple[int, float]:
    """Whether the monitor in C sees a change in a run without one, and the seconds of processor
    that its process takes for each second of the source."""
    rows, first = list(lines(seed, seconds, None)), round(REFERENCE_S * RATE)
    played = played_in_c(read_model(MODEL), rows, first, "slide")
    return int(played.changed), played.spent_s / (seconds - REFERENCE_S)


def main() -> None:
    """Draw, watch and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--first", type=int, default=40, help="first seed")
    parser.add_argument("--changes", type=int, default=40)
    parser.add_argument("--nulls", type=int, default=10)
    parser.add_argument("--null-s", type=float, default=600.0)
    parser.add_argument("--in-c", action="store_true", help="null runs by the monitor in C")
    options = parser.parse_args()
    soon, right, false, delays, cost = 0, 0, 0, [], []
    for seed in range(options.first, options.first + options.changes):
        change = drawn(seed)
        events, spent = told(seed, change, AT_S + AFTER_S)
        cost.append(spent)
        false += sum(e.kind == "changed" and e.at_s < AT_S for e in events)
        first = next((e for e in events if e.kind == "changed" and e.at_s > AT_S), None)
        name = next((e.cause for e in events if e.kind == "named" and e.at_s > AT_S), "")
        delays.append(np.inf if first is None else first.at_s - AT_S)
        soon += delays[-1] <= 5
        hit = any(word in name for word in NAMES[change.kind])
        right += hit
        print(
            f"{seed}: {change}: told after {delays[-1]:.1f} s, named "
            f"{name or 'not'}{'' if hit else ' (wrong)'}",
            flush=True,
        )
    for seed in range(1000 + options.first, 1000 + options.first + options.nulls):
        if options.in_c:
            alarms, spent = alarms_in_c(seed, options.null_s)
        else:
            events, spent = told(seed, None, options.null_s)
            alarms = sum(e.kind == "changed" for e in events)
        cost.append(spent)
        false += alarms
        print(f"{seed}: nothing changes: {alarms} alarms, {spent:.4f} s/s", flush=True)
    hours = (options.nulls * (options.null_s - REFERENCE_S)) / 3600
    hours += options.changes * (AT_S - REFERENCE_S) / 3600
    print(
        f"\ntold within 5 s: {soon} of {options.changes} (median "
        f"{np.median(delays or [np.nan]):.1f} s); named: "
        f"{right} of {options.changes}; false alarms: {false} in {hours:.1f} h; "
        f"{np.median(cost):.3f} s of processor for a second of the source"
    )


if __name__ == "__main__":
    main()

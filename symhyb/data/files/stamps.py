"""The times of logged messages: when they were measured, as their stamps say, or were logged.

A message has the time at which a logger received it, and often a stamp that its sender gave it when
it measured. Between both lie buses and queues. The stamp is the time of a topic where every message
has one, the stamps increase, and their clock is that of the logger; else the time of logging is.
Which one it is and how far apart both are is said: it is a delay that a wrong choice would leave.
Sizes: N messages of a topic.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.judgement import DRIFT_LEAST, SIGNIFICANT

NS = 1e9  # in a second
PARTS = 10  # of a topic, whose smallest delays show whether two clocks run apart
CLOCKS = ("t", "t_log", "t_stamp")
"""What the times of a topic are called: those that are used, and those that are not."""
MOST_TOPICS = 40  # that a sentence lists

Nanoseconds = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Times:
    """The times ``t`` (N,) of a topic in s and ``others`` (N,) in s that were not taken, called
    ``unused``; None and empty where there are none. ``stamped``: t are stamps; ``said`` is what is
    to be said of them."""

    topic: str
    t: NDArray[np.float64]
    others: NDArray[np.float64] | None = None
    unused: str = ""
    stamped: bool = False
    said: str = ""


def times_of(
    topic: str, logged: Nanoseconds, stamps: Nanoseconds | None, zero: int, lasting: int
) -> Times:
    """The times of a topic from when its messages were ``logged`` and, None without any, their
    ``stamps`` (N,), all in ns.

    ``zero`` is counted from, ``lasting`` is how long the whole file lasts, both in ns.
    """
    t = (logged - zero) / NS
    if stamps is None:
        return Times(topic, t)
    delays = (logged - stamps) / NS
    wrong = _wrong(stamps, delays, lasting / NS)
    if wrong:
        return Times(topic, t, (stamps - stamps[0]) / NS, "t_stamp", False, f"{topic} ({wrong})")
    said = f"{topic} ({_delay_text(delays)}{_drift_text(t, delays)})"
    return Times(topic, (stamps - zero) / NS, t, "t_log", True, said)


def time_notes(times: Sequence[Times]) -> tuple[str, ...]:
    """Say of all topics of a file which of their times was taken."""
    stamped = [one.said for one in times if one.stamped]
    wrong = [one.said for one in times if not one.stamped and one.said]
    bare = [one.topic for one in times if not one.said]
    notes = []
    if stamped:
        notes.append(f"t is when it was measured, as stamped: {_listed(stamped)}")
    if wrong:
        notes.append(f"t is when it was logged, for stamps cannot be used: {_listed(wrong)}")
    if bare and (stamped or wrong):
        notes.append(f"t is when it was logged, without stamps: {_listed(bare)}")
    if bare and not stamped and not wrong:
        notes.append("t is when messages were logged; they have no stamps")
    return tuple(notes)


def _wrong(stamps: Nanoseconds, delays: NDArray[np.float64], lasting: float) -> str:
    """Why stamps cannot be used as times; empty if they can. ``delays`` (N,), ``lasting`` in s."""
    unset = int(np.count_nonzero(stamps == 0))
    if unset:
        return "not set" if unset == stamps.size else f"{unset} of {stamps.size} are not set"
    steps = np.diff(stamps)
    back = int(np.count_nonzero(steps < 0))
    if back:
        return f"they jump back {back} times" if back > 1 else "they jump back"
    same = int(np.count_nonzero(steps == 0))
    if same:
        return f"{same} repeat the one before"
    apart = float(np.median(delays))
    if abs(apart) > lasting:
        return f"their clock is another, {_seconds(abs(apart))} apart"
    return ""


def _delay_text(delays: NDArray[np.float64]) -> str:
    low, middle, high = np.quantile(delays, [0.0, 0.5, 1.0])
    if middle < 0:
        return f"logged {_seconds(-middle)} before that: clocks of two computers differ"
    return f"logged {_seconds(middle)} later, {_seconds(low)} to {_seconds(high)}"


def _drift_text(t: NDArray[np.float64], delays: NDArray[np.float64]) -> str:
    """Say that the clock of the stamps runs apart from that of the logger, if it does.

    Queues only ever add to a delay, so that the smallest delays of parts of a topic show the clocks
    (Paxson: On calibrating measurements of packet transit times. SIGMETRICS 1998); along them lies
    a line, whose slope is significant beside what the parts scatter about it.
    """
    parts = np.array_split(np.arange(t.size), PARTS)
    if min(part.size for part in parts) < 2:
        return ""
    least = [part[np.argmin(delays[part])] for part in parts]
    x, y = t[least] - t[least].mean(), delays[least] - delays[least].mean()
    slope = float(x @ y / (x @ x))
    error = float(np.sum((y - slope * x) ** 2)) / (PARTS - 2) / float(x @ x)
    if abs(slope) < DRIFT_LEAST or slope**2 < SIGNIFICANT * error:
        return ""
    verb = "grows" if slope > 0 else "shrinks"
    return f"; this {verb} by {1e6 * abs(slope):.3g} us/s, clocks run apart"


def _seconds(value: float) -> str:
    for factor, unit in ((1.0, "s"), (1e3, "ms"), (1e6, "us")):
        if abs(value) * factor >= 1:
            return f"{value * factor:.3g} {unit}"
    return f"{value * 1e6:.2g} us" if value else "0 s"


def _listed(topics: Sequence[str]) -> str:
    more = f" and {len(topics) - MOST_TOPICS} more" if len(topics) > MOST_TOPICS else ""
    return ", ".join(topics[:MOST_TOPICS]) + more

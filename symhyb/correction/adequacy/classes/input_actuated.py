"""An input that acts behind an actuator with one number: an effect that no smooth function shows.

A dead band and a limit are about smooth functions of the input, a lag is a sum of lags: these have
classes of their own. A rate limit and a play remember where the input was, and steps are finer than
any smooth function. Each number takes several values: of each what the input does otherwise, as it
stands, and its slope by the number, which reaches half of the way to the next value.
"""

from collections.abc import Mapping
from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np

from symhyb.correction.adequacy.classes.columns import made_of, pushes
from symhyb.correction.adequacy.classes.erring_input import erring
from symhyb.correction.adequacy.classes.worth import Around, joined, worths_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Generic
from symhyb.model.actuators import ActuatorKey
from symhyb.numeric.kernels.actuators import acted
from symhyb.numeric.kernels.buffers import Array

REMEMBERING: tuple[ActuatorKey, ...] = ("rate_limit", "backlash", "quantum")
TRIED = 16  # values of each number
FIRST, LAST = 0.02, 0.98  # of the largest value, width or rate of an input: tried between them
FINEST, APART = 20.0, 0.5  # steps up to the largest value: most that are tried, and how far apart
BETWEEN = 9  # values more, between the neighbours of the best
KNOWN = 0.02  # of what a value does: how well its size is known

_Case = tuple[int, str, tuple[tuple[str, float], ...], tuple[float, ...]]
_known: WeakKeyDictionary[Recorded, dict[_Case, list[Generic]]] = WeakKeyDictionary()


def input_actuated(start: Around, which: int, key: ActuatorKey) -> Generic:
    """What an input does otherwise behind an actuator with this number, of the likeliest value."""
    return likeliest_number(start, which, key, stated_of(start.recorded, which))[0]


def likeliest_number(
    start: Around, which: int, key: ActuatorKey, stated: Mapping[str, float]
) -> tuple[Generic, float]:
    """What an input does otherwise behind a number of its actuator beside those ``stated``, SI, of
    the value that is worth most, among some and then between the neighbours of the best, and what
    it is worth in ln evidence. The value is its ``figure``, SI."""
    values = tried(start.recorded, which, key)
    first, least = _best(start, which, key, stated, values)
    near = int(np.argmin(np.abs(values - first.figure)))
    ends = values[max(near - 1, 0)], values[min(near + 1, values.size - 1)]
    second, reached = _best(start, which, key, stated, np.linspace(*ends, BETWEEN + 2)[1:-1])
    best = max((least, first), (reached, second), key=lambda pair: pair[0])
    return replace(best[1], tried=values.size + BETWEEN), best[0]


def _best(
    start: Around, which: int, key: ActuatorKey, stated: Mapping[str, float], values: Array
) -> tuple[Generic, float]:
    options = behind_numbers(start.recorded, which, key, stated, values)
    groups = [range(2 * i, 2 * i + 2) for i in range(len(options))]
    worths = worths_of(start, joined(options), groups)
    best = int(np.argmax(worths))
    return options[best], float(worths[best])


def stated_of(recorded: Recorded, which: int) -> dict[str, float]:
    """The numbers of the actuator of an input that the model states, SI."""
    actuator = recorded.windows.machine.model.inputs[which].actuator
    return {one.name: one.si for one in actuator}


def behind_numbers(
    recorded: Recorded,
    which: int,
    key: ActuatorKey,
    stated: Mapping[str, float],
    values: Array,
) -> list[Generic]:
    """What an input does otherwise, for each of the ``values`` (T,) of a number of its actuator
    beside those ``stated``, SI: as it stands, and the slope by the number."""
    known = _known.setdefault(recorded, {})
    case = which, key, tuple(sorted(stated.items())), tuple(values.tolist())
    if case not in known:
        ways = np.abs(np.gradient(values)) / np.sqrt(12)  # deviation of what lies between two
        pairs = zip(values.tolist(), ways.tolist(), strict=True)
        known[case] = [_behind(recorded, which, key, stated, *pair) for pair in pairs]
    return known[case]


def tried(recorded: Recorded, which: int, key: ActuatorKey) -> Array:
    """The values (T,) of a number that are tried, SI."""
    if key == "lag":
        return np.geomspace(recorded.step_s, recorded.period_s, TRIED)
    largest = 0.0
    for item, (u, _) in zip(recorded.items, pushes(recorded, which), strict=True):
        size = np.abs(np.gradient(u, item.block.t[0]) if key == "rate_limit" else u)
        largest = max(largest, float(size.max()))
    match key:
        case "quantum":  # the outermost step, and with it the fit, turns once from count to count
            return largest / np.arange(APART, FINEST + APART, APART)[::-1]
        case "dead_band":
            return np.geomspace(FIRST, LAST, TRIED) * largest
        case "backlash":  # a width, to either side
            return 2 * np.geomspace(FIRST, LAST, TRIED) * largest
        case _:
            return np.linspace(1.0 / TRIED, LAST, TRIED) * largest


def _behind(
    recorded: Recorded,
    which: int,
    key: ActuatorKey,
    stated: Mapping[str, float],
    value: float,
    way: float,
) -> Generic:
    channel = recorded.windows.machine.model.inputs[which]
    errors = []
    for item in recorded.items:
        times, values = item.block.record
        t, held = item.block.t[0], channel.between == "held"
        fine = times.size > item.source[0].t.size
        was = acted(times, values[:, which], stated, held, fine)
        made = acted(times, values[:, which], {**stated, key: value}, held, fine, (key,))
        errors.append(np.column_stack([made.at(t) - was.at(t), way * made.by_at(t)[:, 0]]))
    found = made_of(recorded, "input", channel.name, erring(recorded, which, errors), value)
    spread, mean = np.array([KNOWN, 1.0]), np.array([1 / KNOWN, 0.0])
    return replace(found, spread=spread, mean=mean, does=key)

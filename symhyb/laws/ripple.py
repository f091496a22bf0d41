"""A force periodic in position: cogging of a motor, a bent guide."""

import math
from collections.abc import Iterator

import numpy as np

from symhyb.laws.base import LENGTH, Key, Law
from symhyb.laws.lines import NARROW, PHASE, WAVE, peaks, unexplained
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import PERIODIC, Array, Candidate, Reach

LINES = 400  # frequencies of a periodogram in position
SAMPLES_MOST = 6000  # of a periodogram
SAMPLES_LEAST = 64


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    turn = 2 * m.pi * at.s / values["period"] + values.get("phase", 0)
    return Action(values.get("amplitude", 0) * m.sin(turn))


def _candidates(reach: Reach) -> Iterator[Candidate]:
    for period in place_peaks(reach.stretch, unexplained(reach)):
        shape = (("period", period),)
        yield Candidate(("sine", "cosine"), (False, False), shape, ("period",), order=PERIODIC)


def place_peaks(stretch: Array, force: Array) -> tuple[float, ...]:
    """The periods (in the unit of ``stretch``) of lines in a force along the travel (N,)."""
    travel = float(np.ptp(stretch))
    if travel <= 0 or stretch.size < SAMPLES_LEAST:
        return ()
    rows = np.unique(np.linspace(0, stretch.size - 1, SAMPLES_MOST).astype(int))
    s, f = stretch[rows], force[rows] - np.mean(force[rows])
    lines = np.linspace(1.0, min(60.0, stretch.size / 20), LINES) / travel
    turn = 2 * np.pi * np.outer(s, lines)
    power = np.asarray(np.abs(f @ np.exp(-1j * turn)) ** 2, dtype=float)
    return tuple(1 / line for line in peaks(lines, power, width=4))


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "amplitude" not in n:
        return None
    head = f"a {'torque' if n.turns else 'force'} of {n.amount('amplitude')}"
    if "period" not in n:
        return Phrase(f"{head} that repeats with position", terms=("amplitude",))
    every, period = f"every {n.small('period')} of travel", n.value("period")
    if n.turns and n.unit("period") == "rad" and period > 0.0:
        count = 2.0 * math.pi / period
        times = n.counted(count, count * n.sd("period") / period)
        every = f"{times} times a turn (every {n.degrees('period')})"
    return Phrase(f"{head} that repeats {every}", terms=("amplitude", "period"))


LAW = Law(
    name="ripple",
    keys=(
        Key("amplitude", 1, 0, 0, lower=0.0, symbol="F_a"),
        Key("period", 0, 1, 0, None, reach=NARROW, divides=True, exact=True, symbol="l_p"),
        PHASE,
        LENGTH,
    ),
    energy="active",
    words="a force periodic in position",
    law="amplitude*sin(2*pi*s/period + phase)",
    strengths=("amplitude",),
    needs=("period",),
    action=_action,
    candidates=_candidates,
    terms=WAVE,
    steady=True,
    phrase=_phrase,
    example={"amplitude": 3.0, "period": 0.2, "phase": 0.4},
)

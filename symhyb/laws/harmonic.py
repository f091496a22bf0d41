"""A force harmonic in time."""

from collections.abc import Iterator

import numpy as np

from symhyb.laws.base import ANYWHERE, LENGTH, Key, Law
from symhyb.laws.lines import NARROW, PHASE, WAVE, peaks, unexplained
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import PERIODIC, Array, Candidate, Reach

SAMPLES_LEAST = 64  # of a spectrum


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    wave = m.sin(2 * m.pi * values.get("frequency", 0) * at.t + values.get("phase", 0))
    return Action(values.get("amplitude", 0) * wave)


def _candidates(reach: Reach) -> Iterator[Candidate]:
    for frequency in time_peaks(reach.t, unexplained(reach)):
        # the clock of every recording starts anew, so that its phase is its own
        yield Candidate(
            ("sine", "cosine"),
            (False, False),
            (("frequency", frequency),),
            ("frequency",),
            own=("phase",),
            order=PERIODIC,
        )


def time_peaks(t: Array, force: Array) -> tuple[float, ...]:
    """The frequencies (Hz) of lines in a force (N,), SI, over ``t`` (N,), s, strongest first."""
    step = float(np.median(np.diff(t))) if t.size > SAMPLES_LEAST else 0.0
    whole = np.flatnonzero(np.abs(np.diff(t) - step) > 0.5 * step)
    last = int(whole[0]) + 1 if whole.size else t.size
    if step <= 0 or last < SAMPLES_LEAST:
        return ()
    window = np.hanning(last)
    padded = 4 * last
    spectrum = np.fft.rfft(force[:last] * window, padded)
    power = np.square(spectrum.real) + np.square(spectrum.imag)
    lines: Array = np.arange(power.size) / (padded * step)
    low = int(np.searchsorted(lines, 2 / (last * step)))
    return peaks(lines[low:], power[low:], width=8)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "amplitude" not in n:
        return None
    head = f"a harmonic {'torque' if n.turns else 'force'} of {n.amount('amplitude')}"
    head += f" at {n.amount('frequency')}" if "frequency" in n else ""
    return Phrase(head, terms=("amplitude", "frequency"))


LAW = Law(
    name="harmonic",
    keys=(
        Key("amplitude", 1, 0, 0, vector=True, lower=0.0, symbol="F_a"),
        Key(
            "frequency",
            0,
            0,
            -1,
            None,
            reach=NARROW,
            exact=True,
            symbol="f_0",
            spoken=("1/s", "Hz"),
        ),
        PHASE,
        LENGTH,
    ),
    energy="active",
    words="a harmonic force",
    law="amplitude*sin(2*pi*frequency*t + phase)",
    strengths=("amplitude",),
    placements=ANYWHERE,
    needs=("frequency",),
    action=_action,
    candidates=_candidates,
    terms=WAVE,
    of_state=False,
    steady=True,
    phrase=_phrase,
    example={"amplitude": 3.0, "frequency": 5.0, "phase": 0.4},
)

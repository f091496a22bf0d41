"""What to record next: the cheapest manoeuvre that separates rival explanations.

Every candidate manoeuvre is simulated with one explanation as the truth, without noise; the other
is fitted to that with windows' initial states free, and the other way round. What cannot be fitted
is the evidence to expect, at the noise and its correlation as measured:

    E = min(χ²(B fitted to A), χ²(A fitted to B)) / 2c        ln of the odds

A recording with E in expectation scatters by √(2E). Sizes: N samples, n coordinates, k inputs.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, log

import numpy as np

from symhyb.correction.advice.bounds import bounds_of
from symhyb.correction.advice.offers import offers
from symhyb.correction.advice.playing import played, restrained
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.score import unit_of
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined, grouped, refine
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.runs import Run, cut_into_windows
from symhyb.discrepancy.results import Manoeuvre
from symhyb.judgement import CERTAIN, MARGIN

FITS_MOST = 48  # of one explanation to what another one would do
WINDOWS = 3  # that a manoeuvre holds at least


@dataclass(frozen=True, slots=True)
class Rivals:
    """Two fitted explanations and what they are called."""

    first: Refined
    second: Refined
    names: tuple[str, str]


@dataclass(frozen=True, slots=True)
class Design:
    """What was found to record next: the best manoeuvre, None if none decides anything; and what
    kept most of the ``hindered`` ones from going further, empty if nothing did."""

    expected: "Expected | None"
    hindered: str = ""
    playable: bool = True


@dataclass(frozen=True, slots=True)
class Expected:
    """A manoeuvre with what it is expected to say about each pair of rivals, ln of the odds, and
    what it must say."""

    plan: Manoeuvre
    evidence: tuple[float, ...]
    needed: tuple[float, ...]

    @property
    def decided(self) -> tuple[bool, ...]:
        """Which pairs it separates."""
        return tuple(e >= n for e, n in zip(self.evidence, self.needed, strict=True))


def design(prepared: Prepared, setting: Setting, pairs: Sequence[Rivals]) -> Design:
    """The cheapest manoeuvre that separates all pairs, else that which separates most of them,
    within what the machine may do."""
    best: Expected | None = None
    left = FITS_MOST
    truths = [pairs[0].first, *(pair.second for pair in pairs)]
    bounds, most = bounds_of(prepared), dict[tuple[object, ...], float]()
    hindered: Counter[str] = Counter()
    playable = False
    for offer in offers(prepared, pairs[0].first.machine):
        kind = (offer.channel, offer.signal, offer.frequency, offer.duration)
        if offer.amplitude > most.get(kind, inf):
            continue  # as far as it may go, it was tried
        plan, exceeded = restrained(prepared, truths, offer, bounds)
        if exceeded:
            hindered[exceeded] += 1
            most[kind] = 0.0 if plan is None else plan.amplitude
        if plan is None:
            continue
        playable = True
        expected, spent = _expected(prepared, setting, pairs, plan)
        left -= spent
        if sum(expected.decided) > (0 if best is None else sum(best.decided)):
            best = expected
        if (best is not None and all(best.decided)) or left <= 0:
            break
    return Design(best, next((what for what, _ in hindered.most_common(1)), ""), playable)


def _expected(
    prepared: Prepared, setting: Setting, pairs: Sequence[Rivals], plan: Manoeuvre
) -> tuple[Expected, int]:
    """What a manoeuvre decides of each pair, and how many fits it took."""
    samples = plan.duration / plan.sampling
    needed = tuple(needed_evidence(pair, samples) for pair in pairs)
    evidence, spent = [], 0
    for pair, least in zip(pairs, needed, strict=True):
        ways = (pair.first, pair.second), (pair.second, pair.first)
        worst = inf
        for truth, rival in ways:
            made = played(prepared, truth, plan)
            worst = min(worst, expected(prepared, setting, made, truth, rival))
            spent += 1
            if worst < least:
                break
        evidence.append(worst)
    return Expected(plan, tuple(evidence), needed), spent


def needed_evidence(pair: Rivals, samples: float) -> float:
    """ln(100) with two standard deviations √(2E) to spare, and what more numbers cost: ½ ln N each;
    at least half the standard deviation √(2N) of χ², below which there is nothing to see."""
    root = (MARGIN * 2**0.5 + (2 * MARGIN**2 + 4 * CERTAIN) ** 0.5) / 2
    more = abs(pair.first.numbers - pair.second.numbers)
    return float(max(root**2, (samples / 2) ** 0.5)) + more * log(max(samples, 2)) / 2


def expected(
    prepared: Prepared,
    setting: Setting,
    made: tuple[Recording, Motion],
    truth: Refined,
    rival: Refined,
) -> float:
    """What a recording of the ``truth`` says against the ``rival``; 0 if that cannot be said."""
    recording, motion = made
    first = prepared.runs[0]
    run = Run(recording, motion, setting.sd, first.steps, first.fine)
    length = min(setting.stages[-1].length_s, recording.duration / WINDOWS)
    cuts = cut_into_windows(run, prepared.machine, length)
    if cuts is None:
        return 0.0
    with np.errstate(all="ignore"):  # a number may have no effect at all in a manoeuvre
        fitted = refine(
            prepared.model, rival.causes, grouped(rival), (cuts,), setting.sd, everything=True
        ).fit
    if fitted.reason:
        return 0.0
    return float(fitted.chi2.sum()) / (2 * max(unit_of(truth), unit_of(rival), 1.0))

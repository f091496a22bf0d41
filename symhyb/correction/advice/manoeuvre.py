"""What to record next: the cheapest manoeuvre that tells rival explanations apart.

Every candidate manoeuvre is simulated with one explanation as the truth, without noise; the other
is fitted to that with windows' initial states free, and the other way round. What cannot be fitted
is the evidence to expect, at the noise and its correlation as measured:

    E = min(χ²(B fitted to A), χ²(A fitted to B)) / 2c        ln of the odds

A recording with E in expectation scatters by √(2E). Sizes: N samples, n coordinates, k inputs.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, log

import numpy as np

from symhyb.correction.advice.offers import factor_of, offers, rest_of, resting
from symhyb.correction.advice.signals import signal_of
from symhyb.correction.search.evidence import NOISE_SHARE, unit_of
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined, grouped, refine
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.runs import Run, laid_on
from symhyb.discrepancy.recorded.windows import reversals
from symhyb.discrepancy.results import Manoeuvre
from symhyb.model.vocabulary import steep
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.runs.windows import Block, WindowModel

ODDS = 100.0  # to 1: decisive
MARGIN = 2.0  # standard deviations of the evidence, by which the expected one must exceed ln(ODDS)
TRAVEL_MOST = 3.0  # of the travel that was recorded
FITS_MOST = 48  # of one explanation to what another one would do
ADDED = "another_sensor"  # the name of one that is tried beside those that recorded
WINDOWS = 3  # that a manoeuvre holds at least


@dataclass(frozen=True, slots=True)
class Rivals:
    """Two fitted explanations and what they are called."""

    first: Refined
    second: Refined
    names: tuple[str, str]


@dataclass(frozen=True, slots=True)
class Told:
    """A manoeuvre with what it is expected to say about each pair of rivals, ln of the odds, and
    what it must say."""

    plan: Manoeuvre
    evidence: tuple[float, ...]
    needed: tuple[float, ...]

    @property
    def decided(self) -> tuple[bool, ...]:
        """Which pairs it tells apart."""
        return tuple(e >= n for e, n in zip(self.evidence, self.needed, strict=True))


def design(prepared: Prepared, setting: Setting, pairs: Sequence[Rivals]) -> Told | None:
    """The cheapest manoeuvre that tells all pairs apart, else that which tells most of them; None
    if none tells any."""
    best: Told | None = None
    left = FITS_MOST
    for plan in offers(prepared, pairs[0].first.machine):
        told, spent = _told(prepared, setting, pairs, plan)
        left -= spent
        if told is not None and sum(told.decided) > (0 if best is None else sum(best.decided)):
            best = told
        if (best is not None and all(best.decided)) or left <= 0:
            break
    return best


def _told(
    prepared: Prepared, setting: Setting, pairs: Sequence[Rivals], plan: Manoeuvre
) -> tuple[Told | None, int]:
    """What a manoeuvre says, None if it asks too much of the machine, and how many fits it took."""
    samples = plan.duration / plan.sampling
    needed = tuple(needed_evidence(pair, samples) for pair in pairs)
    evidence, spent = [], 0
    for pair, least in zip(pairs, needed, strict=True):
        ways = (pair.first, pair.second), (pair.second, pair.first)
        worst = inf
        for truth, rival in ways:
            made = played(prepared, truth, plan)
            if made is None:
                return None, spent
            worst = min(worst, expected(prepared, setting, made, truth, rival))
            spent += 1
            if worst < least:
                break
        evidence.append(worst)
    return Told(plan, tuple(evidence), needed), spent


def needed_evidence(pair: Rivals, samples: float) -> float:
    """ln(100) with two standard deviations √(2E) to spare, and what more numbers cost: ½ ln N each;
    at least 1 % of the noise, below which nothing is claimed."""
    root = (MARGIN * 2**0.5 + (2 * MARGIN**2 + 4 * log(ODDS)) ** 0.5) / 2
    more = abs(pair.first.numbers - pair.second.numbers)
    return float(max(root**2, NOISE_SHARE / 2 * samples)) + more * log(max(samples, 2)) / 2


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
    laid = laid_on(run, prepared.machine, length)
    if laid is None:
        return 0.0
    with np.errstate(all="ignore"):  # a number may have no effect at all in a manoeuvre
        fitted = refine(
            prepared.model, rival.causes, grouped(rival), (laid,), setting.sd, everything=True
        ).fit
    if fitted.reason:
        return 0.0
    return float(fitted.chi2.sum()) / (2 * max(unit_of(truth), unit_of(rival), 1.0))


def played(prepared: Prepared, truth: Refined, plan: Manoeuvre) -> tuple[Recording, Motion] | None:
    """The recording, without noise, that a manoeuvre would give if ``truth`` were all; None if the
    machine would travel further than is reasonable."""
    machine, model = truth.machine, truth.machine.model
    t = np.arange(0.0, plan.duration + plan.sampling / 2, plan.sampling)
    q0, reach = rest_of(prepared)
    given = np.repeat(q0[None], t.size, axis=0)
    inputs = {item.name: np.full(t.size, resting(prepared, item.name)) for item in model.inputs}
    driven = factor_of(machine, plan.channel) * signal_of(plan, t)
    names = [c.name for c in model.coordinates]
    if plan.channel in inputs:
        inputs[plan.channel] = driven
    elif plan.signal == "release":
        q0 = q0.copy()
        q0[names.index(plan.channel)] += factor_of(machine, plan.channel) * plan.amplitude
    else:
        given[:, names.index(plan.channel)] = driven
    u = np.column_stack(list(inputs.values())) if inputs else np.empty((t.size, 0))
    rate = np.gradient(given, t, axis=0)
    form = state_form(machine)
    drive = form.driven(u, given, rate, np.gradient(rate, t, axis=0))
    (z0,) = call(machine.inner_rest, (q0, 0.0, truth.p))
    start = form.state(q0[None], np.zeros((1, q0.size)), z0.reshape(1, -1))
    x, y = _simulated(
        prepared,
        truth,
        Block(
            t[None],
            drive[None],
            np.empty((1, t.size, 0)),
            np.ones((1, t.size - 1), np.int64),
            (t, u),
        ),
        start,
    )
    q, v = form.motion(x, drive)
    with np.errstate(invalid="ignore", over="ignore"):
        if not np.all(np.ptp(q, axis=0)[list(machine.free)] <= TRAVEL_MOST * reach):
            return None
    own = prepared.runs[0].motion
    motion = replace(own, t=t, q=q, v=v, a=np.gradient(v, t, axis=0), blind=())
    imposed = {names[i]: given[:, i] for i in machine.imposed}
    seen = {ADDED}.union(*(run.recording.sensors for run in prepared.runs))
    sensors = {
        s.name: column for s, column in zip(model.sensors, y.T, strict=True) if s.name in seen
    }
    return Recording("next", t, {**inputs, **imposed}, sensors, (), ""), motion


def _simulated(
    prepared: Prepared, truth: Refined, block: Block, start: Array
) -> tuple[Array, Array]:
    """States (N, X) and outputs (N, m) of one long run; finer near reversals where a law is
    steep."""
    late = tuple(c.path.removesuffix(".delay") for c in truth.causes if c.kind == "delay")
    model = WindowModel(truth.machine, tuple(map(truth.machine.column, truth.paths)), late)
    run = prepared.runs[0]
    sharp = steep(truth.machine.model)
    parts = np.full_like(block.substeps, run.steps * (4 if sharp else 1))
    with np.errstate(over="ignore", invalid="ignore"):
        x, y = model.simulate(replace(block, substeps=parts), start, truth.p)
        if sharp and np.isfinite(x).all():
            _, v = model.form.motion(x[0], block.d[0])
            parts = run.steps * np.where(reversals(v), run.fine, 1)[None]
            x, y = model.simulate(replace(block, substeps=parts), start, truth.p)
    return x[0], y[0]

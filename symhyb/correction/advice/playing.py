"""A manoeuvre played by an explanation: the recording, without noise, that it would give.

Sizes: N samples, n coordinates, m sensors, X states.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.advice.bounds import Bounds
from symhyb.correction.advice.offers import factor_of, peaks, rest_of, resting, rounded
from symhyb.correction.advice.signals import signal_of
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.trajectory import Refined, delayed
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.windows import turning
from symhyb.discrepancy.results import Manoeuvre
from symhyb.judgement import NOTABLE
from symhyb.model.vocabulary import steep
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.runs.windows import Block, WindowModel

ADDED = "another_sensor"  # the name of one that is tried beside those that recorded
ROOM, STEEPEST = (
    0.97,
    0.2,
)  # a reduction aims below the bound, and takes no more at a time than this
REDUCTIONS = 6


def restrained(
    prepared: Prepared, truths: Sequence[Refined], plan: Manoeuvre, bounds: Bounds
) -> tuple[Manoeuvre | None, str]:
    """The manoeuvre with an amplitude at which it stays within bounds, whichever of the ``truths``
    holds; None if that is too small to be worth it. And what it would exceed as it was, if
    anything."""
    peak = peaks(prepared, truths[0].machine).get(plan.channel, 0.0)
    exceeded, amplitude = "", plan.amplitude
    for truth in truths:
        for _ in range(REDUCTIONS):
            tried = replace(plan, amplitude=amplitude)
            excess, what = bounds.excess(*played(prepared, truth, tried))
            if excess <= 1:
                break
            exceeded = exceeded or what
            amplitude = rounded(amplitude * max(ROOM / excess, STEEPEST))
            if amplitude < NOTABLE * peak:
                return None, exceeded
        else:
            return None, exceeded
    return replace(plan, amplitude=amplitude, beyond=amplitude > peak), exceeded


def played(prepared: Prepared, truth: Refined, plan: Manoeuvre) -> tuple[Recording, Motion]:
    """The recording, without noise, that a manoeuvre would give if ``truth`` were all; not finite
    from where it could not be simulated."""
    machine, model = truth.machine, truth.machine.model
    t = np.arange(0.0, plan.duration + plan.sampling / 2, plan.sampling)
    q0, _ = rest_of(prepared)
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
    still = np.zeros_like(q0)
    (z0,) = call(machine.inner_rest, (q0, still, 0.0, truth.p))
    start = form.state(q0[None], still[None], z0.reshape(1, -1))
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
    own = prepared.runs[0].motion
    with np.errstate(invalid="ignore", over="ignore"):
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
    late = delayed(truth)
    model = WindowModel(truth.machine, tuple(map(truth.machine.column, truth.paths)), late)
    run = prepared.runs[0]
    sharp = steep(truth.machine.model)
    parts = np.full_like(block.substeps, run.steps * (4 if sharp else 1))
    with np.errstate(over="ignore", invalid="ignore"):
        x, y = model.simulate(replace(block, substeps=parts), start, truth.p)
        if sharp and np.isfinite(x).all():
            q, v = model.form.motion(x[0], block.d[0])
            near = turning(truth.machine, replace(run.motion, t=block.t[0], q=q, v=v))
            parts = run.steps * np.where(near, run.fine, 1)[None]
            x, y = model.simulate(replace(block, substeps=parts), start, truth.p)
    return x[0], y[0]

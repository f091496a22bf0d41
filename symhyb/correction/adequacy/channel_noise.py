"""What noise shows about the channels: a colour that is no noise of a sensor, a force that is noise
of an input.

Coloured noise of a sensor explains what no force does, and so could hide a sensor that drifts or
freezes. Noise is stationary, faster than the motion and, its colour taken off, about normal at
every size of the motion.
An unknown force that does not know its last sample comes from how an input was recorded.
"""

from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.special import expit

from symhyb.correction.adequacy.beyond import Beyond
from symhyb.correction.adequacy.classes.erring_input import spared_by
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import NOISE_FLOOR, Fitted, Generic, Likely, tracks_of
from symhyb.discrepancy.likelihood.horizon import maximised, memoryless
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import Track, white_problem
from symhyb.discrepancy.recorded.channel_spread import excess_kurtosis
from symhyb.judgement import BURSTS, CERTAIN, FAST, NEGLIGIBLE
from symhyb.numeric.kernels.buffers import Array

LEVELS = 10  # classes of the size of the motion


def faulty_sensors(recorded: Recorded, trial: Fitted) -> tuple[Likely, ...]:
    """The sensors whose colour is no noise, each with the probability of the colour."""
    noise = trial.fit.noise
    if trial.fit.reason or not noise.coloured:
        return ()
    tracks = tracks_of(recorded, trial)
    found = list(_faults(recorded, noise, tracks))
    if not found:
        return ()
    steady, without = maximised(tracks, noise.without_colour(), NOISE_FLOOR * recorded.sd)
    price = noise.price(trial.fit.count) - steady.price(trial.fit.count)
    gain = trial.fit.logl - without - price
    if gain < CERTAIN:
        return ()
    return tuple(Likely(generic, float(expit(gain))) for generic in found)


def noisy_inputs(recorded: Recorded, trial: Fitted, left: Beyond) -> tuple[Likely, ...]:
    """The inputs of which the unknown force beside a structure may be the noise: it has no memory,
    and acts nowhere else than one input does, or wherever it acts exactly one of several does."""
    if not left.acts:
        return ()
    named = _reaching(recorded, set(np.flatnonzero(left.share > NEGLIGIBLE)))
    if not named or not _forgets(recorded, trial, left):
        return ()
    inputs = recorded.windows.machine.model.inputs
    each = [Generic("input", inputs[j].name, (), np.zeros(0), does="noisy") for j in named]
    return tuple(Likely(generic, left.probability) for generic in each)


def _reaching(recorded: Recorded, acting: AbstractSet[int]) -> list[int]:
    """One input that pushes wherever a force is ``acting``, or several of which exactly one pushes
    each of these coordinates, not through a state; none where there are no such."""
    inputs = range(len(recorded.windows.machine.model.recorded_inputs))
    pushed = [acting - set(spared_by(recorded, j, at_once=True)) for j in inputs]
    alone = [j for j in inputs if pushed[j] == acting]
    if alone:
        return alone[:1]
    several = [j for j in inputs if pushed[j]]
    once = all(sum(i in pushed[j] for j in several) == 1 for i in acting)
    return several if once else []


def _forgets(recorded: Recorded, trial: Fitted, left: Beyond) -> bool:
    """Whether the unknown force has no memory: one of few samples, or one that is not worth the
    price of a number, ½ ln N."""
    if left.memory_s <= FAST * recorded.step_s:
        return True
    fit, floor = trial.fit, NOISE_FLOOR * recorded.sd
    _, without = memoryless(tracks_of(recorded, trial), fit.noise, floor, recorded.step_s)
    return bool(without > fit.logl - 0.5 * np.log(max(fit.count, 2)))


def sensor_sd(recorded: Recorded, trial: Fitted, left: Beyond) -> Array:
    """The noise (m,) of every sensor, SI, white and coloured together; that of smoothing where the
    colour is none, is no noise, or may be a force. Where no force acts (``left``) that of sensors
    alone."""
    noise = trial.fit.noise
    if left.alone is not None and not left.acts:
        noise = left.alone
    names = [sensor.name for sensor in recorded.windows.machine.model.sensors]
    tracks = tracks_of(recorded, trial)
    faulty = {one.where for one in _faults(recorded, noise, tracks)}
    true = (noise.colour > 0) & [name not in faulty for name in names]
    true &= ~_showing_forces(recorded, tracks)
    return np.where(true, np.hypot(noise.white, noise.colour), recorded.sd)


def _showing_forces(recorded: Recorded, tracks: Sequence[Track]) -> NDArray[np.bool_]:
    """The sensors (m,) that show a force on an imposed coordinate, such as a force cell of a rig:
    nothing moves by that force, so that its colour cannot be distinguished from theirs."""
    imposed = list(recorded.windows.machine.imposed)
    shown = [one.linear.by_force[0][:, :, imposed].any(axis=(0, 2)) for one in tracks]
    return np.asarray(np.any(shown, axis=0))


def _faults(recorded: Recorded, noise: NoiseModel, tracks: Sequence[Track]) -> Iterator[Generic]:
    white = innovations(noise, tracks)
    for j in np.flatnonzero(noise.colour):
        name = recorded.windows.machine.model.sensors[j].name
        if noise.colour_s > recorded.period_s:
            yield Generic("sensor", name, (), np.zeros(0), does="drifts")
        elif excess_kurtosis(_leveled(recorded, white[:, j], int(j))) > BURSTS:
            yield Generic("sensor", name, (), np.zeros(0), does="jumps")


def innovations(noise: NoiseModel, tracks: Sequence[Track]) -> Array:
    """The white residuals (N, m), dimensionless, NaN where nothing was measured."""
    parts = []
    for one in tracks:
        white = white_problem(one, noise)[0].reshape(one.residual.shape)
        parts.append(np.where(one.seen, white, np.nan))
    return np.concatenate(parts)


def _leveled(recorded: Recorded, white: Array, which: int) -> Array:
    """White residuals (N,) of a sensor, of what was measured, over their RMS at each size of the
    motion, in ten classes: a model that fails at large motion alone does so in bursts too, and no
    sensor is at fault."""
    samples = max(round(recorded.period_s / recorded.step_s), 1)
    sizes = []
    for item in recorded.items:
        y = item.block.y[0][:, which]
        seen = np.isfinite(y)
        away = np.where(seen, y - y[seen].sum() / max(seen.sum(), 1), 0.0)
        sizes.append(uniform_filter1d(away**2, samples, mode="nearest"))
    order = np.argsort(np.concatenate(sizes))
    levels = np.array_split(white[order][np.isfinite(white[order])], LEVELS)
    return np.concatenate([e / (np.sqrt(e @ e / max(e.size, 1)) or 1.0) for e in levels])

"""Windows of recordings, and the linear algebra that removes their initial states.

Each window has free initial states. They are eliminated by an orthogonal projection (variable
projection; Golub & Pereyra, SIAM J. Numer. Anal. 10, 1973), so that what remains is a linear
regression of the whitened residual on the parameters and candidate forces.
Sizes: W windows, L samples a window, m sensors, n coordinates, F columns.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import Course, course_of
from symhyb.discrepancy.recorded.ends import margin_of
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.signals import measured
from symhyb.judgement import LARGE
from symhyb.model.types import Input
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.dynamics import delay_of, state_form
from symhyb.numeric.lowered.known import with_known
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.between import bent_columns, finer
from symhyb.numeric.runs.windows import Block, WindowModel

SLOW_SHARE = 0.02
STILL = 2.0  # standard deviations: a rate that is nearer to none may be none
GAP = 1.5  # steps between two samples: more is a gap in time
SAMPLES_LEAST = 12  # samples a window has at least
EVEN = 0.25  # samples: what was recorded a whole number of samples later lies this near
SWUNG = 1.5  # times as fast as anywhere else: the smoothed motion swings at its end


class Whitening(Protocol):
    """Noise of windows that is more than the white noise of every sensor by itself."""

    def whitened(
        self, rows: NDArray[np.int64], columns: Array, seen: NDArray[np.bool_], sd: Array
    ) -> Array:
        """Columns (W, L, m, K), SI, of windows of the samples ``rows`` (W, L) in units of the
        noise, uncorrelated; 0 where nothing is ``seen`` (W, L, m). ``sd`` (m,): of the sensors."""

    def shown(self, rows: NDArray[np.int64]) -> Array:
        """What the sensors of windows (W, L, m) show more, SI, with inputs that are put right."""

    def put_right(self, item: "Cut") -> "Cut":
        """Windows of the same recording that know of this noise, with its inputs put right."""


@dataclass(frozen=True, slots=True)
class Cut:
    """Windows cuts on one recording: the block, start states (W, X) and the ``states`` (W, L, X)
    from smoothing, SI, and ``held`` (W,), True where a window only validates. ``rows`` (W, L) are
    the samples of the recording, ``source`` where they come from. ``floor`` is the mean square by
    which repeated runs differ beyond their noise, in units of the noise: less proves nothing.
    ``steps`` are the integration steps between two samples that laws without jumps need, ``fine``
    how many times as many a steep law takes near a reversal of the place where it acts. ``noise``
    is what is known of noise that is not white at every sensor by itself."""

    block: Block
    start: Array
    states: Array
    held: NDArray[np.bool_]
    rows: NDArray[np.int64]
    source: tuple[Recording, Motion]
    floor: float = 0.0
    steps: int = 1
    fine: int = 1
    noise: Whitening | None = None

    def white(self, columns: Array, sd: Array, seen: NDArray[np.bool_] | None = None) -> Array:
        """Columns (W, L, m, K), SI, in units of the noise and uncorrelated (W, L·m, K), with noise
        ``sd`` (m,) of the sensors; 0 where nothing was measured, or is ``seen`` (W, L, m)."""
        seen = np.isfinite(self.block.y) if seen is None else seen
        windows, length, m, count = columns.shape
        if self.noise is None or not count:
            made = columns * np.where(seen, 1 / sd, 0.0)[..., None]
        else:
            made = self.noise.whitened(self.rows, columns, seen, sd)
        return np.asarray(made.reshape(windows, length * m, count))

    def course(self, machine: Machine) -> Course:
        """The whole course that the windows are cut from."""
        recording, motion = self.source
        return course_of(recording, machine, motion)

    def chosen(self, rows: NDArray[np.int64]) -> "Cut":
        """Some of the windows; of these every third validates."""
        whole = self.block
        block = replace(
            whole,
            t=whole.t[rows],
            d=whole.d[rows],
            y=whole.y[rows],
            substeps=whole.substeps[rows],
        )
        return Cut(
            block,
            self.start[rows],
            self.states[rows],
            np.arange(rows.size) % 3 == 2,
            self.rows[rows],
            self.source,
            self.floor,
            self.steps,
            self.fine,
            self.noise,
        )

    def between(self, first: int, last: int) -> "Cut":
        """The samples from ``first`` to before ``last`` of every window."""
        whole = self.block
        block = replace(
            whole,
            t=whole.t[:, first:last],
            d=whole.d[:, first:last],
            y=whole.y[:, first:last],
            substeps=whole.substeps[:, first : last - 1],
        )
        states, rows = self.states[:, first:last], self.rows[:, first:last]
        return replace(self, block=block, start=states[:, 0], states=states, rows=rows)

    def suited(self, machine: Machine) -> "Cut":
        """The windows for a machine with the same coordinates: with its inner states, and with
        finer steps near the reversals of places where it has steep laws."""
        item = self
        if machine.inner_states or state_form(machine).size != self.start.shape[1]:
            states = self.course(machine).states[self.rows]
            item = replace(self, start=states[:, 0], states=states)
        near = turning(machine, self.source[1])[self.rows[:, :-1]]
        parts = item.steps * np.where(near, item.fine, 1)
        return replace(item, block=replace(item.block, substeps=parts))

    def in_time(self, model: WindowModel, p: Array) -> "Cut":
        """The windows with what late sensors recorded under ``p`` (P,), SI, taken whole samples
        later: the model is asked for the rest of their delays alone, at most half a sample, over
        which a state may be extrapolated. So the noise stays as recorded."""
        sensors = model.machine.model.sensors
        if not self.block.late and not any(s.name in model.form.late for s in sensors):
            return self
        recording, step = self.source[0], float(np.median(np.diff(self.block.t, axis=1)))
        shifts = np.zeros(len(sensors), dtype=int)
        for j, sensor in enumerate(sensors):
            if sensor.name in model.form.late:
                stated = sensor.delay.si if sensor.delay else 0.0
                delay = delay_of(model.machine, sensor, p)
                shifts[j] = round((delay - stated) / step)
        late = tuple((shifts * step).tolist()) if shifts.any() else ()
        if late == self.block.late:
            return self
        y, t = measured(recording, model.machine), recording.t
        columns = []
        for j, shift in enumerate(shifts):
            then = np.clip(self.rows + shift, 0, t.size - 1)
            apart = np.abs(t[then] - t[self.rows] - shift * step)
            columns.append(np.where(apart < EVEN * step, y[then, j], np.nan))
        signals = np.stack(columns, axis=2)
        if self.noise is not None:
            signals = signals + self.noise.shown(self.rows)
        return replace(self, block=replace(self.block, y=signals, late=late))

    def first(self) -> "Cut":
        """The first window alone."""
        return self.chosen(np.array([0]))


def lay(
    recording: Recording,
    machine: Machine,
    motion: Motion,
    length_s: float,
    substeps: NDArray[np.int64] | None = None,
) -> Cut | None:
    """Make windows of ``length_s`` seconds without overlap; every third one validates.

    Windows that straddle a gap in time or miss more samples than others are left out. ``substeps``
    (N − 1,) are the integration steps between the samples of the recording, default one, until
    the windows are adapted to a machine. Returns
    None if the recording holds no window.
    """
    step = float(np.median(np.diff(recording.t)))
    samples = max(round(length_s / step) + 1, SAMPLES_LEAST)
    if samples > recording.t.size:
        return None
    begin = _settled(motion, step)
    if begin + samples > recording.t.size:  # no room: all of the recording is wanted
        begin = 0
    firsts = np.arange(begin, recording.t.size - samples + 1, samples - 1)
    rows = firsts[:, None] + np.arange(samples)
    y = measured(recording, machine)
    whole = (recording.t[rows[:, -1]] - recording.t[rows[:, 0]]) < GAP * (samples - 1) * step
    present = np.isfinite(y[:, np.isfinite(y).any(axis=0)])
    there = present[rows].sum(axis=(1, 2))
    enough = there >= (1 - LARGE) * max(np.quantile(there, 0.75), SAMPLES_LEAST)
    rows = rows[whole & enough]
    if len(rows) == 0:
        return None
    parts = np.ones(recording.t.size - 1, int) if substeps is None else substeps
    return _cut(recording, machine, motion, rows, parts, int(parts.min()))


def stretches(
    recording: Recording, machine: Machine, motion: Motion, steps: int, fine: int
) -> list[Cut]:
    """Every stretch of a recording without a gap in time, as one window each; ``steps`` between two
    samples, each ``fine`` times finer for a steep law near its reversals."""
    t = recording.t
    step = float(np.median(np.diff(t)))
    begin = _settled(motion, step)
    ends = np.flatnonzero(np.diff(t) > GAP * step) + 1
    parts = np.full(t.size - 1, steps)
    found = []
    for first, last in zip([begin, *ends], [*ends, t.size], strict=True):
        if last - max(first, begin) >= SAMPLES_LEAST:
            rows = np.arange(max(first, begin), last)[None]
            found.append(replace(_cut(recording, machine, motion, rows, parts, steps), fine=fine))
    return found


def _cut(
    recording: Recording,
    machine: Machine,
    motion: Motion,
    rows: NDArray[np.int64],
    parts: NDArray[np.int64],
    steps: int,
) -> Cut:
    """Windows of the samples ``rows`` (W, L)."""
    y, course = measured(recording, machine), course_of(recording, machine, motion)
    states = course.states[rows]
    held = np.arange(len(rows)) % 3 == 2
    record = _record(recording, machine.model.inputs)
    block = Block(recording.t[rows], course.drive[rows], y[rows], parts[rows[:, :-1]], record)
    block = replace(block, known=recording.parameters)
    return Cut(block, states[:, 0], states, held, rows, (recording, motion), steps=steps)


@lru_cache(maxsize=32)
def _record(recording: Recording, inputs: tuple[Input, ...]) -> tuple[Array, Array]:
    """Times (K,) s and inputs (K, k), SI, as recorded; smooth ones on a finer grid."""
    found = [recording.inputs[item.name] for item in inputs]
    columns = np.column_stack(found) if found else np.empty((recording.t.size, 0))
    return finer(recording.t, columns, *bent_columns(inputs))


def _settled(motion: Motion, step: float) -> int:
    """The sample from which the smoothed motion determines a start: with few samples a period a
    spline may swing at its end, to speeds that the motion never has again."""
    end = int(np.ceil(margin_of(motion) / step))
    size = np.abs(motion.v)
    if size.shape[0] < 20 * end or size.shape[1] == 0:
        return 0
    return end if bool((size[:end] > SWUNG * size[end:-end].max(axis=0)).any()) else 0


@lru_cache(maxsize=16)
def rates_of(machine: Machine, motion: Motion) -> tuple[Array, Array]:
    """The rate at the place of every element (N, E) along a motion, NaN at points, and one standard
    deviation of it (E,), SI."""
    given = motion.q, motion.v, motion.t, with_known(machine, machine.values, motion.known)
    _, rates, directions = along(machine.pathways, given, (3,), motion.t.size)
    ways = directions.reshape(motion.t.size, -1, machine.n)
    return rates, np.sqrt(np.mean((ways * motion.v_sd) ** 2, axis=0).sum(axis=1))


def turning(machine: Machine, motion: Motion) -> NDArray[np.bool_]:
    """Intervals between samples (N − 1,) near a reversal or a rest of a place where the machine has
    a steep law. A place is not a coordinate: friction in a strut between two masses turns over
    where their difference does, and not where either mass does."""
    elements = machine.model.elements
    sharp = [i for i, element in enumerate(elements) if KINDS[element.kind].steep]
    if not sharp:
        return np.zeros(motion.t.size - 1, bool)
    rates, sd = (part[..., sharp] for part in rates_of(machine, motion))
    known = ~np.isnan(rates).all(axis=0)
    if not known.all():  # at a point the place has no one direction
        rates = np.concatenate([rates[:, known], motion.v], axis=1)
        sd = np.concatenate([sd[known], motion.v_sd])
    return reversals(rates, sd)


def reversals(rates: Array, sd: Array | float = 0.0) -> NDArray[np.bool_]:
    """Intervals between samples (N − 1,) near a reversal or a rest of one of ``rates`` (N, places),
    SI.

    There dry friction turns over or holds, and the integration needs finer steps: where a rate
    changes sign, three intervals to either side, and where it is below 2 % of its largest, or may
    be none with a deviation ``sd`` (places,).
    """
    size = np.abs(rates).max(axis=0)
    slow = (np.abs(rates) < np.maximum(SLOW_SHARE * size, STILL * sd)).any(axis=1)
    turns = (np.sign(rates[1:]) * np.sign(rates[:-1]) <= 0).any(axis=1) | slow[1:] | slow[:-1]
    near = np.convolve(turns.astype(float), np.ones(7), mode="same") > 0
    return near[: turns.size]


@dataclass(frozen=True, slots=True)
class Reduced:
    """Whitened windows with the initial states projected out: ``count`` (W,) samples that are
    there, less the initial states; ``held`` (W,); ``grams`` (W, F + 1, F + 1) of [columns,
    residual], where the residual is dimensionless and a column is per SI unit of its number."""

    count: NDArray[np.int64]
    held: NDArray[np.bool_]
    grams: Array


def reduce(item: Cut, residual: Array, by_start: Array, columns: Array, sd: Array) -> Reduced:
    """Project the initial states out of residual (W, L, m) and columns (W, L, m, F) of windows.

    ``by_start`` (W, L, m, X), noise ``sd`` (m,) of the sensors in SI. Missing residuals are NaN.
    """
    joined, count = _projected(item, residual, by_start, columns, sd)
    return Reduced(count, item.held, joined.transpose(0, 2, 1) @ joined)


def summed(
    item: Cut, residual: Array, by_start: Array, columns: Array, sd: Array
) -> tuple[Array, Array]:
    """The sums (F + 1, F + 1) of what :func:`reduce` gives for each window, in units of the noise,
    of those that are fitted and of those that are held: of many columns the windows one by one take
    far more memory than the columns themselves. Arguments as there, in SI."""
    joined, _ = _projected(item, residual, by_start, columns, sd)
    parts = (joined[mine].reshape(-1, joined.shape[2]) for mine in (~item.held, item.held))
    fitted, held = (np.asarray(part.T @ part) for part in parts)
    return fitted, held


def _projected(
    item: Cut, residual: Array, by_start: Array, columns: Array, sd: Array
) -> tuple[Array, NDArray[np.int64]]:
    """White columns and residual (W, L·m, F + 1) without what initial states do, and how many
    samples are left (W,)."""
    windows = residual.shape[0]
    seen = np.isfinite(residual)
    flat = np.where(seen, residual, 0.0)[..., None]
    joined = item.white(np.concatenate([columns, flat], axis=3), sd, seen)
    starts = item.white(by_start, sd, seen)
    scale = np.linalg.norm(starts, axis=1, keepdims=True)
    basis, triangle = np.linalg.qr(starts / np.where(scale > 0, scale, 1.0))
    pivots = np.abs(np.diagonal(triangle, axis1=1, axis2=2))
    basis = basis * (pivots > 1e-9)[:, None, :]
    joined -= basis @ (basis.transpose(0, 2, 1) @ joined)
    return joined, seen.reshape(windows, -1).sum(axis=1) - (pivots > 1e-9).sum(axis=1)


def merge(
    parts: Sequence[Reduced],
) -> tuple[Array, NDArray[np.int64], NDArray[np.bool_]]:
    """Grams (ΣW, F + 1, F + 1) in the units of :class:`Reduced`, counts and held flags (ΣW,) of
    several recordings."""
    return (
        np.concatenate([part.grams for part in parts]),
        np.concatenate([part.count for part in parts]),
        np.concatenate([part.held for part in parts]),
    )


def correlation_time(residuals: Sequence[Array], m: int) -> float:
    """Integrated autocorrelation c ≥ 1 of whitened residuals [(W, L·m), …], in samples.

    c = 1 + 2 Σ ρ_k, summed to the first lag where ρ drops below 0.05 (a plain initial-sequence
    estimate: Geyer, Statistical Science 7, 1992); the largest over the sensors.
    """
    worst = 1.0
    for sensor in range(m):
        series = [part.reshape(part.shape[0], -1, m)[:, :, sensor] for part in residuals]
        longest = min(part.shape[1] for part in series)
        power = sum(float(np.sum(part**2)) for part in series)
        if power == 0:
            continue
        total = 1.0
        for lag in range(1, longest):
            cross = sum(float(np.sum(part[:, lag:] * part[:, :-lag])) for part in series)
            rho = cross / power
            if rho < 0.05:
                break
            total += 2 * rho
        worst = max(worst, total)
    return worst

"""What adequacy is judged on: the recordings cut at gaps, with candidates, noise and scales."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.correction.search.preparing import SAMPLES_MOST, Prepared
from symhyb.correction.search.setting import Setting
from symhyb.data.recording import Recording
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import track
from symhyb.discrepancy.places.hypotheses import Hypothesis, Library
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.recorded.windows import SAMPLES_LEAST, Cut, stretches
from symhyb.discrepancy.results import Change
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel

FORCE_FIRST = 0.1  # of what moves a coordinate: the unknown force at first
FORCE_AGAIN = 0.01  # the same, where one is looked for again
COLOUR_FIRST = 0.5  # of the white noise
MEMORY_FIRST = 2.0  # samples: of an unknown force that forgets at once
SLOW_FIRST = 1 / 3  # of a period of the motion: correlation times at first


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Recorded:
    """The recordings of a decision, SI: every stretch without a gap (``items``, one window each)
    with the number of its ``recording``, force candidates lowered (``library``), ``parametric``
    candidates (numbers of the model and of its channels), the model with all of these free, the
    noise ``sd`` (m,) that smoothing measured, the ``scale`` (n,) of the force that moves each
    coordinate, the size of every probe's force there (n, C; ``probe_sizes``), the shortest period
    of the motion, and the relative ``accuracy`` of fitted values that the numerics allow.

    Two are the same if they are one object: what is computed from it is kept as long as it is.
    """

    library: Library
    parametric: tuple[Hypothesis, ...]
    windows: WindowModel
    items: tuple[Cut, ...]
    recording: tuple[int, ...]
    sd: Array
    scale: Array
    probe_sizes: Array
    period_s: float
    gain_floor: float
    accuracy: float

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """All candidates."""
        return (*self.library.hypotheses, *self.parametric)

    @property
    def scale_or_inf(self) -> Array:
        """The scale (n, 1) of the force at each coordinate, infinite where none moves it."""
        return np.where(self.scale > 0, self.scale, np.inf)[:, None]

    @property
    def shown(self) -> Array:
        """The RMS (m,) of what each sensor shows about its mean, SI; infinite where nothing."""
        y = np.concatenate([item.block.y[0] for item in self.items])
        seen = np.isfinite(y).any(axis=0)
        size = np.nanstd(np.where(seen, y, 0.0), axis=0)
        return np.where(size > 0, size, np.inf)

    @property
    def each(self) -> tuple[Recording, ...]:
        """The recordings."""
        return tuple(
            self.items[self.recording.index(which)].source[0]
            for which in range(1 + max(self.recording))
        )

    @property
    def step_s(self) -> float:
        """The time between two samples, s."""
        return float(np.median(np.diff(self.items[0].block.t, axis=1)))

    def first_noise(self, slow: bool = False) -> NoiseModel:
        """Where the noise model begins: the unknown force has no memory, or is ``slow``."""
        colour_s = SLOW_FIRST * self.period_s
        return NoiseModel(
            FORCE_FIRST * self.scale,
            colour_s if slow else MEMORY_FIRST * self.step_s,
            self.sd.copy(),
            COLOUR_FIRST * self.sd,
            colour_s,
        )

    def revived(self, noise: NoiseModel) -> NoiseModel:
        """The noise model with every size that is 0 begun anew, small."""
        acts, tinted = bool(np.any(noise.force > 0)), noise.coloured
        return NoiseModel(
            np.where(noise.force > 0, noise.force, FORCE_AGAIN * self.scale),
            noise.memory_s if acts else MEMORY_FIRST * self.step_s,
            noise.white,
            np.where(noise.colour > 0, noise.colour, COLOUR_FIRST * noise.white),
            noise.colour_s if tinted else SLOW_FIRST * self.period_s,
        )


def recorded(prepared: Prepared, setting: Setting) -> Recorded | None:
    """The recordings of a decision, cut at gaps, where the mismatch acts; of long ones the first
    part of every stretch. None where no stretch is long enough."""
    found = [
        (part, which)
        for which, run in enumerate(_runs(prepared, setting))
        for item in stretches(run.recording, prepared.machine, run.motion, run.steps, run.fine)
        if (part := _acting(item, setting.change)).rows.size >= SAMPLES_LEAST
    ]
    if not found:
        return None
    known = sorted({which for _, which in found})
    share = SAMPLES_MOST / sum(item.rows.size for item, _ in found)
    items = tuple(
        item if share >= 1 else item.between(0, max(int(share * item.rows.size), SAMPLES_LEAST))
        for item, _ in found
    )
    return Recorded(
        setting.library,
        setting.parametric,
        setting.windows,
        items,
        tuple(known.index(which) for _, which in found),
        setting.sd,
        force_scale(WindowModel(prepared.machine), items),
        _probe_sizes(setting.library, items),
        prepared.shortest,
        setting.gain_floor,
        setting.accuracy,
    )


def _acting(item: Cut, change: Change | None) -> Cut:
    """The part of a stretch in which a mismatch that begins or ends acts."""
    if change is None or item.source[0].name != change.recording:
        return item
    at = int(np.searchsorted(item.block.t[0], change.time_s))
    return item.between(at, item.rows.size) if change.kind == "begins" else item.between(0, at)


def _runs(prepared: Prepared, setting: Setting) -> list[Run]:
    """The runs that the decision was made on."""
    used = {id(item.source[0]) for item in setting.stages[-1].cuts}
    return [run for run in prepared.runs if id(run.recording) in used]


def _probe_sizes(library: Library, items: Sequence[Cut]) -> Array:
    """RMS (n, C) of the force of every probe at every coordinate along the measured motion, SI."""
    squares, count = 0.0, 0
    for item in items:
        forces = library.forces(item.course(library.machine))[item.rows[0]]
        squares = squares + np.sum(forces**2, axis=0)
        count += len(forces)
    return np.asarray(np.sqrt(squares / max(count, 1)))


def force_scale(model: WindowModel, items: Sequence[Cut]) -> Array:
    """The force (n,) that moves each coordinate, SI: the RMS of the one whose impulses would make
    the measured changes of speed; where no state answers, what the sensors show of it."""
    machine = model.machine
    squares, counts = np.zeros(machine.n), np.zeros(machine.n)
    for item in items:
        one = track(model, item, item.states[0], machine.values)
        linear = one.linear
        push = (linear.left + linear.right)[0]
        change = np.diff(one.x, axis=0)
        for i in range(machine.n):
            power = np.sum(push[:, :, i] ** 2, axis=1)
            if power.size and power.max() > 0:
                spread = change.std(axis=0) + 1e-300
                seen = push[:, :, i] / spread
                j = int(np.argmax(np.mean(seen**2, axis=0)))
                squares[i] += float(np.sum((change[:, j] / _typical(push[:, j, i])) ** 2))
                counts[i] += len(change)
            elif np.any(linear.by_force[0][:, :, i]):
                direct = linear.by_force[0][:, :, i]
                j = int(np.argmax(np.mean(direct**2, axis=0)))
                shown = one.item_y[:, j] / _typical(direct[:, j])
                squares[i] += float(np.nansum((shown - np.nanmean(shown)) ** 2))
                counts[i] += int(np.isfinite(shown).sum())
    return np.asarray(np.sqrt(squares / np.maximum(counts, 1)))


def _typical(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) or 1e-300

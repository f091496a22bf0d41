"""A recording made ready for windows: its motion, the noise of its sensors, fine enough steps."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.discrepancy.recorded.windows import Cut, lay
from symhyb.judgement import OUTSTANDING, PERIODS_LEAST, SAMPLES_TELL
from symhyb.model.expression import parse_expression
from symhyb.model.types import Element, On
from symhyb.numeric.kernels.buffers import Array, mean_of_seen
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.windows import WindowModel

FINE_LEAST, FINE_MOST = 8, 64  # steps near a reversal, for one elsewhere
COORDINATES_FEW = 3  # free coordinates of a machine that a few causes explain
STEPS_MOST = 16
BEND_SHARE = 2e-3  # of the size of a smooth input, that lines within steps may cut: the accuracy of
# the fitted values
WINDOWS_MOST = 300  # evenly spread, that tell how fine steps must be
WINDOWS_WORSE = 0.1  # share of windows in which the integration may err more
PROBE_TRANSITION = 1e-3  # of the largest speed
STEP_SHARE = 0.1  # of the noise: the error of integration that is allowed
SD_FLOOR = 1e-6  # of a sensor's range: the accuracy of the integration
RANGE_SHARE = 2e-5  # of a sensor's range: an error of integration that is always allowed


@dataclass(frozen=True, slots=True)
class Run:
    """One recording with its smoothed motion, the noise ``sd`` (m,) of its sensors, SI, and the
    integration ``steps`` between two samples, each ``fine`` times finer near a reversal; ``floor``
    is the mean square by which repeated runs differ beyond their noise, in units of ``sd``²."""

    recording: Recording
    motion: Motion
    sd: Array
    steps: int = 1
    fine: int = FINE_LEAST
    floor: float = 0.0


def cut_into_windows(run: Run, machine: Machine, length_s: float) -> Cut | None:
    """Windows of one run, ``length_s`` in s, to be adapted to a machine."""
    parts = np.full(run.recording.t.size - 1, run.steps)
    cut = lay(run.recording, machine, run.motion, length_s, parts)
    return cut if cut is None else replace(cut, floor=run.floor, steps=run.steps, fine=run.fine)


def cut_within(run: Run, machine: Machine, length_s: float) -> Cut | None:
    """The same; a run shorter than ``length_s`` is one window, for all of it counts."""
    t = run.recording.t
    return cut_into_windows(
        run, machine, min(length_s, float(np.median(np.diff(t))) * (t.size - 1))
    )


def noise_sd(runs: Sequence[Run], machine: Machine) -> Array:
    """Noise (m,) by sensor over all runs, SI; 1 for a sensor without samples."""
    sd = np.ones(len(machine.model.sensors))
    for j, sensor in enumerate(machine.model.sensors):
        seen = [run for run in runs if np.isfinite(run.motion.sd[j])]
        if not seen:
            continue
        signals = [run.recording.sensors[sensor.name] for run in seen]
        reach = max(float(np.nanmax(signal) - np.nanmin(signal)) for signal in signals)
        spread = float(np.sqrt(np.mean([run.motion.sd[j] ** 2 for run in seen])))
        sd[j] = max(spread, SD_FLOOR * reach) or 1.0  # a channel that stands still weighs 1
    return sd


def too_poor(runs: Sequence[Run], sensors: Sequence[str]) -> str:
    """Why these runs cannot show that nothing is missing, as half a sentence; empty if they can.

    ``sensors`` are the names of the model's sensors, in their order.
    """
    signals = []
    for run in runs:
        for sensor, noise in zip(sensors, run.motion.sd, strict=True):
            values = run.recording.sensors.get(sensor)
            if values is not None and np.isfinite(noise):
                signals.append(float(np.nanstd(values)) > OUTSTANDING * noise)
    if not any(signals):
        return "no channel moves by more than a few times its noise"
    samples = sum(run.recording.t.size for run in runs)
    if samples < SAMPLES_TELL:
        return f"they have {samples} samples, less than {SAMPLES_TELL}"
    longest = max(float(run.motion.periods().max()) for run in runs)
    total = sum(run.recording.duration for run in runs)
    if total < PERIODS_LEAST * longest:
        return f"they last {total:.3g} s, less than {PERIODS_LEAST:g} periods of the motion"
    return ""


def has_many(machine: Machine) -> bool:
    """Whether more coordinates are free than a few causes explain."""
    return len(machine.free) > COORDINATES_FEW


def with_noise(runs: Sequence[Run], sd: Array, model: WindowModel) -> tuple[Run, ...]:
    """The runs with this noise (m,), SI, and as many integration steps as it asks for. How fine
    they are near reversals is left open for a machine of many coordinates, where
    :func:`stepped_for` says it once it is known what acts."""
    known = [replace(run, sd=sd) for run in runs]
    stepped = [replace(run, steps=_steps_needed(model, run)) for run in known]
    if has_many(model.machine):
        return tuple(stepped)
    return tuple(replace(run, fine=fine_needed(model.machine, run)) for run in stepped)


def _steps_needed(model: WindowModel, run: Run) -> int:
    """Steps between samples at which twice as many change the outputs by less than a tenth of the
    noise in nine of ten windows of one period along the measured motion; from where the model as
    given has run away from the recording its error says nothing, and that until then counts as it
    grows over the whole window."""
    length = float(run.motion.periods().min())
    samples = run.recording.t.size - 1

    def cut(steps: int) -> Cut | None:
        parts = steps * np.ones(samples, np.int64)
        return lay(run.recording, model.machine, run.motion, length, parts)

    return _enough(model, run, cut, _for_bends(model, run), STEPS_MOST)


def _for_bends(model: WindowModel, run: Run) -> int:
    """Steps between samples that follow the bends of smooth inputs: noise does not excuse a line
    there, which biases every sample alike. The error of a chord, |Δ²u|/8, falls with their
    square."""
    steps = 1
    for item in model.machine.model.inputs:
        values = run.recording.inputs[item.name]
        if item.between == "smooth" and (size := float(np.std(values))) > 0:
            sag = float(np.sqrt(np.mean(np.diff(values, n=2) ** 2))) / 8 / size
            while sag / steps**2 > BEND_SHARE and steps < STEPS_MOST:
                steps *= 2
    return steps


def fine_needed(machine: Machine, run: Run) -> int:
    """How much finer near reversals, for as much dry friction as the force that the model
    lacks could hold; where every interval has many steps already, fewer times as many are tried."""
    first = max(FINE_LEAST // run.steps, 1)
    missing = discrepancy(machine, course_of(run.recording, machine, run.motion), machine.values)
    size = np.sqrt(np.mean(missing**2, axis=0))
    speed = np.abs(run.motion.v).max(axis=0)
    frictions = []
    for i in machine.free:
        if size[i] > 0 and speed[i] > 0:
            name, place = f"fine{i}", On(machine.model.coordinates[i].name)
            level = parse_expression(float(size[i] / 2))
            width = parse_expression(float(PROBE_TRANSITION * speed[i]))
            entries = (("coulomb", level), ("transition", width))
            frictions.append(Element(name, "friction", place, entries))
    if not frictions:
        return first
    model = machine.model
    steep = build(replace(model, elements=(*model.elements, *frictions)), keep=False)
    length = float(run.motion.periods().min())

    def cut(fine: int) -> Cut | None:
        found = cut_into_windows(replace(run, fine=fine), steep, length)
        return None if found is None else found.suited(steep)

    return _enough(WindowModel(steep), run, cut, first, FINE_MOST)


def stepped_for(machine: Machine, run: Run, length_s: float) -> Run:
    """The run with as many steps between samples, and as fine ones near reversals, as a machine
    needs whose laws are those that are searched for: the error in all windows of ``length_s``
    together may be a tenth of what it leaves of the recording, if that is more than noise. A joint
    that friction holds lets go at one time or another by little; no steps are so fine that this is
    the same in every window. There are no more steps than for the model as given, which may fall
    where the machine is held."""

    def cut(steps: int, fine: int) -> Cut | None:
        found = cut_within(replace(run, steps=steps, fine=fine), machine, length_s)
        return None if found is None else found.suited(machine)

    model, first = WindowModel(machine), cut(run.steps, FINE_LEAST)
    if first is None:
        return run
    with np.errstate(over="ignore", invalid="ignore"):
        _, y = model.simulate(first.block, first.start, machine.values)
        left = np.sqrt(mean_of_seen((y - first.block.y) ** 2, axis=1))
    louder = replace(run, sd=np.fmax(run.sd, _together(np.fmin(left, _reach(run, machine)))))
    steps = run.steps
    if (least := _for_bends(model, run)) < steps:
        steps = _enough(model, louder, lambda n: cut(n, FINE_LEAST), least, steps, _in_all)
    fine = _enough(model, louder, lambda n: cut(steps, n), 1, FINE_MOST, _in_all)
    return replace(run, steps=steps, fine=fine)


def _together(errors: Array) -> Array:
    """The RMS (m,) over all windows of RMS ``errors`` (W, m) of each."""
    return np.asarray(np.sqrt(np.mean(errors**2, axis=0)))


def _in_all(error: Array) -> bool:
    """Whether an ``error`` (W, m) over what is allowed is none in all windows together."""
    return bool((_together(error) <= 1).all())


def _in_most(error: Array) -> bool:
    """Whether an ``error`` (W, m) over what is allowed is none in most windows."""
    return float(np.mean((error > 1).any(axis=1))) <= WINDOWS_WORSE


def _reach(run: Run, machine: Machine) -> Array:
    """The range (m,) of each sensor, SI."""
    y = [run.recording.sensors.get(s.name) for s in machine.model.sensors]
    return np.array([0.0 if c is None else np.nanmax(c) - np.nanmin(c) for c in y])


def _enough(
    model: WindowModel,
    run: Run,
    cut_with: Callable[[int], Cut | None],
    first: int,
    most: int,
    small: Callable[[Array], bool] = _in_most,
) -> int:
    """The smallest of ``first``, 2·``first`` … ``most`` steps that the noise does not distinguish
    from twice as many: by which the outputs of windows differ is ``small`` over what is allowed."""
    values, reach = model.machine.values, _reach(run, model.machine)
    allowed = np.maximum(STEP_SHARE * run.sd, RANGE_SHARE * reach)
    coarse: Array | None = None
    steps = first
    while steps <= 2 * most:
        cuts = cut_with(steps)
        if cuts is None:
            return first
        if len(cuts.start) > WINDOWS_MOST:
            spread = np.linspace(0, len(cuts.start) - 1, WINDOWS_MOST)
            cuts = cuts.chosen(spread.astype(np.int64))
        with np.errstate(over="ignore", invalid="ignore"):
            _, fine = model.simulate(cuts.block, cuts.start, values)
            if coarse is not None:
                near = _near(fine, cuts.block.y, reach)
                error = _grown(fine - coarse, near)
                if small(error / allowed):
                    return steps // 2
        coarse, steps = fine, 2 * steps
    return most


def _grown(error: Array, near: NDArray[np.bool_]) -> Array:
    """The RMS (W, m) of an ``error`` (W, L, m) over whole windows, of which the ``near`` samples
    (W, L, 1) show how it grows with time; 0 where these are none but the first."""
    shown = near.sum(axis=1)
    count = np.maximum(shown, 1)
    rms = np.sqrt(np.sum(np.where(near, error, 0.0) ** 2, axis=1) / count)
    return np.asarray(np.where(shown > 1, rms * near.shape[1] / count, 0.0))


def _near(simulated: Array, measured: Array, reach: Array) -> NDArray[np.bool_]:
    """The samples (W, L, 1) until which no output (W, L, m) has left what was measured by more
    than ``reach`` (m,), the range of its sensor, SI."""
    gone = (~(np.abs(simulated - measured) <= reach) & np.isfinite(measured)).any(axis=2)
    return ~np.maximum.accumulate(gone, axis=1)[..., None]

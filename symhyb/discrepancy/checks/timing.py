"""Do the channels of a recording keep the same time: sample rates, and delays between them.

A sensor is held against the motion that all other sensors show, an input against the force that
the recorded motion asks for: the delay is that under which it is made best of this force and of any
inertia, damping, stiffness, drag, dry friction, a constant and other inputs, so that most physics a
model lacks is not mistaken for a delay; where more than noise is left, none is reported. Under a
single sine these can make any delay, and none is reported either.
Sizes: N samples, n coordinates, R rows.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.recorded.motion import Motion, motion_of, unplaced
from symhyb.discrepancy.recorded.residual import discrepancy, force_band
from symhyb.discrepancy.recorded.signals import acting, measured
from symhyb.discrepancy.recorded.windows import correlation_time
from symhyb.discrepancy.words.wording import number_text, percent_text, small_text
from symhyb.errors import InputError
from symhyb.judgement import DELAY_LEAST, FEW, NOISE_FACTOR, NOTABLE, SMALL, SURE
from symhyb.numeric.kernels.buffers import Array, resampled
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.inner import inner_along
from symhyb.numeric.lowered.machine import Machine

GRID = 41  # delays that are tried first
REACH = 0.25  # of the shortest period: the longest delay that is looked for, either way
REACH_MOST = 0.1  # of the recording
ROUNDS = 4
SENSORS_MOST = 4  # held against the others one by one: each costs an estimate of the motion
SHOWN = "nothing shows it closely enough to tell a delay"
FEIGNED = "but the model lacks more than that, which may feign it"
UNTOLD = "this motion tells no delay"


@dataclass(frozen=True, slots=True)
class Late:
    """By how much a ``channel`` shows or acts later than ``against`` says, s, one ``sd``; None
    where the recording cannot show it; ``reason`` says why it is not ``claimed``."""

    channel: str
    against: str
    delay: float | None
    sd: float
    claimed: bool
    reason: str = ""

    @property
    def sentence(self) -> str:
        """The delay in words."""
        if self.delay is None:
            return f"{self.channel} against {self.against}: {self.reason}"
        amount = small_text(abs(self.delay), "s", self.sd)
        if self.reason:
            way = "late" if self.delay > 0 else "early"
            return f"{self.channel} against {self.against}: {amount} {way} fits best, {self.reason}"
        if not self.claimed:
            return f"{self.channel} against {self.against}: no delay ({amount})"
        return f"{self.channel} is {amount} {'late' if self.delay > 0 else 'early'} against " + (
            self.against
        )


@dataclass(frozen=True, slots=True)
class Timing:
    """``rate`` in Hz and ``jitter`` (the spread of the steps over their median) of a recording,
    ``held`` by channel: changes only every so many samples; ``missing`` the share of samples that
    a sensor lacks; ``late`` the delays."""

    rate: float
    jitter: float
    held: dict[str, int]
    missing: dict[str, float]
    late: tuple[Late, ...]

    @property
    def sentence(self) -> str:
        """Sample rates in words."""
        said = [f"{number_text(self.rate)} Hz"]
        if self.jitter > NOTABLE:
            said.append(f"steps spread by {percent_text(self.jitter)} of one")
        said += [f"{name} changes only every {count} samples" for name, count in self.held.items()]
        said += [
            f"{name} lacks {percent_text(share)} of its samples"
            for name, share in self.missing.items()
        ]
        return ", ".join(said)


def timing_of(
    machine: Machine, recording: Recording, thin: Recording, motion: Motion, course: Course
) -> Timing:
    """Rates of one recording, and delays in it from its ``thin`` form (itself, if it is short) with
    its motion and course."""
    steps = np.diff(recording.t)
    channels = {**recording.inputs, **recording.sensors}
    held = {name: hold_of(values) for name, values in channels.items()}
    gaps = {name: float(np.mean(~np.isfinite(one))) for name, one in recording.sensors.items()}
    late = [*_inputs(machine, motion, course), *_sensors(machine, thin, motion)]
    middle = float(np.median(steps))
    return Timing(
        1 / middle,
        float(np.std(steps)) / middle,
        {name: count for name, count in held.items() if count > 1},
        {name: share for name, share in gaps.items() if share > 0},
        tuple(late),
    )


def hold_of(values: Array) -> int:
    """Every how many samples (N,) of any unit a channel changes: 1 unless it is held in
    between, as by a logger that is faster than the channel."""
    changes = 1 + np.flatnonzero(np.diff(values[np.isfinite(values)]) != 0)
    if changes.size < FEW:
        return 1
    return int(np.gcd.reduce(np.diff(changes)))


def _inputs(machine: Machine, motion: Motion, course: Course) -> Iterator[Late]:
    """Every input against the force that the motion asks for."""
    model, free = machine.model, list(machine.free)
    if machine.input_matrix is None or motion.blind or not free:
        return
    c, against = course, "the recorded motion"
    (slopes,) = along(machine.input_matrix, (c.q, c.v, c.t, c.values(machine)), (3,), c.t.size)
    by = slopes.reshape(c.t.size, len(model.inputs), machine.n)[:, :, free]  # (N, k, free)
    inside = _inside(c.t, motion)
    ordinary = [_orthonormal(_ordinary(c, free, i)[inside]) for i in free]
    lacking = discrepancy(machine, c, machine.values)[:, free]
    band = force_band(machine, motion, c)[:, free]
    for j, item in enumerate(model.recorded_inputs):
        if float(np.ptp(c.u[:, j])) == 0 or not np.abs(by[:, j]).max(initial=0.0) > 0:
            continue
        target = lacking + by[:, j] * c.u[:, j : j + 1]
        size = np.sqrt(np.mean(target**2, axis=0))  # newtons beside newton metres
        push = by / np.where(size > 0, size, 1.0)

        def pushing(delay: float, j: int = j, push: Array = push) -> Array:
            shifted = resampled(c.t, c.u[:, j], c.t - delay)
            return np.asarray(push[:, j] * shifted[:, None])

        target = target / np.where(size > 0, size, 1.0)
        others = [push[:, i] * c.u[:, i : i + 1] for i in range(len(model.inputs)) if i != j]
        noise = float(np.sqrt(np.mean((band / np.where(size > 0, size, 1.0)) ** 2)))
        yield _late(item.name, against, c.t, [target, *others], pushing, ordinary, motion, noise)


def _ordinary(course: Course, free: list[int], where: int) -> Array:
    """What inertia, damping, drag and stiffness by each free coordinate, dry friction and a
    constant could make of the force on one of them: columns (N, 5 free + 2)."""
    columns = []
    for i in free:
        q, v, a = course.q[:, i], course.v[:, i], course.a[:, i]
        columns += [q, v, a, v * np.abs(v), q**3]
    speed = course.v[:, where]
    return np.column_stack([*columns, np.sign(speed), np.ones_like(speed)])


def _sensors(machine: Machine, recording: Recording, motion: Motion) -> Iterator[Late]:
    """Every sensor against the motion that the others show."""
    sensors = machine.model.sensors
    columns = measured(recording, machine).T
    if len(recording.sensors) < 2 or motion.blind:
        return
    for sensor, y in list(zip(sensors, columns, strict=True))[:SENSORS_MOST]:
        if sensor.name not in recording.sensors or not np.ptp(y[np.isfinite(y)]) > 0:
            continue
        shown = _shown(machine, sensor.name, recording)
        if shown is None:
            continue
        expected, seen = shown, np.isfinite(y)
        filled = np.interp(recording.t, recording.t[seen], y[seen])[:, None]

        def later(delay: float, expected: Array = expected) -> Array:
            return resampled(recording.t, expected, recording.t - delay)[:, None]

        plain = [_orthonormal(np.ones((int(_inside(recording.t, motion).sum()), 1)))]
        yield _late(sensor.name, "the other sensors", recording.t, [filled], later, plain, motion)


def _shown(machine: Machine, name: str, recording: Recording) -> Array | None:
    """What a sensor (N,) should show, SI, by the motion that all others show; None where they do
    not show all of it."""
    column = [sensor.name for sensor in machine.model.sensors].index(name)
    others = {key: one for key, one in recording.sensors.items() if key != name}
    alone = replace(recording, sensors=others)
    try:
        if unplaced(alone, machine):
            return None
        motion = motion_of(alone, machine)
    except InputError:
        return None
    u = acting(recording, machine)
    moved = motion.q, motion.v, motion.a
    z = inner_along(machine, recording.t, moved, u, machine.values)
    given = motion.q, motion.v, motion.a, z, u, recording.t, machine.values
    (y,) = along(machine.outputs, given, (6,), recording.t.size)
    return np.asarray(y.reshape(recording.t.size, -1)[:, column])


def _late(
    channel: str,
    against: str,
    t: Array,
    columns: list[Array],
    signal: Callable[[float], Array],
    bases: list[Array],
    motion: Motion,
    noise: float = np.inf,
) -> Late:
    """The delay by which a ``signal`` (N, r) is best made of ``columns``, each (N, r), SI, and of
    what each of its r rows may hold besides, an orthonormal basis (I, k) of the samples that
    are :func:`_inside`: the least that they leave of it, first on a grid, then by Newton.
    Where they leave more than ``noise`` explains, physics that is missing may feign the delay."""
    reach, inside = _reach(t, motion), _inside(t, motion)

    def without_rows(values: Array) -> Array:
        parts = zip(values[inside].T, bases, strict=True)
        return np.column_stack([one - basis @ (basis.T @ one) for one, basis in parts]).reshape(-1)

    basis = _orthonormal(np.column_stack([without_rows(one) for one in columns]))
    taken = basis.shape[1] + sum(one.shape[1] for one in bases)
    step = float(np.median(np.diff(t)))

    def change(delay: float) -> Array:
        return np.asarray((signal(delay + step) - signal(delay - step)) / (2 * step))

    def beyond(values: Array) -> Array:
        flat = without_rows(values)
        return np.asarray(flat - basis @ (basis.T @ flat))

    def misses(delay: float) -> float:
        return float(np.sum(beyond(signal(delay)) ** 2))

    delay = float(min(np.linspace(-reach, reach, GRID), key=misses))
    for _ in range(ROUNDS):
        left, slope = beyond(signal(delay)), beyond(change(delay))
        moved = float(slope @ left) / max(float(slope @ slope), 1e-300)
        delay = float(np.clip(delay - moved, -reach, reach))
    left, slope = beyond(signal(delay)), beyond(change(delay))
    seen = float(slope @ slope)
    if seen <= SMALL * float(np.sum(change(delay)[inside] ** 2)):
        return Late(channel, against, None, np.inf, False, UNTOLD)
    together = correlation_time([left.reshape(1, -1)], len(bases))
    variance = float(left @ left) / max(left.size - taken - 1, 1)
    sd = float(np.sqrt(variance * together / seen))
    if sd > reach:
        said = f"{UNTOLD} (± {small_text(sd, 's', digits=2)})"
        return Late(channel, against, None, sd, False, said)
    there = signal(delay)[inside]
    size = float(np.sum((there - there.mean(axis=0)) ** 2))
    rough = np.isfinite(noise) and there.size * noise**2 > SMALL * size
    if rough or float(left @ left) > SMALL * size:
        return Late(channel, against, None, sd, False, SHOWN)
    if abs(delay) >= reach * (1 - 1e-6):
        return Late(channel, against, None, sd, False, "no delay within reach fits")
    if float(np.sqrt(np.mean(left**2))) > NOISE_FACTOR * noise:
        return Late(channel, against, delay, sd, False, FEIGNED)
    claimed = abs(delay) > SURE * sd and abs(delay) > DELAY_LEAST * step
    return Late(channel, against, delay, sd, claimed)


def _reach(t: Array, motion: Motion) -> float:
    """The longest delay, s, that is looked for in signals at ``t`` (N,)."""
    return min(REACH * float(motion.periods().min()), REACH_MOST * float(t[-1] - t[0]))


def _inside(t: Array, motion: Motion) -> NDArray[np.bool_]:
    """The samples (N,) that stay within the recording however late a signal may be."""
    reach = _reach(t, motion)
    return np.asarray((t >= t[0] + reach) & (t <= t[-1] - reach))


def _orthonormal(columns: Array) -> Array:
    """Directions (N, k) of length 1 that span the columns that are not zero."""
    sizes = np.sqrt(np.mean(columns**2, axis=0))
    basis, *_ = np.linalg.svd(columns[:, sizes > 0] / sizes[sizes > 0], full_matrices=False)
    return np.asarray(basis)

"""What every test engineer looks at first: one recording held against its model, check by check.

Standstill, modes, channels' time, frequency responses and the energy balance; each is a value or a
reason why it cannot be had here. Nothing here decides a diagnosis.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from symhyb.data.cleaning import still
from symhyb.data.recording import Recording
from symhyb.data.thin import coarsest, thinned
from symhyb.discrepancy.checks.balance import Balance, balance_of
from symhyb.discrepancy.checks.modes import (
    Mode,
    modes_at,
    rest_position,
    start_of,
    steady_slopes,
    without_dry_friction,
)
from symhyb.discrepancy.checks.repeats import repeated, reported_repeats
from symhyb.discrepancy.checks.response import Response, driven, response_of
from symhyb.discrepancy.checks.standstill import Standstill, standstill_of
from symhyb.discrepancy.checks.timing import Timing, timing_of
from symhyb.discrepancy.recorded.course import Course, course_of
from symhyb.discrepancy.recorded.motion import Motion, motion_of
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.recorded.signals import acting, driving, measured
from symhyb.discrepancy.results import Repeats
from symhyb.discrepancy.words.wording import joined
from symhyb.judgement import RUNAWAY
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array, on_lines
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.known import machine_with
from symhyb.numeric.lowered.linear import depends_on_time
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.between import held_columns
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import LEFT, Scenario

SAMPLES_MOST = 10_000  # of a recording: longer ones are averaged in blocks, or cut
Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class Swing:
    """The modes of a model about a place by coordinate, in its unit; ``rests`` where it is a place
    of rest, else where simulations start. ``dry`` names the dry friction that was left out."""

    model: str
    place: Mapping[str, float]
    rests: bool
    modes: tuple[Mode, ...]
    dry: tuple[str, ...] = ()

    @property
    def sentences(self) -> tuple[str, ...]:
        """One sentence a mode, the first with what they are of."""
        about = "its place of rest" if self.rests else "its start, which is no place of rest"
        left = f", without {joined(self.dry)}" if self.dry else ""
        head = f"{self.model}, about {about}{left}"
        return tuple(f"{head}: {mode.sentence}" for mode in self.modes)


@dataclass(frozen=True, slots=True)
class FirstChecks:
    """All that was checked of one ``recording``; ``skipped`` gives the reason by check, ``away``
    says where the model's own free run left what was recorded."""

    recording: str
    timing: Timing
    standstill: Standstill | None
    swings: tuple[Swing, ...]
    responses: tuple[Response, ...]
    balance: Balance | None
    skipped: Mapping[str, str] = field(default_factory=dict)
    away: str = ""

    @property
    def said(self) -> tuple[tuple[str, str], ...]:
        """Each check by name with a sentence, in the order in which they are looked at."""
        return tuple(self._said())

    def _said(self) -> Iterator[tuple[str, str]]:
        parts: dict[str, list[str]] = {
            "sampling": [self.timing.sentence],
            "delays": [late.sentence for late in self.timing.late],
            "rest": [self.standstill.sentence] if self.standstill else [],
            "modes": [line for swing in self.swings for line in swing.sentences],
            "response": [
                *(response.sentence for response in self.responses),
                *([self.away] if self.responses and self.away else []),
            ],
            "energy": [self.balance.sentence] if self.balance else [],
        }
        for name, sentences in parts.items():
            for sentence in sentences:
                yield name, sentence
            if name in self.skipped:
                yield name, f"not checked: {self.skipped[name]}"


def first_checks(
    machine: Machine,
    recording: Recording,
    motion: Motion | None = None,
    corrected: Machine | None = None,
    simulated: Mapping[str, Mapping[str, Array]] | None = None,
) -> FirstChecks:
    """Check one recording against a machine.

    ``motion`` is that of the recording where it is known. ``corrected`` is the machine after a
    correction, whose modes are shown too. ``simulated`` are free runs (N,) by name and sensor, SI,
    to be held against the recording; without it the machine is simulated from the smoothed start.

    Raises:
        InputError: the recording does not show any motion.
    """
    machine = machine_with(machine, recording.parameters)
    if corrected is not None:
        corrected = machine_with(corrected, recording.parameters)
    thin = _shortened(recording, machine)
    if motion is None or thin is not recording:
        motion = motion_of(thin, machine)
    course, skipped = course_of(thin, machine, motion), dict[str, str]()

    def kept(name: str, found: Value | str) -> Value | None:
        if isinstance(found, str):
            skipped[name] = found
            return None
        return found

    timing = timing_of(machine, recording, thin, motion, course)
    if not timing.late:
        skipped["delays"] = "no channel can be held against others, or against a force"
    standing = kept("rest", _standstill(machine, motion, course))
    swings = kept("modes", _swings(machine, corrected, course))
    if simulated is not None:
        base, runs, away = recording, simulated, ""
    else:
        base, (runs, away) = thin, _free_run(machine, thin, course)
    responses = kept("response", _responses(machine, base, runs))
    balance = kept("energy", balance_of(machine, motion, course))
    return FirstChecks(
        recording.name, timing, standing, swings or (), responses or (), balance, skipped, away
    )


def _shortened(recording: Recording, machine: Machine) -> Recording:
    """A long recording averaged in blocks; where its motion allows too few samples to a block, the
    first part of it."""
    if recording.t.size < 2 * SAMPLES_MOST:
        return recording
    head = recording.crop(end=float(recording.t[SAMPLES_MOST]))
    if still([head]):
        return thinned(recording, recording.t.size // SAMPLES_MOST)
    factor = coarsest(recording, SAMPLES_MOST, float(motion_of(head, machine).periods().min()))
    if held_columns(machine.model.inputs):  # averages of what is held are not held
        factor = 1
    if factor < recording.t.size // SAMPLES_MOST:
        recording = recording.crop(end=float(recording.t[SAMPLES_MOST * factor]))
    return thinned(recording, factor)


def repeats_of(
    model: Model, recordings: Sequence[Recording], motions: Sequence[Motion]
) -> tuple[Repeats, ...]:
    """Which of several recordings repeat one manoeuvre, and what they differ by."""
    pairs = zip(recordings, motions, strict=True)
    runs = [Run(recording, motion, np.empty(0)) for recording, motion in pairs]
    return reported_repeats(model, runs, repeated(runs, [sensor.name for sensor in model.sensors]))


def _standstill(machine: Machine, motion: Motion, course: Course) -> Standstill | str:
    if depends_on_time(machine):
        return "the model depends on time itself and rests nowhere"
    if not machine.free:
        return "the motion of every coordinate is imposed"
    return standstill_of(machine, without_dry_friction(machine)[0], motion, course)


def _swings(machine: Machine, corrected: Machine | None, course: Course) -> tuple[Swing, ...] | str:
    """The modes of the model, and of the corrected one where it is another."""
    if not machine.free:
        return "the motion of every coordinate is imposed"
    found = []
    for name, one in (("model", machine), ("corrected", corrected)):
        if one is None or (name == "corrected" and one.model == machine.model):
            continue
        swing = _swing(name, one, course)
        if isinstance(swing, str):
            return swing
        found.append(swing)
    return tuple(found)


def _swing(name: str, machine: Machine, course: Course) -> Swing | str:
    """Modes about the place of rest nearest to the middle of the motion, under no inputs but
    those of the model; about the start where it rests nowhere."""
    plain, dry = without_dry_friction(machine)
    idle, t = np.zeros(len(machine.model.inputs)), float(course.t[0])
    start = start_of(machine.model)
    start[list(machine.imposed)] = course.q[:, list(machine.imposed)].mean(axis=0)
    if depends_on_time(machine) and not steady_slopes(plain, start, idle, course.t):
        return "stiffness, damping or masses of the model depend on time itself"
    rest = rest_position(plain, start, idle, t)
    place = start if rest is None else rest
    modes = modes_at(plain, place, idle, t)
    if not modes:
        return "a law of the model has no slope where it would rest"
    coordinates = machine.model.coordinates
    where = {c.name: float(q) / c.unit.factor for c, q in zip(coordinates, place, strict=True)}
    return Swing(name, where, rest is not None, modes, dry)


def _free_run(
    machine: Machine, recording: Recording, course: Course
) -> tuple[Mapping[str, Mapping[str, Array]], str]:
    """The model simulated from the smoothed start, by sensor, and where it ran away, in words."""
    form = state_form(machine)
    size = np.abs(course.states).max(axis=0, initial=0.0)
    size = np.where(size > 0, size, 1.0)
    t_u, u = driving(recording, machine)
    scenario = Scenario(
        recording.t,
        course.q[0],
        course.v[0],
        t_u,
        u,
        size,
        z=course.z[0],
        given=on_lines(recording.t, course.drive[:, form.inputs :], t_u) if form.given else None,
        bound=RUNAWAY * size,
    )
    run = simulate(machine, scenario)
    names = [sensor.name for sensor in machine.model.sensors]
    runs = {"model": {name: run.y[:, j] for j, name in enumerate(names)}}
    if run.complete:
        return runs, ""
    end = float(run.t[np.argmin(np.isfinite(run.q).all(axis=1))] - run.t[0])
    why = (
        f"is {RUNAWAY:g} times beyond what was recorded" if run.reason.startswith(LEFT) else "stops"
    )
    return runs, (
        f"the model alone, simulated from the recorded start, {why} after {end:.3g} s: it has no "
        "response to be held beside these"
    )


def _responses(
    machine: Machine, recording: Recording, runs: Mapping[str, Mapping[str, Array]]
) -> tuple[Response, ...] | str:
    """The frequency response of every sensor to all that drives the machine."""
    model = machine.model
    drives = dict(
        zip((item.name for item in model.inputs), acting(recording, machine).T, strict=True)
    )
    drives |= {c.name: recording.inputs[c.name] for c in model.coordinates if c.imposed}
    by = driven(recording.t, drives)
    if isinstance(by, str):
        return by
    found, reasons = [], []
    for sensor, y in zip(model.sensors, measured(recording, machine).T, strict=True):
        if sensor.name not in recording.sensors or not np.isfinite(y).any():
            continue
        beside = {name: run[sensor.name] for name, run in runs.items() if sensor.name in run}
        one = response_of(
            by, recording.t, (sensor.name, y, sensor.unit.text, sensor.unit.factor), beside
        )
        if isinstance(one, str):
            reasons.append(one)
        else:
            found.append(one)
    return tuple(found) if found else "; ".join(dict.fromkeys(reasons)) or "no sensor has samples"

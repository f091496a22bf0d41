"""Faults of a recording: a wrong unit or sign, exchanged columns, a time column in another unit.

These would mislead the estimate of the motion itself, so they are tried before everything else, but
only where a model misses more than any ordinary cause could explain (:mod:`.misfit`). A fault is
claimed where the repaired recordings leave a tenth of that and the model then explains nine tenths
of all forces; one that helps and does less is reported as a suspicion and changes nothing.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import log
from typing import TypeVar

import numpy as np

from symhyb.data.recording import Recording
from symhyb.data.thin import stretch, thinned
from symhyb.discrepancy.fitting.misfit import Misfit, misfit
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.results import RecordingFault
from symhyb.discrepancy.words.wording import joined, percent_text
from symhyb.errors import InputError
from symhyb.judgement import ALIKE, GAIN_REACH, LARGE, NOTABLE, SAMPLES_TELL, SMALL, SUSPECT
from symhyb.model.types import Input, Model, Parameter, Sensor
from symhyb.numeric.kernels.buffers import resampled
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.between import held_columns
from symhyb.units import ONE, Unit, parse_unit

SAMPLES_MOST = 1200  # of a recording, that are looked at
SPACINGS_TRIED = (1.6, 4.0, 8.0, 16.0, 32.0, 64.0)  # samples between two knots
SAMPLES_PERIOD = 80  # of the shortest period, that are kept

UNITS = (
    "m",
    "mm",
    "cm",
    "um",
    "inch",
    "rad",
    "deg",
    "turn",
    "mrad",
    "m/s",
    "mm/s",
    "cm/s",
    "km/h",
    "rad/s",
    "deg/s",
    "turn/s",
    "rpm",
    "m/s^2",
    "mm/s^2",
    "g",
    "rad/s^2",
    "deg/s^2",
    "N",
    "kN",
    "mN",
    "kgf",
    "lbf",
    "N*m",
    "mN*m",
    "kN*m",
    "V",
    "mV",
    "A",
    "mA",
)
"""Units that recordings come in; of a channel, those of its dimension are tried."""
TOGETHER = ("mm", "cm", "deg", "turn")  # lengths or angles, their speeds and accelerations
NAMED = {"g": (9.80665, "m/s^2"), "kgf": (9.80665, "N"), "lbf": (4.4482216, "N")}
TIMES = (("ms", 1e3), ("us", 1e6), ("min", 1 / 60))
PLURALS = {"deg": "degrees", "turn": "revolutions", "inch": "inches"}


@dataclass(frozen=True, slots=True)
class Repair:
    """Model and recordings without the faults that were claimed; ``faults`` are those of any
    weight."""

    model: Model
    faults: tuple[RecordingFault, ...]


def repaired(given: Sequence[Recording], faults: Sequence[RecordingFault]) -> tuple[Recording, ...]:
    """Recordings with what no model file can say put right: exchanged columns, the unit of time.

    Wrong units and signs stay in them: the corrected model states their gain.
    """
    claimed = [fault for fault in faults if fault.claimed]
    return tuple(_undone(recording, claimed) for recording in given)


def _undone(recording: Recording, faults: Sequence[RecordingFault]) -> Recording:
    for fault in faults:
        if fault.kind == "time":
            recording = replace(recording, t=recording.t / fault.factor)
        if fault.kind == "clock":
            recording = _retimed(recording, fault)
        if fault.kind == "swap":
            first, second = fault.channels
            sensors, inputs = dict(recording.sensors), dict(recording.inputs)
            side = sensors if first in sensors else inputs
            if first in side and second in side:
                side[first], side[second] = side[second], side[first]
            recording = replace(recording, sensors=sensors, inputs=inputs)
    return recording


def _retimed(recording: Recording, fault: RecordingFault) -> Recording:
    """A recording in which a channel's delay no longer grows."""
    sensors, inputs = dict(recording.sensors), dict(recording.inputs)
    grown = fault.factor * (recording.t - recording.t[0])
    for name in fault.channels:
        if name in sensors:  # what it shows at t + d was true at t
            at = recording.t + grown
            known = np.isfinite(sensors[name])
            column = resampled(recording.t[known], sensors[name][known], at)
            sensors[name] = np.where((at < recording.t[0]) | (at > recording.t[-1]), np.nan, column)
        if name in inputs:
            inputs[name] = resampled(recording.t, inputs[name], recording.t - grown)
    return replace(recording, sensors=sensors, inputs=inputs)


def suspect(machine: Machine, runs: Sequence[Run]) -> Repair:
    """Try all faults where the model as given misses more than ordinary causes explain.

    ``machine`` is that of a model that states the gains of all channels, ``runs`` have their
    motion; costs one look at ΔF where nothing is suspected.
    """
    model = machine.model
    if sum(run.recording.t.size for run in runs) < SAMPLES_TELL or not any(map(_turned, runs)):
        return Repair(model, ())
    before = _measured(machine, runs)
    if before is None or before.worst < SUSPECT or any(run.motion.blind for run in runs):
        return Repair(model, ())
    short = [_shortened(run, machine) for run in runs]
    spacing = float(np.median([run.motion.spacing_s for run in runs]))
    plain = _along(machine, short, spacing)
    before = None if plain is None else _measured(machine, plain)
    if plain is None or before is None or before.worst < SUSPECT:
        return Repair(model, ())
    inputs, scored = {item.name for item in model.recorded_inputs}, []
    for fault in recording_faults_of(model, short):
        changed = replace(machine, model=with_fault(model, fault))
        values = np.array([item.si for item in changed.model.all_parameters()])
        changed = replace(changed, values=values)
        moved = fault.kind == "time" or not inputs.issuperset(fault.channels)
        tried = [_undone(recording, [fault]) for recording in short]
        if moved:
            scale = fault.factor if fault.kind == "time" else 1.0
            found = _along(changed, tried, spacing / scale)
        else:
            found = tuple(replace(r, recording=one) for r, one in zip(plain, tried, strict=True))
        after = None if found is None else _measured(changed, found)
        if after is not None:
            scored.append((fault, after))
    return _judged(model, before, scored)


def _turned(run: Run) -> bool:
    """Whether a recording lasts a period of some motion: less shows no shape to distinguish faults
    by."""
    return bool(np.min(run.motion.periods()) < (1 - 1e-9) * run.recording.duration)


def _judged(
    model: Model, before: Misfit, scored: Sequence[tuple[RecordingFault, Misfit]]
) -> Repair:
    """Claim what clears the misfit and explains the forces, report what helps, else nothing."""
    clear = [(fault, after) for fault, after in scored if _clears(before, after)]
    helps = [(fault, after) for fault, after in scored if _helps(before, after)]
    able = clear or helps
    if not able:
        return Repair(model, ())
    limit = ALIKE * max(min(after.worst for _, after in able), NOTABLE * SUSPECT)
    near = [(fault, after) for fault, after in able if after.worst < limit]
    fault, after = min(near, key=lambda pair: _rank(pair[0], model))
    others = tuple(other for other, _ in near if other is not fault)
    sentence = (_claim if clear else _suspicion)(fault, before, after, tuple(map(said, others)))
    named = replace(fault, claimed=bool(clear), sentence=sentence, rivals=others)
    return Repair(with_fault(model, named) if clear else model, (named,))


def _clears(before: Misfit, after: Misfit) -> bool:
    """Whether nothing but this fault explains the misfit; sensors that contradict each other need
    no forces to show it."""
    explains = after.plain < SMALL and after.plain < LARGE * before.plain
    contradict = before.senses > SUSPECT and after.senses < SMALL * before.senses
    return after.worst < SMALL * before.worst and (explains or contradict)


def _helps(before: Misfit, after: Misfit) -> bool:
    return after.worst < LARGE * before.worst and (
        after.plain < LARGE * before.plain or before.senses > SUSPECT
    )


def _along(
    machine: Machine, recordings: Sequence[Recording], spacing_s: float
) -> tuple[Run, ...] | None:
    """Recordings with their motion, or None where there is none. Channels that contradict each
    other ask for finer knots than channels that agree, so besides ``spacing_s`` others are tried.
    """
    runs = []
    for recording in recordings:
        step = float(np.median(np.diff(recording.t)))
        spacings = sorted({spacing_s, *(one * step for one in SPACINGS_TRIED)})
        try:
            motion = motion_of(recording, machine, spacings)
        except InputError:
            return None
        runs.append(Run(recording, motion, np.empty(0)))
    return tuple(runs)


def _measured(machine: Machine, runs: Sequence[Run]) -> Misfit | None:
    try:
        with np.errstate(all="ignore"):
            found = misfit(machine, runs)
    except (ValueError, np.linalg.LinAlgError):
        return None
    return found if np.isfinite(found.worst) and np.isfinite(found.plain) else None


def _shortened(run: Run, machine: Machine) -> Recording:
    """The part of a recording that moves most, thinned as far as its motion and inputs allow."""
    step = float(np.median(np.diff(run.recording.t)))
    dense = int(float(run.motion.periods().min()) / SAMPLES_PERIOD / step)
    if held_columns(machine.model.inputs):  # averages of what is held are not held
        dense = 1
    recording = thinned(run.recording, max(min(dense, run.recording.t.size // SAMPLES_MOST), 1))
    size = recording.t.size
    if size <= SAMPLES_MOST:
        return recording
    firsts = range(0, size - SAMPLES_MOST + 1, SAMPLES_MOST)
    spreads = {name: float(np.nanstd(values)) for name, values in recording.sensors.items()}

    def moves(first: int) -> float:
        parts = {n: v[first : first + SAMPLES_MOST] for n, v in recording.sensors.items()}
        kept = {n: part for n, part in parts.items() if spreads[n] > 0 and np.isfinite(part).any()}
        return sum(float(np.nanstd(part)) / spreads[n] for n, part in kept.items())

    first = max(firsts, key=moves)
    return stretch(recording, slice(first, first + SAMPLES_MOST))


def recording_faults_of(model: Model, recordings: Sequence[Recording]) -> Iterator[RecordingFault]:
    """Every fault worth a trial: signs and units of each channel and of all sensors of one unit
    together, exchanged columns, the unit of time."""
    present = [s for s in model.sensors if all(s.name in r.sensors for r in recordings)]
    channels: list[Input | Sensor] = [*model.recorded_inputs, *present]
    for channel in channels:
        yield RecordingFault("sign", (channel.name,), -1.0)
        for word, factor in misreadings(channel.unit):
            yield RecordingFault("unit", (channel.name,), factor, word)
    for word in TOGETHER:
        factors = {
            s.name: factor
            for s in present
            for other, factor in misreadings(s.unit)
            if other.split("/")[0] == word
        }
        if len(factors) > 1 and max(factors.values()) < 1.001 * min(factors.values()):
            yield RecordingFault("unit", tuple(factors), max(factors.values()), word)
    sensed, driven = [s.name for s in present], [item.name for item in model.recorded_inputs]
    for pair in (*combinations(sensed, 2), *combinations(driven, 2)):
        yield RecordingFault("swap", pair)
    for word, factor in TIMES:
        yield RecordingFault("time", ("t",), factor, word)


def misreadings(unit: Unit) -> Iterator[tuple[str, float]]:
    """Other units of a dimension, with the factor by which a number in them is too large."""
    seen = {1.0}
    for text in UNITS:
        size, name = NAMED.get(text, (1.0, text))
        other = parse_unit(name)
        factor = unit.factor / (size * other.factor)
        turns = "rad" in text or "deg" in text or "turn" in text or text == "rpm"
        if not unit.same_dimension(other) or turns != _turns(unit):
            continue
        if max(factor, 1 / factor) > 1 + GAIN_REACH and round(log(factor), 6) not in seen:
            seen.add(round(log(factor), 6))
            yield text, factor


def _turns(unit: Unit) -> bool:
    return any(word in unit.text for word in ("rad", "deg", "turn", "rpm", "rev"))


def with_fault(model: Model, fault: RecordingFault) -> Model:
    """The model whose channels state the gains of a wrong unit or sign."""
    if fault.kind not in ("unit", "sign"):
        return model
    return replace(
        model,
        inputs=tuple(_misread(item, fault, 1 / fault.factor) for item in model.inputs),
        sensors=tuple(_misread(item, fault, fault.factor) for item in model.sensors),
    )


Channel = TypeVar("Channel", Input, Sensor)


def _misread(channel: Channel, fault: RecordingFault, factor: float) -> Channel:
    if channel.name not in fault.channels:
        return channel
    gain = channel.gain or Parameter("gain", 1.0, ONE, owner=channel.name)
    return replace(channel, gain=replace(gain, value=gain.value * factor))


def gain_of(model: Model, fault: RecordingFault, name: str) -> float:
    """The gain of a channel of the model as given, with a fault that was claimed."""
    changed = with_fault(model, fault)
    channels: list[Input | Sensor] = [*changed.inputs, *changed.sensors]
    gain = next(channel.gain for channel in channels if channel.name == name)
    return 1.0 if gain is None else gain.value


def _rank(fault: RecordingFault, model: Model) -> tuple[int, int, int]:
    """Which of two faults that fit alike is named: a sign before a unit before an exchange before
    the time, an input before a sensor, all sensors of a unit before a single one."""
    order = ("sign", "unit", "swap", "time", "clock")
    inputs = {item.name for item in model.inputs}
    return order.index(fault.kind), int(not inputs & {*fault.channels}), -len(fault.channels)


def said(fault: RecordingFault) -> str:
    """Say a fault as a clause: ``encoder is recorded in degrees``."""
    names = joined(fault.channels)
    verb = "is" if len(fault.channels) == 1 else "are"
    match fault.kind:
        case "sign":
            return f"{names} {verb} recorded with the opposite sign"
        case "unit":
            word = PLURALS.get(fault.word, fault.word)
            return f"{names} {verb} recorded in {word}"
        case "swap":
            return f"the columns of {names} are exchanged"
        case "clock":
            return f"the clock of {names} does not keep the time of the other channels"
        case _:
            return f"the time column is in {fault.word}, not in s"


def _claim(fault: RecordingFault, before: Misfit, after: Misfit, equals: Sequence[str]) -> str:
    cure = {
        "swap": " (map each to the other's column to be rid of this)",
        "time": f" (map t to its column in {fault.word} to be rid of this)",
    }.get(fault.kind, "")
    sentence = f"{said(fault)}{cure}: as recorded, {_share(before)}; put right, {_share(after)}"
    return sentence + (f" (the same would be seen if {joined(equals, 'or')})" if equals else "")


def _suspicion(fault: RecordingFault, before: Misfit, after: Misfit, equals: Sequence[str]) -> str:
    rivals = f", or {joined(equals, 'or')}" if equals else ""
    return (
        f"perhaps {said(fault)}{rivals}: as recorded, {_share(before)}; "
        f"put right, {_share(after)}, "
        "which is not enough to claim it"
    )


def _share(found: Misfit) -> str:
    if found.senses > max(found.ordinary, SUSPECT):
        return f"the sensors contradict each other by {percent_text(found.senses)} of a variance"
    return f"{percent_text(min(found.ordinary, 1.0))} of the squared forces have no ordinary cause"

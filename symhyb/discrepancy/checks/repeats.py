"""Repeated runs of one manoeuvre: how far they differ beyond the noise within a run.

What changes from run to run (temperature, lubrication, how the rig was set up) is no measurement
noise, and no average over samples takes it away. Where recordings repeat each other it can be
measured, and it is the smallest effect that these recordings can prove.
Sizes: N samples, m sensors.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.local import plain
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.recorded.signals import noise_level
from symhyb.discrepancy.results import Repeats
from symhyb.discrepancy.words.wording import joined, small_text
from symhyb.judgement import (
    FEWEST,
    LARGE,
    NEGLIGIBLE,
    NOTABLE,
    OUTSTANDING,
    START_DEVIATIONS,
    STRANGE,
    SURE,
)
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array


@dataclass(frozen=True, slots=True, eq=False)
class Repeated:
    """Runs (their indices) of one manoeuvre; ``between`` (m,) is the spread between them beyond
    their noise, SI: zero where noise explains it, NaN for a sensor that they lack."""

    runs: tuple[int, ...]
    between: Array


def repeated(runs: Sequence[Run], sensors: Sequence[str]) -> tuple[Repeated, ...]:
    """The groups of runs that repeat one manoeuvre: same length and sampling, inputs the same
    within their noise, the same start, and motion alike. ``sensors`` in the order of the model."""
    groups: list[list[int]] = []
    for i, run in enumerate(runs):
        for group in groups:
            if _same(runs[group[0]], run):
                group.append(i)
                break
        else:
            groups.append([i])
    found = []
    for group in groups:
        members = _regular(runs, group, sensors)
        if len(members) > 1:
            found.append(Repeated(tuple(members), _between(runs, members, sensors)))
    return tuple(found)


def floor_of(groups: Sequence[Repeated], sensors: int) -> Array:
    """The largest spread between repeated runs (m,), SI; zero where none is known."""
    rows = [np.nan_to_num(group.between) for group in groups]
    return np.asarray(np.max([np.zeros(sensors), *rows], axis=0))


def reported_repeats(
    model: Model, runs: Sequence[Run], groups: Sequence[Repeated]
) -> tuple[Repeats, ...]:
    """The groups of repeated runs in words, with what they differ by in the units of sensors."""
    result = []
    for group in groups:
        names = tuple(runs[i].recording.name for i in group.runs)
        noise, between, parts = {}, {}, []
        for j, sensor in enumerate(model.sensors):
            if not np.isfinite(group.between[j]):
                continue
            spreads = [runs[i].motion.sd[j] for i in group.runs]
            noise[sensor.name] = float(np.sqrt(np.mean(np.square(spreads)))) / sensor.unit.factor
            between[sensor.name] = float(group.between[j]) / sensor.unit.factor
            if between[sensor.name] > 0:
                text = [
                    small_text(x[sensor.name], sensor.unit.text, digits=2) for x in (between, noise)
                ]
                parts.append(f"{text[0]} in {sensor.name} (noise {text[1]})")
        said = f"{joined(names)} repeat one manoeuvre"
        if parts:
            said += f" and differ by {joined(parts)}: no smaller effect is claimed."
        else:
            said += " and differ by no more than their noise."
        result.append(Repeats(names, noise, between, said))
    return tuple(result)


def _same(first: Run, second: Run) -> bool:
    a, b = first.recording, second.recording
    if dict(a.parameters) != dict(b.parameters):
        return False  # of two machines
    driving, other = (plain(one).inputs for one in (a, b))  # what an FMU says follows from motion
    if a.t.size != b.t.size or set(driving) != set(other) or set(a.sensors) != set(b.sensors):
        return False
    step = float(np.median(np.diff(a.t)))
    if np.max(np.abs((a.t - a.t[0]) - (b.t - b.t[0]))) > 0.5 * step:
        return False
    driven = all(same_input(signal, other[name]) for name, signal in driving.items())
    return driven and _same_start(first.motion, second.motion) and _alike(a, b)


def same_input(first: Array, second: Array) -> bool:
    """Whether two records (N,) of a signal, in any one unit, are the same within their noise."""
    noise = float(np.hypot(noise_level(first), noise_level(second)))
    allowed = max(OUTSTANDING * noise, NEGLIGIBLE * float(np.std(first)))
    return bool(np.sqrt(np.mean((first - second) ** 2)) <= allowed)


def _same_start(first: Motion, second: Motion) -> bool:
    return all(
        bool(np.all(np.abs(a[0] - b[0]) <= NOTABLE * np.ptp(a, axis=0) + START_DEVIATIONS * sd))
        for a, b, sd in (
            (first.q, second.q, first.q_sd + second.q_sd),
            (first.v, second.v, first.v_sd + second.v_sd),
        )
    )


def _alike(first: Recording, second: Recording) -> bool:
    for name, values in first.sensors.items():
        apart = np.sqrt(np.nanmean((values - second.sensors[name]) ** 2))
        if not apart <= LARGE * np.nanstd(values):
            return False
    return True


def _regular(runs: Sequence[Run], group: Sequence[int], sensors: Sequence[str]) -> list[int]:
    """The runs of a group without one that differs from all others by far more than they do: it is
    an outlier among them, not a measure of their spread."""
    members = list(group)
    while len(members) > FEWEST:
        spreads = {
            i: (_mean(runs, members, sensors, [i]), _mean(runs, members, sensors, [], out=i))
            for i in members
        }
        worst = max(members, key=lambda i: spreads[i][0] / max(spreads[i][1], 1e-300))
        own, others = spreads[worst]
        if own <= STRANGE * others:
            break
        members.remove(worst)
    return members


def _mean(
    runs: Sequence[Run],
    members: Sequence[int],
    sensors: Sequence[str],
    within: Sequence[int],
    out: int = -1,
) -> float:
    """Mean whitened distance of pairs: those with a run of ``within``, or those without ``out``."""
    pairs = [
        pair
        for pair in combinations(members, 2)
        if out not in pair and (not within or set(within) & set(pair))
    ]
    return float(np.mean([_distance(runs[i], runs[j], sensors) for i, j in pairs]))


def _distance(first: Run, second: Run, sensors: Sequence[str]) -> float:
    parts = []
    for j, name in enumerate(sensors):
        if name in first.recording.sensors and np.isfinite(first.motion.sd[j]):
            apart = first.recording.sensors[name] - second.recording.sensors[name]
            noise = max(float(first.motion.sd[j]), 1e-300)
            parts.append(float(np.sqrt(np.nanmean(apart**2) / 2)) / noise)
    return float(np.mean(parts)) if parts else 0.0


def _between(runs: Sequence[Run], members: Sequence[int], sensors: Sequence[str]) -> Array:
    """What pairs differ by in mean square, halved, less the mean square of the noise."""
    spread = np.full(len(sensors), np.nan)
    for j, name in enumerate(sensors):
        if any(name not in runs[i].recording.sensors for i in members):
            continue
        noise = float(np.mean([runs[i].motion.sd[j] ** 2 for i in members]))
        apart = [
            runs[a].recording.sensors[name] - runs[b].recording.sensors[name]
            for a, b in combinations(members, 2)
        ]
        whole = float(np.nanmean(np.square(apart))) / 2
        count = max(int(np.isfinite(apart[0]).sum()) * (len(members) - 1), 1)
        sure = SURE * noise * float(np.sqrt(2 / count))
        spread[j] = np.sqrt(whole - noise) if whole - noise > sure else 0.0
    return spread

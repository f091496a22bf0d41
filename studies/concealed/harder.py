"""Harder recordings of a drawn case: what is concealed stays, one thing about them changes.

The sort follows from the seed. *Coloured*: the noise of all sensors is correlated over 2 to 15
samples. *Held*: the machine sees the staircase of the recorded inputs, and its model file does not
know. *Unmeasured*: an Ornstein-Uhlenbeck force that nobody records acts at a place of the machine,
with 1 to 5 % of the largest known force there (RMS) and a correlation time of 0.05 to 0.5 periods.
The oracle's words stay those of the plain case.
"""

from dataclasses import replace

import numpy as np
from conceal import Case
from effects import place_of
from laws import Array
from oracle import Run
from plant import BEFORE, UnboundedError, Unmeasured, simulate
from scipy.interpolate import CubicSpline
from scipy.signal import lfilter
from systems import System

COLOUR = (2.0, 15.0)  # correlation time in samples
SHARE = (0.01, 0.05)  # of the largest known force at the place, RMS
TIME = (0.05, 0.5)  # correlation time in periods of the machine
FINER = 2  # points of the unmeasured force a sample, with a cubic spline between


def harder(case: Case) -> Case | None:
    """The case with harder recordings; None where they do not stay bounded."""
    system, seed = case.plan.system, case.plan.seed
    random = np.random.default_rng([seed, 9])
    sorts = ["coloured", "unmeasured", *["held"] * bool(system.inputs)]
    sort = str(random.choice(sorts))
    if sort == "coloured":
        colour = float(random.uniform(*COLOUR))
        return replace(case, colour=colour, hardship={"sort": sort, "samples": colour})
    said: dict[str, object] = {"sort": sort}
    if sort == "held":
        said |= {"inputs": list(system.inputs), "delay": 0.5 / system.rate}
    forces: list[Unmeasured | None] = [None] * len(case.runs)
    if sort == "unmeasured":
        place = str(random.choice(system.places))
        share = float(np.exp(random.uniform(*np.log(SHARE))))
        time = float(np.exp(random.uniform(*np.log(TIME)))) * period(system)
        first = case.runs[0]
        size = share * place_of(first.plant, first.motion, first.inputs, place).known
        said |= {"place": place, "share": share, "rms": size, "time": time}
        forces = [
            Unmeasured(place, wandering(np.random.default_rng([seed, 9, i]), size, time, run))
            for i, run in enumerate(case.runs)
        ]
    try:
        runs = [
            again(run, sort == "held", force) for run, force in zip(case.runs, forces, strict=True)
        ]
    except (UnboundedError, np.linalg.LinAlgError):
        return None
    if any(system.met(run.plant.values, run.motion.q) for run in runs):
        return None
    return replace(case, runs=tuple(runs), colour=0.0, hardship=said)


def period(system: System) -> float:
    """A period of the machine in s: that of the middle of the band in which it is driven."""
    low, high = system.drive.band
    return float(1 / np.sqrt(low * high))


def wandering(random: np.random.Generator, size: float, time: float, run: Run) -> CubicSpline:
    """An Ornstein-Uhlenbeck force of RMS ``size`` N and correlation ``time`` s along a run: drawn
    exactly at points, a cubic spline between them."""
    step = 1 / (FINER * run.system.rate)
    t = np.arange(-BEFORE - step, run.motion.t[-1] + 2 * step, step)
    return CubicSpline(t, size * _wandering(random, t.size, float(np.exp(-step / time))))


def _wandering(random: np.random.Generator, count: int, keep: float) -> Array:
    """A stationary sequence of variance 1 whose neighbours correlate by ``keep``."""
    white = random.standard_normal(count)
    white[1:] *= np.sqrt(1 - keep**2)
    return np.asarray(lfilter([1.0], [1.0, -keep], white))


def again(run: Run, held: bool, force: Unmeasured | None) -> Run:
    """The run once more with held inputs or an unmeasured force; the noise keeps its size."""
    plant = replace(run.plant, held=held, unmeasured=force)
    assert run.start is not None
    motion = simulate(plant, run.motion.t, run.start)
    inputs = run.inputs
    if run.system.inputs:
        inputs = plant.recorded(motion.t, motion.q, motion.v)
    return replace(run, plant=plant, motion=motion, inputs=inputs)

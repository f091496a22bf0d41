"""A pushed mass on a spring whose recordings are exact: SciPy's linear simulation, first-order hold
between samples, so that nothing but what a test plants stands between machine and model."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.signal import lfilter, lsim

from symhyb.correction.adequacy.followed import likeliest
from symhyb.correction.adequacy.judge import Adequacy, adequacy
from symhyb.correction.adequacy.recorded import Recorded, recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.trajectory import refine
from symhyb.data.recording import Recording
from symhyb.discrepancy.likelihood.fit import Task
from symhyb.discrepancy.places.hypotheses import with_channels
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.windows import stretches
from symhyb.model.read import parse_model
from symhyb.model.types import Model, On
from symhyb.numeric.lowered.machine import Machine, build
from tests.builders import DRIVEN_MASS

Array = NDArray[np.float64]
STIFFNESS, DAMPING = 25.0, 0.6  # what builders.DRIVEN_MASS states, of a mass of 1 kg
STEP, NOISE = 0.02, 2e-3
STEPS = 4  # integration steps between two samples


def pushed_model(text: str = DRIVEN_MASS) -> Model:
    return parse_model(text, "pushed.toml")


def markov(random: np.random.Generator, size: int, rms: float, memory_s: float) -> Array:
    """A stationary first-order Markov signal (N,)."""
    keep = np.exp(-STEP / memory_s)
    white = rms * np.sqrt(1 - keep**2) * random.standard_normal(size)
    white[0] = rms * random.standard_normal()
    return lfilter([1.0], [1.0, -keep], white)


def pushing(random: np.random.Generator, t: Array, size: float = 4.0) -> Array:
    """A multisine of ``size`` N RMS between 0.2 and 2 Hz (N,)."""
    lines, phases = np.linspace(0.2, 2.0, 10), random.uniform(0, 2 * np.pi, 10)
    waves = np.sin(2 * np.pi * np.outer(t, lines) + phases)
    return size * np.sqrt(2 / lines.size) * waves.sum(axis=1)


def pushed(
    seed: int,
    *,
    samples: int = 600,
    stiffness: float = STIFFNESS,
    damping: float = DAMPING,
    beside: Array | None = None,
    colour: tuple[float, float] = (0.0, 1.0),
    noise: float = NOISE,
    name: str = "pushed.csv",
) -> Recording:
    """Position under a multisine; ``beside`` (N,) is a force, N, that is not recorded, ``colour``
    RMS in m and correlation time in s of noise of the sensor beside the white ``noise``, m."""
    random = np.random.default_rng(seed)
    t = STEP * np.arange(samples)
    force = pushing(random, t)
    total = force if beside is None else force + beside
    _, x, _ = lsim(([1.0], [1.0, damping, stiffness]), total, t)
    seen = x + noise * random.standard_normal(samples)
    if colour[0] > 0:
        seen = seen + markov(random, samples, *colour)
    return Recording(name, t, {"f": force}, {"laser": seen}, (), "")


def resisted(seed: int, force: Callable[[float, float], float], samples: int = 1000) -> Recording:
    """The pushed mass with a force that resists, of (x, v)."""
    t = STEP * np.arange(samples)
    push = pushing(np.random.default_rng(seed), t)
    acting = CubicSpline(t, push)

    def rates(time: float, state: Array) -> list[float]:
        x, v = state
        return [v, float(acting(time)) - STIFFNESS * x - DAMPING * v - force(x, v)]

    run = solve_ivp(rates, (0, t[-1]), [0.0, 0.0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=STEP)
    noise = NOISE * np.random.default_rng(900 + seed).standard_normal(t.size)
    return Recording("made.csv", t, {"f": push}, {"laser": run.y[0] + noise}, (), "")


def lowered(model: Model | None = None) -> Machine:
    return build(with_channels(model or pushed_model()))


def task_of(
    machine: Machine,
    *recordings: Recording,
    count: int = 0,
    own: tuple[tuple[int, ...], ...] = (),
    steps: int = STEPS,
) -> Task:
    """``count`` numbers without bounds and priors, to be fitted to whole recordings."""
    items, which = [], []
    for i, one in enumerate(recordings):
        for item in stretches(one, machine, motion_of(one, machine), steps, 1):
            items.append(item)
            which.append(i)
    none, wide = np.zeros(count), np.full(count, np.inf)
    floor = np.full(len(machine.model.sensors), 1e-2 * NOISE)
    return Task(tuple(items), tuple(which), floor, -wide, wide, none, wide, own)


def setting_of(model: Model, *recordings: Recording, own: tuple[str, ...] = ()) -> Recorded:
    """What adequacy is judged on."""
    prepared = prepare(model, recordings, own=own)
    found = recorded(prepared, settle(prepared, own))
    assert found is not None
    return found


def decided(
    recording: Recording, *laws: tuple[str, str], rows: Sequence[Mapping[str, float]]
) -> tuple[Recorded, Fitted]:
    """The pushed mass with laws on x, by kind and first term, as innovations fit them; ``rows``
    begin their numbers, SI."""
    ground = setting_of(pushed_model(), recording)
    causes = [
        next(
            cause
            for cause in ground.hypotheses
            if (cause.kind, cause.terms[0], cause.place) == (*law, On("x"))
        )
        for law in laws
    ]
    return ground, likeliest(ground, causes, rows)


def judged(recording: Recording, model: Model | None = None) -> tuple[Recorded, Adequacy]:
    """The judgement of the model as it is."""
    prepared = prepare(model or pushed_model(), recording)
    setting = settle(prepared)
    cuts = setting.stages[-1].cuts
    final = refine(prepared.model, (), (), cuts, setting.sd)
    ground = recorded(prepared, setting)
    assert ground is not None
    return ground, adequacy(prepared, setting, final, (final, cuts))

"""A run of every shipped model by each method, and by the one that ``simulate`` finds.

10 s with 2001 outputs, from the start that the model declares; inputs and imposed motions are
recorded at 200 Hz, sums of three sines. The method that ``simulate`` finds on the way has to take
no more than twice as long as the better of the explicit method alone, with as many steps as it asks
for, and of CVODES alone, by BDF or Adams. All return states alone, on their constraints; times are
of the processor, the second of two runs, since the first may wait for the compiler. A contender
that ends before the run does is no contender.
"""

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from timing import Row, milliseconds

from symhyb.model.read import read_model
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.closing import closed_rows
from symhyb.numeric.runs.cvodes import ABSOLUTE_TOLERANCE, RELATIVE_TOLERANCE
from symhyb.numeric.runs.explicit import field, longest_step
from symhyb.numeric.runs.explicit_run import Course, explicit_run
from symhyb.numeric.runs.implicit_run import implicit_sizes, implicit_states
from symhyb.numeric.runs.integrate import begun, found_states
from symhyb.numeric.runs.scenario import Scenario

Array = NDArray[np.float64]
MODELS = Path(__file__).parents[2] / "models"
RATE = 200.0  # Hz
WAVES = 2 * np.pi * np.array([0.3, 0.9, 2.1])  # rad/s
PART = "10 s of every model, the method found on the way"
NOISE = 0.02  # s: below, times of two runs of the same differ by a factor of 2 on a busy machine
# sizes of inputs, then of imposed motions, and what inputs are without them, SI
SIZES: dict[str, tuple[float, ...]] = {
    "car": (60,),
    "cartpole": (3,),
    "chain_of_masses": (5,),
    "damper_rig": (0.004,),
    "duffing": (1,),
    "emps": (60,),
    "five_bar": (0.3, 0.3),
    "four_bar": (0.2,),
    "furuta_pendulum": (0.02,),
    "half_car": (0.02, 0.02),
    "loudspeaker": (5,),
    "maglev": (0.2,),
    "oscillator": (1,),
    "pendulum_on_cart": (5,),
    "quadrotor": (0.05, 0.05, 0.05, 0.05),
    "quarter_car": (0.02,),
    "rig_alone": (0.004,),
    "silverbox": (0.05,),
    "six_joint_arm": (20, 40, 20, 3, 3, 1),
    "slider_crank": (0.2,),
    "strut": (500,),
    "two_inertia_backlash": (0.05,),
    "two_link_arm": (2, 1),
}
MEANS = {"maglev": 4.00124, "quadrotor": 1.6}


def names() -> list[str]:
    """The shipped models."""
    return sorted(file.stem for file in MODELS.glob("*.toml"))


def scenario_of(name: str, seconds: float = 10.0) -> tuple[Machine, Scenario]:
    """A model and its run."""
    machine = build(read_model(MODELS / f"{name}.toml"))
    model, imposed = machine.model, len(machine.imposed)
    t = np.linspace(0.0, seconds, round(seconds * RATE) + 1)
    inputs, sizes = len(model.inputs), SIZES.get(name, ())
    moved = [[size * _waves(t, i, order) for i, size in enumerate(sizes)] for order in range(3)]
    u = np.array(moved[0][:inputs]).reshape(inputs, t.size).T + MEANS.get(name, 0.0)
    given = np.array([row[inputs:] for row in moved]).reshape(3 * imposed, t.size).T
    q, v = (np.array(part) for part in model.start())
    driven = bool(inputs or imposed)
    t_u = t if driven else t[[0, -1]]
    return machine, Scenario(
        t, q, v, t_u, u if driven else np.empty((2, 0)), given=given if imposed else None
    )


def _waves(t: Array, number: int, order: int) -> Array:
    """A sum of sines (N,) of size 1 at most, or its first or second rate, for one of several."""
    phase = np.outer(np.ones_like(t), 1.0 * number + 2.0 * np.arange(WAVES.size))
    phase += np.outer(t, WAVES) + order * np.pi / 2
    return np.asarray((np.sin(phase) * WAVES**order).mean(axis=1))


def alone(
    form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array
) -> dict[str, Callable[[], str]]:
    """Runs by one method throughout; each returns why it ended early."""

    def closed(x: Array, reason: str) -> str:
        return closed_rows(form, scenario, drive, x, p, reason)[1]

    def explicit() -> str:
        rates = field(form)
        if rates is None:
            return "no compiler"
        course = Course(scenario.t, start, p, scenario.t_u, drive, longest_step(form))
        tolerances = (RELATIVE_TOLERANCE, ABSOLUTE_TOLERANCE)
        run = explicit_run(rates, course, None, tolerances, lambda *_: False)[0]
        return closed(run.x, run.reason)

    def implicit(method: str) -> str:
        sizes = implicit_sizes(form, scenario, drive, start, p, method)
        return closed(*implicit_states(form, scenario, drive, start, p, sizes, method))

    return {
        "explicit": explicit,
        "bdf": lambda: implicit("bdf"),
        "adams": lambda: implicit("adams"),
    }


def timed(work: Callable[[], str], repeats: int = 2) -> tuple[float, str]:
    """Time of the processor of the last run, s, and why it ended early."""
    took, reason = 0.0, ""
    for _ in range(repeats):
        before = time.process_time()
        reason = work()
        took = time.process_time() - before
    return took, reason


def row(name: str, seconds: float = 10.0) -> Row | None:
    """One model; None where no coordinate is free."""
    machine, scenario = scenario_of(name, seconds)
    form, scenario, drive, start, reason = begun(machine, scenario, machine.values)
    if form.size == 0 or reason:
        return None
    given = form, scenario, drive, start, machine.values
    told: list[str] = []

    def ours() -> str:
        _, reason, method, note = found_states(*given)
        told[:] = [method, note]
        return reason

    took, ended = timed(ours)
    others = {method: timed(work, 1 if took > 1 else 2) for method, work in alone(*given).items()}
    done = [time for time, reason in others.values() if not reason]
    text = "; ".join(
        f"{method} {milliseconds(time)}{' (ends early)' if reason else ''}"
        for method, (time, reason) in others.items()
    )
    note = f"{milliseconds(took)} ({told[0]}{', ends early' if ended else ''}); {text}"
    if not done:
        best = min(time for time, _ in others.values())
        return Row(PART, f"{name}: time over the quickest end", took / best, None, False, "×", note)
    ratio = took / min(done)
    bar = 2.0 if max(took, min(done)) > NOISE else None
    return Row(PART, f"{name}: time over the best of all", ratio, bar, False, "×", note)


def rows() -> list[Row]:
    """All models."""
    return [found for name in names() if (found := row(name)) is not None]

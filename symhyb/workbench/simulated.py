"""The model that is shown, simulated beside a recording, with the error of every channel.

A free run: from the start of the recording to its end, driven by the recorded inputs. It starts
from the first state of the smoothed recording, or from one that was fitted. Values of parameters
are arguments of the lowered machine, so that nothing is lowered anew when one is moved.
"""

from dataclasses import dataclass, replace

import numpy as np

from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.scores import free_scenario
from symhyb.discrepancy.recorded.motion import Motion, motion_of
from symhyb.discrepancy.recorded.runs import Run, noise_sd, with_noise
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.discrepancy.recorded.signals import measured
from symhyb.model.types import Input, Model, Sensor
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import WindowModel


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """A ``recording`` with its smoothed ``motion``, as the ``model`` of the file sees it."""

    model: Model
    recording: Recording
    motion: Motion


@dataclass(frozen=True, slots=True, eq=False)
class Begun:
    """The lowered ``machine`` of a free run and what it is given. ``key`` is what both depend on
    beside the recording: the elements, and the delays of channels; ``fitted`` says where the start
    is from."""

    key: tuple[object, ...]
    machine: Machine
    scenario: Scenario
    fitted: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Compared:
    """A sensor in its ``unit``, measured and simulated (N,), NaN where there is no value; ``nrmse``
    is RMSE / (max − min) of the measurement, None where it cannot be computed."""

    sensor: Sensor
    measured: Array
    simulated: Array
    nrmse: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """A simulation beside a recording at ``t`` (N,), s; ``reason`` says why it ended early."""

    t: Array
    sensors: tuple[Compared, ...]
    reason: str

    def nrmse(self) -> dict[str, float | None]:
        """The errors by sensor."""
        return {one.sensor.name: one.nrmse for one in self.sensors}


def prepare(model: Model, recording: Recording) -> Prepared:
    """Estimate the motion of a recording once, with the model of the file.

    Raises:
        InputError: no sensor of motion, or a machine that cannot be built.
    """
    return Prepared(model, recording, motion_of(recording, _machine(model, recording, keep=True)))


def key_of(model: Model) -> tuple[object, ...]:
    """What a free run depends on in a model beside the values of parameters."""
    channels: tuple[Input | Sensor, ...] = (*model.inputs, *model.sensors)
    delays = tuple(one.delay and one.delay.si for one in channels)
    return tuple(model.elements.names()), delays


def begin(prepared: Prepared, model: Model, before: Begun | None = None) -> Begun:
    """What a free run of a model is given; a start that was fitted ``before`` stays."""
    if before is not None and before.key == key_of(model):
        return before
    machine = _machine(model, prepared.recording)
    run = Run(prepared.recording, prepared.motion, np.empty(0))
    scenario = free_scenario(WindowModel(machine), run, fitted=False)
    if before is None or not before.fitted:
        return Begun(key_of(model), machine, scenario)
    place = replace(scenario, q=before.scenario.q, v=before.scenario.v)
    return Begun(key_of(model), machine, place, fitted=True)


def fit_start(prepared: Prepared, model: Model) -> Begun:
    """The same from the initial state with which the model meets the recording best."""
    machine = _machine(model, prepared.recording)
    window = WindowModel(machine)
    runs = [Run(prepared.recording, prepared.motion, np.empty(0))]
    (run,) = with_noise(runs, noise_sd(runs, machine), window)
    return Begun(key_of(model), machine, free_scenario(window, run), fitted=True)


def shown_run(prepared: Prepared, model: Model, begun: Begun) -> Shown:
    """Simulate a model beside a recording; a run that stops early says why."""
    values = np.array([item.si for item in model.all_parameters()])
    run = simulate(begun.machine, begun.scenario, values)
    y = measured(prepared.recording, begun.machine)
    pairs = zip(begun.machine.model.sensors, y.T, run.y.T, strict=True)
    return Shown(
        prepared.recording.t,
        tuple(_compared(*pair) for pair in pairs if np.isfinite(pair[1]).any()),
        run.reason,
    )


def _machine(model: Model, recording: Recording, keep: bool = False) -> Machine:
    return build(as_sampled(model, [recording]), keep)


def _compared(sensor: Sensor, recorded: Array, run: Array) -> Compared:
    recorded, run = recorded / sensor.unit.factor, run / sensor.unit.factor
    return Compared(sensor, recorded, run, nrmse(recorded, run))


def nrmse(recorded: Array, run: Array) -> float | None:
    """RMSE / (max − min) of what was recorded (N,), in the unit of both; None where that is zero
    or a run ended early."""
    known = np.isfinite(recorded)
    reach = float(np.ptp(recorded[known])) if known.any() else 0.0
    with np.errstate(over="ignore", invalid="ignore"):
        error = float(np.sqrt(np.mean((run[known] - recorded[known]) ** 2))) if reach else np.nan
    return error / reach if np.isfinite(error) else None

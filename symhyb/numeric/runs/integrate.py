"""Simulation of a machine, once over the whole output grid: by an explicit Runge–Kutta method in
machine code where that can be had, and from where a run is stiff by CVODES; else by CVODES alone.

Recorded inputs act by first-order hold; along a spline, or held from sample to sample, where the
model says so, and then through its actuators. Where an input jumps, the integration ends and starts
anew, so that no step reaches across. Failure is an outcome with its reason, never an exception.

Source: Hindmarsh et al., SUNDIALS, ACM TOMS 31, 2005 (through ``casadi.integrator``).
"""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from symhyb.drawn import drawn
from symhyb.framed import Signal, dataset_of, frame_of
from symhyb.model.space import gimbal_lock
from symhyb.model.types import Model
from symhyb.model.unsampled import require_unsampled
from symhyb.numeric.kernels.actuators import Acted
from symhyb.numeric.kernels.buffers import Array, call, held_at, on_line, on_lines
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.acting import acting_inputs
from symhyb.numeric.lowered.dynamics import StateForm, state_form
from symhyb.numeric.lowered.lengths import at_unit_length
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.between import bent_columns, finer, stepped
from symhyb.numeric.runs.closing import closed_rows, closed_start
from symhyb.numeric.runs.cvodes import (
    RELATIVE_TOLERANCE,
    advanced,
    culprits,
    cvodes_options,
    driven,
    steps_of_output,
)
from symhyb.numeric.runs.explicit import compiler_fails, field
from symhyb.numeric.runs.implicit_run import implicit_run
from symhyb.numeric.runs.sampled import sampled_run, samples_of
from symhyb.numeric.runs.scenario import Event, Scenario
from symhyb.numeric.runs.turns import in_turns
from symhyb.shown import card
from symhyb.units import parse_unit

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

NEAR_LOCK = 0.1  # |cos| of the second of three rotations where a run ended


@dataclass(frozen=True, slots=True, repr=False)
class Trajectory:
    """A simulated run, SI: ``q``, ``v``, ``a`` (N, n), ``y`` (N, m) sensors without noise, ``z``
    (N, z) declared states, then inner states.

    ``reason`` is empty, or says why the integration stopped; rows from there on are NaN. ``method``
    integrated, at the end of the run: *explicit* (Runge–Kutta of order 8), or CVODES by *bdf* or
    *adams*; ``note`` says from when and why, if another did before, what stood in the way of
    another, or where loops can fold over. Of an exact run it is DOP853 or Radau, between the
    located ``events``; *mujoco* where MuJoCo has the machine. ``model`` is what was simulated,
    whose units frames and pictures show.
    """

    t: Array
    q: Array
    v: Array
    a: Array
    y: Array
    z: Array
    reason: str = ""
    method: str = "bdf"
    note: str = ""
    events: tuple[Event, ...] = ()
    model: Model | None = dataclasses.field(default=None, compare=False)

    @property
    def complete(self) -> bool:
        """True if the integration reached the end."""
        return not self.reason

    def __len__(self) -> int:
        return int(self.t.size)

    def __repr__(self) -> str:
        title = f" of '{self.model.title}'" if self.model else ""
        span = f"{self.t[0]:g} … {self.t[-1]:g} s" if len(self) else "no time"
        ended = f"; ended early: {self.reason}" if self.reason else ""
        events = f", {len(self.events)} events" if self.events else ""
        return f"<Trajectory{title}: {len(self)} samples, {span}, {self.method}{events}{ended}>"

    def _repr_html_(self) -> str:
        rows = [
            (name, unit, f"{np.nanmin(values):.5g}", f"{np.nanmax(values):.5g}")
            for name, values, unit in (self.signals() if self.model else ())
            if np.isfinite(values).any()
        ]
        said = tuple(filter(None, (self.reason, self.note)))
        return card(repr(self)[1:-1], "", ("signal", "unit", "smallest", "largest"), rows, said)

    def signals(self) -> Iterator[Signal]:
        """What the sensors show, then places, speeds and accelerations of the coordinates, then
        declared states, each with its values (N,) in the unit of the model file, and that unit."""
        if self.model is None:
            raise ValueError("a run that does not know its model has no names to show")
        for sensor, shown in zip(self.model.sensors, self.y.T, strict=True):
            late = 0.0 if sensor.delay is None else sensor.delay.si
            seen = np.interp(self.t - late, self.t, shown) / sensor.unit.factor
            yield sensor.name, seen, sensor.unit.text
        taken, second = self.model.sensors.names(), parse_unit("s")
        for order, motion in enumerate((self.q, self.v, self.a)):
            for coordinate, column in zip(self.model.coordinates, motion.T, strict=True):
                name = coordinate.name + "'" * order
                name = f"{name} (coordinate)" if name in taken else name
                unit = coordinate.unit / second**order
                yield name, column / coordinate.unit.factor, unit.text
        for state, column in zip(self.model.states, self.z.T, strict=False):
            name = f"{state.name} (state)" if state.name in taken else state.name
            yield name, column / state.unit.factor, state.unit.text

    def to_frame(self) -> "pd.DataFrame":
        """The run in the units of the model file: what sensors show without noise, coordinates and
        their rates, as columns over the index ``t`` in s; ``attrs["units"]`` says which units."""
        return frame_of(self.t, self.signals())

    def to_xarray(self) -> "xr.Dataset":
        """As :meth:`to_frame`, as a dataset of xarray.

        Raises:
            InputError: xarray is not installed.
        """
        return dataset_of(self.t, self.signals())

    def plot(self, *names: str, ax: Any = None) -> Any:
        """Draw sensors and coordinates over time, those of ``names`` or all: returns the axes of
        matplotlib, one a name; what is given as ``ax`` is drawn on (:mod:`symhyb.report.axes`)."""
        return drawn("trajectory", self, ax, names=names)


def simulate(machine: Machine, scenario: Scenario, p: Array | None = None) -> Trajectory:
    """Integrate M q'' = k_e − k_c over ``scenario.t`` with parameters ``p`` (P,) in SI, default
    the model's. Inputs must cover the output times.

    With a C compiler the explicit method, and CVODES by BDF from where the run is so stiff that
    this is quicker, or where the explicit method stops, to say why. Else CVODES alone: BDF with
    Newton's method where a law is steep or remembers, or where the machine linearised at the start
    has a decay that is fast against its swing; else Adams with functional iteration, and BDF if
    that fails. A law that switches is left to BDF at once. Dry friction creeps and stops are
    smooth; exact runs are :mod:`symhyb.exact`.

    Raises:
        ValueError: an input that stops before the simulation does, or times that do not increase.
    """
    values = machine.values if p is None else np.asarray(p, dtype=float)
    form, scenario, drive, start, reason = begun(machine, scenario, values)
    if reason:
        x = np.full((scenario.t.size, form.size), np.nan)
        return _observe(form, scenario, drive, x, values, reason, "none")
    if form.size == 0:
        x = np.zeros((scenario.t.size, 0))
        return _observe(form, scenario, drive, x, values, "", "none")
    x, reason, method, note = found_states(form, scenario, drive, start, values)
    return replace(_observe(form, scenario, drive, x, values, reason, method), note=note)


def begun(
    machine: Machine, scenario: Scenario, p: Array
) -> tuple[StateForm, Scenario, Array, Array, str]:
    """The machine as a system of first order, the scenario with inputs straight between its times,
    the drive (K, D) and the start (X,), SI, and why there is none.

    Raises:
        ValueError: as :func:`simulate`.
    """
    _require_cover(scenario)
    scenario, form = bent(scenario, machine, p), state_form(machine)
    drive = _drive(form, scenario)
    start = form.state(scenario.q, scenario.v, inner_start(machine, scenario, p))
    return form, scenario, drive, *closed_start(form, start, drive, scenario, p)


def found_states(
    form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array
) -> tuple[Array, str, str, str]:
    """States (N, X), SI, by the method that a run asks for, why they end early, the method at the
    end, and a note; of a machine with sampled states from one sample to the next."""
    if form.machine.sampled is None:
        return _unsampled(form, scenario, drive, start, p)

    def advance(part: Scenario, drive: Array, start: Array) -> tuple[Array, str, str, str]:
        return _unsampled(form, part, drive, start, p)

    return sampled_run(samples_of(form, scenario.t, p), scenario, drive, start, advance)


def _unsampled(
    form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array
) -> tuple[Array, str, str, str]:
    rates = None if culprits(form.machine.model) else field(form)
    if rates is not None and scenario.t.size > 1 and np.isfinite(start).all():
        x, reason, method, changed = in_turns(form, rates, scenario, drive, start, p)
        x, reason, note = closed_rows(form, scenario, drive, x, p, reason)
    else:
        x, reason, note, method = implicit_run(form, scenario, drive, start, p)
        changed = compiler_fails()
    return x, reason, method, "; ".join(filter(None, (note, changed)))


def bent(scenario: Scenario, machine: Machine, p: Array) -> Scenario:
    """The scenario with inputs as their actuators pass them on under ``p`` (P,), SI, straight
    between its times: smooth ones on a finer grid, held ones with a time more right before each
    jump."""
    inputs = machine.model.inputs
    smooth, held = bent_columns(inputs)
    if not smooth and not held and not any(item.actuator for item in inputs):
        return scenario
    t, u = finer(scenario.t_u, scenario.u, smooth, held)
    acted = acting_inputs(machine, p, t, u, bool(smooth))
    still = [i for i in held if i not in acted or acted[i].held]
    t, u = _together(t, u, acted, still) if acted else (t, u)
    t, u = stepped(t, u, still)
    if scenario.given is None:
        return replace(scenario, t_u=t, u=u)
    return replace(scenario, t_u=t, u=u, given=on_lines(scenario.t_u, scenario.given, t))


def _together(
    t: Array, u: Array, acted: Mapping[int, Acted], held: Sequence[int]
) -> tuple[Array, Array]:
    """Signals (K, k) at ``t`` (K,), s, with those that actuators pass on, at the times of all; the
    columns ``held`` hold."""
    at = np.unique(np.concatenate([t, *(one.t for one in acted.values())]))
    columns = []
    for i, column in enumerate(u.T):
        if i in acted:
            columns.append(acted[i].at(at))
        else:
            columns.append(held_at(t, column, at) if i in held else on_line(t, column, at))
    return at, np.column_stack(columns) if columns else np.empty((at.size, 0))


def inner_start(machine: Machine, scenario: Scenario, p: Array) -> Array:
    """The inner states (z,) with which a scenario begins, SI."""
    if scenario.z is not None:
        return scenario.z
    (z,) = call(machine.inner_rest, (scenario.q, scenario.v, float(scenario.t[0]), p))
    return z.reshape(-1)


def _drive(form: StateForm, scenario: Scenario) -> Array:
    """Inputs and given motion (K, drive) at the times of the inputs."""
    if not form.given:
        return scenario.u
    if scenario.given is None:
        names = [form.machine.model.coordinates[i].name for i in form.given]
        raise ValueError(f"the motion of {', '.join(names)} is imposed and was not given")
    return np.concatenate([scenario.u, scenario.given], axis=1)


def solve_system(
    form: StateForm, scenario: Scenario, right: ca.Function, start: Array, p: Array
) -> tuple[Array, str]:
    """Integrate any system y' = right(y, d, t, p) along the drive of a scenario by BDF.

    Returns y (N, Y), of order 1 and dimensionless, at the output times, and why it ends early.
    """
    require_unsampled(form.machine.model, "an integration of slopes or of what was learned")
    scenario = bent(scenario, form.machine, p)
    drive = _drive(form, scenario)
    rate = driven(right, scenario.t_u, drive)
    most = steps_of_output(scenario.t.size)
    options = cvodes_options(scenario.t_u, drive, most, "bdf", RELATIVE_TOLERANCE)
    rows = np.full((scenario.t.size, start.size), np.nan)
    rows[0] = start
    states, reason = advanced(rate, scenario.t, start, p, options)
    rows[1 : 1 + len(states)] = states
    return rows, reason


def _require_cover(scenario: Scenario) -> None:
    if not np.all(np.diff(scenario.t) > 0):  # a NaN would never end
        raise ValueError("output times must increase")
    if scenario.u.shape[1] == 0 and scenario.given is None:
        return
    if scenario.t_u[0] > scenario.t[0] + 1e-9 or scenario.t_u[-1] < scenario.t[-1] - 1e-9:
        raise ValueError(
            f"the inputs cover {scenario.t_u[0]:.6g} to {scenario.t_u[-1]:.6g} s, the simulation "
            f"runs from {scenario.t[0]:.6g} to {scenario.t[-1]:.6g} s; shorten the simulation or "
            "give a longer input"
        )


def _observe(
    form: StateForm,
    scenario: Scenario,
    drive: Array,
    x: Array,
    values: Array,
    reason: str,
    method: str,
) -> Trajectory:
    t, total = scenario.t, scenario.t.size
    d = on_lines(scenario.t_u, drive, t)
    q, v = at_unit_length(form.machine.model, *form.motion(x, d))
    x = form.state(q, v, x[:, 2 * len(form.free) :])
    still = np.zeros(form.machine.n)
    y, a = along(form.outputs(), (x, d, t, values, still), repeated=(3, 4), samples=total)
    z = x[:, 2 * len(form.free) :]
    ended, model = _ending(form.machine, q, reason), form.machine.model
    return Trajectory(t, q, v, a, y, z, ended, method, model=model)


def drive_at(form: StateForm, scenario: Scenario, p: Array) -> Array:
    """The drive (N, D) of a scenario at its output times under ``p`` (P,), SI."""
    scenario = bent(scenario, form.machine, p)
    return on_lines(scenario.t_u, _drive(form, scenario), scenario.t)


def _ending(machine: Machine, q: Array, reason: str) -> str:
    """Why a run ended, with the gimbal lock that it ran into, if it did: the last row of q (N, n)
    that was computed may lie a little before it."""
    last = np.flatnonzero(np.isfinite(q).all(axis=1))[-1:]
    if not reason or not last.size:
        return reason
    names = [coordinate.name for coordinate in machine.model.coordinates]
    near = dict(zip(names, (float(x) for x in q[last[0]]), strict=True))
    locked = gimbal_lock(machine.model, near, NEAR_LOCK)
    return f"{reason}; {locked}" if locked else reason

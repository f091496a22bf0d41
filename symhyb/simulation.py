"""One simulated run of a model, as a table: inputs from a recording or zero, start as declared."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from symhyb.data.known_table import table_of_known, values_in
from symhyb.data.recording import Recording, read_recording
from symhyb.discrepancy.recorded.motion import given_motion
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.discrepancy.recorded.signals import driving
from symhyb.errors import InputError, NumericsError, Problem
from symhyb.exact.simulation import simulate
from symhyb.limits import RUN_ROWS
from symhyb.model.bare import bare, is_bare
from symhyb.model.expression import Name, parse_expression
from symhyb.model.types import Model, Sensor
from symhyb.mujoco_run import mujoco_run
from symhyb.numeric.kernels.buffers import Array, held_at, on_line, on_lines
from symhyb.numeric.lowered.known import machine_with
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import Trajectory
from symhyb.numeric.runs.scenario import Scenario
from symhyb.units import parse_unit

_CLOCK = Sensor("t", parse_expression("t"), parse_unit("s"))


def read_inputs(
    path: str | Path,
    model: Model,
    columns: Mapping[str, str] | None = None,
    known: Path | None = None,
) -> Recording:
    """Read the inputs of a model from a recording; it need not have a column for any sensor.
    ``known`` is a table of what is known of parameters in recordings.

    Raises:
        InputError: as :func:`symhyb.data.read_recording`.
    """
    imposed = {Name(c.name) for c in model.coordinates if c.imposed}
    kept = tuple(s for s in model.sensors if s.measures.tree in imposed)
    sensors = {sensor.name for sensor in model.sensors if sensor not in kept}
    asked = {key: text for key, text in (columns or {}).items() if key not in sensors}
    table = table_of_known(known, model)
    values = values_in(table, path)
    seeing = replace(model, sensors=(_CLOCK, *kept))
    recording = read_recording(path, seeing, asked, parameters=values)
    notes = (note for note in recording.notes if not note.startswith(("sensor ", "column")))
    return replace(recording, sensors={}, notes=tuple(notes))


def run_model(
    model: Model,
    driven: Recording | None = None,
    end: float | None = None,
    step: float | None = None,
    exact: bool = False,
) -> tuple[Machine, Scenario, Trajectory]:
    """Simulate a model from its declared start to ``end`` with rows every ``step``, both in s;
    ``exact``: with located events of dry friction and stops.

    Without ``driven`` all inputs are zero and the run begins at 0; with it the run begins, and by
    default ends and steps, as the recording does.

    Raises:
        InputError: times that make no run, or inputs that stop before ``end``.
        NumericsError: the integration failed; the message says why.
    """
    model = bare(model) if model.mujoco else model  # which MuJoCo itself runs
    machine = build(model if driven is None else as_sampled(model, [driven]))
    machine = machine if driven is None else machine_with(machine, driven.parameters)
    t = output_times(model, driven, end, step)
    if driven is None:
        t_u, u, given = t[[0, -1]], np.zeros((2, len(model.inputs))), None
        require_free(model)
    else:
        t_u, u = driving(driven, machine)
        given = given_motion(driven, machine) if machine.imposed else None
        given = None if given is None else on_lines(driven.t, given, t_u)
    q, v = (np.array(part) for part in machine.model.start())
    scenario = Scenario(t, q, v, t_u, u, given=given)
    run = run_of(machine, scenario, exact=exact)
    if not run.complete:
        raise NumericsError(run.reason)
    return machine, scenario, run


def run_of(
    machine: Machine, scenario: Scenario, p: Array | None = None, exact: bool = False
) -> Trajectory:
    """The run of a machine, by MuJoCo where MuJoCo has it, with parameters ``p`` (P,), SI.

    Raises:
        InputError: as :func:`symhyb.exact.simulation.simulate` and
            :func:`symhyb.mujoco_run.mujoco_run`; an exact run of what MuJoCo has.
    """
    if machine.model.mujoco is None or not is_bare(machine.model):
        return simulate(machine, scenario, p, exact)
    if exact:
        text = "a run of MuJoCo has its own steps and contacts; leave out 'exact'"
        raise InputError(Problem(text, "mujoco", machine.model.file))
    return mujoco_run(machine, scenario, p)


def require_free(model: Model) -> None:
    """Refuse a model with imposed motion that no recording gives.

    Raises:
        InputError: it has.
    """
    imposed = [c.name for c in model.coordinates if c.imposed]
    if imposed:
        text = (
            f"the motion of {', '.join(imposed)} is imposed; give a recording with a column of "
            "that name"
        )
        raise InputError(Problem(text, file=model.file))


METHODS = {
    "explicit": "an explicit Runge-Kutta method of order 8",
    "adams": "CVODES (Adams)",
    "bdf": "CVODES (BDF)",
    "dop853": "DOP853 between located events",
    "radau": "Radau between located events",
    "none": "the inputs alone: no coordinate is free",
    "mujoco": "MuJoCo's own steps",
}


def integration_text(run: Trajectory) -> str:
    """By which method a run was integrated, in words."""
    return METHODS.get(run.method, run.method)


def run_table(machine: Machine, scenario: Scenario, run: Trajectory) -> str:
    """Write a run as CSV: t, inputs, sensors without noise, coordinates and their rates, declared
    states, each in the unit of the model file, which stands in the header."""
    model = machine.model
    columns: list[tuple[str, Array]] = [("t [s]", run.t)]
    for item, signal in zip(model.inputs, scenario.u.T, strict=True):
        follow = held_at if item.between == "held" else on_line
        acts = follow(scenario.t_u, signal, run.t)
        columns.append((f"{item.name} [{item.unit}]", acts / item.unit.factor))
    shown = {name: (f"{name} [{unit}]", values) for name, values, unit in run.signals()}
    columns += [shown[sensor.name] for sensor in model.sensors]
    taken = model.sensors.names()
    for q in model.coordinates:
        place = f"{q.name} (coordinate)" if q.name in taken else q.name
        columns += [shown[place], shown[f"{q.name}'"]]
    for state in model.states:
        columns.append(shown[f"{state.name} (state)" if state.name in taken else state.name])
    rows = zip(*(values.tolist() for _, values in columns), strict=True)
    head = ",".join(header for header, _ in columns)
    return "\n".join([head, *(",".join(f"{x:.10g}" for x in row) for row in rows)]) + "\n"


def events_table(run: Trajectory) -> str:
    """Write the events of an exact run as CSV: time, element and transition."""
    lines = [f"{event.time:.15g},{event.element},{event.transition}" for event in run.events]
    return "\n".join(["t [s],element,transition", *lines]) + "\n"


def events_sentence(run: Trajectory) -> str:
    """How many transitions an exact run has, element by element."""
    counts: dict[str, dict[str, int]] = {}
    for event in run.events:
        own = counts.setdefault(event.element, {})
        own[event.transition] = own.get(event.transition, 0) + 1
    parts = [
        f"{name} {', '.join(f'{word} {times}×' for word, times in own.items())}"
        for name, own in counts.items()
    ]
    total = len(run.events)
    head = f"{total} transition{'' if total == 1 else 's'} located"
    return "; ".join([head, *parts]) if parts else f"{head}: nothing sticks, slips or touches anew"


def output_times(
    model: Model, driven: Recording | None, end: float | None, step: float | None
) -> Array:
    """The output grid (N,) in s: from 0 to ``end``, or as the inputs were ``driven``, with rows
    every ``step``.

    Raises:
        InputError: times that make no run, or inputs that stop before ``end``.
    """
    if driven is None and end is None:
        text = "say when the simulation ends (--end, or end=), or give a recording of the inputs"
        raise InputError(Problem(text, file=model.file))
    first = 0.0 if driven is None else float(driven.t[0])
    last = float(driven.t[-1]) if driven is not None and end is None else float(end or 0.0)
    if driven is not None and last > driven.t[-1] + 1e-9:
        text = (
            f"the inputs stop at {driven.t[-1]:.6g} s, but the simulation is to end at "
            f"{last:.6g} s; shorten the simulation or give a longer input"
        )
        raise InputError(Problem(text, file=driven.name))
    if not np.isfinite(last) or last <= first:
        raise InputError(Problem(f"the end, {last:g} s, must come after the start, {first:g} s"))
    if step is None and driven is not None:
        return driven.t[driven.t <= last + 1e-9]
    step = (last - first) / 1000 if step is None else step
    if not np.isfinite(step) or not 0 < step <= last - first:
        length = f"the {last - first:g} s of the simulation"
        raise InputError(Problem(f"a step of {step:g} s does not fit into {length}"))
    if (last - first) / step > RUN_ROWS:
        raise InputError(Problem(f"a step of {step:g} s makes more than {RUN_ROWS:,} rows"))
    rows = int((last - first) / step + 1e-6) + 1
    return first + step * np.arange(rows, dtype=np.float64)

"""A run as a script asks for it: a model, how long, and what drives it, by name and in its units.

run = simulate(model, end=5, inputs={"f": lambda t: 2 * np.sin(t)}, start={"x": 0.1})
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from symhyb.asked import asked
from symhyb.data.known import require_known
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import given_motion
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.discrepancy.recorded.signals import driving
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.bare import bare
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array, on_lines
from symhyb.numeric.lowered.either import machine_of, model_of
from symhyb.numeric.lowered.known import machine_with
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import Trajectory
from symhyb.numeric.runs.scenario import Scenario
from symhyb.simulation import output_times, require_free, run_of


@asked
def simulate(
    model: Model | Machine,
    scenario: Scenario | Recording | None = None,
    p: Any = None,
    exact: bool = False,
    *,
    end: float | None = None,
    step: float | None = None,
    inputs: Mapping[str, Any] | None = None,
    start: Mapping[str, float] | None = None,
    parameters: Mapping[str, float] | None = None,
) -> Trajectory:
    """Simulate a model or its machine. A run that stops early says why in its ``reason``.

    Without a ``scenario`` the run goes from 0 to ``end`` with a row every ``step``, both in s
    (default: 1000 steps); with a recording it is driven by the recorded inputs, over its times
    unless ``end`` or ``step`` say otherwise, with the values of parameters that it knows.
    ``inputs`` by name are numbers, functions of the time in s, or values (N,) at the output times,
    0 where unset; ``start`` gives places and rates (``x``, ``x'``) instead of the declared ones,
    ``parameters`` values instead of those of the model: all in the units of the model file. A
    :class:`Scenario` says everything itself, in SI.
    ``p`` (P,), in SI, are all parameters of the machine at once. ``exact``: dry friction holds and
    stops touch, with located events.

    Raises:
        InputError: unknown names, times that make no run, inputs that stop before ``end``, imposed
            motion without a recording, or an exact run of a machine with constraints.
        ValueError: a scenario whose inputs stop before it does, or whose times do not increase.
    """
    if isinstance(scenario, Scenario):
        _require_alone(end=end, step=step, inputs=inputs, start=start)
        machine = _machine(model)
        return run_of(machine, scenario, _values(machine, p, parameters), exact)
    driven = scenario
    t = output_times(model_of(model), driven, end, step)
    if driven is None:
        machine, given = _machine(model), None
        require_free(machine.model)
        u = _driven(machine.model, t, inputs or {})
        t_u = t
    else:
        _require_alone(inputs=inputs)
        require_known(model_of(model), [driven])
        known = model_of(model)
        known = bare(known) if known.mujoco else known  # which MuJoCo itself runs
        machine = build(as_sampled(known, [driven]))
        machine = machine_with(machine, driven.parameters)
        t_u, u = driving(driven, machine)
        given = given_motion(driven, machine) if machine.imposed else None
        given = None if given is None else on_lines(driven.t, given, t_u)
    q, v = _start(machine.model, start or {})
    whole = Scenario(t, q, v, t_u, u, given=given)
    return run_of(machine, whole, _values(machine, p, parameters), exact)


def _machine(given: Model | Machine) -> Machine:
    """The machine, or that of a model: what acts beside MuJoCo where MuJoCo has it."""
    if isinstance(given, Model) and given.mujoco:
        return build(bare(given))
    return machine_of(given)


def _driven(model: Model, t: Array, inputs: Mapping[str, Any]) -> Array:
    """The inputs (N, k) at the output times, SI."""
    _require_names(inputs, [item.name for item in model.inputs], "inputs", "input")
    u = np.zeros((t.size, len(model.inputs)))
    problems = []
    for column, item in enumerate(model.inputs):
        given = inputs.get(item.name, 0.0)
        if callable(given):
            given = [given(time) for time in t.tolist()]
        try:
            values = np.asarray(given, dtype=np.float64)
            u[:, column] = values * item.unit.factor
            wrong = "" if np.isfinite(values).all() else "is not finite everywhere"
        except (TypeError, ValueError):
            shape = np.shape(given)
            wrong = (
                f"must be a number, a function of the time or {t.size} numbers, one an output time"
                + (f", not {shape}" if shape else f", not {type(given).__name__}")
            )
        if wrong:
            problems.append(Problem(wrong, f"inputs['{item.name}']", model.file))
    if problems:
        raise InputError(problems)
    return u


def _start(model: Model, start: Mapping[str, float]) -> tuple[Array, Array]:
    """Places and speeds (n,) at the start, SI."""
    q, v = (np.array(part, dtype=np.float64) for part in model.start())
    places = {item.name: (q, i, item) for i, item in enumerate(model.coordinates)}
    speeds = {f"{item.name}'": (v, i, item) for i, item in enumerate(model.coordinates)}
    known = {**places, **speeds}
    _require_names(start, list(known), "start", "coordinate or rate")
    for name, value in start.items():
        motion, i, item = known[name]
        motion[i] = _number(value, f"start['{name}']", model) * item.unit.factor
    return q, v


def _values(machine: Machine, p: Any, parameters: Mapping[str, float] | None) -> Array:
    """All parameters (P,), SI: ``p`` or the model's own, with ``parameters`` by path instead."""
    values = np.array(machine.values if p is None else p, dtype=np.float64)
    if values.shape != machine.values.shape:
        text = f"must be ({machine.values.size},), one value a parameter, not {values.shape}"
        raise InputError(Problem(text, "p", machine.model.file))
    declared = {item.path: item for item in machine.model.all_parameters()}
    _require_names(parameters or {}, list(declared), "parameters", "parameter")
    for path, value in (parameters or {}).items():
        number = _number(value, f"parameters['{path}']", machine.model)
        values[machine.column(path)] = number * declared[path].unit.factor
    return values


def _number(value: object, place: str, model: Model) -> float:
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        text = f"must be a number, not {type(value).__name__}"
        raise InputError(Problem(text, place, model.file)) from None
    if not np.isfinite(number):
        raise InputError(Problem(f"must be finite, not {number}", place, model.file))
    return number


def _require_names(given: Mapping[str, Any], known: list[str], where: str, what: str) -> None:
    problems = [
        Problem(f"'{name}' is no {what} of the model{did_you_mean(name, known)}", where)
        for name in given
        if name not in known
    ]
    if problems:
        raise InputError(problems)


def _require_alone(**given: object) -> None:
    """Refuse what a scenario or a recording says already."""
    said = [name for name, value in given.items() if value is not None]
    if said:
        text = f"the scenario says that itself; leave out {', '.join(said)}"
        raise InputError(Problem(text, "simulate"))

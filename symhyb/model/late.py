"""A sensor that shows what it measures through a first-order lag, as a state of the model.

    τ·z' = y − z        y is what the sensor measured, z what it measures now

So a sensor that lags is written with what a model file has: a state, and its time constant among
the parameters.
"""

from collections.abc import Sequence
from dataclasses import replace

from symhyb.model.expression import Expression, Name, parse_expression
from symhyb.model.read import parse_model
from symhyb.model.render import newline_of, parameter_lines, state_lines
from symhyb.model.scope import RATE, expression_faults, scope_of
from symhyb.model.source import scan
from symhyb.model.states import State
from symhyb.model.types import Model, Parameter, Sensor
from symhyb.model.write import text_of
from symhyb.units import parse_unit


def may_lag(model: Model, sensor: Sensor) -> bool:
    """Whether a state may follow what a sensor measures: no rate contains an acceleration or a
    reading of an instrument."""
    path = ("sensors", sensor.name, "measures")
    return not any(expression_faults(path, sensor.measures, scope_of(model), RATE, None))


def lag_name(model: Model, sensor: str) -> str:
    """The name of the parameter that would be the time constant of a sensor."""
    return _free(model, f"{sensor}_lag")


def with_lag(model: Model, sensors: Sequence[str], time_s: float, sd: float | None = None) -> Model:
    """Return a model in which these sensors lag by one time constant, s. Each may lag
    (:func:`may_lag`)."""
    time = _time(model, sensors, time_s, sd)
    states = tuple(_state(model, name, time.name) for name in sensors)
    late = {name: state.name for name, state in zip(sensors, states, strict=True)}
    shown = tuple(
        replace(item, measures=parse_expression(late[item.name])) if item.name in late else item
        for item in model.sensors
    )
    return replace(
        model,
        sensors=shown,
        states=(*model.states, *states),
        parameters=(*model.parameters, time),
    )


def written_with_lag(model: Model, sensor: str, time_s: float, sd: float | None) -> Model:
    """:func:`with_lag` of one sensor as a model file: its text changes in what the sensor measures,
    and state and time constant are appended.

    Raises:
        InputError: the sensor may not lag.
    """
    text = text_of(model)
    newline = newline_of(text)
    time = _time(model, (sensor,), time_s, sd)
    state = _state(model, sensor, time.name)
    stated = scan(text).entries[("sensors", sensor, "measures")]
    text = f'{text[: stated.start]}"{state.name}"{text[stated.end :]}'
    text += "" if text.endswith("\n") else newline
    lines = ("", *state_lines(state), "", *parameter_lines(time))
    return parse_model(text + "".join(line + newline for line in lines), model.file)


def _time(model: Model, sensors: Sequence[str], time_s: float, sd: float | None) -> Parameter:
    whose = f"the sensor{'s' if len(sensors) > 1 else ''} {' and '.join(sensors)}"
    about = f"time constant of the lag of {whose}"
    return Parameter(lag_name(model, sensors[0]), time_s, parse_unit("s"), sd, about)


def _state(model: Model, sensor: str, time: str) -> State:
    """The state that a sensor shows when it lags; a simulation begins with it where the coordinate
    that it measures does, else at 0."""
    item = model.sensors[sensor]
    name = _free(model, f"{sensor}_late")
    rate = parse_expression(f"({item.measures.text} - {name})/{time}")
    about = f"what the sensor {sensor} shows, behind its lag"
    return State(name, item.unit, rate, _start(model, item.measures, item), about)


def _start(model: Model, measures: Expression, item: Sensor) -> float:
    tree = measures.tree
    if not isinstance(tree, Name) or tree.order:
        return 0.0
    known = {one.name: one.start * one.unit.factor for one in model.coordinates}
    known |= {one.name: one.si_start for one in model.states}
    return known.get(tree.name, 0.0) / item.unit.factor


def _free(model: Model, name: str) -> str:
    """The name, or it with as many strokes as make it one that the model does not have."""
    while name in scope_of(model).units:
        name += "_"
    return name

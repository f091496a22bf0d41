"""A number or an input of a model times a factor that is an expression, wherever it is used.

    k  →  (k*curve(k_course, t))

So a number that changes with time stays an ordinary number beside a curve over the time.
"""

import re
from collections.abc import Iterable
from dataclasses import fields, is_dataclass, replace
from typing import Any

from symhyb.errors import InputError
from symhyb.model.curves import Curve
from symhyb.model.expression import Expression, names, parse_expression
from symhyb.model.maps import Map
from symhyb.model.quantities import beside_quantities
from symhyb.model.read import parse_model
from symhyb.model.render import curve_lines, newline_of, parameter_lines, render
from symhyb.model.source import Source, scan
from symhyb.model.types import Element, Model, On, Parameter
from symhyb.model.write import text_of

_SECTIONS = (
    "elements",
    "states",
    "points",
    "bodies",
    "energy",
    "gravity",
    "constraints",
    "sensors",
)
_WORDS = frozenset(
    {"kind", "about", "unit", "units", "over", "times", "side", "curve", "map", "file", "found"}
)
_DECLARED = (Parameter, Curve, Map)


def with_factor(
    model: Model,
    path: str,
    factor: str,
    parameters: Iterable[Parameter] = (),
    curves: Iterable[Curve] = (),
) -> Model:
    """Return a model in which a number, by its path, or an input acts times a ``factor``, which may
    use more ``parameters`` and ``curves``. What a sensor measures of an input stays the input.

    Raises:
        ExpressionError: a factor that is no expression.
    """
    owner, _, name = path.rpartition(".")
    changed: dict[str, Any] = {}
    for section in _sections(model, path):
        given = getattr(model, section)
        if section == "elements":
            changed[section] = tuple(
                _factored(item, name, factor) if _sees(item, owner, name) else item
                for item in given
            )
        else:
            changed[section] = _factored(given, name, factor)
    more = (*model.parameters, *parameters)
    return replace(model, **changed, parameters=more, curves=(*model.curves, *curves))


def shown_with_factor(
    model: Model, sensor: str, factor: str, parameters: Iterable[Parameter] = ()
) -> Model:
    """Return a model in which a sensor shows what it measures times a ``factor``, which may use
    more ``parameters``.

    Raises:
        ExpressionError: a factor that is no expression.
    """
    sensors = tuple(
        replace(item, measures=parse_expression(f"({item.measures.text})*{factor}"))
        if item.name == sensor
        else item
        for item in model.sensors
    )
    return replace(model, sensors=sensors, parameters=(*model.parameters, *parameters))


def written_with_factor(
    model: Model,
    path: str,
    factor: str,
    parameters: Iterable[Parameter] = (),
    curves: Iterable[Curve] = (),
) -> Model:
    """:func:`with_factor` as a model file: its text changes where the number is used, and the
    parameters and curves are appended.

    Raises:
        InputError: the model may not state this: an added mass, for example, is constant.
    """
    parameters, curves = tuple(parameters), tuple(curves)
    wanted = with_factor(model, path, factor, parameters, curves)
    text = text_of(model)
    newline = newline_of(text)
    for start, end, new in _edits(scan(text), model, path, factor):
        text = text[:start] + new + text[end:]
    lines = []
    for item in parameters:
        lines += ["", *parameter_lines(item)]
    for curve in curves:
        lines += ["", *curve_lines(curve)]
    text += "" if text.endswith("\n") else newline
    text += "".join(line + newline for line in lines)
    try:
        found = parse_model(text, model.file)
        if replace(found, text="") == replace(wanted, text=""):
            return found
    except InputError:
        pass  # a word that looks like the number: the whole file is written anew
    return parse_model(render(wanted), model.file)


def _sections(model: Model, path: str) -> tuple[str, ...]:
    """The sections in which a number is used, those of an element's own in elements alone."""
    if "." in path:
        return ("elements",)
    given = path in [item.name for item in model.inputs]
    return tuple(name for name in _SECTIONS if name != "sensors" or not given)


def _sees(element: Element, owner: str, name: str) -> bool:
    """Whether an element's expressions mean this number by its name."""
    own = name in [item.name for item in element.parameters]
    return element.name == owner if owner else not own


def _factored(value: Any, name: str, factor: str) -> Any:
    """A value of a model whose expressions have a name times a factor."""
    if isinstance(value, Expression):
        used = {one.name for one in names(value)}
        return parse_expression(_multiplied(value.text, name, factor)) if name in used else value
    if isinstance(value, On):
        return value if value.plain else On(_multiplied(value.coordinate, name, factor))
    if isinstance(value, tuple):
        return tuple(_factored(item, name, factor) for item in value)
    if not is_dataclass(value) or isinstance(value, (type, *_DECLARED)):
        return value
    inner = {one.name: _factored(getattr(value, one.name), name, factor) for one in fields(value)}
    return replace(value, **inner)


def _multiplied(text: str, name: str, factor: str) -> str:
    """A text in which a name, not its derivative, a function, a curve or a map, or a unit, has a
    factor."""
    meant = re.compile(rf"(?<![\w.])(?<!curve\()(?<!map\(){re.escape(name)}(?![\w'(])")
    return beside_quantities(text, lambda part: meant.sub(f"({name}*{factor})", part))


def _edits(source: Source, model: Model, path: str, factor: str) -> list[tuple[int, int, str]]:
    """What changes in a text, the last first."""
    owner, _, name = path.rpartition(".")
    seen = {item.name for item in model.elements if _sees(item, owner, name)}
    found = []
    for where, entry in source.entries.items():
        if where[0] not in _sections(model, path) or where[-1] in _WORDS or "parameters" in where:
            continue
        if where[0] == "elements" and (len(where) < 3 or where[1] not in seen):
            continue
        old = source.text[entry.start : entry.end]
        if old[:1] in ('"', "'", "["):
            new = _multiplied(old, name, factor)
            if new != old:
                found.append((entry.start, entry.end, new))
    return sorted(found, reverse=True)

"""A force written as a coefficient times a formula: the element, its units and its text.

Only for the last resort, a ``law``: what the vocabulary cannot name. The formula uses coordinates,
their rates, inputs and ``transition``, a speed over which dry friction is smoothed.
"""

from collections.abc import Mapping

from symhyb.model.expression import Name, parse_expression, unit_of
from symhyb.model.types import Element, Model, On, Parameter
from symhyb.model.vocabulary import force_unit, stretch_unit
from symhyb.units import Unit, parse_unit

LAW = "law"
SYMBOLS = {"coefficient": "c", "transition": "v_t"}  # letters of the numbers of a formula
WARNING = "an empirical term, not a law of physics that is known by name"


def law_element(
    model: Model,
    name: str,
    place: On,
    formula: str,
    values: Mapping[str, float],
    symbols: Mapping[str, str] | None = None,
    spreads: Mapping[str, float] | None = None,
) -> Element:
    """The element −coefficient·formula with ``values`` in SI by key (``coefficient``,
    ``transition``); ``symbols`` rename them, ``spreads`` are standard deviations in SI."""
    called = dict(symbols or {})
    own = []
    for key, value in values.items():
        unit = law_unit(model, place, formula, key)
        sd = (spreads or {}).get(key)
        own.append(
            Parameter(
                called.get(key, key),
                value / unit.factor,
                unit,
                None if sd is None else sd / unit.factor,
                owner=name,
            )
        )
    text = law_text(formula, called.get("coefficient", "coefficient"))
    if "transition" in values:
        text = text.replace("transition", called.get("transition", "transition"))
    key = "torque" if force_unit(model, place).text == "N*m" else "force"
    return Element(name, LAW, place, ((key, parse_expression(text)),), tuple(own))


def law_text(formula: str, coefficient: str = "coefficient") -> str:
    """The force of a formula as an expression of the model file; positive coefficients resist."""
    return f"-{coefficient}*{formula}"


def law_unit(model: Model, place: On, formula: str, key: str) -> Unit:
    """The unit of a key of a formula, coherent SI."""
    speed = stretch_unit(model, place) / parse_unit("s")
    if key == "transition":
        return speed
    units = {c.name: stretch_unit(model, On(c.name)) for c in model.coordinates}
    units |= {item.name: item.unit for item in model.inputs}
    units["transition"] = speed

    def unit_of_name(name: Name) -> Unit:
        return units[name.name] / parse_unit("s") ** name.order

    found = unit_of(parse_expression(formula), unit_of_name)
    return force_unit(model, place) / found if found is not None else force_unit(model, place)

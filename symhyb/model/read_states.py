"""Read [states]: quantities of first order, and those that are sampled and held."""

from symhyb.model.expression import ExpressionError, evaluate, names, unit_of
from symhyb.model.states import STILL, State
from symhyb.model.tables import Table
from symhyb.units import parse_unit

_KEYS = ("unit", "start", "rate", "every", "first", "next", "about")


def read_state(table: Table) -> State | None:
    """Read one state; None if it cannot be read."""
    table = table.checked(_KEYS)
    unit, start, about = table.unit(), table.number("start"), table.about()
    if not any(key in table.entries for key in ("next", "every", "first")):
        rate = table.expression("rate", required=True)
        if unit is None or rate is None:
            return None
        return State(table.path[-1], unit, rate, start or 0.0, about)
    if "rate" in table.entries:
        text = "a state that is sampled is held between its samples, and has no 'rate'"
        table.fault(f"{text}; leave out 'rate', or 'every', 'first' and 'next'", "rate")
        return None
    following, every = table.expression("next", required=True), _seconds(table, "every")
    first = _seconds(table, "first") if "first" in table.entries else 0.0
    if "every" not in table.entries:
        table.fault("'every' is missing: the time from sample to sample, as in every = \"10 ms\"")
    elif every is not None and every <= 0:
        table.fault(f"must be positive, not {every:g} s", "every")
        every = None
    if unit is None or following is None or every is None or first is None:
        return None
    name = table.path[-1]
    return State(name, unit, STILL, start or 0.0, about, every, first, following)


def _seconds(table: Table, key: str) -> float | None:
    """A time in s: a number, or one with its unit in place."""
    expression = table.expression(key)
    if expression is None:
        return None
    if not names(expression):
        try:
            unit = unit_of(expression, lambda _: parse_unit("s"))
            if unit is None or unit.same_dimension(parse_unit("s")) or unit.text == "1":
                return float(evaluate(expression.tree, {}))
        except ExpressionError:
            pass
    table.fault(f"must be a time, a number in s or as in \"10 ms\", not '{expression.text}'", key)
    return None

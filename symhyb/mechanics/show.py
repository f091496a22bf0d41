r"""The equations of motion of a model, written for people.

    M(q,t) q'' + k_c(q,q',t) = k_e(q,q',u,t)        one block a coordinate, one row a cause

The rows of one side add up. :mod:`symhyb.mechanics.readable` derives what is written here, and
:mod:`symhyb.mechanics.show_latex` writes it in LaTeX.
"""

import re
import textwrap
from collections.abc import Iterator, Sequence

import sympy as sp
from sympy.printing.str import StrPrinter

from symhyb.mechanics.readable import Readable, readable
from symhyb.mechanics.rows import Row, Side
from symhyb.mechanics.show_latex import as_latex
from symhyb.mechanics.tabulated import MappedBase, TabulatedBase
from symhyb.mechanics.words import (
    curves_in_words,
    maps_in_words,
    rates_title,
    reading_in_words,
    sensor_notes,
)
from symhyb.model.types import Model

WIDTH = 100  # columns of text
_SIDES: tuple[tuple[Side, str], ...] = (("M", "M q''"), ("k_c", "+ k_c"), ("k_e", "= k_e"))


def show_equations(model: Model, latex: bool = False, matrices: bool = False) -> str:
    """Write M q'' + k_c = k_e coordinate by coordinate, each summand with what it comes from.

    With ``matrices`` M, k_c and k_e entry by entry, each summed up. Text in the notation of the
    model file, or LaTeX (``align*`` of amsmath) with x, ẋ and ẍ. Below stand the rates of inner
    states, names for what several rows use, the parameters in their own units, and the sensors.
    """
    derived = readable(model, matrices)
    return as_latex(model, derived) if latex else _as_text(model, derived, matrices)


def text_of(expression: sp.Expr) -> str:
    """An expression in the notation of the model file."""
    return str(_Text({"full_prec": False}).doprint(expression))


class _Text(StrPrinter):  # type: ignore[misc]
    """SymPy's text in the notation of the model file: ``abs``, ``min`` and ``max``."""

    def _print_Abs(self, expression: sp.Abs) -> str:
        return self._called("abs", expression)

    def _print_Max(self, expression: sp.Max) -> str:
        return self._called("max", expression)

    def _print_Min(self, expression: sp.Min) -> str:
        return self._called("min", expression)

    def _print_Heaviside(self, expression: sp.Heaviside) -> str:
        return f"step({self.stringify(expression.args[:1], ', ')})"

    def _print_TabulatedBase(self, expression: TabulatedBase) -> str:
        name, marks = expression.called
        return f"curve{marks}({name}, {self.stringify(expression.args, ', ')})"

    def _print_MappedBase(self, expression: MappedBase) -> str:
        name, by = expression.called
        return f"map{by and '_'}{by}({name}, {self.stringify(expression.args, ', ')})"

    def _called(self, name: str, expression: sp.Expr) -> str:
        return f"{name}({self.stringify(expression.args, ', ')})"


def _as_text(model: Model, derived: Readable, matrices: bool) -> str:
    states = "q,q',z,u,t" if derived.inner else "q,q',u,t"
    result = [model.title, "", f"M(q,t) q'' + k_c(q,q',t) = k_e({states})        in SI units"]
    result += _matrices(model, derived) if matrices else _coordinates(model, derived)
    for title, block in (
        ("constraints, held by forces J^T lambda beside k_e, J the slopes by q", _held(derived)),
        ("declared states", _states(model)),
        (rates_title(model), _inner(derived)),
        ("sampled, and held in between", _sampled(derived)),
        ("with", _names(derived)),
        ("curves", _table(curves_in_words(model))),
        ("maps", _table(maps_in_words(model))),
        ("parameters", _parameters(model)),
        ("sensors", _sensors(model, derived)),
    ):
        rows = list(block)
        result += ["", title, *rows] if rows else []
    return "\n".join(row.rstrip() for row in result) + "\n"


def _coordinates(model: Model, derived: Readable) -> Iterator[str]:
    text = _Text({"full_prec": False}).doprint
    width = max((len(row.source) for row in derived.rows), default=0)
    for i, coordinate in enumerate(model.coordinates):
        about = f", {coordinate.about}" if coordinate.about else ""
        yield from ("", f"{coordinate.name} [{coordinate.unit}]{about}")
        for side, mark in _SIDES:
            for row in derived.of(side, i) or (Row(side, (i,), "", sp.Integer(0)),):
                yield from _wrapped(f"  {mark:<5}  {row.source:<{width}}  ", text(row.value))
                mark = ""
        if coordinate.imposed:
            reason = f"the motion of {coordinate.name} is given; this force is what it takes"
            name = f"reaction({coordinate.name})"
            yield f"         {'imposed':<{width}}  {name}: {reason}"


def _matrices(model: Model, derived: Readable) -> Iterator[str]:
    """Entries that are not zero; M is symmetric and shown on and above its diagonal."""
    text = _Text({"full_prec": False}).doprint
    names = [coordinate.name for coordinate in model.coordinates]
    sides: tuple[tuple[Side, str], ...] = (("M", ", symmetric"), ("k_c", ""), ("k_e", ""))
    for side, about in sides:
        yield from ("", f"{side}{about}; entries not shown are 0")
        rows = [row for row in derived.rows if row.side == side]
        labels = [f"[{', '.join(names[i] for i in row.of)}]" for row in rows]
        width = max(map(len, labels), default=0)
        for label, row in zip(labels, rows, strict=True):
            yield from _wrapped(f"  {label:<{width}}  ", text(row.value))
    for coordinate in model.coordinates:
        if coordinate.imposed:
            name = coordinate.name
            yield f"  imposed: the motion of {name} is given, and k_e lacks reaction({name})"


def _held(derived: Readable) -> Iterator[str]:
    text = _Text({"full_prec": False}).doprint
    for row in derived.gaps:
        speed = row.speed(derived.symbols)
        yield from _wrapped(f"  {row.label}: 0 = ", text(row.gap if speed is None else speed))


def _inner(derived: Readable) -> Iterator[str]:
    text = _Text({"full_prec": False}).doprint
    for symbol, rate in derived.inner:
        yield from _wrapped(f"  {symbol.name}' = ", text(rate))


def _sampled(derived: Readable) -> Iterator[str]:
    text = _Text({"full_prec": False}).doprint
    for symbol, after, every in derived.sampled:
        yield from _wrapped(f"  every {every:.10g} s  {symbol.name} becomes ", text(after))


def _states(model: Model) -> Iterator[str]:
    """Declared states with their starts."""
    return _table(
        [
            (item.name, f"[{item.unit}]", f"begins at {item.start:.10g}", item.about)
            for item in model.states
        ]
    )


def _names(derived: Readable) -> Iterator[str]:
    text = _Text({"full_prec": False}).doprint
    if any(item.kind == "slope" for item in derived.names):
        yield "  x(b)_q: the slope of x by q, x of the centre of the body b; y and angle likewise"
        yield "  x(b)''_M + x(b)''_c: the acceleration along x, first what goes with q''"
    if any(item.kind.startswith("turn") for item in derived.names):
        yield "  omega_x(b): the angular velocity of the body b about its own x axis, omega_x(b)_q'"
        yield "  its slope by q', omega_x(b)'_M + omega_x(b)'_c its rate, first what goes with q''"
    for item in derived.names:
        yield from _wrapped(f"  {item.symbol.name} = ", text(item.value))


def _wrapped(label: str, text: str) -> list[str]:
    """Break a long expression between its summands, below where it began."""
    whole = re.sub(r"\|(\w+) - (\w+)\|", "|\\1\N{NO-BREAK SPACE}-\N{NO-BREAK SPACE}\\2|", text)
    rows = textwrap.wrap(
        whole,
        max(WIDTH, len(label) + 40),
        initial_indent=label,
        break_on_hyphens=False,
        subsequent_indent=" " * len(label),
        break_long_words=False,
    )
    return [row.replace("\N{NO-BREAK SPACE}", " ") for row in rows]


def _parameters(model: Model) -> Iterator[str]:
    """Path, value with standard deviation, unit and meaning in columns."""
    return _table(
        [
            (
                item.path,
                f"{item.value:.10g}" + ("" if item.sd is None else f" ± {item.sd:.3g}"),
                "" if item.unit.text == "1" else item.unit.text,
                item.about,
            )
            for item in model.all_parameters()
        ]
    )


def _sensors(model: Model, derived: Readable) -> Iterator[str]:
    """What each sensor records, and the instruments among them in words."""
    text = _Text({"full_prec": False}).doprint
    table = [
        (f"{sensor.name} [{sensor.unit}]", f"= {text(output)}", *sensor_notes(sensor))
        for sensor, output in zip(model.sensors, derived.outputs, strict=True)
    ]
    yield from _table(table)
    held = [item.name for item in model.constraints]
    for reading in derived.readings:
        yield from _wrapped(f"  {reading}: ", reading_in_words(reading, held))


def _table(table: Sequence[tuple[str, ...]]) -> Iterator[str]:
    """Rows in columns; the last column is not padded."""
    columns = max(map(len, table), default=1) - 1
    widths = [max((len(row[i]) for row in table), default=0) for i in range(columns)]
    for *cells, last in table:
        row = (f"{cell:<{width}}" for cell, width in zip(cells, widths, strict=True))
        yield "  " + "  ".join((*row, last))

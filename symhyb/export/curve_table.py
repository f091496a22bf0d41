"""Laws of stretch or of rate as tables: what owners of tabulated dampers and bushings read in.

    F > 0 resists: it pulls back from a positive stretch, and brakes a positive rate

          F │        ●─── ● the law        between two rows a straight line: rows are added
            │     ●         until it misses the law by no more than a thousandth of the
       ─────●──────────▶ s  largest force
         ●  │

Laws at one place over one variable act side by side, so that one table holds their sum. Those of
stretch and rate together become a grid (:mod:`symhyb.export.map_table`).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.errors import InputError, Problem
from symhyb.export.map_table import ACCURACY, PLACES_FIRST, Law, MapTable, file_of, gridded
from symhyb.export.spec import chosen
from symhyb.laws.maths import NUMPY, Motion
from symhyb.model.expression import evaluate
from symhyb.model.scope import numbers_of
from symhyb.model.types import At, Element, Model, Place, place_text
from symhyb.model.vocabulary import KINDS, force_unit, stretch_unit
from symhyb.numeric.kernels.buffers import Array
from symhyb.units import parse_unit

ROWS_FIRST, ROWS_MOST = 33, 4000
OVER = ("stretch", "rate")
BOTH = "map"
_EACH = np.logspace(-6, 3, 19)
PROBES = np.concatenate([-_EACH[::-1], [0.0], _EACH])  # SI: where a law is asked what it follows
ELSE = "export an FMU (--to fmu)"

Span = tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class CurveTable:
    """The ``force`` (R,) over the stretch or the rate ``x`` (R,) at a place, SI, with their units,
    of some ``elements`` together."""

    place: Place
    over: str
    elements: tuple[str, ...]
    x: Array
    force: Array
    units: tuple[str, str]

    @property
    def file(self) -> str:
        """The name of its file: ``on-x-rate.csv``."""
        return file_of(self.place, self.over)

    def text(self) -> str:
        """Two columns under their names, with commas."""
        head = f"{self.over} [{self.units[0]}],force [{self.units[1]}]"
        rows = (f"{x:.9g},{y:.9g}" for x, y in zip(self.x, self.force, strict=True))
        return "\n".join((head, *rows)) + "\n"

    def said(self) -> str:
        """What it holds, for a person."""
        low, high = self.x[0], self.x[-1]
        return (
            f"{self.file}: force over {self.over} {place_text(self.place)} of "
            f"{' and '.join(self.elements)}, {self.x.size} rows from {low:.4g} to {high:.4g} "
            f"{self.units[0]}; F > 0 resists"
        )


def curve_tables(
    model: Model, elements: Sequence[str], spans: Mapping[str, Span]
) -> tuple[CurveTable | MapTable, ...]:
    """Tables of the named ``elements``, by default of those that a diagnosis found; ``spans`` are
    the ranges of stretch and of rate, SI, by default those of the points of own curves and maps.

    Raises:
        InputError: elements that are missing or are no function of stretch and rate, a range that
            is missing, all of them at once.
    """
    groups: dict[tuple[Place, str], list[tuple[Element, Law]]] = {}
    problems: list[Problem] = []
    for name in chosen(model, elements):
        element = next(one for one in model.elements if one.name == name)
        try:
            law = _law(model, element)
            groups.setdefault((element.place, _over(law)), []).append((element, law))
        except _NoTableError as error:
            problems.append(Problem(f"{error}; {ELSE}", f"elements.{name}", model.file))
    found: list[CurveTable | MapTable] = []
    for (place, over), members in groups.items():
        given = {one: spans.get(one) or _own_span(members, one) for one in _variables(over)}
        lacking = [f"--{one} LOW:HIGH" for one, span in given.items() if span is None]
        if lacking:
            names = " and ".join(element.name for element, _ in members)
            ranges = "ranges" if len(lacking) > 1 else "a range"
            text = f"a table of {names} needs {ranges}: {' and '.join(lacking)}, in SI"
            problems.append(Problem(text, f"elements.{members[0][0].name}", model.file))
            continue
        begun = [
            _begun(members, one, span, PLACES_FIRST if over == BOTH else ROWS_FIRST)
            for one, span in given.items()
            if span is not None
        ]
        if over == BOTH:
            found.append(_map(model, place, members, begun[0], begun[1]))
        else:
            found.append(_table(model, place, over, members, begun[0]))
    if problems:
        raise InputError(problems)
    return tuple(found)


def _variables(over: str) -> tuple[str, ...]:
    return OVER if over == BOTH else (over,)


def span_of(over: str, text: str) -> Span:
    """The range ``LOW:HIGH`` that a person gives of the stretch or the rate, SI.

    Raises:
        InputError: no two numbers, or not in their order.
    """
    try:
        low, high = map(float, text.split(":"))
    except ValueError:
        low = high = np.nan
    if not -np.inf < low < high < np.inf:
        raise InputError(Problem(f"--{over} is '{text}'; write LOW:HIGH in SI, such as -0.5:0.5"))
    return low, high


class _NoTableError(Exception):
    """A law that no table of two columns holds; the message says why."""


def _law(model: Model, element: Element) -> Law:
    """The force of an element, SI, as a function of stretch and rate."""
    kind = KINDS[element.kind]
    if kind.action is None or kind.energy == "active":
        raise _NoTableError(f"a '{element.kind}' is no law of stretch or rate")
    if kind.states:
        raise _NoTableError("it has an inner state, which remembers")
    if isinstance(element.place, At):
        raise _NoTableError("it acts at a point, along more than one direction")
    numbers = numbers_of(model, element)
    try:
        values: dict[str, object] = {
            key: float(evaluate(text, numbers, model.characteristics()))
            for key, text in element.values
        }
    except KeyError as error:
        text = f"its strength depends on {error}, which changes as the machine moves"
        raise _NoTableError(text) from None
    values |= element.given()
    act = kind.action

    def force(s: Array, r: Array) -> Array:
        action = act(NUMPY, Motion(s, r, (), 0.0), values, dict(element.options))
        return np.broadcast_to(np.asarray(action.force, dtype=np.float64), np.shape(s + r))

    return force


def _over(law: Law) -> str:
    """What a law follows: one variable, or both."""
    with np.errstate(all="ignore"):
        force = law(PROBES[:, None], PROBES[None, :])
    by_stretch = bool(np.any(force != force[:1]))
    by_rate = bool(np.any(force != force[:, :1]))
    if by_stretch and by_rate:
        return BOTH
    if not (by_stretch or by_rate):
        raise _NoTableError("it depends on neither stretch nor rate")
    return OVER[by_rate]


def _own_span(members: Sequence[tuple[Element, Law]], over: str) -> Span | None:
    """The range of the points of curves and maps along a variable; None where a law has none."""
    ends = [tuple(_points(element, over)) for element, _ in members]
    if not all(ends):
        return None
    return min(x[0] for x in ends), max(x[-1] for x in ends)


def _points(element: Element, over: str) -> Iterator[float]:
    """Where the points of curves and the places of a map along a variable lie, SI."""
    by_rate = dict(element.options).get("over") == "rate"
    for curve, along in ((element.curve, OVER[by_rate]), (element.by_stretch, "stretch")):
        if curve is not None and along == over:
            yield from (curve.units[0].factor * x for x, _ in curve.points)
    if element.map is not None:
        axis = OVER.index(over)
        places = (element.map.x, element.map.y)[axis]
        yield from (element.map.units[axis].factor * x for x in places)


def _begun(members: Sequence[tuple[Element, Law]], over: str, span: Span, first: int) -> Array:
    """Places of a table along a variable, SI: even ones, the origin, and those of the laws."""
    marks = [0.0, *(x for element, _ in members for x in _points(element, over))]
    return np.union1d(np.linspace(*span, first), [x for x in marks if span[0] < x < span[1]])


def _together(members: Sequence[tuple[Element, Law]]) -> Law:
    """The force of all elements, SI."""

    def force(s: Array, r: Array) -> Array:
        total: Array = sum((law(s, r) for _, law in members), np.zeros(np.shape(s + r)))
        return total

    return force


def _map(
    model: Model, place: Place, members: Sequence[tuple[Element, Law]], x: Array, y: Array
) -> MapTable:
    x, y, z, missed = gridded(_together(members), x, y)
    along, up = stretch_unit(model, place), force_unit(model, place)
    across = along / parse_unit("s")
    units = along.text, across.text, up.text
    names = tuple(element.name for element, _ in members)
    scaled = x / along.factor, y / across.factor, z / up.factor
    return MapTable(place, names, *scaled, units, missed)


def _table(
    model: Model, place: Place, over: str, members: Sequence[tuple[Element, Law]], x: Array
) -> CurveTable:
    both = _together(members)

    def force(x: Array) -> Array:
        still = np.zeros_like(x)
        return both(x, still) if over == "stretch" else both(still, x)

    x = _refined(force, x)
    along, up = stretch_unit(model, place), force_unit(model, place)
    along = along if over == "stretch" else along / parse_unit("s")
    units = (along.text, up.text)
    names = tuple(element.name for element, _ in members)
    return CurveTable(place, over, names, x / along.factor, force(x) / up.factor, units)


def _refined(force: Callable[[Array], Array], x: Array) -> Array:
    """The places ``x`` (R,), SI, and as many between them as straight lines need."""
    while x.size < ROWS_MOST:
        y, between = force(x), 0.5 * (x[:-1] + x[1:])
        missed = np.abs(force(between) - 0.5 * (y[:-1] + y[1:]))
        more = between[missed > ACCURACY * np.abs(y).max(initial=0.0)]
        if not more.size:
            break
        x = np.union1d(x, more)
    return x

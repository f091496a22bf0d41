"""What holds a closed loop together, and what rolls: conditions as the file says them.

A constraint is one or more expressions c(q, t) that are zero: the two components of b − a of a pin,
the deviation of a distance, of a point from a line, of one coordinate from what another makes it.
A nonholonomic one is a speed s(q, q', t), linear in the rates, that is zero: of a wheel or a ball
in space where it touches the ground.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from symhyb.model.expression import Expression


@dataclass(frozen=True, slots=True)
class ConstraintKind:
    """A kind of constraint: the keys under which it names places, with how many names each takes
    (1: a plain text) and in which section they are declared, then its keys with expressions; those
    in ``needs`` must be set; ``axes`` are keys that name an axis, with their defaults (empty: must
    be set)."""

    places: tuple[tuple[str, int], ...]
    section: str
    keys: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    axes: tuple[tuple[str, str], ...] = ()


CONSTRAINTS: Mapping[str, ConstraintKind] = {
    "pin": ConstraintKind((("points", 2),), "points"),
    "distance": ConstraintKind((("between", 2),), "points", ("length",), ("length",)),
    "slider": ConstraintKind((("point", 1), ("along", 2)), "points"),
    "gear": ConstraintKind((("on", 2),), "coordinates", ("ratio", "offset"), ("ratio",)),
    "rolling": ConstraintKind((("on", 2),), "coordinates", ("radius", "offset"), ("radius",)),
    "equation": ConstraintKind((), "", ("zero",), ("zero",)),
    "wheel": ConstraintKind(
        (("point", 1),), "points", ("radius", "height"), ("radius",), (("axle", ""), ("up", "z"))
    ),
    "ball": ConstraintKind(
        (("point", 1),), "points", ("radius", "height"), ("radius",), (("up", "z"),)
    ),
    "nonholonomic": ConstraintKind((), "", ("rate",), ("rate",)),
}
"""The kinds, in the order of the documentation."""


@dataclass(frozen=True, slots=True)
class Constraint:
    """One condition of ``kind``. ``names`` are the points or coordinates in the order of the kind's
    places (of a slider the point, then the two of the line), ``values`` its keys with expressions,
    ``axes`` those that name one of x, y and z.
    """

    name: str
    kind: str
    names: tuple[str, ...]
    values: tuple[tuple[str, Expression], ...] = ()
    about: str = ""
    axes: tuple[tuple[str, str], ...] = ()

    def value(self, key: str) -> Expression | None:
        """The expression under ``key``, or None where the file leaves it unset."""
        return dict(self.values).get(key)


@dataclass(frozen=True, slots=True)
class Assembly:
    """Where a model with constraints closes: places ``q`` and speeds ``v`` (n each, SI) near the
    start that the file states, the ``rows`` of constraints that are held, those that repeat others
    and are ``left_out`` (by label, ``rod`` or ``pin.x``), sentences on the ``moves`` of the start,
    and ``notes`` on what is left out."""

    q: tuple[float, ...]
    v: tuple[float, ...]
    rows: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    moves: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

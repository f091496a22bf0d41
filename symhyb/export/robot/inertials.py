"""Mass, centre and tensor of a link, written where a URDF or an MJCF has them.

Numbers that stay are left as they stand. A body of an MJCF without ``<inertial>`` takes its mass
from its shapes; it gets one, which counts in their stead, for a shape that is added could neither
take mass away nor have any tensor.
"""

from collections.abc import Sequence

import numpy as np

from symhyb.export.robot.spans import (
    Change,
    Span,
    comment,
    first_inside,
    last_inside,
    with_attributes,
)
from symhyb.imports.rigid import from_rpy, nearest_of_a_body
from symhyb.imports.robot import Array, Inertial, Link

NOTHING = Inertial(0.0, np.zeros(3), np.zeros((3, 3)))
SAME = 1e-12  # of the largest number of its kind: it is left as it stands
LEAST = 1e-11  # of the largest principal second moment: MuJoCo checks all digits of flat bodies
_URDF = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
_MJCF = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_TURNED = ("quat", "axisangle", "xyaxes", "zaxis", "euler")


def number(value: float) -> str:
    """A number in the digits that a file needs to be read back as it is."""
    return f"{value + 0.0:.13g}"  # no -0


def said(link: Link, new: Inertial) -> str:
    """What a link gets, in words."""
    old = link.inertial or NOTHING
    changed = [f"mass {new.mass:.6g} kg (before {old.mass:.6g})"] * (old.mass != new.mass)
    changed += ["its centre"] * (not _same(old.centre, new.centre))
    changed += ["its inertia"] * (not _same(old.tensor, new.tensor, _size(new)))
    return ", ".join(changed)


def of_urdf(text: str, span: Span, link: Link, new: Inertial) -> list[Change]:
    """The changes that give a ``<link>`` an inertial."""
    inner = span.first("inertial")
    if inner is None:
        return first_inside(text, span, _inertial(new))
    old = link.inertial or NOTHING
    origin, mass, inertia = (inner.first(tag) for tag in ("origin", "mass", "inertia"))
    rpy = "0 0 0" if origin is None else origin.attributes.get("rpy", "0 0 0")
    turned = from_rpy([float(part) for part in rpy.split()])
    was, now = (turned.T @ one.tensor @ turned for one in (old, new))
    stands = {} if inertia is None else inertia.attributes  # what was repaired is otherwise there
    tensor = {
        key: number(now[at])
        for key, at in _URDF.items()
        if key not in stands or not _same(float(stands[key]), now[at], _size(new))
    }
    place = {} if _same(old.centre, new.centre) else {"xyz": _row(new.centre)}
    weight = {} if _same(old.mass, new.mass) else {"value": number(new.mass)}
    tensor = {} if _same(was, now, _size(new)) else tensor
    changes: list[Change] = []
    lines: list[str] = []
    for tag, there, wanted in (
        ("origin", origin, place),
        ("mass", mass, weight),
        ("inertia", inertia, tensor),
    ):
        if wanted and there is not None:
            changes.append(with_attributes(text, there, wanted))
        elif wanted:
            attributes = " ".join(f'{key}="{value}"' for key, value in wanted.items())
            lines.append(f"<{tag} {attributes}/>")
    return [*changes, *last_inside(text, inner, lines)]


def _inertial(new: Inertial) -> tuple[str, ...]:
    """The lines of an element of a URDF."""
    tensor = " ".join(f'{key}="{number(new.tensor[at])}"' for key, at in _URDF.items())
    return (
        "<inertial>",
        f'  <origin xyz="{_row(new.centre)}"/>',
        f'  <mass value="{number(new.mass)}"/>',
        f"  <inertia {tensor}/>",
        "</inertial>",
    )


def of_mjcf(text: str, span: Span, link: Link, new: Inertial) -> list[Change]:
    """The changes that give a ``<body>`` an inertial."""
    inner = span.first("inertial")
    centre = new.centre - np.array(link.origin)
    tensor = nearest_of_a_body(new.tensor, LEAST)
    mixed = [number(tensor[at]) for at in _MJCF]
    straight = not np.abs([tensor[at] for at in _MJCF[3:]]).max() > SAME * np.abs(tensor).max()
    if inner is None:
        kind, entries = ("diaginertia", mixed[:3]) if straight else ("fullinertia", mixed)
        mass, at = number(new.mass), _row(centre)
        line = f'<inertial pos="{at}" mass="{mass}" {kind}="{" ".join(entries)}"/>'
        head = comment("by symhyb: this counts, and what the shapes of this body weigh does not")
        return first_inside(text, span, [head, line] if link.inertial is not None else [line])
    old = link.inertial or NOTHING
    wanted: dict[str, str] = {}
    without: Sequence[str] = ()
    if not _same(old.centre, new.centre):
        wanted["pos"] = _row(centre)
    if not _same(old.mass, new.mass):
        wanted["mass"] = number(new.mass)
    if not _same(old.tensor, new.tensor, _size(new)):
        plain = straight and "fullinertia" not in inner.attributes
        if plain and not any(key in inner.attributes for key in _TURNED):
            wanted["diaginertia"] = " ".join(mixed[:3])
        else:
            wanted["fullinertia"] = " ".join(mixed)
            without = ("diaginertia", *_TURNED)
    return [with_attributes(text, inner, wanted, without)] if wanted else []


def stated_count(text: str, root: Span) -> list[Change]:
    """The changes by which an MJCF takes what ``<inertial>`` states before what shapes weigh."""
    return [
        with_attributes(text, span, {"inertiafromgeom": "auto"})
        for span in root.every("compiler")
        if span.attributes.get("inertiafromgeom") == "true"
    ]


def _row(values: Array) -> str:
    return " ".join(number(value) for value in values)


def _size(new: Inertial) -> float:
    """What rounding of a tensor is relative to."""
    return float(np.abs(new.tensor).max() + new.mass * (new.centre @ new.centre))


def _same(one: Array | float, other: Array | float, size: float = 0.0) -> bool:
    largest = max(float(np.max(np.abs(one))), float(np.max(np.abs(other))), size)
    return bool(np.max(np.abs(np.subtract(one, other))) <= SAME * largest)

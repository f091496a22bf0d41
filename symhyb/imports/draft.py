"""What is declared so far of a model: numbers as parameters, and the names of joints and links."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from symhyb.imports.names import stems
from symhyb.imports.reduction import Moved
from symhyb.imports.rigid import right_angles
from symhyb.model.constraints import Constraint
from symhyb.model.limits import Limit
from symhyb.model.types import Body, Coordinate, Element, Input, Parameter, Point, Sensor
from symhyb.units import parse_unit

AXES = "xyz"
_JOINT = (
    *("", "_torque", "_force", "_rate", "_motor", "_damping", "_friction", "_ratio", "_offset"),
    *("_rotor", "_spring", "_rest"),
    *("_ox", "_oy", "_oz", "_roll", "_pitch", "_yaw", "_turn", "_tilt"),
    *("_dx", "_dy", "_dz", "_ex", "_ey", "_ez"),
    *("_x", "_y", "_z", "_angle", "_qw", "_qx", "_qy", "_qz"),
)
_TIP = ("", "_x", "_y", "_z")
_ENDS = ("_a", "_b")  # of a pin
_HELD = ("", *(end + part for end in _ENDS for part in _TIP), *(f"_c{k}" for k in range(5)), "_at")
_LINK = ("_m", "_cx", "_cy", "_cz", "_J", "_Jxx", "_Jyy", "_Jzz", "_Jxy", "_Jxz", "_Jyz")


@dataclass(frozen=True, slots=True)
class Names:
    """The names that the joints that move, the bodies, their points and the constraints have in the
    model file."""

    joints: Mapping[str, str]
    links: Mapping[str, str]
    points: Mapping[str, str] = field(default_factory=dict)
    held: Mapping[str, str] = field(default_factory=dict)

    @property
    def changed(self) -> Iterator[tuple[str, str, str]]:
        """What is called otherwise than in the file of the robot: kind, name there, name here."""
        kinds = (("joint", self.joints), ("link", self.links), ("point", self.points))
        for kind, names in kinds:
            yield from ((kind, old, new) for old, new in names.items() if old != new)


@dataclass(frozen=True, slots=True)
class Draft:
    """What is declared so far, with the ``names`` to use; ``units`` are those of joints with one
    coordinate, by their names in the file of the robot."""

    names: Names
    units: Mapping[str, str] = field(default_factory=dict)
    coordinates: list[Coordinate] = field(default_factory=list)
    parameters: list[Parameter] = field(default_factory=list)
    inputs: list[Input] = field(default_factory=list)
    points: list[Point] = field(default_factory=list)
    bodies: list[Body] = field(default_factory=list)
    elements: list[Element] = field(default_factory=list)
    sensors: list[Sensor] = field(default_factory=list)
    limits: list[Limit] = field(default_factory=list)
    constraints: list[Constraint] = field(default_factory=list)

    def number(self, name: str, value: float, unit: str, about: str) -> str:
        """Declare a parameter and return its name; of 0 it is plain 0."""
        if value == 0:
            return "0"
        self.parameters.append(Parameter(name, float(value), parse_unit(unit), about=about))
        return name

    def angle(self, name: str, value: float, about: str) -> str:
        """Declare an angle and return its name; right angles are written as they are."""
        count = right_angles(value)
        if count is None:
            return self.number(name, value, "rad", about)
        return {-1: "-pi/2", 0: "0", 1: "pi/2", 2: "pi"}[(count + 1) % 4 - 1]


def drafted(bodies: Sequence[Moved], held: Iterable[str] = ()) -> Draft:
    """A draft of a model with these bodies and names of what holds them, in which nothing is
    declared but names."""
    taken = {"g", "g_x", "g_y", "g_z"}
    joints = stems([body.joint.name for body in bodies], _JOINT, taken, "joint")
    links = stems([body.name for body in bodies], _LINK, taken, "link")
    taken.update(links.values())
    points = stems([tip.name for body in bodies for tip in body.tips], _TIP, taken, "link")
    names = Names(joints, links, points, stems(held, _HELD, taken, "loop"))
    return Draft(names, {body.joint.name: unit_of(body) for body in bodies})


def unit_of(body: Moved) -> str:
    """The unit of the position of a joint with one coordinate."""
    return "m" if body.joint.kind == "prismatic" else "rad"

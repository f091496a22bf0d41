"""The closed vocabulary of elements: kinds of force laws, their keys, units, energy and words.

The same table serves people who write a model and the diagnosis that looks for what is missing.
With s the stretch of a place and s' its rate, *passive* kinds resist,

    Q = −(∂s/∂q)ᵀ F(s, s')        a tension pulls:   a o──▶ F    F ◀──o b

and *active* kinds push: Q = +F on a coordinate, a tension between two points, a vector at a point.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from symhyb.model.scope import scope_of, unit_in
from symhyb.model.types import At, Between, Model, On, Place
from symhyb.units import ONE, Unit, parse_unit

Energy = Literal["conservative", "dissipative", "active"]
Placement = Literal["on", "between", "at"]
STRETCHED: tuple[Placement, ...] = ("on", "between")
ANYWHERE: tuple[Placement, ...] = ("on", "between", "at")


@dataclass(frozen=True, slots=True)
class Key:
    """One entry of a kind: a coefficient or an expression with its unit and default.

    The unit is [force]^``force`` · [stretch]^``stretch`` · s^``time`` at the place. ``default`` is
    the expression of an unset key: a number, another key, or None where unset has its own meaning
    (said in ``about``). ``placements``: where the key may be written. ``signal`` marks the
    expression of a force, which may use the motion, where other keys are coefficients. ``choices``
    are the words of a key that takes one of them. A ``vector`` is a list of two at a point.
    ``exponent`` names the key whose value n multiplies the power of [stretch].
    """

    name: str
    force: int
    stretch: int
    time: int
    default: str | None = "0"
    about: str = ""
    placements: tuple[Placement, ...] = ANYWHERE
    signal: bool = False
    choices: tuple[str, ...] = ()
    vector: bool = False
    exponent: str = ""


@dataclass(frozen=True, slots=True)
class Kind:
    """A force law. ``law`` is F for people, ``words`` name the physics, ``strengths`` are the keys
    of which at least one must be set (exactly one where they are signals), ``needs`` the keys that
    have no sensible default. ``state`` is the law of its inner state z, empty without one."""

    name: str
    keys: tuple[Key, ...]
    energy: Energy
    words: str
    law: str
    strengths: tuple[str, ...]
    placements: tuple[Placement, ...] = STRETCHED
    needs: tuple[str, ...] = ()
    state: str = ""

    @property
    def passive(self) -> bool:
        """Whether the force resists (Q = −(∂s/∂q)ᵀF) instead of pushing."""
        return self.energy != "active"

    def key(self, name: str) -> Key | None:
        """The key of that name, None if the kind has no such key."""
        return next((key for key in self.keys if key.name == name), None)


_LENGTH = Key("length", 0, 1, 0, "0", "stretch is counted from this distance", ("between",))
_ASYMMETRY = Key("asymmetry", 0, 0, 0, "0", "F is multiplied by 1 + asymmetry*sgn(s')", STRETCHED)
_FORCE = Key(
    "force", 1, 0, 0, None, "what acts; at a point a list [Fx, Fy]", ("on", "at"), True, vector=True
)
_TORQUE = Key("torque", 1, 0, 0, None, "what acts on an angle", ("on",), True)
_TENSION = Key("tension", 1, 0, 0, None, "pulls the two points together", ("between",), True)
_LEVELS = (
    Key("coulomb", 1, 0, 0),
    Key("static", 1, 0, 0, "coulomb", "breakaway level"),
    Key("stribeck", 0, 1, -1, None, "speed at which static falls to coulomb"),
)
_PHASE = Key("phase", 0, 0, 0, "0", "rad; of a found one, for each recording")

_ALL = (
    Kind(
        "spring",
        (
            Key("stiffness", 1, -1, 0),
            Key("quadratic", 1, -2, 0),
            Key("cubic", 1, -3, 0),
            _LENGTH,
        ),
        "conservative",
        "a spring",
        "stiffness*s + quadratic*s^2 + cubic*s^3",
        ("stiffness", "quadratic", "cubic"),
    ),
    Kind(
        "damper",
        (Key("damping", 1, -1, 1), _ASYMMETRY, _LENGTH),
        "dissipative",
        "viscous damping",
        "damping*s'",
        ("damping",),
        ANYWHERE,
    ),
    Kind(
        "drag",
        (Key("drag", 1, -2, 2), _LENGTH),
        "dissipative",
        "drag quadratic in speed",
        "drag*abs(s')*s'",
        ("drag",),
        ANYWHERE,
    ),
    Kind(
        "friction",
        (
            *_LEVELS,
            Key("transition", 0, 1, -1, None, "unset: 1e-4 of the scale of the speed"),
            _ASYMMETRY,
            _LENGTH,
        ),
        "dissipative",
        "dry (Coulomb) friction",
        "g*tanh(s'/transition), g = coulomb + (static - coulomb)*exp(-(s'/stribeck)^2)",
        ("coulomb", "static"),
        ANYWHERE,
    ),
    Kind(
        "gap",
        (
            Key("stiffness", 1, -1, 0),
            Key("clearance", 0, 1, 0, "0", "free travel to each side that has a stop"),
            Key("damping", 1, -1, 1, "0", "acts in contact only and never pulls"),
            Key(
                "side", 0, 0, 0, "both", "which stops there are", choices=("upper", "lower", "both")
            ),
            _LENGTH,
        ),
        "dissipative",
        "an elastic stop behind a clearance",
        "stiffness*max(s - clearance, 0) + stiffness*min(s + clearance, 0)",
        ("stiffness",),
    ),
    Kind(
        "hysteresis",
        (
            Key("stiffness", 1, -1, 0),
            Key("beta", 0, -1, 0, exponent="exponent"),
            Key("gamma", 0, -1, 0, exponent="exponent"),
            Key("exponent", 0, 0, 0, "1", "n, at least 1"),
            Key("play", 0, 1, 0, "0", "free travel in series with the spring"),
            _LENGTH,
        ),
        "dissipative",
        "hysteresis (Bouc-Wen)",
        "stiffness*dead(z, play)",
        ("stiffness",),
        state="z' = s' - beta*abs(s')*abs(z)^(n-1)*z - gamma*s'*abs(z)^n",
    ),
    Kind(
        "friction_dynamic",
        (*_LEVELS, Key("stiffness", 1, -1, 0), Key("micro_damping", 1, -1, 1), _LENGTH),
        "dissipative",
        "dry friction with elastic pre-sliding (LuGre)",
        "stiffness*z + micro_damping*z'",
        ("coulomb", "static"),
        needs=("coulomb", "stiffness"),
        state="z' = s' - stiffness*abs(s')*z/g, g as of friction",
    ),
    Kind(
        "relaxation",
        (Key("stiffness", 1, -1, 0), Key("damping", 1, -1, 1), _LENGTH),
        "dissipative",
        "a spring that relaxes (Maxwell)",
        "stiffness*(s - z)",
        ("stiffness",),
        needs=("damping",),
        state="z' = (s - z)*stiffness/damping",
    ),
    Kind(
        "constant",
        (Key("constant", 1, 0, 0, vector=True), _LENGTH),
        "active",
        "a constant force",
        "constant",
        ("constant",),
        ANYWHERE,
    ),
    Kind(
        "harmonic",
        (
            Key("amplitude", 1, 0, 0, vector=True),
            Key("frequency", 0, 0, -1, None),
            _PHASE,
            _LENGTH,
        ),
        "active",
        "a harmonic force",
        "amplitude*sin(2*pi*frequency*t + phase)",
        ("amplitude",),
        ANYWHERE,
        needs=("frequency",),
    ),
    Kind(
        "ripple",
        (Key("amplitude", 1, 0, 0), Key("period", 0, 1, 0, None), _PHASE, _LENGTH),
        "active",
        "a force periodic in position",
        "amplitude*sin(2*pi*s/period + phase)",
        ("amplitude",),
        needs=("period",),
    ),
    Kind(
        "added_mass",
        (Key("mass", 1, -1, 2), _LENGTH),
        "conservative",
        "added mass",
        "mass*s''",
        ("mass",),
        ANYWHERE,
    ),
    Kind(
        "force",
        (_FORCE, _TENSION),
        "active",
        "an applied force",
        "force",
        ("force", "tension"),
        ANYWHERE,
    ),
    Kind("torque", (_TORQUE,), "active", "an applied torque", "torque", ("torque",), ("on",)),
    Kind(
        "law",
        (_FORCE, _TORQUE, _TENSION),
        "active",
        "a force given by an expression",
        "force, torque or tension as written",
        ("force", "torque", "tension"),
        ANYWHERE,
    ),
    Kind("network", (_LENGTH,), "active", "a trained force", "network(inputs)", ()),
)
KINDS: Mapping[str, Kind] = {kind.name: kind for kind in _ALL}


_INERTIA = {"N": "kg", "N*m": "kg*m^2"}


def placement_of(place: Place) -> Placement:
    """Return the key under which the file writes this kind of place."""
    match place:
        case On():
            return "on"
        case Between():
            return "between"
        case At():
            return "at"


def stretch_unit(model: Model, place: Place) -> Unit:
    """Return the unit of s: m along any length, rad on any angle, else the coordinate's own (V).

    An expression of angles that has no dimension is an angle: ``phi - ratio*psi``.

    Raises:
        LookupError: a place on unknown names, or of units that do not fit.
    """
    if not isinstance(place, On):
        return parse_unit("m")
    units = {c.name: c.unit for c in model.coordinates}
    scope = scope_of(model)
    unit = units[place.coordinate] if place.plain else unit_in(place.expression, scope)
    if unit is None or place.names & scope.inputs:
        raise LookupError(place.coordinate)
    angles = any(units[name].is_angle for name in place.names & units.keys())
    if unit.is_number and angles:
        return parse_unit("rad")
    return parse_unit("m") if unit.same_dimension(parse_unit("m")) else unit


def force_unit(model: Model, place: Place) -> Unit:
    """Return the unit of F: N along a length, N*m on an angle, else energy over coordinate."""
    stretch = stretch_unit(model, place)
    if stretch.text == "m":
        return parse_unit("N")
    if stretch.text == "rad":
        return parse_unit("N*m")
    return model.energy_unit / stretch


def key_unit(
    model: Model, element_kind: str, key: str, place: Place, exponent: float = 1.0
) -> Unit:
    """Return the unit that a key of a kind has at a place, as readable text (``N*s^2/m^2``).

    ``force.x`` and ``force.y`` are components of a force at a point (in space a torque may stand
    there too); ``exponent`` is the n of a hysteresis, on which the units of its beta and gamma
    depend: no unit has finer powers than twelfths, so an n between them (1.37) takes the nearest,
    and the number counts in SI.

    Raises:
        KeyError: an unknown kind or key.
    """
    declared = KINDS[element_kind].key(key.split(".")[0])
    if declared is None:
        raise KeyError(f"{element_kind} has no key '{key}'")
    force, stretch = force_unit(model, place), stretch_unit(model, place)
    if element_kind == "torque" and isinstance(place, At):
        return parse_unit("N*m")
    if (element_kind, declared.name) == ("added_mass", "mass") and force.text in _INERTIA:
        return parse_unit(_INERTIA[force.text])
    n = Fraction(exponent).limit_denominator(12) if declared.exponent else Fraction(1)
    along = declared.stretch * n
    parts = ((force, declared.force), (parse_unit("s"), declared.time), (stretch, along))
    unit = ONE
    for part, power in parts:
        unit = unit * part**power
    return unit

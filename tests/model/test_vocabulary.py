"""The vocabulary: units of every key at every kind of place."""

import pytest

from symhyb.model.types import At, Between, Coordinate, Model, On, Place
from symhyb.model.vocabulary import KINDS, force_unit, key_unit, stretch_unit
from symhyb.units import parse_unit

MODEL = Model(
    "",
    (
        Coordinate("x", parse_unit("mm")),
        Coordinate("phi", parse_unit("deg")),
    ),
    energy_unit=parse_unit("J"),
)
VOLTS = Model("", (Coordinate("y", parse_unit("V")),), energy_unit=parse_unit("V^2"))
SPAN = Between("a", "b")


@pytest.mark.parametrize(
    ("kind", "key", "place", "text"),
    [
        ("spring", "stiffness", On("x"), "N/m"),
        ("spring", "quadratic", On("x"), "N/m^2"),
        ("spring", "cubic", SPAN, "N/m^3"),
        ("spring", "length", SPAN, "m"),
        ("spring", "stiffness", On("phi"), "N*m/rad"),
        ("damper", "damping", On("x"), "N*s/m"),
        ("damper", "damping", On("phi"), "N*m*s/rad"),
        ("damper", "asymmetry", On("x"), "1"),
        ("drag", "drag", On("x"), "N*s^2/m^2"),
        ("drag", "drag", On("phi"), "N*m*s^2/rad^2"),
        ("friction", "coulomb", On("phi"), "N*m"),
        ("friction", "static", SPAN, "N"),
        ("friction", "stribeck", On("x"), "m/s"),
        ("friction", "transition", On("phi"), "rad/s"),
        ("constant", "constant", On("x"), "N"),
        ("law", "tension", SPAN, "N"),
        ("force", "force.x", At("a"), "N"),
        ("torque", "torque", On("phi"), "N*m"),
        ("damper", "damping", At("a"), "N*s/m"),
        ("friction", "coulomb", At("a"), "N"),
        ("gap", "clearance", On("x"), "m"),
        ("gap", "damping", On("phi"), "N*m*s/rad"),
        ("hysteresis", "beta", On("x"), "1/m"),
        ("hysteresis", "play", SPAN, "m"),
        ("friction_dynamic", "stiffness", On("x"), "N/m"),
        ("friction_dynamic", "micro_damping", On("phi"), "N*m*s/rad"),
        ("relaxation", "damping", SPAN, "N*s/m"),
        ("constant", "constant.x", At("a"), "N"),
        ("harmonic", "amplitude.y", At("a"), "N"),
        ("harmonic", "amplitude", On("phi"), "N*m"),
        ("harmonic", "frequency", On("x"), "1/s"),
        ("ripple", "period", On("phi"), "rad"),
        ("ripple", "phase", On("x"), "1"),
        ("added_mass", "mass", On("x"), "kg"),
        ("added_mass", "mass", On("phi"), "kg*m^2"),
        ("added_mass", "length", SPAN, "m"),
        ("network", "length", SPAN, "m"),
    ],
)
def test_unit_of_a_key(kind: str, key: str, place: Place, text: str) -> None:
    unit = key_unit(MODEL, kind, key, place)
    assert unit.text == text
    assert unit.factor == 1.0


def test_other_coordinates_take_energy_over_coordinate() -> None:
    place = On("y")
    assert stretch_unit(VOLTS, place).text == "V"
    assert force_unit(VOLTS, place).text == "V"
    assert key_unit(VOLTS, "spring", "cubic", place).text == "1/V^2"
    assert key_unit(VOLTS, "damper", "damping", place).text == "s"
    assert key_unit(VOLTS, "friction", "transition", place).text == "V/s"
    assert key_unit(VOLTS, "added_mass", "mass", place).text == "s^2"


@pytest.mark.parametrize(("n", "text"), [(1.0, "1/m"), (2.0, "1/m^2"), (1.5, "1/m^(3/2)")])
def test_the_exponent_of_a_hysteresis_sets_units(n: float, text: str) -> None:
    for key in ("beta", "gamma"):
        unit = key_unit(MODEL, "hysteresis", key, On("x"), n)
        assert unit.text == text
        assert parse_unit(text).same_dimension(unit)
    assert key_unit(MODEL, "hysteresis", "stiffness", On("x"), n).text == "N/m"


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda kind: kind.name)
def test_every_kind_is_complete(kind) -> None:  # type: ignore[no-untyped-def]
    assert kind.words
    assert kind.law
    assert kind.strengths or kind.name in ("curve", "map", "network")
    assert all(kind.key(name) is not None for name in (*kind.strengths, *kind.needs))
    law = ", ".join([kind.law, *(state.text for state in kind.states)]).replace("^n", "exponent")
    if "g as of friction" in law:
        law += KINDS["friction"].law
    for key in kind.keys:
        if kind.name not in ("force", "torque", "law"):
            said = key.about or key.name == "length"
            assert key.name in law or said
        assert set(key.placements) & set(kind.placements)
        if key.default not in (None, "0", "1", *key.choices):
            assert kind.key(str(key.default)) is not None
        if key.exponent:
            assert kind.key(key.exponent) is not None
    remembers = {
        "hysteresis": 1,
        "friction_dynamic": 1,
        "relaxation": 1,
        "mode": 2,
        "hydromount": 2,
    }
    assert len(kind.states) == remembers.get(kind.name, 0)


def test_energy_says_whether_a_kind_resists() -> None:
    passive = {name for name, kind in KINDS.items() if kind.passive}
    assert set(KINDS) - passive == {
        "circulatory",
        "constant",
        "flow_drag",
        "flow_lift",
        "harmonic",
        "ripple",
        "force",
        "torque",
        "law",
        "network",
    }
    assert KINDS["spring"].energy == "conservative"
    assert KINDS["drag"].energy == "dissipative"


def test_an_unknown_key_is_a_key_error() -> None:
    with pytest.raises(KeyError, match="has no key 'mass'"):
        key_unit(MODEL, "spring", "mass", On("x"))

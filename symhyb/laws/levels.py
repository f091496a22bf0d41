"""The level of dry friction, N, with what it grows with:

g = coulomb + (static − coulomb)·exp(−(s'/stribeck)²) + load_coefficient·|load|
"""

from symhyb.laws.base import Key
from symhyb.laws.maths import Maths, Value, Values
from symhyb.laws.phrases import Numbers

LEVEL = "g = coulomb + (static - coulomb)*exp(-(s'/stribeck)^2)"
WIDER = 10.0  # a Stribeck speed against the transition: slower, it would only undo the smoothing

COULOMB = Key("coulomb", 1, 0, 0, lower=0.0, symbol="F_c")
STATIC = Key(
    "static", 1, 0, 0, "coulomb", "breakaway level", symbol="F_s", label="breakaway friction"
)
STRIBECK = Key(
    "stribeck",
    0,
    1,
    -1,
    None,
    "speed at which static falls to coulomb",
    above=("transition", WIDER),
    divides=True,
    symbol="v_s",
    label="Stribeck speed",
)
LOAD = Key(
    "load",
    1,
    0,
    0,
    "0",
    "the force that presses: any expression in positions, speeds, inputs and time",
    signal=True,
)
LOAD_COEFFICIENT = Key(
    "load_coefficient",
    0,
    0,
    0,
    "0",
    "part of the size of the load that friction grows by",
    lower=0.0,
    symbol="mu",
    noun="friction by load",
    label="coefficient of the load",
)


def friction_level(m: Maths, rate: Value, values: Values) -> Value:
    """g at a ``rate``, N."""
    level = coulomb = values.get("coulomb", 0)
    if "static" in values and "stribeck" in values:
        level += (values["static"] - coulomb) * m.exp(-((rate / values["stribeck"]) ** 2))
    if "load" in values and "load_coefficient" in values:
        level += values["load_coefficient"] * m.abs(values["load"])
    return level


def level_phrase(n: Numbers) -> tuple[str, tuple[str, ...]]:
    """The breakaway level and the speed at which it is gone, with the keys they use."""
    parts = [f"{n.amount('static')} at breakaway"] if "static" in n else []
    parts += [f"Stribeck speed {n.amount('stribeck')}"] if "stribeck" in n else []
    return ", ".join(parts), ("static", "stribeck")

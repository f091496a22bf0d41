"""The level of dry friction, N, with what it changes with:

g = c + (static − coulomb)·exp(−(s'/stribeck)²) + load_coefficient·|load|
c = max(coulomb + slope·(s − around), 0)

A guide that is tight at one end, a belt or a drive rubs more at some places than at others; its
level is linear in the stretch, and nowhere less than nothing, so that it only takes energy.

Sources: Armstrong-Hélouvry, Control of Machines with Friction, 1991 (of a gear it depends on the
position), and with Dupont & Canudas de Wit, Automatica 30, 1994.
"""

from symhyb.laws.base import STRETCHED, Key
from symhyb.laws.maths import Maths, Motion, Value, Values
from symhyb.laws.phrases import Numbers

FALLING = "(static - coulomb)*exp(-(s'/stribeck)^2)"
LEVEL = f"g = coulomb + {FALLING}"
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
SLOPE = Key(
    "slope",
    1,
    -1,
    0,
    "0",
    "change of the level along the stretch",
    STRETCHED,
    symbol="g_s",
    noun="change of dry friction along the travel",
    label="change along the travel",
)
AROUND = Key(
    "around",
    0,
    1,
    0,
    "0",
    "stretch at which the level is coulomb, where it has a slope",
    STRETCHED,
    exact=True,
    quoted=True,
    symbol="s_c",
    label="where it is so",
)


def friction_level(m: Maths, at: Motion, values: Values) -> Value:
    """g at a stretch and a rate, N."""
    level = coulomb = values.get("coulomb", 0)
    if "slope" in values:
        level = m.max(coulomb + values["slope"] * (at.s - values.get("around", 0)), 0)
    if "static" in values and "stribeck" in values:
        level += (values["static"] - coulomb) * m.exp(-((at.r / values["stribeck"]) ** 2))
    if "load" in values and "load_coefficient" in values:
        level += values["load_coefficient"] * m.abs(values["load"])
    return level


def level_phrase(n: Numbers) -> tuple[str, tuple[str, ...]]:
    """The breakaway level and the speed at which it is gone, with the keys they use."""
    parts = [f"{n.amount('static')} at breakaway"] if "static" in n else []
    parts += [f"Stribeck speed {n.amount('stribeck')}"] if "stribeck" in n else []
    return ", ".join(parts), ("static", "stribeck")

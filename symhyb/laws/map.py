"""A map: a memoryless force over stretch and rate together, given by a grid of values.

It is for people to write, as dampers, bushings and tyres are kept in tables of other programs; a
diagnosis does not look for it.
"""

from collections.abc import Collection

from symhyb.laws.base import LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    """It stores nothing: what the table gives back on a closed path, it feeds in."""
    return Action(values.get("scale", 1) * m.map(values["map"], at.s, at.r))


def _formula(keys: Collection[str], _: Options) -> str:
    return "scale*map(s, s')" if "scale" in keys else "map(s, s')"


LAW = Law(
    name="map",
    keys=(Key("scale", 0, 0, 0, "1", "factor of the force", symbol="c"), LENGTH),
    energy="dissipative",
    words="a force of stretch and rate from a table",
    law="scale*map(s, s')",
    strengths=(),
    action=_action,
    formula=_formula,
    example={"scale": 1.5},
)

"""A characteristic curve: a memoryless force over the stretch or over its rate, given by points."""

from collections.abc import Collection

from symhyb.laws.base import LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values

OVER = {"stretch": "s", "rate": "s'"}


def _action(m: Maths, at: Motion, values: Values, options: Options) -> Action:
    """Over the stretch it stores the area below the curve, counted from s = 0."""
    curve, scale = values["curve"], values.get("scale", 1)
    if options["over"] == "rate":
        return Action(scale * m.curve(curve, at.r))
    return Action(scale * m.curve(curve, at.s), scale * m.curve(curve.area(), at.s))


def _formula(keys: Collection[str], options: Options) -> str:
    force = f"curve({OVER[options.get('over', 'stretch')]})"
    return f"scale*{force}" if "scale" in keys else force


LAW = Law(
    name="curve",
    keys=(
        Key("scale", 0, 0, 0, "1", "factor of the force", symbol="c"),
        Key(
            "over",
            0,
            0,
            0,
            None,
            "what the force is a function of, stretch or rate",
            choices=tuple(OVER),
        ),
        LENGTH,
    ),
    energy="dissipative",
    words="a characteristic curve",
    law="scale*curve(s) or scale*curve(s')",
    strengths=(),
    needs=("over",),
    action=_action,
    formula=_formula,
    example={"scale": 1.5},
)

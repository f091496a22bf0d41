"""Forces that a model writes itself: applied forces and torques, expressions, networks."""

from symhyb.laws.base import ANYWHERE, LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase

_FORCE = Key(
    "force", 1, 0, 0, None, "what acts; at a point a list [Fx, Fy]", ("on", "at"), True, vector=True
)
_TORQUE = Key("torque", 1, 0, 0, None, "what acts on an angle", ("on",), True)
_TENSION = Key("tension", 1, 0, 0, None, "pulls the two points together", ("between",), True)


def _action(_: Maths, __: Motion, values: Values, ___: Options) -> Action:
    return Action(next(iter(values.values()), 0))


def _phrase(n: Numbers, options: Options) -> Phrase | None:
    if "formula" not in options or "coefficient" not in n:
        return None
    noun, letter = ("torque" if n.turns else "force"), n.symbol("coefficient")
    written = f"-{letter}*{options['formula']}".replace("-", "−")
    head = f"an empirical {noun} {written} with {letter} = {n.amount('coefficient')}"
    return Phrase(head, terms=("coefficient",))


FORCE = Law(
    name="force",
    keys=(_FORCE, _TENSION),
    energy="active",
    words="an applied force",
    law="force",
    strengths=("force", "tension"),
    placements=ANYWHERE,
    action=_action,
    example={"force": 2.0},
)
TORQUE = Law(
    name="torque",
    keys=(_TORQUE,),
    energy="active",
    words="an applied torque",
    law="torque",
    strengths=("torque",),
    placements=("on",),
    action=_action,
    example={"torque": 2.0},
)
EXPRESSION = Law(
    name="law",
    keys=(_FORCE, _TORQUE, _TENSION),
    energy="active",
    words="a force given by an expression",
    law="force, torque or tension as written",
    strengths=("force", "torque", "tension"),
    placements=ANYWHERE,
    action=_action,
    phrase=_phrase,
    example={"force": 2.0},
)
NETWORK = Law(
    name="network",
    keys=(LENGTH,),
    energy="active",
    words="a trained force",
    law="network(inputs)",
    strengths=(),
)

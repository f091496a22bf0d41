"""Drag quadratic in speed."""

from collections.abc import Iterator

from symhyb.laws.base import ANYWHERE, LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import LOSS, Candidate, Reach

WORDS, TORQUE_WORDS = "drag quadratic in speed", "drag torque quadratic in speed"


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    return Action(values.get("drag", 0) * m.abs(at.r) * at.r)


def _candidates(_: Reach) -> Iterator[Candidate]:
    yield Candidate(("drag",), (True,), order=LOSS)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "drag" not in n:
        return None
    noun = TORQUE_WORDS if n.turns else WORDS
    return Phrase(f"{noun} ({n.amount('drag')})", terms=("drag",), resists="motion")


LAW = Law(
    name="drag",
    keys=(Key("drag", 1, -2, 2, lower=0.0, symbol="b", noun="drag coefficient"), LENGTH),
    energy="dissipative",
    words=WORDS,
    law="drag*abs(s')*s'",
    strengths=("drag",),
    placements=ANYWHERE,
    action=_action,
    candidates=_candidates,
    phrase=_phrase,
    resists="drag",
    example={"drag": 0.7},
)

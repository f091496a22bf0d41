"""Inertia that turns with the body to which a point is fixed, about whichever axis it turns.

    T = inertia·|ω|²/2        p o──── the body, which turns by ω

It is what a body has beyond its mass at a point: a payload that is no point, a link whose tensor is
larger than stated. One number stands for all axes, as of a ball or a cube; where it stands on the
body makes no difference.
"""

from collections.abc import Iterator

from symhyb.laws.base import Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import INERTIA, Candidate, Reach


def _turned(_: Maths, __: Motion, values: Values, ___: Options) -> Action:
    return Action(0, mass=values.get("inertia", 0))


def _tried(_: Reach) -> Iterator[Candidate]:
    yield Candidate(("inertia",), (True,), order=INERTIA)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "inertia" not in n:
        return None
    head = f"added inertia of {n.amount('inertia')} (of the body that turns there)"
    return Phrase(head, terms=("inertia",), resists="angular acceleration")


LAW = Law(
    name="added_inertia",
    keys=(Key("inertia", 1, 1, 2, lower=0.0, inertia=True, symbol="J_a", noun="added inertia"),),
    energy="conservative",
    words="added inertia",
    law="inertia*omega'",
    strengths=("inertia",),
    placements=("at",),
    action=_turned,
    candidates=_tried,
    turns=True,
    of_state=False,
    steady=True,
    phrase=_phrase,
    example={"inertia": 0.02},
)

"""A constant force."""

from collections.abc import Iterator

from symhyb.laws.base import ANYWHERE, LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import FIRST, Candidate, Reach


def _action(_: Maths, __: Motion, values: Values, ___: Options) -> Action:
    return Action(values.get("constant", 0))


def _candidates(_: Reach) -> Iterator[Candidate]:
    yield Candidate(("constant",), (False,), order=FIRST)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "constant" not in n:
        return None
    noun = "torque" if n.turns else "force"
    return Phrase(f"a constant {noun} of {n.amount('constant')}", terms=("constant",))


LAW = Law(
    name="constant",
    keys=(Key("constant", 1, 0, 0, vector=True, symbol="F_0", noun="constant force"), LENGTH),
    energy="active",
    words="a constant force",
    law="constant",
    strengths=("constant",),
    placements=ANYWHERE,
    action=_action,
    candidates=_candidates,
    at_rest=True,
    steady=True,
    phrase=_phrase,
    pushes="constant",
    example={"constant": -1.5},
)

"""Mass that moves with the stretch: F = mass·s''.

On an angle it is an inertia: what turns along, or a rotor of inertia J behind a gear of ratio n,
which a joint feels as n²·J.
"""

from collections.abc import Iterator

from symhyb.laws.base import ANYWHERE, LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import INERTIA, Candidate, Reach


def moved(_: Maths, __: Motion, values: Values, ___: Options) -> Action:
    """F = mass·s'' is the force of the kinetic energy mass·s'²/2; no other term is left."""
    return Action(0, mass=values.get("mass", 0))


def tried(_: Reach) -> Iterator[Candidate]:
    """One mass, which is never negative."""
    yield Candidate(("mass",), (True,), order=INERTIA)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "mass" not in n:
        return None
    head = f"added mass of {n.amount('mass')}"
    if n.turns:
        head = f"added inertia of {n.amount('mass')} (as of a rotor behind a gear)"
    return Phrase(head, terms=("mass",), resists="acceleration")


LAW = Law(
    name="added_mass",
    keys=(
        Key("mass", 1, -1, 2, lower=0.0, inertia=True, symbol="m_a", noun="added mass"),
        LENGTH,
    ),
    energy="conservative",
    words="added mass",
    law="mass*s''",
    strengths=("mass",),
    placements=ANYWHERE,
    action=moved,
    candidates=tried,
    of_state=False,
    steady=True,
    phrase=_phrase,
    example={"mass": 0.3},
)

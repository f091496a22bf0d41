"""A mass that is carried at a point: it resists the acceleration of that point, and has weight.

    o        M gets mass·JᵀJ, and gravity acts at the point: F = mass·g, with J = ∂p/∂q
    |
    p [mass]

It acts in all coordinates that move the point at once, as no law on one coordinate does: a tool, a
load in a gripper, a body that is heavier than stated. The weight is no law of stretch and rate: the
equations, which know gravity, add it.
"""

from symhyb.laws import added_mass
from symhyb.laws.base import Key, Law
from symhyb.laws.maths import Options
from symhyb.laws.phrases import Numbers, Phrase


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "mass" not in n:
        return None
    head = f"a payload of {n.amount('mass')}"
    return Phrase(head, terms=("mass",), resists="acceleration")


LAW = Law(
    name="payload",
    keys=(Key("mass", 1, -1, 2, lower=0.0, inertia=True, symbol="m_p", noun="payload"),),
    energy="conservative",
    words="a payload",
    law="mass*(a - g)",
    strengths=("mass",),
    placements=("at",),
    action=added_mass.moved,
    candidates=added_mass.tried,
    weighs=True,
    of_state=False,
    steady=True,
    phrase=_phrase,
    example={"mass": 0.4},
)

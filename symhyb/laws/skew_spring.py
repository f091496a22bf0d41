r"""Coupling stiffness: a spring that is askew to two stretches couples them.

          ^ b   /    energy k·a·b
          |  /\/     push on a = −k·b
          | /        push on b = −k·a       k of either sign
          └──▶ a

It is an entry beside the diagonal of a stiffness matrix. Together with springs of at least
``abs(k)`` on both it stores energy whatever the motion.
"""

from symhyb.laws.base import PAIRED, Key, Law
from symhyb.laws.maths import Coupling, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase


def _coupling(a: Motion, b: Motion, values: Values) -> Coupling:
    k = values.get("stiffness", 0)
    return Coupling((-k * b.s, -k * a.s), k * a.s * b.s)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "stiffness" not in n:
        return None
    return Phrase(f"coupling stiffness of {n.amount('stiffness')}", terms=("stiffness",))


LAW = Law(
    name="skew_spring",
    keys=(Key("stiffness", 1, -1, 0, placements=PAIRED, symbol="k_ab", noun="coupling stiffness"),),
    energy="conservative",
    words="a coupling spring",
    law="(-stiffness*b, -stiffness*a)",
    strengths=("stiffness",),
    placements=PAIRED,
    coupling=_coupling,
    steady=True,
    phrase=_phrase,
    example={"stiffness": 40.0},
)

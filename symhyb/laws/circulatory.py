r"""Circulatory coupling: the stretch of one pushes along the other, and not the other way back.

          ^ b        push on a = +k·b
          | ↺        push on b = −k·a       k > 0 turns a motion from b to a, clockwise here
          └──▶ a

The work along a closed orbit is 2k times its area: it feeds energy into a motion that turns its way
and takes it out of one that turns the other way. Seals and journal bearings (cross-coupled
stiffness), brakes and followers act so.

Source: Ziegler, Principles of Structural Stability, 1968, §1.3.
"""

from symhyb.laws.base import PAIRED, Key, Law
from symhyb.laws.maths import Coupling, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase


def _coupling(a: Motion, b: Motion, values: Values) -> Coupling:
    k = values.get("stiffness", 0)
    return Coupling((k * b.s, -k * a.s))


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "stiffness" not in n:
        return None
    return Phrase(f"circulatory stiffness of {n.amount('stiffness')}", terms=("stiffness",))


LAW = Law(
    name="circulatory",
    keys=(
        Key("stiffness", 1, -1, 0, placements=PAIRED, symbol="k_c", noun="circulatory stiffness"),
    ),
    energy="active",
    words="circulatory coupling",
    law="(stiffness*b, -stiffness*a)",
    strengths=("stiffness",),
    placements=PAIRED,
    coupling=_coupling,
    steady=True,
    phrase=_phrase,
    example={"stiffness": 40.0},
)

r"""Coupling damping: a damper that is askew to two stretches couples them.

          ^ b   /    push on a = −d·b'
          |  [=/     push on b = −d·a'      d of either sign
          | /
          └──▶ a

It is an entry beside the diagonal of a damping matrix. Together with dampers of at least ``abs(d)``
on both it only takes energy; alone it feeds energy in where the two rates have different signs.
"""

from symhyb.laws.base import PAIRED, Key, Law
from symhyb.laws.maths import Coupling, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase


def _coupling(a: Motion, b: Motion, values: Values) -> Coupling:
    d = values.get("damping", 0)
    return Coupling((-d * b.r, -d * a.r))


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "damping" not in n:
        return None
    return Phrase(f"coupling damping of {n.amount('damping')}", terms=("damping",))


LAW = Law(
    name="skew_damper",
    keys=(Key("damping", 1, -1, 1, placements=PAIRED, symbol="d_ab", noun="coupling damping"),),
    energy="dissipative",
    words="coupling damping",
    law="(-damping*b', -damping*a')",
    strengths=("damping",),
    placements=PAIRED,
    coupling=_coupling,
    steady=True,
    phrase=_phrase,
    example={"damping": 3.0},
)

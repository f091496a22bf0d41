r"""Gyroscopic coupling: a rotor that is tilted about one axis pushes about the other one.

          ^ b        push on a = +G·b'
          |          push on b = −G·a'      G = ∓(angular momentum of a rotor), a and b its tilts
     (rotor)──▶ a

The power a'·G·b' − b'·G·a' is 0: it neither stores nor takes energy.

Source: Meirovitch, Elements of Vibration Analysis, 2nd ed., 1986, §4.13.
"""

from symhyb.laws.base import PAIRED, Key, Law
from symhyb.laws.maths import Coupling, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase


def _coupling(a: Motion, b: Motion, values: Values) -> Coupling:
    g = values.get("coefficient", 0)
    return Coupling((g * b.r, -g * a.r))


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "coefficient" not in n:
        return None
    return Phrase(f"gyroscopic coupling of {n.amount('coefficient')}", terms=("coefficient",))


LAW = Law(
    name="gyroscopic",
    keys=(Key("coefficient", 1, -1, 1, placements=PAIRED, symbol="G", noun="gyroscopic coupling"),),
    energy="conservative",
    words="gyroscopic coupling",
    law="(coefficient*b', -coefficient*a')",
    strengths=("coefficient",),
    placements=PAIRED,
    coupling=_coupling,
    steady=True,
    phrase=_phrase,
    example={"coefficient": 3.0},
)

"""Losses that differ by direction: F is multiplied by 1 + asymmetry·sgn s'."""

from symhyb.laws.base import STRETCHED, Key
from symhyb.laws.maths import Maths, Motion, Value, Values
from symhyb.laws.phrases import Numbers

SKEW = 0.95  # of an asymmetry: beyond, a loss would drive
BESIDE = 30.0  # the same beside an element of the model, of which it may take back a part

ASYMMETRY = Key(
    "asymmetry",
    0,
    0,
    0,
    "0",
    "F is multiplied by 1 + asymmetry*sgn(s')",
    STRETCHED,
    lower=-SKEW,
    upper=SKEW,
    symbol="a_s",
)
FACTOR = "*(1 + asymmetry*sgn(s'))"


def sided(m: Maths, at: Motion, values: Values) -> Value:
    """1 + asymmetry·sgn s'."""
    if "asymmetry" not in values:
        return 1
    return 1 + values["asymmetry"] * m.sign(at.r)


def directions(n: Numbers, term: str) -> str:
    """The strengths of a law that differs by direction."""
    if "asymmetry" not in n:
        return ""
    forward, backward = (
        n.derived(n.value(term) * (1.0 + sign * n.value("asymmetry")), n.unit(term))
        for sign in (1.0, -1.0)
    )
    return f"{forward} forward, {backward} backward"

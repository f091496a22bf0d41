"""Dry friction with elastic pre-sliding (LuGre; Dahl without micro-damping).

Source: Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995.
"""

from collections.abc import Collection, Iterator
from dataclasses import replace

from symhyb.laws.base import LENGTH, Key, Law, State
from symhyb.laws.hysteresis import imitated
from symhyb.laws.levels import COULOMB, LEVEL, STATIC, STRIBECK, friction_level, level_phrase
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import Candidate, Reach
from symhyb.laws.variants import Pace, Row, Variant

PRESLIDING_SHARES = (0.01, 0.05)  # of the amplitude
MICRO_SHARE = 0.3  # of friction over speed (RMS): micro-damping
STATIC_FIRST = 1.3  # of the sliding friction: the breakaway friction that is tried first
STRIBECK_FIRST = 0.1  # of the largest rate


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    k, d = values.get("stiffness", 0), values.get("micro_damping", 0)
    (z,) = at.z
    inner = at.r - k * m.abs(at.r) * z / friction_level(m, at, values)
    return Action(k * z + d * inner, k * z**2 / 2, (inner,), (0,))


def _candidates(reach: Reach) -> Iterator[Candidate]:
    if reach.amplitude <= 0:
        return
    for share in PRESLIDING_SHARES:
        shape = (("stiffness", 1 / (share * reach.amplitude)),)
        yield Candidate(("coulomb",), (True,), shape, ("stiffness",), tied=("stiffness",))


def _variants(row: Row, pace: Pace, added: Collection[str]) -> Iterator[Variant]:
    """Micro-damping, and a level that falls with speed; the hysteresis that it may stand for."""
    if not pace.rate > 0:
        return
    if "micro_damping" not in added:
        micro = MICRO_SHARE * row["coulomb"] / pace.rate
        yield Variant({**row, "micro_damping": micro}, ("micro_damping",), ("micro_damping",))
    if "static" not in added:
        levels = {
            "static": STATIC_FIRST * row["coulomb"],
            "stribeck": STRIBECK_FIRST * pace.fastest,
        }
        yield Variant({**row, **levels}, ("static", "stribeck"), ("static",))
    if not added:
        yield from imitated(row["stiffness"], row["coulomb"], pace)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "coulomb" not in n:
        return None
    levels, terms = level_phrase(n)
    head = f"dry friction{' torque' if n.turns else ''} of {n.amount('coulomb')}"
    head += f" ({levels})" if levels else ""
    if n.value("stiffness") > 0.0:
        travel = n.ratio("coulomb", "stiffness")
        head += f" that yields elastically over about {travel} before it slides (LuGre)"
    return Phrase(head, terms=("coulomb", *terms), resists="motion")


def _formula(keys: Collection[str], _: Options) -> str:
    level, rest = ("g", f", {LEVEL}") if "static" in keys else ("coulomb", "")
    force = "stiffness*z" + (" + micro_damping*z'" if "micro_damping" in keys else "")
    return f"{force}, z' = s' - stiffness*abs(s')*z/{level}{rest}"


LAW = Law(
    name="friction_dynamic",
    keys=(
        replace(COULOMB, divides=True),
        STATIC,
        STRIBECK,
        Key("stiffness", 1, -1, 0, symbol="k"),
        Key("micro_damping", 1, -1, 1, symbol="d_m"),
        LENGTH,
    ),
    energy="dissipative",
    words="dry friction with elastic pre-sliding (LuGre)",
    law="stiffness*z + micro_damping*z'",
    strengths=("coulomb", "static"),
    needs=("coulomb", "stiffness"),
    states=(State("z", "s' - stiffness*abs(s')*z/g, g as of friction"),),
    action=_action,
    steep=True,
    stiff=True,
    dry=True,
    candidates=_candidates,
    variants=_variants,
    subject="friction",
    phrase=_phrase,
    formula=_formula,
    example={
        "coulomb": 2.0,
        "static": 3.0,
        "stribeck": 0.1,
        "stiffness": 1e3,
        "micro_damping": 1.0,
    },
)

"""An elastic stop behind a clearance, on either side or on both.

Source: Hunt & Crossley, J. Appl. Mech. 42, 1975, for contact that never pulls.
"""

from collections.abc import Collection, Iterator

import numpy as np

from symhyb.laws.base import LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import Candidate, Reach
from symhyb.laws.variants import Pace, Row, Variant

CLEARANCE_SHARES = (0.4, 0.65, 0.85)  # of the stretches of one sign: quantiles
CONTACT_SHARES = (0.03, 0.3)  # of stretch over speed (both RMS): damping over stiffness
SAMPLES_LEAST = 20  # of one sign, that a side is tried
SIDES = {"upper": "on the upper side", "lower": "on the lower side", "both": "on both sides"}


def _action(m: Maths, at: Motion, values: Values, options: Options) -> Action:
    """Contact at s = clearance (upper) and s = −clearance (lower); with damping the contact force
    still never pulls."""
    k, d, c = (values.get(key, 0) for key in ("stiffness", "damping", "clearance"))
    side, force, stored = options.get("side", "both"), 0, 0
    for name, sign in (("upper", 1), ("lower", -1)):
        if side not in (name, "both"):
            continue
        depth = m.max(sign * at.s - c, 0)
        if "damping" not in values:
            pressed = k * depth
        else:  # the damper acts in contact only
            pressed = m.max(k * depth + d * sign * at.r * m.step(depth), 0)
        force += sign * pressed
        stored += k * depth**2 / 2
    return Action(force, stored)


def _candidates(reach: Reach) -> Iterator[Candidate]:
    s = reach.stretch - (reach.length or 0.0)
    for side, travel in (("both", np.abs(s)), ("upper", s[s > 0]), ("lower", -s[s < 0])):
        if travel.size < SAMPLES_LEAST or (side == "both" and not (s.min() < 0 < s.max())):
            continue
        for clearance in np.quantile(travel, CLEARANCE_SHARES):
            if clearance > 0:
                yield Candidate(
                    ("stiffness",),
                    (True,),
                    (("clearance", float(clearance)), *reach.slack),
                    ("clearance",),
                    options=(("side", side),),
                )


def _variants(row: Row, pace: Pace, added: Collection[str]) -> Iterator[Variant]:
    """A stop that is damped while it is pressed."""
    if "damping" not in added and pace.rate > 0:
        for share in CONTACT_SHARES:
            damped = {**row, "damping": share * pace.time * row["stiffness"]}
            yield Variant(damped, ("damping",), ("damping",))


def _phrase(n: Numbers, options: Options) -> Phrase | None:
    side = options.get("side", "")
    if "stiffness" not in n:
        return None
    tail = f"beyond a clearance of {n.small('clearance')}" if "clearance" in n else ""
    tail = " ".join(part for part in (tail, SIDES.get(side, "")) if part)
    if side == "both" and "clearance" in n:
        tail += f", {n.derived_small(2.0 * n.value('clearance'), n.unit('clearance'))} apart"
    return Phrase(f"an elastic stop of {n.amount('stiffness')}", tail, ("stiffness", "clearance"))


def _formula(keys: Collection[str], options: Options) -> str:
    upper, lower = ("s - clearance", "s + clearance") if "clearance" in keys else ("s", "s")
    if "damping" in keys:  # in contact only, and never pulling
        pressed = [
            f"max(stiffness*({upper}) + damping*s', 0)*({upper} > 0)",
            f"min(stiffness*({lower}) + damping*s', 0)*({lower} < 0)",
        ]
    else:
        pressed = [f"stiffness*max({upper}, 0)", f"stiffness*min({lower}, 0)"]
    chosen = {"upper": pressed[:1], "lower": pressed[1:]}.get(options.get("side", "both"), pressed)
    return " + ".join(chosen)


LAW = Law(
    name="gap",
    keys=(
        Key("stiffness", 1, -1, 0, symbol="k"),
        Key(
            "clearance",
            0,
            1,
            0,
            "0",
            "free travel to each side that has a stop",
            lower=0.0,
            reach=3.0,
            exact=True,
            symbol="s_c",
        ),
        Key(
            "damping",
            1,
            -1,
            1,
            "0",
            "acts in contact only and never pulls",
            lower=0.0,
            symbol="d",
        ),
        Key("side", 0, 0, 0, "both", "which stops there are", choices=tuple(SIDES)),
        LENGTH,
    ),
    energy="dissipative",
    words="an elastic stop behind a clearance",
    law="stiffness*max(s - clearance, 0) + stiffness*min(s + clearance, 0)",
    strengths=("stiffness",),
    action=_action,
    steep=True,
    stiff=True,
    switch="touches",
    candidates=_candidates,
    variants=_variants,
    phrase=_phrase,
    formula=_formula,
    example={"stiffness": 200.0, "clearance": 0.1, "damping": 5.0},
)

"""Play (backlash) in a spring: within the clearance, to either side, it exerts nothing.

The element is what the play changes of a spring that stands beside it: it takes back what a spring
of this ``stiffness`` exerts within the clearance, and beyond it what that exerts at the clearance.

Source: Nordin & Gutman, Controlling mechanical systems with backlash: a survey, Automatica 38,
2002 (the dead zone of a shaft without damping).
"""

from collections.abc import Iterator

import numpy as np

from symhyb.laws.base import LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import Candidate, Reach

CLEARANCE_SHARES = (0.1, 0.4, 0.7)  # of the sizes of the stretch: quantiles
ABOUT = 2.0  # the stiffness of the spring that has play, over that of the model or under it


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    k, c = values.get("stiffness", 0), values.get("clearance", 0)
    beyond = m.max(at.s - c, 0) + m.min(at.s + c, 0)
    return Action(-k * (at.s - beyond), -k * (at.s**2 - beyond**2) / 2)


def _candidates(reach: Reach) -> Iterator[Candidate]:
    if reach.stiffness <= 0.0:
        return
    bounds = (("stiffness", reach.stiffness / ABOUT, reach.stiffness * ABOUT),)
    for clearance in np.quantile(np.abs(reach.stretch - (reach.length or 0.0)), CLEARANCE_SHARES):
        if clearance > 0:
            yield Candidate(
                ("stiffness",),
                (True,),
                (("clearance", float(clearance)), *reach.slack),
                ("clearance",),
                bounds=bounds,
            )


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "stiffness" not in n or "clearance" not in n:
        return None
    return Phrase(
        f"play (backlash) of {n.small('clearance')} to either side",
        f"in a spring of {n.amount('stiffness')}",
        ("stiffness", "clearance"),
    )


LAW = Law(
    name="play",
    keys=(
        Key("stiffness", 1, -1, 0, "0", "of the spring that has the play", symbol="k"),
        Key(
            "clearance",
            0,
            1,
            0,
            None,
            "free travel to either side",
            lower=0.0,
            reach=10.0,
            exact=True,
            symbol="s_c",
        ),
        LENGTH,
    ),
    energy="conservative",
    words="play in a spring",
    law="-stiffness*max(min(s, clearance), -clearance)",
    strengths=("stiffness",),
    needs=("clearance",),
    action=_action,
    steep=True,
    candidates=_candidates,
    phrase=_phrase,
    example={"stiffness": 200.0, "clearance": 0.1},
)

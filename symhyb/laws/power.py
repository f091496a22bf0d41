"""A loss that grows with a power of the speed, which is a number of its own.

    F = coefficient·(s'/speed)·((s'² + transition²)/speed²)^((exponent − 1)/2)

Beyond the transition that is coefficient·|s'/speed|^exponent·sgn s': the coefficient is the force
at the reference speed, so that its unit does not depend on the exponent. Within the transition the
force is in proportion to s', for below a power of 1 its slope would be infinite at rest.
"""

from collections.abc import Iterator

import numpy as np

from symhyb.laws.base import LENGTH, Key, Law
from symhyb.laws.friction import DEFAULT_TRANSITION
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import LOSS, Candidate, Reach

FIRST = (0.5, 1.5)  # exponents that are tried first
LEAST, MOST = 0.2, 3.0  # below it is dry friction; above no loss of a machine is known
LISTED = (0.0, 1.0, 2.0)  # dry friction, viscous damping and drag are laws with names of their own
WORDS = "a loss that grows with a power of the speed"


def _action(_: Maths, at: Motion, values: Values, __: Options) -> Action:
    speed = values.get("speed", 1)
    width = values.get("transition", DEFAULT_TRANSITION * speed)
    size = (at.r**2 + width**2) / speed**2
    grown = size ** ((values["exponent"] - 1) / 2)
    return Action(values.get("coefficient", 0) * (at.r / speed) * grown)


def _candidates(reach: Reach) -> Iterator[Candidate]:
    """The reference speed is the RMS speed, to one digit: there the force is known best."""
    typical = float(np.sqrt(np.mean(reach.rate**2)))
    width = reach.narrow * reach.speed
    if not typical > 0 or not width > 0:
        return
    rest = (("speed", float(f"{typical:.0e}")), ("transition", width))
    for exponent in FIRST:
        yield Candidate(
            ("coefficient",),
            (True,),
            (("exponent", exponent), *rest),
            ("exponent",),
            bounds=(("exponent", LEAST, MOST),),
            order=LOSS,
        )


def _phrase(n: Numbers, options: Options) -> Phrase | None:
    if "coefficient" not in n or "exponent" not in n:
        return None
    power = n.counted(n.value("exponent"), n.sd("exponent"))
    at = options.get("speed", "the reference speed")
    head = f"a loss of {n.amount('coefficient')} at {at} that grows with the power {power} of speed"
    return Phrase(head, terms=("coefficient", "exponent"), resists="motion")


LAW = Law(
    name="power",
    keys=(
        Key(
            "coefficient",
            1,
            0,
            0,
            about="the force at the reference speed",
            lower=0.0,
            symbol="F_p",
            noun="loss at the reference speed",
        ),
        Key(
            "exponent",
            0,
            0,
            0,
            None,
            "the power of the speed",
            lower=0.0,
            listed=LISTED,
            symbol="p",
            label="power",
        ),
        Key(
            "speed",
            0,
            1,
            -1,
            "1",
            "the reference speed",
            divides=True,
            quoted=True,
            symbol="v_r",
            label="reference speed",
        ),
        Key(
            "transition",
            0,
            1,
            -1,
            None,
            "unset: 1e-4 of the reference speed",
            symbol="v_t",
            label="transition speed",
        ),
        LENGTH,
    ),
    energy="dissipative",
    words=WORDS,
    law="coefficient*(s'/speed)*((s'^2 + transition^2)/speed^2)^((exponent - 1)/2)",
    strengths=("coefficient",),
    needs=("exponent",),
    action=_action,
    stiff=True,
    candidates=_candidates,
    bent=True,
    phrase=_phrase,
    resists="coefficient",
    example={"coefficient": 3.0, "exponent": 0.6, "speed": 0.5, "transition": 0.01},
)

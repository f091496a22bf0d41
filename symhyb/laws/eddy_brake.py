"""An eddy-current brake: strongest at its critical speed, and weaker beyond.

    F = peak·2·(s'/critical)/(1 + (s'/critical)²)

Far below the critical speed it is viscous damping of 2·peak/critical; far beyond the eddy currents
shield the disc from the field, and F falls with 1/s'.

Sources: Davis & Reitz, J. Appl. Phys. 42, 1971; Wouterse, IEE Proc. B 138, 1991, eq. 1.
"""

from collections.abc import Iterator

from symhyb.laws.base import LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import SHAPED, Candidate, Reach

CRITICAL_SHARES = (0.15, 0.5)  # of the largest rate
SLOWEST, FASTEST = 0.05, 3.0  # of the largest rate: below, friction turns; beyond, it is a damper


def _action(_: Maths, at: Motion, values: Values, __: Options) -> Action:
    ratio = at.r / values["critical"]
    return Action(2 * values.get("peak", 0) * ratio / (1 + ratio**2))


def _candidates(reach: Reach) -> Iterator[Candidate]:
    for share in CRITICAL_SHARES:
        yield Candidate(
            ("peak",),
            (True,),
            (("critical", share * reach.speed),),
            ("critical",),
            bounds=(("critical", SLOWEST * reach.speed, FASTEST * reach.speed),),
            order=SHAPED,
        )


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "peak" not in n or "critical" not in n:
        return None
    head = f"an eddy-current brake of {n.amount('peak')} at its critical speed"
    head += f" of {n.amount('critical')}"
    return Phrase(head, terms=("peak", "critical"), resists="motion")


LAW = Law(
    name="eddy_brake",
    keys=(
        Key("peak", 1, 0, 0, about="the largest force", lower=0.0, symbol="F_m"),
        Key(
            "critical",
            0,
            1,
            -1,
            None,
            "the speed at which the force is largest",
            divides=True,
            symbol="v_c",
            label="critical speed",
        ),
        LENGTH,
    ),
    energy="dissipative",
    words="an eddy-current brake",
    law="2*peak*(s'/critical)/(1 + (s'/critical)^2)",
    strengths=("peak",),
    needs=("critical",),
    action=_action,
    candidates=_candidates,
    bent=True,
    phrase=_phrase,
    resists="peak",
    example={"peak": 3.0, "critical": 0.6},
)

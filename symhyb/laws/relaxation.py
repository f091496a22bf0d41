"""A spring that relaxes: spring and damper in series (Maxwell)."""

from collections.abc import Collection, Iterator

import numpy as np

from symhyb.laws.base import LENGTH, Key, Law, State
from symhyb.laws.hysteresis import imitated
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import Candidate, Reach
from symhyb.laws.variants import Pace, Row, Variant

RELAXATION_SHARES = (0.15, 1.0, 6.0)  # of 1/ω of the motion
HALF = 0.5


def _action(_: Maths, at: Motion, values: Values, __: Options) -> Action:
    k, d, (z,) = values["stiffness"], values["damping"], at.z
    return Action(k * (at.s - z), k * (at.s - z) ** 2 / 2, ((at.s - z) * k / d,), (at.s,))


def _candidates(reach: Reach) -> Iterator[Candidate]:
    if reach.amplitude <= 0:
        return
    pace = float(np.sqrt(np.mean(reach.rate**2))) / max(float(np.std(reach.stretch)), 1e-300)
    for share in RELAXATION_SHARES:
        shape = (("damping", share / pace),)
        yield Candidate(("stiffness",), (True,), shape, ("damping",), tied=("damping",))


def _variants(row: Row, pace: Pace, _: Collection[str]) -> Iterator[Variant]:
    """Whatever remembers resembles it at first: a hysteresis, from where it would saturate at half
    of the stretch (RMS)."""
    if pace.time > 0:
        level = row["stiffness"] * (HALF * pace.time * pace.rate)
        yield from imitated(row["stiffness"], level, pace)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "stiffness" not in n:
        return None
    head = f"a spring of {n.amount('stiffness')} that relaxes"
    if "damping" in n and n.value("stiffness") > 0.0:
        head += f" with the time constant {n.ratio('damping', 'stiffness')}"
    return Phrase(f"{head} (Maxwell)", terms=("stiffness",))


LAW = Law(
    name="relaxation",
    keys=(
        Key("stiffness", 1, -1, 0, symbol="k"),
        Key("damping", 1, -1, 1, lower=0.0, divides=True, symbol="d"),
        LENGTH,
    ),
    energy="dissipative",
    words="a spring that relaxes (Maxwell)",
    law="stiffness*(s - z)",
    strengths=("stiffness",),
    needs=("damping",),
    states=(State("z", "(s - z)*stiffness/damping"),),
    action=_action,
    stiff=True,
    several=True,
    candidates=_candidates,
    variants=_variants,
    phrase=_phrase,
    example={"stiffness": 200.0, "damping": 40.0},
)

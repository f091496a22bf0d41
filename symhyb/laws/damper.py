"""Viscous damping, which may differ by direction."""

from collections.abc import Collection, Iterator, Mapping

from symhyb.laws.base import ANYWHERE, LENGTH, Key, Law, Terms
from symhyb.laws.friction import imitating
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import LOPSIDED, LOSS, Candidate, Reach
from symhyb.laws.sided import ASYMMETRY, FACTOR, directions, sided
from symhyb.laws.variants import Pace, Row, Variant

WORDS = "viscous damping"


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    return Action(values.get("damping", 0) * at.r * sided(m, at, values))


def _candidates(_: Reach) -> Iterator[Candidate]:
    yield Candidate(("damping",), (True,), order=LOSS)
    yield Candidate(("damping", "skew"), (True, False), order=LOPSIDED)


def _variants(row: Row, pace: Pace, _: Collection[str]) -> Iterator[Variant]:
    """The friction by a load that it may stand for."""
    if "asymmetry" not in row:
        yield from imitating(row["damping"], pace)


def _read(terms: Mapping[str, float]) -> dict[str, float]:
    """damping·s' + skew·abs(s') = damping·s'·(1 + asymmetry·sgn s')."""
    values = dict(terms)
    if "skew" in values:
        values["asymmetry"] = values.pop("skew") / values["damping"] if values["damping"] else 0.0
    return values


TERMS = Terms(
    {"skew": "asymmetry"},
    _read,
    # next to nothing but abs(s')
    {"damping": {"damping": 1.0}, "skew": {"damping": 1e-9, "asymmetry": 1e9}},
    added=("skew",),
)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "damping" not in n:
        return None
    head = f"{WORDS} of {n.amount('damping')}"
    by_side = directions(n, "damping")
    return Phrase(head + (f" ({by_side})" if by_side else ""), terms=("damping",), resists="motion")


def _formula(keys: Collection[str], _: Options) -> str:
    return f"damping*s'{FACTOR if 'asymmetry' in keys else ''}"


LAW = Law(
    name="damper",
    keys=(
        Key("damping", 1, -1, 1, lower=0.0, symbol="d", noun=WORDS),
        ASYMMETRY,
        LENGTH,
    ),
    energy="dissipative",
    words=WORDS,
    law="damping*s'",
    strengths=("damping",),
    placements=ANYWHERE,
    action=_action,
    candidates=_candidates,
    variants=_variants,
    terms=TERMS,
    phrase=_phrase,
    resists="damping",
    critical="damping",
    formula=_formula,
    example={"damping": 4.0, "asymmetry": 0.25},
)

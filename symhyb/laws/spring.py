"""A spring: a polynomial of the stretch."""

from collections.abc import Collection, Iterator

from symhyb.laws.base import LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import POLYNOMIAL, Candidate, Reach

FORCE = "stiffness*s + quadratic*s^2 + cubic*s^3"
MEANINGS = {  # key: (noun, meaning of a positive value, of a negative value)
    "stiffness": ("linear stiffness", "", "pushes away from rest"),
    "quadratic": (
        "quadratic stiffness",
        "harder at positive stretch",
        "softer at positive stretch",
    ),
    "cubic": ("cubic stiffness", "hardening", "softening"),
}


def _action(_: Maths, at: Motion, values: Values, __: Options) -> Action:
    k1, k2, k3 = (values.get(key, 0) for key in MEANINGS)
    s = at.s
    return Action(
        k1 * s + k2 * s**2 + k3 * s**3,
        k1 * s**2 / 2 + k2 * s**3 / 3 + k3 * s**4 / 4,
    )


def _candidates(reach: Reach) -> Iterator[Candidate]:
    for term in MEANINGS:
        yield Candidate((term,), (False,), reach.slack, order=POLYNOMIAL)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    present = tuple(key for key in MEANINGS if key in n)
    parts = []
    for key in present:
        noun, hard, soft = MEANINGS[key]
        meaning = hard if n.value(key) >= 0.0 else soft
        parts.append(f"{noun} of {n.amount(key)}" + (f" ({meaning})" if meaning else ""))
    return Phrase(n.listed(parts), terms=present, plural=len(parts) > 1) if parts else None


def _formula(keys: Collection[str], _: Options) -> str:
    return " + ".join(term for term in FORCE.split(" + ") if term.split("*")[0] in keys)


LAW = Law(
    name="spring",
    keys=(
        Key("stiffness", 1, -1, 0, symbol="k"),
        Key("quadratic", 1, -2, 0, symbol="k_2", noun="quadratic stiffness"),
        Key("cubic", 1, -3, 0, symbol="k_3", noun="cubic stiffness"),
        LENGTH,
    ),
    energy="conservative",
    words="a spring",
    law=FORCE,
    strengths=("stiffness", "quadratic", "cubic"),
    action=_action,
    candidates=_candidates,
    at_rest=True,
    joins=True,
    phrase=_phrase,
    formula=_formula,
    example={"stiffness": 200.0, "quadratic": 40.0, "cubic": 3000.0},
)

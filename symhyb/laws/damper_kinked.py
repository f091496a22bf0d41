"""A damper with a knee: one damping below a speed, another one beyond it.

       F ^        ..-- beyond          F = beyond·s' + (damping − beyond)·s'/(1 + x^n)^(1/n)
         |    .-'                      x = |s'|/knee,  n = sharpness
         |  /
         | / damping                   n = 1 turns slowly, n → ∞ is two straight lines
      ───┼──────┼────▶ s'
               knee

A digressive damper is softer beyond its knee, as shock absorbers are whose valves open; a
progressive one is harder. With beyond = 0 and n = 1 it is a fluid that thins as it is sheared.

Sources: Dixon, The Shock Absorber Handbook, 2007, chapter 7 (knees); Cross, J. Colloid Sci. 20,
1965 (the fluid).
"""

from collections.abc import Collection, Iterator

from symhyb.laws.base import LENGTH, Key, Law, Terms
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import SHAPED, Candidate, Reach
from symhyb.laws.variants import Pace, Row, Variant

KNEE_SHARES = (0.05, 0.2)  # of the largest rate
SLOWEST, FASTEST = 0.02, 3.0  # of the largest rate: a knee below is friction, beyond a damper
SHARPER = 4.0  # sharpness of the variant
TINY = 1e-30  # keeps the slope of x^n over n finite at rest


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    d, beyond = values.get("damping", 0), values.get("beyond", 0)
    n, x = values.get("sharpness", 1), m.abs(at.r) / values["knee"]
    bent = 1 + x if n == 1 else (1 + (x + TINY) ** n) ** (1 / n)
    return Action(beyond * at.r + (d - beyond) * at.r / bent)


def _candidates(reach: Reach) -> Iterator[Candidate]:
    bounds = (("knee", SLOWEST * reach.speed, FASTEST * reach.speed),)
    knees = [share * reach.speed for share in KNEE_SHARES]
    for knee in knees:
        shape = (("knee", knee),)
        yield Candidate(("damping",), (True,), shape, ("knee",), bounds=bounds, order=SHAPED)
    yield Candidate(
        ("damping", "beyond"),
        (True, True),
        (("knee", knees[-1]),),
        ("knee",),
        bounds=bounds,
        order=SHAPED,
    )


def _variants(row: Row, _: Pace, added: Collection[str]) -> Iterator[Variant]:
    """A sharper knee, and what is left of the damping beyond it."""
    if "sharpness" not in added:
        yield Variant({**row, "sharpness": SHARPER}, ("sharpness",))


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "damping" not in n or "knee" not in n:
        return None
    kind = "progressive" if n.value("beyond") > n.value("damping") else "digressive"
    head = f"a {kind} damper of {n.amount('damping')}"
    if "beyond" in n:
        head += f" below and {n.amount('beyond')} beyond a knee at {n.amount('knee')}"
    else:
        head += f" with a knee at {n.amount('knee')}"
    if "sharpness" in n:
        head += f" of sharpness {n.counted(n.value('sharpness'), n.sd('sharpness'))}"
    return Phrase(head, terms=("damping", "beyond", "knee", "sharpness"), resists="motion")


def _formula(keys: Collection[str], _: Options) -> str:
    bent = "(1 + x^n)^(1/n)" if "sharpness" in keys else "(1 + x)"
    names = ", n = sharpness" if "sharpness" in keys else ""
    if "beyond" not in keys:
        return f"damping*s'/{bent}, x = abs(s')/knee{names}"
    return f"beyond*s' + (damping - beyond)*s'/{bent}, x = abs(s')/knee{names}"


LAW = Law(
    name="damper_kinked",
    keys=(
        Key("damping", 1, -1, 1, about="below the knee", lower=0.0, symbol="d"),
        Key(
            "beyond",
            1,
            -1,
            1,
            "0",
            "the damping beyond the knee",
            lower=0.0,
            symbol="d_b",
            label="damping beyond the knee",
        ),
        Key(
            "knee",
            0,
            1,
            -1,
            None,
            "the speed at which the damping turns over",
            divides=True,
            symbol="v_k",
            label="knee speed",
        ),
        Key(
            "sharpness",
            0,
            0,
            0,
            "1",
            "n, at least 1",
            lower=1.0,
            upper=20.0,
            reach=5.0,
            symbol="n",
        ),
        LENGTH,
    ),
    energy="dissipative",
    words="a damper with a knee",
    law="beyond*s' + (damping - beyond)*s'/(1 + x^n)^(1/n), x = abs(s')/knee",
    strengths=("damping",),
    needs=("knee",),
    action=_action,
    candidates=_candidates,
    variants=_variants,
    terms=Terms(added=("beyond",)),
    bent=True,
    phrase=_phrase,
    resists="damping",
    formula=_formula,
    example={"damping": 8.0, "beyond": 1.0, "knee": 0.3, "sharpness": 2.0},
)

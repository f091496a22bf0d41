"""Hysteresis after Bouc and Wen, with play in series.

    F = stiffness·dead(z, play),   z' = s' − beta·|s'|·|z|^(n−1)·z − gamma·s'·|z|^n

Sources: Bouc, Proc. 4th Conf. Nonlinear Oscillation, 1967, and Wen, J. Eng. Mech. 102, 1976.
"""

from collections.abc import Collection, Iterator
from dataclasses import replace
from fractions import Fraction

from symhyb.laws.base import LENGTH, Key, Law, State
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import Candidate, Reach
from symhyb.laws.variants import Pace, Row, Variant
from symhyb.units import parse_unit

YIELD_SHARES = (0.05, 0.2, 0.6)  # of the amplitude: where it saturates
EXPONENT_FIRST = 2.0
PLAY_SHARES = (0.2, 0.6)  # of the stretch at which the plain hysteresis saturates
HALF = 0.5
LEAST = 1e-3  # of beta + gamma: the smallest of them that a variant starts from
TINY = 1e-30  # m: keeps the slope of abs(z)^n finite at z = 0


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    beta, gamma, k = (values.get(key, 0) for key in ("beta", "gamma", "stiffness"))
    n = values.get("exponent", 1)
    (z,), r = at.z, at.r
    size = m.abs(z) + (0 if n == 1 else TINY)
    grown, turned = size**n, z if n == 1 else size ** (n - 1) * z
    taut = z
    if "play" in values:
        play = values["play"]
        taut = m.max(z - play, 0) + m.min(z + play, 0)
    inner = r - beta * m.abs(r) * turned - gamma * r * grown
    return Action(k * taut, k * taut**2 / 2, (inner,), (0,))


def _candidates(reach: Reach) -> Iterator[Candidate]:
    if reach.amplitude <= 0:
        return
    for share in YIELD_SHARES:
        half = 0.5 / (share * reach.amplitude)
        shape = (("beta", half), ("gamma", half))
        yield Candidate(("stiffness",), (True,), shape, ("beta", "gamma"))


def _variants(row: Row, _: Pace, added: Collection[str]) -> Iterator[Variant]:
    """A sharper or softer knee, and play in series; the stretch and the force at which the plain
    law saturates stay. Last a gamma of either sign: a law that hardens as it is loaded, and unloads
    more steeply still."""
    both, n = row["beta"] + row["gamma"], row.get("exponent", 1.0)
    if both <= 0:
        return
    yields = both ** (-1 / n)
    if "exponent" not in added:
        sharper = {**_scaled(row, yields**-EXPONENT_FIRST), "exponent": EXPONENT_FIRST}
        yield Variant(sharper, ("exponent",))
    if "play" not in added:
        for share in PLAY_SHARES:
            longer = _scaled(row, (yields * (1 + share)) ** -n)
            yield Variant({**longer, "play": share * yields}, ("play",))
    if not added:
        hardening = {**row, "gamma": -HALF * row["beta"]}
        yield Variant(hardening, ("gamma",), tried={"gamma": row["beta"]})


def _scaled(row: Row, both: float) -> dict[str, float]:
    """The same hysteresis with another beta + gamma, both of them positive."""
    beta, gamma = (max(row[key], LEAST * (row["beta"] + row["gamma"])) for key in ("beta", "gamma"))
    return {**row, "beta": beta * both / (beta + gamma), "gamma": gamma * both / (beta + gamma)}


def imitated(stiffness: float, level: float, pace: Pace) -> Iterator[Variant]:
    """The Bouc–Wen laws of which Dahl's, with this ``stiffness`` and force ``level``, is the one
    with gamma = 0: they load and unload otherwise, or behind a play. SI."""
    if min(level, stiffness) <= 0:
        return
    both = stiffness / level
    first = {"stiffness": stiffness, "beta": 0.7 * both, "gamma": 0.3 * both}
    shape = (("beta", first["beta"]), ("gamma", first["gamma"]))
    candidate = Candidate(("stiffness",), (True,), shape, ("beta", "gamma"))
    for variant in (Variant(first), *_variants(first, pace, ())):
        yield replace(variant, law="hysteresis", candidate=candidate)


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "stiffness" not in n:
        return None
    tail = f"with a stiffness of {n.amount('stiffness')}" + _saturation(n)
    if "play" in n:
        tail += f" behind a play of {n.small('play')}"
    return Phrase("hysteresis (Bouc–Wen)", tail, ("stiffness", "play"), "motion")


def _saturation(n: Numbers) -> str:
    """The force at which z' = 0 on loading: stiffness·((beta + gamma)^(−1/n) − play); with a
    negative sum z grows ever faster."""
    power, both = n.value("exponent", 1.0), n.value("beta") + n.value("gamma")
    if "beta" not in n or both == 0.0 or power <= 0.0:
        return ""
    if both < 0.0:
        return " that hardens on loading"
    inverse = -1 / Fraction(power).limit_denominator(12)
    stretch = parse_unit(n.unit("beta")) ** inverse
    if "^" in stretch.text or "/" in stretch.text:  # an exponent that was set, not fitted
        return ""
    level = n.value("stiffness") * (both ** (-1.0 / power) - n.value("play"))
    unit = (parse_unit(n.unit("stiffness")) * stretch).text
    return f" that saturates at about {n.derived(level, unit)}"


def _formula(keys: Collection[str], _: Options) -> str:
    force = "stiffness*dead(z, play)" if "play" in keys else "stiffness*z"
    turned, grown = ("abs(z)^(n-1)*z", "abs(z)^n") if "exponent" in keys else ("z", "abs(z)")
    rate = "s'"
    rate += f" - beta*abs(s')*{turned}" if "beta" in keys else ""
    rate += f" - gamma*s'*{grown}" if "gamma" in keys else ""
    return f"{force}, z' = {rate}" + (", n = exponent" if "exponent" in keys else "")


LAW = Law(
    name="hysteresis",
    keys=(
        Key("stiffness", 1, -1, 0, symbol="k"),
        Key("beta", 0, -1, 0, exponent="exponent"),
        # with a positive beta energy is lost whatever the sign of gamma
        Key("gamma", 0, -1, 0, exponent="exponent", either_sign=True),
        Key("exponent", 0, 0, 0, "1", "n, at least 1", lower=1.0, reach=4.0, symbol="n"),
        Key("play", 0, 1, 0, "0", "free travel in series with the spring", symbol="s_p"),
        LENGTH,
    ),
    energy="dissipative",
    words="hysteresis (Bouc-Wen)",
    law="stiffness*dead(z, play)",
    strengths=("stiffness",),
    states=(State("z", "s' - beta*abs(s')*abs(z)^(n-1)*z - gamma*s'*abs(z)^n"),),
    action=_action,
    steep=True,
    stiff=True,
    candidates=_candidates,
    variants=_variants,
    phrase=_phrase,
    formula=_formula,
    example={"stiffness": 200.0, "beta": 4.0, "gamma": 2.0, "exponent": 1.5, "play": 0.02},
)

"""Dry friction whose sign is smoothed, with a breakaway level and a Stribeck speed.

The law that is fitted rises over a transition instead of jumping:

    g(s') tanh(s'/transition),   g = coulomb + (static − coulomb) exp(−(s'/stribeck)²)

so its peak stays below ``static``, where dry friction reaches it. A fit makes up for that by a
higher level and a shorter Stribeck speed. Both are known no better than the smoothing allows.

Where friction turns over within a wide band, as a lubricated contact does below its full level, the
transition is a number of the machine and is fitted: far below it the force is viscous damping of
coulomb/transition, far beyond it dry friction.

The level may grow with a load, by load_coefficient·|load|: in gears, belts, brakes and wheels what
slides is pressed by the force that is carried. It may change with the place, by slope·(s − around),
to nothing at the least: a guide is tight at one end.
"""

from collections.abc import Collection, Iterator
from dataclasses import replace
from math import floor, log10

import numpy as np

from symhyb.laws.base import ANYWHERE, LENGTH, SHAPE_REACH, Fitted, Key, Law, Terms
from symhyb.laws.levels import (
    AROUND,
    COULOMB,
    FALLING,
    LEVEL,
    LOAD,
    LOAD_COEFFICIENT,
    SLOPE,
    STATIC,
    STRIBECK,
    friction_level,
    level_phrase,
)
from symhyb.laws.maths import Action, Maths, Motion, Options, Value, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import LOSS, SHAPED, Candidate, Reach
from symhyb.laws.sided import ASYMMETRY, FACTOR, directions, sided
from symhyb.laws.variants import Pace, Row, Variant
from symhyb.units import parse_unit

SPEED_SCALE = 1.0  # m/s (rad/s …), where no recording tells how fast the machine moves
DEFAULT_TRANSITION = 1e-4  # of the speed scale
STRIBECK_SHARES = (0.05, 0.2)  # of the largest rate
WIDE_SHARES = (0.05, 0.2)  # of the largest rate: a transition that is fitted
WIDEST = 1.0  # of the largest rate: beyond, the level was never seen, and it is a damper
LOADED = 0.5  # of the level of dry friction: what a load has of it at first
SLOPED = 0.5  # of the level: what it changes by at first over the RMS of the stretch
SPEEDS = np.linspace(0.01, 20.0, 4000)  # in transitions, where the peak is looked for
WORDS = "dry (Coulomb) friction"


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    turning = m.tanh(at.r / transition(values))
    return Action(friction_level(m, at, values) * turning * sided(m, at, values))


def transition(values: Values) -> Value:
    """The speed within which friction turns, m/s."""
    return values.get("transition", DEFAULT_TRANSITION * SPEED_SCALE)


def _candidates(reach: Reach) -> Iterator[Candidate]:
    width = (("transition", reach.narrow * reach.speed),)
    yield Candidate(("coulomb",), (True,), width, order=LOSS)
    for share in STRIBECK_SHARES:
        shape = (("stribeck", share * reach.speed), *width)
        yield Candidate(("coulomb", "static"), (True, True), shape, ("stribeck",), order=SHAPED)
    for share in WIDE_SHARES:
        wide = (("transition", share * reach.speed),)
        bounds = (("transition", reach.narrow * reach.speed, WIDEST * reach.speed),)
        yield Candidate(("coulomb",), (True,), wide, ("transition",), bounds=bounds, order=SHAPED)


def _variants(row: Row, pace: Pace, added: Collection[str]) -> Iterator[Variant]:
    """Friction a part of which grows with what presses at the place, with each load that the
    machine knows there; friction that turns over within a wider band; friction whose level changes
    along the travel."""
    if "load_coefficient" not in added:
        yield from _loaded(row, row["coulomb"], pace)
    if "transition" not in row and "static" not in row:
        yield from _wide(row, pace)
    if "slope" not in added:
        yield from _along(row, pace)


def _wide(row: Row, pace: Pace) -> Iterator[Variant]:
    """Friction that turns over between the narrow transition and the largest rate."""
    if not 0 < pace.turning < pace.fastest:
        return
    for share in WIDE_SHARES:
        yield Variant(
            {**row, "transition": share * pace.fastest},
            ("transition",),
            bounds=(("transition", pace.turning, WIDEST * pace.fastest),),
        )


def _along(row: Row, pace: Pace) -> Iterator[Variant]:
    """Friction whose level is what it was in the middle of the travel, or at 0 where that is near,
    and changes from there."""
    reach = pace.time * pace.rate
    if min(row["coulomb"], reach) <= 0:
        return
    first = SLOPED * row["coulomb"] / reach
    digits = -floor(log10(reach))
    middle = round(pace.middle, digits) if abs(pace.middle) > reach else 0.0
    yield Variant(
        {**row, "slope": first},
        ("slope",),
        shape=(("around", middle),) if middle else (),
        product="{s}*tanh({s}'/transition)",
        bounds=(("slope", -SHAPE_REACH * first, SHAPE_REACH * first),),
    )


def _loaded(row: Row, level: float, pace: Pace) -> Iterator[Variant]:
    """Friction of a typical ``level``, N, that each load shares with what does not change."""
    for load in pace.loads:
        first = {
            **row,
            "coulomb": (1 - LOADED) * level,
            "load_coefficient": LOADED * level / load.size,
        }
        yield Variant(first, ("load_coefficient",), options=(("load", load.text),))


def imitating(damping: float, pace: Pace) -> Iterator[Variant]:
    """Friction by a load that grows with the stretch, as a weight or a spring is: every swing loses
    the same share of its energy to it, which is what viscous ``damping`` (N·s/m) takes, and dry
    friction of one level does not."""
    if min(damping, pace.rate, pace.turning) <= 0:
        return
    shape = (("transition", pace.turning),)
    candidate = Candidate(("coulomb",), (True,), shape)
    for variant in _loaded(dict(shape), damping * pace.rate, pace):
        yield replace(variant, law="friction", candidate=candidate)


def _phrase(n: Numbers, options: Options) -> Phrase | None:
    if "coulomb" not in n:
        return None
    noun = WORDS + (" torque" if n.turns else "")
    levels, terms = level_phrase(n)
    listed = ", ".join(part for part in (levels, directions(n, "coulomb")) if part)
    head = f"{noun} of {n.amount('coulomb')}" + (f" ({listed})" if listed else "")
    does = []
    if "slope" in n:
        length = parse_unit(n.unit("coulomb")) / parse_unit(n.unit("slope"))
        head += f" at {options.get('around', f'0 {length.text}')}"
        does.append(f"changes by {n.amount('slope')} along the travel")
    if "transition" in n:
        does.append(f"turns over within {n.amount('transition')} of rest")
    if "load_coefficient" in n:
        share = n.counted(n.value("load_coefficient"), n.sd("load_coefficient"))
        load = f" {options['load']}" if "load" in options else ""
        does.append(f"grows by {share} of the load{load}")
    head += f" that {n.listed(does)}" if does else ""
    shapes = ("transition", "slope", "load_coefficient")
    return Phrase(head, terms=("coulomb", *terms, *shapes), resists="motion")


def _formula(keys: Collection[str], _: Options) -> str:
    stretch = "(s - around)" if "around" in keys else "s"
    sliding = f"max(coulomb + slope*{stretch}, 0)" if "slope" in keys else "coulomb"
    falling = f"g = {sliding} + {FALLING}"
    level, rest = ("g", f", {falling}") if "static" in keys else (sliding, "")
    if "load_coefficient" in keys:
        loaded = "load_coefficient*abs(load)"
        level = f"({level} + {loaded})" if {"coulomb", "static"} & {*keys} else loaded
    return f"{level}*tanh(s'/transition){FACTOR if 'asymmetry' in keys else ''}{rest}"


def widened(values: Fitted) -> dict[str, tuple[float, float]]:
    """Values and deviations with those of ``static`` and ``stribeck`` widened by what the peak
    lacks and by the transition, unless that is fitted too."""
    wide = dict(values)
    if not {"coulomb", "static", "stribeck", "transition"} <= wide.keys():
        return wide
    if np.isfinite(wide["transition"][1]):
        return wide
    coulomb, static, stribeck, width = (
        wide[key][0] for key in ("coulomb", "static", "stribeck", "transition")
    )
    speed = SPEEDS * width
    level = coulomb + (static - coulomb) * np.exp(-((speed / stribeck) ** 2))
    lacking = max(static - float(np.max(level * np.tanh(SPEEDS))), 0.0)
    for key, bias in (("static", lacking), ("stribeck", width)):
        value, sd = wide[key]
        wide[key] = value, float(np.hypot(sd, bias))  # of a number that is held, NaN stays
    return wide


LAW = Law(
    name="friction",
    keys=(
        replace(COULOMB, noun="Coulomb friction"),
        replace(STATIC, noun="static friction"),
        STRIBECK,
        Key(
            "transition",
            0,
            1,
            -1,
            None,
            "unset: 1e-4 of the scale of the speed",
            divides=True,
            symbol="v_t",
            noun="transition of dry friction",
            label="transition speed",
        ),
        ASYMMETRY,
        SLOPE,
        AROUND,
        LOAD_COEFFICIENT,
        LOAD,
        LENGTH,
    ),
    energy="dissipative",
    words=WORDS,
    torque_words=f"{WORDS} torque",
    law=f"g*tanh(s'/transition), {LEVEL}",
    strengths=("coulomb", "static", "load_coefficient"),
    placements=ANYWHERE,
    action=_action,
    steep=True,
    stiff=True,
    dry=True,
    smoothed_over="transition",
    switch="holds",
    candidates=_candidates,
    variants=_variants,
    terms=Terms(added=("static",)),
    phrase=_phrase,
    resists="coulomb",
    formula=_formula,
    widened=widened,
    example={
        "coulomb": 2.0,
        "static": 3.0,
        "stribeck": 0.2,
        "transition": 0.05,
        "asymmetry": -0.4,
        "slope": 5.0,
        "around": 0.1,
        "load_coefficient": 0.3,
        "load": 1.5,
    },
)

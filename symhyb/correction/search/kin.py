"""Variants of a law that was found: the same law with one key more, tried where something is left.

They stand in no linear screen, so the first list does not grow: a variant begins at the values of
the plain law and at a few values of the added key, spread over what the place moves through.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.search.setting import Setting
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import Place

EXPONENT_FIRST = 2.0  # of a hysteresis
PLAY_SHARES = (0.2, 0.6)  # of the stretch at which the plain hysteresis saturates
MICRO_SHARE = 0.3  # of friction over speed (RMS): micro-damping
STATIC_FIRST = 1.3  # of the sliding friction: the breakaway friction that is tried first
STRIBECK_FIRST = 0.1  # of the largest rate
CONTACT_SHARES = (0.03, 0.3)  # of stretch over speed (both RMS): damping over stiffness of a stop
HALF = 0.5
LEAST = 1e-3  # of beta + gamma: the smallest of them that a variant starts from

Row = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Pace:
    """How a place moves, SI: RMS and largest rate, and the time that the stretch (RMS about its
    mean) takes at the RMS rate, s."""

    rate: float
    fastest: float
    time: float


def variants_of(
    setting: Setting, cause: Hypothesis, row: Row
) -> Iterator[tuple[Hypothesis, dict[str, float]]]:
    """Each variant of a fitted cause with the first guess of its keys, SI; ``row`` holds the values
    of the plain law."""
    if cause.place not in setting.library.places:
        return
    pace = pace_of(setting, cause.place)
    match cause.kind:
        case "hysteresis":
            yield from _hysteresis(cause, row)
        case "friction_dynamic" if pace.rate > 0:
            yield from _sliding(cause, row, pace)
            if not cause.added:
                yield from _unsymmetric(cause, row)
        case "relaxation" if pace.time > 0:
            # whatever remembers resembles it at first: from where it would saturate at half of
            # the stretch (RMS)
            stretch = HALF * pace.time * pace.rate
            told = {"stiffness": row["stiffness"], "coulomb": row["stiffness"] * stretch}
            yield from _unsymmetric(cause, told)
        case "gap" if "damping" not in cause.added and pace.rate > 0:
            for share in CONTACT_SHARES:
                damping = share * pace.time * row["stiffness"]
                yield _more(cause, row, {"damping": damping}, tied=True)


def _hysteresis(cause: Hypothesis, row: Row) -> Iterator[tuple[Hypothesis, dict[str, float]]]:
    """A sharper or softer knee, and play in series; the stretch and the force at which the plain
    law saturates stay."""
    both, n = row["beta"] + row["gamma"], row.get("exponent", 1.0)
    if both <= 0:
        return
    yields = both ** (-1 / n)
    if "exponent" not in cause.added:
        yield _more(cause, _scaled(row, yields**-EXPONENT_FIRST), {"exponent": EXPONENT_FIRST})
    if "play" not in cause.added:
        for share in PLAY_SHARES:
            longer = (yields * (1 + share)) ** -n
            yield _more(cause, _scaled(row, longer), {"play": share * yields})
    if not cause.added:
        yield _hardening(cause, row)


def _hardening(cause: Hypothesis, row: Row) -> tuple[Hypothesis, dict[str, float]]:
    """The same law with a gamma of either sign: one that hardens as it is loaded, and unloads more
    steeply still."""
    tried = {**dict(cause.shape), "gamma": row["beta"]}
    signed = replace(cause, shape=tuple(tried.items()), added=(*cause.added, "gamma"))
    return signed, {**row, "gamma": -HALF * row["beta"]}


def _scaled(row: Row, both: float) -> dict[str, float]:
    """The same hysteresis with another beta + gamma, both of them positive."""
    beta, gamma = (max(row[key], LEAST * (row["beta"] + row["gamma"])) for key in ("beta", "gamma"))
    return {**row, "beta": beta * both / (beta + gamma), "gamma": gamma * both / (beta + gamma)}


def _sliding(
    cause: Hypothesis, row: Row, pace: Pace
) -> Iterator[tuple[Hypothesis, dict[str, float]]]:
    """Micro-damping, and a level that falls with speed."""
    if "micro_damping" not in cause.added:
        micro = MICRO_SHARE * row["coulomb"] / pace.rate
        yield _more(cause, row, {"micro_damping": micro}, tied=True)
    if "static" not in cause.added:
        levels = {
            "static": STATIC_FIRST * row["coulomb"],
            "stribeck": STRIBECK_FIRST * pace.fastest,
        }
        yield _more(cause, row, levels, tied=True)


def _unsymmetric(cause: Hypothesis, row: Row) -> Iterator[tuple[Hypothesis, dict[str, float]]]:
    """The Bouc-Wen laws of which Dahl's is the one with gamma = 0: they load and unload otherwise,
    or behind a play."""
    if min(row["coulomb"], row["stiffness"]) <= 0:
        return
    both = row["stiffness"] / row["coulomb"]
    first = {"stiffness": row["stiffness"], "beta": 0.7 * both, "gamma": 0.3 * both}
    shape = tuple((key, first[key]) for key in ("beta", "gamma"))
    plain = Hypothesis(
        "hysteresis",
        cause.place,
        ("stiffness",),
        (True,),
        shape,
        ("beta", "gamma"),
    )
    yield plain, first
    yield from _hysteresis(plain, first)


def _more(
    cause: Hypothesis, row: Row, added: Row, tied: bool = False
) -> tuple[Hypothesis, dict[str, float]]:
    """A law with more keys, which begins at ``row`` and ``added``; the refined keys are tried at
    where they begin, forces that are ``tied`` grow with the first coefficient."""
    first = {**row, **added}
    shape = {**dict(cause.shape), **added}
    shape |= {key: first[key] for key in cause.refined if key not in cause.tied}
    grows = tuple(key for key in added if tied and key != "stribeck")
    variant = replace(
        cause,
        shape=tuple(shape.items()),
        refined=(*cause.refined, *added),
        tied=(*cause.tied, *grows),
        added=(*cause.added, *added),
    )
    return variant, {key: first[key] for key in variant.keys}


def pace_of(setting: Setting, place: Place) -> Pace:
    """How a place of the library moves along all recordings."""
    index = setting.library.places.index(place)
    parts = [
        setting.library.motion(item.course(setting.library.machine))
        for item in setting.stages[0].laid
    ]
    stretch = np.concatenate([s[:, index] - s[:, index].mean() for s, _ in parts])
    rate = np.concatenate([r[:, index] for _, r in parts])
    typical = float(np.sqrt(np.mean(rate**2)))
    return Pace(
        typical,
        float(np.quantile(np.abs(rate), 0.99)),
        float(np.std(stretch)) / typical if typical > 0 else 0.0,
    )

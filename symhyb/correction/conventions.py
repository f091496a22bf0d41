"""Causes that no recording of a kind tells apart, and which of them convention names."""

from symhyb.correction.selection import Problem
from symhyb.discrepancy.hypotheses import Hypothesis

CERTAIN = 4.6  # of the criterion: a rival closer than this (odds 10 to 1) leaves a cause in doubt
RIVAL = 10.0  # of the criterion: closer than this, a rival is told
TWINS = 1e-6  # of 1 − ρ² between two effects: the same


def exact_twins(problem: Problem) -> tuple[tuple[int, int], ...]:
    """Pairs of causes whose effects are the same on these windows, the one to be named first.

    A parameter that may be estimated goes before a force, a force before a channel, an input
    before a sensor.
    """
    causes = problem.hypotheses
    order = sorted(range(len(causes)), key=lambda i: precedence(i, causes[i]))
    pairs, gone = [], set()
    for place, first in enumerate(order):
        if first in gone or len(problem.columns[first]) > 1:
            continue
        a = problem.columns[first][0]
        for second in order[place + 1 :]:
            if second in gone or len(problem.columns[second]) > 1:
                continue
            b = problem.columns[second][0]
            power = problem.gram[a, a] * problem.gram[b, b]
            if power > 0 and 1 - problem.gram[a, b] ** 2 / power < TWINS:
                pairs.append((first, second))
                gone.add(second)
    return tuple(pairs)


def precedence(index: int, cause: Hypothesis) -> tuple[int, int]:
    """Which of two equal causes is named: a parameter that may be estimated before a force, a force
    before a channel, an input before a sensor."""
    return {"parameter": 0, "gain": 2, "offset": 3, "delay": 4}.get(cause.kind, 1), index


def alike(first: Hypothesis, second: Hypothesis) -> bool:
    """Whether two causes are of kinds that convention ranks: gains of two channels of a linear
    system, offsets or delays of two channels, a constant force and an offset."""
    kinds = {first.kind, second.kind}
    return kinds in ({"gain"}, {"offset"}, {"delay"}, {"constant", "offset"})

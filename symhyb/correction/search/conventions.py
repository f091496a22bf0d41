"""Causes that no recording of a kind distinguishes, and which of them convention names."""

from collections.abc import Sequence
from dataclasses import dataclass

from symhyb.correction.search.selection import Problem
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import SAME


@dataclass(frozen=True)
class Exchange:
    """What one structure has in place of what another has."""

    fresh: tuple[Hypothesis, ...]  # causes of the one that the other lacks
    lost: tuple[Hypothesis, ...]  # causes of the other that the one lacks

    @property
    def pair(self) -> tuple[Hypothesis, Hypothesis] | None:
        """The fresh and the lost cause, where there is one of each."""
        one = len(self.fresh) == len(self.lost) == 1
        return (self.fresh[0], self.lost[0]) if one else None

    @property
    def conventional(self) -> bool:
        """Whether one cause stands for another of a kind that convention ranks."""
        return self.pair is not None and alike(*self.pair)

    @property
    def grows(self) -> bool:
        """Whether more numbers come than go: an extension rather than a rival."""
        fresh, lost = (sum(cause.numbers for cause in side) for side in (self.fresh, self.lost))
        return fresh > lost


def exchange(one: Sequence[Hypothesis], other: Sequence[Hypothesis]) -> Exchange:
    """What the causes ``one`` have in place of the causes ``other``."""
    return Exchange(
        tuple(cause for cause in one if cause not in other),
        tuple(cause for cause in other if cause not in one),
    )


def indistinguishable(problem: Problem) -> tuple[tuple[int, int], ...]:
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
            if power > 0 and 1 - problem.gram[a, b] ** 2 / power < SAME:
                pairs.append((first, second))
                gone.add(second)
    return tuple(pairs)


def with_twins(
    alike: Sequence[tuple[int, int]], twins: Sequence[tuple[int, int]]
) -> tuple[tuple[int, int], ...]:
    """Pairs that look ``alike``, and those that are the same in every motion (``twins``), each with
    the one to be named first; a cause gives way once, and to one that does not give way itself."""
    gone = {second for _, second in alike}
    more = [(a, b) for a, b in twins if a not in gone and b not in gone]
    named = {first for first, _ in alike}
    fresh = {b: (a, b) for a, b in reversed(more) if b not in named}
    return (*alike, *(fresh[b] for b in sorted(fresh)))


def precedence(index: int, cause: Hypothesis) -> tuple[int, int]:
    """Which of two equal causes is named: a parameter that may be estimated before a force, a force
    before a channel, an input before a sensor."""
    return {"parameter": 0, "gain": 2, "offset": 3, "delay": 4}.get(cause.kind, 1), index


def alike(first: Hypothesis, second: Hypothesis) -> bool:
    """Whether two causes are of kinds that convention ranks: gains of two channels of a linear
    system, offsets or delays of two channels, a constant force and an offset."""
    kinds = {first.kind, second.kind}
    return kinds in ({"gain"}, {"offset"}, {"delay"}, {"constant", "offset"})

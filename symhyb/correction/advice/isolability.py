"""Which causes the recordings at hand can distinguish, and by how much.

Along the selected structure's own simulation the effect of every cause on the sensors is linear.
Initial states of the windows and the selected structure's other causes are projected out of it. Of
the effect a of one cause, at the size found, another cause B can imitate all but the rest r = a − B
b; where a is the truth, the recordings speak against B with

    E = |r|² / 2c = (1 − ρ²) |a|² / 2c        ln of the odds; ρ: correlation of a with B

(c: χ² of one independent sample). Sizes: F columns of the reduced problem, C causes listed.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.correction.naming.findings import cause_phrase, doubtful
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.score import unit_of
from symhyb.correction.search.selection import Problem
from symhyb.correction.search.setting import Setting, effects
from symhyb.discrepancy.fitting.normal import shortest_solution
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.results import Isolability
from symhyb.judgement import SIGNIFICANT
from symhyb.numeric.kernels.buffers import Array

Along = Callable[[], Problem]
"""Gives the linear problem along the selected structure's simulation; made when it is asked for."""

NEAREST = 3  # causes listed beside each found one
LISTED_MOST = 8  # rows of the matrix


@dataclass(frozen=True, slots=True, eq=False)
class _Cause:
    """A cause in the reduced problem: its columns in each shape that is tried, what it is, and
    which cause of the selected structure (by index) it is or stands for. ``effect`` (F,) are
    coefficients."""

    hypothesis: Hypothesis
    shapes: tuple[tuple[int, ...], ...]
    stands: int
    effect: Array


def isolability(setting: Setting, decision: Decision, along: Along) -> Isolability | None:
    """The matrix of the selected structure's causes, their rivals and the causes that come nearest
    to them; None if nothing was found. ``along`` as in :data:`.Along`."""
    if not decision.selected.causes:
        return None
    space, doubt = _Space(setting, decision, along()), doubtful(decision)
    chosen = list(space.own)
    rivals = {
        cause.family
        for trial in decision.trials
        for cause in trial.causes
        if decision.behind(trial) < SIGNIFICANT
    }
    for mine in space.own:
        near = [other for _, other in space.others(mine)]
        near.sort(key=lambda other: other.hypothesis.family not in rivals)
        chosen += near[:NEAREST]
    unique = {cause.hypothesis.family: cause for cause in reversed(chosen)}
    listed = sorted(unique.values(), key=lambda cause: chosen.index(cause))[:LISTED_MOST]
    return Isolability(
        tuple(cause_phrase(cause.hypothesis) for cause in listed),
        tuple(cause in space.own and cause.hypothesis not in doubt for cause in listed),
        np.array(
            [[*(space.against(a, b) for b in listed), space.against(a, None)] for a in listed]
        ),
    )


class _Space:
    """The effects of all causes along the selected structure's simulation, as Gram matrix of all
    windows."""

    def __init__(self, setting: Setting, decision: Decision, problem: Problem):
        self.selected = decision.selected
        self.problem = problem
        self.gram = self.problem.gram + self.problem.held
        self.gram = computable(self.gram[:-1, :-1]) + np.diag(self.problem.prior)
        self.unit = unit_of(self.selected)
        self.own = tuple(
            _Cause(cause, (part.columns,), i, part.effect)
            for i, (cause, part) in enumerate(
                zip(
                    self.selected.causes, effects(setting, self.selected, self.problem), strict=True
                )
            )
        )

    def others(self, mine: _Cause) -> list[tuple[float, _Cause]]:
        """Every other cause with what the recordings say against it where ``mine`` acts, in the
        shape and at the size in which it comes nearest; the nearest first."""
        taken = {(c.kind, c.place, c.path) for c in self.selected.causes}
        best: dict[tuple[object, ...], tuple[float, _Cause]] = {}
        for hypothesis, columns in zip(self.problem.hypotheses, self.problem.columns, strict=True):
            key = hypothesis.kind, hypothesis.place, hypothesis.path
            if hypothesis.variant or key in taken:
                continue
            rest, values = self._imitated(mine, columns)
            if not np.any(values):
                continue
            effect = np.zeros(len(self.gram))
            effect[list(columns)] = values
            found = rest / (2 * self.unit), _Cause(hypothesis, (columns,), mine.stands, effect)
            held = best.get(hypothesis.family)
            if held is None or found[0] < held[0]:
                best[hypothesis.family] = found
        return sorted(best.values(), key=lambda pair: pair[0])

    def against(self, true: _Cause, tried: _Cause | None) -> float:
        """ln of the odds against ``tried`` (None: nothing) where ``true`` acts; NaN for itself."""
        if tried is true:
            return float("nan")
        shapes: Sequence[tuple[int, ...]] = ((),) if tried is None else tried.shapes
        return min(self._imitated(true, columns)[0] for columns in shapes) / (2 * self.unit)

    def _imitated(self, true: _Cause, columns: Sequence[int]) -> tuple[float, Array]:
        """|rest|² of an effect that ``columns`` imitate, and their coefficients; the selected
        structure's other causes may move too. What physics forbids imitates nothing."""
        beside = [
            c
            for other in self.own
            if other.stands != true.stands
            for c in other.shapes[0]
            if c not in columns
        ]
        joined = [*columns, *beside]
        rest, values = self._rest(true.effect, joined)
        own = values[: len(columns)]
        problem: Problem = self.problem
        low, high = problem.lower[list(columns)], problem.upper[list(columns)]
        standing = any(set(columns) == set(o.shapes[0]) for o in self.own)
        if not standing and (np.any(own < low) or np.any(own > high)):
            return self._rest(true.effect, beside)[0], np.zeros(len(columns))
        return rest, own

    def _rest(self, effect: Array, columns: Sequence[int]) -> tuple[float, Array]:
        return imitated(self.gram, effect, columns)


def computable(gram: Array) -> Array:
    """A Gram matrix (F, F), per SI units, in which a column that could not be computed along this
    motion (its law leaves the range of numbers there) has no effect, and so imitates nothing."""
    able = np.isfinite(np.diag(gram))
    return np.asarray(np.where(able[:, None] & able & np.isfinite(gram), gram, 0.0))


def imitated(gram: Array, effect: Array, columns: Sequence[int]) -> tuple[float, Array]:
    """|rest|² of an effect (F,) that ``columns`` imitate, and their coefficients, SI. Columns may
    be the same or do nothing: what two share is split between them."""
    whole = float(effect @ gram @ effect)
    index = list(columns)
    right = (gram @ effect)[index]
    values = shortest_solution(gram[np.ix_(index, index)], right)
    return max(whole - float(right @ values), 0.0), values

"""Structures refined at the longest windows, each once."""

from collections.abc import Mapping, Sequence

import numpy as np

from symhyb.correction.search.selection import Problem, Subset
from symhyb.correction.search.setting import Setting, Stage, around
from symhyb.correction.search.trajectory import Refined, grouped, refine
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.numeric.kernels.buffers import Array
from symhyb.steps import Say

NEXT_TO_NONE = 1e-3  # of the mean of the others: where a recording without a cause begins

Row = dict[str, float]


class Trials:
    """Structures refined at the longest windows, each once; the second of ``equals`` is not
    tried, nor are bent laws, which compete where simpler ones are known not to be enough
    (:mod:`symhyb.correction.adequacy.curves.listed`)."""

    def __init__(
        self,
        setting: Setting,
        say: Say,
        equals: Sequence[tuple[int, int]] = (),
    ):
        self.setting, self.say = setting, say
        self.equals = tuple(equals)
        self.doubles = frozenset(second for _, second in equals)
        self.dropped = self.doubles | setting.bent
        self.done: dict[tuple[int, ...], Refined] = {}
        self.known = list(setting.hypotheses)
        self._along: dict[tuple[int, ...], Problem] = {}

    def refined(
        self,
        causes: Sequence[int],
        values: Sequence[Mapping[str, float]] = (),
        starts: Sequence[Array] | None = None,
    ) -> Refined:
        """The structure of the numbered ``causes``, fitted from ``values`` (SI, by key; as many as
        causes) and the initial states of windows ``starts`` (W, 2n), where given."""
        key = tuple(sorted(causes))
        if key not in self.done:
            chosen = [self.known[cause] for cause in causes]
            self.say("trying " + (" + ".join(map(str, chosen)) or "the model as it is"))
            found = self._fitted(chosen, values, starts)
            part = self._best_part(key)
            if part is not None and not found.fit.train <= part.fit.train:
                # what it holds fits better alone: it ended in a minimum of its own
                again = self._fitted(chosen, _joining(part, chosen, values), part.fit.starts)
                found = min(found, again, key=_misfit)
            self.done[key] = found
        return self.done[key]

    def carried(self, causes: Sequence[int], values: Sequence[Row]) -> Sequence[Row]:
        """Where a structure begins at the longest windows: ``values`` (SI, by key; as many as
        causes) fitted at the shortest, and from there at every longer length. What is off carries
        short windows less far away, so that fewer minima lie between."""
        chosen = [self.known[cause] for cause in causes]
        self.say("fitting at growing windows " + " + ".join(map(str, chosen)))
        for stage in self.setting.stages[:-1]:
            found = self._fitted(chosen, values, None, stage)
            if found.fit.reason:
                break
            values = grouped(found)
        return values

    def again(
        self,
        causes: Sequence[int],
        values: Sequence[Mapping[str, float]],
        starts: Sequence[Array] | None,
    ) -> Refined:
        """A known structure fitted from other ``values`` (SI, by key; as many as causes) and
        initial states of windows ``starts`` (W, 2n); the better of both fits is kept."""
        key = tuple(sorted(causes))
        found = self._fitted([self.known[cause] for cause in causes], values, starts)
        self.done[key] = min(self.done[key], found, key=_misfit)
        return self.done[key]

    def _fitted(
        self,
        causes: Sequence[Hypothesis],
        values: Sequence[Mapping[str, float]],
        starts: Sequence[Array] | None,
        stage: Stage | None = None,
    ) -> Refined:
        cuts = (stage or self.setting.stages[-1]).cuts
        model = self.setting.windows.machine.model
        return refine(model, causes, values, cuts, self.setting.sd, starts)

    def _best_part(self, key: Sequence[int]) -> Refined | None:
        """The structure that fits best of those known ones that hold only causes of this one."""
        parts = [
            trial
            for known, trial in self.done.items()
            if {*known} < {*key} and not trial.fit.reason
        ]
        return min(parts, key=_misfit, default=None)

    def along(self, trial: Refined) -> Problem:
        """The linear problem along the simulation of a structure, its own numbers always in."""
        key = tuple(sorted(self.causes(trial)))
        if key not in self._along:
            self._along = {key: around(self.setting, trial)}  # the last one: it is large
        return self._along[key]

    @property
    def count(self) -> int:
        """How many causes compete."""
        families = {cause.family for cause in self.setting.hypotheses if not cause.bent}
        return len(families) - len(self.doubles)

    def causes(self, trial: Refined) -> tuple[int, ...]:
        """The numbers of a structure's causes."""
        return tuple(map(self.index, trial.causes))

    def index(self, cause: Hypothesis) -> int:
        """The number of a cause; one that is not in the first list gets a new one."""
        if cause not in self.known:
            self.known.append(cause)
        return self.known.index(cause)


def _misfit(trial: Refined) -> float:
    """χ² of the fitted windows."""
    return trial.fit.train


def _joining(
    part: Refined, causes: Sequence[Hypothesis], values: Sequence[Mapping[str, float]]
) -> list[Mapping[str, float]]:
    """Where a structure begins that holds ``part``: there, and with next to none of the rest."""
    known = dict(zip(part.causes, grouped(part), strict=True))
    return [
        known[cause]
        if cause in known
        else {
            key: value * (1.0 if _shapes(key.split("@")[0], cause) else NEXT_TO_NONE)
            for key, value in row.items()
        }
        for cause, row in zip(causes, values, strict=True)
    ]


def _shapes(key: str, cause: Hypothesis) -> bool:
    """Whether a key shapes a law, rather than making it strong."""
    return key in ("phase", "asymmetry") or (key in cause.refined and key not in cause.tied)


def first_guess(problem: Problem, subset: Subset) -> list[dict[str, float]]:
    """The first guess of each cause of a subset, by key, SI."""
    rows, rest = [], list(subset.values)
    for index in subset.causes:
        count = len(problem.columns[index])
        rows.append(_begin(problem, index, rest[:count]))
        rest = rest[count:]
    return rows


def _begin(problem: Problem, index: int, values: Sequence[float]) -> dict[str, float]:
    """The first guess of a cause: shared keys at their mean over the recordings that have numbers
    of their own."""
    cause, columns = problem.hypotheses[index], problem.columns[index]
    numbers = np.reshape(values[: len(cause.terms)], (1, -1))
    if problem.places is not None and len(columns) > len(cause.terms):
        known = dict(zip(columns, values, strict=True))
        first = columns[: len(cause.terms)]
        numbers = np.array([[known[row[c]] for c in first] for row in problem.places.rows])
    # where one recording shows nothing of a cause the law still stands: it may divide by its key
    numbers = np.where(numbers == 0, NEXT_TO_NONE * np.mean(numbers, axis=0), numbers)
    each = [cause.values(list(row)) for row in numbers]
    row = {key: float(np.mean([one[key] for one in each])) for key in each[0]}
    if len(each) > 1:
        for name, one in zip(problem.recordings, each, strict=True):
            row |= {f"{key}@{name}": one[key] for key in cause.own}
        row |= {key: each[0][key] for key in cause.own}
    return row

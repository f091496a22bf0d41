"""What a search ends with: the selected structure, and by how much each other one is worse."""

from dataclasses import dataclass

from symhyb.correction.search.score import choice_of, piece_of, score, uncertain
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.places.hypotheses import Hypothesis

CLOSE_MOST = 8  # structures that are decided among, with the selected one


@dataclass(frozen=True, slots=True)
class Decision:
    """The structure that is selected (``selected``), the ``best`` by its score alone (convention
    may name another one), all that were refined (``trials``), and ``equals``: causes that no
    recording of this kind distinguishes from another one. ``count`` causes competed. Some trials
    may have been ``judged`` along whole recordings: by how much each is worse than the selected
    structure there. ``unmade`` are the comparisons, in words, that time did not allow: it then
    holds what was compared by then, and nothing may be claimed of it."""

    selected: Refined
    nothing: Refined
    trials: tuple[Refined, ...]
    equals: tuple[tuple[Hypothesis, Hypothesis], ...]
    log: tuple[str, ...]
    count: int = 1
    best: Refined | None = None
    judged: tuple[tuple[Refined, float], ...] = ()
    unmade: tuple[str, ...] = ()

    def behind(self, trial: Refined) -> float:
        """By how much the score of a trial is worse than the best: twice ln of the odds."""
        for known, worse in self.judged:
            if known is trial:
                return worse
        best = self.best or self.selected
        unit = piece_of(best)
        return score(trial, unit, self.count) - score(best, unit, self.count)

    def near(self, within: float) -> list[Refined]:
        """The structures beside the selected one that are less than ``within`` behind the best, the
        best of them first."""
        behind = [(self.behind(trial), i, trial) for i, trial in enumerate(self.trials)]
        return [
            trial
            for worse, _, trial in sorted(behind)
            if trial is not self.selected and not trial.fit.reason and worse < within
        ]

    def against(self, trial: Refined) -> float:
        """The same at even odds of a parameter and a law: an ``sd`` says how far a parameter may be
        off, and not how likely it is that it, rather than a law, is what acts."""
        if any(known is trial for known, _ in self.judged):
            return self.behind(trial)
        more = uncertain(trial) - uncertain(self.best or self.selected)
        return self.behind(trial) + more * choice_of(self.count)

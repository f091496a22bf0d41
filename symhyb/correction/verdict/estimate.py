"""The values of a chosen structure, from all windows, and which of its causes are reported."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.naming.findings import Named, doubtful, named
from symhyb.correction.naming.fleet_words import drift_sentence
from symhyb.correction.search.fleet import Outlier, drifting, widened
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.score import plain, weak
from symhyb.correction.search.setting import Setting, Stage
from symhyb.correction.search.trajectory import Refined, grouped, refine
from symhyb.correction.verdict.choice import Choice
from symhyb.correction.verdict.held import with_what_is_held
from symhyb.correction.verdict.whole import Completed, completed_over_all
from symhyb.correction.verdict.whole_words import added_sentence
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.judgement import NEAR_NOISE
from symhyb.model.vocabulary import KINDS
from symhyb.steps import Say


@dataclass(frozen=True, slots=True)
class Estimated:
    """The structure with its final values, the ``stage`` of windows that proves it, its causes in
    ``doubt``, which are not reported, sentences on numbers that change on the way, and what whole
    recordings added (``completed``), with the structure as it is ``seen`` in the windows then."""

    final: Refined
    stage: Stage
    doubt: frozenset[Hypothesis]
    drifts: tuple[str, ...]
    completed: Completed | None = None
    seen: Refined | None = None

    @property
    def windows(self) -> tuple[Refined, Sequence[Cut]]:
        """The structure as it was fitted on windows, and these."""
        return self.seen or self.final, self.stage.cuts

    @property
    def items(self) -> Sequence[Named]:
        """The effects that are reported."""
        causes = self.final.causes
        return [
            item for item in named(self.final) if not self.doubt & {causes[i] for i in item.causes}
        ]

    @property
    def tells(self) -> bool:
        """Whether any cause is reported."""
        return self.doubt < {*self.final.causes}


def estimate(prepared: Prepared, choice: Choice, say: Say) -> Estimated:
    """Fit the chosen structure to all windows; causes in doubt stay in, or they would bend the
    others."""
    completed = completed_over_all(prepared, choice, say)
    if completed is not None:
        return estimate_completed(prepared, choice, completed)
    final, stage = valued(choice.setting, choice.decision.selected, prepared)
    drift = drifting(prepared.model, final, stage, choice.setting.sd)
    held = with_what_is_held(prepared.model, choice.setting, final, stage)
    doubt = _doubt(choice, final) | _vague(held, _drifted(choice, final, drift)[0])
    final, more, said = _drifted(choice, held, drift)
    return Estimated(final, stage, doubt | more, said)


def estimate_completed(prepared: Prepared, choice: Choice, completed: Completed) -> Estimated:
    """Values of the structure with what whole recordings added to it, from whole recordings: in
    windows it hides, and bends the others. The addition is in doubt where it has a rival, and
    stays in all the same."""
    stage, final = choice.setting.stages[-1], completed.final
    final = replace(final, accuracy=choice.setting.accuracy)
    drift = drifting(prepared.model, final, stage, choice.setting.sd)
    doubt = _doubt(choice, final)
    final, more, moved = _drifted(choice, final, drift)
    if completed.rivals:
        doubt |= {completed.added}
    said = (added_sentence(prepared.model, completed), *moved)
    seen = refine(
        prepared.model,
        final.causes,
        grouped(final),
        stage.cuts,
        choice.setting.sd,
        choice.decision.selected.fit.starts,
    )
    return Estimated(final, stage, doubt | more, said, completed, seen)


def _doubt(choice: Choice, final: Refined) -> frozenset[Hypothesis]:
    """The causes that have rivals, or do not stand out of their deviations."""
    return frozenset({*doubtful(choice.decision), *(final.causes[i] for i in weak(final))})


def _vague(held: Refined, alone: Refined) -> frozenset[Hypothesis]:
    """The causes whose strength does not stand out of its deviation with what else the model is
    uncertain of (``held``); what bends a law separates it from that, if it stands out by itself
    (``alone``)."""
    straight = set(plain(alone))
    return frozenset(held.causes[i] for i in weak(held) if i in straight)


def _drifted(
    choice: Choice, final: Refined, drift: Outlier | None
) -> tuple[Refined, frozenset[Hypothesis], tuple[str, ...]]:
    """The structure where one of its numbers is not constant, the cause that is in doubt for that,
    and the sentence that says so."""
    if drift is None:
        return final, frozenset(), ()
    moved = final.causes[drift.cause]
    steady = moved.kind in KINDS and KINDS[moved.kind].steady
    if steady and choice.decision.selected.fit.scale > NEAR_NOISE:
        said = drift_sentence(final, drift, "so something else looks like it")
        return final, frozenset({moved}), (said,)
    return widened(final, drift), frozenset(), (drift_sentence(final, drift),)


def valued(setting: Setting, selected: Refined, prepared: Prepared) -> tuple[Refined, Stage]:
    """The selected structure refitted on all windows, at the window length that determines its
    values best: short windows carry more noise, long ones more of what the model still lacks. Where
    nothing more is lacking that is the longest."""
    best: tuple[float, Refined, Stage] | None = None
    for stage in reversed(setting.stages):
        starts = selected.fit.starts if stage is setting.stages[-1] else None
        trial = refine(
            prepared.model,
            selected.causes,
            grouped(selected),
            stage.cuts,
            setting.sd,
            starts,
            everything=True,
            careful=True,
        )
        spread = np.sqrt(np.diag(trial.fit.covariance))
        width = float(np.sum(np.log(np.maximum(spread, 1e-300)))) if spread.size else 0.0
        if not trial.fit.reason and (best is None or width < best[0] or not spread.size):
            best = width, trial, stage
        if best is not None and best[1].fit.scale < NEAR_NOISE:
            break
    if best is None:
        return selected, setting.stages[-1]
    return replace(best[1], accuracy=setting.accuracy), best[2]

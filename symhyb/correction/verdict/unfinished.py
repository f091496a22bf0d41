"""The diagnosis of a decision whose time was spent: what was compared, and what was not.

Every check that guards a claim was made, or nothing is claimed: the search ended, structures of
almost the same score were compared along whole recordings, and it is known what acts beyond. Where
one of them is missing, what fits best by then stands among the alternatives.
"""

from dataclasses import replace

from symhyb.correction.naming.fleet_words import repeats_said
from symhyb.correction.search.so_far import fits_best
from symhyb.correction.verdict.conclusion import concluded
from symhyb.correction.verdict.decided import Decided
from symhyb.correction.verdict.proof import Proof
from symhyb.correction.verdict.refusal import with_faults
from symhyb.deadline import budget_text
from symhyb.discrepancy.results import Budget, Diagnosis
from symhyb.discrepancy.words.wording import capital
from symhyb.model.types import Model

UNPROVEN = Proof((), None, float("nan"), float("nan"))


def nothing_compared(budget_s: float) -> Diagnosis:
    """The diagnosis where no structure was fitted within the budget, in s."""
    said = f"The time that was allowed ({budget_text(budget_s)}) was spent before any structure"
    budget = Budget(budget_s, ("all causes that may explain the recordings",))
    return Diagnosis("undecided", f"{said} was fitted: nothing was compared.", budget=budget)


def unfinished(model: Model, decided: Decided, budget_s: float) -> Diagnosis:
    """The diagnosis of a decision that lacks comparisons, for which the budget, in s, did not
    suffice: it claims nothing but faults of recordings that were clear before anything was
    decided."""
    prepared, choice, judged = decided.prepared, decided.choice, decided.judged
    answer = concluded(model, prepared, choice, decided.known, UNPROVEN, (), judged)
    answer = replace(answer, misfits=choice.misfits, repeats=tuple(repeats_said(prepared)))
    rest = "" if judged.unjudged else " ".join(answer.remainder_notes)
    missing = "; ".join(decided.unmade)
    said = (
        f"The time that was allowed ({budget_text(budget_s)}) was spent before all comparisons were"
        f" made, so that nothing is claimed. Not compared: {missing}. "
        f"{capital(fits_best(choice.decision.selected, len(choice.decision.trials)))}. {rest}"
    ).rstrip()
    answer = replace(answer, verdict="undecided", remainder=1.0, log=(*answer.log, said))
    answer = with_faults(answer, model, prepared.faults, decided.known.final.fit.scale)
    faults = "; ".join(one.sentence for one in prepared.faults if one.claimed)
    wrong = f"The measurement is wrong: {faults}. " if faults else ""
    return replace(answer, sentence=wrong + said, budget=Budget(budget_s, decided.unmade))

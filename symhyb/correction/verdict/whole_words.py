"""What whole recordings added, in words and as alternatives where it has rivals."""

from symhyb.correction.naming.findings import alternative_of, cause_phrase
from symhyb.correction.verdict.whole import Completed
from symhyb.discrepancy.results import Alternative
from symhyb.discrepancy.words.amounts import capital, joined
from symhyb.discrepancy.words.wording import alternative_phrase
from symhyb.model.types import Model


def added_alternatives(model: Model, completed: Completed | None) -> tuple[Alternative, ...]:
    """The added cause and its rivals, best first; none where it has no rival: it is found."""
    if completed is None or not completed.rivals:
        return ()
    pairs = [(completed.final, 0.0), *completed.rivals]
    return tuple(
        alternative_of(model, trial, trial.causes[-1], max(evidence, 0.0))
        for trial, evidence in pairs
    )


def added_sentence(model: Model, completed: Completed) -> str:
    """Say what shows only over whole recordings."""
    rows = added_alternatives(model, completed)
    if not rows:
        said = cause_phrase(completed.added)
        return f"{capital(said)} shows only over the whole of a recording."
    rivals = joined([alternative_phrase(row) for row in rows], "or")
    return (
        "Over the whole of a recording one cause more shows, and these recordings cannot tell "
        f"which: {rivals}."
    )

"""What the report adds to the sentences of the diagnosis: scores, rivals, remainder, noise."""

import math
import re
from collections.abc import Mapping

from symhyb.discrepancy.results import Alternative, Verdict
from symhyb.discrepancy.words.wording import (
    UNKNOWN,
    alternative_phrase,
    capital,
    joined,
    number_text,
    percent_text,
    quantity_text,
)
from symhyb.report.contract import finite
from symhyb.report.series import shown_unit

DIGITS = 3  # of an error: more would claim to know it better than it is known
_BEFORE_UNIT = re.compile(
    r"(?<=[\d⁰¹²³⁴⁵⁶⁷⁸⁹)]) (?=(?:[µmk]?[mNVAsgJWK]|rad|Hz|deg)(?:[·/²³,.;:)]|\s|$))"
)
_AS_BEFORE = ", as before"
_TIE = 0.05  # a difference of the criterion that is nobody's win
_ODDS_SAID = 28.0  # difference of the criterion: beyond odds of a million to one they say no more
_LEVEL = 1.005  # two scores within this ratio are called the same


def score_sentences(verdict: Verdict, units: Mapping[str, str]) -> tuple[str, ...]:
    """Say how each score changed, on unseen recordings if there are any.

    ``units`` by sensor; an error is then given in the sensor's unit too.
    """
    scores = verdict.holdout or verdict.train
    where = "unseen recordings" if verdict.holdout else "the training recordings"
    before, after = scores.before, scores.after
    windows = [
        f"error of {name} {_change(before.window_nrmse.get(name), value, 'of its range')}"
        + _in_unit(before.window_rmse.get(name), after.window_rmse.get(name), units.get(name))
        for name, value in after.window_nrmse.items()
    ]
    runs = [
        f"error of {name} {_change(before.free_run_nrmse.get(name), value, 'of its range')}"
        + _in_unit(before.free_run_rmse.get(name), after.free_run_rmse.get(name), units.get(name))
        for name, value in after.free_run_nrmse.items()
    ]
    forces = [
        f"force left over on {name} "
        + _change(before.force_residual.get(name), value, "of the applied force")
        for name, value in after.force_residual.items()
    ]
    spoken = (
        (f"Over windows of {quantity_text(verdict.window_s, 's')} on {where}", windows),
        (f"In a free run on {where}", runs),
        (f"On {where}", forces),
    )
    unchanged = before == after  # nothing was corrected: there is no before
    return tuple(
        f"{opening}, the {joined(said)}.".replace(_AS_BEFORE, "" if unchanged else _AS_BEFORE)
        for opening, said in spoken
        if said
    )


def method_sentences(verdict: Verdict) -> tuple[str, ...]:
    """Say how each score is made, for without that a score means nothing."""
    band = finite(verdict.force_band_hz)
    through = "both through the same zero-phase low-pass"
    through += "" if band is None else f" at {quantity_text(band, 'Hz')}"
    windows = (
        "Window error: each recording is cut into windows of "
        f"{quantity_text(verdict.window_s, 's')}, each simulated by itself; RMSE over the range of "
        "the measurement (its largest minus its smallest value).",
    )
    return (
        "Force residual: the force that the model leaves over against the applied force, "
        f"‖ΔF‖ / ‖k_e‖, {through}. It does not depend on any simulation.",
        "Force error: the RMS of that force over the range that it has before the correction.",
        *(windows if math.isfinite(verdict.window_s) else ()),
        "Free run: each recording is simulated from its start to its end in one go; RMSE over the "
        "range of the measurement. Where nothing holds a coordinate in place, small errors add up "
        "without bound.",
        "Share of a found effect: by how much the squared window error on unseen data grows when "
        "the effect is left out and the rest fitted again, over that error uncorrected.",
        "Stays chosen: in how many of 400 random weighings of the windows the effect would be "
        "found again. With fewer than 80 % it is in doubt.",
        f"Initial states: {verdict.initial_states}.".replace("..", "."),
    )


def alternative_sentence(rival: Alternative, *others: Alternative) -> str:
    """Say a rival (with ``others`` that hold only together with it), what it would replace and by
    how much it is worse."""
    instead = f", instead of {rival.instead_of}" if rival.instead_of else ""
    said = f"{alternative_phrase(rival, *others)}{instead}"
    said = capital(said)
    if not math.isfinite(rival.evidence):
        return f"{said}."
    if abs(rival.evidence) < _TIE:
        if rival.instead_of is None:
            return f"{said}: a part of what fits best, and in doubt."
        return f"{said}: it explains the recordings equally well."
    worse = "worse" if rival.evidence > 0.0 else "better"
    odds = ""
    if 0.0 < rival.evidence < _ODDS_SAID:  # the criterion is -2 ln of a probability
        odds = f", odds of {number_text(math.exp(rival.evidence / 2.0), digits=2)} to 1 against it"
    amount = number_text(abs(rival.evidence), digits=DIGITS)
    return f"{said}: {worse} by {amount} in the criterion{odds}."


def remainder_sentence(share: float | None) -> str:
    """Say how much of the squared window error is still unexplained."""
    if finite(share) is None:
        return "Nothing was claimed of which the remainder could be stated."
    if share == 0.0:
        return "Over windows nothing is left of the mismatch beyond the noise."
    return f"Over windows {percent_text(share)} of the mismatch is still unexplained."


def typeset(sentence: str) -> str:
    """Keep ``±``, ``=``, ``%`` and units on the line of their number (no-break spaces)."""
    held = sentence.replace(" ± ", "\u00a0±\u00a0").replace(" %", "\u00a0%")
    held = held.replace(" = ", "\u00a0=\u00a0")
    return _BEFORE_UNIT.sub("\u00a0", held)


def error_text(value: float | None, unit: str) -> str:
    """Write an error with the prefix of its unit that reads best: ``0.94 mm`` for 9.4e-4 m."""
    known = finite(value)
    if known is None:
        return UNKNOWN
    factor, shown = shown_unit(abs(known), unit)
    if factor != 1.0 and shown.startswith("10"):  # no prefix: leave the power at the number
        return quantity_text(known, unit, digits=DIGITS)
    return f"{number_text(known / factor, digits=DIGITS)} {shown}".rstrip()


def _change(before: float | None, after: float | None, share: str) -> str:
    before, after = finite(before), finite(after)
    if before is None and after is None:
        return "could not be computed"
    if after is None:
        return f"was {percent_text(before)} {share} and could not be computed after the correction"
    if before is None:
        return f"could not be computed before the correction; after it, it is {percent_text(after)}"
    low, high = sorted((before, after))
    if high <= _LEVEL * low:
        return f"is {percent_text(after)} {share}{_AS_BEFORE}"
    verb = "falls" if after < before else "rises"
    return f"{verb} from {percent_text(before)} to {percent_text(after)} {share}"


def _in_unit(before: float | None, after: float | None, unit: str | None) -> str:
    if unit is None or finite(before) is None or finite(after) is None:
        return ""
    texts = dict.fromkeys((error_text(before, unit), error_text(after, unit)))
    return f" ({' to '.join(texts)})"

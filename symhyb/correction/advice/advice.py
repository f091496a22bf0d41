"""What to record next, in words and for a program: from what could not be distinguished."""

from collections.abc import Sequence
from dataclasses import replace
from math import exp, inf

import numpy as np

from symhyb.correction.advice.bounds import bounds_of
from symhyb.correction.advice.manoeuvre import Design, Expected, Rivals, design
from symhyb.correction.advice.newsensor import telling_sensor
from symhyb.correction.naming.findings import cause_phrase, rivals_of
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.selection import many
from symhyb.correction.search.setting import Setting
from symhyb.discrepancy.recorded.passages import one_way
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.results import Manoeuvre
from symhyb.discrepancy.words.wording import capital, joined, number_text, quantity_text
from symhyb.judgement import AMPLE, OUTSTANDING, PERIODS_LEAST, SAMPLES_TELL, SIGNIFICANT
from symhyb.model.types import Model

PAIRS_MOST = 3  # rivals of the selected structure that a manoeuvre is designed for
ODDS_SHOWN = 1e6
CLOSED = (
    "No manoeuvre is worked out, for the equations of the machine are known along these "
    "recordings alone; record other amplitudes and frequencies."
)


def advise(
    prepared: Prepared, setting: Setting, decision: Decision
) -> tuple[str | None, Manoeuvre | None]:
    """The manoeuvre that separates the selected structure from its rivals, as a sentence and for a
    program; both None where there is no rival or a structure has many causes, of which each trial
    of a manoeuvre would cost a fit, and no manoeuvre where only another sensor would help, or where
    the equations hold along the recordings alone."""
    pairs = _pairs(decision)
    if not pairs or any(many(one.causes) for pair in pairs for one in (pair.first, pair.second)):
        return None, None
    if any(item.local for item in prepared.model.inputs):
        return CLOSED, None
    found = design(prepared, setting, pairs)
    if found.expected is None:
        return no_manoeuvre(prepared, setting, pairs, found), None
    plan = _said(found.expected, pairs, bounds_of(prepared).stated)
    return plan.sentence, plan


def _pairs(decision: Decision) -> list[Rivals]:
    """The selected structure with each rival that is not ranked by convention alone, the closest
    first."""
    pairs = []
    for change, evidence, trial in sorted(rivals_of(decision), key=lambda rival: rival[1]):
        if not change.conventional and not trial.fit.reason and evidence < SIGNIFICANT:
            lost, fresh = (
                joined([cause_phrase(cause) for cause in side])
                for side in (change.lost, change.fresh)
            )
            pairs.append(Rivals(decision.selected, trial, (lost, fresh)))
    return pairs[:PAIRS_MOST]


def _said(expected: Expected, pairs: Sequence[Rivals], stated: Sequence[str]) -> Manoeuvre:
    """The manoeuvre with what it separates, and its sentence; ``stated`` are the channels for
    which the model file states how far they may go."""
    decided = [pair for pair, ok in zip(pairs, expected.decided, strict=True) if ok]
    open_ = [pair for pair, ok in zip(pairs, expected.decided, strict=True) if not ok]
    least = min(e for e, ok in zip(expected.evidence, expected.decided, strict=True) if ok)
    names = tuple(dict.fromkeys(name for pair in decided for name in pair.names))
    others = joined(list(dict.fromkeys(pair.names[1] for pair in decided)))
    said = (
        f"{_action(expected.plan)}. This is expected to tell {names[0]} from {others} "
        f"with odds of {_odds(least)}."
    )
    if expected.plan.beyond and expected.plan.channel not in stated:
        said += " It asks more of the machine than what was recorded: check that it may."
    if open_:
        left = joined(list(dict.fromkeys(pair.names[1] for pair in open_)), "or")
        said += f" No manoeuvre that was tried tells it from {left}."
    return replace(expected.plan, between=names, evidence=float(least), sentence=said)


def _odds(evidence: float) -> str:
    odds = exp(min(evidence, 700.0))
    if odds >= ODDS_SHOWN:
        return "more than a million to one"
    return f"{number_text(odds, digits=2)} to one"


def _action(plan: Manoeuvre) -> str:
    """The first sentence: what to do with which channel."""
    size, rate = quantity_text(plan.amplitude, plan.unit), number_text(1 / plan.sampling)
    lasting = f"{quantity_text(plan.duration, 's')} at {rate} samples a second"
    if plan.signal == "release":
        return (
            f"Pull {plan.channel} {size} away from where it rests, let it go with no drive, and "
            f"record {lasting} from the release on"
        )
    lo, hi = plan.frequency or (0.0, 0.0)
    one, band = quantity_text(lo, "Hz"), f"from {number_text(lo)} to {quantity_text(hi, 'Hz')}"
    period = quantity_text(1 / lo, "s", digits=3)
    signal = {
        "sine": f"a sine of {size} at {one}",
        "sweep": f"a sine of {size} that sweeps {band}, evenly in octaves",
        "multisine": f"a multisine with a peak of {size}, eight lines {band}",
        "steps": f"steps of +{size}, 0, −{size} and 0, each held for "
        f"{quantity_text(1 / lo / 4, 's', digits=3)}",
        "triangle": f"a slow triangle between +{size} and −{size} with a period of {period}",
    }[plan.signal]
    about = f" about {quantity_text(plan.offset, plan.unit)}" if plan.offset else ""
    return f"Drive {plan.channel} with {signal}{about}, from rest, for {lasting}"


def no_manoeuvre(
    prepared: Prepared, setting: Setting, pairs: Sequence[Rivals], found: Design
) -> str:
    """What is said where no manoeuvre separates any pair: what hinders them, and which sensor
    would."""
    first, second = pairs[0].names
    within = "the travel, speed and acceleration that were recorded"
    if prepared.model.limits:
        within = f"the limits of the model file and {within} where it states none"
    said = f"No manoeuvre within {within} tells {first} from {second}"
    more = ""
    if found.hindered:
        more = (
            f" Larger ones would exceed {found.hindered}: if the machine may do more than that, "
            "state it under [limits] of the model file."
        )
    if not found.playable:
        return f"{said}: none that is worth recording stays within them.{more}"
    sensor = telling_sensor(prepared, setting, pairs[0])
    if sensor is None:
        return f"{said}, nor would a further sensor of a coordinate's motion.{more}"
    words, plan = sensor
    return f"{said}; a further sensor of {words} would. {_action(plan)}.{more}"


def better_recording(prepared: Prepared) -> str:
    """What a recording must be to decide anything, where those at hand are too short or too
    noisy."""
    model: Model = prepared.model
    slowest = max(float(run.motion.periods().max()) for run in prepared.runs)
    lasts = sum(run.recording.duration for run in prepared.runs)
    samples = sum(run.recording.t.size for run in prepared.runs)
    wishes = []
    if all(one_way(run.motion) for run in prepared.runs):
        if samples < SAMPLES_TELL:
            wishes.append(_more_passages(prepared.runs))
    elif lasts < PERIODS_LEAST * slowest or samples < SAMPLES_TELL:
        length = quantity_text(AMPLE * slowest, "s", digits=2)
        wishes.append(
            f"a run of at least {length}, ten periods of the slowest motion, with at least "
            f"{SAMPLES_TELL} samples (these last {quantity_text(lasts, 's', digits=2)} and have "
            f"{samples})"
        )
    for j, sensor in enumerate(model.sensors):
        ratio, spread = _signal(prepared, j)
        if ratio < OUTSTANDING:
            wanted = quantity_text(
                spread / max(ratio, 1e-9) * (AMPLE * OUTSTANDING) / sensor.unit.factor,
                sensor.unit.text,
                digits=2,
            )
            wishes.append(
                f"a drive under which {sensor.name} spreads by at least {wanted} (standard "
                f"deviation), {AMPLE * OUTSTANDING:g} times its noise; now it is "
                f"{number_text(ratio, digits=2)} times"
            )
    first = joined(wishes[:3])
    return f"{capital(first)}." if first else ""


def _more_passages(runs: Sequence[Run]) -> str:
    """What to record where nothing comes back, so that no run can be made longer."""
    lasts = quantity_text(sum(run.recording.duration for run in runs), "s", digits=2)
    samples = sum(run.recording.t.size for run in runs)
    return (
        "more runs that pass the same places at other speeds (this motion goes one way and has no "
        f"period), with at least {SAMPLES_TELL} samples together (these last {lasts} and have "
        f"{samples})"
    )


def other_speeds(runs: Sequence[Run]) -> str:
    """The advice for recordings that pass every place at one speed."""
    said = _more_passages(runs)
    return f"{capital(said)}."


def _signal(prepared: Prepared, j: int) -> tuple[float, float]:
    """Largest spread of a sensor over its noise (inf if it recorded nothing), and that, SI."""
    name, best = prepared.model.sensors[j].name, (-inf, 0.0)
    for run in prepared.runs:
        values = run.recording.sensors.get(name)
        if values is not None and np.isfinite(run.motion.sd[j]) and run.motion.sd[j] > 0:
            spread = float(np.nanstd(values))
            best = max(best, (spread / float(run.motion.sd[j]), spread))
    return best if best[0] > -inf else (inf, 0.0)

"""What a block of a source says of the causes: a model, lowered with all of them, along a block."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.naming.findings import cause_phrase
from symhyb.correction.search.conventions import indistinguishable, with_twins
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.setting import Setting, Stage, along_motion
from symhyb.correction.search.twins import exact_twins
from symhyb.data.recording import Recording
from symhyb.data.thin import thinned
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.runs import cut_within
from symhyb.discrepancy.words.amounts import quantity_text, small_text
from symhyb.discrepancy.words.wording import joined
from symhyb.errors import InputError, Problem
from symhyb.model.closed import require_open
from symhyb.model.types import Model, Parameter
from symhyb.model.vocabulary import force_unit, key_of
from symhyb.monitoring.changes import Block, Causes, Reference
from symhyb.monitoring.events import Amount
from symhyb.monitoring.play import is_law, is_play, play_of, play_phrase, plays
from symhyb.numeric.kernels.buffers import Array

WINDOWS_BLOCK = 1.25  # that a block lasts at least: its ends belong to no window
SAMPLES_BLOCK = 60


@dataclass(frozen=True, slots=True, eq=False)
class Gauge:
    """A model made ready to be held beside its machine: the ``prepared`` reference, the causes and
    windows of ``setting``, one ``stage`` of which measures, and the ``hypotheses`` that compete, in
    the order of ``causes``; blocks average ``thinning`` samples."""

    prepared: Prepared
    setting: Setting
    stage: Stage
    hypotheses: tuple[Hypothesis, ...]
    causes: Causes
    thinning: int

    @property
    def block_s(self) -> float:
        """How long a block lasts at least, s."""
        step = float(np.median(np.diff(self.prepared.runs[0].recording.t)))
        return max(WINDOWS_BLOCK * self.stage.length_s, SAMPLES_BLOCK * step)


def gauge_of(model: Model, reference: Recording) -> Gauge:
    """A model with all causes along a recording of the machine as it is.

    Raises:
        InputError: the model is an FMU; the recording does not show the motion, or a fault of it
            that must be put right first.
    """
    require_open(model)
    prepared = prepare(model, reference)
    if claimed := [fault for fault in prepared.faults if fault.claimed]:
        cure = joined([fault.sentence for fault in claimed])
        raise InputError(Problem(f"{cure}: put that right before the machine is watched"))
    setting = settle(prepared, besides=plays(prepared.model))
    stage = setting.stages[min(1, len(setting.stages) - 1)]
    problem = along_motion(setting, stage)
    gone = {second for _, second in with_twins(indistinguishable(problem), exact_twins(setting))}
    kept = [
        i
        for i, cause in enumerate(problem.hypotheses)
        if i not in gone | setting.bent and not (cause.points or cause.variant or is_law(cause))
    ]
    step = float(np.median(np.diff(prepared.runs[0].recording.t)))
    thinning = max(round(step / float(np.median(np.diff(reference.t)))), 1)
    hypotheses = tuple(problem.hypotheses[i] for i in kept)
    columns = tuple(problem.columns[i] for i in kept)
    more = [one.numbers - len(own) for one, own in zip(hypotheses, columns, strict=True)]
    price = 2 * np.log(max(len(kept), 2)) * np.array(more, float)
    return Gauge(prepared, setting, stage, hypotheses, Causes(columns, price), thinning)


def block_of(gauge: Gauge, recording: Recording) -> Block | None:
    """A block of the source, reduced; None where it holds no whole window."""
    run = gauge.prepared.runs[0]
    short = thinned(recording, gauge.thinning)
    try:
        motion = motion_of(short, gauge.prepared.machine, [run.motion.spacing_s])
    except InputError:
        return None
    cut = cut_within(
        replace(run, recording=short, motion=motion), gauge.prepared.machine, gauge.stage.length_s
    )
    if cut is None:
        return None
    problem = along_motion(gauge.setting, replace(gauge.stage, cuts=(cut,)))
    whole = problem.gram + problem.held
    if not np.isfinite(whole).all():
        return None
    last = len(whole) - 1
    # a gain does to a sensor what its whole motion is, or what an input does to it
    own = zip(problem.hypotheses, problem.columns, strict=True)
    gains = [column for cause, columns in own if cause.kind == "gain" for column in columns]
    moving = float(np.diag(whole)[gains].max(initial=0.0))
    begin, end = float(recording.t[0]), float(recording.t[-1])
    return Block(begin, end, whole[:last, :last], whole[:last, last], moving)


def amounts_of(gauge: Gauge, cause: int, size: Array, sd: Array) -> tuple[Amount, ...]:
    """By how much a cause acts otherwise (k,), SI, in the units of the model file."""
    one, model = gauge.hypotheses[cause], gauge.prepared.model
    if one.place is None:
        unit = _declared(model, one.path).unit
        return (
            Amount(one.path, float(size[0]) / unit.factor, float(sd[0]) / unit.factor, unit.text),
        )
    if is_play(one):
        return (play_of(model, one, float(size[0]), float(sd[0])),)
    rows = []
    for key, value, spread in zip(one.terms, size, sd, strict=False):
        # amplitudes of sine and cosine are terms that the model file has no keys for
        unit = one.unit(model, key) if key_of(one.kind, key) else force_unit(model, one.place)
        rows.append(Amount(key, float(value) / unit.factor, float(spread) / unit.factor, unit.text))
    return tuple(rows)


def values_of(gauge: Gauge, reference: Reference, blocks: Sequence[Block]) -> tuple[Amount, ...]:
    """The parameters that state an sd as these blocks show them together, in the units of the model
    file."""
    model = gauge.prepared.model
    own = [i for i, cause in enumerate(gauge.hypotheses) if cause.kind == "parameter"]
    columns = [gauge.causes.columns[i][0] for i in own]
    if not columns or not blocks:
        return ()
    information = np.sum([one.information for one in blocks], axis=0)[np.ix_(columns, columns)]
    score = np.sum([one.score for one in blocks], axis=0)[columns]
    inverse = np.linalg.pinv(information, hermitian=True)
    rows = []
    fitted = zip(own, columns, inverse @ score, np.diag(inverse), strict=True)
    for i, column, change, variance in fitted:
        item = _declared(model, gauge.hypotheses[i].path)
        spread = float(np.sqrt(variance * reference.scatter[column])) / item.unit.factor
        value = (item.si + float(change)) / item.unit.factor
        rows.append(Amount(item.path, value, spread, item.unit.text))
    return tuple(rows)


def phrase_of(cause: Hypothesis) -> str:
    """Name a cause without its numbers."""
    return play_phrase(cause) if is_play(cause) else cause_phrase(cause)


def change_phrase(gauge: Gauge, cause: int, amounts: Sequence[Amount]) -> str:
    """A change of a cause in words, with its size."""
    one = gauge.hypotheses[cause]
    text = small_text if is_play(one) else quantity_text
    by = joined([text(a.value, a.unit, a.sd) for a in amounts])
    if one.place is not None:
        return f"{phrase_of(one)} by {by}"
    item = _declared(gauge.prepared.model, one.path)
    stated = quantity_text(item.value, item.unit.text)
    return f"{cause_phrase(one)} by {by} (the model says {stated})"


def _declared(model: Model, path: str) -> Parameter:
    return next(item for item in model.all_parameters() if item.path == path)

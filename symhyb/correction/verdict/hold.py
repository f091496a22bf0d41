"""An input that is held from sample to sample, where that explains all that a model lacks.

A staircase of one sample is what `between = "held"` states in a model file. Everything is decided
once more with that; it is named where nothing acts beyond what is decided then, with the time for
which the record keeps a value: of a slow controller that is several samples. A staircase of several
samples that the record does not show is none of the recording's, and stays a class.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.judge import Adequacy
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.standing import inputs_of_elements
from symhyb.discrepancy.results import Diagnosis, Measurement
from symhyb.discrepancy.words.wording import verdict_sentence
from symhyb.judgement import CERTAIN, NOTABLE, PROBABLE
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array


def held_inputs(
    model: Model, recordings: Sequence[Recording], judged: Adequacy
) -> tuple[Measurement, ...]:
    """The inputs that are held for one sample, as what is wrong with the record of each: where a
    class says so most certainly, or where all that delays a channel is half of a sample, as a line
    between the samples of a staircase comes late; none where that is not the answer."""
    steps = np.array([float(np.median(np.diff(one.t))) for one in recordings])
    names = _certainly(judged, steps) or _half_a_sample_late(model, judged, steps)
    known = [model.inputs[name] for name in names]
    if any(item.between == "held" for item in known):
        return ()
    lasts = [(item.name, steps[0] * samples_kept(recordings, item.name)) for item in known]
    return tuple(Measurement(name, "held", float(hold), 0.0, "s") for name, hold in lasts)


def _certainly(judged: Adequacy, steps: Array) -> list[str]:
    """The inputs that are held for the one step (R,), s, of the recordings, by the likeliest
    class."""
    best = judged.classes[0] if judged.classes else None
    if best is None or best.generic.does != "holds":
        return []
    if not (best.whole and best.probability > PROBABLE and _same(steps, best.generic.figure)):
        return []
    return [str(best.generic.where), *filter(None, best.generic.other.split(" and "))]


def _half_a_sample_late(model: Model, judged: Adequacy, steps: Array) -> list[str]:
    """The inputs of all elements, where the structure has channels that are late, all by half of
    the steps (R,), s."""
    one = judged.structure
    if one is None:
        return []
    late = [cause.path for cause in one.causes if cause.kind == "delay"]
    halves = [_same(steps, 2 * float(one.p[one.machine.column(path)])) for path in late]
    return [*inputs_of_elements(model)] if halves and all(halves) else []


def _same(steps: Array, hold: float) -> bool:
    return bool(np.all(np.abs(steps - hold) < NOTABLE * hold))


def likelier(again: Adequacy, before: Adequacy) -> bool:
    """Whether nothing acts beyond what was decided with held inputs, and that is likelier, to 100
    to 1, than a structure beyond which nothing acted either."""
    if not again.adequate or again.structure is None or before.structure is None:
        return again.adequate
    gain = again.structure.evidence - before.structure.evidence
    return not before.adequate or gain > CERTAIN


def samples_kept(recordings: Sequence[Recording], name: str) -> int:
    """For how many samples the records of an input keep each of its values: the largest number that
    divides the way from every change to the next."""
    ways = 0
    for one in recordings:
        changes = np.flatnonzero(np.diff(one.inputs[name]))
        ways = int(np.gcd.reduce(np.diff(changes), initial=ways))
    return max(ways, 1)


def with_holds(model: Model, held: Sequence[Measurement]) -> Model:
    """The model with these inputs held from each sample to the next."""
    names = {one.channel for one in held}
    inputs = [replace(i, between="held") if i.name in names else i for i in model.inputs]
    return replace(model, inputs=tuple(inputs))


def with_held(answer: Diagnosis, held: Sequence[Measurement]) -> Diagnosis:
    """The diagnosis of the model with held inputs as that of the model as it was given."""
    measurement = (*held, *answer.measurement)
    verdict = "measurement" if answer.verdict == "nothing missing" else answer.verdict
    parts = answer.found, answer.parameters, measurement
    return replace(
        answer,
        verdict=verdict,
        sentence=verdict_sentence(verdict, *parts, answer.alternatives),
        measurement=measurement,
    )

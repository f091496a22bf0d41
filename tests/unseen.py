"""Unseen recordings replaced by noise: what is found must not notice.

Every study's test may use this: ``assert_unseen_chooses_nothing(path_of_study)``.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.diagnosis import diagnose
from symhyb.discrepancy.results import Diagnosis
from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.study import run as chain
from symhyb.study.file import read_study

Claims = dict[str, list[str]]


def noise_like(recording: Recording, seed: int = 0, scale: float = 1.0) -> Recording:
    """White noise in all channels of a recording, with the mean of each channel and ``scale`` times
    its standard deviation."""
    random = np.random.default_rng(seed)

    def drawn(values: NDArray[np.float64]) -> NDArray[np.float64]:
        seen = values[np.isfinite(values)]
        return seen.mean() + scale * seen.std() * random.standard_normal(values.size)

    return replace(
        recording,
        inputs={name: drawn(values) for name, values in recording.inputs.items()},
        sensors={name: drawn(values) for name, values in recording.sensors.items()},
        sha256="",
    )


def claims(diagnosis: Diagnosis) -> Claims:
    """All that is claimed, without what the unseen recordings are there to say: shares, and with
    them the order, also of what was withdrawn, and scores in the provenance of an element."""
    found = [
        replace(one, share=None, sentence="", element=replace(one.element, found=()))
        for one in diagnosis.found
    ]
    rest = (diagnosis.parameters, diagnosis.measurement, diagnosis.faults, diagnosis.misfits)
    return {
        "verdict": [diagnosis.verdict],
        "found": sorted(map(repr, found)),
        "rest": [repr(one) for group in rest for one in group],
        "alternatives": sorted(map(repr, diagnosis.alternatives)),
    }


def with_and_without(
    model: Model,
    train: Sequence[Recording],
    unseen: Sequence[Recording],
    own: Sequence[str] = (),
    scale: float = 1.0,
) -> tuple[Claims, Claims]:
    """What is claimed with the unseen recordings, and with noise in their place."""
    noise = [noise_like(one, seed, scale) for seed, one in enumerate(unseen)]
    return (
        claims(diagnose(model, train, unseen, own=own)),
        claims(diagnose(model, train, noise, own=own)),
    )


def assert_unseen_chooses_nothing(path: Path) -> None:
    """Run the diagnosis of a study twice, once with noise for its unseen recordings."""
    study = read_study(path)
    model = read_model(study.model)
    train, unseen = chain.read_all(study, model)
    assert unseen, f"{path} has no unseen recording"
    as_it_is, with_noise = with_and_without(model, train, unseen, study.own)
    assert with_noise == as_it_is

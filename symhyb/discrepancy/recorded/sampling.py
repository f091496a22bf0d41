"""How inputs run between their samples where the model file leaves that open."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.data.recording import Recording
from symhyb.model.types import Input, Model
from symhyb.numeric.runs.between import looks_smooth


def as_sampled(model: Model, recordings: Sequence[Recording]) -> Model:
    """The model in which every input that is left open is ``smooth`` between its samples where it
    looks so in all ``recordings``, else a ``line``; one that is constant in all is a line."""
    settled = tuple(
        item if item.between else replace(item, between=_looks(item, recordings))
        for item in model.inputs
    )
    return model if settled == model.inputs else replace(model, inputs=settled)


def _looks(item: Input, recordings: Sequence[Recording]) -> str:
    recorded = [(r.t, r.inputs[item.name]) for r in recordings if item.name in r.inputs]
    varying = [(t, values) for t, values in recorded if np.ptp(values) > 0]
    smooth = bool(varying) and all(looks_smooth(t, values) for t, values in varying)
    return "smooth" if smooth else "line"

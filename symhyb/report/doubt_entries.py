"""What a sceptic asks of a correction, as ``diagnosis.json`` holds it."""

import numpy as np

from symhyb.discrepancy.evidence import Correlations, Whiteness
from symhyb.discrepancy.results import RivalRun
from symhyb.report.document import (
    CorrelatedEntry,
    CorrelationsEntry,
    RivalEntry,
    WhitenessEntry,
)


def correlations_entry(known: Correlations | None) -> CorrelationsEntry | None:
    """Names and matrix; None where it is not known, or holds what is no number."""
    if known is None or not np.isfinite(known.matrix).all():
        return None
    return {"names": list(known.names), "matrix": known.matrix.tolist()}


def whiteness_entry(one: Whiteness) -> WhitenessEntry:
    """How a residual is correlated with itself and with the inputs."""

    def told(name: str) -> CorrelatedEntry:
        return {"largest": one.largest(name), "noise": one.noise(name)}

    return {
        "recording": one.recording,
        "sensor": one.sensor,
        "itself": told(""),
        "inputs": {name: told(name) for name in one.cross},
    }


def rival_entry(run: RivalRun) -> RivalEntry:
    """Where a rival would differ most from the chosen structure."""
    sensor, time, deviations = run.largest
    return {
        "causes": run.causes,
        "instead_of": run.instead_of,
        "evidence": run.evidence,
        "probability": run.probability,
        "recording": run.recording,
        "window_s": run.window_s,
        "sensor": sensor,
        "time_s": time,
        "deviations": deviations,
        "rms": dict(run.typical),
    }

"""What a fit of parameters shows, printed and as plain values."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from symhyb.discrepancy.results import Reestimated, Verdict
from symhyb.discrepancy.words.amounts import number_text, quantity_text
from symhyb.model.types import Model
from symhyb.report.contract import finite
from symhyb.report.sentences import score_sentences

if TYPE_CHECKING:  # a verb that only reads a file need not load the numerics
    from symhyb.correction.calibration import Calibrated

CORRELATED = 0.95  # from here on two parameters are hard to tell apart
UNTOLD = 0.9  # of the stated deviation: the recordings told hardly anything
LOUD = 2.0  # times the noise: what is left is no noise


def print_fit(done: "Calibrated", verdict: Verdict, model: Model) -> None:
    """Print fitted values, what to be careful about, and the errors before and after."""
    for line in _rows(done):
        print(f"  {line}")
    for sentence in (*fit_notes(done), *(fault.sentence for fault in done.faults)):
        print(f"note: {sentence}")
    print(
        f"Over windows the model left {times(done.before)} the noise, fitted it leaves"
        f" {times(done.after)} the noise."
    )
    units = {sensor.name: sensor.unit.text for sensor in model.sensors}
    for sentence in score_sentences(verdict, units):
        print(f"  {sentence}")


def fit_notes(done: "Calibrated") -> Iterator[str]:
    """Say which values are not to be relied on, and why."""
    for first, second, size in done.together(CORRELATED):
        yield (
            f"{second} and {first} can hardly be told apart by these recordings (correlation"
            f" {number_text(size, digits=3)}): a wrong value of one shifts the other"
        )
    for item, prior in zip(done.parameters, done.prior, strict=True):
        if prior is not None and item.sd > UNTOLD * prior:
            yield f"{item.name} is known from its stated sd alone; these recordings hardly show it"
    for name in done.bounds:
        yield f"{name} ends at the bound of what is possible; something else is wrong or missing"
    if done.after > LOUD**2:
        yield (
            "more than noise is left, so the deviations of these values are too small and the"
            " values make up for what is missing; symhyb diagnose looks for the cause"
        )


def fit_facts(done: "Calibrated") -> dict[str, Any]:
    """Give a fit as plain values; numbers that are not finite are null."""
    names = [item.name for item in done.parameters]
    return {
        "parameters": [
            {
                "name": item.name,
                "was": item.was,
                "value": item.value,
                "sd": finite(item.sd),
                "unit": item.unit,
                "stated_sd": prior,
            }
            for item, prior in zip(done.parameters, done.prior, strict=True)
        ],
        "correlation": {
            name: {other: finite(float(r)) for other, r in zip(names, row, strict=True)}
            for name, row in zip(names, done.correlation, strict=True)
        },
        "noise_multiple": {
            "before": finite(math.sqrt(done.before)),
            "after": finite(math.sqrt(done.after)),
        },
        "notes": [*fit_notes(done), *(fault.sentence for fault in done.faults)],
    }


def times(squares: float) -> str:
    """χ² per sample as a multiple of the noise: ``3.2 times``."""
    if not math.isfinite(squares):
        return "unboundedly more than"
    return f"{number_text(math.sqrt(squares), digits=2)} times"


def _rows(done: "Calibrated") -> Iterator[str]:
    width = max(len(item.name) for item in done.parameters)
    for item, prior in zip(done.parameters, done.prior, strict=True):
        value = quantity_text(item.value, item.unit, item.sd)
        yield f"{item.name:<{width}}  {value}  (was {_was(item, prior)})"


def _was(item: Reestimated, prior: float | None) -> str:
    return quantity_text(item.was, item.unit, prior, digits=6)

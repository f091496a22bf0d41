"""Last values of a corrected model: every number that is not certain, on every sample.

A decision works on as many windows as it needs and claims a parameter only where that is worth a
name. What was named then stands beside parameters that are known to their ``sd`` alone. Here the
numbers of found elements and all these parameters are fitted together, by simulation error over all
windows of the training recordings. Nothing is chosen and nothing is claimed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.asked import asked
from symhyb.correction.search.preparing import last_windows, prepare
from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.matching import fit
from symhyb.discrepancy.fitting.task import Task
from symhyb.errors import NumericsError
from symhyb.model.types import Model, Parameter
from symhyb.model.vocabulary import key_of
from symhyb.model.write import replace_parameters
from symhyb.numeric.runs.windows import WindowModel


@dataclass(frozen=True, slots=True)
class Finished:
    """The ``model`` with its last values, one deviation of each in the file; ``scale`` is χ² per
    sample that is left."""

    model: Model
    scale: float

    @property
    def sentence(self) -> str:
        """What was done, in words."""
        return (
            "The corrected model holds last values: the numbers of what was found and all "
            "parameters with a stated deviation, fitted together on all training recordings"
            + (f" (χ² per sample {self.scale:.4g})." if np.isfinite(self.scale) else ".")
        )


@asked
def finished(model: Model, recordings: Recording | Sequence[Recording]) -> Finished:
    """Fit the numbers of found elements, and the parameters of the model, that state an sd (a width
    that only smooths a law states none), on all windows.

    Raises:
        InputError: unusable recordings.
        NumericsError: the model cannot be simulated along them.
    """
    prepared = prepare(model, recordings)
    found = {element.name for element in model.elements if element.found}
    free = [
        item
        for item in model.all_parameters()
        if item.sd is not None and (item.owner in found or not item.owner)
    ]
    if not free:
        return Finished(model, float("nan"))
    machine = prepared.machine
    columns = tuple(machine.column(item.path) for item in free)
    cuts = tuple(item.suited(machine) for item in last_windows(prepared, spread=False))
    mean, spread = machine.values[list(columns)], np.array([_known(item, found) for item in free])
    lower, upper = np.array([_bounds(model, item) for item in free]).T
    task = Task(cuts, prepared.sd, lower, upper, mean, spread, everything=True)
    fitted = fit(WindowModel(machine, columns), task, machine.values)
    if fitted.reason:
        raise NumericsError(f"the corrected model cannot be simulated: {fitted.reason}")
    sds = np.sqrt(np.diag(fitted.covariance))
    changed = {
        item.path: (float(value) / item.unit.factor, float(sd) / item.unit.factor)
        for item, value, sd in zip(free, fitted.values, sds, strict=True)
    }
    return Finished(replace_parameters(model, changed), fitted.scale)


def _known(item: Parameter, found: set[str]) -> float:
    """What was known of a number before these recordings, as one deviation in SI: nothing of what
    comes from them."""
    fitted = item.owner in found or item.was is not None
    return np.inf if fitted else float(item.si_sd or np.inf)


def _bounds(model: Model, item: Parameter) -> tuple[float, float]:
    """What physics allows of a number of an element, SI; any value of a parameter of the model."""
    for element in model.elements:
        for key, value in element.values if element.name == item.owner else ():
            declared = key_of(element.kind, key) if value.text == item.name else None
            if declared is not None:
                return declared.lower, declared.upper
    return -np.inf, np.inf

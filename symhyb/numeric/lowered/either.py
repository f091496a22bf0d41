"""A model or its machine: what takes one takes the other."""

from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import Machine, build


def model_of(given: Model | Machine) -> Model:
    """The model, or that of a machine."""
    return given.model if isinstance(given, Machine) else given


def machine_of(given: Model | Machine) -> Machine:
    """The machine, or that of a model.

    Raises:
        InputError: as :func:`symhyb.numeric.lowered.machine.build`.
    """
    return given if isinstance(given, Machine) else build(given)

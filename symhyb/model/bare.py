"""A model that another program runs, without that: what can be said before it is asked."""

from dataclasses import replace

from symhyb.model.expression import parse_expression
from symhyb.model.local import Local
from symhyb.model.types import Energy, Model


def is_bare(model: Model) -> bool:
    """Whether a model that another program runs is without that."""
    return model.engine is not None and model.local == Local(())


def bare(model: Model) -> Model:
    """A model that an FMU or MuJoCo runs as if all its coordinates had a mass of 1 and nothing
    acted but its elements: what its sensors and elements say of a motion is the same. Any other as
    it is."""
    if model.engine is None:
        return model
    masses = " + ".join(f"{c.name}'**2" for c in model.coordinates)
    return replace(
        model,
        energy=Energy(kinetic=parse_expression(f"({masses})/2")),
        inputs=model.recorded_inputs,
        local=Local(()),
    )

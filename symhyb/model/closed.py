"""A model that an FMU or MuJoCo runs has no equations of its own: what needs them says so."""

from symhyb.errors import InputError, Problem
from symhyb.model.types import Model

CLOSED = (
    "the machine is run by another program, and its equations are known along recordings alone: "
    "diagnose, compare and judge work with it, and what was found can be exported; to simulate, "
    "run it there"
)


def require_open(model: Model) -> None:
    """Refuse a model that another program runs, if its equations along recordings are not known.

    Raises:
        InputError: the model is such a one.
    """
    if model.engine is not None and model.local is None:
        raise InputError(Problem(CLOSED, model.engine.section, model.file))

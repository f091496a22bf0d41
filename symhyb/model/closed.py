"""A model that is an FMU has no equations of its own: what needs them says so."""

from symhyb.errors import InputError, Problem
from symhyb.model.types import Model

CLOSED = (
    "the machine is an FMU, whose equations are known along recordings alone: diagnose, compare "
    "and judge work with it, and what was found can be exported; to simulate, run the FMU"
)


def require_open(model: Model) -> None:
    """Refuse an FMU whose equations along recordings are not known.

    Raises:
        InputError: the model is such a one.
    """
    if model.fmu is not None and model.local is None:
        raise InputError(Problem(CLOSED, "fmu", model.file))

"""What cannot hold the sampled states of a model says so."""

from symhyb.errors import InputError, Problem
from symhyb.model.types import Model

RECORDED = 'record what the controller puts out and give it as an input with between = "held"'

HOST = "export the machine without it, with what it puts out as an input, and let the host sample"


def require_unsampled(model: Model, what: str, cure: str = RECORDED) -> None:
    """Refuse a model with sampled states for ``what``; ``cure`` says what to do instead.

    Raises:
        InputError: the model has such states.
    """
    problems = [
        Problem(
            f"is sampled every {state.every:g} s, which {what} does not do; {cure}",
            f"states.{state.name}",
            model.file,
        )
        for state in model.states
        if state.next is not None
    ]
    if problems:
        raise InputError(problems)

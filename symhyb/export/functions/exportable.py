"""Which elements can be exported by themselves, and whose their inner states are."""

from collections.abc import Sequence

from symhyb.errors import InputError, Problem
from symhyb.model.types import Model
from symhyb.model.vocabulary import KINDS


def require_force_elements(model: Model, names: Sequence[str]) -> None:
    """Refuse elements, by name, whose force a host cannot apply as one.

    Raises:
        InputError: added masses, and elements that use an input with a delay.
    """
    problems = []
    for element in model.elements:
        if element.name in names and KINDS[element.kind].inertial:
            text = (
                f"the kind {element.kind} cannot be exported as a force element: its force depends "
                "on the acceleration, which the force itself changes; give the mass to a body of "
                "the host, or export the whole model (--whole)"
            )
            problems.append(Problem(text, f"elements.{element.name}", model.file))
    late = [i.name for i in model.inputs if i.delay is not None and i.delay.si != 0]
    for element in model.elements:
        if element.name not in names:
            continue
        said = repr([value.tree for _, value in element.values]) + repr(element.network)
        for name in late:
            if f"Name(name={name!r}" in said:
                text = f"uses the input {name}, which has a delay; let the host delay the signal"
                problems.append(Problem(text, f"elements.{element.name}", model.file))
    if problems:
        raise InputError(problems)


def owners(model: Model) -> list[str]:
    """The element that each inner state belongs to."""
    from symhyb.mechanics.symbols import symbols_of  # SymPy takes half a second to import

    return list(symbols_of(model).z)

"""Which elements can be exported by themselves, and whose their inner states are."""

from collections.abc import Sequence

from symhyb.errors import InputError, Problem
from symhyb.laws.base import State
from symhyb.model.types import Element, Model
from symhyb.model.vocabulary import KINDS, memories


def require_force_elements(model: Model, names: Sequence[str]) -> None:
    """Refuse elements, by name, whose force a host cannot apply as one.

    Raises:
        InputError: added masses, and elements that use an input with a delay or an actuator.
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
    left_out = left_to_host(model)
    for element in model.elements:
        if element.name not in names:
            continue
        said = repr([value.tree for _, value in element.values]) + repr(element.network)
        if any(_named(state.name) in said for state in model.states):
            said += repr([state.rate.tree for state in model.states])
        for name, (has, cure) in left_out.items():
            if _named(name) in said:
                text = f"uses the input {name}, which {has}; {cure}"
                problems.append(Problem(text, f"elements.{element.name}", model.file))
    if problems:
        raise InputError(problems)


def _named(name: str) -> str:
    """How a tree that contains a name is written."""
    return f"Name(name={name!r}"


def require_plain_inputs(model: Model) -> None:
    """Refuse inputs to which something is done before they act, which no exported model holds.

    Raises:
        InputError: inputs with a delay or an actuator.
    """
    problems = [
        Problem(f"{has}, which no exported model holds; {cure}", f"inputs.{name}", model.file)
        for name, (has, cure) in left_to_host(model).items()
    ]
    if problems:
        raise InputError(problems)


def left_to_host(model: Model) -> dict[str, tuple[str, str]]:
    """Of each input what a host has to do to the signal before it gives it: what it has, and the
    cure, in words."""
    found = {}
    for item in model.inputs:
        if item.delay is not None and item.delay.si != 0:
            found[item.name] = "has a delay", "let the host delay the signal"
        acts = [number.name.replace("_", " ") for number in item.actuator if number.si != 0]
        if acts:
            said = f"has an actuator ({', '.join(acts)})"
            found[item.name] = said, "let the host give the signal that comes out of it"
    return found


def owners(model: Model) -> list[tuple[str, str]]:
    """What each entry of z is: ("s", a declared state) or ("z", an inner one)."""
    remembering = [("z", name_of(*one)) for one in memories(model)]
    return [("s", state.name) for state in model.states] + remembering


def name_of(element: Element, state: State) -> str:
    """The name of an inner state outside: that of its element, and its own where that has more."""
    alone = len(KINDS[element.kind].states) == 1
    return element.name if alone else f"{element.name}.{state.name}"

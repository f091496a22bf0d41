"""What a loss that differs by direction is together with the one that the model has, in words."""

from collections.abc import Iterator, Sequence

from symhyb.correction.naming.findings import Named
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.places.standing import alike
from symhyb.discrepancy.words.amounts import quantity_text
from symhyb.model.trees import evaluate, names
from symhyb.model.types import Element, Model, place_text
from symhyb.model.vocabulary import KINDS, key_unit
from symhyb.numeric.kernels.buffers import Array

_DIGITS = 3  # of a sum of fitted numbers


def together(model: Model, final: Refined, items: Sequence[Named]) -> Iterator[str]:
    """A sentence for each reported loss that differs by direction beside one of its kind that the
    model has at its place: what both are, forward and backward."""
    for item in items:
        beside = alike(model, item.kind, item.place)
        if "asymmetry" not in item.values or not beside:
            continue
        law = KINDS[item.kind]
        key = law.strengths[0]
        unit = key_unit(model, item.kind, key, item.place)
        strengths = [(item.values[key][0], item.values["asymmetry"][0])]
        known = [_strength(final, element, key) for element in beside]
        strengths += [one for one in known if one is not None]
        if len(strengths) <= len(beside):  # one changes as the machine moves
            continue
        forward, backward = (
            sum(value * (1.0 + sign * asymmetry) for value, asymmetry in strengths) / unit.factor
            for sign in (1.0, -1.0)
        )
        amounts = [quantity_text(value, unit.text, digits=_DIGITS) for value in (forward, backward)]
        names = " and ".join(element.name for element in beside)
        yield (
            f"Together with {names}, this is {law.words} of {amounts[0]} forward and {amounts[1]} "
            f"backward {place_text(item.place)}."
        )


def _strength(final: Refined, element: Element, key: str) -> tuple[float, float] | None:
    """The strength and the asymmetry of an element of a fitted model, SI; None where an input, a
    state or the time changes them."""
    machine = final.machine
    known = dict(zip((p.path for p in machine.model.all_parameters()), final.p, strict=True))
    own = {p.name: known[f"{element.name}.{p.name}"] for p in element.parameters}
    values: dict[tuple[str, int] | str, Array | float] = {
        name: float(value) for name, value in (known | own).items()
    }
    tables = machine.model.characteristics()
    strength, asymmetry = (element.value(name) for name in (key, "asymmetry"))
    said = [name for text in (strength, asymmetry) if text is not None for name in names(text)]
    if not {name.name for name in said} <= values.keys():
        return None
    return (
        0.0 if strength is None else float(evaluate(strength, values, tables)),
        0.0 if asymmetry is None else float(evaluate(asymmetry, values, tables)),
    )

"""Which sensor would show a mode that was found, in words."""

from collections.abc import Sequence

from symhyb.discrepancy.results import Found
from symhyb.discrepancy.words.amounts import quantity_text
from symhyb.model.types import place_text


def sensors_of_modes(found: Sequence[Found]) -> tuple[str, ...]:
    """A sentence on each mode: its mass moves in no coordinate of the model, so that no sensor
    shows it; one on the part that swings would."""
    said = []
    for item in found:
        if item.element.kind == "mode":
            line = next(one for one in item.estimates if one.term == "frequency")
            at = quantity_text(line.value, "Hz", digits=2)
            said.append(
                f"{item.element.name} is seen by its force {place_text(item.element.place)} alone; "
                f"an accelerometer on what swings there near {at} would show which part it is"
            )
    return tuple(said)

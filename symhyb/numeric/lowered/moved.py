"""Sentences on where a model with constraints starts."""

from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array

REPORTED = 1e-3  # of a stated start: a smaller move is what rounding in the file leaves


def places_text(model: Model, q: Array) -> str:
    """Where a model is at q (n,), SI, in the units of its file."""
    return ", ".join(
        f"{c.name} = {value / c.unit.factor:.5g} {c.unit.text}".removesuffix(" 1")
        for c, value in zip(model.coordinates, q, strict=True)
    )


def moves(model: Model, q: Array, v: Array) -> tuple[str, ...]:
    """Notes on starts that the file states and that had to move to places q (n,) and speeds v (n,),
    SI, and on those left open."""
    moved, opened = [], []
    for c, place, speed in zip(model.coordinates, q, v, strict=True):
        unit = "" if c.unit.text == "1" else f" {c.unit}"
        rate = "/s" if not unit else f"{unit}/s"
        pairs = (("start", c.start, place, unit), ("start_rate", c.start_rate, speed, rate))
        for key, was, value, text in pairs:
            now = value / c.unit.factor
            least = REPORTED if key in c.stated else 1e-9
            if abs(now - was) <= least * max(abs(now), abs(was), 1e-6):
                continue
            said = f"{key} of {c.name} is {now:.6g}{text}"
            if key in c.stated:
                moved.append(f"{said}, not {was:.6g}")
            else:
                opened.append(said)
    notes = [f"so that the constraints hold, the {said}" for said in moved]
    if opened:
        notes.append(f"from the constraints: the {', the '.join(opened)}")
    return tuple(notes)

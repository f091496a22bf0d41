"""When, at which frequencies and beyond which amplitude a mismatch acts, in a sentence."""

from symhyb.discrepancy.results import Change
from symhyb.discrepancy.words.amounts import capital, joined, number_text, quantity_text, small_text
from symhyb.judgement import SMALL
from symhyb.model.expression import Expression, names
from symhyb.model.turned import Quaternion, Rotations
from symhyb.model.types import Body, Model, On, Place, place_text
from symhyb.model.vocabulary import stretch_unit

BURSTS_NAMED = 3


def place_words(model: Model, place: Place) -> str:
    """Say a place with the joint or body that it belongs to: ``on beta (joint of lower to
    upper)``."""
    said = place_text(place)
    if not isinstance(place, On) or not place.plain:
        return said
    owner = _owner(model, place.coordinate)
    return f"{said} ({owner})" if owner else said


def _owner(model: Model, coordinate: str) -> str:
    """The joint or body that a coordinate turns or moves; empty where several share it."""

    def moved(*expressions: Expression | None) -> bool:
        return any(
            item.name == coordinate
            for expression in expressions
            if expression is not None
            for item in names(expression)
        )

    def turning(body: Body) -> bool:
        match body.turned:
            case Rotations(steps):
                return moved(*(angle for _, angle in steps))
            case Quaternion(parts):
                return coordinate in parts
        return moved(body.angle)

    hung = [b for b in model.bodies if b.joint is not None]
    joints = [b for b in hung if turning(b) or moved(*(b.joint or ()))]
    if len(joints) == 1:
        return f"joint of {joints[0].name} to {joints[0].parent or 'the ground'}"
    turned = [b for b in model.bodies if b.joint is None and turning(b)]
    if len(turned) == 1 and not joints:
        return f"turn of {turned[0].name}"
    pushed = [b for b in model.bodies if b.joint is None and moved(*b.at)]
    return f"motion of {pushed[0].name}" if len(pushed) == 1 and not joints and not turned else ""


def occurrence_sentence(
    model: Model,
    place: Place,
    change: Change | None,
    band_hz: tuple[float, float] | None,
    line_hz: float,
    beyond: float | None,
    spans: tuple[tuple[float, float], ...] = (),
    duty: float = 1.0,
) -> str:
    """Say where, when, beyond what and at which frequencies a mismatch acts; empty if nothing sets
    it apart. ``line_hz`` is the resolution of the spectrum, ``duty`` the share of time in which it
    acts, ``spans`` these times in s."""
    parts = []
    if change is not None:
        parts.append(change_words(change))
    if beyond is not None:
        unit = stretch_unit(model, place)
        parts.append(f"acts only beyond {small_text(beyond / unit.factor, unit.text, digits=2)}")
    elif spans and duty < SMALL:
        times = joined([f"{number_text(a, digits=3)} s" for a, _ in spans[:BURSTS_NAMED]])
        more = f" and {len(spans) - BURSTS_NAMED} times more" if len(spans) > BURSTS_NAMED else ""
        parts.append(f"acts in bursts, at {times}{more}")
    if band_hz is not None:
        low, high = band_hz
        if high - low <= 2 * line_hz:
            parts.append(f"acts at {quantity_text((low + high) / 2, 'Hz', digits=2)}")
        else:
            said = f"{number_text(low, digits=2)} and {quantity_text(high, 'Hz', digits=2)}"
            parts.append(f"acts mostly between {said}")
    if not parts:
        return ""
    where = place_words(model, place)
    return f"{capital(where)}, the mismatch {joined(parts)}."


def change_words(change: Change) -> str:
    """``begins at t = 40.2 s (± 0.4 s)``."""
    at = number_text(change.time_s, digits=4)
    width = number_text(change.width_s, digits=2)
    return f"{change.kind} at t = {at} s of {change.recording} (to {width} s)"

r"""What instruments show of a lowered model: distances, directions, accelerometers, force cells.

An accelerometer shows the specific force a − g in the axes of a body:

    y' ^   ^ x'
        \ /   angle        resting upright (x' up): accelerometer_x = +9.81 m/s²
         o
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import casadi as ca

from symhyb.model.expression import Reading

if TYPE_CHECKING:
    from symhyb.numeric.lowered.translate import Lowered


def shown_by(
    lowered: Lowered, reading: Reading, reaction: ca.SX, coordinates: Sequence[str]
) -> ca.SX:
    """What one instrument reads, SI; ``reaction`` (n, 1) is the force that drives the
    ``coordinates``."""
    places, names, axis = lowered.places, reading.names, reading.what[-1]
    match reading.what:
        case "force":
            return lowered.strengths[names[0]]
        case "reaction":
            return reaction[coordinates.index(names[0])]
        case "orientation" | "gyroscope":
            angle = lowered.column([places.frames[names[0]].angle])
            return angle if reading.what == "orientation" else lowered.rate(angle)
        case "gyroscope_x" | "gyroscope_y" | "gyroscope_z":
            return lowered.column([places.attitude(names[0]).omega["xyz".index(axis)]])
        case "position_x" | "position_y" | "position_z":
            return lowered.column([places.points[names[0]]["xyz".index(axis)]])
        case "accelerometer_x" | "accelerometer_y" | "accelerometer_z":
            return _specific_force(lowered, names[0], names[1], axis)
    first, second = (lowered.column(places.points[name]) for name in names)
    if reading.what == "distance":
        return ca.norm_2(second - first)
    return ca.atan2(second[1] - first[1], second[0] - first[0])


def _specific_force(lowered: Lowered, point: str, body: str, axis: str) -> ca.SX:
    places = lowered.places
    velocity = lowered.rate(lowered.column(places.points[point]))
    pull = lowered.rate(velocity) + ca.jtimes(velocity, lowered.v, lowered.a)
    felt = pull - lowered.gravity
    if places.frames[body].attitude is not None:
        column = tuple(row["xyz".index(axis)] for row in places.attitude(body).axes)
        return ca.dot(lowered.column(column), felt)
    angle = lowered.column([places.frames[body].angle])
    c, s = ca.cos(angle), ca.sin(angle)
    return c * felt[0] + s * felt[1] if axis == "x" else c * felt[1] - s * felt[0]

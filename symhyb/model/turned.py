"""How a body in space is turned: what a model file declares."""

from dataclasses import dataclass

from symhyb.model.expression import Expression


@dataclass(frozen=True, slots=True)
class Rotations:
    """How a body in space is turned against what it hangs on: one rotation after the other, each
    about an axis ("x", "y", "z") of the body as the rotations before have turned it, by an angle
    (rad, counter-clockwise)."""

    steps: tuple[tuple[str, Expression], ...]


@dataclass(frozen=True, slots=True)
class Quaternion:
    """How a body in space is turned: four coordinates w, x, y, z of a quaternion, by name. Only
    its direction counts, so that its length does not matter to the physics."""

    parts: tuple[str, ...]

"""Where the parts of a machine are, in numbers: what a drawing needs, without any equation.

Sizes: n coordinates; d = 2 in the plane, 3 in space.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from symhyb.model.expression import Expression, evaluate
from symhyb.model.space import dimension
from symhyb.model.turned import Quaternion, Rotations
from symhyb.model.types import Body, Model
from symhyb.report.series import Array

Values = dict[tuple[str, int] | str, Array | float]
ROUNDED = 1e-12  # components below this part of the largest are 0


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """The axes of a body: its ``origin`` (d,) in m and its ``axes`` (d, d) as columns,
    dimensionless, both in the inertial axes."""

    origin: Array
    axes: Array

    def place(self, local: Array) -> Array:
        """A position (d,) in m given in these axes, in the inertial ones."""
        return np.asarray(self.origin + self.axes @ local)


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """Frames and centres (d,) of the bodies and positions (d,) of points in m, by name."""

    frames: Mapping[str, Frame]
    centres: Mapping[str, Array]
    points: Mapping[str, Array]


def placed(model: Model, q: Array) -> Placed:
    """Place a machine whose coordinates are ``q`` (n,) in SI, at time 0 and without inputs."""
    values, size = _values(model, q), dimension(model)
    bodies = {body.name: body for body in model.bodies}
    frames: dict[str, Frame] = {"": Frame(np.zeros(size), np.eye(size))}

    def vector(parts: tuple[Expression, ...]) -> Array:
        return np.array([float(evaluate(part, values, model.characteristics())) for part in parts])

    def frame(name: str) -> Frame:
        if name not in frames:
            body = bodies[name]
            parent = frame(body.parent) if body.parent else frames[""]
            axes = parent.axes @ _turn(body, values, model, size)
            at = body.at if body.joint is None else body.joint
            origin = vector(at) if body.joint is None else parent.place(vector(at))
            frames[name] = Frame(origin, axes)
        return frames[name]

    for name in bodies:
        frame(name)
    centres = {
        name: frames[name].origin if body.joint is None else frames[name].place(vector(body.at))
        for name, body in bodies.items()
    }
    points = {
        point.name: frames[point.body].place(vector(point.at)) if point.body else vector(point.at)
        for point in model.points
    }
    return Placed(frames, centres, points)


def _values(model: Model, q: Array) -> Values:
    """What names in positions mean, SI; rates and inputs are 0."""
    values: Values = {"t": 0.0, "pi": float(np.pi)}
    values |= {item.name: item.si for item in model.parameters}
    values |= {item.name: 0.0 for item in model.inputs}
    for coordinate, place in zip(model.coordinates, q, strict=True):
        values[coordinate.name] = float(place)
        values[coordinate.name, 1] = values[coordinate.name, 2] = 0.0
    return values


def _turn(body: Body, values: Values, model: Model, size: int) -> Array:
    """The axes (d, d) of a body in those of what it hangs on."""

    def number(expression: Expression) -> float:
        return float(evaluate(expression, values, model.characteristics()))

    if size == 2:
        angle = 0.0 if body.angle is None else number(body.angle)
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, -s], [s, c]])
    match body.turned:
        case Rotations(steps):
            axes = np.eye(3)
            for axis, expression in steps:
                axes = axes @ _about("xyz".index(axis), number(expression))
            return axes
        case Quaternion(parts):
            return _quaternion(np.array([float(values[name]) for name in parts]))
    return np.eye(3)


def _about(axis: int, angle: float) -> Array:
    j, k = (axis + 1) % 3, (axis + 2) % 3
    axes = np.eye(3)
    axes[j, j] = axes[k, k] = np.cos(angle)
    axes[k, j], axes[j, k] = np.sin(angle), -np.sin(angle)
    return axes


def _quaternion(q: Array) -> Array:
    """The rotation matrix (3, 3) of a quaternion w, x, y, z (4,) of any length but 0."""
    w, x, y, z = q / max(float(np.linalg.norm(q)), 1e-300)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )

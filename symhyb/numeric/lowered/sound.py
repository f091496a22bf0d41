"""What a machine must have before anything is computed: mass everywhere, and finite forces."""

from collections.abc import Mapping

import casadi as ca
import numpy as np

from symhyb.errors import InputError, Problem
from symhyb.model.space import gimbal_lock
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array, call

SMALLEST = 1e-10  # scaled eigenvalue of M, below which it is singular


def require_sound(model: Model, functions: Mapping[str, ca.Function], p: Array) -> None:
    """Check a lowered model at its declared start with parameters ``p`` (P,), SI.

    Raises:
        InputError: a mass matrix that is singular, not positive definite or not finite, or a law
            that is not finite; names the coordinates or the elements.
    """
    q, v = (np.array(part) for part in model.start())
    _require_finite(model, functions, q, v, p)
    if "closure" in functions:
        _require_mass_beside(model, functions, q, p)
    else:
        _require_mass(model, functions["M"], q, p)


def _require_mass(model: Model, function: ca.Function, q: Array, p: Array) -> None:
    free = [i for i, c in enumerate(model.coordinates) if not c.imposed]
    if not free:
        return
    (mass,) = call(function, (q, 0.0, p))
    mass = mass[np.ix_(free, free)]
    names = [model.coordinates[i].name for i in free]
    if not np.all(np.isfinite(mass)):
        text = "the mass matrix is not finite at the start; look for a division by zero"
        raise InputError(Problem(text, "bodies", model.file))
    scale = np.sqrt(np.abs(np.diag(mass)))
    bare = [name for name, size in zip(names, scale, strict=True) if size == 0]
    if bare:
        text = (
            f"the mass matrix is singular: nothing that moves with {', '.join(bare)} has mass; "
            "give a body there a mass or an inertia"
        )
        raise InputError(Problem(text, "bodies", model.file))
    locked = gimbal_lock(
        model, {c.name: float(x) for c, x in zip(model.coordinates, q, strict=True)}
    )
    if locked:
        text = f"the mass matrix is singular at the start: {locked}, or start elsewhere"
        raise InputError(Problem(text, "bodies", model.file))
    balanced = mass / np.outer(scale, scale)
    values, vectors = np.linalg.eigh((balanced + balanced.T) / 2)
    if values[0] < SMALLEST:
        worst = np.argsort(-np.abs(vectors[:, 0]))
        named = [names[i] for i in worst if abs(vectors[i, 0]) > 0.3]
        text = (
            f"the mass matrix is singular or not positive definite in {', '.join(named)} "
            f"(smallest scaled eigenvalue {values[0]:.3g}); two coordinates may move one mass"
        )
        raise InputError(Problem(text, "bodies", model.file))


def _require_mass_beside(
    model: Model, functions: Mapping[str, ca.Function], q: Array, p: Array
) -> None:
    """With constraints M may be singular, but not in a direction that they leave free; a coordinate
    that moves mass only together with others is no direction that :mod:`constrained` can solve."""
    free = [i for i, c in enumerate(model.coordinates) if not c.imposed]
    (mass,), still = call(functions["M"], (q, 0.0, p)), 0 * q
    slope = call(functions["closure"], (q, still, still, 0.0, p))[3].T[:, free]
    mass = mass[np.ix_(free, free)]
    if not np.all(np.isfinite(mass)) or np.all(np.diag(mass) > 0):
        _require_mass(model, functions["M"], q, p)
        return
    mass = mass + slope.T @ slope
    scale = np.sqrt(np.diag(mass))
    if np.all(scale > 0) and np.linalg.eigvalsh(mass / np.outer(scale, scale))[0] >= SMALLEST:
        return
    _, vectors = np.linalg.eigh(mass)
    names = [model.coordinates[i].name for i in free]
    named = [name for name, part in zip(names, vectors[:, 0], strict=True) if abs(part) > 0.3]
    text = (
        f"nothing that moves with {', '.join(named)} has mass, and no constraint ties it to what "
        "has; give a body there a mass or an inertia, or add a constraint"
    )
    raise InputError(Problem(text, "bodies", model.file))


def _require_finite(
    model: Model, functions: Mapping[str, ca.Function], q: Array, v: Array, p: Array
) -> None:
    """Forces at the start; an input may stand in a denominator, so it is tried at 0 and at 1."""
    (z,) = call(functions["inner_rest"], (q, v, 0.0, p))
    bad: list[bool] = []
    for level in (0.0, 1.0):
        u = np.full(len(model.inputs), level)
        (forces,) = call(functions["elements"], (q, v, z, u, 0.0, p))
        (inner,) = call(functions["inner"], (q, v, z, u, 0.0, p))
        bad = [not np.isfinite(force).all() for force in forces]
        if not any(bad) and np.isfinite(inner).all():
            return
    problems = [
        Problem(
            f"the {element.kind} is not finite at the start (a division by zero, a root or a "
            "logarithm of a negative number, or a direction between two points that coincide); "
            "change the start or the law",
            f"elements.{element.name}",
            model.file,
        )
        for element, wrong in zip(model.elements, bad, strict=True)
        if wrong
    ]
    text = "an inner state is not finite at the start; look for a division by zero"
    raise InputError(problems or [Problem(text, "elements", model.file)])

"""Why an exact run ended early, in words."""

from collections.abc import Sequence
from typing import Any

import numpy as np

GROWN = 1e100  # SI


def chatters(recent: Sequence[tuple[float, tuple[str, ...]]]) -> str:
    """What changes without end: ``recent`` times, s, with the names of what changed then."""
    names = dict.fromkeys(name for _, changed in recent for name in changed)
    owners = ("states.", "gravity")
    places = ", ".join(n if n.startswith(owners) else f"elements.{n}" for n in names)
    return (
        f"{places} changed between sliding, holding, touching or jumping {len(recent)} times "
        f"between {recent[0][0]:.9g} and {recent[-1][0]:.9g} s and would do so without end (Zeno): "
        "simulate it smoothed, or with a damper or a stiffness that ends the chatter"
    )


def failure(solver: Any, message: str | None) -> str:
    """Why a solver failed, from its last state and its ``message``."""
    if not np.all(np.abs(solver.y) < GROWN) or "spacing" not in (message or ""):
        return f"the motion grew without bound at {solver.t:.6g} s"
    return (
        f"no step at {solver.t:.6g} s was small enough for the tolerance: the motion grows without "
        "bound or a force jumps"
    )


def tired(t: float, most: int) -> str:
    """That ``most`` steps were too few to get beyond ``t`` s."""
    return (
        f"more than {most} steps were needed to reach {t:.6g} s: the equations are stiff or chatter"
    )

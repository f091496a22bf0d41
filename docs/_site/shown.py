"""What a kind of element does, computed with its own law: force over stretch, rate or time.

The stretch goes as s = S sin(w t); laws with inner states are integrated along it, and the last
turn is shown, where the loop has closed.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np
from numpy.typing import NDArray

from _site.drawing import axis, drawn
from symhyb.laws.base import Law
from symhyb.laws.characteristic import through
from symhyb.laws.maths import NUMPY, Action, Motion
from symhyb.laws.surface import bilinear

STEPS = 2000  # of one turn
TURNS = 2
UNITS = {
    **{"s": "m", "s′": "m/s", "s″": "m/s²", "t": "s", "b": "m", "b′": "m/s"},
    "ω′": "rad/s²",  # where the stretch is an angle
}


@dataclass(frozen=True, slots=True)
class Drive:
    """How a law is shown: the amplitude of the stretch (m), its angular frequency (rad/s), what the
    force is drawn ``over``, and values of keys (SI) instead of those of the law's example."""

    stretch: float = 1.0
    pace: float = 1.0
    over: str = "s"
    values: Mapping[str, float] = field(default_factory=dict)
    options: Mapping[str, str] = field(default_factory=dict)


DRIVES: Mapping[str, Drive] = {
    "spring": Drive(0.4),
    "damper": Drive(over="s′"),
    "drag": Drive(over="s′"),
    "power": Drive(over="s′"),
    "damper_kinked": Drive(over="s′"),
    "eddy_brake": Drive(over="s′"),
    "flow_drag": Drive(4.0, over="s′"),
    "flow_lift": Drive(),
    "friction": Drive(over="s′", values={"transition": 0.03}),
    "gap": Drive(0.25, 0.02),
    "play": Drive(0.25),
    "hysteresis": Drive(0.1),
    "friction_dynamic": Drive(0.02),
    "relaxation": Drive(0.1, 5.0),
    "constant": Drive(),
    "harmonic": Drive(pace=5 * pi, over="t"),
    "ripple": Drive(0.3),
    "added_mass": Drive(over="s″"),
    "payload": Drive(over="s″"),
    "added_inertia": Drive(over="ω′"),
    "mode": Drive(pace=8.0),
    "hydromount": Drive(0.1, 25.0),
    "curve": Drive(over="s′", options={"over": "rate"}, values={"scale": 1.0}),
    "gyroscopic": Drive(over="b′"),
    "circulatory": Drive(over="b"),
    "skew_spring": Drive(over="b"),
    "skew_damper": Drive(over="b′"),
    "map": Drive(over="s′", values={"scale": 1.0}),
}
CURVE = ((-1.0, -900.0), (-0.33, -620.0), (0.0, 0.0), (0.33, 260.0), (1.0, 400.0))

GRID = (
    (-1.0, -0.5, 0.5, 1.0),  # of the stretch, m: it brakes harder at both ends
    (-1.0, -0.33, 0.0, 0.33, 1.0),  # of the rate, m/s
    tuple(tuple(f * force for _, force in CURVE) for f in (2.0, 1.0, 1.0, 1.5)),
)


@dataclass(frozen=True, slots=True)
class Shown:
    """A drawing, and the values with which it was made, SI."""

    svg: str
    values: Mapping[str, float]
    over: str


def shown(law: Law) -> Shown | None:
    """The drawing of a law; None of one that a model writes itself, or that nobody chose a motion
    for and that needs one."""
    drive = DRIVES.get(law.name)
    if drive is None or (law.action is None and law.coupling is None):
        return None
    values = {**law.example, **drive.values}
    columns, force = run(law, drive, values)
    x = columns[drive.over]
    order = np.argsort(x, kind="stable") if not law.states else slice(None)
    x, force = x[order], force[order]
    across = axis(drive.over, UNITS[drive.over], list(x))
    up = axis("F", "N·m" if law.turns else "N", list(force))
    return Shown(
        drawn(x, force, across, up, f"F of {law.name} over {drive.over}"), values, drive.over
    )


def run(
    law: Law, drive: Drive, values: Mapping[str, float]
) -> tuple[dict[str, NDArray[np.float64]], NDArray[np.float64]]:
    """Stretch, rate, acceleration and time of the last turn (N,), and the force there (N,), SI; of
    a pair those of its second stretch while the first stands still, and the force on that."""
    t = np.linspace(0.0, TURNS * 2 * pi / drive.pace, TURNS * STEPS + 1)
    s = drive.stretch * np.sin(drive.pace * t)
    r = drive.stretch * drive.pace * np.cos(drive.pace * t)
    a = -(drive.pace**2) * s
    last = slice(-STEPS - 1, None)
    if law.coupling is not None:
        still, moving = Motion(0 * s, 0 * r, (), t), Motion(s, r, (), t)
        push = law.coupling(still, moving, values).push[0]
        return {"b": s[last], "b′": r[last]}, push[last]
    given = dict(values)
    if law.name == "curve":
        given["curve"] = through("curve", *zip(*CURVE, strict=True))
    if law.name == "map":
        given["map"] = bilinear("map", *GRID)
    action = acting(law, drive, given, Motion(s, r, states(law, drive, given, t), t))
    force = np.broadcast_to(action.force + action.mass * a, t.shape)
    columns = {"s": s, "s′": r, "s″": a, "ω′": a, "t": t - t[last][0]}
    return {name: column[last] for name, column in columns.items()}, force[last]


def acting(law: Law, drive: Drive, values: Mapping[str, object], motion: Motion) -> Action:
    """What a law does along a motion."""
    assert law.action is not None
    return law.action(NUMPY, motion, values, drive.options)


def states(
    law: Law, drive: Drive, values: Mapping[str, object], t: NDArray[np.float64]
) -> tuple[NDArray[np.float64], ...]:
    """The inner states, each (N,), at the times ``t`` (N,), s, from rest, by the midpoint rule."""

    def rate(time: float, z: NDArray[np.float64]) -> NDArray[np.float64]:
        s = drive.stretch * np.sin(drive.pace * time)
        r = drive.stretch * drive.pace * np.cos(drive.pace * time)
        return np.array(acting(law, drive, values, Motion(s, r, tuple(z), time)).inner)

    found = np.zeros((t.size, len(law.states)))
    for i, h in enumerate(np.diff(t)):
        half = found[i] + h / 2 * rate(t[i], found[i])
        found[i + 1] = found[i] + h * rate(t[i] + h / 2, half)
    return tuple(found.T)

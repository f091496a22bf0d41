"""The real machine: MuJoCo computes the cart and its pole, dry friction of the rail is located.

MuJoCo gives mass matrix and forces of a state, and knows the damping of the pivot; its own dry
friction is a soft constraint and is not used. Between two reversals, sticks and releases of the
cart the motion is smooth, and SciPy's DOP853 integrates it. Shares no code with symhyb.

    q = (x, phi): place of the cart in m; angle of the pole in rad, 0 hanging, counter-clockwise
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

CART, POLE, ARM, INERTIA, GRAVITY = 0.60, 0.25, 0.30, 7.5e-3, 9.81  # kg, kg, m, kg·m², m/s²
COULOMB, DAMPING = 1.5, 4.0e-3  # concealed: N on the rail, N·m·s/rad in the pivot
TOLERANCES = {"method": "DOP853", "rtol": 1e-9, "atol": 1e-11}


def _built(damping: float) -> tuple[Any, Any]:
    text = (
        f'<mujoco><option gravity="0 {-GRAVITY!r} 0"/><worldbody><body>'
        '<joint type="slide" axis="1 0 0"/>'
        f'<inertial pos="0 0 0" mass="{CART!r}" diaginertia="1e-9 1e-9 1e-9"/>'
        f'<body><joint type="hinge" axis="0 0 1" damping="{damping!r}"/>'
        f'<inertial pos="0 {-ARM!r} 0" mass="{POLE!r}"'
        f' diaginertia="{INERTIA!r} {INERTIA!r} {INERTIA!r}"/>'
        "</body></body></worldbody></mujoco>"
    )
    model = mujoco.MjModel.from_xml_string(text)
    return model, mujoco.MjData(model)


@dataclass(frozen=True, slots=True)
class Machine:
    """The cart and its pole with what is concealed: ``coulomb`` N, ``damping`` N·m·s/rad."""

    coulomb: float = COULOMB
    damping: float = DAMPING
    parts: tuple[Any, Any] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", _built(self.damping))

    def forces(self, state: Array, push: float) -> tuple[Array, Array]:
        """Mass matrix (2, 2) and forces (2,), but for the friction of the rail."""
        model, data = self.parts
        data.qpos[:], data.qvel[:] = state[:2], state[2:]
        data.qfrc_applied[0] = push
        mujoco.mj_forward(model, data)
        mass = np.zeros((2, 2))
        mujoco.mj_fullM(model, data, mass)
        return mass, data.qfrc_applied + data.qfrc_passive - data.qfrc_bias

    def asked(self, state: Array, push: float) -> float:
        """The force in N that holds the cart, positive along x, if it is to stay at rest."""
        mass, acting = self.forces(state, push)
        return float(mass[0, 1] * acting[1] / mass[1, 1] - acting[0])

    def rates(self, state: Array, push: float, way: int) -> Array:
        """q', q'' where the cart slides one ``way`` (±1) or sticks (0)."""
        mass, acting = self.forces(state, push)
        if way == 0 and self.coulomb:
            return np.array([0.0, state[3], 0.0, acting[1] / mass[1, 1]])
        acting[0] -= way * self.coulomb
        return np.concatenate([state[2:], np.linalg.solve(mass, acting)])

    def way(self, state: Array, push: float) -> int:
        """+1 or −1 while the cart slides, or is about to; 0 while it sticks."""
        if state[2]:
            return int(np.sign(state[2]))
        asked = self.asked(state, push)
        # a release is located where |asked| = coulomb to rounding: it must not stick on
        return -int(np.sign(asked)) if abs(asked) > self.coulomb * (1 - 1e-9) else 0

    def advance(self, state: Array, push: tuple[float, float], h: float) -> Array:
        """The state (x, phi, x', phi') after h s, during which the force runs straight."""
        now, state = 0.0, np.array(state, float)

        def force(s: float) -> float:
            return push[0] + (push[1] - push[0]) * s / h

        while now < h:
            way = self.way(state, force(now))
            run = solve_ivp(
                lambda s, y: self.rates(y, force(s), way),  # noqa: B023  # used at once
                (now, h),
                state,
                events=self._event(way, force),
                **TOLERANCES,
            )
            now, state = float(run.t[-1]), run.y[:, -1].copy()
            if run.status == 1 and way:
                state[2] = 0.0  # the event says so, to rounding
        return state

    def _event(self, way: int, force: Callable[[float], float]) -> Any:
        """Where the cart stops, or where friction no longer holds it."""

        def stops(s: float, y: Array) -> float:
            return float(y[2]) * way

        def slips(s: float, y: Array) -> float:
            return self.coulomb - abs(self.asked(y, force(s)))

        event = stops if way else slips
        event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        return event if self.coulomb else None


def replay(machine: Machine, state: Array, push: Array, h: float) -> Array:
    """The states (K, 4) from the first, under a force (K,) in N that runs straight between its
    values every h s."""
    states = [np.array(state, float)]
    for pair in pairwise(push):
        states.append(machine.advance(states[-1], pair, h))
    return np.array(states)

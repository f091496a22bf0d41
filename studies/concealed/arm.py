"""A machine whose equations nobody wrote: MuJoCo gives mass matrix, forces and the tip's Jacobian.

The plant integrates what MuJoCo computes for a state, with the same located reversals of dry
friction as for all other machines; MuJoCo's own friction is a soft constraint and is not used.
MuJoCo is asked for one state after the other, so a draw takes longer than with equations by hand.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np
from laws import Array
from systems import Drive, System, Values

N = 3


@lru_cache(maxsize=8)
def _engine(m: float, l: float, r: float, J: float, g: float) -> tuple[Any, Any]:  # noqa: E741
    """MuJoCo's model and data of the arm in the plane of x and y, gravity along −y."""
    import mujoco

    text, closing = "", ""
    for i in range(N):
        text += f'<body pos="0 {-l if i else 0.0!r} 0"><joint type="hinge" axis="0 0 1"/>'
        text += f'<inertial pos="0 {-r!r} 0" mass="{m!r}" diaginertia="{J!r} {J!r} {J!r}"/>'
        closing += "</body>"
    text += f'<site name="tip" pos="0 {-l!r} 0"/>'
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option gravity="0 {-g!r} 0"><flag contact="disable"/></option>'
        f"<worldbody>{text}{closing}</worldbody></mujoco>"
    )
    return model, mujoco.MjData(model)


def _states(p: Values, q: Array) -> Iterator[tuple[int, Any, Any]]:
    """MuJoCo's model and data, placed into one state after the other."""
    import mujoco

    model, data = _engine(*(float(p[key]) for key in ("m", "l", "r", "J", "g")))
    for i, angles in enumerate(q.reshape(N, -1).T):
        data.qpos[:] = angles
        mujoco.mj_fwdPosition(model, data)
        yield i, model, data


def _mass(p: Values, q: Array) -> Array:
    import mujoco

    result = np.empty((q[0].size, N, N))
    for i, model, data in _states(p, q):
        mujoco.mj_fullM(model, data, result[i])
    return np.moveaxis(result, 0, -1).reshape(N, N, *q.shape[1:])


def _forces(p: Values, q: Array, v: Array, u: Array) -> Array:
    """Gravity, inertial forces, bearings, motors, band."""
    import mujoco

    weight, inertial = np.empty((2, q[0].size, N))
    rates = v.reshape(N, -1).T
    for i, model, data in _states(p, q):
        data.qvel[:] = 0.0
        mujoco.mj_fwdVelocity(model, data)
        weight[i] = -data.qfrc_bias
        data.qvel[:] = rates[i]
        mujoco.mj_fwdVelocity(model, data)
        inertial[i] = -data.qfrc_bias - weight[i]
    s, J = _band(p, q)
    shape = (N, *q.shape[1:])
    moved = [weight.T.reshape(shape), inertial.T.reshape(shape), -p["d"] * v]
    motors = [np.zeros(shape) for _ in range(N)]
    for k, row in enumerate(motors):
        row[k] = u[k]
    return np.array([*moved, *motors, -p["k_b"] * s * J])


def _band(p: Values, q: Array) -> tuple[Array, Array]:
    """From the post to the tip; stretch = distance − slack length."""
    import mujoco

    place, turn = np.empty((q[0].size, 2)), np.empty((q[0].size, 2, N))
    jacobian = np.empty((3, N))
    for i, model, data in _states(p, q):
        mujoco.mj_jacSite(model, data, jacobian, None, 0)
        place[i], turn[i] = data.site_xpos[0, :2], jacobian[:2]
    away = place - [p["post_x"], p["post_y"]]
    distance = np.linalg.norm(away, axis=1)
    J = np.einsum("bi,bin->nb", away / distance[:, None], turn)
    s = distance - p["l_b"]
    return s.reshape(q.shape[1:]), J.reshape(N, *q.shape[1:])


ARM = System(
    "arm",
    ("a", "b", "c"),
    _mass,
    _forces,
    Drive((0.3, 3.0), 0.35),
    inputs=("shoulder", "elbow", "wrist"),
    between={"post-tip": _band},
    start=(0.2, -0.1, 0.1),
    rate=150.0,
    duration=12.0,
)

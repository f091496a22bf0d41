"""What to simulate."""

from dataclasses import dataclass

import numpy as np

from symhyb.numeric.kernels.buffers import Array

LEFT = "the motion left the bounds that were set for it"


@dataclass(frozen=True, slots=True)
class Scenario:
    """What to simulate, SI: output times ``t`` (N,), start ``q``, ``v`` (n,), and inputs ``u``
    (K, k), as actuators get them, at times ``t_u`` (K,).

    ``scales`` (X,) are typical sizes of the states (q, v, z), else found by a rough run; ``z`` the
    inner states at the start, else those of a machine at rest; ``given`` (K, 3·g) places, speeds
    and accelerations of the g imposed coordinates at ``t_u``. ``bound`` (X,) are sizes of the
    states, SI, beyond which nobody wishes to know: there the run ends.
    """

    t: Array
    q: Array
    v: Array
    t_u: Array
    u: Array
    scales: Array | None = None
    z: Array | None = None
    given: Array | None = None
    bound: Array | None = None


def within(bound: Array | None, t: Array, x: Array) -> tuple[Array, str]:
    """States (N, X) at ``t`` (N,), NaN from where one is beyond its ``bound`` (X,), SI, and why the
    run ends there; empty if it does not."""
    if bound is None:
        return x, ""
    far = np.maximum.accumulate(~(np.abs(x) <= bound).all(axis=1))
    if not far.any():
        return x, ""
    return np.where(far[:, None], np.nan, x), f"{LEFT} by {t[np.argmax(far)]:.6g} s"


@dataclass(frozen=True, slots=True)
class Event:
    """A located transition: ``time`` in s, the ``element`` (of a gap with two stops: name.upper),
    and what it does: 'sticks', 'slides +', 'slides -', 'touches', 'lets go', 'presses again' or
    'leaves'."""

    time: float
    element: str
    transition: str

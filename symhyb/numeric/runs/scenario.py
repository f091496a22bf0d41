"""What to simulate."""

from dataclasses import dataclass

from symhyb.numeric.kernels.buffers import Array


@dataclass(frozen=True, slots=True)
class Scenario:
    """What to simulate, SI: output times ``t`` (N,), start ``q``, ``v`` (n,), and inputs ``u``
    (K, k) at times ``t_u`` (K,).

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

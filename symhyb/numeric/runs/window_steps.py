"""The integration steps of windows as functions with their slopes.

Of small machines a step is differentiated as a whole, and its slopes run along with it. Of large
ones that would be hundreds of thousands of instructions; their slopes follow from those of the
rates (:mod:`symhyb.numeric.kernels.collocation`), step by step along a run that is there already.

Sizes: S steps, X states, n coordinates, m sensors, F free parameters.
"""

from collections.abc import Sequence
from itertools import pairwise

import casadi as ca
import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.chains import Chains
from symhyb.numeric.kernels.collocation import collocated
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.lowered.steps import rate_slopes, rosenbrock_step, step_and_middle

RATES_LARGE = 1000  # instructions of the rates, from which on a step is not differentiated whole
STEPS_AT_ONCE = 4096
SAME = 1e-9  # of a drive or a step: less is rounding


class Steps:
    """The step functions of a form: each lowered when it is asked for, and once."""

    def __init__(self, form: StateForm, free: list[int]):
        self.sense = _sensing(form, free)
        self.large = form.rates().n_instructions() > RATES_LARGE
        self._form, self._free = form, free
        self._ready: dict[str, Chains] = {}
        self._rates: dict[bool, ca.Function] = {}

    def run(self, what: str) -> Chains:
        """The steps of chains: ``plain``, with slopes to ``fit``, or to ``screen``; of a large
        machine with the state in the ``middle`` instead of slopes."""
        if what not in self._ready:
            self._ready[what] = Chains(self._function(what))
        return self._ready[what]

    def slopes(
        self, states: Sequence[Array], given: Sequence[Array], p: Array, forces: bool
    ) -> list[Array]:
        """Slopes of steps of a large machine by x (S, X·X), free parameters (S, X·F) and, if asked
        for, test ``forces`` (S, X·n), columns one after the other, SI.

        ``states`` (S, X) are those before the steps, in their middle and after them; ``given`` the
        drive before and after (S, drive), times (S, 1) and lengths (S, 1) of the steps, s.
        """
        size, own = self._form.size, len(self._free)
        count = size + own + (self._form.machine.n if forces else 0)
        found = np.empty((len(given[3]), count, size))
        for begin in range(0, len(found), STEPS_AT_ONCE):
            rows = slice(begin, begin + STEPS_AT_ONCE)
            part = [x[rows] for x in states], [one[rows] for one in given]
            nodes = self._at_nodes(*part, p, forces)
            made = collocated(nodes, part[1][3][:, 0], len(self._form.free))
            found[rows] = made.transpose(0, 2, 1)
        ends = (0, size, size + own, count) if forces else (0, size, size + own)
        return [
            np.ascontiguousarray(found[:, a:b]).reshape(len(found), -1) for a, b in pairwise(ends)
        ]

    def _at_nodes(
        self, states: Sequence[Array], given: Sequence[Array], p: Array, forces: bool
    ) -> list[Array]:
        """Slopes of the rates before, in the middle of and after steps; where one step ends as the
        next begins they are taken once."""
        before, middle, after = states
        d0, d1, t, h = given
        size = np.abs(d0).max(axis=0, initial=1e-300)
        same = np.zeros(len(h), bool)
        same[:-1] = (
            (before[1:] == after[:-1]).all(axis=1)
            & (np.abs(d0[1:] - d1[:-1]) <= SAME * size).all(axis=1)
            & (np.abs(t[1:] - t[:-1] - h[:-1]) <= SAME * h[:-1]).all(axis=1)
        )
        last = ~same
        x = np.concatenate([before, middle, after[last]])
        d = np.concatenate([d0, (d0 + d1) / 2, d1[last]])
        times = np.concatenate([t, t + h / 2, (t + h)[last]])
        if forces not in self._rates:
            self._rates[forces] = rate_slopes(self._form, self._free, forces)
        (flat,) = along(self._rates[forces], (x, d, times, p), (3,), len(x))
        found = flat.reshape(len(x), -1, flat.shape[1]).swapaxes(1, 2)
        steps = len(h)
        ends = np.empty_like(found[:steps])
        ends[:-1][same[:-1]] = found[1:steps][same[:-1]]
        ends[last] = found[2 * steps :]
        return [found[:steps], found[steps : 2 * steps], ends]

    def _function(self, what: str) -> ca.Function:
        """(x, d0, d1, t, h, p) -> x after the step; for fits with its slopes by x and p, for
        screens also by a test force w; or with x in its middle."""
        if what == "middle":
            return step_and_middle(self._form)
        x, d0, t, p, w = self._form.symbols()
        d1, h = ca.SX.sym("d1", self._form.drive), ca.SX.sym("h")
        names = {"plain": "", "fit": "xp", "screen": "xpw"}[what]
        after = rosenbrock_step(self._form)(x, d0, d1, t, h, p, w)
        slopes = {"x": x, "p": p, "w": w}
        parts = [after, *(ca.jacobian(after, slopes[name]) for name in names)]
        if "p" in names:
            parts[2] = parts[2][:, self._free]
        parts = [ca.densify(ca.substitute(part, w, 0 * w)) for part in parts]
        return ca.Function(what, [x, d0, d1, t, h, p], parts, {"cse": True})


def _sensing(form: StateForm, free: list[int]) -> ca.Function:
    """(x, d, t, p) -> outputs (m), ∂/∂x (m, X), ∂/∂free (m, F), ∂/∂w (m, n)."""
    x, d, t, p, w = form.symbols()
    y, _ = form.outputs()(x, d, t, p, w)
    parts = [y, ca.jacobian(y, x), ca.jacobian(y, p)[:, free], ca.jacobian(y, w)]
    parts = [ca.densify(ca.substitute(part, w, 0 * w)) for part in parts]
    return ca.Function("sense", [x, d, t, p], parts, {"cse": True})

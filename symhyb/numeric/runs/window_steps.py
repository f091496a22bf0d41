"""The integration steps of windows as functions with their slopes.

Sizes: X states, n coordinates, m sensors, F free parameters.
"""

import casadi as ca

from symhyb.numeric.kernels.chains import Chains
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.lowered.steps import rosenbrock_step


class Steps:
    """The step functions of a form: each lowered when it is asked for, and once."""

    def __init__(self, form: StateForm, free: list[int]):
        self.sense = _sensing(form, free)
        self._form, self._free = form, free
        self._ready: dict[str, Chains] = {}

    def run(self, what: str) -> Chains:
        """The steps of chains: ``plain``, with slopes to ``fit``, or to ``screen``."""
        if what not in self._ready:
            self._ready[what] = Chains(self._function(what))
        return self._ready[what]

    def _function(self, what: str) -> ca.Function:
        """(x, d0, d1, t, h, p) -> x after the step; for fits with its slopes by x and p, for
        screens also by a test force w."""
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

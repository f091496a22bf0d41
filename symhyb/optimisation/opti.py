"""Runs inside CasADi's optimisers: a whole run as a function with both derivatives, and one step.

    run = whole_run(rollout)                    # (θ, x0, u) -> y, x; CVODES-like accuracy
    step = step_function(machine)               # (x, u0, u1, t, h, p) -> x; any derivative

A whole run has first derivatives only: ask IPOPT for ``hessian_approximation = limited-memory``.
Multiple shooting and collocation take the step, which is made of scalar operations, has all
derivatives and needs no compiler. Sizes: F free parameters, X states, k inputs, K their times,
N outputs, m sensors; CasADi's matrices have time along their columns.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.steps import rosenbrock_step
from symhyb.optimisation.rollout import KINDS, NAMES, Rollout, Slopes, varying


class WholeRun(ca.Callback):
    """What varies of (θ (F), x0 (X), u (k, K)) -> y (m, N), x (X, N), SI, as a CasADi function.

    CasADi holds no reference to it: keep it as long as what is built with it."""

    def __init__(self, rollout: Rollout, vary: Sequence[str] = KINDS):
        ca.Callback.__init__(self)
        self.rollout, self._vary = rollout, varying(vary)
        self._kept: list[ca.Callback] = []
        sizes = {
            "free": (rollout.theta.size, 1),
            "start": (rollout.start.size, 1),
            "inputs": rollout.inputs.shape[::-1],
        }
        self._takes = tuple(sizes[kind] for kind in self._vary)
        self._gives = rollout.shape[::-1], (rollout.start.size, rollout.t.size)
        self.construct("whole_run", {})

    def get_n_in(self) -> int:
        """Parameters, start, inputs, those that vary."""
        return len(self._takes)

    def get_n_out(self) -> int:
        """Sensors, states."""
        return 2

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        """Dense."""
        return ca.Sparsity.dense(*self._takes[i])

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        """Dense."""
        return ca.Sparsity.dense(*self._gives[i])

    def eval(self, arguments: Sequence[ca.DM]) -> list[ca.DM]:
        """Run."""
        given = _named(self._vary, arguments)
        return [ca.DM(self.rollout(**given).T), ca.DM(self.rollout.states(**given).T)]

    def has_reverse(self, count: int) -> bool:
        """One direction at a time."""
        return count == 1

    def has_forward(self, count: int) -> bool:
        """One direction at a time."""
        return count == 1

    def get_reverse(
        self,
        count: int,
        name: str,
        inputs: Sequence[str],
        outputs: Sequence[str],
        options: Mapping[str, Any],
    ) -> ca.Function:
        """(arguments, results, weights of results) -> slopes by the arguments."""
        places = (*self._takes, *self._gives, *self._gives), self._takes
        return self._keep(_Slope(self.rollout, self._vary, name, *places, backwards=True))

    def get_forward(
        self,
        count: int,
        name: str,
        inputs: Sequence[str],
        outputs: Sequence[str],
        options: Mapping[str, Any],
    ) -> ca.Function:
        """(arguments, results, changes of arguments) -> changes of the results."""
        places = (*self._takes, *self._gives, *self._takes), self._gives
        return self._keep(_Slope(self.rollout, self._vary, name, *places, backwards=False))

    def _keep(self, made: ca.Callback) -> ca.Function:
        self._kept.append(made)
        return made


class _Slope(ca.Callback):
    """One direction of the derivatives of a whole run."""

    def __init__(
        self,
        rollout: Rollout,
        vary: tuple[str, ...],
        name: str,
        takes: tuple[tuple[int, int], ...],
        gives: tuple[tuple[int, int], ...],
        backwards: bool,
    ):
        ca.Callback.__init__(self)
        self._rollout, self._vary, self._takes, self._gives = rollout, vary, takes, gives
        self._backwards = backwards
        self.construct(name, {})

    def get_n_in(self) -> int:
        return len(self._takes)

    def get_n_out(self) -> int:
        return len(self._gives)

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(*self._takes[i])

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(*self._gives[i])

    def eval(self, arguments: Sequence[ca.DM]) -> list[ca.DM]:
        run, given = self._rollout, _named(self._vary, arguments)
        if self._backwards:
            seed, states = (_array(matrix) for matrix in arguments[len(self._vary) + 2 :])
            slopes = run.pull_back(seed, **given, states=states)
            return [ca.DM(getattr(slopes, kind).T) for kind in self._vary]
        changed = _named(self._vary, arguments[len(self._vary) + 2 :])
        by = (changed.get(name, 0 * getattr(run, name)) for name in NAMES.values())
        free, start, inputs = by
        y, x = run.pushed(Slopes(free.ravel(), start.ravel(), inputs), **given)
        return [ca.DM(y.T), ca.DM(x.T)]


def _named(vary: Sequence[str], matrices: Sequence[ca.DM]) -> dict[str, Array]:
    """Arguments of a rollout by their names."""
    return {NAMES[kind]: _array(matrix) for kind, matrix in zip(vary, matrices, strict=False)}


def _array(matrix: ca.DM) -> Array:
    """Time along rows."""
    return np.asarray(matrix.full()).T


def whole_run(rollout: Rollout, vary: Sequence[str] = KINDS) -> WholeRun:
    """A rollout as a function for ``casadi.Opti`` and ``casadi.nlpsol``: what varies of (θ (F),
    x0 (X), u (k, K)), in this order, -> y (m, N), x (X, N), SI; the rest is nominal.

    ``vary`` names some of "free", "start", "inputs". Leave out what stays as it is: CasADi lays
    out a place for the slope of every output by every argument, long recordings included.
    """
    return WholeRun(rollout, vary)


def step_function(machine: Machine, stiff: bool = False) -> ca.Function:
    """One step as a CasADi function: (x, u0, u1, t, h, p) -> x after h seconds, SI.

    x is (q_free, v_free, z), the drive runs straight from u0 to u1; the classical Runge–Kutta
    method of order 4, or, if ``stiff``, the Rosenbrock method RODAS4, which friction asks for.
    """
    form = state_form(machine)
    x, d0, t, p, w = form.symbols()
    d1, h = ca.SX.sym("d1", form.drive), ca.SX.sym("h")
    arguments, names = [x, d0, d1, t, h, p], ["x", "u0", "u1", "t", "h", "p"]
    if stiff:
        after = rosenbrock_step(form)(*arguments)
        return ca.Function("step", arguments, [after], names, ["after"], {"cse": True})
    f = len(form.free)

    def slope(state: ca.SX, s: float) -> ca.SX:
        rates = form.rates()(state, d0 + s * (d1 - d0), t + s * h, p, 0 * w)
        return ca.vertcat(state[f : 2 * f, 0], rates)

    first = slope(x, 0.0)
    second = slope(x + h / 2 * first, 0.5)
    third = slope(x + h / 2 * second, 0.5)
    fourth = slope(x + h * third, 1.0)
    after = x + h / 6 * (first + 2 * second + 2 * third + fourth)
    return ca.Function("step", arguments, [after], names, ["after"], {"cse": True})

"""Many short windows of a recording simulated in one sweep, with sensitivities.

Every window starts from its own initial state; the states after each sample and their
derivatives with respect to initial states, parameters and test forces come from one pass of a
CasADi ``mapaccum``. Sizes: W windows, L samples a window, n coordinates, m sensors, F free
parameters, C test forces.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.buffers import Array, accumulated, call, mapped
from symhyb.numeric.compiled import compiled
from symhyb.numeric.machine import Machine
from symhyb.numeric.steps import rosenbrock_step


@dataclass(frozen=True, slots=True)
class Block:
    """Windows of equal length from one recording, in SI.

    ``t`` (W, L) s; ``u`` (W, L, k) inputs; ``y`` (W, L, m) measurements, NaN where missing;
    ``substeps`` (W, L − 1) integration steps between two samples.
    """

    t: Array
    u: Array
    y: Array
    substeps: NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Linear:
    """The linearised dynamics along windows in SI, sample to sample (W, L − 1, …) and at samples:

        δ(i+1) = transition·δ(i) + left·w(i) + right·w(i+1) + by_free·θ − defect
        y(i)   = output(i) + by_state·δ(i) + by_force·w(i) + direct·θ

    with δ (2n) the deviation of the state from ``x``, w (n) a test force and θ (F) the change of
    the free parameters. ``defect`` is zero along a simulated window; along a measured motion it is
    what the model fails to do from one sample to the next.
    """

    x: Array  # (W, L, 2n)
    output: Array  # (W, L, m)
    defect: Array  # (W, L − 1, 2n)
    transition: Array  # (W, L − 1, 2n, 2n)
    left: Array  # (W, L − 1, 2n, n)
    right: Array  # (W, L − 1, 2n, n)
    by_free: Array  # (W, L − 1, 2n, F)
    by_state: Array  # (W, L, m, 2n)
    by_force: Array  # (W, L, m, n)
    direct: Array  # (W, L, m, F)

    def from_start(self) -> Array:
        """∂y/∂(initial state), (W, L, m, 2n)."""
        windows, _, states = self.x.shape
        begin = np.broadcast_to(np.eye(states), (windows, states, states))
        nothing = np.zeros((*self.transition.shape[:2], states, states))
        return self.by_state @ self._propagate(begin, nothing)

    def from_free(self) -> Array:
        """∂y/∂θ, (W, L, m, F)."""
        return self.by_state @ self._propagate(self._rest(self.by_free), self.by_free) + self.direct

    def from_forces(self, forces: Array) -> Array:
        """Response of y to small test forces (W, L, n, C) at the samples: (W, L, m, C)."""
        added = self.left @ forces[:, :-1] + self.right @ forces[:, 1:]
        states = self._propagate(self._rest(added), added)
        return self.by_state @ states + self.by_force @ forces

    def from_defect(self) -> Array:
        """What the model, started on the motion, adds to ``output``: (W, L, m)."""
        added = -self.defect[..., None]
        return (self.by_state @ self._propagate(self._rest(added), added))[..., 0]

    def _rest(self, added: Array) -> Array:
        return np.zeros((added.shape[0], added.shape[2], added.shape[3]))

    def _propagate(self, begin: Array, added: Array) -> Array:
        """δ at the samples (W, L, 2n, C) from its value at the start and what each step adds."""
        windows, steps, states, count = added.shape
        result = np.empty((windows, steps + 1, states, count))
        result[:, 0] = begin
        for i in range(steps):
            result[:, i + 1] = self.transition[:, i] @ result[:, i] + added[:, i]
        return result


class WindowModel:
    """A machine prepared for sweeps; ``free`` are the columns of p that are differentiated."""

    def __init__(self, machine: Machine, free: tuple[int, ...] = ()):
        self.machine, self.free = machine, free
        n, k, size = machine.n, len(machine.model.inputs), machine.values.size
        x, p, w = ca.SX.sym("x", 2 * n), ca.SX.sym("p", size), ca.SX.sym("w", n)
        u0, u1 = ca.SX.sym("u0", k), ca.SX.sym("u1", k)
        t, h = ca.SX.sym("t"), ca.SX.sym("h")
        start, restart = ca.SX.sym("start", 2 * n), ca.SX.sym("restart")
        begin = ca.if_else(restart, start, x)
        rest, chosen = (u0, u1, t, h, p), list(free)
        after = rosenbrock_step(machine)(x, *rest, w)
        by_x, by_free = ca.jacobian(after, x), ca.jacobian(after, p)[:, chosen]
        outputs = {
            "plain": [after],
            "fit": [after, by_x, by_free],
            "screen": [after, by_x, by_free, ca.jacobian(after, w)],
        }
        at, begins = ca.vertcat(x, w), ca.vertcat(begin, 0 * w)
        steps = {
            what: ca.Function(
                what, [x, start, restart, *rest],
                [ca.densify(ca.substitute(part, at, begins)) for part in parts], {"cse": True},
            )
            for what, parts in outputs.items()
        }  # fmt: skip
        fitting = compiled({what: steps[what] for what in ("plain", "fit")})
        self._steps = {**steps, **fitting}
        self._sense = _sensing(machine, chosen)
        self._runs: dict[tuple[str, int], ca.Function] = {}

    def simulate(self, block: Block, start: Array, p: Array) -> tuple[Array, Array]:
        """Simulate windows from ``start`` (W, 2n) with parameters ``p`` (P,), SI.

        Returns states (W, L, 2n) and outputs (W, L, m); a window whose integration diverges is not
        finite from there on.
        """
        (ends,) = self._run(block, start[:, None], p, "plain")
        x = np.concatenate([start[:, None], ends], axis=1)
        return x, self._outputs(block, x, p)[0]

    def differentiate(self, block: Block, start: Array, p: Array, forces: bool = False) -> Linear:
        """Linearise along the windows simulated from ``start`` (W, 2n) with ``p`` (P,), SI; without
        ``forces`` the response to test forces is left out (zero), which costs less."""
        what = "screen" if forces else "fit"
        ends, *slopes = self._run(block, start[:, None], p, what)
        x = np.concatenate([start[:, None], ends], axis=1)
        return self._linear(block, x, np.zeros_like(ends), slopes, p)

    def along(self, block: Block, states: Array, p: Array) -> Linear:
        """Linearise along a measured motion ``states`` (W, L, 2n) with ``p`` (P,), SI: every sample
        starts anew."""
        ends, *slopes = self._run(block, states[:, :-1], p, "screen")
        return self._linear(block, states, states[:, 1:] - ends, slopes, p)

    def _linear(
        self, block: Block, x: Array, defect: Array, slopes: list[Array], p: Array
    ) -> Linear:
        transition, left, right, by_free = slopes
        output, by_state, direct, by_force = self._outputs(block, x, p)
        return Linear(
            x, output, defect, transition, left, right, by_free, by_state, by_force, direct
        )

    def _run(self, block: Block, starts: Array, p: Array, what: str) -> list[Array]:
        """Integrate from one start a window (W, 1, 2n) or one a sample (W, L − 1, 2n).

        Returns states at the ends (W, L − 1, 2n) and, unless ``what`` is plain, the slopes from
        sample to sample.
        """
        windows, length, inputs = block.u.shape
        states, parts = starts.shape[2], block.substeps.reshape(-1)
        first = np.concatenate([[0], np.cumsum(parts)[:-1]])
        owner = np.repeat(np.arange(parts.size), parts)
        part = (np.arange(owner.size) - first[owner]) / parts[owner]
        h = (np.diff(block.t, axis=1).reshape(-1) / parts)[owner]
        rise = np.diff(block.u, axis=1).reshape(parts.size, inputs)[owner]
        u0 = block.u[:, :-1].reshape(parts.size, inputs)[owner] + part[:, None] * rise
        u1 = u0 + rise / parts[owner][:, None]
        t = block.t[:, :-1].reshape(-1)[owner] + part * h * parts[owner]
        begins = first.reshape(windows, length - 1)[:, : starts.shape[1]].reshape(-1)
        restart, begin = np.zeros(owner.size), np.zeros((owner.size, states))
        restart[begins], begin[begins] = 1, starts.reshape(-1, states)
        run = self._mapped(what, owner.size)
        after, *slopes = call(run, (np.zeros(states), begin, restart, u0, u1, t, h, p))
        shape = (windows, length - 1, states)
        ends = after[first + parts - 1].reshape(shape)
        if what == "plain":
            return [ends]
        if what == "fit":
            slopes.append(np.zeros((owner.size * self.machine.n, states)))
        steps = [slope.reshape(owner.size, -1, states).swapaxes(1, 2) for slope in slopes]
        return [ends, *(j.reshape(*shape, -1) for j in _joined(steps, first, parts))]

    def _outputs(self, block: Block, x: Array, p: Array) -> tuple[Array, ...]:
        windows, length, _ = x.shape
        sense = self._mapped("sense", windows * length)
        y, *slopes = call(sense, (x, block.u, block.t, p))
        m = len(self.machine.model.sensors)
        return (
            y.reshape(windows, length, m),
            *(s.reshape(windows, length, -1, m).swapaxes(2, 3) for s in slopes),
        )

    def _mapped(self, what: str, total: int) -> ca.Function:
        """The function for ``total`` steps; the last few are kept, building one costs ms."""
        run = self._runs.get((what, total))
        if run is None:
            if what == "sense":
                run = mapped(self._sense, total, repeated=(3,))
            else:
                run = accumulated(self._steps[what], total, repeated=(7,))
            recent = list(self._runs.items())[-5:]
            self._runs = dict([*recent, ((what, total), run)])
        return run


def _joined(
    steps: list[Array], first: NDArray[np.int64], parts: NDArray[np.int64]
) -> tuple[Array, ...]:
    """Slopes of integration steps (S, 2n, ·), in the order transition, by free, impulse, joined to
    slopes from sample to sample (M, 2n, ·): transition, left, right, by free. The test force runs
    linearly between two samples and is constant within a step. ``first`` (M,) is the first step of
    each interval and ``parts`` (M,) how many there are."""
    transition, free, impulse = (step[first] for step in steps)
    share = (0.5 / parts)[:, None, None]
    left, right = impulse * (1 - share), impulse * share
    for i in range(1, int(parts.max(initial=1))):
        more = np.flatnonzero(parts > i)
        step, by_free, kick = (s[first[more] + i] for s in steps)
        where = ((i + 0.5) / parts[more])[:, None, None]
        transition[more] = step @ transition[more]
        free[more] = step @ free[more] + by_free
        left[more] = step @ left[more] + (1 - where) * kick
        right[more] = step @ right[more] + where * kick
    return transition, left, right, free


def _sensing(machine: Machine, chosen: list[int]) -> ca.Function:
    """(x, u, t, p) -> outputs (m), ∂/∂x (m, 2n), ∂/∂free (m, F), ∂/∂w (m, n)."""
    n, k = machine.n, len(machine.model.inputs)
    x, u, t = ca.SX.sym("x", 2 * n), ca.SX.sym("u", k), ca.SX.sym("t")
    p, w = ca.SX.sym("p", machine.values.size), ca.SX.sym("w", n)
    a = machine.acceleration(x[:n], x[n:], u, t, p, w)
    y = machine.outputs(x[:n], x[n:], a, u, t, p)
    parts = [y, ca.jacobian(y, x), ca.jacobian(y, p)[:, chosen], ca.jacobian(y, w)]
    parts = [ca.densify(ca.substitute(part, w, 0 * w)) for part in parts]
    return ca.Function("sense", [x, u, t, p], parts, {"cse": True})

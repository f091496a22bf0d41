r"""A whole run as a function of parameters, start and inputs, with its slopes.

    y = run(θ, x0, u)      pull_back:  ȳ ↦ (∂y/∂θ)ᵀȳ, (∂y/∂x0)ᵀȳ, (∂y/∂u)ᵀȳ     adjoint
                           push:       δθ, δx0, δu ↦ δy                             forward

The adjoint goes back through the very steps of the run, their lengths held, so that it is the exact
slope of what was computed; its cost does not depend on the number of parameters. Everything runs
in machine code on memory of its own: any number of threads may use one rollout at once.
Sizes: N outputs, m sensors, X states, F free parameters, k inputs at K times.

Source: Hager, Runge–Kutta methods in optimal control and the transformed adjoint system, Numer.
Math. 87, 2000 (the discrete adjoint); Hairer, Nørsett & Wanner, Solving ODEs I (the steps).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from symhyb.errors import InputError, NumericsError, Problem
from symhyb.model.unsampled import require_unsampled
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.lowered.dynamics import StateForm, state_form
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.explicit import (
    Field,
    Steps,
    Tape,
    Tolerances,
    field_of,
    longest_step,
    rates_of,
)
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.optimisation.reverse import pulled_back

# Relative; absolute a hundredth of it, in scales of the states. The error of slopes is larger than
# that of states, by 100 to 1000 where friction is steep: at 1e-12 it stays below 1e-8.
TOLERANCE = 1e-12
STEPS_MOST = 1_000_000
KINDS = ("free", "start", "inputs")  # what may vary, as an optimiser calls it
NAMES = dict(zip(KINDS, ("theta", "start", "inputs"), strict=True))  # and as a rollout takes it
ROOM = 2  # steps of a tape over those of the nominal run


@dataclass(frozen=True, slots=True)
class Slopes:
    """Of a number that depends on a run: by free parameters (F,), by start (X,) and by inputs
    (K, k), per SI unit of each."""

    free: Array
    start: Array
    inputs: Array


@dataclass(frozen=True, slots=True)
class _Parts:
    """The functions of a machine that a rollout needs."""

    rates: Field
    sensed: Field
    pulled: Field
    sensed_pulled: Field
    pushed: Field
    sensed_pushed: Field


class Rollout:
    """Runs of one machine over one output grid, y = run(θ, x0, u), with their slopes.

    Sizes: N outputs, m sensors, X states, F free parameters, k inputs at K times. The ``scenario``
    states the output times, the times of the inputs, and nominal start and inputs; ``free`` are the
    paths of the parameters that are arguments, in this order, all else is held.

    Attributes:
        theta: (F,) nominal values of the free parameters, SI.
        start: (X,) nominal start (q_free, v_free, z), SI.
        inputs: (K, k) nominal inputs, SI.
        shape: (N, m) of what a run returns.
    """

    def __init__(
        self,
        machine: Machine,
        scenario: Scenario,
        free: Sequence[str] = (),
        tolerance: float = TOLERANCE,
    ):
        """Run once with the nominal values, which finds the sizes of the states.

        Raises:
            InputError: an input with an actuator.
            NumericsError: no C compiler, or a nominal run that fails; the message says why.
            ValueError: a parameter that the machine does not have.
        """
        require_unsampled(machine.model, "a rollout", "simulate it")
        self.machine, self.form = machine, state_form(machine)
        self._free = [_column(machine, path) for path in free]
        acts = [item.name for item in machine.model.inputs if item.actuator]
        if acts:
            said = "has an actuator, which a rollout does not hold; give what comes out of it"
            raise InputError([Problem(said, f"inputs.{name}", machine.model.file) for name in acts])
        first = simulate(machine, scenario)
        if not first.complete:
            raise NumericsError(first.reason)
        key = ("rollout", self.form.key, tuple(self._free))
        self._parts = kept(key, lambda: _parts(self.form, self._free))
        x = self.form.state(first.q, first.v, first.z)
        self.theta, self.start = machine.values[self._free], x[0]
        self.inputs, self._given = scenario.u, scenario.given
        self.t, self.t_u = scenario.t, scenario.t_u
        self.shape = (scenario.t.size, len(machine.model.sensors))
        reach = np.abs(x).max(axis=0, initial=0.0)
        scales = np.where(reach > 0, reach, 1.0)
        self._longest = longest_step(self.form)
        self._limits = Tolerances(
            tolerance, 1e-2 * tolerance * scales, np.full(x.shape[1], np.inf), STEPS_MOST
        )
        self._place = np.clip(np.searchsorted(self.t_u, self.t, "right") - 1, 0, self.t_u.size - 2)
        self._share = (self.t - self.t_u[self._place]) / np.diff(self.t_u)[self._place]
        self._room = ROOM * max(self._states(self.theta, x[0], self.inputs)[0].accepted, 50)

    def __call__(
        self, theta: Array | None = None, start: Array | None = None, inputs: Array | None = None
    ) -> Array:
        """What the sensors record, (N, m), SI; NaN from where the run fails. Parameters ``theta``
        (F,), ``start`` (X,) and ``inputs`` (K, k), SI, are nominal where they are not given."""
        theta, start, inputs = self._filled(theta, start, inputs)
        run, p, drive = self._states(theta, start, inputs)
        return self._parts.sensed.along(self.t, run.x, self._at(drive), p)

    def states(
        self, theta: Array | None = None, start: Array | None = None, inputs: Array | None = None
    ) -> Array:
        """The states (N, X), SI, of the same run."""
        return self._states(*self._filled(theta, start, inputs))[0].x

    def pull_back(
        self,
        seed: Array,
        theta: Array | None = None,
        start: Array | None = None,
        inputs: Array | None = None,
        states: Array | None = None,
    ) -> Slopes:
        """The slopes of Σ seed·y, ``seed`` (N, m), and of Σ states·x if ``states`` (N, X) are
        given, both per SI unit; NaN if the run fails. Arguments else as of a call."""
        return self.taped(theta, start, inputs)[1](seed, states)

    def taped(
        self, theta: Array | None = None, start: Array | None = None, inputs: Array | None = None
    ) -> tuple[Array, "Reversal"]:
        """What the sensors record, (N, m), SI, and what pulls weights of it back."""
        theta, start, inputs = self._filled(theta, start, inputs)
        room = self._room
        while True:
            tape = Tape(room, start.size)
            run, p, drive = self._states(theta, start, inputs, tape)
            if run.reason != "a full tape" or room > STEPS_MOST:
                break
            room *= 4
        y = self._parts.sensed.along(self.t, run.x, self._at(drive), p)
        return y, Reversal(self, run, tape, p, drive)

    def push(
        self,
        by: Slopes,
        theta: Array | None = None,
        start: Array | None = None,
        inputs: Array | None = None,
    ) -> Array:
        """How y (N, m) changes, to first order and in SI, when free parameters, start and inputs
        change ``by`` so much."""
        return self.pushed(by, theta, start, inputs)[0]

    def pushed(
        self,
        by: Slopes,
        theta: Array | None = None,
        start: Array | None = None,
        inputs: Array | None = None,
    ) -> tuple[Array, Array]:
        """The same for y (N, m) and the states (N, X), SI."""
        theta, start, inputs = self._filled(theta, start, inputs)
        p, drive = self._values(theta), self._drive(inputs)
        more, turned = np.zeros(p.size), np.zeros(drive.shape)
        np.add.at(more, self._free, by.free)
        turned[:, : inputs.shape[1]] = by.inputs.reshape(inputs.shape)
        both, moved = np.concatenate([p, more]), np.concatenate([drive, turned], axis=1)
        limits = Tolerances(
            self._limits.relative,
            np.concatenate([self._limits.absolute, np.full(start.size, np.inf)]),
            np.full(2 * start.size, np.inf),
            STEPS_MOST,
        )
        run = self._parts.pushed.integrate(
            self.t,
            np.concatenate([start, by.start]),
            both,
            (self.t_u, moved),
            limits,
            longest=self._longest,
        )
        y = self._parts.sensed_pushed.along(self.t, run.x, self._at(moved), both)
        return y, run.x[:, start.size :]

    def jacobian(
        self, theta: Array | None = None, start: Array | None = None, inputs: Array | None = None
    ) -> Array:
        """∂y/∂θ (N, m, F), SI, by one forward run for each free parameter: for bounds along the
        whole run, and for least squares. Arguments as of a call."""
        columns = []
        for way in np.eye(self.theta.size):
            by = Slopes(way, np.zeros_like(self.start), np.zeros_like(self.inputs))
            columns.append(self.push(by, theta, start, inputs))
        return np.stack(columns, axis=2) if columns else np.zeros((*self.shape, 0))

    def _filled(
        self, theta: Array | None, start: Array | None, inputs: Array | None
    ) -> tuple[Array, Array, Array]:
        pairs = ((theta, self.theta), (start, self.start), (inputs, self.inputs))
        filled = []
        for name, (given, nominal) in zip(("theta", "start", "inputs"), pairs, strict=True):
            value = nominal if given is None else np.asarray(given, float)
            if value.size != nominal.size:
                raise ValueError(f"{name} has {value.size} numbers, needs {nominal.size}")
            filled.append(value.reshape(nominal.shape))
        return filled[0], filled[1], filled[2]

    def _values(self, theta: Array) -> Array:
        p = self.machine.values.copy()
        p[self._free] = theta
        return p

    def _drive(self, inputs: Array) -> Array:
        return inputs if self._given is None else np.concatenate([inputs, self._given], axis=1)

    def _at(self, drive: Array) -> Array:
        """The drive (N, drive) at the outputs."""
        here, then = drive[self._place], drive[self._place + 1]
        return here + self._share[:, None] * (then - here)

    def _states(
        self, theta: Array, start: Array, inputs: Array, tape: Tape | None = None
    ) -> tuple[Steps, Array, Array]:
        p, drive = self._values(theta), self._drive(inputs)
        nodes = (self.t_u, drive)
        run = self._parts.rates.integrate(
            self.t, start, p, nodes, self._limits, tape, self._longest
        )
        return run, p, drive


@dataclass(frozen=True, slots=True)
class Reversal:
    """One run, ready to be gone through backwards: its parameters ``p`` (P,) and drive (K, drive),
    SI."""

    rollout: Rollout
    run: Steps
    tape: Tape
    p: Array
    drive: Array

    def __call__(self, seed: Array, states: Array | None = None) -> Slopes:
        """The slopes of Σ seed·y + Σ states·x, ``seed`` (N, m), ``states`` (N, X), per SI unit."""
        of, x = self.rollout, self.run.x
        f, k = of._free, of.inputs.shape[1]
        if self.run.reason:
            lost = (np.full(size, np.nan) for size in (len(f), x.shape[1], of.inputs.shape))
            return Slopes(*lost)
        weights = np.concatenate([x, np.asarray(seed, float).reshape(of.shape)], axis=1)
        at = of._at(self.drive)
        first = of._parts.sensed_pulled.along(of.t, weights, at, self.p)
        by_x, by_d, by_p = np.split(first, np.cumsum([x.shape[1], self.drive.shape[1]]), axis=1)
        total = by_x if states is None else by_x + states
        nodes, steps = (of.t_u, self.drive), self.run.accepted
        start, values, drive = pulled_back(
            of._parts.pulled, self.tape, steps, total, self.p, of.t, nodes
        )
        np.add.at(drive, of._place, (1 - of._share)[:, None] * by_d)
        np.add.at(drive, of._place + 1, of._share[:, None] * by_d)
        return Slopes(values + by_p.sum(axis=0), start, drive[:, :k])


def varying(kinds: Sequence[str]) -> tuple[str, ...]:
    """What varies, in the order of all arguments.

    Raises:
        ValueError: one that cannot vary.
    """
    unknown = [kind for kind in kinds if kind not in KINDS]
    if unknown:
        raise ValueError(f"{unknown[0]!r} cannot vary; it is one of {', '.join(KINDS)}")
    return tuple(kind for kind in KINDS if kind in kinds)


def _column(machine: Machine, path: str) -> int:
    paths = [item.path for item in machine.model.all_parameters()]
    if path not in paths:
        raise ValueError(f"no parameter {path!r}; there are {', '.join(paths)}")
    return paths.index(path)


def _parts(form: StateForm, free: list[int]) -> _Parts:
    rates = rates_of(form)
    x, d, t, p, w = form.symbols()
    sensed = form.outputs()(x, d, t, p, 0 * w)[0]
    outputs = ca.Function("sensed", [x, d, t, p], [ca.densify(sensed)], {"cse": True})
    functions = (
        rates,
        outputs,
        _pulled(rates, free),
        _pulled(outputs, free),
        _pushed(rates),
        _pushed(outputs),
    )
    fields = [field_of(function) for function in functions]
    ready = [field for field in fields if field is not None]
    if len(ready) < len(functions):
        raise NumericsError(
            "slopes of whole runs need a C compiler that works, and none was found; "
            "symhyb.optimisation.opti.step_function needs none"
        )
    return _Parts(*ready)


def _pulled(function: ca.Function, free: list[int]) -> ca.Function:
    """((x, weights of the result), d, t, p) -> these by x, d and what is free of p, one below the
    other."""
    x, d, t, p = (ca.SX.sym(name, function.size1_in(i)) for i, name in enumerate("xdtp"))
    weights = ca.SX.sym("weights", function.size1_out(0))
    result = function(x, d, t, p)
    slopes = ca.densify(ca.jtimes(result, ca.vertcat(x, d, p), weights, True))
    kept_rows = [*range(x.numel() + d.numel()), *(x.numel() + d.numel() + i for i in free)]
    both = ca.vertcat(x, weights)
    return ca.Function("pulled", [both, d, t, p], [slopes[kept_rows]], {"cse": True})


def _pushed(function: ca.Function) -> ca.Function:
    """((x, δx), (d, δd), t, (p, δp)) -> the result and its change, one below the other for rates,
    and the change alone for what has not as many results as states."""
    x, d, t, p = (ca.SX.sym(name, function.size1_in(i)) for i, name in enumerate("xdtp"))
    moves = [ca.SX.sym("move", symbol.numel()) for symbol in (x, d, p)]
    result = function(x, d, t, p)
    change = ca.densify(ca.jtimes(result, ca.vertcat(x, d, p), ca.vertcat(*moves)))
    results = ca.vertcat(result, change) if function.name() == "field" else change
    both = [ca.vertcat(*pair) for pair in zip((x, d, p), moves, strict=True)]
    return ca.Function("pushed", [both[0], both[1], t, both[2]], [results], {"cse": True})

"""A machine as a system of first order: what moves by itself, and what drives it.

    x = (q_free, v_free, z)          state: X = 2 n_free + z numbers
    d = (u, q_given, v_given, a_given)    drive: recorded inputs, and motion that is given

Coordinates are given where the model imposes them; with all coordinates given, only the
inner states of the elements are left, which then follow a measured motion. Where delays are to be
differentiated, the drive goes on with u' (k), and the delays of inputs and sensors (k + m) that
the recorded signals were already cleared of:

    u(t − τ) = u − (τ − cleared) u',   cleared = τ: exact, with the slope by τ
    q(t − τ) = q − δ q' + δ²/2 q'',   v(t − τ) = v − δ q''(t − δ/2),   δ = τ − cleared, of a sensor
    below half a sample

Where numbers of actuators (:mod:`symhyb.model.actuators`) are to be differentiated, their slopes
and the values that the inputs follow already stand at its end, number by number:

    u(θ) = u + (θ − taken) ∂u/∂θ,   taken = θ: exact, with the slope by θ
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from symhyb.model.delays import delay_paths
from symhyb.model.types import Input, Sensor
from symhyb.numeric.kernels.actuators import Acted
from symhyb.numeric.kernels.buffers import Array, held_at, resampled
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.lowered.machine import Machine, structure_of
from symhyb.numeric.lowered.manifold import placing


@dataclass(frozen=True, slots=True)
class StateForm:
    """A machine with ``given`` coordinates (their indices); ``late`` channels (by name) have a
    delay that is differentiated, and so are the numbers of actuators ``shaping`` (by path)."""

    machine: Machine
    given: tuple[int, ...]
    late: tuple[str, ...] = ()
    shaping: tuple[str, ...] = ()

    @property
    def free(self) -> tuple[int, ...]:
        """The coordinates that follow from forces."""
        return tuple(i for i in range(self.machine.n) if i not in self.given)

    @property
    def size(self) -> int:
        """X, the length of the state."""
        return 2 * len(self.free) + self.machine.inner_states

    @property
    def moving(self) -> int:
        """How many directions places and speeds have: twice the free coordinates, less what
        constraints hold."""
        f, m = len(self.free), self.machine.constraints
        return max(f - len(placing(self.machine)), 0) + max(f - m, 0)

    @property
    def inputs(self) -> int:
        """k, the number of recorded inputs."""
        return len(self.machine.model.inputs)

    @property
    def drive(self) -> int:
        """The length of the drive."""
        more = 2 * self.inputs + len(self.machine.model.sensors) if self.late else 0
        return self.inputs + 3 * len(self.given) + more + 2 * len(self.shaping)

    def extended(
        self,
        drive: Array,
        t: Array,
        record: tuple[Array, Array],
        p: Array,
        late: Sequence[float],
        acted: Mapping[int, Acted],
    ) -> Array:
        """The drive (W, L, …) with what delays need: late inputs taken anew, under the delays of
        ``p``, from the ``record`` (times (K,) and inputs (K, k) as recorded), the slopes of all
        inputs along ``t`` (W, L), and the delays that the signals are now cleared of: of a sensor
        the one that the model states, and ``late`` (m,) beyond it, where given; then the slopes by
        numbers of actuators, and these. Inputs that have actuators are taken from what these pass
        on (``acted``). SI."""
        if not (self.late or acted):
            return drive
        drive = drive.copy()
        for i, one in acted.items():
            drive[..., i] = one.at(t - self.cleared(i, p))
        if self.late:
            drive = self._delayed(drive, t, record, p, late, acted)
        if not self.shaping:
            return drive
        taken = [p[self.machine.column(path)] for path in self.shaping]
        still = np.broadcast_to(np.array(taken), (*drive.shape[:-1], len(taken)))
        slopes = np.empty_like(still)
        for i, columns in self.shaped_columns(acted):
            slopes[..., columns] = acted[i].by_at(t - self.cleared(i, p))
        return np.concatenate([drive, slopes, still], axis=-1)

    def shaped_columns(self, acted: Mapping[int, Acted]) -> list[tuple[int, list[int]]]:
        """Of each input that has an actuator which of the differentiated numbers are its own."""
        owners = [self._owner(path) for path in self.shaping]
        return [(i, [j for j, owner in enumerate(owners) if owner == i]) for i in acted]

    @property
    def first_slope(self) -> int:
        """Where the slopes by numbers of actuators begin in the drive."""
        return self.drive - 2 * len(self.shaping)

    def _delayed(
        self,
        drive: Array,
        t: Array,
        record: tuple[Array, Array],
        p: Array,
        late: Sequence[float],
        acted: Mapping[int, Acted],
    ) -> Array:
        """The drive (W, L, …) with late inputs, their slopes, and what signals are cleared of."""
        model = self.machine.model
        channels: tuple[Input | Sensor, ...] = (*model.inputs, *model.sensors)
        cleared = [c.delay.si if c.delay else 0.0 for c in channels]
        for i, item in enumerate(model.inputs):
            if item.name in self.late:
                stated, cleared[i] = cleared[i], self.cleared(i, p)
                if i in acted or not (stated or cleared[i]):
                    continue  # as it was recorded
                follow = held_at if item.between == "held" else resampled
                drive[..., i] = follow(record[0], record[1][:, i], t - cleared[i])
        for j, lag in enumerate(late):
            cleared[self.inputs + j] += lag
        rise = np.gradient(drive[..., : self.inputs], axis=1) / np.gradient(t, axis=1)[..., None]
        still = np.broadcast_to(np.array(cleared), (*drive.shape[:-1], len(cleared)))
        return np.concatenate([drive, rise, still], axis=-1)

    def cleared(self, i: int, p: Array) -> float:
        """The delay in s that the i-th input is cleared of: that of ``p`` (P,), SI, where
        it is differentiated, else the one that the model states."""
        item = self.machine.model.inputs[i]
        if item.name in self.late:
            return delay_of(self.machine, item, p)
        return item.delay.si if item.delay else 0.0

    def unpack(self, x: ca.SX, d: ca.SX, p: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
        """q, v (n), z, acting u and the given accelerations, from x, d and p."""
        f, g, k = len(self.free), len(self.given), self.inputs
        parts = [type(x)(1, 1)] * self.machine.n, [type(x)(1, 1)] * self.machine.n
        for i, where in enumerate(self.free):
            parts[0][where], parts[1][where] = x[i], x[f + i]
        for i, where in enumerate(self.given):
            parts[0][where], parts[1][where] = d[k + i], d[k + g + i]
        q, v = (ca.vertcat(*part) for part in parts)
        acts = [d[j] for j in range(k)]
        for j, path in enumerate(self.shaping):
            column, at = self.machine.column(path), self.first_slope + j
            off = p[column] - d[at + len(self.shaping)]
            acts[self._owner(path)] += off * d[at]
        u = ca.vertcat(*(self._late(i, acts[j], d, p, j) for j, i in self._channels(0)))
        return q, v, x[2 * f :, 0], u if k else d[:0, 0], d[k + 2 * g : k + 3 * g, 0]

    def _owner(self, path: str) -> int:
        """The input to whose actuator a number belongs."""
        inputs = self.machine.model.inputs
        return next(i for i, one in enumerate(inputs) if path in [n.path for n in one.actuator])

    def _channels(self, which: int) -> list[tuple[int, Input | Sensor]]:
        model = self.machine.model
        channels: tuple[Input | Sensor, ...] = (model.inputs, model.sensors)[which]
        return list(enumerate(channels))

    def _late(self, item: Input | Sensor, value: ca.SX, d: ca.SX, p: ca.SX, i: int) -> ca.SX:
        """An input as it acts under its delay."""
        if item.name not in self.late:
            return value
        first = self.inputs + 3 * len(self.given)
        return value - self._lag(item, d, p, i) * d[first + i]

    def _lag(self, item: Input | Sensor, d: ca.SX, p: ca.SX, i: int) -> ca.SX:
        """The delay of a channel beyond what its signal was cleared of; sensors follow inputs."""
        first = 2 * self.inputs + 3 * len(self.given)
        own = [p[self.machine.column(path)] for path in delay_paths(item)]
        return sum(own[1:], own[0]) - d[first + i]

    @property
    def key(self) -> tuple[object, ...]:
        """What the functions of a form depend on."""
        return _structure(self.machine), self.given, self.late, self.shaping

    def rates(self) -> ca.Function:
        """(x, d, t, p, w) -> (n_free + z,) the rates of v_free and z; w (n) is a test force."""
        return kept(("rates", self.key), self._rates)

    def outputs(self) -> ca.Function:
        """(x, d, t, p, w) -> (m,) what the sensors record, and (n,) accelerations."""
        return kept(("outputs", self.key), self._outputs)

    def _rates(self) -> ca.Function:
        x, d, t, p, w = self.symbols()
        q, v, z, u, b = self.unpack(x, d, p)
        machine = self.machine
        parts = [machine.inner(q, v, z, u, t, p)]
        if self.free:
            a = self.accelerations(q, v, z, u, t, p, w, b)
            parts.insert(0, a[list(self.free)])
        return ca.Function("rates", [x, d, t, p, w], [ca.densify(ca.vertcat(*parts))])

    def _outputs(self) -> ca.Function:
        x, d, t, p, w = self.symbols()
        q, v, z, u, b = self.unpack(x, d, p)
        a = self.accelerations(q, v, z, u, t, p, w, b)
        y = self.machine.sensed(q, v, a, z, u, t, p, w)
        for j, sensor in self._channels(1):
            if sensor.name in self.late:
                lag = self._lag(sensor, d, p, self.inputs + j)
                slope = d[self.inputs + 3 * len(self.given) :][: self.inputs]
                u_half, u_then = (u - h * slope if self.inputs else u for h in (lag / 2, lag))
                q_half, v_half = q - lag / 2 * v + lag**2 / 8 * a, v - lag / 2 * a
                a_half = self.accelerations(q_half, v_half, z, u_half, t - lag / 2, p, w, b)
                q_then, v_then = q - lag * v + lag**2 / 2 * a, v - lag * a_half
                a_then = self.accelerations(q_then, v_then, z, u_then, t - lag, p, w, b)
                then = (q_then, v_then, a_then, z, u_then, t - lag, p, w)
                y[j] = self.machine.sensed(*then)[j]
        return ca.Function("outputs", [x, d, t, p, w], [ca.densify(y), ca.densify(a)])

    def accelerations(
        self, q: ca.SX, v: ca.SX, z: ca.SX, u: ca.SX, t: ca.SX, p: ca.SX, w: ca.SX, b: ca.SX
    ) -> ca.SX:
        """q'' (n) under an extra generalized force w (n), SI; b are the given accelerations."""
        if len(self.given) == self.machine.n:
            order = np.argsort(self.given)
            return ca.vertcat(*(b[int(i)] for i in order))
        return self.machine.acceleration(q, v, z, u, t, p, w, b)

    def symbols(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
        """Fresh symbols x, d, t, p, w."""
        return (
            ca.SX.sym("x", self.size),
            ca.SX.sym("d", self.drive),
            ca.SX.sym("t"),
            ca.SX.sym("p", self.machine.values.size),
            ca.SX.sym("w", self.machine.n),
        )

    def driven(self, u: Array, q: Array, v: Array, a: Array) -> Array:
        """The drive (N, drive) from inputs (N, k) and a motion (N, n each) of which the given
        coordinates count, SI."""
        g = list(self.given)
        return np.concatenate([u, q[..., g], v[..., g], a[..., g]], axis=-1)

    def state(self, q: Array, v: Array, z: Array) -> Array:
        """x (N, X) from a motion (N, n) and inner states (N, z), SI; other leading sizes too."""
        f = list(self.free)
        return np.concatenate([q[..., f], v[..., f], z], axis=-1)

    def motion(self, x: Array, d: Array) -> tuple[Array, Array]:
        """q and v (N, n) from states (N, X) and drives (N, drive), SI; other leading sizes too."""
        f, g, k = len(self.free), len(self.given), self.inputs
        q, v = (np.empty((*x.shape[:-1], self.machine.n)) for _ in range(2))
        q[..., list(self.free)], v[..., list(self.free)] = x[..., :f], x[..., f : 2 * f]
        q[..., list(self.given)] = d[..., k : k + g]
        v[..., list(self.given)] = d[..., k + g : k + 2 * g]
        return q, v


def delay_of(machine: Machine, channel: Input | Sensor, p: Array) -> float:
    """The delay of a channel under the parameters ``p`` (P,), SI: its own and what it shares, s."""
    return float(sum(p[machine.column(path)] for path in delay_paths(channel)))


@lru_cache(maxsize=16)
def _structure(machine: Machine) -> str:
    """What the functions of a machine depend on; a machine is its own key, compared by identity."""
    return structure_of(machine.model)


def state_form(
    machine: Machine, late: tuple[str, ...] = (), shaping: tuple[str, ...] = ()
) -> StateForm:
    """The machine with the coordinates given that its model imposes."""
    return StateForm(machine, machine.imposed, late, shaping)


def inner_form(machine: Machine) -> StateForm:
    """The inner states of a machine alone, along a motion that is given."""
    return StateForm(machine, tuple(range(machine.n)))

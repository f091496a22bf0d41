"""Many short windows of a recording simulated in one sweep, with sensitivities.

Every window starts from its own initial state; the states after each sample and their
derivatives with respect to initial states, parameters and test forces come from one pass.
Sizes: W windows, L samples a window, n coordinates, m sensors, F free parameters, C test forces, X
states (of a machine without inner states 2n).
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from symhyb.model.delays import delayed_by
from symhyb.model.unsampled import require_unsampled
from symhyb.numeric.kernels.actuators import Acted
from symhyb.numeric.kernels.buffers import Array, held_line
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.kernels.sweeps import joined, responses
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.acting import acting_inputs, moves, shaping_paths
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.known import Known, with_known
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.manifold import closed, tangent
from symhyb.numeric.runs.between import bent_columns
from symhyb.numeric.runs.window_steps import Steps, Taken, in_pieces


@dataclass(frozen=True, slots=True)
class Block:
    """Windows of equal length from one recording, in SI.

    ``t`` (W, L) s; ``d`` (W, L, drive) inputs, and motion that is given; ``y`` (W, L, m)
    measurements, NaN where missing;
    ``substeps`` (W, L − 1) integration steps between two samples; ``record`` times (K,) and inputs
    (K, k) of the whole recording, from which inputs under another delay are taken, and those that
    are smooth between samples (then on a finer grid). ``late`` (m,), if not empty: by how many
    seconds each column of ``y`` was taken later, beyond the delay that the model
    states. ``known`` parameters take the place of those that a machine is simulated with.
    """

    t: Array
    d: Array
    y: Array
    substeps: NDArray[np.int64]
    record: tuple[Array, Array] = (np.empty(0), np.empty((0, 0)))
    late: tuple[float, ...] = ()
    known: Known = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Linear:
    """The linearised dynamics along windows in SI, sample to sample (W, L − 1, …) and at samples:

        δ(i+1) = transition·δ(i) + left·w(i) + right·w(i+1) + by_free·θ − defect
        y(i)   = output(i) + by_state·δ(i) + by_force·w(i) + direct·θ

    with δ (X) the deviation of the state from ``x``, w (n) a test force and θ (F) the change of
    the free parameters. ``defect`` is zero along a simulated window; along a measured motion it is
    what the model fails to do from one sample to the next.
    """

    x: Array  # (W, L, X)
    output: Array  # (W, L, m)
    defect: Array  # (W, L − 1, X)
    transition: Array  # (W, L − 1, X, X)
    left: Array  # (W, L − 1, X, n)
    right: Array  # (W, L − 1, X, n)
    by_free: Array  # (W, L − 1, X, F)
    by_state: Array  # (W, L, m, X)
    by_force: Array  # (W, L, m, n)
    direct: Array  # (W, L, m, F)
    begin: Array | None = None  # (W, X, R): directions in which initial states may move; else all
    begin_free: Array | None = None  # (W, X, F): how they must move with θ; else they need not

    def from_start(self) -> Array:
        """∂y/∂(initial state), (W, L, m, X); with constraints along the R directions they leave."""
        windows, _, states = self.x.shape
        begin = self.begin
        if begin is None:
            begin = np.broadcast_to(np.eye(states), (windows, states, states))
        return self._shown(begin, np.empty((*self.transition.shape[:2], states, 0)))

    def from_states(self) -> Array:
        """The same for an error of each state (W, L, m, X); with constraints, of the part of it
        that they allow."""
        if self.begin is None:
            return self.from_start()
        return np.asarray(self.from_start() @ np.linalg.pinv(self.begin)[:, None])

    def from_free(self) -> Array:
        """∂y/∂θ, (W, L, m, F)."""
        begin = self._rest(self.by_free) if self.begin_free is None else self.begin_free
        return self._shown(begin, self.by_free) + self.direct

    def from_start_and_free(self) -> tuple[Array, Array]:
        """The two above from one pass, which costs little more than either: ∂y/∂(initial state)
        (W, L, m, X) and ∂y/∂θ (W, L, m, F)."""
        windows, _, states = self.x.shape
        first = states if self.begin is None else self.begin.shape[2]
        both = first + self.by_free.shape[3]
        begin = np.zeros((windows, states, both))
        begin[:, :, :first] = np.eye(states) if self.begin is None else self.begin
        if self.begin_free is not None:
            begin[:, :, first:] = self.begin_free
        made = self._shown(begin, self.by_free)
        return made[..., :first], made[..., first:] + self.direct

    def from_forces(self, forces: Array) -> Array:
        """Response of y to small test forces (W, L, n, C) at the samples: (W, L, m, C)."""
        added = self.left @ forces[:, :-1] + self.right @ forces[:, 1:]
        return self._shown(self._rest(added), added) + self.by_force @ forces

    def from_defect(self) -> Array:
        """What the model, started on the motion, adds to ``output``: (W, L, m)."""
        added = -self.defect[..., None]
        return self._shown(self._rest(added), added)[..., 0]

    def _rest(self, added: Array) -> Array:
        return np.zeros((added.shape[0], added.shape[2], added.shape[3]))

    def _shown(self, begin: Array, added: Array) -> Array:
        """What sensors see (W, L, m, C) of δ, from its value at the start (W, X, C) and what each
        step adds to the last of the columns."""
        arrays = (self.transition, self.by_state, begin, added)
        return np.asarray(responses(*map(np.ascontiguousarray, arrays)))


class WindowModel:
    """A machine prepared for sweeps; ``free`` are the columns of p that are differentiated.

    Signals are cleared of the delays that the model states; those of ``p`` count beside them for
    the channels whose delay is free or that are named ``late``. What actuators do to the inputs is
    always that of ``p``.
    """

    def __init__(self, machine: Machine, free: tuple[int, ...] = (), late: tuple[str, ...] = ()):
        require_unsampled(machine.model, "an estimation from recordings")
        self.machine, self.free = machine, free
        paths = [item.path for item in machine.model.all_parameters()]
        moved = [name for i in free for name in delayed_by(machine.model, paths[i])]
        shaping = shaping_paths(machine, free)
        self.form = state_form(machine, tuple(dict.fromkeys((*moved, *late))), shaping)
        self._smooth, self._held = bent_columns(machine.model.inputs)
        self._fine = bool(self._smooth)
        self._held = tuple(i for i in self._held if not moves(machine.model.inputs[i]))
        self._steps = kept(("windows", self.form.key, free), lambda: Steps(self.form, list(free)))

    @property
    def remembers(self) -> bool:
        """Whether there are states beside those of the motion."""
        return self.form.size > 2 * len(self.form.free)

    def simulate(self, block: Block, start: Array, p: Array) -> tuple[Array, Array]:
        """Simulate windows from ``start`` (W, X) with parameters ``p`` (P,), SI.

        Returns states (W, L, X) and outputs (W, L, m); a window whose integration diverges is not
        finite from there on.
        """
        p = with_known(self.machine, p, block.known)
        (ends,) = self._run(block, start[:, None], p, "plain")
        x = np.concatenate([start[:, None], ends], axis=1)
        return x, self._outputs(block, x, p)[0]

    def differentiate(self, block: Block, start: Array, p: Array, forces: bool = False) -> Linear:
        """Linearise along the windows simulated from ``start`` (W, X) with ``p`` (P,), SI; without
        ``forces`` the response to test forces is left out (zero), which costs less."""
        p, what = with_known(self.machine, p, block.known), "screen" if forces else "fit"
        ends, *slopes = self._run(block, start[:, None], p, what)
        x = np.concatenate([start[:, None], ends], axis=1)
        return self._linear(block, x, np.zeros_like(ends), slopes, p)

    def along(self, block: Block, states: Array, p: Array) -> Linear:
        """Linearise along a measured motion ``states`` (W, L, X) with ``p`` (P,), SI: every sample
        starts anew."""
        p = with_known(self.machine, p, block.known)
        ends, *slopes = self._run(block, states[:, :-1], p, "screen")
        return self._linear(block, states, states[:, 1:] - ends, slopes, p)

    def _linear(
        self, block: Block, x: Array, defect: Array, slopes: list[Array], p: Array
    ) -> Linear:
        transition, left, right, by_free = slopes
        output, by_state, direct, by_force = self._outputs(block, x, p)
        return Linear(
            x,
            output,
            defect,
            transition,
            left,
            right,
            by_free,
            by_state,
            by_force,
            direct,
            *self._directions(block, x[:, 0], p),
        )

    def closed(self, block: Block, start: Array, p: Array) -> Array:
        """Initial states (W, X) moved onto the constraints under ``p`` (P,), SI."""
        if not self.machine.constraints:
            return start
        form, drive, p = self.form, block.d[:, 0], with_known(self.machine, p, block.known)
        q, v = form.motion(start, drive)
        still, t = np.zeros_like(q), block.t[:, 0]
        on = closed(self.machine, (q, v, still), t, p, form.given)
        return form.state(on.q, on.v, start[:, 2 * len(form.free) :])

    def _directions(self, block: Block, start: Array, p: Array) -> tuple[Array | None, ...]:
        """Where initial states (W, X) may move within the constraints, and must with parameters."""
        if not self.machine.constraints:
            return None, None
        form = self.form
        windows, states = start.shape
        q, v = form.motion(start, block.d[:, 0])
        held = tangent(self.machine, q, v, block.t[:, 0], p, form.given, self.free)
        f, r = 2 * len(form.free), held.basis.shape[2]
        begin = np.zeros((windows, states, r + states - f))
        begin[:, :f, :r] = held.basis
        begin[:, f:, r:] = np.eye(states - f)
        by_free = np.zeros((windows, states, len(self.free)))
        by_free[:, :f] = held.by_p
        return begin, by_free

    def _run(self, block: Block, starts: Array, p: Array, what: str) -> list[Array]:
        """Integrate from one start a window (W, 1, X) or one a sample (W, L − 1, X).

        Returns states at the ends (W, L − 1, X) and, unless ``what`` is plain, the slopes from
        sample to sample.
        """
        acted = self._acted(block, p)
        drive = self.form.extended(block.d, block.t, block.record, p, block.late, acted)
        windows, length, inputs = drive.shape
        states, parts = starts.shape[2], block.substeps.reshape(-1)
        if states == 0:  # all motion is given, and nothing remembers
            return self._nothing(windows, length - 1, what)
        first = np.concatenate([[0], np.cumsum(parts)[:-1]])
        part = np.arange(parts.sum()) - np.repeat(first, parts)
        h = np.repeat(np.diff(block.t, axis=1).reshape(-1) / parts, parts)
        rise = np.diff(drive, axis=1).reshape(parts.size, inputs) / parts[:, None]
        rise[:, [*self._held, *self._slopes_of(acted, self._held)]] = 0.0
        rise = np.repeat(rise, parts, axis=0)
        d0 = np.repeat(drive[:, :-1].reshape(parts.size, inputs), parts, axis=0)
        d0 += part[:, None] * rise
        d1 = d0 + rise
        t = np.repeat(block.t[:, :-1].reshape(-1), parts) + part * h
        self._bend(d0, t, block, p, acted)
        self._bend(d1, t + h, block, p, acted)
        self._hold(d0, d1, t, h, block, p, acted)
        begins = first.reshape(windows, length - 1)[:, : starts.shape[1]].reshape(-1)
        given = d0, d1, t[:, None], h[:, None]
        shape = (windows, length - 1, states)
        starts = starts.reshape(-1, states)
        if what == "plain":
            after, _ = self._applied(begins, starts, given, p)
            return [after[first + parts - 1].reshape(shape)]
        after, middle = self._applied(begins, starts, given, p)
        before = np.concatenate([after[:1], after[:-1]])
        before[begins] = starts
        ends = after[first + parts - 1].reshape(shape)
        run = Taken((before, middle, after), given)
        if not (self._smooth or self._held or acted):  # drives are lines between samples
            run, first, parts = in_pieces(run, first, parts)
        found = self._steps.slopes(run, p, what == "screen")
        made = joined(found, len(self.free), first, parts)
        slopes = [one.reshape(*shape, -1) for one in made]
        if what == "fit":  # no test force is asked for
            slopes[1] = slopes[2] = np.zeros((*shape, self.machine.n))
        return [ends, *slopes]

    def _applied(
        self, begins: NDArray[np.int64], starts: Array, given: Sequence[Array], p: Array
    ) -> list[Array]:
        """All outputs of steps (S, entries) that begin anew at ``begins`` (C,) from ``starts`` (C,
        X), with the arguments ``given`` (S, rows) of each, chain by chain. Chains of two lengths go
        apart; where there are more, the shorter ones wait at their ends."""
        total, run = len(given[0]), self._steps.run
        count = np.diff(np.append(begins, total))
        lengths = np.unique(count)
        if lengths.size > 2:
            longest = np.arange(lengths[-1])
            place = begins[:, None] + np.minimum(longest, count[:, None] - 1)
            real = longest < count[:, None]
            d0, d1, t, h = (a.take(place, axis=0) for a in given)
            made = run(starts, (d0, d1, t, np.where(real[..., None], h, 0.0)), p)
            rows = np.flatnonzero(real)
            return [one.reshape(real.size, one.shape[2]).take(rows, axis=0) for one in made]
        results: list[Array] = []
        for steps in lengths:
            mine = np.flatnonzero(count == steps)
            place = begins[mine, None] + np.arange(steps)
            alone = mine.size == count.size
            shape = (*place.shape, -1)
            varying = [a.reshape(shape) if alone else a.take(place, axis=0) for a in given]
            made = run(starts[mine], varying, p)
            if alone:
                return [output.reshape(total, -1) for output in made]
            results = results or [np.empty((total, output.shape[2])) for output in made]
            for result, output in zip(results, made, strict=True):
                result[place] = output
        return results

    def _acted(self, block: Block, p: Array) -> dict[int, Acted]:
        """What actuators pass on of the record; of a block without one they did already."""
        times, values = block.record
        if not times.size:
            return {}
        return acting_inputs(self.machine, p, times, values, self._fine, self.form.shaping)

    def _slopes_of(self, acted: Mapping[int, Acted], inputs: Collection[int]) -> list[int]:
        """Where the slopes of these inputs by numbers of actuators stand in the drive."""
        first, columns = self.form.first_slope, self.form.shaped_columns(acted)
        return [first + j for i, mine in columns if i in inputs for j in mine]

    def _bend(
        self, drive: Array, t: Array, block: Block, p: Array, acted: Mapping[int, Acted]
    ) -> None:
        """Put the inputs that are no lines between samples, smooth or by their actuators, into
        drives (S, …) at times (S,)."""
        times, values = block.record
        for i in self._smooth if times.size else ():
            if i not in acted:
                drive[:, i] = np.interp(t - self.form.cleared(i, p), times, values[:, i])
        for i, one in acted.items():
            if i not in self._held:
                at = t - self.form.cleared(i, p)
                drive[:, i] = one.at(at)
                drive[:, self._slopes_of(acted, (i,))] = one.by_at(at)

    def _hold(
        self,
        d0: Array,
        d1: Array,
        t: Array,
        h: Array,
        block: Block,
        p: Array,
        acted: Mapping[int, Acted],
    ) -> None:
        """Put inputs that hold each sample until the next, under a delay, into drives (S, …) at the
        begin and the end of steps at ``t`` (S,) of length ``h`` (S,): a line over the step, whose
        impulse and first moment are exact, and its slopes by time."""
        times, values = block.record
        first = self.form.inputs + 3 * len(self.form.given)  # of the slopes
        for i in self._held if times.size else ():
            lag, signal = self.form.cleared(i, p), acted[i].u if i in acted else values[:, i]
            if not (lag or self.form.late):
                continue
            sides, slopes = held_line(times, signal, t - lag, t + h - lag)
            if lag:
                d0[:, i], d1[:, i] = sides
            if self.form.late:
                d0[:, first + i], d1[:, first + i] = slopes

    def _nothing(self, windows: int, steps: int, what: str) -> list[Array]:
        columns = {"plain": [], "fit": [len(self.free)], "screen": [len(self.free)]}[what]
        n = self.machine.n
        slopes = [0, n, n, *columns] if what != "plain" else []
        return [np.zeros((windows, steps, 0)), *(np.zeros((windows, steps, 0, c)) for c in slopes)]

    def _outputs(self, block: Block, x: Array, p: Array) -> tuple[Array, ...]:
        windows, length, _ = x.shape
        acted = self._acted(block, p)
        drive = self.form.extended(block.d, block.t, block.record, p, block.late, acted)
        total = windows * length
        given = x.reshape(total, -1), drive.reshape(total, -1), block.t.reshape(-1), p
        y, *slopes = along(self._steps.sense, given, (3,), total)
        m = len(self.machine.model.sensors)
        return (
            y.reshape(windows, length, m),
            *(_rows(s.reshape(windows, length, -1, m)) for s in slopes),
        )


def _rows(columns: Array) -> Array:
    """Matrices (W, L, m, C) from their columns one after the other (W, L, C, m)."""
    return np.ascontiguousarray(columns.swapaxes(2, 3))

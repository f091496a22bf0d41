"""The noise of a measured input in windows: how far the machine passes it on to the sensors.

An input that is measured with noise drives the simulation of a window with that noise, so that what
is left of the sensors is no longer white. With J the reply of a window's outputs to errors of the
input's samples, its covariance is

    R + J Q Jᵀ        R: noise of the sensors, Q: white noise of the inputs

which the gains of a Kalman filter along the linearised machine whiten (Cholesky's factor of that
matrix, in time that grows with the samples and not with their cube). The machine is linearised
along the structure that was decided; the filter starts without an error, for the initial states of
windows are fitted.

Slopes along a noisy input are too large, so that numbers come out too small (attenuation: Fuller,
Measurement Error Models, 1987, §1.1). So windows are simulated with the inputs u + û, where û is
what the smoother makes of their errors, and held against y + J û, which changes no residual of the
structure along which it was found (a step of Gauss and Newton of all errors of the inputs).
Sizes: N samples, X states, m sensors, k noisy inputs, W windows, L samples a window, K columns.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.likelihood.filter import whiten
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import Track, smoothed, still
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.sweeps import responses


@dataclass(frozen=True, slots=True, eq=False)
class InputNoise:
    """White noise of some ``inputs`` (k,), of deviation ``size`` (k,), along a recording:
    ``transition`` (N − 1, X, X), what errors of the inputs at the sample before (``left``) and
    after (``right``, N − 1, X, k) do to the next state, and what the sensors show of the state
    (``by_state``, N, m, X) and of those errors at once (``by_input``, N, m, k). ``known`` (N, k)
    is û. SI."""

    inputs: tuple[int, ...]
    size: Array
    transition: Array
    left: Array
    right: Array
    by_state: Array
    by_input: Array
    known: Array

    def whitened(
        self, rows: NDArray[np.int64], columns: Array, seen: NDArray[np.bool_], sd: Array
    ) -> Array:
        """Columns (W, L, m, K), SI, of windows of the samples ``rows`` (W, L) in units of the
        noise, uncorrelated; 0 where nothing is ``seen`` (W, L, m). ``sd`` (m,): of the sensors."""
        count = columns.shape[3]
        states, sensors, k = self.transition.shape[1], sd.size, self.size.size
        steps = rows.shape[1] - 1
        rest = (
            np.zeros((steps, states, count)),
            np.zeros((states, count)),
            np.zeros((states, states)),
            np.zeros((steps, k)),
            np.zeros((steps, 0)),
        )
        white = np.empty(columns.shape)
        for w, (first, last) in enumerate(rows[:, [0, -1]]):
            between, at = slice(first, last), slice(first, last + 1)
            white[w], _ = whiten(
                self.transition[between],
                self.left[between],
                self.right[between],
                self.by_state[at],
                self.by_input[at],
                seen[w],
                rest[0],
                np.ascontiguousarray(columns[w]),
                *rest[1:],
                self.size**2,
                sd**2,
                np.zeros(0),
                np.full(sensors, -1),
            )
        return white

    def shown(self, rows: NDArray[np.int64]) -> Array:
        """What û does to the sensors of windows (W, L, m) of the samples ``rows`` (W, L), SI."""
        errors, before = self.known[rows][..., None], rows[:, :-1]
        added = self.left[before] @ errors[:, :-1] + self.right[before] @ errors[:, 1:]
        rest = np.zeros((len(rows), self.transition.shape[1], 1))
        moved = responses(self.transition[before], self.by_state[rows], rest, added)
        return np.asarray(moved + self.by_input[rows] @ errors)[..., 0]

    def put_right(self, item: Cut) -> Cut:
        """Windows of the recording that know of this noise, with û added to their inputs."""
        block, columns = item.block, list(self.inputs)
        d = block.d.copy()
        d[..., columns] += self.known[item.rows]
        times, values = block.record
        errors = [np.interp(times, item.source[0].t, error) for error in self.known.T]
        values = values.copy()
        values[:, columns] += np.stack(errors, axis=1)
        y = block.y + self.shown(item.rows)
        return replace(item, block=replace(block, d=d, record=(times, values), y=y), noise=self)


def by_input(one: Track, push: Array, shown: Array) -> Track:
    """A track whose unknown forces are errors of inputs, each of which pushes with ``push``
    (N, n, k) and shows at once as ``shown`` (N, m, k), SI for one unit of it."""
    linear = one.linear
    return replace(
        one,
        linear=replace(
            linear,
            left=(linear.left[0] @ push[:-1])[None],
            right=(linear.right[0] @ push[1:])[None],
            by_force=shown[None],
        ),
    )


def along_recording(
    tracks: Sequence[Track], samples: int, noise: NoiseModel, inputs: tuple[int, ...]
) -> InputNoise:
    """What the stretches of one recording of so many ``samples`` (:func:`by_input`) say of the
    noise of its ``inputs`` (k,); between them there is none."""
    first = tracks[0].linear
    states, k, m = first.transition.shape[2], first.left.shape[3], first.by_state.shape[2]
    found = InputNoise(
        inputs,
        noise.force,
        np.zeros((samples - 1, states, states)),
        np.zeros((samples - 1, states, k)),
        np.zeros((samples - 1, states, k)),
        np.zeros((samples, m, states)),
        np.zeros((samples, m, k)),
        np.zeros((samples, k)),
    )
    for one in tracks:
        linear, at = one.linear, one.item.rows[0]
        found.transition[at[:-1]] = linear.transition[0]
        found.left[at[:-1]], found.right[at[:-1]] = linear.left[0], linear.right[0]
        found.by_state[at], found.by_input[at] = linear.by_state[0], linear.by_force[0]
        found.known[at] = smoothed(one, noise, still(one)).force
    return found

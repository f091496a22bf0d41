"""The integration steps of windows as functions, and their slopes.

A step that is differentiated as a whole is tens to hundreds of thousands of instructions, anew for
every cause that is tried. Slopes of steps follow instead from those of the rates
(:mod:`symhyb.numeric.kernels.collocation`), along a run that is there already.

A run that dry friction asks for may take a hundred steps between two samples, where its slopes are
smooth in all but few. So those are made along pieces of several steps, at states of that run
(:func:`in_pieces`).

Sizes: S steps, M intervals between samples, X states, n coordinates, m sensors, F free parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.chains import Chains
from symhyb.numeric.kernels.collocation import collocated
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.dry_steps import step_of
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.lowered.steps import rate_slopes

STEPS_AT_ONCE = 4096
SAME = 1e-9  # of a drive or a step: less is rounding
PIECES_MOST = 8  # between two samples, along which slopes are made


@dataclass(frozen=True, slots=True)
class Taken:
    """Steps of a run: the ``states`` before them, in their middle and after them (S, X), and
    ``given`` the drive before and after (S, drive), times (S, 1) and lengths (S, 1), s."""

    states: tuple[Array, Array, Array]
    given: tuple[Array, Array, Array, Array]


def in_pieces(
    run: Taken, first: NDArray[np.int64], parts: NDArray[np.int64]
) -> tuple[Taken, NDArray[np.int64], NDArray[np.int64]]:
    """A run in no more pieces between two samples than ``PIECES_MOST``, each of several of its
    steps, with the first piece (M,) of each interval and how many there are (M,). It had ``parts``
    (M,) steps of one length from the ``first`` (M,) on, with drives that are lines; where these
    are no multiple of the pieces they stay as they are."""
    size = np.where(parts % PIECES_MOST == 0, parts // PIECES_MOST, 1)
    if (size == 1).all():
        return run, first, parts
    count = parts // size
    begin = np.cumsum(count) - count
    each = np.repeat(size, count)
    at = np.repeat(first, count) + (np.arange(each.size) - np.repeat(begin, count)) * each
    last, half = at + each - 1, at + each // 2
    before, middle, after = run.states
    between = np.where((each % 2 == 0)[:, None], before[half], middle[half])
    d0, d1, t, h = run.given
    made = Taken(
        (before[at], between, after[last]), (d0[at], d1[last], t[at], h[at] * each[:, None])
    )
    return made, begin, count


class Steps:
    """The step functions of a form: each lowered when it is asked for, and once."""

    def __init__(self, form: StateForm, free: list[int]):
        self.sense = _sensing(form, free)
        self._form, self._free = form, free
        self._rates: dict[bool, ca.Function] = {}

    @property
    def run(self) -> Chains:
        """The steps of chains, with the state in the middle of each: the same whatever is free."""
        return kept(("steps", self._form.key), lambda: Chains(step_of(self._form)))

    def slopes(self, run: Taken, p: Array, forces: bool) -> Array:
        """Slopes of steps by x, free parameters and, if asked for, test ``forces`` (S, X + F + n,
        X), column by column, SI; ``p`` (P,) in SI."""
        states, given = run.states, run.given
        size, own = self._form.size, len(self._free)
        count = size + own + (self._form.machine.n if forces else 0)
        found = np.empty((len(given[3]), count, size))
        for begin in range(0, len(found), STEPS_AT_ONCE):
            rows = slice(begin, begin + STEPS_AT_ONCE)
            part = [x[rows] for x in states], [one[rows] for one in given]
            slopes, nodes = self._at_nodes(*part, p, forces)
            found[rows] = collocated(slopes, nodes, part[1][3][:, 0], len(self._form.free))
        return found

    def _at_nodes(
        self, states: Sequence[Array], given: Sequence[Array], p: Array, forces: bool
    ) -> tuple[Array, NDArray[np.int64]]:
        """Slopes of the rates (N, X + F + n, m) before, in the middle of and after steps, and where
        those of each step stand (S, 3): where one ends as the next begins they are taken once."""
        before, middle, after = states
        d0, d1, t, h = given
        steps = len(h)
        size = np.abs(d0).max(axis=0, initial=1e-300)
        same = np.zeros(steps, bool)
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
        first = np.arange(steps)
        ends = np.where(same, first + 1, 2 * steps - 1 + np.cumsum(last))
        return flat.reshape(len(x), -1, flat.shape[1]), np.stack([first, steps + first, ends], 1)


def _sensing(form: StateForm, free: list[int]) -> ca.Function:
    """(x, d, t, p) -> outputs (m), ∂/∂x (m, X), ∂/∂free (m, F), ∂/∂w (m, n)."""
    x, d, t, p, w = form.symbols()
    y, _ = form.outputs()(x, d, t, p, w)
    parts = [y, ca.jacobian(y, x), ca.jacobian(y, p)[:, free], ca.jacobian(y, w)]
    parts = [ca.densify(ca.substitute(part, w, 0 * w)) for part in parts]
    return ca.Function("sense", [x, d, t, p], parts, {"cse": True})

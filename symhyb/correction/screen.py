"""The screen: every cause pushed once through the linearised dynamics along the recording.

The dynamics are linearised along the *measured* (smoothed) motion, so that a poor model does not
carry the windows away before the causes are compared; what the model fails to do from sample to
sample is the defect that the causes compete to explain. Screening names causes to try and gives
starting values; it does not decide. Sizes: W windows, L samples, n coordinates, C columns.
"""

from collections.abc import Sequence

import numpy as np

from symhyb.correction.selection import Problem
from symhyb.discrepancy.hypotheses import GAIN_REACH, Hypothesis, Library
from symhyb.discrepancy.windows import Laid, reduce
from symhyb.numeric.buffers import Array
from symhyb.numeric.windows import Linear, WindowModel


def screen(
    library: Library,
    model: WindowModel,
    dull: Sequence[Hypothesis],
    laid: Sequence[Laid],
    p: Array,
    sd: Array,
    starts: Sequence[Array] | None = None,
    gain_floor: float = 0.0,
) -> Problem:
    """Reduce windows to a linear problem in the forces of ``library`` and the free parameters.

    The first free parameters of ``model`` are those of the ``dull`` causes; any others are in every
    subset. With ``starts`` (one (W, 2n) a recording) the linearisation is along the simulation from
    there instead of the motion. A gain closer to 1 than ``gain_floor`` is none. ``p`` (P,), ``sd``
    (m,) in SI.
    """
    parts = []
    for i, fine in enumerate(laid):
        item = fine.suited(model.machine.model)
        if starts is None:
            linear = model.along(item.block, item.motion, p)
        else:
            linear = model.differentiate(item.block, starts[i], p, forces=True)
        residual = item.block.y - linear.output - linear.from_defect()
        columns = [_force_columns(library, item, linear), linear.from_free()]
        parts.append(
            reduce(residual, linear.from_start(), np.concatenate(columns, axis=3), sd, item.held)
        )
    forces, free = sum(map(len, library.columns)), len(model.free)
    lower, upper = _bounds(library, dull, free)
    return Problem(
        gram=np.sum([part.grams[~part.held].sum(axis=0) for part in parts], axis=0),
        held=np.sum([part.grams[part.held].sum(axis=0) for part in parts], axis=0),
        hypotheses=(*library.hypotheses, *dull),
        columns=(*library.columns, *((forces + i,) for i in range(len(dull)))),
        always=tuple(range(forces + len(dull), forces + free)),
        prior=np.concatenate([np.zeros(forces), _priors(model, dull), np.zeros(free - len(dull))]),
        lower=lower,
        upper=upper,
        least=np.concatenate(
            [
                np.zeros(forces),
                [gain_floor if cause.kind == "gain" else 0.0 for cause in dull],
                np.zeros(free - len(dull)),
            ]
        ),
    )


def _force_columns(library: Library, item: Laid, linear: Linear) -> Array:
    """Responses of the sensors (W, L, m, C) to the forces of all probes along the windows."""
    windows, length, states = linear.x.shape
    n, flat = states // 2, linear.x.reshape(windows * length, states)
    u, t = item.block.u.reshape(windows * length, -1), item.block.t.reshape(-1)
    forces = library.forces(flat[:, :n], flat[:, n:], u, t)
    return linear.from_forces(forces.reshape(windows, length, n, -1))


def _bounds(library: Library, dull: Sequence[Hypothesis], free: int) -> tuple[Array, Array]:
    """Bounds of the coefficients: dissipation is positive, a gain is off by half at most."""
    lower = [0.0 if sign else -np.inf for h in library.hypotheses for sign in h.positive]
    lower += [-GAIN_REACH if h.kind == "gain" else -np.inf for h in dull]
    upper = [np.inf] * (len(lower) - len(dull))
    upper += [GAIN_REACH if h.kind == "gain" else np.inf for h in dull]
    rest = np.full(free - len(dull), np.inf)
    return np.concatenate([lower, -rest]), np.concatenate([upper, rest])


def _priors(model: WindowModel, dull: Sequence[Hypothesis]) -> Array:
    """1/sd² of the parameters that state an sd, 0 for gains and offsets, SI."""
    spread = {item.path: item.si_sd for item in model.machine.model.all_parameters()}
    return np.array([0.0 if (sd := spread[h.path]) is None else sd**-2 for h in dull])

"""The screen: every cause pushed once through the linearised dynamics along the recording.

The dynamics are linearised along the *measured* (smoothed) motion, so that a poor model does not
carry the windows away before the causes are compared; what the model fails to do from sample to
sample is the defect that the causes compete to explain. Screening names causes to try and gives
starting values; it does not decide. Sizes: W windows, L samples, n coordinates, C columns.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from symhyb.correction.selection import Problem
from symhyb.discrepancy.course import Course
from symhyb.discrepancy.hypotheses import GAIN_REACH, Hypothesis, Library
from symhyb.discrepancy.windows import Laid, reduce
from symhyb.numeric.buffers import Array
from symhyb.numeric.dynamics import state_form
from symhyb.numeric.windows import WindowModel

DELAY_LEAST = 0.25  # samples: less is a matter of how a signal was held between samples


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
    subset. With ``starts`` (one (W, X) a recording) the linearisation is along the simulation from
    there instead of the motion. A gain closer to 1 than ``gain_floor`` is none. ``p`` (P,), ``sd``
    (m,) in SI.
    """
    parts = []
    for i, fine in enumerate(laid):
        item = fine.suited(model.machine)
        if starts is None:
            linear = model.along(item.block, item.states, p)
        else:
            linear = model.differentiate(item.block, starts[i], p, forces=True)
        residual = item.block.y - linear.output - linear.from_defect()
        probes = _probe_forces(library, item, None if starts is None else linear.x)
        columns = [linear.from_forces(probes), linear.from_free()]
        parts.append(
            reduce(
                residual,
                linear.from_start()[..., : 2 * len(model.form.free)],
                np.concatenate(columns, axis=3),
                sd,
                item.held,
            )
        )
    forces, free = sum(map(len, library.columns)), len(model.free)
    declared = {item.path: item.si for item in model.machine.model.all_parameters()}
    lower, upper = _bounds(library, dull, free, declared)
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
                [_least(cause, gain_floor, laid, declared) for cause in dull],
                np.zeros(free - len(dull)),
            ]
        ),
    )


def _least(
    cause: Hypothesis, gain_floor: float, laid: Sequence[Laid], values: Mapping[str, float]
) -> float:
    """The smallest size of a dull cause that is worth a name, SI."""
    if cause.kind == "delay":
        return DELAY_LEAST * float(np.median(np.diff(laid[0].block.t, axis=1)))
    if cause.kind in ("parameter", "gain"):
        return gain_floor * abs(float(values[cause.path]))
    return 0.0


def _probe_forces(library: Library, item: Laid, simulated: Array | None) -> Array:
    """Forces of all probes (W, L, n, C) along the windows: along the measured motion, or along
    ``simulated`` states (W, L, X); what remembers follows the measured motion always."""
    machine, rows = library.machine, item.rows
    course = item.course(machine)
    if simulated is None:
        return library.forces(course)[rows]
    form = state_form(machine)
    q, v = form.motion(simulated, item.block.d)
    flat = Course(
        item.block.t.reshape(-1), q.reshape(rows.size, -1), v.reshape(rows.size, -1),
        course.a[rows].reshape(rows.size, -1), course.z[rows].reshape(rows.size, -1),
        course.u[rows].reshape(rows.size, -1), *(np.empty((0, 0)) for _ in range(3)),
    )  # fmt: skip
    return library.forces(flat).reshape(*rows.shape, machine.n, -1)


def _bounds(
    library: Library, dull: Sequence[Hypothesis], free: int, values: Mapping[str, float]
) -> tuple[Array, Array]:
    """Bounds of the coefficients: dissipation is positive, a gain is off by half at most."""
    reach = [GAIN_REACH * abs(values[h.path]) if h.kind == "gain" else np.inf for h in dull]
    lower = [0.0 if sign else -np.inf for h in library.hypotheses for sign in h.positive]
    upper = [np.inf] * len(lower) + reach
    lower += [-one for one in reach]
    rest = np.full(free - len(dull), np.inf)
    return np.concatenate([lower, -rest]), np.concatenate([upper, rest])


def _priors(model: WindowModel, dull: Sequence[Hypothesis]) -> Array:
    """1/sd² of the parameters that state an sd, 0 for gains and offsets, SI."""
    spread = {item.path: item.si_sd for item in model.machine.model.all_parameters()}
    return np.array([0.0 if (sd := spread[h.path]) is None else sd**-2 for h in dull])

"""The screen: every cause pushed once through the linearised dynamics along the recording.

The dynamics are linearised along the *measured* (smoothed) motion, so that a poor model does not
carry the windows away before the causes are compared; what the model fails to do from sample to
sample is the defect that the causes compete to explain. Screening names causes to try and gives
starting values; it does not decide. Sizes: W windows, L samples, n coordinates, C columns.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from symhyb.correction.search.owners import Layout, layout, own_terms
from symhyb.correction.search.selection import Problem
from symhyb.discrepancy.places.hypotheses import Hypothesis, Library
from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.recorded.windows import Cut, summed
from symhyb.judgement import DELAY_LEAST, GAIN_REACH
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.runs.windows import WindowModel


def screen(
    library: Library,
    model: WindowModel,
    parametric: Sequence[Hypothesis],
    cuts: Sequence[Cut],
    p: Array,
    sd: Array,
    starts: Sequence[Array] | None = None,
    gain_floor: float = 0.0,
    each: Sequence[Array] | None = None,
    own: Mapping[int, str] | None = None,
) -> Problem:
    """Reduce windows to a linear problem in the forces of ``library`` and the free parameters.

    The first free parameters of ``model`` are those of the ``parametric`` causes; any others are in
    every subset. With ``starts`` (one (W, X) a recording) the linearisation is along the simulation
    from there instead of the motion. A gain closer to 1 than ``gain_floor`` is none. ``p`` (P,),
    ``sd`` (m,) in SI; with ``each``, a vector of parameters for every recording instead of ``p``.
    The free parameters ``own`` (their columns in p) have a value in each recording, as causes may,
    or in each group of a grouping.
    """
    parts = []
    forces, free = sum(map(len, library.columns)), len(model.free)
    given = (*library.columns, *((forces + i,) for i in range(len(parametric))))
    always = tuple(range(forces + len(parametric), forces + free))
    causes = (*library.hypotheses, *parametric)
    mine = {
        columns[i]: by
        for cause, columns in zip(causes, given, strict=True)
        for i, by in own_terms(cause)
    }
    for i, column in enumerate(model.free):
        if column in (own or {}) and i >= len(parametric):
            mine[forces + i] = (own or {})[column]
    places = layout(mine, forces + free, [item.source[0] for item in cuts])
    for i, fine in enumerate(cuts):
        now = p if each is None else each[i]
        item = fine.suited(model.machine).in_time(model, now)
        if starts is None:
            linear = model.along(item.block, item.states, now)
        else:
            linear = model.differentiate(item.block, starts[i], now, forces=True)
        residual = item.block.y - linear.output - linear.from_defect()
        probes = _probe_forces(library, item, None if starts is None else linear.x)
        columns = [linear.from_forces(probes), linear.from_free()]
        parts.append(
            summed(
                item,
                residual,
                linear.from_start()[..., : model.form.moving],
                apart(np.concatenate(columns, axis=3), places, i),
                sd,
            )
        )
    source = list(places.source)
    declared = {item.path: item.si for item in model.machine.model.all_parameters()}
    lower, upper = _bounds(library, parametric, free, declared)
    prior = np.concatenate(
        [np.zeros(forces), _priors(model, parametric), np.zeros(free - len(parametric))]
    )
    floors = [_least(cause, gain_floor, cuts, declared) for cause in parametric]
    least = np.concatenate([np.zeros(forces), floors, np.zeros(free - len(parametric))])
    return Problem(
        gram=np.sum([fitted for fitted, _ in parts], axis=0),
        held=np.sum([held for _, held in parts], axis=0),
        hypotheses=causes,
        columns=tuple(places.widened(one) for one in given),
        always=places.widened(always),
        prior=prior[source],
        lower=lower[source],
        upper=upper[source],
        least=least[source],
        recordings=tuple(item.source[0].name for item in cuts),
        places=places,
    )


def apart(columns: Array, places: Layout, which: int) -> Array:
    """Columns (W, L, m, F) of one recording, in units of the noise, at their ``places`` among those
    of all."""
    if not places.apart:
        return columns
    wide = np.zeros((*columns.shape[:3], len(places.source)))
    wide[..., list(places.rows[which])] = columns
    return wide


def _least(
    cause: Hypothesis, gain_floor: float, cuts: Sequence[Cut], values: Mapping[str, float]
) -> float:
    """The smallest size of a parametric cause that is worth a name, SI."""
    if cause.kind == "delay":
        return DELAY_LEAST * float(np.median(np.diff(cuts[0].block.t, axis=1)))
    if cause.kind in ("parameter", "gain"):
        return gain_floor * abs(float(values[cause.path]))
    return 0.0


def _probe_forces(library: Library, item: Cut, simulated: Array | None) -> Array:
    """Forces of all probes (W, L, n, C) along the windows: along the measured motion, or along
    ``simulated`` states (W, L, X); what remembers follows the measured motion always."""
    machine, rows = library.machine, item.rows
    course = item.course(machine)
    if simulated is None:
        return library.forces(course)[rows]
    form = state_form(machine)
    q, v = form.motion(simulated, item.block.d)
    flat = Course(
        item.block.t.reshape(-1),
        q.reshape(rows.size, -1),
        v.reshape(rows.size, -1),
        course.a[rows].reshape(rows.size, -1),
        course.z[rows].reshape(rows.size, -1),
        course.u[rows].reshape(rows.size, -1),
        states=np.empty((0, 0)),
        drive=np.empty((0, 0)),
        reaction=np.empty((0, 0)),
        known=course.known,
    )
    return library.forces(flat).reshape(*rows.shape, machine.n, -1)


def _bounds(
    library: Library, parametric: Sequence[Hypothesis], free: int, values: Mapping[str, float]
) -> tuple[Array, Array]:
    """Bounds of the coefficients: dissipation is positive, a gain is off by half at most."""
    reach = [GAIN_REACH * abs(values[h.path]) if h.kind == "gain" else np.inf for h in parametric]
    lower = [0.0 if sign else -np.inf for h in library.hypotheses for sign in h.positive]
    upper = [np.inf] * len(lower) + reach
    lower += [-one for one in reach]
    rest = np.full(free - len(parametric), np.inf)
    return np.concatenate([lower, -rest]), np.concatenate([upper, rest])


def _priors(model: WindowModel, parametric: Sequence[Hypothesis]) -> Array:
    """1/sd² of the parameters that state an sd, 0 for gains and offsets, SI."""
    spread = {item.path: item.si_sd for item in model.machine.model.all_parameters()}
    return np.array([0.0 if (sd := spread[h.path]) is None else sd**-2 for h in parametric])

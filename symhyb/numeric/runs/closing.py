"""Whole runs of a machine with constraints: starts and rows moved onto them, and where loops lock.

Integration holds the constraints to its own tolerance. What a run returns is moved the rest of the
way, by the shortest step; where that is impossible, the loop has locked or was torn open, and the
run ends there with a reason.
"""

import numpy as np

from symhyb.numeric.kernels.buffers import Array, on_lines
from symhyb.numeric.lowered.dependence import constraint_of
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.lowered.manifold import closed, gaps_of, placing
from symhyb.numeric.runs.scenario import Scenario

OPEN_MOST = 1e-8  # of the size of the motion: more is a loop that does not close
FOLDS_MOST = 2000  # rows of a run that are looked at for positions in which loops fold over
NEAR_LOCK = 1e-2  # smallest over largest singular value of J, scaled: a loop about to lock


def closed_start(
    form: StateForm, start: Array, drive: Array, scenario: Scenario, p: Array
) -> tuple[Array, str]:
    """The state (X,), SI, at the start of a scenario on the constraints, and why there is none."""
    if not form.machine.constraints:
        return start, ""
    begin = scenario.t[:1]
    first = on_lines(scenario.t_u, drive, begin)
    rows, left, _ = _moved(form, start[None], first, begin, p)
    if left[0] <= OPEN_MOST:
        return rows[0], ""
    said = _worst(form, rows[0], first[0], float(begin[0]), p)
    return start, f"the constraints cannot be met at the start: {said}"


def closed_rows(
    form: StateForm, scenario: Scenario, drive: Array, x: Array, p: Array, reason: str
) -> tuple[Array, str, str]:
    """States (N, X) of a run on the constraints, SI, why it ended (what CVODES says, else where
    the loop no longer closes, from where on rows are NaN), and where its loops can fold over."""
    if not form.machine.constraints:
        return x, reason, ""
    d = on_lines(scenario.t_u, drive, scenario.t)
    whole = np.isfinite(x).all(axis=1)
    rows, left = x.copy(), np.full(len(x), np.inf)
    if not whole.any():
        return rows, reason, ""
    rows[whole], left[whole], slope = _moved(form, x[whole], d[whole], scenario.t[whole], p)
    torn = np.flatnonzero(whole & ~(left <= OPEN_MOST))
    end = int(torn[0]) if torn.size else int(whole.sum())
    last, t = max(end - 1, 0), scenario.t
    note = _folded(t[:end], slope[:end], end < len(x))
    if not torn.size and not reason:
        return rows, "", note
    before, slack = (
        _slack(form, rows[row], d[row], float(t[row]), p) for row in (max(last - 1, 0), last)
    )
    rows[end:] = np.nan
    # towards a lock the square of the slack falls linearly: here it would be 0 within two rows
    locks = slack < NEAR_LOCK or before**2 - slack**2 > 0.5 * slack**2
    if not torn.size and not locks:
        return rows, reason, note
    said = _worst(form, x[last], d[last], float(t[last]), p)
    return rows, f"the loop locks after {t[last]:.6g} s: {said}", note


def _folded(t: Array, slope: Array, ended: bool) -> str:
    """Where a run passes a position in which its loops can fold over, as a sentence; empty if
    nowhere. ``slope`` (N, h, f) is J of the rows that hold places, at ``t`` (N,) s, after which the
    run had ``ended`` early.

    The smallest singular value of J, its rows over their largest length, falls to 0 there: before
    an output towards which it falls so steeply that it would be negative."""
    count, held, free = slope.shape
    if not 0 < held <= free or count < 4:
        return ""
    some = np.unique(np.linspace(0, count - 1, min(count, FOLDS_MOST)).astype(int))
    t, slope = t[some], slope[some]
    size = np.linalg.norm(slope, axis=2, keepdims=True).max(axis=0)
    unit = slope / np.maximum(size, 1e-300)
    least = np.sqrt(np.maximum(np.linalg.eigvalsh(unit @ unit.swapaxes(1, 2))[:, 0], 0.0))
    steep = np.flatnonzero(2 * least[1:-1] < least[:-2])
    passed = 1 + steep[np.diff(steep, prepend=-2) > 1]
    if passed.size:
        first = int(passed[0])
        more = f", and {passed.size - 1} times more" if passed.size > 1 else ""
        where = f"between {t[first]:.6g} and {t[first + 1]:.6g} s{more}"
    elif ended and 2 * least[-1] < least[-2]:
        where = f"after {t[-1]:.6g} s"
    else:
        return ""
    return (
        f"{where} the machine passes a position in which its loops can fold over: which way it "
        "goes on hangs on the last digit"
    )


def _moved(form: StateForm, x: Array, d: Array, t: Array, p: Array) -> tuple[Array, Array, Array]:
    """States (N, X) on the constraints, what is left open (N,), of the size of the motion, and J of
    the rows that hold places (N, h, f)."""
    q, v = form.motion(x, d)
    on = closed(form.machine, (q, v, np.zeros_like(q)), t, p, form.given)
    size = 1 + np.abs(on.q).max(axis=1, initial=0.0)
    left = np.abs(on.left).max(axis=1, initial=0.0) / size
    slope = on.slope[:, placing(form.machine)][:, :, list(form.free)]
    return form.state(on.q, on.v, x[:, 2 * len(form.free) :]), left, slope


def _slope(form: StateForm, x: Array, d: Array, t: float, p: Array) -> tuple[Array, Array]:
    """J (m, f) of the free coordinates, each row over its length with all of them, and the places:
    a row that only imposed coordinates can meet has lost its hold."""
    q, v = form.motion(x[None], d[None])
    slope = gaps_of(form.machine, q, v, 0 * v, np.array([t]), p).slope[0]
    size = np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-300)
    return slope[:, list(form.free)] / size, q[0]


def _slack(form: StateForm, x: Array, d: Array, t: float, p: Array) -> float:
    """How far from singular the constraints are: smallest over largest singular value of J."""
    sizes = np.linalg.svd(_slope(form, x, d, t, p)[0], compute_uv=False)
    return float(sizes[-1] / sizes[0]) if sizes.size else 1.0


def _worst(form: StateForm, x: Array, d: Array, t: float, p: Array) -> str:
    """What resists, and where: ``constraints.rod cannot follow at phi = 1.57 rad``."""
    slope, q = _slope(form, x, d, t, p)
    left, _, _ = np.linalg.svd(slope)
    which = int(np.argmax(np.abs(left[:, min(slope.shape) - 1])))
    model = form.machine.model
    rows = model.assembly.rows if model.assembly else ()
    name = constraint_of(rows[which])
    places = ", ".join(
        f"{c.name} = {value / c.unit.factor:.5g} {c.unit}"
        for c, value in zip(model.coordinates, q, strict=True)
    )
    return f"constraints.{name} cannot follow at {places}"

"""Where a model with constraints closes: consistent starts, and constraints that repeat others.

Newton's method with the shortest steps (minimum norm) moves first what the file leaves open, then
everything; speeds follow from J v + ∂c/∂t = 0 in the same way. Rows of J that depend on the rows
before them, at the start and beside it, repeat them and are left out. Sizes: n coordinates, m rows.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.errors import InputError, Problem
from symhyb.model.constraints import Assembly
from symhyb.model.expression import readings
from symhyb.model.types import Energy, Model
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.lowered import cache
from symhyb.numeric.lowered.dependence import (
    DEPENDENT,
    NOTHING,
    SLIGHT,
    constraint_of,
    dependent,
    idle,
    slight,
)
from symhyb.numeric.lowered.moved import moves, places_text

CLOSED = 1e-12  # of the size of the motion: what rounding leaves open
STEPS_MOST = 60
SHARES = (1.0, 0.5, 0.25, 0.1, 0.02)  # of a Newton step
BESIDE = 0.02  # how far beside the start dependence is tried again, of the size of a coordinate
TRIES = 3


@dataclass(frozen=True, slots=True)
class _Gaps:
    """The constraints of one model: ``function`` is the closure of all rows, with ``labels``; the
    ``slight`` rows hold nothing, and what they leave open does not count."""

    model: Model
    function: ca.Function
    labels: tuple[str, ...]
    p: Array
    slight: tuple[int, ...] = ()

    def at(self, q: Array, v: Array) -> tuple[Array, Array, Array]:
        """c, ċ (m,) and J (m, n)."""
        gap, rate, slope = self.whole(q, v)
        rows = list(self.slight)
        gap[rows], rate[rows], slope[rows] = 0.0, 0.0, 0.0
        return gap, rate, slope

    def whole(self, q: Array, v: Array) -> tuple[Array, Array, Array]:
        """The same with what slight rows leave open."""
        gap, rate, _, slope, _ = call(self.function, (q, v, 0 * q, 0.0, self.p))
        return gap[0].copy(), rate[0].copy(), slope.T.copy()

    def dependent(self, q: Array, free: NDArray[np.bool_]) -> dict[int, list[int]]:
        """The rows that hold nothing at q, or only what rows before them hold, each with those."""
        return dependent(self.at(q, 0 * q)[2], free, self.labels)

    def placing(self) -> list[int]:
        """The rows that hold places; the others are nonholonomic."""
        return placing_rows(self.function)


def placing_rows(closure: ca.Function) -> list[int]:
    """The rows of a ``closure`` that hold places; the others are nonholonomic."""
    return sorted(set(closure.jac_sparsity(0, 0).get_triplet()[0]))


def constraints_key(model: Model) -> tuple[object, ...]:
    """What the functions of constraints depend on, beside names: the starts that a gear without an
    offset takes its own from, and rows that are left out."""
    bound = [
        [(c.name, c.start, c.unit.text) for c in model.coordinates if c.name in item.names]
        for item in model.constraints
        if item.kind in ("gear", "rolling") and item.value("offset") is None
    ]
    left_out = model.assembly.left_out if model.assembly else ()
    rows = [replace(item, about="") for item in model.constraints]
    return (rows, bound, left_out) if rows else ()


def assembled(model: Model) -> Model:
    """The model with its ``assembly``: itself without constraints.

    Raises:
        InputError: constraints that cannot close, that contradict each other, that hold nothing
            which is free to move, or a start in which they lock.
    """
    if not model.constraints:
        return model
    q, v = (np.array(part) for part in model.start())
    gaps = _without_slight(_gaps_of(model), q)
    before = model.assembly
    q_closed, v_closed = _closed(gaps, q, v)
    if before is not None and np.array_equal(q, q_closed) and np.array_equal(v, v_closed):
        return model
    left_out, notes = _repeated(gaps, q_closed)
    _require_shown(model, left_out)
    rows = tuple(label for label in gaps.labels if label not in left_out)
    found = Assembly(
        tuple(q_closed.tolist()),
        tuple(v_closed.tolist()),
        rows,
        left_out,
        moves(model, q_closed, v_closed),
        notes,
    )
    return replace(model, assembly=found)


def _without_slight(gaps: _Gaps, q: Array) -> _Gaps:
    """The constraints without components of vectors along which next to nothing moves, neither at q
    (n,) nor beside it."""
    vectors = [item.name for item in gaps.model.constraints if item.kind in ("pin", "slider")]
    slopes = [gaps.whole(place, 0 * q)[2] for place in (q, *_drawn(q))]
    return replace(gaps, slight=slight(slopes, gaps.labels, vectors))


def _drawn(q: Array) -> list[Array]:
    """Places (n,) beside q, on the constraints or not."""
    draws = np.random.default_rng(0).standard_normal((TRIES, q.size))
    return [q + BESIDE * (1 + np.abs(q)) * draw for draw in draws]


def _require_level(gaps: _Gaps, q: Array) -> None:
    """Where nothing moves along a component nothing may be off along it either, but for as much as
    it may move."""
    gap, _, slope = gaps.whole(q, 0 * q)
    for row in gaps.slight:
        mine = [constraint_of(one) == constraint_of(gaps.labels[row]) for one in gaps.labels]
        if abs(gap[row]) > SLIGHT * np.linalg.norm(slope[mine], axis=1).max():
            raise InputError(_beside_the_plane(gaps, row, gap))


def _beside_the_plane(gaps: _Gaps, row: int, gap: Array) -> Problem:
    text = (
        f"nothing moves along {gaps.labels[row]}, and there it is off by {abs(gap[row]):.4g} (SI); "
        "let both lie in the plane of the motion"
    )
    return Problem(text, f"constraints.{constraint_of(gaps.labels[row])}", gaps.model.file)


def _require_shown(model: Model, left_out: Sequence[str]) -> None:
    """No sensor may show the reaction of a constraint that repeats others: any share of the load
    may go through it."""
    problems = [
        Problem(
            f"constraints.{name} repeats others, so that its reaction cannot be told from theirs",
            f"sensors.{sensor.name}.measures",
            model.file,
        )
        for sensor in model.sensors
        for reading in readings(sensor.measures)
        for name in reading.names
        if reading.what == "reaction" and name in left_out
    ]
    if problems:
        raise InputError(problems)


def _gaps_of(model: Model) -> _Gaps:
    bare = replace(
        model,
        states=(),
        elements=(),
        sensors=(),
        inputs=(),
        energy=Energy(),
        gravity=None,
        assembly=None,
    )
    parts = (
        [c.name for c in bare.coordinates],
        [p.path for p in bare.parameters],
        bare.points,
        [replace(body, about="") for body in bare.bodies],
        constraints_key(bare),
        bare.characteristics(),
    )
    key = cache.key("closure", repr(parts))
    function, labels = kept(("closure", key), lambda: _from_cache(bare, key))
    p = np.array([item.si for item in bare.all_parameters()])
    return _Gaps(model, function, labels, p)


def _from_cache(bare: Model, key: str) -> tuple[ca.Function, tuple[str, ...]]:
    found = cache.load(key)
    if found is not None and len(found) == 1:
        ((name, function),) = found.items()
        return function, tuple(name.split())
    function, labels = _lowered(bare)
    cache.store(key, {" ".join(labels): function})
    return function, labels


def _lowered(bare: Model) -> tuple[ca.Function, tuple[str, ...]]:
    from symhyb.mechanics.constraints import closures  # SymPy takes half a second to import
    from symhyb.mechanics.equations import derive
    from symhyb.numeric.lowered.constrained import loops_of, lowered_closure
    from symhyb.numeric.lowered.translate import Lowered

    equations = derive(bare)
    low = Lowered(equations)
    rows = closures(bare, equations.places, equations.symbols)
    loops = loops_of(low, rows)
    assert loops is not None  # there is at least one constraint, and each has a row
    return lowered_closure(low, loops)["closure"], tuple(row.label for row in rows)


def _closed(gaps: _Gaps, q: Array, v: Array) -> tuple[Array, Array]:
    """q and v (n,) that meet the constraints, near those given."""
    model = gaps.model
    free = np.array([not c.imposed for c in model.coordinates])
    open_q = free & np.array(["start" not in c.stated for c in model.coordinates])
    open_v = free & np.array(["start_rate" not in c.stated for c in model.coordinates])
    _require_hold(gaps, q, free)
    for movable in (open_q, free):
        placed, gap = _newton(gaps, q, movable)
        if _small(gap, placed):
            break
    else:
        raise InputError(_impossible(gaps, placed, gap))
    _require_level(gaps, placed)
    for movable in (open_v, free):
        moved = v.copy()
        _, rate, slope = gaps.at(placed, v)
        moved[movable] -= np.linalg.lstsq(slope[:, movable], rate, rcond=1e-10)[0]
        rate = gaps.at(placed, moved)[1]
        if _small(rate, moved):
            return placed, v if np.allclose(moved, v, rtol=1e-14, atol=0) else moved
    raise InputError(_locked(gaps, placed, rate))


def _small(gap: Array, size: Array) -> bool:
    return bool(np.abs(gap).max(initial=0.0) <= CLOSED * (1 + np.abs(size).max(initial=0.0)))


def _newton(gaps: _Gaps, q: Array, movable: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Places (n,) moved by shortest Newton steps until c (m,) is 0 or no step makes it smaller."""
    q, still = q.copy(), np.zeros_like(q)
    gap, _, slope = gaps.at(q, still)
    rows = gaps.placing()
    for _ in range(STEPS_MOST if movable.any() else 0):
        if _small(gap, q) or not np.isfinite(slope).all():
            break
        step = np.linalg.lstsq(slope[rows][:, movable], gap[rows], rcond=1e-8)[0]
        for share in SHARES:
            trial = q.copy()
            trial[movable] -= share * step
            after = gaps.at(trial, still)
            if np.linalg.norm(after[0]) < np.linalg.norm(gap):
                break
        else:
            break
        q, (gap, _, slope) = trial, after
    return q, gap


def _repeated(gaps: _Gaps, q: Array) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Labels of the rows that repeat others, and notes on them.

    Raises:
        InputError: rows that depend on others at the start and nowhere beside it.
    """
    free = np.array([not c.imposed for c in gaps.model.coordinates])
    here = gaps.dependent(q, free)
    if not here:
        return (), ()
    always = set(here)
    for beside in _beside(gaps, q):
        always &= set(gaps.dependent(beside, free))
    lost = [row for row in here if row not in always]
    if lost:
        raise InputError(_locked(gaps, q, np.eye(len(gaps.labels))[lost[0]]))
    notes, whole = [], gaps.whole(q, 0 * q)[2]
    for row in sorted(always):
        name, others = gaps.labels[row], [gaps.labels[i] for i in here[row]]
        listed = " and ".join(dict.fromkeys(constraint_of(label) for label in others))
        if not others:
            zero = row not in gaps.slight or row in slight(
                [whole], gaps.labels, [constraint_of(name)], NOTHING
            )
            said = "zero" if zero else "nearly zero"
            notes.append(f"constraints.{name} is {said} wherever the machine moves and is left out")
        elif not _of_a_line(gaps, name, others):
            notes.append(f"constraints.{name} repeats what {listed} say already and is left out")
    return tuple(gaps.labels[row] for row in sorted(always)), tuple(notes)


def _of_a_line(gaps: _Gaps, label: str, others: Sequence[str]) -> bool:
    """Whether a row is the third of a line in space, of which two say all."""
    name = constraint_of(label)
    kind = next(item.kind for item in gaps.model.constraints if item.name == name)
    return kind == "slider" and all(constraint_of(other) == name for other in others)


def _beside(gaps: _Gaps, q: Array) -> list[Array]:
    """Places (n,) near q at which the constraints hold too, imposed coordinates moved as well."""
    slope = gaps.at(q, 0 * q)[2]
    rank = int(np.linalg.matrix_rank(slope, tol=DEPENDENT * np.linalg.norm(slope)))
    along = np.linalg.svd(slope)[2][rank:]
    draws = np.random.default_rng(0).standard_normal((TRIES, q.size))
    found = []
    for draw in draws:
        step = along.T @ (along @ draw)
        moved, gap = _newton(gaps, q + BESIDE * (1 + np.abs(q)) * step, np.ones(q.size, bool))
        if _small(gap, moved):
            found.append(moved)
    return found


def _require_hold(gaps: _Gaps, q: Array, free: NDArray[np.bool_]) -> None:
    """Every row must depend on something that is free to move; speeds linearly on rates."""
    bent = sorted({row % len(gaps.labels) for row in gaps.function.jac_sparsity(3, 1).row()})
    _refuse(
        gaps,
        [gaps.labels[row] for row in bent],
        "is not linear in the rates: a nonholonomic constraint is a sum of rates, each times a "
        "factor of places, parameters and time",
    )
    gap = gaps.at(q, 0 * q)[0]
    _refuse(
        gaps,
        idle(gaps.function, gaps.labels, free),
        "holds nothing that is free to move: it contains no coordinate, or only imposed ones",
    )
    bad = [label for label, value in zip(gaps.labels, gap, strict=True) if not np.isfinite(value)]
    if bad:
        text = (
            "is not finite at the start (a division by zero, or two points of a line or a distance "
            "that coincide); change the start"
        )
        name = constraint_of(bad[0])
        raise InputError(Problem(text, f"constraints.{name}", gaps.model.file))


def _refuse(gaps: _Gaps, labels: Sequence[str], text: str) -> None:
    """Raise, if there are any, what is wrong with the constraints of these rows, each once."""
    names = dict.fromkeys(constraint_of(label) for label in labels)
    if names:
        raise InputError([Problem(text, f"constraints.{name}", gaps.model.file) for name in names])


def _impossible(gaps: _Gaps, q: Array, gap: Array) -> Problem:
    """Why Newton's method found no place: rows that contradict each other, or that do not reach."""
    worst = int(np.argmax(np.abs(gap)))
    name = constraint_of(gaps.labels[worst])
    generic = _contradicted(gaps, q)
    related = dict.fromkeys(constraint_of(gaps.labels[i]) for i in generic.get(worst, ()))
    others = [other for other in related if other != name]
    where = places_text(gaps.model, q)
    if worst in generic and not generic[worst]:
        return _beside_the_plane(gaps, worst, gap)
    if others:
        text = (
            f"contradicts constraints.{' and '.join(others)}: where that holds, this one is off by "
            f"{np.abs(gap).max():.4g} (SI) whatever moves; leave one of them out"
        )
    else:
        text = (
            f"the loop cannot be closed: nearest to the start this is still off by "
            f"{abs(gap[worst]):.4g} (SI), at {where}; change lengths or the start"
        )
    return Problem(text, f"constraints.{name}", gaps.model.file)


def _contradicted(gaps: _Gaps, q: Array) -> dict[int, list[int]]:
    """Rows that depend on others wherever the machine is, each with all rows that it depends on,
    and those on it."""
    free = np.array([not c.imposed for c in gaps.model.coordinates])
    found: dict[int, list[int]] | None = None
    for place in _drawn(q):
        at = gaps.dependent(place, free)
        found = at if found is None else {row: at[row] for row in found if row in at}
    related = dict(found or {})
    for row, others in (found or {}).items():
        for other in others:
            related.setdefault(other, [row])
    return related


def _locked(gaps: _Gaps, q: Array, left: Array) -> Problem:
    name = constraint_of(gaps.labels[int(np.argmax(np.abs(left)))])
    text = (
        f"the loop locks at its start, {places_text(gaps.model, q)}: there this constraint and "
        "the others leave no consistent speeds; start a little beside it"
    )
    return Problem(text, f"constraints.{name}", gaps.model.file)

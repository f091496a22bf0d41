"""What listed laws would do in the place of a curve, in the same linear problem.

Their forces over the stretch alone, or over the rate alone, are columns of the same fine line, so
that sets of them and the curve are compared by one evidence.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations, permutations
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.curves.courses import Line
from symhyb.correction.adequacy.curves.points import worth_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Row
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws.maths import NUMPY, Motion
from symhyb.model.types import On
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array

TOGETHER = 3  # laws at most, that stand for a curve
BY_THEMSELVES = 8  # of the laws that are worth most, of which sets are made
OTHER = 0.5  # of what moves the place: the quantity that the curve is no function of


class Listed(NamedTuple):
    """Laws by name with values of their keys, SI, and what they are worth in ln evidence."""

    causes: tuple[Hypothesis, ...]
    rows: tuple[Row, ...]
    worth: float


class _Law(NamedTuple):
    """A candidate, its forces (G, T) over their ``largest`` (T,), SI, and what it is worth."""

    cause: Hypothesis
    columns: Array
    largest: Array
    worth: float


def listed(recorded: Recorded, line: Line) -> list[Listed]:
    """The laws that are functions of the quantity of a line alone: one, two, and three of them, the
    set of each size that is worth most, of these the one that is worth most first; of each law the
    shape that is worth most. The evidence pays for their choice among all candidates."""
    count = len({cause.family for cause in recorded.hypotheses})
    best: dict[object, _Law] = {}
    for law in _laws(recorded, line):
        key = law.cause.family
        if key not in best or law.worth > best[key].worth:
            best[key] = law
    laws = sorted(best.values(), key=lambda law: -law.worth)[:BY_THEMSELVES]
    found = []
    for size in range(1, TOGETHER + 1):
        sets = []
        for chosen in combinations(laws, size):
            if any(a.cause.extends(b.cause) for a, b in permutations(chosen, 2)):
                continue
            worth, values = worth_of(line, np.concatenate([law.columns for law in chosen], axis=1))
            rows = _rows(chosen, values)
            if rows is not None:
                causes = tuple(law.cause for law in chosen)
                sets.append(Listed(causes, rows, worth - size * float(np.log(max(count, 2)))))
        found += sorted(sets, key=lambda one: -one.worth)[:1]
    return sorted(found, key=lambda one: -one.worth)


def _laws(recorded: Recorded, line: Line) -> Iterator[_Law]:
    """The candidates at the place of a line that are functions of its quantity alone."""
    place = recorded.library.places[line.which]
    for cause in recorded.library.hypotheses:
        law = KINDS.get(cause.kind)
        if law is None or cause.place != place or cause.own:
            continue
        if law.state or law.inertial or not law.of_state:
            continue
        forces = _forces(cause, line, 0.0)
        largest = np.abs(forces).max(axis=0)
        if np.array_equal(forces, _forces(cause, line, OTHER)) and np.all(largest > 0):
            pushes = -1.0 if not law.passive and isinstance(place, On) else 1.0
            columns = pushes * forces / largest
            yield _Law(cause, columns, largest, worth_of(line, columns)[0])


def _forces(cause: Hypothesis, line: Line, other: float) -> Array:
    """The force F (G, T), SI, of each term over the quantity of a line, the ``other`` quantity
    held."""
    law, fixed, none = KINDS[cause.kind], np.full_like(line.x, other), np.zeros_like(line.x)
    s, r = (line.x, fixed) if line.over == "stretch" else (fixed, line.x)
    at, columns = Motion(s, r, none, none), []
    assert law.action is not None
    for unit in cause.units():
        values = {**dict(cause.shape), **unit}
        columns.append(none + law.action(NUMPY, at, values, dict(cause.options)).force)
    return np.stack(columns, axis=1)


def _rows(chosen: Sequence[_Law], values: Array) -> tuple[Row, ...] | None:
    """The keys, SI, of laws whose columns have these coefficients; None where physics forbids
    one."""
    rows, first = [], 0
    for law in chosen:
        own = values[first : first + law.largest.size] / law.largest
        first += law.largest.size
        if any(x < 0 for x, only in zip(own, law.cause.positive, strict=True) if only):
            return None
        row = law.cause.values(own.tolist())
        if "static" in row and not row["static"] > row["coulomb"]:
            return None  # it breaks away at less than it slides with
        rows.append(row)
    return tuple(rows)

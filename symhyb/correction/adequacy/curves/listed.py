"""What listed laws would do in the place of a curve, in the same linear problem.

Their forces, over what the curve is a factor of, are functions of the stretch alone, or of the rate
alone, and so columns of the same fine line: sets of them and the curve are compared by one
evidence.
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
ROUNDED = 1e-9  # relative
OTHER = 0.5  # m or rad: a stretch of which a law over the rate is no function
OTHERS = (1.0, -1.0, 0.3)  # of the largest: the quantity that the curve is no function of


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
    shape that is worth most. A bent law, which stands between simpler ones, is a set by
    itself; each of them is given, for the keys by which it bends are fitted afterwards.
    The evidence pays for their choice among all candidates."""
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
            if size > 1 and any(law.cause.bent for law in chosen):  # a curve by other names
                continue
            worth, values = worth_of(line, np.concatenate([law.columns for law in chosen], axis=1))
            rows = _rows(chosen, values)
            if rows is not None:
                causes = tuple(law.cause for law in chosen)
                sets.append(
                    Listed(causes, rows, float(worth) - size * float(np.log(max(count, 2))))
                )
        sets.sort(key=lambda one: -one.worth)
        found += [one for i, one in enumerate(sets) if i == 0 or one.causes[0].bent]
    return sorted(found, key=lambda one: -one.worth)


def _laws(recorded: Recorded, line: Line) -> Iterator[_Law]:
    """The candidates at the place of a line that are functions of its quantity alone."""
    place = recorded.library.places[line.which]
    for cause in recorded.library.hypotheses:
        law = KINDS.get(cause.kind)
        if law is None or cause.place != place or cause.own:
            continue
        if law.states or law.inertial or not law.of_state:
            continue
        forces, *again = (_forces(cause, line, share) for share in OTHERS)
        largest = np.abs(forces).max(axis=0)
        same = all(np.allclose(forces, one, rtol=ROUNDED, atol=0.0) for one in again)
        if same and np.all(largest > 0):
            pushes = -1.0 if not law.passive and isinstance(place, On) else 1.0
            columns = pushes * forces / largest
            yield _Law(cause, columns, largest, float(worth_of(line, columns)[0]))


def _forces(cause: Hypothesis, line: Line, share: float) -> Array:
    """The force F (G, T), SI, of each term over the quantity of a line, the other one held at this
    ``share`` of its largest, over what the curve is a factor of."""
    law, none = KINDS[cause.kind], np.zeros_like(line.x)
    over_rate = line.form.over == "rate"
    held = np.full_like(line.x, share * (OTHER if over_rate else line.rate))
    s, r = (held, line.x) if over_rate else (line.x, held)
    at, columns = Motion(s, r, (), none), []
    assert law.action is not None
    for unit in cause.units():
        values = {**dict(cause.shape), **unit}
        columns.append(none + law.action(NUMPY, at, values, dict(cause.options)).force)
    return np.stack(columns, axis=1) / line.form.factor(held)[:, None]


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

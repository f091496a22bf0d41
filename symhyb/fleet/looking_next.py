"""Which of the recordings that exist are worth looking at next, in order, each with its reason."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from symhyb.discrepancy.words.amounts import number_text
from symhyb.errors import InputError
from symhyb.fleet.fleet import Fleet, Own, fleet_of
from symhyb.fleet.means import Array
from symhyb.fleet.members import condition_of, unit_of
from symhyb.fleet.rungs import with_structure
from symhyb.fleet.words import reason_sentence
from symhyb.judgement import FEWEST
from symhyb.tasks.folder import Entry
from symhyb.tasks.outcome import FAILED, FINISHED, NOT_RUN, Outcome, Outcomes
from symhyb.tasks.rows import causes_of

Why = Literal[
    "structure", "numbers", "trend", "bound", "undecided", "other cause", "failed", "not run"
]
ORDER: tuple[Why, ...] = (
    "structure",
    "numbers",
    "trend",
    "bound",
    "undecided",
    "other cause",
    "failed",
    "not run",
)


@dataclass(frozen=True, slots=True)
class Next:
    """A task that is worth looking at, of which ``unit``, and ``why``, in a word and a sentence."""

    task: str
    unit: str
    recordings: tuple[str, ...]
    why: Why
    sentence: str


def worth_looking(
    outcomes: Outcomes,
    unit: str = "",
    conditions: Sequence[str] = (),
    among: Sequence[str] = (),
    structure: str = "",
) -> tuple[Next, ...]:
    """The tasks of a study that are worth looking at, most urgent first.

    Units whose structure is not that of the others come first, then those whose numbers deviate and
    those that end at a bound; of diagnoses those that are undecided, and those that find what most
    others do not; then what failed, and what was not run, beginning with what is farthest from all
    that is finished: of a unit without any, then by its conditions.

    Raises:
        InputError: as :func:`symhyb.fleet.fleet.fleet_of`.
    """
    _, name, outcomes = with_structure(outcomes, structure)
    done = [one for one in outcomes.tasks if one.state == FINISHED]
    found = list(_left(outcomes.tasks, done, unit, conditions))
    if done and all(one.fitted is not None for one in done):
        try:
            fleet = fleet_of(outcomes, unit, conditions, among, name)
        except InputError:
            if len({unit_of(one.entry, unit) for one in done}) >= FEWEST:
                raise
        else:
            found += _of_units(fleet, {one.entry.name: one for one in done})
    else:
        found += _of_diagnoses(done, unit)
    return tuple(sorted(found, key=lambda one: ORDER.index(one.why)))


def _of_units(fleet: Fleet, tasks: dict[str, Outcome]) -> Iterator[Next]:
    """Units that are named, each by the recording that shows it best."""
    for one in fleet.deviating:
        if one.reason is None:
            continue
        task = _telling(one, tasks)
        yield _next(task.entry, one.name, one.reason.kind, reason_sentence(one.reason))
    for one in fleet.units:
        if one.bounds and one.reason is None:
            text = f"{', '.join(one.bounds)} ends at the bound of what is possible"
            yield _next(_telling(one, tasks).entry, one.name, "bound", text)


def _telling(one: Own, tasks: dict[str, Outcome]) -> Outcome:
    """Of the tasks of a unit the one that leaves most beyond noise where that is why it is named,
    else the one with the most information on the number that deviates."""
    every = [tasks[name] for name in one.tasks]
    reason = one.reason

    def worth(task: Outcome) -> float:
        fit = task.fitted
        if fit is None:
            return 0.0
        if reason is not None and reason.kind == "structure":
            return fit.samples / max(fit.correlation_time, 1.0) * (fit.after - 1.0)
        names = reason.names if reason is not None else one.bounds
        places = [fit.names.index(name) for name in names]
        return float(np.min(1 / fit.sd[places] ** 2, initial=np.inf))

    return max(every, key=worth)


def _of_diagnoses(done: Sequence[Outcome], unit: str) -> Iterator[Next]:
    """Undecided diagnoses, and those that find what most others do not."""
    sets = Counter(tuple(causes_of(one)) for one in done if one.verdict != "undecided")
    usual = sets.most_common(1)[0][0] if sets else ()
    for one in done:
        name = unit_of(one.entry, unit)
        if one.verdict == "undecided":
            likely = max(one.classes.items(), key=lambda item: item[1], default=None)
            best = "" if likely is None else f"; likeliest is {likely[0]}, {number_text(likely[1])}"
            yield _next(one.entry, name, "undecided", f"its diagnosis is undecided{best}")
            continue
        mine = tuple(causes_of(one))
        if mine != usual and 2 * sets[mine] < sum(sets.values()):
            count, total = sets[mine], sum(sets.values())
            text = f"finds {', '.join(mine) or 'nothing'}, as {count} of {total} do; most find"
            text += f" {', '.join(usual) or 'nothing'}"
            yield _next(one.entry, name, "other cause", text)


def _left(
    tasks: Sequence[Outcome], done: Sequence[Outcome], unit: str, conditions: Sequence[str]
) -> Iterator[Next]:
    """What failed, and what was not run."""
    for one in tasks:
        if one.state == FAILED:
            text = f"failed: {one.failure}"
            yield _next(one.entry, unit_of(one.entry, unit), "failed", text)
    waiting = [one.entry for one in tasks if one.state == NOT_RUN]
    known = {unit_of(one.entry, unit) for one in done}
    new = [one for one in waiting if unit and unit_of(one, unit) not in known]
    for entry in new:
        yield _next(entry, unit_of(entry, unit), "not run", "not run; nothing of its unit is")
    rest = [one for one in waiting if one not in new]
    places = {one.name: _conditions(one, conditions) for one in waiting}
    seen = [_conditions(one.entry, conditions) for one in done]
    seen += [places[one.name] for one in new]
    for entry, text in _farthest(rest, places, seen, conditions):
        yield _next(entry, unit_of(entry, unit), "not run", text)


def _conditions(entry: Entry, conditions: Sequence[str]) -> Array:
    return np.array([condition_of(entry, name) for name in conditions], dtype=np.float64)


def _farthest(
    waiting: Sequence[Entry],
    places: dict[str, Array],
    seen: list[Array],
    conditions: Sequence[str],
) -> Iterator[tuple[Entry, str]]:
    """Tasks in an order in which each is farthest from all before it and all that are finished, in
    ranges of the conditions (Kennard & Stone, Technometrics 11, 1969)."""
    if not conditions:
        yield from ((entry, "not run") for entry in waiting)
        return
    every = np.array([*seen, *places.values()])
    width = np.ptp(every, axis=0)
    width = np.where(width > 0, width, 1.0)
    left = list(waiting)
    before = [one / width for one in seen]
    far = {
        one.name: min((_distance(places[one.name] / width, x) for x in before), default=np.inf)
        for one in left
    }
    while left:
        entry = max(left, key=lambda one: far[one.name])
        left.remove(entry)
        stated = ", ".join(
            f"{name} {number_text(float(x))}"
            for name, x in zip(conditions, places[entry.name], strict=True)
        )
        how = number_text(100 * far[entry.name], digits=2)
        yield entry, f"not run; at {stated}, {how} % of the range away from all before it"
        here = places[entry.name] / width
        for one in left:
            far[one.name] = min(far[one.name], _distance(places[one.name] / width, here))


def _distance(first: Array, second: Array) -> float:
    return float(np.max(np.abs(first - second)))


def _next(entry: Entry, unit: str, why: Why, sentence: str) -> Next:
    return Next(entry.name, unit, tuple(one.name for one in entry.recordings), why, sentence)

"""The units of a fleet with their estimates, from the outcomes of tasks that fit.

Sizes: R recordings (tasks) of a unit, K numbers, C conditions with the constant one.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.fleet.means import Array
from symhyb.judgement import FEWEST
from symhyb.tasks.fitting import Fitted
from symhyb.tasks.folder import Entry
from symhyb.tasks.outcome import FINISHED, Outcome, Outcomes

WIDE = 1e3  # times the spread of all values: the deviation of a number that was not determined


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """One unit: its ``tasks`` by name, the fits they left, and the ``conditions`` (R, C − 1) under
    which they were recorded, in the units of the study; ``peers`` (R, G) say of which of G groups
    of peers each recording is, by 1 in its column, and ``effects`` (T,) which values of the
    groupings that make them its first one has, by 1 for all values but one of each grouping."""

    name: str
    tasks: tuple[str, ...]
    fits: tuple[Fitted, ...]
    conditions: Array
    peers: Array = field(default_factory=lambda: np.ones((1, 1)))
    effects: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def left(self) -> float:
        """χ² per sample that the fits leave, all samples together."""
        weights = [max(one.samples, 1) for one in self.fits]
        return float(np.average([one.after for one in self.fits], weights=weights))

    @property
    def freedom(self) -> float:
        """How many independent samples that is from."""
        return sum(one.samples / max(one.correlation_time, 1.0) for one in self.fits)

    @property
    def bounds(self) -> tuple[str, ...]:
        """Numbers that end at a bound of what is possible."""
        return tuple(dict.fromkeys(name for one in self.fits for name in one.bounds))


def members_of(
    outcomes: Outcomes, unit: str = "", conditions: Sequence[str] = (), among: Sequence[str] = ()
) -> tuple[Member, ...]:
    """The units of a study whose tasks fit: those of one value of the grouping ``unit``, else every
    task is one; tasks that are not finished are left out. Peers are recordings that have the same
    values of all groupings ``among``.

    Raises:
        InputError: tasks that diagnose, that vary more than the recordings, or that fitted other
            numbers; groupings or conditions that recordings do not state, or that are no numbers;
            too few units among which one is to be compared.
    """
    done = [one for one in outcomes.tasks if one.state == FINISHED]
    problems = [*_no_fits(done), *_varied(outcomes.tasks), *_unlike(done)]
    if problems:
        raise InputError(problems)
    chosen: dict[str, list[tuple[Outcome, list[float], tuple[str, ...]]]] = {}
    for one in done:
        try:
            name = unit_of(one.entry, unit)
            stated = [condition_of(one.entry, key) for key in conditions]
            group = tuple(unit_of(one.entry, by, "--among") for by in among)
        except InputError as error:
            problems.extend(error.problems)
        else:
            chosen.setdefault(name, []).append((one, stated, group))
    problems = problems or list(_alone(chosen))
    if problems:
        raise InputError(_in_short(problems))
    groups = list(dict.fromkeys(group for rows in chosen.values() for _, _, group in rows))
    values = [sorted({group[k] for group in groups})[1:] for k in range(len(among))]
    every = [(k, value) for k, some in enumerate(values) for value in some]
    column = dict(zip(groups, np.eye(len(groups)), strict=True))
    return tuple(
        Member(
            name,
            tuple(one.entry.name for one, _, _ in rows),
            tuple(one.fitted for one, _, _ in rows if one.fitted is not None),
            np.array([stated for _, stated, _ in rows], dtype=np.float64).reshape(len(rows), -1),
            np.array([column[group] for _, _, group in rows]),
            np.array([rows[0][2][k] == value for k, value in every], dtype=np.float64),
        )
        for name, rows in chosen.items()
    )


def _alone(
    chosen: Mapping[str, Sequence[tuple[Outcome, list[float], tuple[str, ...]]]],
) -> Iterable[Problem]:
    """Groups of too few units to compare one of them with the others."""
    having = Counter(group for rows in chosen.values() for group in {group for _, _, group in rows})
    for group, count in having.items():
        if group and count < FEWEST:
            least = f"one is compared with {FEWEST - 1} or more"
            text = f"has {count} units with '{', '.join(group)}'; {least}"
            yield Problem(text, "--among")


def unit_of(entry: Entry, unit: str, option: str = "--unit") -> str:
    """The unit that a task is of: by a grouping of its recordings, else what the sweep chose.

    Raises:
        InputError: its recordings do not state that grouping, or are of several units.
    """
    if not unit:
        return dict(entry.settings).get("recordings", entry.name)
    stated = [dict(one.groups).get(unit) for one in entry.recordings]
    names = dict.fromkeys(name for name in stated if name is not None)
    if len(names) == 1 and None not in stated:
        return next(iter(names))
    known = list(dict.fromkeys(by for one in entry.recordings for by, _ in one.groups))
    if names:
        what = "units" if option == "--unit" else "groups"
        text = f"the task '{entry.name}' has recordings of {len(names)} {what} or of none"
    else:
        text = f"the recordings of '{entry.name}' do not state it{did_you_mean(unit, known)}"
    raise InputError(Problem(text, f"{option} {unit}"))


def condition_of(entry: Entry, name: str) -> float:
    """The mean of a grouping with numbers, or of a known parameter, over the recordings of a task.

    Raises:
        InputError: a recording does not state it, or it is no number.
    """
    values = []
    for one in entry.recordings:
        stated: dict[str, str | float] = {**dict(one.groups), **dict(one.parameters)}
        if name not in stated:
            known = did_you_mean(name, list(stated))
            text = f"'{one.name}' states no group and no known parameter of that name{known}"
            raise InputError(Problem(text, f"condition {name}"))
        values.append(_number(stated[name], one.name, name))
    if not values:
        text = "the folder was left by a version that names no recordings; run the study again"
        raise InputError(Problem(text, f"condition {name}"))
    return float(np.mean(values))


def _number(value: str | float, recording: str, name: str) -> float:
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        text = f"must be a number, but '{recording}' states '{value}'"
        raise InputError(Problem(text, f"condition {name}"))
    return number


def _in_short(problems: Sequence[Problem]) -> Iterable[Problem]:
    """The first problem of each option, with how many more tasks have it."""
    places = dict.fromkeys(one.place for one in problems)
    for place in places:
        first, *rest = [one for one in problems if one.place == place]
        more = f" (and {len(rest)} more)" if rest else ""
        yield replace(first, text=first.text + more)


def _no_fits(done: Sequence[Outcome]) -> Iterable[Problem]:
    if not done:
        yield Problem("no task is finished; run the study first: symhyb run STUDY -o DIR")
    elif any(one.fitted is None for one in done):
        yield Problem(
            "its tasks are diagnoses, whose structures may differ from unit to unit; state in the"
            ' study which numbers of one structure are to be fitted, as fit = ["k", "d"]'
        )


def _varied(tasks: Sequence[Outcome]) -> Iterable[Problem]:
    axes = dict.fromkeys(axis for one in tasks for axis, _ in one.entry.settings)
    more = [axis for axis in axes if axis != "recordings"]
    if more:
        text = f"its sweep varies {', '.join(more)} too; units are compared on recordings alone"
        yield Problem(text, "sweep")


def _unlike(done: Sequence[Outcome]) -> Iterable[Problem]:
    named = {(one.fitted.names, one.fitted.units) for one in done if one.fitted is not None}
    if len(named) > 1:
        yield Problem("its tasks fitted different numbers; run the study again in a new folder")


def widths_of(members: Sequence[Member]) -> Array:
    """What takes the place of an infinite deviation of each number (K,), in its unit."""
    values = np.array([one.values for member in members for one in member.fits])
    sd = np.array([one.sd for member in members for one in member.fits])
    sd = np.where(np.isfinite(sd), sd, 0.0)
    spread = np.maximum(values.std(axis=0), 1e-3 * np.abs(values).max(axis=0))
    spread = np.maximum(spread, np.median(sd, axis=0))
    return np.asarray(WIDE * np.maximum(spread, 1e-300))

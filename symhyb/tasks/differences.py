"""What two runs of a study say differently, task by task."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from symhyb.tasks.outcome import FINISHED, Number, Outcome, Outcomes
from symhyb.tasks.rows import causes_of


@dataclass(frozen=True, slots=True)
class Moved:
    """A number that two tasks found: ``deviations`` is the difference over the root of the sum of
    both variances; None where neither has one."""

    name: str
    first: Number
    second: Number
    deviations: float | None


@dataclass(frozen=True, slots=True)
class Difference:
    """What differs in one task: ``states`` if one of both did not finish, else ``verdicts`` where
    they differ; causes that are ``only_first`` or ``only_second``; numbers that ``moved``."""

    task: str
    states: tuple[str, str] | None = None
    verdicts: tuple[str, str] | None = None
    only_first: tuple[str, ...] = ()
    only_second: tuple[str, ...] = ()
    moved: tuple[Moved, ...] = ()


@dataclass(frozen=True, slots=True)
class Differences:
    """What two studies say differently: tasks that only one has, and those of both that differ out
    of ``common``."""

    only_first: tuple[str, ...]
    only_second: tuple[str, ...]
    common: int
    tasks: tuple[Difference, ...]

    @property
    def same(self) -> bool:
        """Whether both have the same tasks with the same outcomes."""
        return not (self.only_first or self.only_second or self.tasks)


def differences_of(first: Outcomes, second: Outcomes) -> Differences:
    """Compare tasks by their names."""
    left = {one.entry.name: one for one in first.tasks}
    right = {one.entry.name: one for one in second.tasks}
    both = [name for name in left if name in right]
    found = (_difference(name, left[name], right[name]) for name in both)
    return Differences(
        tuple(name for name in left if name not in right),
        tuple(name for name in right if name not in left),
        len(both),
        tuple(one for one in found if one is not None),
    )


def _difference(name: str, first: Outcome, second: Outcome) -> Difference | None:
    if FINISHED not in (first.state, second.state):
        alike = (first.state, first.failure) == (second.state, second.failure)
        return None if alike else Difference(name, states=(_said(first), _said(second)))
    if first.state != second.state:
        return Difference(name, states=(_said(first), _said(second)))
    left, right = causes_of(first), causes_of(second)
    one = Difference(
        name,
        verdicts=None if first.verdict == second.verdict else (first.verdict, second.verdict),
        only_first=tuple(cause for cause in left if cause not in right),
        only_second=tuple(cause for cause in right if cause not in left),
        moved=tuple(_moved(first.found, second.found)),
    )
    return one if one.verdicts or one.only_first or one.only_second or one.moved else None


def _moved(first: Mapping[str, Number], second: Mapping[str, Number]) -> Iterator[Moved]:
    """Numbers that both found with other values, in the same unit."""
    for name, one in first.items():
        other = second.get(name)
        if other is None or (one.value, one.unit) == (other.value, other.unit):
            continue
        spread = math.hypot(one.sd or 0.0, other.sd or 0.0)
        known = one.unit == other.unit and spread > 0
        yield Moved(name, one, other, abs(other.value - one.value) / spread if known else None)


def _said(outcome: Outcome) -> str:
    return f"{outcome.state}: {outcome.failure}" if outcome.failure else outcome.state

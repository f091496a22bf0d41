"""A time after which a diagnosis ends: stated once, and asked wherever long work has a place to
stop.

Work gets a deadline as it gets an interruption: not as an argument, and at places of its own. Where
it has passed they raise :class:`OutOfTimeError`; who called knows what was compared by then.
"""

import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from symhyb.errors import InputError, Problem

UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0}
FORM = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(s|min|h)\s*")
WANTED = "a time above 0 with its unit, s, min or h, as '10min'"
SPENT = "the time that was allowed was spent"


class OutOfTimeError(Exception):
    """The deadline has passed."""


@dataclass(frozen=True, slots=True)
class Deadline:
    """That a ``budget`` in s is spent when the ``clock``, in s, is that much beyond ``begun``."""

    budget_s: float
    begun: float
    clock: Callable[[], float]

    @property
    def passed(self) -> bool:
        """Whether the budget is spent."""
        return self.clock() - self.begun >= self.budget_s


_stated: ContextVar[Deadline | None] = ContextVar("deadline", default=None)


def deadline_of(
    budget: float | str | None, clock: Callable[[], float] = time.monotonic
) -> Deadline | None:
    """The deadline of a ``budget``, a number of s or a text with its unit, that begins now; None of
    None.

    Raises:
        InputError: it is no time above 0.
    """
    return None if budget is None else Deadline(required_seconds(budget), clock(), clock)


def required_seconds(budget: float | str) -> float:
    """A budget in s.

    Raises:
        InputError: it is no time above 0.
    """
    seconds = seconds_of(budget)
    if seconds is None:
        raise InputError(Problem(f"must be {WANTED}, not {budget!r}", "budget"))
    return seconds


def seconds_of(budget: float | str) -> float | None:
    """A time in s, of a number of s or a text with its unit (``10min``); None of what is no time
    above 0."""
    if isinstance(budget, str):
        form = FORM.fullmatch(budget)
        seconds = float(form[1]) * UNITS[form[2]] if form else 0.0
    else:
        seconds = float(budget)
    return seconds if 0.0 < seconds < float("inf") else None


def budget_text(seconds: float) -> str:
    """A time in words, in the largest unit of which it is at least one."""
    unit = max((u for u in UNITS if UNITS[u] <= seconds), key=UNITS.__getitem__, default="s")
    return f"{seconds / UNITS[unit]:.3g} {unit}"


@contextmanager
def within(deadline: Deadline | None) -> Iterator[None]:
    """Let work end at the deadline; with None, let it take the time that it takes."""
    token = _stated.set(deadline)
    try:
        yield
    finally:
        _stated.reset(token)


def require_time() -> None:
    """Go on, if there is time.

    Raises:
        OutOfTimeError: the deadline that was stated has passed.
    """
    stated = _stated.get()
    if stated is not None and stated.passed:
        raise OutOfTimeError(SPENT)

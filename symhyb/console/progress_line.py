"""The line of a terminal that says what is being done, for how long, and how much time is left."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from symhyb.errors import visible
from symhyb.steps import Counted

if TYPE_CHECKING:
    from rich.live import Live

A_SECOND = 4  # times that the line is drawn
EVERY_S = 60.0  # a line of a log, at most
TURNING = "⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏"  # one at a time: something happens


@dataclass(frozen=True, slots=True)
class Shown:
    """A ``step`` that was ``said`` then, in seconds of a clock; the first piece of a counted one
    was at ``since``."""

    step: str
    said: float
    since: float

    def then(self, step: str, now: float) -> "Shown":
        """The next step, said ``now``. The next piece of a counted one began with its first."""
        last, clean = self.step, visible(" ".join(step.split()))
        if not isinstance(step, Counted):
            return Shown(clean, now, now)
        pieces = Counted(clean, step.done, step.total)
        goes_on = isinstance(last, Counted) and last.total == step.total and last.done <= step.done
        return Shown(pieces, now, self.since if goes_on and step.done else now)

    def words(self, seconds: float, now: float) -> str:
        """What is shown ``now``, ``seconds`` after the beginning: times first, for the end of a
        long line is cut off."""
        times = clock(seconds)
        if isinstance(self.step, Counted) and self.step.total > 1:
            times += f", {self.step.done + 1} of {self.step.total}"
            if self.step.done:
                each = (self.said - self.since) / self.step.done
                times += left((self.step.total - self.step.done) * each - (now - self.said))
        return f"{times}  {self.step}"


def clock(seconds: float) -> str:
    """A time as minutes and seconds, with hours where there are any."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


def left(seconds: float) -> str:
    """The time that is left, as roughly as it is known; nothing below five seconds."""
    if seconds < 5:
        return ""
    if seconds < 90:
        return f", about {5 * round(seconds / 5)} s left"
    return f", about {round(seconds / 60)} min left"


@dataclass(slots=True)
class ProgressLine:
    """What :class:`rich.live.Live` draws again and again: one line, cut to the terminal's width."""

    now: Callable[[], float] = time.monotonic
    begun: float = 0.0
    shown: Shown = Shown("", 0.0, 0.0)

    def __post_init__(self) -> None:
        self.begun = self.now()
        self.shown = Shown("starting", self.begun, self.begun)

    def say(self, step: str) -> None:
        """Show a step from now on."""
        self.shown = self.shown.then(step, self.now())

    def __rich__(self) -> Text:
        now = self.now()
        sign = TURNING[int(A_SECOND * now) % len(TURNING)]
        words = self.shown.words(now - self.begun, now)
        return Text(f"{sign} {words}", no_wrap=True, overflow="ellipsis", end="")


@dataclass(slots=True)
class ProgressLog:
    """The same where there is no terminal, as in the log of a job: ``write`` gets a line with the
    step that begins, at most one a minute, and none in the first."""

    write: Callable[[str], None]
    line: ProgressLine
    last: float = 0.0  # line, in seconds of the clock

    def __post_init__(self) -> None:
        self.last = self.line.begun

    def say(self, step: str) -> None:
        """Take the next step."""
        self.line.say(step)
        now = self.line.now()
        if now - self.last >= EVERY_S:
            self.last = now
            self.write(self.line.shown.words(now - self.line.begun, now))


def live(console: Console, line: ProgressLine) -> "Live":
    """The line on the terminal until this is left, when it vanishes."""
    from rich.live import Live  # where there is no terminal nobody needs it

    return Live(line, console=console, refresh_per_second=A_SECOND, transient=True)

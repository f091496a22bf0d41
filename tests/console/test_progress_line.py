"""Progress is one line of the terminal, however narrow it is, and tells the time that is left."""

import io
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from rich.cells import cell_len
from rich.console import Console

from symhyb.console.progress_line import ProgressLine, ProgressLog, Shown, clock, left
from symhyb.console.terminal import progress
from symhyb.steps import Counted, counted, silent

LONG = "trying drag quadratic in speed on q + dry (Coulomb) friction on q + a harmonic force " * 3
CONTROL = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")


BEGUN = Shown("", 0.0, 0.0)


class Clock:
    """A clock that is set by hand, s."""

    def __init__(self) -> None:
        self.seconds = 100.0

    def __call__(self) -> float:
        return self.seconds


def drawn(line: ProgressLine, width: int) -> list[str]:
    """The line as a terminal of a width shows it, by rows."""
    console = Console(file=io.StringIO(), force_terminal=True, width=width, color_system=None)
    return "".join(part.text for part in console.render(line)).splitlines()


@pytest.mark.parametrize("width", [20, 60, 200])
@pytest.mark.parametrize("step", [LONG, "short", "温度 " * 80, "with\na new line and [bold]markup"])
def test_the_line_is_cut_to_the_terminal(width: int, step: str) -> None:
    line = ProgressLine(Clock())
    line.say(step)
    (row,) = drawn(line, width)
    assert cell_len(row) <= width
    whole = f"0:00  {' '.join(step.split())}"
    if cell_len(whole) + 2 > width:
        assert row.rstrip().endswith("…")
    else:
        assert row.endswith(whole)


def test_a_log_gets_a_line_a_minute() -> None:
    now, written = Clock(), []
    log = ProgressLog(written.append, ProgressLine(now))
    for done in range(10):
        log.say(Counted("fitting", done, 10))
        now.seconds += 25
    assert written == [
        "1:15, 4 of 10, about 3 min left  fitting",
        "2:30, 7 of 10, about 2 min left  fitting",
        "3:45, 10 of 10, about 25 s left  fitting",
    ]


def test_a_counted_step_tells_the_time_that_is_left() -> None:
    now, said = Clock(), []
    line = ProgressLine(now)

    def say(step: str) -> None:
        line.say(step)
        said.append(drawn(line, 120)[0][2:])

    say("reading")
    for _ in counted(say, "holding it against whole recordings", range(4)):
        now.seconds += 20.0
    say("writing the report")
    assert said == [
        "0:00  reading",
        "0:00, 1 of 4  holding it against whole recordings",
        "0:20, 2 of 4, about 60 s left  holding it against whole recordings",
        "0:40, 3 of 4, about 40 s left  holding it against whole recordings",
        "1:00, 4 of 4, about 20 s left  holding it against whole recordings",
        "1:20  writing the report",
    ]


def test_the_time_that_is_left_falls_while_a_piece_lasts() -> None:
    shown = BEGUN.then(Counted("a", 0, 3), 10.0).then(Counted("a", 1, 3), 40.0)
    assert "about 60 s left" in shown.words(40.0, 40.0)
    assert "about 50 s left" in shown.words(50.0, 50.0)
    assert "left" not in shown.words(120.0, 120.0)


def test_a_step_of_one_piece_is_not_counted() -> None:
    assert BEGUN.then(Counted("a", 0, 1), 0.0).words(3.0, 3.0) == "0:03  a"


def test_letters_that_a_terminal_obeys_stand_by_their_numbers() -> None:
    line = ProgressLine(Clock())
    line.say("comparing \x1b[31mred.csv")
    assert drawn(line, 80)[0].endswith("comparing \\u001b[31mred.csv")


def test_a_count_that_begins_anew_forgets_the_last() -> None:
    shown = BEGUN.then(Counted("a", 2, 3), 10.0).then(Counted("b", 0, 3), 50.0)
    assert "about 20 s left" in shown.then(Counted("b", 1, 3), 60.0).words(60.0, 60.0)


@pytest.mark.parametrize(
    ("seconds", "words"), [(0, "0:00"), (59.9, "0:59"), (61, "1:01"), (3725, "1:02:05")]
)
def test_elapsed_time(seconds: float, words: str) -> None:
    assert clock(seconds) == words


def test_time_that_is_left_is_as_rough_as_it_is_known() -> None:
    assert [left(s) for s in (2.0, 7.0, 42.0, 130.0)] == [
        "",
        ", about 5 s left",
        ", about 40 s left",
        ", about 2 min left",
    ]


def test_a_counted_step_is_the_line_that_it_says() -> None:
    said: list[str] = []
    assert list(counted(said.append, "weighing", ["a", "b"])) == ["a", "b"]
    assert said == ["weighing", "weighing"]
    assert silent("anything") is None  # type: ignore[func-returns-value]


def test_nothing_is_written_where_there_is_no_terminal() -> None:
    console = Console(file=io.StringIO(), force_terminal=False, width=60)
    with progress(console) as say:
        say(LONG)
    assert console.file.getvalue() == ""  # type: ignore[attr-defined]


@pytest.mark.parametrize("width", [60, 200])
def test_steps_write_over_each_other(width: int) -> None:
    file = io.StringIO()
    console = Console(file=file, force_terminal=True, width=width, color_system=None)
    with progress(console) as say:
        for step in range(3):
            say(f"{step} {LONG}")
            time.sleep(0.3)
    said = file.getvalue()
    assert said.count("\n") <= 1  # one, to leave the line
    frames = [CONTROL.sub("", part) for part in re.split(r"[\r\n]", said)]
    assert {frame[2:].split("  ")[-1][0] for frame in frames if "trying" in frame} == set("012")
    assert all(cell_len(frame) <= width for frame in frames)


@pytest.mark.skipif(sys.platform == "win32", reason="no pseudo-terminal there")
@pytest.mark.parametrize("width", [60, 200])
def test_a_verb_on_a_terminal_is_one_line_until_it_is_interrupted(
    width: int, tmp_path: Path
) -> None:
    import fcntl
    import pty
    import struct
    import termios

    script = tmp_path / "work.py"
    script.write_text(
        "import signal, time\n"
        "from symhyb.console.terminal import progress\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may ignore it\n"
        "with progress() as say:\n"
        f"    say({LONG!r})\n"
        "    time.sleep(60)\n"
    )
    terminal, inner = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, width, 0, 0))
    child = subprocess.Popen(  # not a fork, which would ask for this worker's memory twice
        [sys.executable, str(script)],
        stdin=inner,
        stdout=inner,
        stderr=inner,
        env={**os.environ, "TERM": "xterm", "COLUMNS": str(width)},
        start_new_session=True,
    )
    os.close(inner)
    said, sent = "", False
    while True:
        try:
            piece = os.read(terminal, 4096).decode("utf-8", "replace")
        except OSError:  # it has ended
            break
        if not piece:
            break
        said += piece
        if not sent and said.count("0:01") > 1:
            child.send_signal(signal.SIGINT)
            sent = True
    child.wait()
    os.close(terminal)
    before, _, after = said.partition("note: interrupted at this step: ")
    assert after.startswith(LONG[:60])
    rows = [CONTROL.sub("", row) for row in before.split("\n")]
    assert sum("trying" in row for row in rows) == 1  # all of it in one row
    assert all(cell_len(frame) <= width for row in rows for frame in row.split("\r"))

"""A source that the monitor in C watches."""

import resource
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from symhyb.export.monitor.files import monitor_files
from symhyb.model.types import Model
from symhyb.monitoring.begun import begun
from symhyb.monitoring.feed import Feed

FALSE_ALARMS = 1.0  # a day


@dataclass(frozen=True, slots=True)
class Played:
    """What the monitor printed, line by line, whether it saw a change, and the seconds of processor
    that its process took for all rows."""

    lines: list[str]
    changed: bool
    spent_s: float


def played_in_c(model: Model, rows: Sequence[str], first: int, name: str) -> Played:
    """Let the monitor that begins with the first rows of a source (below its header) watch the
    others.

    Raises:
        RuntimeError: it did not end as a monitor does.
    """
    feed = Feed(model, None, f"{name}.csv")
    for row in rows[: 1 + first]:
        feed.take(row)
    found = begun(model, feed.piece(first), FALSE_ALARMS, f"{name}.csv")
    with TemporaryDirectory() as folder:
        for file, text in monitor_files(found, name, f"{name}.csv", FALSE_ALARMS).items():
            (Path(folder) / file).write_text(text, encoding="utf-8")
        command = ["cc", "-std=c99", "-O2", f"{name}.c", f"{name}_main.c", "-lm", "-o", name]
        subprocess.run(command, cwd=folder, check=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        given = "\n".join(rows[1 + first :])
        done = subprocess.run(
            [f"{folder}/{name}"], input=given, text=True, check=False, capture_output=True
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"the monitor ended with {done.returncode}: {done.stderr}")
    spent = after.ru_utime - before.ru_utime
    return Played(done.stdout.splitlines(), bool(done.returncode), spent)

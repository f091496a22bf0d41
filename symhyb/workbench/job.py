"""A diagnosis in a process of its own: what it is asked, how far it is, and its end.

The process gets its request as JSON on its standard input and says its steps, and how it ended, as
lines of JSON on its standard output (`symhyb.workbench.diagnosing`).
"""

import json
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from symhyb.console.progress_line import Shown, clock
from symhyb.steps import Counted

STEPS_KEPT = 200
PATIENCE = 5.0  # s that a process gets to end after it was asked to


@dataclass(frozen=True, slots=True)
class Request:
    """A diagnosis of recordings with a model, whose files go into the folder ``output``."""

    model: Path
    train: tuple[Path, ...]
    holdout: tuple[Path, ...]
    columns: tuple[tuple[str, str], ...]
    output: Path

    def text(self) -> str:
        """The request as JSON."""
        return json.dumps(
            {
                "model": str(self.model),
                "train": [str(one) for one in self.train],
                "holdout": [str(one) for one in self.holdout],
                "columns": dict(self.columns),
                "output": str(self.output),
            }
        )


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a diagnosis is at ``seconds``: the ``words`` on the step that runs, the ``steps``
    before it with their times, and how it ended: ``running``, ``done``, ``stopped`` or ``failed``
    with ``problems``."""

    output: Path
    state: str = "running"
    words: str = "0:00  starting"
    steps: tuple[str, ...] = ()
    problems: tuple[str, ...] = ()


def with_message(progress: Progress, message: dict[str, Any]) -> Progress:
    """The progress after a message of the process that is no step."""
    if "problems" in message:
        problems = tuple(str(one) for one in message["problems"])
        return replace(progress, state="failed", problems=problems)
    if message.get("done"):
        return replace(progress, state="done")
    return progress


class Job:
    """A diagnosis that runs, in a process of its own."""

    def __init__(self, request: Request, now: Callable[[], float] = time.monotonic) -> None:
        self.request = request
        self._now, self._begun = now, now()
        self._shown = Shown("starting", self._begun, self._begun)
        self._progress = Progress(request.output)
        self._lock = threading.Lock()
        self._process = subprocess.Popen(
            [sys.executable, "-m", "symhyb.workbench.diagnosing"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
        )
        self._listener = threading.Thread(target=self._listen, daemon=True, name="diagnosis")
        self._listener.start()

    def progress(self) -> Progress:
        """How far it is now."""
        with self._lock:
            if self._progress.state != "running":
                return self._progress
            now = self._now()
            return replace(self._progress, words=self._shown.words(now - self._begun, now))

    def stop(self) -> None:
        """End the process; what it has not written is not written."""
        with self._lock:
            if self._progress.state == "running":
                self._progress = replace(self._progress, state="stopped")
        self._process.terminate()
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._listener.join(PATIENCE)

    def _listen(self) -> None:
        asked, said = self._process.stdin, self._process.stdout
        assert asked is not None
        assert said is not None
        with suppress(OSError, ValueError), said:  # the process may end in the middle of a line
            with asked:
                asked.write(self.request.text())
            for line in said:
                self._hear(json.loads(line))
        self._process.wait()
        with self._lock:
            if self._progress.state == "running":
                text = "the process of the diagnosis ended without an answer"
                self._progress = replace(self._progress, state="failed", problems=(text,))

    def _hear(self, message: dict[str, Any]) -> None:
        with self._lock:
            if self._progress.state != "running":
                return
            if "step" not in message:
                self._progress = with_message(self._progress, message)
                return
            now, text = self._now(), str(message["step"])
            pieces = message.get("pieces")
            step = text if pieces is None else Counted(text, int(pieces[0]), int(pieces[1]))
            self._shown = self._shown.then(step, now)
            if not self._progress.steps or not self._progress.steps[-1].endswith(f"  {text}"):
                line = f"{clock(now - self._begun)}  {text}"
                steps = (*self._progress.steps, line)[-STEPS_KEPT:]
                self._progress = replace(self._progress, steps=steps)

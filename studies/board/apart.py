"""A command of somebody else in a process of its own: no shell, limits, nothing left running."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

LAUNCH = Path(__file__).resolve().with_name("launch.py")
FILE_MOST = 64 * 2**20  # bytes of a file that a command may write
TAIL = 500  # characters of its last words that are kept
PASSED = (  # of our environment; all else, keys of a workplace too, stays here
    "PATH",
    "LANG",
    "LC_ALL",
    "SYSTEMROOT",
    "OPENBLAS_CORETYPE",
    "OPENBLAS_L2_SIZE",
)


@dataclass(frozen=True, slots=True)
class Ended:
    """How a command ended: its exit ``status`` (None: it was stopped), ``seconds`` on the clock,
    ``cpu`` seconds of it and of its ended children, its last words on standard error, and whether
    what is sealed was ``hidden`` from it."""

    status: int | None
    seconds: float
    cpu: float
    words: str
    hidden: bool


def run(
    command: Sequence[str], folder: Path, seconds: float, memory: int, hide: Sequence[Path] = ()
) -> Ended:
    """Run a command in a folder, at most ``seconds`` long and ``memory`` bytes large.

    Folders under ``hide`` are empty for it where the system allows that. It is the first of a
    session of its own, all of which is ended with it."""
    read, write = os.pipe()
    limits = {
        "memory": memory,
        "file": FILE_MOST,
        "seconds": int(seconds) + 1,
        "hide": [str(one.resolve()) for one in hide if one.is_dir()],
        "fd": write,
    }
    own = {name: os.environ[name] for name in PASSED if name in os.environ}
    own |= {"HOME": str(folder), "TMPDIR": str(folder), "OMP_NUM_THREADS": "1"}
    own |= {"OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    log, begin = folder / "stderr.txt", time.monotonic()
    with log.open("wb") as words:
        process = subprocess.Popen(
            [sys.executable, "-I", "-S", str(LAUNCH), json.dumps(limits), *command],
            cwd=folder,
            env=own,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=words,
            pass_fds=(write,),
            start_new_session=True,
        )
    os.close(write)
    hidden = os.read(read, 1) == b"1"
    os.close(read)
    status, cpu = _waited(process, begin + seconds)
    return Ended(status, time.monotonic() - begin, cpu, _tail(log), hidden)


def _waited(process: subprocess.Popen[bytes], until: float) -> tuple[int | None, float]:
    """Exit status, None if it had to be stopped, and the processor seconds of a process."""
    stopped, pause = False, 0.005
    while True:
        done, status, usage = os.wait4(process.pid, os.WNOHANG)
        if done:
            break
        if not stopped and time.monotonic() > until:
            stopped = True
            _end(process.pid)
        time.sleep(pause)
        pause = min(2 * pause, 0.1)
    _end(process.pid)  # whatever it left running
    process.returncode = os.waitstatus_to_exitcode(status)
    return None if stopped else process.returncode, usage.ru_utime + usage.ru_stime


def _end(group: int) -> None:
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(group, signal.SIGKILL)


def _tail(log: Path) -> str:
    """The last words of a log, printable; the command may have replaced the file by anything."""
    if not log.is_file() or log.is_symlink():
        return ""
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - 4 * TAIL))
        text = file.read(4 * TAIL).decode("utf-8", "replace")
    return "".join(c if c.isprintable() else " " for c in text).strip()[-TAIL:]

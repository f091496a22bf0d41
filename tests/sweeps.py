"""A small study with a sweep, and workers that take no time, or are killed."""

import json
import os
import signal
import time
from pathlib import Path

import numpy as np
from builders import DRIVEN_MASS
from fakes import friction, verdict
from scipy.integrate import solve_ivp

from symhyb.report.contract import to_json
from symhyb.tasks.expand import Task
from symhyb.tasks.folder import Ended, begin, end, finished, leave_ended, whole
from symhyb.tasks.work import Done

SWEEP = """\
symhyb = 1
title = "a mass with friction"
model = "model.toml"
[[train]]
files = "r*.csv"
[sweep]
each = "recording"
[sweep.noise]
levels = [0.0, 0.001]
"""


def write_sweep(folder: Path, text: str = SWEEP, recordings: int = 3, samples: int = 300) -> Path:
    """The study with its model and recordings: a driven mass on a spring, with dry friction that
    the model lacks, solved by SciPy; without ``samples`` the recordings are one line each."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.toml").write_text(DRIVEN_MASS, encoding="utf-8")
    for number in range(recordings):
        file = folder / f"r{number}.csv"
        if samples:
            np.savetxt(file, _run(number, samples), delimiter=",", header="t,f,laser", comments="")
        else:
            file.write_text(f"{number}\n", encoding="utf-8")
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return folder / "study.toml"


def _run(seed: int, samples: int) -> np.ndarray:
    chance = np.random.default_rng(seed)
    t, phases = 0.02 * np.arange(samples), chance.uniform(0, 6, 3)
    sines = list(zip((6, 5, 3), (3, 6.1, 11), phases, strict=True))

    def force(time: np.ndarray) -> np.ndarray:
        return sum(a * np.sin(w * time + phase) for a, w, phase in sines)

    def rates(time: float, state: np.ndarray) -> list[float]:
        x, v = state
        return [v, float(force(time)) - 25 * x - 0.6 * v - 0.8 * np.tanh(v / 0.01)]

    run = solve_ivp(rates, (0, t[-1]), [0, 0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=0.02)
    return np.c_[t, force(t), run.y[0] + 1e-4 * chance.standard_normal(samples)]


def quick(task: Task, directory: Path) -> Done:
    """Leave the files of a diagnosis at once, with a line that says that it was done once more. The
    value is that of the seed of the recording."""
    if finished(directory, task.key):
        return Done(task.key)
    begin(directory, task.key)
    with open(directory.parent / "performed.txt", "a", encoding="utf-8") as stream:
        stream.write(f"{task.name}\n")
    with whole(directory, task.key) as folder:
        coulomb = 0.5 + int(task.key[:4], 16) / 1e6
        content = to_json(friction(coulomb), verdict())
        (folder / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
        leave_ended(folder, Ended(seconds=time.perf_counter()))
    end(directory, task.key)
    return Done(task.key)


def slow(task: Task, directory: Path) -> Done:
    """As `quick`, after a while, while half of its files are there."""
    if not finished(directory, task.key):
        begin(directory, task.key)
        with whole(directory, task.key) as folder:
            (folder / "half").touch()
            time.sleep(0.2)
            (folder / "half").unlink()
            raise_after = quick(task, directory)
        return raise_after
    return Done(task.key)


def deadly(task: Task, directory: Path) -> Done:
    """As `quick`, but tasks with r1 and no noise kill their worker, always."""
    if "r1.csv, noise=0.0" in f"{task.name},".replace("0.001", "x"):
        begin(directory, task.key)
        time.sleep(0.1)
        os.kill(os.getpid(), signal.SIGKILL)
    return quick(task, directory)


def deadly_once(task: Task, directory: Path) -> Done:
    """As `quick`, but the first worker of a task of r1 is killed."""
    mark = directory.parent / f"once-{task.key}"
    if "r1.csv" in task.name and not mark.exists():
        mark.touch()
        begin(directory, task.key)
        os.kill(os.getpid(), signal.SIGKILL)
    return quick(task, directory)


def disk_full(task: Task, directory: Path) -> Done:
    """No space is left when the second recording is written."""
    if "r1.csv" in task.name:
        return Done(task.key, "No space left on device")
    return quick(task, directory)


def deadly_to_all(task: Task, directory: Path) -> Done:
    """As `quick`, but a task of r1 kills the whole group of processes: of a cluster on this
    computer its scheduler too."""
    if "r1.csv" in task.name:
        time.sleep(0.5)
        os.killpg(0, signal.SIGKILL)
    return quick(task, directory)

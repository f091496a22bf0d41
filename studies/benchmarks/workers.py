"""A study with a sweep, by one worker process and by two.

Each task is a diagnosis of a mass on a spring and a damper, of which a damper is concealed
(:mod:`growth`), with another seed of added noise. Every turn has a folder of its own, so that
nothing is kept from the one before; starting the processes is part of the time.
"""

import tempfile
from pathlib import Path

import numpy as np
from growth import chain, recorded
from timing import Row, in_turns, middle, milliseconds

from symhyb.study.file import read_study
from symhyb.tasks.run import How, run_sweep

SAMPLES, LEVEL = 1000, 0.002


def written(folder: Path, tasks: int) -> Path:
    """A study of so many tasks, its model and its recording."""
    (folder / "chain.toml").write_text(chain(1), encoding="utf-8")
    table = recorded(1, SAMPLES)
    np.savetxt(folder / "run.csv", table, delimiter=",", header="t,f,s0", comments="", fmt="%.9g")
    text = (
        'symhyb = 1\nmodel = "chain.toml"\n[[train]]\nfile = "run.csv"\n'
        f"[sweep.noise]\nlevels = [{LEVEL}]\nseeds = {list(range(tasks))}\n"
    )
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return folder / "study.toml"


def performed(study: Path, workers: int) -> None:
    """Run the study in a new folder.

    Raises:
        RuntimeError: a task failed.
    """
    with tempfile.TemporaryDirectory() as output:
        ran = run_sweep(read_study(study), output, How(workers=workers))
        if ran.failed:
            raise RuntimeError(str(ran.failed))


def rows(tasks: int = 12, repeats: int = 3) -> list[Row]:
    """The bar of two workers."""
    with tempfile.TemporaryDirectory() as name:
        study = written(Path(name), tasks)
        performed(study, 1)  # compiles what serves every task
        times = middle(in_turns({str(n): lambda n=n: performed(study, n) for n in (1, 2)}, repeats))
    note = f"{milliseconds(times['1'])}, {milliseconds(times['2'])}"
    what = "time with one worker over time with two"
    return [Row(f"{tasks} tasks of a study", what, times["1"] / times["2"], 1.7, True, "×", note)]

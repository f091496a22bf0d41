"""What all tabs of a browser share: the bench as it was opened, results, and the one diagnosis."""

import secrets
from collections.abc import Sequence
from pathlib import Path

from symhyb.errors import InputError, Problem
from symhyb.model.write import write_model
from symhyb.workbench.bench import Bench, current
from symhyb.workbench.job import Job, Progress, Request
from symhyb.workbench.latest import Latest
from symhyb.workbench.results import REPORT, Result, read_result, read_results
from symhyb.writing import require_folder

BUSY = "a diagnosis is running already; stop it, or wait until it is done"


class Shared:
    """A bench or none, the ``folders`` of results, and where diagnoses leave theirs: in numbered
    folders of ``output``. ``key`` is the secret in the addresses of reports, another than that of
    the page, which a report cannot learn from its own."""

    def __init__(self, bench: Bench | None, folders: Sequence[Path], output: Path) -> None:
        self.bench, self.output = bench, output
        self.numerics = Latest()
        self.key = secrets.token_urlsafe(24)
        self.results: list[Result] = list(read_results(folders))
        self.job: Job | None = None

    def address(self, folder: Path) -> str:
        """Where the report of a folder is served."""
        number = next(i for i, one in enumerate(self.results) if one.folder == folder)
        return f"/{self.key}/{number}/{REPORT}"

    def report(self, path: str) -> Path | None:
        """The file of an address as `address` gives it, None for any other."""
        parts = path.strip("/").split("/")
        if len(parts) != 3 or parts[2] != REPORT or not parts[1].isdecimal():
            return None
        number = int(parts[1]) if len(parts[1]) < 6 else len(self.results)
        return self.results[number].report if number < len(self.results) else None

    def progress(self) -> Progress | None:
        """How far the diagnosis is, None where there was none."""
        return None if self.job is None else self.job.progress()

    def start(self, bench: Bench, unseen: Sequence[int]) -> None:
        """Begin a diagnosis of the model that is set.

        Raises:
            InputError: one is running, no recording is left to learn from, or nothing can be
                written.
        """
        running = self.progress()
        if running is not None and running.state == "running":
            raise InputError(Problem(BUSY))
        train = [path for i, path in enumerate(bench.paths) if i not in unseen]
        if not train:
            raise InputError(Problem("leave at least one recording to learn from"))
        require_folder(self.output)
        folder = new_folder(self.output)
        model = bench.file
        if bench.changed:
            model = folder / f"{bench.file.stem}-as-set.toml"
            write_model(current(bench), model)
        proof = [path for i, path in enumerate(bench.paths) if i in unseen]
        self.job = Job(Request(model, tuple(train), tuple(proof), bench.columns, folder))

    def stop(self) -> None:
        """End the diagnosis that runs."""
        if self.job is not None:
            self.job.stop()

    def collected(self) -> Result | None:
        """The result of the diagnosis, once it is done; it is among the results then.

        Raises:
            InputError: it cannot be read.
        """
        progress = self.progress()
        if progress is None or progress.state != "done":
            return None
        known = [one for one in self.results if one.folder == progress.output]
        if not known:
            self.results.append(read_result(progress.output))
        return known[0] if known else self.results[-1]


def new_folder(output: Path) -> Path:
    """The first numbered folder that is not there yet."""
    number = 1
    while (output / str(number)).exists():
        number += 1
    return output / str(number)

"""One diagnosis of a case in a folder, timed, with what failed kept."""

import resource
import subprocess
import time
import traceback
from pathlib import Path
from typing import Any


def cpu() -> float:
    """Seconds that this process and its ended children (a compiler) have computed so far."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def commit() -> str:
    """The commit of the code that diagnoses, with a + where files were changed after it."""
    import symhyb

    here = Path(symhyb.__file__).parent
    git = ["git", "-C", str(here)]
    try:
        name = subprocess.run(
            [*git, "rev-parse", "--short=12", "HEAD"], capture_output=True, text=True, check=True
        )
        changed = subprocess.run(
            [*git, "status", "--porcelain", "--", str(here)],
            capture_output=True,
            text=True,
            check=True,
        )
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return name.stdout.strip() + "+" * bool(changed.stdout.strip())


def diagnose(folder: Path) -> dict[str, Any]:
    """What symhyb says of a case, the seconds it took, or how it failed.

    ``seconds`` and ``cpu_seconds`` are those of the diagnosis alone, on the clock and computed."""
    import symhyb as sh
    from symhyb.report.contract import to_json

    reported: dict[str, Any] = {"symhyb": sh.__version__, "commit": commit()}
    begin, spent = time.perf_counter(), cpu()
    try:
        model = sh.read_model(folder / "model.toml")
        train, holdout = (
            sh.read_recording(folder / f"{x}.csv", model) for x in ("train", "holdout")
        )
        begin, spent = time.perf_counter(), cpu()
        diagnosis = sh.diagnose(model, train, holdout)
        reported |= {"seconds": time.perf_counter() - begin, "cpu_seconds": cpu() - spent}
        claims = [diagnosis.found, diagnosis.parameters, diagnosis.measurement]
        if courses := getattr(diagnosis, "courses", ()):  # which older packages do not have
            claims.append(courses)
        corrected = sh.apply(model, *claims)
        verdict = sh.judge(model, corrected, holdout, train=train)
        return {**reported, "diagnosis": to_json(diagnosis, verdict)}
    except Exception as error:  # a crash is a result too: it is reported, not lost
        lasted = {"seconds": time.perf_counter() - begin, "cpu_seconds": cpu() - spent}
        sort = "sentence" if isinstance(error, sh.InputError | sh.NumericsError) else "crash"
        return {**lasted, **reported, sort: str(error), "traceback": traceback.format_exc()}

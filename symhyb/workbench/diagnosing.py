"""The process of a diagnosis: a request from the standard input, lines of JSON to the standard
output. ``python -m symhyb.workbench.diagnosing`` is started by `symhyb.workbench.job` alone."""

import json
import sys
from pathlib import Path
from typing import Any

from symhyb.fault import error_sentences
from symhyb.interruption import is_interruption, listen
from symhyb.steps import Counted
from symhyb.study.file import Study
from symhyb.study.run import StudyResult, carry_out, leave_files
from symhyb.study.sources import Source
from symhyb.writing import require_folder


def tell(message: dict[str, Any]) -> None:
    """Write one message."""
    print(json.dumps(message), flush=True)


def say(step: str) -> None:
    """Write a step, with how many of its pieces are done."""
    pieces = [step.done, step.total] if isinstance(step, Counted) else None
    tell({"step": str(step), "pieces": pieces})


def diagnose(request: dict[str, Any]) -> None:
    """Carry out a request, and say how it ended."""
    study = Study(
        Path(request["model"]),
        tuple(Source(Path(one)) for one in request["train"]),
        tuple(Source(Path(one)) for one in request["holdout"]),
        dict(request["columns"]),
    )
    output = Path(request["output"])
    require_folder(output)

    def leave(result: StudyResult) -> None:
        leave_files(result, output)

    carry_out(study, say, leave)
    tell({"done": True})


def main() -> int:
    """Read the request and carry it out: the exit status."""
    listen()
    try:
        diagnose(json.loads(sys.stdin.read()))
    except (KeyboardInterrupt, Exception) as error:
        if is_interruption(error) or isinstance(error, BrokenPipeError):  # nobody listens any more
            return 130
        status, sentences = error_sentences(error)
        tell({"problems": sentences})
        return status
    return 0


if __name__ == "__main__":
    sys.exit(main())

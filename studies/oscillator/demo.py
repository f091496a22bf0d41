"""The demonstration: find what was concealed in a recording, then open the seal and compare.

    python studies/oscillator/demo.py      (or: make demo)

The recordings were made by generate.py, which shares no code with symhyb; the model file knows a
mass, a spring and the excitation. Ends with exit status 0 if exactly the concealed effects were
found, each value within 5 %.
"""

import base64
import json
import sys
from pathlib import Path

from symhyb.console.results import print_checks, print_result
from symhyb.console.terminal import progress
from symhyb.errors import SymhybError
from symhyb.report.contract import to_json
from symhyb.study.expected import Check, Expected, check
from symhyb.study.run import StudyResult, run_study

HERE = Path(__file__).resolve().parent
OUTPUT = HERE.parent.parent / "build" / "demo"
WITHIN = 0.05  # of each concealed value


def main() -> int:
    """Run the study, then compare what it found with what was concealed."""
    print(f"Diagnosing {HERE.name}/train.csv with a model of mass, spring and excitation ...\n")
    try:
        with progress() as say:
            result = run_study(HERE / "study.toml", OUTPUT, say)
    except SymhybError as error:
        print(f"the demonstration failed: {error}", file=sys.stderr)
        return 1
    print_result(result, OUTPUT)
    print("\nNow the seal is opened: what was concealed, and what was found.")
    checks = dict.fromkeys((*result.checks, *compare(result, unsealed())))
    print_checks(list(checks))
    passed = all(one.passed for one in checks)
    names = " and ".join(unsealed().found or {})
    outcome = "passed" if passed else "FAILED"
    print(f"{outcome}: {names}, nothing else, each within {100 * WITHIN:g} %")
    print(f"took {result.seconds:.0f} s; the report is {OUTPUT / 'report.html'}")
    return 0 if passed else 1


def unsealed() -> Expected:
    """Open the seal: values are the base64 text of their JSON."""
    sealed = json.loads((HERE / "sealed.json").read_text(encoding="utf-8"))
    truth = {key: json.loads(base64.b64decode(text)) for key, text in sealed.items()}
    found = {name: (value, WITHIN) for name, value in truth["found"].items()}
    return Expected(verdict=truth["verdict"], found=found, nothing_else=True)


def compare(result: StudyResult, truth: Expected) -> tuple[Check, ...]:
    """Hold what was found against the truth, name by name."""
    return check(truth, to_json(result.diagnosis, result.verdict))


if __name__ == "__main__":
    sys.exit(main())

"""How far a model and its correction miss an unseen recording in a free run.

    python studies/board/unseen.py CASE CORRECTED OUT

CASE is a folder with model.toml and holdout.csv, CORRECTED a model file, OUT the JSON that is
written: ``before`` and ``after``, the largest error of a sensor over its range, null where a run
ended early; or ``error``. The board starts it apart, like a method: the file is not its own.
"""

import json
import sys
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def missed(case: Path, file: Path) -> dict[str, float | str | None]:
    """Errors before and after, or why there are none."""
    import symhyb as sh

    try:
        model, corrected = sh.read_model(case / "model.toml"), sh.read_model(file)
        if corrected.fmu is not None or getattr(corrected, "engine", None) is not None:
            return {"error": "a corrected model that brings code or an engine is not run"}
        verdict = sh.judge(model, corrected, sh.read_recording(case / "holdout.csv", model))
    except (sh.InputError, sh.NumericsError) as error:
        return {"error": str(error)[:500]}
    assert verdict.holdout is not None
    scores = verdict.holdout.before, verdict.holdout.after
    before, after = (_worst(score.free_run_nrmse) for score in scores)
    return {"before": before, "after": after}


def _worst(errors: Mapping[str, float | None]) -> float | None:
    """The largest one; None if a sensor has none, as where the run ended early."""
    known = [value for value in errors.values() if value is not None]
    return max(known) if known and len(known) == len(errors) else None


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    found = missed(Path(sys.argv[1]), Path(sys.argv[2]))
    Path(sys.argv[3]).write_text(json.dumps(found) + "\n", encoding="utf-8")

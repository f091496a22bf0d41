"""What our entries share: the arguments of a method, a claim in the form of an answer, writing."""

import json
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[3]


def folders() -> tuple[Path, Path]:
    """Case and answer, the first two arguments; symhyb is that of this checkout unless a third
    one is the folder of another."""
    package = Path(sys.argv[3]).resolve() if len(sys.argv) > 3 else ROOT
    sys.path.insert(0, str(package))
    return Path(sys.argv[1]), Path(sys.argv[2])


def element(
    kind: str, place: dict[str, Any], numbers: dict[str, tuple[float, float]], side: str = ""
) -> dict[str, Any]:
    """A claimed element, with value and sd by key."""
    parameters = {
        k: {"value": float(v), "sd": float(sd), "term": k} for k, (v, sd) in numbers.items()
    }
    options = {"options": {"side": side}} if side else {}
    return {"kind": kind, "place": place, "parameters": parameters, **options}


def write(folder: Path, **answer: Any) -> None:
    """Write the answer."""
    text = json.dumps(answer, indent=1, allow_nan=False)
    (folder / "diagnosis.json").write_text(text + "\n", encoding="utf-8")

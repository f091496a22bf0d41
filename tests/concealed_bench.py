"""The scripts of the bench of concealed effects as modules, and small cases of it."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

from tests.scripts import scripts

FOLDER = Path(__file__).parents[1] / "studies" / "concealed"
NAMES = (
    "laws",
    "systems",
    "chains",
    "arm",
    "plant",
    "hidden",
    "oracle",
    "effects",
    "plans",
    "conceal",
    "harder",
    "truth",
    "claims",
    "seal",
    "draw",
    "bars",
    "tables",
    "results",
    "report",
    "score",
    "diagnosing",
    "run",
    "peer_library",
    "peer_motion",
    "peer_stepwise",
    "peer_regression",
    "peers",
    "peer_tuning",
    "figure",
    "fleets",
)
Study = Mapping[str, ModuleType]


@contextmanager
def modules() -> Iterator[Study]:
    """The modules of the bench, which are scripts beside each other."""
    with scripts("concealed", NAMES) as found:
        yield found


def run(study: Study, seeds: Sequence[int], folder: Path, errors: bool = False) -> Any:
    """Draw, diagnose and score cases."""
    (folder / "results").mkdir()
    for seed in seeds:
        study["run"].one(seed, folder, folder / "results")
    return score(study, seeds, folder, errors)


def score(study: Study, seeds: Sequence[int], folder: Path, errors: bool = False) -> Any:
    """Score cases that were diagnosed."""
    options = study["score"].argparse.Namespace(
        seeds=",".join(map(str, seeds)),
        output=folder,
        results=folder / "results",
        peers=folder / "peers",
        errors=errors,
    )
    return study["score"].read(options)


def answer_of(**changes: Any) -> dict[str, Any]:
    """An opened answer: drag on x, or what is changed of it."""
    effect = {"kind": "drag", "place": "x", "side": "both", "keys": {"drag": 0.8}, "share": 0.1}
    plain = {
        "kind": "drag",
        "noise": 0.01,
        "effects": [effect],
        "parameters": {},
        "faults": [],
        "rivals": [],
    }
    return {**plain, **changes}


def reported(kind: str, place: str, term: str, value: float, sd: float) -> dict[str, Any]:
    """A result that claims one force."""
    parameters = {"b": {"value": value, "sd": sd, "unit": "1", "term": term}}
    found = {"kind": kind, "place": {"on": place}, "parameters": parameters}
    diagnosis = {
        "verdict": "missing physics",
        "found": [found],
        "parameters": [],
        "measurement": [],
        "alternatives": [],
    }
    return {"seconds": 1.0, "diagnosis": diagnosis}

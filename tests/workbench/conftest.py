"""A mass on a spring as files: a model, two recordings, and results as a diagnosis leaves them."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from rigs import spring_model, spring_recording

from symhyb.model.write import text_of
from symhyb.workbench.bench import Bench, open_bench, read_shown
from symhyb.workbench.simulated import Prepared, prepare

Write = Callable[..., Path]


@pytest.fixture(scope="session")
def rig(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The files of the rig by name: model, first and second recording. The second calls the
    sensor otherwise."""
    folder = tmp_path_factory.mktemp("rig")
    model = folder / "rig.toml"
    model.write_text(text_of(spring_model(sd=10.0)), encoding="utf-8")
    files = {"model": model}
    for name, seed, header in (("first", 1, "laser"), ("second", 2, "way [mm]")):
        made = spring_recording(seed, {"coulomb": 1.5}, duration=5.0)
        factor = 1000.0 if "mm" in header else 1.0
        rows = zip(made.t, made.inputs["f"], factor * made.sensors["laser"], strict=True)
        lines = [f"t,f,{header}", *(f"{a:.6g},{b:.8g},{c:.8g}" for a, b, c in rows), ""]
        files[name] = folder / f"{name}.csv"
        files[name].write_text("\n".join(lines), encoding="utf-8")
    return files


@pytest.fixture(scope="session")
def bench(rig: dict[str, Path]) -> Bench:
    """The rig with its first recording."""
    return open_bench(rig["model"], [rig["first"]])


@pytest.fixture(scope="session")
def prepared(bench: Bench) -> Prepared:
    """Its first recording with the motion."""
    return prepare(bench.model, read_shown(bench))


def number(value: float, sd: float, unit: str, term: str) -> dict[str, Any]:
    """A fitted number as diagnosis.json has it."""
    return {"value": value, "sd": sd, "unit": unit, "term": term}


@pytest.fixture
def write_result(tmp_path: Path) -> Write:
    """Returns ``write(name, …)``, which leaves a result with a friction of that many N."""

    def write(name: str, friction: float = 1.5, sd: float = 0.1, **more: Any) -> Path:
        before, after = {"laser": 0.2}, {"laser": 0.01}
        score = {
            "before": {"window_nrmse": before, "free_run_nrmse": {"laser": None}},
            "after": {"window_nrmse": after, "free_run_nrmse": {"laser": 0.02}},
        }
        value = {
            "verdict": "missing physics",
            "sentence": "On x the model lacks <b>friction</b>.",
            "found": [
                {
                    "name": "found_friction",
                    "kind": "friction",
                    "place": {"on": "x"},
                    "law": "coulomb*tanh(s'/transition)",
                    "sentence": "Friction & more resists the motion.",
                    "share": 0.9,
                    "parameters": {"F": number(friction, sd, "N", "coulomb")},
                }
            ],
            "parameters": [{"name": "k", "was": 200.0, "value": 210.0, "sd": 2.0, "unit": "N/m"}],
            "measurement": [],
            "record_next": None,
            "scores": {"train": score, "holdout": None},
            **more,
        }
        folder = tmp_path / name
        folder.mkdir(parents=True)
        (folder / "diagnosis.json").write_text(json.dumps(value), encoding="utf-8")
        return folder

    return write

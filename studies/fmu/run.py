"""Diagnose cases of the bench of concealed effects twice: with the model file, and through an FMU
that was exported from it. Keeps one JSON a case; resumable.

    python studies/fmu/run.py --seeds 0-27 [-o build/fmu]

A case whose machine has an imposed coordinate is left out: an FMU has none.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
sys.path.append(str(HERE.parent / "concealed"))

from as_fmu import as_fmu  # noqa: E402
from draw import write  # noqa: E402
from plans import PLAIN, seeds_of  # noqa: E402

import symhyb as sh  # noqa: E402
from symhyb.data.hosts.fmu_answers import TRUST  # noqa: E402


def named(model: sh.Model, folder: Path) -> dict[str, Any]:
    """What a diagnosis with this model names, and the seconds it takes."""
    train, holdout = (sh.read_recording(folder / f"{x}.csv", model) for x in ("train", "holdout"))
    begin = time.perf_counter()
    diagnosis = sh.diagnose(model, train, holdout)
    seconds = time.perf_counter() - begin
    found = [f"{one.element.kind} {one.element.place}" for one in diagnosis.found]
    numbers = [one.name for one in diagnosis.parameters]
    channels = [f"{one.channel} {one.kind}" for one in diagnosis.measurement]
    names = sorted([*found, *numbers, *channels])
    said = {"verdict": diagnosis.verdict, "names": names, "sentence": diagnosis.sentence}
    return {**said, "seconds": round(seconds, 1)}


def one(seed: int, build: Path) -> dict[str, Any] | None:
    """Both diagnoses of a case; None where there is none."""
    folder = write(seed, build, PLAIN)
    if folder is None:
        return None
    model = sh.read_model(folder / "model.toml")
    if any(c.imposed for c in model.coordinates):
        return None
    closed = as_fmu(model, folder / "fmu")
    return {"case": folder.name, "model": named(model, folder), "fmu": named(closed, folder)}


def main() -> None:
    """Run cases and print a line a case, and what they make together."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default="0-27")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/fmu"))
    options = parser.parse_args()
    os.environ[TRUST] = "1"  # they are made here
    options.output.mkdir(parents=True, exist_ok=True)
    rows = []
    for seed in seeds_of(options.seeds):
        kept = options.output / f"{seed:05}.json"
        row = json.loads(kept.read_text()) if kept.exists() else one(seed, options.output)
        kept.write_text(json.dumps(row, indent=1) + "\n", encoding="utf-8")
        if row is not None:
            rows.append(row)
            same = "same" if row["model"]["names"] == row["fmu"]["names"] else "OTHER"
            print(same, row["case"], *(row[key]["seconds"] for key in ("model", "fmu")), flush=True)
    alike = sum(row["model"]["names"] == row["fmu"]["names"] for row in rows)
    ratios = sorted(row["fmu"]["seconds"] / row["model"]["seconds"] for row in rows)
    print(
        f"{alike} of {len(rows)} alike; {ratios[len(ratios) // 2]:.2f} times as slow in the median"
    )
    print(f"at most {ratios[-1]:.2f} times")


if __name__ == "__main__":
    main()

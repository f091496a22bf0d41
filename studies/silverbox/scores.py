"""The figures of the Silverbox benchmark, with named terms and with a smooth remainder.

    python studies/silverbox/scores.py OUT [--noise SHARE] [--remainder]

runs the study (with white noise of SHARE of the output's RMS added to the training part, where
asked for), leaves its files in OUT and prints, in mV, the RMSE of free runs whose first 50 samples
only set the initial state. Nothing is chosen on the tests.
"""

import argparse
import json
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from symhyb.correction.apply import apply
from symhyb.correction.finish import finished
from symhyb.correction.learning.remainder import remainder
from symhyb.data.datasets import fetch
from symhyb.data.recording import Recording, read_recording
from symhyb.diagnosis import diagnose
from symhyb.discrepancy.fitting.initialised import initialised_run
from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.model.write import write_model
from symhyb.study.file import read_study

STUDY = Path(__file__).with_name("study.toml")
STEP = 1.6384e-3  # s between samples
TRAIN, MULTISINE, ARROW = (40650, 105712), (105712, 127400), (100, 40575)
INSIDE = 32_000  # samples of the arrow that do not leave the amplitudes of the training part


def part(model: Model, samples: tuple[int, int]) -> Recording:
    """The recording from one sample to before another."""
    first, last = ((sample - 0.5) * STEP for sample in samples)
    columns = read_study(STUDY).columns
    return read_recording(fetch("silverbox", "SNLS80mV.csv"), model, columns, span=(first, last))


def noisy(recording: Recording, share: float, seed: int = 0) -> Recording:
    """The recording with white noise of a ``share`` of the output's RMS added to it."""
    y = recording.sensors["output"]
    added = share * float(np.std(y)) * np.random.default_rng(seed).standard_normal(y.size)
    return replace(recording, sensors={"output": y + added})


def scores(model: Model) -> Mapping[str, float]:
    """RMSE in mV on the multisine, the arrow, and the arrow without extrapolation."""
    multisine = initialised_run(model, part(model, MULTISINE))
    arrow = initialised_run(model, part(model, ARROW))
    return {
        "multisine": 1e3 * multisine.rmse()["output"],
        "arrow": 1e3 * arrow.rmse()["output"],
        "arrow without extrapolation": 1e3 * arrow.rmse(INSIDE)["output"],
    }


def main() -> None:
    """Diagnose the training part, correct the model, score it, and leave it with its figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--noise", type=float, default=0.0)
    parser.add_argument("--remainder", action="store_true")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    model, begun = read_model(read_study(STUDY).model), time.process_time()
    train = part(model, TRAIN)
    train = noisy(train, given.noise) if given.noise else train
    found = diagnose(
        model,
        train,
        say=lambda line: print(f"{time.process_time() - begun:7.1f} {line}", flush=True),
    )
    corrected = apply(model, found.found, found.parameters, found.measurement, found.courses)
    shown = {"sentence": found.sentence, "named": scores(corrected)}
    write_model(corrected, given.out / "corrected.toml")
    corrected = finished(corrected, train).model
    shown["named, last values"] = scores(corrected)
    write_model(corrected, given.out / "finished.toml")
    left = remainder(corrected, train) if given.remainder else None
    if left is not None:
        write_model(left.model, given.out / "with_remainder.toml")
        shown |= {"remainder": left.sentence, "with remainder": scores(left.model)}
    shown["processor seconds"] = round(time.process_time() - begun, 1)
    print(json.dumps(shown, indent=2, ensure_ascii=False))
    (given.out / "scores.json").write_text(json.dumps(shown, indent=2, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()

"""One task that fits: numbers of a model on the recordings of one unit, and no cause is sought.

fit.json of a task holds the values in the units of the model file, their whole covariance, and how
much the fitted model leaves of its recordings; where structures are compared, this of each of them,
with its evidence.
"""

import json
import math
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from symhyb.correction.calibration import Calibrated, calibrated
from symhyb.correction.structures import structured
from symhyb.data.recording import Recording
from symhyb.errors import NumericsError
from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.model.write import set_parameters, write_model
from symhyb.numeric.kernels.buffers import Array
from symhyb.report.contract import finite
from symhyb.study.file import Study
from symhyb.study.provenance import entry_of, sha256_of, table_hashes, versions
from symhyb.study.run import read_all
from symhyb.tasks.expand import Task
from symhyb.writing import write_file

NAME = "fit.json"
FORMAT = 1
NEGATIVE = 1e-6  # of a correlation matrix: rounding of the smallest eigenvalue


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """What a task fitted: ``names`` (K) of numbers as ``k`` or ``laser.gain``, their ``values``
    (K,) and ``covariance`` (K, K) in the ``units`` of the model file; a number that the recordings
    do not determine has an infinite variance and no covariances. ``before`` and ``after`` are χ²
    per sample of the model as given and as fitted, 1 where it is noise alone; ``samples`` are
    those of the windows less their initial states, ``correlation_time`` over how many samples
    the rest is correlated; ``bounds`` are the names of numbers that end at a bound. Where
    structures were compared, ``rungs`` are all of them in the order of the study, and the rest is
    of the likeliest."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    covariance: Array
    before: float
    after: float
    samples: int
    correlation_time: float
    bounds: tuple[str, ...] = ()
    rungs: tuple["Rung", ...] = ()

    @property
    def sd(self) -> Array:
        """One standard deviation of each number (K,), in its unit."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))


@dataclass(frozen=True, slots=True, eq=False)
class Rung:
    """One of several structures that a task compared: its ``name``, what it ``fitted`` (None: it
    cannot be simulated), the ln of its ``evidence`` less that of the likeliest, and its posterior
    ``probability``, equal ones before."""

    name: str
    fitted: Fitted | None
    evidence: float
    probability: float


def leave_fit(task: Task, folder: Path) -> None:
    """Fit what the study of a task names to its training recordings, and leave ``fit.json``,
    ``fitted.toml`` (the model with these values) and ``manifest.json``. A stated sd of a number is
    no evidence about it here: what units have in common is estimated from all of them.

    Raises:
        InputError: the model or a recording is wrong.
        NumericsError: the numerics failed, or a value is not finite.
    """
    study, begin = task.study, time.perf_counter()
    model = set_parameters(read_model(study.model), dict(study.values))
    recordings, _ = read_all(study, model)
    if study.structures:
        done, content = _compared(study, model, recordings)
    else:
        done = calibrated(model, recordings, study.fit or (), stated=False)
        content = {"format": FORMAT, **_content(done)}
    write_model(done.model, folder / "fitted.toml")
    write_file(folder / NAME, _text(content))
    said = _manifest(task, model, recordings, time.perf_counter() - begin)
    write_file(folder / "manifest.json", _text(said))


def _compared(
    study: Study, model: Model, recordings: tuple[Recording, ...]
) -> tuple[Calibrated, dict[str, Any]]:
    """The likeliest of the structures of a study, and what is left of all of them."""
    common = study.fit or ()
    asked = [((*common, *one.fit), dict(one.values)) for one in study.structures]
    found = structured(model, recordings, asked)
    likeliest = found.fits[found.likeliest]
    assert likeliest is not None
    rungs = [
        {
            "name": one.name,
            "ln_evidence": finite(float(logs)),
            "probability": float(part),
            **({} if fit is None else _content(fit)),
        }
        for one, fit, logs, part in zip(
            study.structures, found.fits, found.ln_evidence, found.probabilities, strict=True
        )
    ]
    head = {"format": FORMAT, "structure": study.structures[found.likeliest].name}
    return likeliest, {**head, **_content(likeliest), "structures": rungs}


def read_fit(content: Mapping[str, Any]) -> Fitted:
    """What the content of a ``fit.json`` says.

    Raises:
        ValueError, KeyError, TypeError: it is none.
    """
    rungs = tuple(map(_rung, content.get("structures", ())))
    return replace(_read_numbers(content), rungs=rungs)


def _rung(content: Mapping[str, Any]) -> Rung:
    fitted = _read_numbers(content) if "numbers" in content else None
    logs, part = content["ln_evidence"], float(content["probability"])
    evidence = -math.inf if logs is None else float(logs)
    if not (evidence <= 0 and 0 <= part <= 1) or (fitted is None and logs is not None):
        raise ValueError("a structure without an evidence or a probability")
    return Rung(str(content["name"]), fitted, evidence, part)


def _read_numbers(content: Mapping[str, Any]) -> Fitted:
    numbers = content["numbers"]
    covariance = np.array(
        [[np.nan if x is None else float(x) for x in row] for row in content["covariance"]]
    )
    size = len(numbers)
    if not numbers or covariance.shape != (size, size):
        raise ValueError(f"a covariance of {covariance.shape} for {size} numbers")
    unknown = ~np.isfinite(np.diag(covariance)) | (np.diag(covariance) <= 0)
    covariance[unknown, :], covariance[:, unknown] = 0.0, 0.0
    covariance[unknown, unknown] = np.inf
    covariance = (covariance + covariance.T) / 2
    values = np.array([float(one["value"]) for one in numbers])
    if not (np.isfinite(values).all() and not np.isnan(covariance).any()):
        raise ValueError("values and covariances must be finite")
    finite = np.where(np.isinf(covariance), 1.0, covariance)
    scale = np.sqrt(np.diag(finite))  # of small ones the product of two variances is 0
    if np.linalg.eigvalsh(finite / np.outer(scale, scale))[0] < -NEGATIVE:
        raise ValueError("its covariance is none: not positive")
    after = content["noise_multiple"]["after"]
    before = content["noise_multiple"]["before"]
    return Fitted(
        tuple(str(one["name"]) for one in numbers),
        tuple(str(one["unit"]) for one in numbers),
        values,
        covariance,
        math.inf if before is None else float(before) ** 2,
        math.inf if after is None else float(after) ** 2,
        int(content["samples"]),
        float(content["correlation_time"]),
        tuple(map(str, content["bounds"])),
    )


def _content(done: Calibrated) -> dict[str, Any]:
    values = [item.value for item in done.parameters]
    sd = np.array([item.sd for item in done.parameters], dtype=np.float64)
    if not np.isfinite(values).all():
        names = [item.name for item in done.parameters if not math.isfinite(item.value)]
        raise NumericsError(f"fitted values are not finite: {', '.join(names)}")
    with np.errstate(invalid="ignore", over="ignore"):
        covariance = done.correlation * np.outer(sd, sd)
    return {
        "numbers": [
            {
                "name": item.name,
                "unit": item.unit,
                "was": item.was,
                "value": item.value,
                "sd": finite(item.sd),
            }
            for item in done.parameters
        ],
        "covariance": [[finite(x) for x in row] for row in covariance.tolist()],
        "noise_multiple": {
            "before": finite(math.sqrt(done.before)),
            "after": finite(math.sqrt(done.after)),
        },
        "samples": done.samples,
        "correlation_time": done.correlation_time,
        "bounds": list(done.bounds),
        "faults": [fault.sentence for fault in done.faults],
    }


def _manifest(
    task: Task, model: Model, recordings: tuple[Recording, ...], seconds: float
) -> dict[str, Any]:
    """What a fit was made from: hashes, versions and duration, but no paths."""
    study: Study = task.study
    return {
        "task": task.name,
        "key": task.key,
        "model": {"file": study.model.name, "sha256": sha256_of(study.model)},
        **table_hashes(model),
        "recordings": [
            entry_of("train", recording, source)
            for recording, source in zip(recordings, study.train, strict=True)
        ],
        "map": dict(study.columns or {}),
        "fit": list(study.fit or ()),
        **({"structures": [asdict(one) for one in study.structures]} if study.structures else {}),
        **({"values": dict(study.values)} if study.values else {}),
        **({"noise": asdict(study.noise)} if study.noise else {}),
        "versions": versions(),
        "seconds": round(seconds, 1),
    }


def _text(content: Mapping[str, Any]) -> str:
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"

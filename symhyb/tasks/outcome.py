"""What came out of each task of a study, read from the folder of a run."""

import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from symhyb.errors import InputError, Problem
from symhyb.limits import DIAGNOSIS_BYTES, content_of
from symhyb.study.expected import found_terms, place_name
from symhyb.tasks.fitting import NAME as FIT
from symhyb.tasks.fitting import Fitted, read_fit
from symhyb.tasks.folder import TASKS, Entry, ended, read_index

NOT_RUN = "not run"
FAILED = "failed"
FINISHED = "finished"
FITTED = "fitted"
"""What a task that only fits has for a verdict."""


@dataclass(frozen=True, slots=True)
class Number:
    """A found value with one standard deviation, in ``unit``."""

    value: float
    sd: float | None
    unit: str


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came out of a task: ``state`` is finished, failed or not run. ``found`` are numbers by
    place.term, ``classes`` probabilities by place.class, ``scores`` by path; ``fitted`` is what a
    task that only fits says, whose verdict is "fitted"."""

    entry: Entry
    state: str
    failure: str = ""
    seconds: float | None = None
    verdict: str = ""
    found: Mapping[str, Number] = field(default_factory=dict)
    classes: Mapping[str, float] = field(default_factory=dict)
    scores: Mapping[str, float] = field(default_factory=dict)
    fitted: Fitted | None = None


@dataclass(frozen=True, slots=True)
class Outcomes:
    """The outcomes of the tasks of a study in the order of its file."""

    title: str
    tasks: tuple[Outcome, ...]


def read_outcomes(directory: str | os.PathLike[str]) -> Outcomes:
    """Read what the tasks in a folder left.

    Raises:
        InputError: it is no folder of a study with a sweep, or a file in it is damaged.
    """
    folder = Path(directory)
    title, entries = read_index(folder)
    return Outcomes(title, tuple(_outcome(folder, entry) for entry in entries))


def _outcome(folder: Path, entry: Entry) -> Outcome:
    how = ended(folder, entry.key)
    if how is None:
        return Outcome(entry, NOT_RUN)
    if how.why:
        return Outcome(entry, FAILED, "; ".join(how.sentences), how.seconds)
    fit = folder / TASKS / entry.key / FIT
    if fit.is_file():
        return _fitted(entry, fit, how.seconds)
    file = folder / TASKS / entry.key / "diagnosis.json"
    try:
        content = json.loads(content_of(file, DIAGNOSIS_BYTES))
        return Outcome(
            entry,
            FINISHED,
            seconds=how.seconds,
            verdict=str(content["verdict"]),
            found={
                name: Number(one["value"], one.get("sd"), one["unit"])
                for name, one in found_terms(content).items()
            },
            classes=_classes(content),
            scores=dict(_numbers(content["scores"])),
        )
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        text = f"is no diagnosis: {type(error).__name__} {error}"
        raise InputError(Problem(text, file=str(file))) from None


def _fitted(entry: Entry, file: Path, seconds: float) -> Outcome:
    try:
        one = read_fit(json.loads(content_of(file, DIAGNOSIS_BYTES)))
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        text = f"is no fit: {type(error).__name__} {error}"
        raise InputError(Problem(text, file=str(file))) from None
    numbers = zip(one.names, one.values, one.sd, one.units, strict=True)
    found = {
        name: Number(float(value), float(sd) if math.isfinite(sd) else None, unit)
        for name, value, sd, unit in numbers
    }
    left = {"before": one.before, "after": one.after}
    scores = {f"noise_multiple.{when}": math.sqrt(x) for when, x in left.items() if x < math.inf}
    return Outcome(
        entry, FINISHED, seconds=seconds, verdict=FITTED, found=found, scores=scores, fitted=one
    )


def _classes(content: Mapping[str, Any]) -> dict[str, float]:
    found = {}
    for one in content.get("classes", ()):
        where = place_name(one["place"]) if "place" in one else one.get("channel")
        name = f"{where or one.get('parameter')}.{one['kind']}"
        found[name] = float(one["probability"])
    return found


def _numbers(scores: Mapping[str, Any], above: str = "") -> list[tuple[str, float]]:
    """The numbers in nested scores by their paths; those that there are not are left out."""
    found: list[tuple[str, float]] = []
    for key, value in scores.items():
        path = f"{above}.{key}" if above else key
        if isinstance(value, Mapping):
            found += _numbers(value, path)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            found.append((path, float(value)))
    return found

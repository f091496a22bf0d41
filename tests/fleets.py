"""Fleets of which the truth is known: units drawn from a population, and folders of their fits."""

import json
from pathlib import Path

import numpy as np

from symhyb.fleet.means import Array, Unit

NAMES = ("k", "d", "laser.gain")
UNITS = ("N/m", "N*s/m", "1")


def drawn(
    seed: int,
    count: int,
    mean: Array,
    between: Array,
    error: Array,
    recordings: int = 1,
    within: Array | None = None,
    slope: Array | None = None,
) -> list[Unit]:
    """Units of a population (K numbers), each with so many recordings; with a ``slope`` (K,) the
    numbers depend on one condition between −1 and 1."""
    chance = np.random.default_rng(seed)
    none, units = np.zeros(mean.size), []
    for _ in range(count):
        own = chance.multivariate_normal(none, between)
        x = np.ones((recordings, 1))
        if slope is not None:
            x = np.column_stack([x, chance.uniform(-1, 1, recordings)])
        y = mean + own + chance.multivariate_normal(none, error, recordings)
        if within is not None:
            y = y + chance.multivariate_normal(none, within, recordings)
        if slope is not None:
            y = y + np.outer(x[:, 1], slope)
        units.append(Unit(y, np.repeat(error[None], recordings, axis=0), x))
    return units


def write_fits(
    folder: Path,
    values: Array,
    covariance: Array,
    groups: list[dict[str, str]],
    left: Array | None = None,
    states: dict[int, str] | None = None,
    names: tuple[str, ...] = NAMES,
) -> Path:
    """Leave the folder of a sweep with a fit a row of ``values`` (N, K), but for those tasks whose
    state is another: a failure, or empty for not run."""
    entries = []
    for i, row in enumerate(values):
        key, known = f"{i:064x}", {"m": 1.5}
        entries.append(
            {
                "name": f"recordings=r{i}.csv",
                "settings": {"recordings": f"r{i}.csv"},
                "key": key,
                "recordings": [{"name": f"r{i}.csv", "groups": groups[i], "parameters": known}],
            }
        )
        state = (states or {}).get(i)
        if state == "":
            continue
        task = folder / "tasks" / key
        task.mkdir(parents=True)
        ended = {"why": "input" if state else "", "sentences": [state or ""], "seconds": 1.0}
        (task / "task.json").write_text(json.dumps(ended), encoding="utf-8")
        if not state:
            rest = 1.0 if left is None else float(left[i])
            (task / "fit.json").write_text(json.dumps(fit_content(row, covariance, rest, names)))
    content = {"format": 1, "title": "a fleet", "symhyb": "0", "tasks": entries}
    (folder / "study.json").write_text(json.dumps(content), encoding="utf-8")
    return folder


def fit_content(
    row: Array, covariance: Array, left: float = 1.0, names: tuple[str, ...] = NAMES
) -> dict[str, object]:
    """The content of a ``fit.json``."""
    sd = np.sqrt(np.diag(covariance))
    return {
        "format": 1,
        "numbers": [
            {"name": name, "unit": unit, "was": 1.0, "value": float(value), "sd": float(error)}
            for name, unit, value, error in zip(names, UNITS, row, sd, strict=False)
        ],
        "covariance": covariance.tolist(),
        "noise_multiple": {"before": 10.0, "after": left},
        "samples": 1000,
        "correlation_time": 2.0,
        "bounds": [],
        "faults": [],
    }

"""The output files of a diagnosis, each written whole or not at all."""

import csv
import io
import json
import os
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from symhyb.asked import asked
from symhyb.discrepancy.checks.first_checks import FirstChecks
from symhyb.discrepancy.results import Diagnosis, Trace, Verdict
from symhyb.model.types import Model
from symhyb.report.contract import to_json
from symhyb.report.page import render_page
from symhyb.writing import write_file


@asked
def write_report(
    path: str | os.PathLike[str],
    diagnosis: Diagnosis,
    verdict: Verdict,
    model: Model | None = None,
    *,
    title: str | None = None,
    difference: str = "",
    provenance: Mapping[str, str] | None = None,
    first: FirstChecks | None = None,
) -> None:
    """Write the diagnosis as one self-contained HTML page.

    ``model`` gives the units to show signals in and the title, if none is given.

    Raises:
        InputError: the file cannot be written.
    """
    heading = title or (model.title if model is not None else "Diagnosis")
    page = render_page(heading, diagnosis, verdict, difference, provenance, model, first)
    write_file(path, page)


@asked
def write_diagnosis(path: str | os.PathLike[str], diagnosis: Diagnosis, verdict: Verdict) -> None:
    """Write ``diagnosis.json``, valid under the output contract.

    Raises:
        InputError: the file cannot be written.
        NumericsError: a fitted value is not finite.
    """
    content = to_json(diagnosis, verdict)
    write_file(path, json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


@asked
def write_simulation(path: str | os.PathLike[str], traces: Sequence[Trace], model: Model) -> None:
    """Write ``simulation.csv``: every recording with its simulations before and after.

    Columns ``recording``, ``role``, ``t`` (s) and for each sensor ``<sensor>_measured [unit]``,
    ``_before``, ``_after`` in the sensor's unit; an empty cell where there is no value.

    Raises:
        InputError: the file cannot be written.
    """
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(
        ["recording", "role", "t"]
        + [
            f"{sensor.name}_{moment} [{sensor.unit.text}]"
            for sensor in model.sensors
            for moment in ("measured", "before", "after")
        ]
    )
    for trace in traces:
        columns = [_cells(trace.t, 12), *_signals(trace, model)]
        for row in zip(*columns, strict=True):
            table.writerow([trace.recording, trace.role, *row])
    write_file(path, text.getvalue())


def _signals(trace: Trace, model: Model) -> Iterator[list[str]]:
    for sensor in model.sensors:
        for signals in (trace.measured, trace.before, trace.after):
            values = signals.get(sensor.name)
            known = np.full(len(trace.t), np.nan) if values is None else values
            yield _cells(known / sensor.unit.factor, 9)


def _cells(values: NDArray[np.float64], digits: int) -> list[str]:
    return [f"{value:.{digits}g}" if np.isfinite(value) else "" for value in values.tolist()]

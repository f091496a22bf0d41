"""A fleet as plain values, as a table of its units, and as a picture."""

from pathlib import Path
from typing import Any

import numpy as np

from symhyb.fleet.fleet import Common, Fleet, Own, Reason
from symhyb.fleet.words import fleet_notes, reason_sentence
from symhyb.report.contract import finite
from symhyb.report.fleet_figure import Panel, fleet_figure
from symhyb.tasks.rows import Cell, Rows, csv_text, write_parquet
from symhyb.writing import write_file


def fleet_facts(fleet: Fleet) -> dict[str, Any]:
    """Give a fleet as plain values; numbers that are not finite are null."""
    return {
        "title": fleet.title,
        "conditions": {
            name: {"mean": float(mean)}
            for name, mean in zip(fleet.conditions, fleet.centre, strict=True)
        },
        "among": list(fleet.among),
        "together": {cause: list(numbers) for cause, numbers in fleet.together},
        "structures": [
            {
                "name": one.name,
                "ln_evidence": finite(one.evidence),
                "probability": one.probability,
                "likeliest_in": one.likeliest,
                "recordings": one.recordings,
            }
            for one in fleet.structures
        ],
        "structure": fleet.structure or None,
        "numbers": [_number(one) for one in fleet.numbers],
        "units": [_unit(fleet, one) for one in fleet.units],
        "deviating": [one.name for one in fleet.deviating],
        "tested": fleet.tested,
        "failed": fleet.failed,
        "not_run": fleet.not_run,
        "notes": list(fleet_notes(fleet)),
    }


def unit_rows(fleet: Fleet) -> Rows:
    """A row for each unit: its conditions, its values by its own recordings and with the
    population, what its fits leave, what its recordings say, and why it is named."""
    head = ["unit", *fleet.conditions]
    for one in fleet.numbers:
        head += [f"{one.name} [{one.unit}]", f"{one.name} sd [{one.unit}]"]
        head += [f"{one.name} shrunken [{one.unit}]", f"{one.name} shrunken sd [{one.unit}]"]
    head += ["noise_multiple", "information", "deviates", "numbers", "probability", "reason"]
    rows = []
    for unit in fleet.units:
        row: list[Cell] = [unit.name, *map(float, unit.conditions)]
        columns = zip(unit.values, unit.sd, unit.shrunken, unit.shrunken_sd, strict=True)
        for numbers in columns:
            row += [finite(float(x)) for x in numbers]
        reason = unit.reason
        row += [finite(unit.left), finite(unit.information)]
        row += [None] * 4 if reason is None else _cells(reason)
        rows.append(tuple(row))
    return Rows(tuple(head), tuple(rows))


def write_units(fleet: Fleet, file: Path) -> None:
    """Write the table of units, as Parquet where the name says so, else as CSV.

    Raises:
        InputError: the file cannot be written.
    """
    if file.suffix.lower() == ".parquet":
        write_parquet(unit_rows(fleet), file)
    else:
        write_file(file, csv_text(unit_rows(fleet)))


def write_picture(fleet: Fleet, file: Path) -> None:
    """Draw every number of all units, over each condition or in the order of the study, as an SVG
    or a PNG.

    Raises:
        InputError: the file cannot be written.
    """
    over = range(len(fleet.conditions)) if fleet.conditions else (None,)
    panels = [[_panel(fleet, k, c) for c in over] for k in range(len(fleet.numbers))]
    write_file(file, fleet_figure(panels, fleet.title, file.suffix))


def _panel(fleet: Fleet, k: int, c: int | None) -> Panel:
    """One number of all units over one condition, the others taken to their means."""
    number = fleet.numbers[k]
    x = np.arange(len(fleet.units), dtype=np.float64)
    y = np.array([one.values[k] for one in fleet.units])
    sd = np.array([one.sd[k] for one in fleet.units])
    line, others = np.full(2, number.mean), np.zeros(len(x))
    ends = np.array([x.min(), x.max()])
    conditions = np.array([one.conditions for one in fleet.units]) - fleet.centre
    for i, slope in enumerate(number.slopes):
        if i == c:
            x = conditions[:, i] + fleet.centre[i]
            ends = np.array([x.min(), x.max()])
            change = slope.value * (ends - fleet.centre[i])
            line = number.mean * np.exp(change) if number.factors else number.mean + change
        else:
            others = others + slope.value * conditions[:, i]
    y, sd = (y / np.exp(others), sd / np.exp(others)) if number.factors else (y - others, sd)
    spread = number.spread * (np.abs(line) if number.factors else 1.0)
    odd = [
        one.name if one.reason is not None and _shown(one.reason, number.name) else ""
        for one in fleet.units
    ]
    title = "unit, in the order of the study" if c is None else fleet.conditions[c]
    return Panel(number.name, number.unit, title, x, y, sd, ends, line, spread + 0 * line, odd)


def _shown(reason: Reason, name: str) -> bool:
    return reason.kind == "structure" or name in reason.names


def _number(one: Common) -> dict[str, Any]:
    return {
        "name": one.name,
        "unit": one.unit,
        "varies_by": "factors" if one.factors else "amounts",
        "mean": one.mean,
        "sd": finite(one.sd),
        "spread": finite(one.spread),
        "spread_sd": finite(one.spread_sd),
        "spread_within": one.within,
        "slopes": [
            {
                "condition": slope.condition,
                "value": slope.value,
                "sd": finite(slope.sd),
                "probability": slope.probability,
            }
            for slope in one.slopes
        ],
    }


def _unit(fleet: Fleet, one: Own) -> dict[str, Any]:
    columns = zip(one.values, one.sd, one.shrunken, one.shrunken_sd, strict=True)
    numbers = {
        number.name: dict(
            zip(("value", "sd", "shrunken", "shrunken_sd"), map(_float, row), strict=True)
        )
        for number, row in zip(fleet.numbers, columns, strict=True)
    }
    return {
        "name": one.name,
        "tasks": list(one.tasks),
        "conditions": dict(zip(fleet.conditions, map(float, one.conditions), strict=True)),
        "numbers": numbers,
        "noise_multiple": finite(one.left),
        "information": finite(one.information),
        "adds_nothing": one.adds_nothing,
        "bounds": list(one.bounds),
        "reason": None if one.reason is None else _reason(one.reason),
    }


def _reason(reason: Reason) -> dict[str, Any]:
    return {
        "kind": reason.kind,
        "probability": reason.probability,
        "noise_times": reason.times if reason.kind == "structure" else None,
        "off": [
            {"name": one.name, "unit": one.unit, "by": one.by, "sd": one.sd, "part": one.part}
            for one in reason.off
        ],
        "rivals": [list(names) for names in reason.rivals],
        "trends": [
            {
                "name": one.name,
                "unit": one.unit,
                "condition": one.condition,
                "by": one.by,
                "sd": one.sd,
                "as_part": one.factors,
            }
            for one in reason.trends
        ],
        "sentence": reason_sentence(reason),
    }


def _cells(reason: Reason) -> list[Cell]:
    names = ", ".join(reason.names) or None
    return [reason.kind, names, reason.probability, reason_sentence(reason)]


def _float(number: float) -> float | None:
    return finite(float(number))

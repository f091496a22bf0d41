"""What one passage along a long recording shows, printed, as plain values and as a table."""

import csv
import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from symhyb.discrepancy.words.amounts import joined, number_text, percent_text, quantity_text
from symhyb.model.places import place_text
from symhyb.model.types import On
from symhyb.model.vocabulary import force_unit
from symhyb.numeric.kernels.buffers import Array
from symhyb.report.contract import finite
from symhyb.scanning import Proposed, Scan
from symhyb.units import Unit

LISTED = 5  # stretches
WHOLE_MOST = 1_000_000  # samples of a recording that is diagnosed as a whole


def print_scan(found: Scan, model: str) -> None:
    """Print what is lacking by coordinate, the laws that are proposed, and when it is another;
    ``model`` is the name of the model file."""
    rate = number_text(1 / found.step_s)
    print(
        f"{found.file}: {found.samples} samples in {_lasting(found)} at {rate} Hz,"
        f" {'each' if found.averaged == 1 else f'averaged over {found.averaged}'},"
        f" in {len(found.stretches)} stretches"
    )
    print("what the model lacks, as a force (ΔF = M q'' + k_c − k_e), RMS:")
    force, applied = (_whole(found, name) for name in ("force", "applied"))
    for i, (name, unit) in enumerate(_units(found)):
        share = f", {percent_text(force[i] / applied[i])} of what is applied" if applied[i] else ""
        print(f"  {name}: {quantity_text(force[i] / unit.factor, unit.text)}{share}")
    if found.screen is None:
        print("forces of laws were not compared: constraints, or all motion is given")
    elif found.proposed:
        print("least squares of forces proposes (a diagnosis decides):")
        print(*(f"  {_law_text(found, law)}" for law in found.proposed), sep="\n")
    else:
        print("least squares of forces proposes no law")
    for line in _unlike_lines(found):
        print(line)
    print(f"next: symhyb diagnose {model} {found.file}{_span(found)}")


def scan_facts(found: Scan) -> dict[str, Any]:
    """Give a scan as plain values, in the units of forces at the coordinates."""
    units, unlike = [unit for _, unit in _units(found)], found.unlike
    return {
        "file": found.file,
        "samples": found.samples,
        "step_s": found.step_s,
        "averaged": found.averaged,
        "coordinates": [{"name": name, "unit": unit.text} for name, unit in _units(found)],
        "proposed": [
            {
                "place": place_text(law.hypothesis.place) if law.hypothesis.place else None,
                "kind": law.hypothesis.kind,
                "values": {
                    key: {"value": value / unit.factor, "unit": unit.text}
                    for key, value, unit in _values(found, law)
                },
            }
            for law in found.proposed
        ],
        "stretches": [
            {
                "start_s": one.start,
                "end_s": one.end,
                "force": _in(one.force, units),
                "applied": _in(one.applied, units),
                "left": _in(one.left, [units[i] for i in found.free]),
                "unlike": one in unlike,
            }
            for one in found.stretches
        ],
    }


def scan_table(found: Scan) -> str:
    """Give the stretches as CSV: times, and RMS by coordinate in the unit of its force."""
    units = _units(found)
    head = ["start [s]", "end [s]"]
    head += [f"lacking {name} [{unit.text}]" for name, unit in units]
    head += [f"applied {name} [{unit.text}]" for name, unit in units]
    head += [f"left {units[i][0]} [{units[i][1].text}]" for i in found.free]
    written = io.StringIO()
    table = csv.writer(written, lineterminator="\n")
    table.writerow(head)
    every = [unit for _, unit in units]
    for one in found.stretches:
        left = _in(one.left, [every[i] for i in found.free])
        numbers = [one.start, one.end, *_in(one.force, every), *_in(one.applied, every), *left]
        table.writerow(["" if number is None else f"{number:.9g}" for number in numbers])
    return written.getvalue()


def _unlike_lines(found: Scan) -> Iterator[str]:
    unlike = found.unlike
    if not unlike:
        yield "no stretch is unlike the others"
        return
    names = [found.model.coordinates[i].name for i in found.free]
    yield f"{len(unlike)} stretch{'es' * (len(unlike) > 1)} unlike the others:"
    usual = found.usual
    for one in unlike[:LISTED]:
        times = one.left / usual
        on = joined(
            [f"{number_text(x, digits=2)} on {n}" for n, x in zip(names, times, strict=True)]
        )
        begin, end = number_text(one.start, digits=6), number_text(one.end, digits=6)
        yield f"  t = {begin} … {end} s: beside that is left, times the usual, {on}"
    if len(unlike) > LISTED:
        yield f"  and {len(unlike) - LISTED} more"


def _span(found: Scan) -> str:
    """The options by which the stretch to diagnose is read; none where all of it may be."""
    if not found.unlike and found.samples <= WHOLE_MOST:
        return ""
    worst = (*found.unlike, *found.stretches)[0]
    return f" --start {worst.start:.6g} --end {worst.end:.6g}"


def _law_text(found: Scan, law: Proposed) -> str:
    values = [f"{key} {quantity_text(x / u.factor, u.text)}" for key, x, u in _values(found, law)]
    place = "" if law.hypothesis.place is None else f" {place_text(law.hypothesis.place)}"
    return f"{law.hypothesis.kind}{place}: {joined(values)}"


def _values(found: Scan, law: Proposed) -> list[tuple[str, float, Unit]]:
    return [
        (key, value, law.hypothesis.unit(found.model, key)) for key, value in law.values.items()
    ]


def _units(found: Scan) -> list[tuple[str, Unit]]:
    return [(c.name, force_unit(found.model, On(c.name))) for c in found.model.coordinates]


def _in(values: Array, units: list[Unit]) -> list[float | None]:
    return [finite(float(x) / unit.factor) for x, unit in zip(values, units, strict=True)]


def _whole(found: Scan, name: str) -> Array:
    """The RMS (n,) over all stretches, SI."""
    lasting = np.array([one.end - one.start for one in found.stretches])
    squares = np.array([getattr(one, name) ** 2 for one in found.stretches])
    return np.asarray(np.sqrt(lasting @ squares / lasting.sum()))


def _lasting(found: Scan) -> str:
    seconds = found.stretches[-1].end - found.stretches[0].start
    for size, unit in ((86400.0, "d"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 3 * size:
            return quantity_text(seconds / size, unit, digits=3)
    return quantity_text(seconds, "s", digits=3)

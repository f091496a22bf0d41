"""Run the benchmarks, print the table, and keep it in results.json and docs/performance.md.

python studies/benchmarks/bench.py                 all of it, some minutes
python studies/benchmarks/bench.py --only forces   one part, printed only
... --only forces --keep   one part, and the kept rows of the others as they stand
"""

import argparse
import datetime
import json
import os
import re
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from timing import Row, machine

HERE = Path(__file__).parent
PAGE = HERE.parents[1] / "docs" / "performance.md"
BEGIN, END = "<!-- measured -->", "<!-- /measured -->"
PARTS = (
    "links",
    "runs",
    "events",
    "forces",
    "sweep",
    "starting",
    "pages",
    "regression",
    "matching",
    "compiled",
    "growth",
    "models",
    "dopri5",
    "workers",
    "streaming",
)


def measure(part: str) -> list[Row]:
    """The rows of one part; imported here, so that a part needs only its own libraries."""
    import compiled
    import dopri5
    import forces
    import growth
    import links
    import oscillators
    import pages
    import regression
    import runs
    import starting
    import sticking
    import streaming
    import trajectories
    import workers

    work: dict[str, Callable[[], list[Row]]] = {
        "links": links.rows,
        "runs": oscillators.run_rows,
        "events": sticking.rows,
        "forces": forces.rows,
        "sweep": oscillators.sweep_rows,
        "starting": starting.rows,
        "pages": pages.rows,
        "regression": regression.rows,
        "matching": trajectories.rows,
        "compiled": compiled.rows,
        "growth": growth.rows,
        "models": runs.rows,
        "dopri5": dopri5.rows,
        "workers": workers.rows,
        "streaming": streaming.rows,
    }
    return work[part]()


def page_table(rows: Sequence[Row], on: dict[str, str]) -> str:
    """The measured part of the page."""
    lines = ["| | measured | bar | | |", "|---|---|---|---|---|"]
    part = ""
    for row in rows:
        if row.part != part:
            lines.append(f"| **{row.part}** | | | | |")
            part = row.part
        lines.append(f"| {row.what} | {row.measured} | {row.wanted} | {row.verdict} | {row.note} |")
    about = "; ".join(f"{name} {value}" for name, value in on.items())
    return "\n".join([f"Measured on: {about}.", "", *lines])


def replaced(page: str, measured: str) -> str:
    """The page with another measured part.

    Raises:
        ValueError: a page without the two marks.
    """
    if BEGIN not in page or END not in page:
        raise ValueError(f"the page lacks the marks {BEGIN} and {END}")
    pattern = re.escape(BEGIN) + ".*?" + re.escape(END)
    return re.sub(pattern, lambda _: f"{BEGIN}\n{measured}\n{END}", page, flags=re.S)


def show(rows: Sequence[Row]) -> None:
    """Print the table."""
    table = Table("", "measured", "bar", "", "")
    for row in rows:
        style = {True: "green", False: "red", None: ""}[row.met]
        table.add_row(
            f"{row.part}: {row.what}", row.measured, row.wanted, row.verdict, row.note, style=style
        )
    Console(width=None if os.isatty(1) else 180).print(table)


def keep(rows: Sequence[Row], on: dict[str, str]) -> None:
    """Write results.json and the table of the page."""
    on = {**on, "date": datetime.date.today().isoformat()}
    results = {"machine": on, "rows": [{**asdict(row), "met": row.met} for row in rows]}
    text = json.dumps(results, indent=1, ensure_ascii=False) + "\n"
    (HERE / "results.json").write_text(text, encoding="utf-8")
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(replaced(page, page_table(rows, on)), encoding="utf-8")


def beside(rows: Sequence[Row], kept: Mapping[str, Any], on: Mapping[str, str]) -> list[Row]:
    """The kept rows with those of the measured parts replaced, or behind them if they are new.

    Raises:
        ValueError: the others were measured on another machine, or with other versions.
    """
    same = {name: value for name, value in kept["machine"].items() if name in on}
    if dict(on) != same:
        raise ValueError(f"the kept rows were measured on {same}, these on {dict(on)}")
    fields = ({k: v for k, v in row.items() if k != "met"} for row in kept["rows"])
    measured = {row.part for row in rows}
    old = [row for row in (Row(**each) for each in fields) if row.part not in measured]
    return [*old, *rows]


def main() -> None:
    """Parse arguments, measure, print, keep."""
    parser = argparse.ArgumentParser(description="Benchmarks of symhyb, as ratios of one run.")
    parser.add_argument("--only", choices=PARTS, action="append", help="a part; may be repeated")
    parser.add_argument("--keep", action="store_true", help="keep what --only measures")
    given = parser.parse_args()
    chosen = given.only
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = folder  # nothing that an earlier run has kept helps
        rows = [row for part in chosen or PARTS for row in measure(part)]
    show(rows)
    if chosen and given.keep:
        rows = beside(rows, json.loads((HERE / "results.json").read_text("utf-8")), machine())
    if given.keep or not chosen:
        keep(rows, machine())


if __name__ == "__main__":
    main()

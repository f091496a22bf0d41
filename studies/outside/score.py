"""Open the seals and score what was claimed.

    python studies/outside/score.py [--seeds 0-9] [--results build/outside/results] [-v]
    python studies/outside/score.py --results build/outside/old build/outside/new

Prints a table a result folder (counts by kind, then totals with 95 % intervals by Wilson) and
writes ``report.md`` and ``rows.json`` beside the results. With two folders only the cases that both
have are scored, and what changed is listed.
"""

import argparse
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
from kinds import TABLE
from outcomes import OUTCOMES, Row, score_case
from shared import seeds_of, unseal

EQUAL = 0.02  # of the range of an unseen recording
KEPT = ("report.md", "rows.json")


def wilson(part: int, whole: int, z: float = 1.96) -> tuple[float, float]:
    """The 95 % interval of a rate by Wilson's score."""
    if not whole:
        return 0.0, 1.0
    rate, spread = part / whole, z * z / whole
    middle = (rate + spread / 2) / (1 + spread)
    half = z * np.sqrt(rate * (1 - rate) / whole + z * z / (4 * whole**2)) / (1 + spread)
    return max(0.0, middle - float(half)), min(1.0, middle + float(half))


def read(build: Path, results: Path, seeds: Sequence[int] | None) -> Iterator[Row]:
    """Rows of all results of some seeds, or of all."""
    for path in sorted(results.glob("*.json")):
        if path.name in KEPT or (seeds is not None and int(path.name[:4]) not in seeds):
            continue
        result = json.loads(path.read_text(encoding="utf-8"))
        yield score_case(path.stem, result, unseal(build / path.stem / "sealed.json"))


def _line(label: str, rows: Sequence[Row]) -> str:
    counts = [sum(row.outcome == outcome for row in rows) for outcome in OUTCOMES]
    return f"| {label} | {len(rows)} | {' | '.join(map(str, counts))} |"


def _totals(label: str, rows: Sequence[Row]) -> str:
    cells = []
    for outcome in OUTCOMES:
        count = sum(row.outcome == outcome for row in rows)
        low, high = wilson(count, len(rows))
        cells.append(f"{count} ({count / len(rows):.0%}, {low:.0%}–{high:.0%})")
    return f"| {label} | {len(rows)} | {' | '.join(cells)} |"


def table(rows: Sequence[Row]) -> str:
    """Counts by kind in the order of the table of kinds, then totals."""
    lines = [f"| kind | cases | {' | '.join(OUTCOMES)} |", "|---" * 7 + "|"]
    lines += [
        _line(f"{kind.name} ({kind.classes[0]})", mine)
        for kind in TABLE
        if (mine := [row for row in rows if row.kind == kind.name])
    ]
    groups = {
        "something acts": [r for r in rows if not r.kind.startswith(("noise ", "law, "))],
        "noise alone": [r for r in rows if r.kind.startswith("noise ")],
        "listed law under such noise": [r for r in rows if r.kind.startswith("law, ")],
        "all": list(rows),
    }
    lines += ["", f"| total | cases | {' | '.join(OUTCOMES)} |", "|---" * 7 + "|"]
    lines += [_totals(label, group) for label, group in groups.items() if group]
    known = [row for row in rows if row.unseen is not None and row.unseen[0] > EQUAL]
    equal = [r for r in known if r.unseen and r.unseen[1] <= EQUAL and r.verdict != "undecided"]
    if known:
        lines += [
            "",
            f"Of {len(known)} cases in which the model misses the unseen recording by more than "
            f"{EQUAL:.0%} of its range in a free run, what is claimed misses it by less in "
            f"{len(equal)}.",
        ]
    spent = [row.cpu for row in rows if row.cpu is not None]
    if spent:
        lines += ["", f"Median time of a diagnosis: {np.median(spent):.1f} s of CPU."]
    return "\n".join(lines) + "\n"


def listing(rows: Sequence[Row]) -> str:
    """Every case with what was said of it."""
    return "".join(
        f"{row.case} {row.kind}: {row.outcome}; {'; '.join(row.wrong) or row.verdict}\n"
        f"    {row.sentence}\n"
        for row in rows
    )


def changes(before: Sequence[Row], after: Sequence[Row]) -> str:
    """Cases whose outcome is another one."""
    new = {row.case: row for row in after}
    return "".join(
        f"{row.case} {row.kind}: {row.outcome} → {new[row.case].outcome}\n"
        for row in before
        if new[row.case].outcome != row.outcome
    )


def main() -> None:
    """Score the results of some folders."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="", help="all that have results, if empty")
    parser.add_argument("-v", "--verbose", action="store_true", help="every case with its sentence")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/outside"))
    parser.add_argument("--results", type=Path, nargs="+", default=[Path("build/outside/results")])
    options = parser.parse_args()
    seeds = seeds_of(options.seeds) if options.seeds else None
    scored = [list(read(options.output, folder, seeds)) for folder in options.results]
    common = set.intersection(*({row.case for row in rows} for rows in scored))
    scored = [[row for row in rows if row.case in common] for rows in scored]
    for folder, rows in zip(options.results, scored, strict=True):
        report = table(rows)
        print(f"{folder}\n\n{report}")
        if options.verbose:
            print(listing(rows))
        (folder / "report.md").write_text(report, encoding="utf-8")
        kept = json.dumps([asdict(row) for row in rows], indent=1)
        (folder / "rows.json").write_text(kept + "\n", encoding="utf-8")
    if len(scored) == 2:
        print(changes(*scored))


if __name__ == "__main__":
    main()

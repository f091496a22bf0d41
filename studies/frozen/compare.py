"""Hold two labelled runs of the frozen set against each other.

    python studies/frozen/compare.py before after

For every part of the set, over the cases that both have: causes named, cases complete, with a wrong
claim, refused, values that are right, and time; then every case whose outcome changed. With one
label alone its own table is printed, and the time of every case.
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median

from cases import listed
from run import BUILD, DRAWN
from scoring import Outcome, outcome

GROUPS = ("concealed", "null", "study", "example", "all")
SLOWER = 1.5  # times as long: reported of a case
SECONDS = 5.0  # and at least so much longer


def outcomes(results: Path, drawn: Path = DRAWN) -> dict[str, Outcome]:
    """The scored cases of a label by name, in the order of the list.

    Raises:
        SystemExit: there are none.
    """
    found = {}
    for case in listed():
        path = results / f"{case.name}.json"
        if path.exists():
            found[case.name] = outcome(case, json.loads(path.read_text("utf-8")), drawn)
    if not found:
        raise SystemExit(f"{results}: holds no results; run.py --label {results.name} makes them")
    return found


def column(rows: Sequence[Outcome]) -> list[str]:
    """The figures of some cases."""
    hidden = [row for row in rows if row.wanted]
    return [
        str(len(rows)),
        _part(sum(row.named for row in rows), sum(row.wanted for row in rows)),
        _part(sum(row.complete for row in rows), len(rows)),
        _part(sum(bool(row.wrong) for row in rows), len(rows)),
        _part(sum(row.refused for row in hidden), len(hidden)),
        _part(sum(row.right for row in rows), sum(row.counted for row in rows)),
        str(sum(row.verdict == "crash" for row in rows)),
        f"{median(row.cpu for row in rows):.1f} s",
        f"{sum(row.cpu for row in rows):.0f} s",
    ]


FIGURES = (
    "cases",
    "named",
    "complete, nothing else",
    "with a wrong claim",
    "refused, of those with something concealed",
    "values right",
    "crashes",
    "time computed, median",
    "time computed, all",
)


def _part(part: int, whole: int) -> str:
    return f"{part} of {whole}" if whole else "–"


def table(labels: Sequence[str], runs: Sequence[Mapping[str, Outcome]]) -> str:
    """The figures of every group, a column a run."""
    lines = []
    for group in GROUPS:
        own = [[row for row in run.values() if group in (row.group, "all")] for run in runs]
        if not own[0]:
            continue
        lines += [f"| {group} | {' | '.join(labels)} |", "|---|" + "---|" * len(labels)]
        for name, *cells in zip(FIGURES, *map(column, own), strict=True):
            lines.append(f"| {name} | {' | '.join(cells)} |")
        lines.append("")
    return "\n".join(lines)


def changes(a: Mapping[str, Outcome], b: Mapping[str, Outcome]) -> list[str]:
    """Every case whose outcome differs, in words."""
    lines = []
    for name in a:
        if name in b and a[name].essence != b[name].essence:
            lines += [f"- {name}", f"    was: {a[name].words}", f"    is:  {b[name].words}"]
    return lines


def slower(a: Mapping[str, Outcome], b: Mapping[str, Outcome]) -> list[str]:
    """Every case that takes much longer."""
    return [
        f"- {name}: {a[name].cpu:.1f} s, now {b[name].cpu:.1f} s"
        for name in a
        if name in b and b[name].cpu > max(SLOWER * a[name].cpu, a[name].cpu + SECONDS)
    ]


def report(labels: Sequence[str], runs: Sequence[Mapping[str, Outcome]]) -> str:
    """All that is printed."""
    heads = [
        f"{label}: commit {', '.join(sorted({row.commit for row in run.values()}))}"
        for label, run in zip(labels, runs, strict=True)
    ]
    if len(runs) == 1:
        lines = [f"| {row.case} | {row.cpu:.1f} s | {row.words} |" for row in runs[0].values()]
        each = ["| case | time | outcome |", "|---|---|---|", *lines]
        return "\n".join([*heads, "", table(labels, runs), *each])
    common = [name for name in runs[0] if name in runs[1]]
    if not common:
        raise SystemExit("the two labels have no case in common")
    shared = [{name: run[name] for name in common} for run in runs]
    changed, late = changes(*shared), slower(*shared)
    only = [
        f"only in {label}: {', '.join(sorted(set(run) - set(common)))}"
        for label, run in zip(labels, runs, strict=True)
        if set(run) - set(common)
    ]
    return "\n".join(
        [
            *heads,
            "",
            table(labels, shared),
            f"Changed outcomes: {len(changed) // 3} of {len(common)}",
            *changed,
            f"\nMuch slower: {len(late)}",
            *late,
            *only,
        ]
    )


def main() -> None:
    """Compare two labels, or print one."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("labels", nargs="+", metavar="LABEL", help="one or two of run.py --label")
    options = parser.parse_args()
    if len(options.labels) > 2:
        parser.error("one or two labels can be compared")
    print(report(options.labels, [outcomes(BUILD / label) for label in options.labels]))


if __name__ == "__main__":
    main()

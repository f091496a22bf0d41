"""docs/recordings.md, made from what the studies of real recordings gave.

python studies/recordings/page.py --run emps bowling_ball   # run these (or all), keep the results
python studies/recordings/page.py --docs                    # write the page from what is kept
"""

import argparse
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from kept import RESULTS, STUDIES, Case, cases, keep
from picture import draw
from words import about, knows, numbers, own_scores, reported, rivals, score_rows, short

from symhyb.study.run import run_study

DOCS = STUDIES.parent / "docs"
PAGE = DOCS / "recordings.md"
LARGEST = 60_000  # bytes of a picture
HEAD = """\
# Real recordings

Recordings that others made and published, models from which what is known was left out, and what
symhyb says of them. This page is made by `studies/recordings/page.py` from what
[`symhyb run`](study.md) gave, kept in `studies/recordings/results`; nothing on it is typed by hand.
What is published comes from `expected.json` of each study and is shown beside what was found; no
diagnosis sees it. The unseen recordings choose nothing.

- ± is one standard deviation. A difference is to the published value, in percent and in standard
  deviations of what was found and, where it is known, of what is published.
- Errors are those of the unseen recordings, in the unit of the sensor: windows with fitted initial
  states, and free runs over the whole recording. Before is the model as given, after the model with
  what was found.
- Times are of the processors, on a machine with two cores, and on the clock. With other processes
  beside it both are longer than alone.
- The [free falls of a servo](../studies/servo_pendulums/README.md), each with a known weight of its
  own, have a page of their own. They are development data, also for numbers shared within groups.
"""


def page_text(found: Sequence[Case], docs: Path = DOCS) -> str:
    """The whole page."""
    rows = [_row(case) for case in found]
    top = ["| study | verdict | found | published | windows of the unseen recording | time |"]
    top += ["|---|---|---|---|---|---|", *rows]
    parts = [HEAD, "\n".join(top), *(_section(case, docs) for case in found)]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def _row(case: Case) -> str:
    link = f"[{case.name}](#{_anchor(case)})"
    if case.kept is None:
        return f"| {link} | not run | | | | |"
    rows = [row for row in score_rows(case) if row.kind == "window"]
    errors = "; ".join(
        f"{row.sensor} {short(row.before, row.unit)} → {short(row.after, row.unit)}" for row in rows
    )
    table = list(numbers(case))
    table = [(name.split(" (")[0], *rest) for name, *rest in table if "@" not in name]
    ours = ", ".join(f"{name} {amount}" for name, amount, _, _ in table if amount)
    theirs = ", ".join(f"{name} {amount}" for name, _, amount, _ in table if amount)
    said = (case.kept["verdict"], ours, theirs, errors, _time(case.kept))
    return f"| {link} | " + " | ".join(said) + " |"


def _section(case: Case, docs: Path) -> str:
    parts = [f"## {case.study.title or case.name}", f"{about(case)}{_readme(case)}"]
    facts = [f"- **The model knows:** {knows(case)}"]
    if case.kept is None:
        return "\n\n".join([*parts, *facts, "Not run."])
    facts += [f"- **{role}:** {text}" for role, text in reported(case)]
    facts.append(f"- **symhyb says:** *{case.kept['verdict']}*. {case.kept['sentence']}")
    if rivals(case.kept):
        facts.append(f"- **Not ruled out:** {rivals(case.kept)}.")
    if case.expected.published:
        says = case.expected.published.says
        source = case.expected.published.source.rstrip(".")
        facts.append(f"- **Published:** {says + '; ' if says else ''}{source}.")
    facts.append(f"- **Time:** {_time(case.kept)}. {_checks(case.kept)}")
    if case.stale:
        facts.append(
            "- **Older than its study file or model:** these have changed since it was run."
        )
    parts += ["\n".join(facts), *_tables(case)]
    if own_scores(case):
        parts.append(own_scores(case))
    picture = docs / f"recordings-{case.name}.png"
    if picture.is_file():
        parts.append(f"![{case.name}: what the model lacks, and a free run]({picture.name})")
    return "\n\n".join(parts)


def _readme(case: Case) -> str:
    """A link to the page of the study, in its folder or around it."""
    for folder in case.file.parents:
        if folder == STUDIES or not folder.is_relative_to(STUDIES):
            break
        if (folder / "README.md").is_file():
            there = folder.relative_to(STUDIES.parent).as_posix()
            return f" More in [its README](../{there}/README.md)."
    return ""


def _time(kept: Mapping[str, Any]) -> str:
    busy = f", while {kept['load']:.0f} other processes ran" if (kept["load"] or 0) >= 0.5 else ""
    cpu, clock = kept["cpu_seconds"], kept["seconds"]
    return f"{cpu:.0f} s of processors, {clock:.0f} s on the clock{busy}"


def _checks(kept: Mapping[str, Any]) -> str:
    checks = kept["checks"]
    failed = [one for one in checks if not one["passed"]]
    if not checks:
        return "Nothing is expected."
    if not failed:
        return f"All {len(checks)} expectations are met."
    missed = "; ".join(f"{x['subject']}: {x['got']}, expected {x['wanted']}" for x in failed)
    return f"**{len(failed)} of {len(checks)} expectations are not met:** {missed}."


def _tables(case: Case) -> Iterator[str]:
    table = list(numbers(case))
    if table:
        head = ["| value | found | published | difference |", "|---|---|---|---|"]
        rows = [f"| {' | '.join(x or '–' for x in row)} |" for row in table]
        yield "\n".join([*head, *rows])
    scores = score_rows(case)
    if scores:
        head = [
            "| error on the unseen recordings | before | after | published |",
            "|---|---|---|---|",
        ]
        rows = [
            f"| {row.words} | {short(row.before, row.unit)} | {short(row.after, row.unit)} "
            f"| {row.published or '–'} |"
            for row in scores
        ]
        yield "\n".join([*head, *rows])


def _anchor(case: Case) -> str:
    title = (case.study.title or case.name).lower()
    return "".join(x for x in title if x.isalnum() or x in "-_ ").replace(" ", "-")


def run(case: Case, results: Path = RESULTS, docs: Path = DOCS) -> None:
    """Run a study, keep what it gave and draw its picture."""
    with TemporaryDirectory() as folder:
        begin, load = time.process_time(), os.getloadavg()[0]
        result = run_study(case.file, folder)
        cpu = time.process_time() - begin
    keep(case.name, result, cpu, load, results)
    draw(result, docs / f"recordings-{case.name}.png")


def main() -> None:
    """Run studies, write the page, or both."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--run", nargs="*", metavar="NAME", help="studies to run; none: all")
    parser.add_argument("--docs", action="store_true", help="write docs/recordings.md")
    options = parser.parse_args()
    known = {case.name: case for case in cases()}
    wanted = [] if options.run is None else options.run or list(known)
    unknown = [name for name in wanted if name not in known]
    if unknown:
        raise SystemExit(f"no study of a real recording: {', '.join(unknown)}; {', '.join(known)}")
    for name in wanted:
        print(f"running {name}", file=sys.stderr)
        run(known[name])
    if options.docs:
        PAGE.write_text(page_text(cases()), encoding="utf-8")


if __name__ == "__main__":
    main()

"""Tables of scored cases in Markdown: by properties of the cases, by size, of the peers."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from bars import bound, median_time
from claims import Row
from plans import size_of

SIZES = ("1", "2–3", "4–6")
EDGES = (0.0, 0.003, 0.01, 0.03, 0.1, 0.3, np.inf)
BINS = ("below 0.3 %", "0.3 to 1 %", "1 to 3 %", "3 to 10 %", "10 to 30 %", "above 30 %")
WORDLESS = ("mlp",)  # peers that claim nothing
Key = Callable[[Row], Any]


def header(*names: str) -> str:
    """The first two lines of a table."""
    return f"| {' | '.join(names)} |\n|{'---|' * len(names)}"


def percent(part: float, whole: float) -> str:
    """A share in per cent, or a dash of nothing."""
    return f"{100 * part / whole:.0f} %" if whole else "–"


def seconds(value: float) -> str:
    """A time in s with two digits."""
    return f"{value:.0f}" if value >= 9.95 else f"{value:.2g}"


def table(rows: Sequence[Row], title: str, key: Key) -> str:
    """One line for every value of ``key``; a value that is a pair sorts by its first part."""
    lines = [
        header(
            title,
            "cases",
            "place",
            "name",
            "complete",
            "wrong claims",
            "refused",
            "±2 sd",
            "unseen error",
            "time s",
        ),
    ]
    for value in sorted({key(row) for row in rows}):
        words = value[1] if isinstance(value, tuple) else value
        lines.append(f"| {words} | " + _line([row for row in rows if key(row) == value]))
    lines.append("| all | " + _line(rows))
    return "\n".join(lines)


def _line(rows: Sequence[Row]) -> str:
    wanted = sum(row.wanted for row in rows)
    counted = sum(row.counted for row in rows)
    errors = [row.error for row in rows if row.error is not None and np.isfinite(row.error)]
    cells = [
        str(len(rows)),
        percent(sum(row.place for row in rows), wanted),
        percent(sum(row.name for row in rows), wanted),
        percent(sum(row.structure for row in rows), len(rows)),
        percent(sum(bool(row.wrong) for row in rows), len(rows)),
        percent(sum(row.refused for row in rows), len(rows)),
        percent(sum(row.covered for row in rows), counted),
        f"{np.median(errors):.3f}" if errors else "–",
        _times(rows),
    ]
    return " | ".join(cells) + " |"


def _times(rows: Sequence[Row]) -> str:
    """Median seconds on the clock, and computed where they were kept."""
    if not rows:
        return "–"
    wall, (spent, sort) = np.median([row.seconds for row in rows]), median_time(rows)
    return f"{seconds(spent)} ({seconds(wall)})" if sort == "CPU" else f"({seconds(wall)})"


def by_size(row: Row) -> tuple[int, str]:
    """The class of coordinates of a case."""
    return size_of(row.coordinates), SIZES[size_of(row.coordinates)]


def by_noise(row: Row) -> tuple[float, str]:
    """The noise level of a case."""
    return row.noise, f"{100 * row.noise:g} %"


def by_sensing(row: Row) -> str:
    """What is sensed."""
    if "-rig" in row.case:
        return "force cell"
    return "positions and rates" if row.rates else "positions"


def by_hardship(row: Row) -> str:
    """What makes the recordings of a case harder."""
    return row.hardship or "none"


def by_system(row: Row) -> tuple[int, str]:
    """The machine of a case."""
    return row.coordinates, row.case.split("-", 1)[1]


def detection(rows: Sequence[Row], peers: Mapping[str, Sequence[Row]]) -> str:
    """Of the concealed forces of a size, how many were found, by whom."""
    names = [f"named by {name}" for name in peers]
    lines = [header("share of the known force", "forces", "found something there", "named", *names)]
    for low, high, words in zip(EDGES, EDGES[1:], BINS, strict=False):
        counts = []
        for own in (rows, *peers.values()):
            hits = [
                hit
                for row in own
                for share, hit in zip(row.shares, row.hits, strict=True)
                if share is not None and low <= share < high
            ]
            counts.append(hits)
        ours, whole = counts[0], len(counts[0])
        if whole:
            cells = [percent(sum(h > 0 for h in ours), whole)]
            cells += [percent(sum(h == 2 for h in hits), whole) for hits in counts]
            lines.append(f"| {words} | {whole} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def refusals(rows: Sequence[Row]) -> str:
    """How misses end: nothing was claimed, another cause was named alone, or a claim was wrong."""
    missed = [row for row in rows if row.name < row.wanted]
    refused, wrong = sum(row.refused for row in missed), sum(bool(row.wrong) for row in missed)
    return (
        f"Of {len(missed)} cases in which a concealed cause was not named {refused} were refused, "
        f"{len(missed) - refused - wrong} named another concealed cause and nothing else, and "
        f"{wrong} had a wrong claim."
    )


def hard(rows: Sequence[Row]) -> str:
    """What became of incomplete draws: to refuse them is right, to name them is better."""
    wrong = sum(bool(row.wrong) for row in rows)
    refused = sum(row.refused for row in rows)
    return (
        f"Of {len(rows)} draws that are not complete and may be refused {refused} were refused, "
        f"{wrong} had a wrong claim, and in {len(rows) - refused - wrong} some or all "
        f"of what is concealed was named and nothing else; {sum(row.structure for row in rows)} "
        "were complete."
    )


def nothing(rows: Sequence[Row]) -> str:
    """Wrong claims where nothing is concealed, with the exact bound of their rate."""
    lines = [header("noise", "cases", "with a wrong claim", "at most (95 %)", "verdicts")]
    for kind in (*sorted({row.kind for row in rows}), "all"):
        own = [row for row in rows if kind in (row.kind, "all")]
        wrong = sum(bool(row.wrong) for row in own)
        said = sorted({row.verdict for row in own})
        verdicts = ", ".join(f"{v} {sum(row.verdict == v for row in own)}" for v in said)
        lines.append(
            f"| {kind} | {len(own)} | {wrong} | {100 * bound(wrong, len(own)):.1f} % | {verdicts} |"
        )
    return "\n".join(lines)


def against(rows: Sequence[Row], peers: Mapping[str, Sequence[Row]]) -> str:
    """Everybody on the same cases, then who names which kind and at which noise."""
    everybody = {"symhyb": rows, **peers}
    lines = [
        header(
            "",
            "place",
            "name",
            "complete",
            "wrong claims",
            "misses refused",
            "±2 sd",
            "wrong on null cases",
            "unseen force error",
            "time s",
        ),
    ]
    for name, own in everybody.items():
        lines.append(f"| {name} | " + _everything(own, words=name not in WORDLESS))
    talking = {k: own for k, own in everybody.items() if k not in WORDLESS}
    for title, key in (("kind", lambda row: row.kind), ("noise", by_noise)):
        lines += ["", header(f"named, by {title}", "causes", *talking)]
        hidden = [row for row in rows if row.wanted]
        for value in sorted({key(row) for row in hidden}):
            mine = {
                k: [row for row in own if row.wanted and key(row) == value]
                for k, own in talking.items()
            }
            causes = sum(row.wanted for row in mine["symhyb"])
            cells = [percent(sum(row.name for row in own), causes) for own in mine.values()]
            words = value[1] if isinstance(value, tuple) else value
            lines.append(f"| {words} | {causes} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _everything(rows: Sequence[Row], words: bool) -> str:
    hidden, nulls = ([row for row in rows if bool(row.wanted) is sort] for sort in (True, False))
    wanted, counted = sum(row.wanted for row in hidden), sum(row.counted for row in hidden)
    missed = [row for row in hidden if row.name < row.wanted]
    wrong = sum(bool(row.wrong) for row in nulls)
    fits = [row.fit for row in hidden if row.fit is not None]
    reported = [
        percent(sum(row.place for row in hidden), wanted),
        percent(sum(row.name for row in hidden), wanted),
        percent(sum(row.structure for row in hidden), len(hidden)),
        percent(sum(bool(row.wrong) for row in hidden), len(hidden)),
        percent(sum(row.refused for row in missed), len(missed)),
        percent(sum(row.covered for row in hidden), counted),
        f"{wrong} of {len(nulls)}",
    ]
    fit = f"{np.median(fits):.2f}" if fits else "–"
    time = seconds(median_time(rows)[0]) if rows else "–"
    return " | ".join([*(reported if words else ["–"] * len(reported)), fit, time]) + " |"

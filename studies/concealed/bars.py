"""The bars that the bench is held against, and the statistics they need."""

from collections.abc import Sequence

import numpy as np
from claims import Row
from plans import size_of
from scipy.stats import beta

LIMITS_S = (15.0, 45.0, 180.0)  # median seconds for one, two or three, four to six coordinates
SIZES = ("one coordinate", "two or three", "four to six")


def bound(count: int, whole: int) -> float:
    """The largest rate at which ``count`` or fewer of ``whole`` still have a probability of 5 %:
    the exact one-sided bound of Clopper and Pearson."""
    return 1.0 if count >= whole else float(beta.ppf(0.95, count + 1, whole - count))


def median_time(rows: Sequence[Row]) -> tuple[float, str]:
    """The median time in s, computed where every row knows it, else on the clock; and which."""
    spent = [row.cpu for row in rows if row.cpu is not None]
    if len(spent) == len(rows):
        return float(np.median(spent)), "CPU"
    return float(np.median([row.seconds for row in rows])), "clock"


def _share(label: str, part: int, whole: int, least: float) -> str:
    if not whole:
        return f"| {label} | ≥ {least:.0%} | – | not measured |"
    reached = part / whole
    return (
        f"| {label} | ≥ {least:.0%} | {reached:.1%} ({part} of {whole}) | "
        f"{'pass' if reached >= least else 'fail'} |"
    )


def bars(rows: Sequence[Row]) -> str:
    """Every bar with what was measured, pass or fail."""
    hidden = [row for row in rows if row.wanted]
    one, five = ([row for row in hidden if row.noise == x] for x in (0.01, 0.05))
    wanted = sum(row.wanted for row in one)
    missed = [row for row in hidden if row.name < row.wanted]
    lines = [
        "| bar | asked for | measured | |",
        "|---|---|---|---|",
        _share("place, 1 % noise", sum(row.place for row in one), wanted, 0.98),
        _share("name, 1 % noise", sum(row.name for row in one), wanted, 0.95),
        _share(
            "complete structure, no wrong claim, 1 % noise",
            sum(row.structure for row in one),
            len(one),
            0.9,
        ),
        _share(
            "±2 sd, 1 % noise",
            sum(row.covered for row in one),
            sum(row.counted for row in one),
            0.9,
        ),
        _unseen(one),
        _share(
            "name, 5 % noise", sum(row.name for row in five), sum(row.wanted for row in five), 0.85
        ),
        _share(
            "a miss is a refusal, all noise", sum(row.refused for row in missed), len(missed), 0.8
        ),
        _quiet([row for row in rows if not row.wanted]),
    ]
    for size, (words, most) in enumerate(zip(SIZES, LIMITS_S, strict=True)):
        own = [row for row in rows if size_of(row.coordinates) == size]
        lines.append(_fast(words, own, most))
    return "\n".join(lines)


def _unseen(rows: Sequence[Row]) -> str:
    label = "unseen error over the oracle's, median, 1 % noise"
    errors = np.array([row.error for row in rows if row.error is not None])
    if not errors.size:
        return f"| {label} | ≤ 1.1 | – | not measured |"
    middle = float(np.median(errors))
    return (
        f"| {label} | ≤ 1.1 | {middle:.3f} ({int(np.sum(errors <= 1.1))} of {errors.size} within) "
        f"| {'pass' if middle <= 1.1 else 'fail'} |"
    )


def _quiet(nulls: Sequence[Row]) -> str:
    """The rate itself has to be at most 1 %; the bound says what the number of cases supports."""
    label = "wrong claims on null cases, all noise"
    if not nulls:
        return f"| {label} | ≤ 1 % | – | not measured |"
    wrong = sum(bool(row.wrong) for row in nulls)
    passed = "pass" if wrong <= 0.01 * len(nulls) else "fail"
    if len(nulls) < 300:
        passed = "too few cases" if passed == "pass" else passed
    return (
        f"| {label} | ≤ 1 % of at least 300 | {wrong} of {len(nulls)}, at most "
        f"{bound(wrong, len(nulls)):.1%} (95 %) | {passed} |"
    )


def _fast(words: str, rows: Sequence[Row], most: float) -> str:
    if not rows:
        return f"| median time, {words} | ≤ {most:g} s | – | not measured |"
    middle, sort = median_time(rows)
    return (
        f"| median time, {words} | ≤ {most:g} s | {middle:.1f} s ({sort}) | "
        f"{'pass' if middle <= most else 'fail'} |"
    )

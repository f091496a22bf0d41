"""The score of one method on one case, the same for both benches, and the table of all of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from benches import bound

OUTCOMES = ("right", "in part", "wrong", "refused", "false nothing", "failed")
EQUAL = 0.02  # of the range of an unseen recording
GROUPS = ("something acts", "nothing acts")


@dataclass(frozen=True, slots=True)
class Line:
    """One method on one case.

    ``wanted`` causes act; of them ``placed`` and ``named`` were found; ``complete``: all of them
    with all their numbers and nothing else. Of ``counted`` values of named causes ``covered`` are
    within 2 of their sd. ``stated``: pairs of a stated probability and whether it was right.
    ``unseen``: by what share of its range the worst sensor of the unseen recording is missed in a
    free run, by the model and by the corrected one (None: it ran away); None without a corrected
    model. ``reason`` says why a case failed, ``wrong`` what was wrongly claimed."""

    case: str
    kind: str
    outcome: str
    wanted: int
    placed: int = 0
    named: int = 0
    complete: bool = False
    wrong: tuple[str, ...] = ()
    covered: int = 0
    counted: int = 0
    stated: tuple[tuple[float, bool], ...] = ()
    unseen: tuple[float | None, float | None] | None = None
    seconds: float = 0.0
    cpu: float = 0.0
    reason: str = ""


def table(lines: Mapping[str, Sequence[Line]], wordless: Sequence[str] = ()) -> str:
    """One row a method: outcomes where something acts and where nothing does, then numbers.

    In brackets stands how large the rate of wrong answers may be, the exact one-sided 95 % bound
    of Clopper and Pearson."""
    head = [
        *("method", "cases", *OUTCOMES, "place", "name", "±2 sd", "said probable, were right"),
        *(f"unseen within {EQUAL:.0%}", "worse than the model", "processor s"),
    ]
    parts = []
    for group in GROUPS:
        mine = {
            name: [one for one in own if bool(one.wanted) == (group == GROUPS[0])]
            for name, own in lines.items()
        }
        if not any(mine.values()):
            continue
        rows = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
        rows += [_row(name, own, name not in wordless) for name, own in mine.items() if own]
        parts += [f"**{group.capitalize()}**", "", *rows, ""]
    return "\n".join(parts)


def _row(name: str, lines: Sequence[Line], words: bool) -> str:
    counts = [sum(one.outcome == outcome for one in lines) for outcome in OUTCOMES]
    cells = [str(count) for count in counts]
    wrong = OUTCOMES.index("wrong")
    cells[wrong] += f" (≤ {bound(counts[wrong], len(lines)):.0%})"
    wanted = sum(one.wanted for one in lines)
    claims = [
        _share(sum(one.placed for one in lines), wanted),
        _share(sum(one.named for one in lines), wanted),
        _share(sum(one.covered for one in lines), sum(one.counted for one in lines)),
        _reliability(lines),
    ]
    if not words:
        cells = ["–"] * (len(OUTCOMES) - 1) + cells[-1:]
        claims = ["–"] * len(claims)
    spent = f"{np.median([one.cpu for one in lines]):.2g}" if lines else "–"
    return f"| {' | '.join([name, str(len(lines)), *cells, *claims, *_unseen(lines), spent])} |"


def _share(part: int, whole: int) -> str:
    return f"{part} of {whole}" if whole else "–"


def _reliability(lines: Sequence[Line]) -> str:
    """The mean of stated probabilities, and the share of these statements that is right."""
    stated = [pair for one in lines for pair in one.stated]
    if not stated:
        return "–"
    said, right = np.mean([p for p, _ in stated]), np.mean([true for _, true in stated])
    return f"{said:.0%}, {right:.0%} ({len(stated)})"


def _unseen(lines: Sequence[Line]) -> list[str]:
    """Of the cases that the model misses by more: how many the corrected model does not; and in
    how many of all it is worse than the model, or runs away."""
    known = [one.unseen for one in lines if one.unseen is not None]
    missed = [after for before, after in known if before is None or before > EQUAL]
    within = sum(after is not None and after <= EQUAL for after in missed)
    worse = sum(
        before is not None and (after is None or after > before * (1 + 1e-9))
        for before, after in known
    )
    return [_share(within, len(missed)), _share(worse, len(known))]

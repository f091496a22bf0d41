"""The bench of concealed effects, as the board sees it."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from benches import Drawn
from claims import Row, score_case
from draw import write
from lines import Line
from plans import plan_of

BUILD = Path("build/concealed")
SEEDS = 3300, 9999  # from which fresh ones are drawn; 10000 on are those of the arm


def drawn(seeds: Sequence[int], kinds: str, build: Path) -> Iterator[Drawn]:
    """The cases of seeds, drawn where they are not there; ``kinds`` are beginnings of kinds."""
    wanted = tuple(kinds.split(",")) if kinds else ("",)
    for seed in seeds:
        if plan_of(seed).kind.startswith(wanted):
            folder = write(seed, build)
            if folder is not None:
                yield Drawn(folder.name, folder)


def line(case: Drawn, result: dict[str, Any], sealed: dict[str, Any]) -> Line:
    """The score of one answer."""
    row = score_case(case.name, result, sealed, plan_of(int(case.name.split("-", 1)[0])).system.n)
    return Line(
        case.name,
        row.kind,
        _outcome(row),
        row.wanted,
        row.place,
        row.name,
        row.structure,
        row.wrong,
        row.covered,
        row.counted,
        _stated(result.get("diagnosis", {}), row),
        reason=row.failed,
    )


def _outcome(row: Row) -> str:
    if row.verdict in ("crash", "refused") and row.failed:
        return "failed"
    if row.wrong:
        return "wrong"
    if row.name == row.wanted:
        return "right"  # with nothing concealed: nothing was claimed
    if row.name:
        return "in part"
    return "false nothing" if row.verdict == "nothing missing" else "refused"


def _stated(said: dict[str, Any], row: Row) -> tuple[tuple[float, bool], ...]:
    """Stated probabilities of claimed forces, and whether each claim is right."""
    pairs = []
    for one in said.get("found", ()):
        if "probability" in one:
            ((_, names),) = one["place"].items()
            where = names if isinstance(names, str) else "-".join(names)
            wrong = any(w.startswith(one["kind"]) and w.endswith(f"@ {where}") for w in row.wrong)
            pairs.append((one["probability"], not wrong))
    return tuple(pairs)

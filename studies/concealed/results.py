"""Scored cases as a small file: one line a case, so that a report needs neither cases nor seals."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from claims import Row

HERE = Path(__file__).resolve().parent / "results"
COLUMNS = (
    "case",
    "kind",
    "noise",
    "coordinates",
    "rates",
    "verdict",
    "shares",
    "hits",
    "twins",
    "structure",
    "wrong",
    "missed",
    "covered",
    "counted",
    "error",
    "seconds",
    "cpu",
    "fit",
    "failed",
    "may_refuse",
    "hardship",
)
OF_PEER = ("hits", "twins", "structure", "wrong", "covered", "counted", "cpu", "fit")
DIGITS = {"error": 4, "seconds": 3, "cpu": 3, "fit": 3}


@dataclass(frozen=True, slots=True)
class Scored:
    """The scores of a range of ``seeds``: rows of symhyb, and of every peer in the same order.

    ``about``: symhyb's version and commits, settings of the peers. ``discarded`` draws in all,
    ``given_up`` seeds without a complete draw."""

    seeds: str
    rows: tuple[Row, ...]
    peers: Mapping[str, tuple[Row, ...]] = field(default_factory=dict)
    discarded: int = 0
    given_up: int = 0
    about: Mapping[str, Any] = field(default_factory=dict)


def _line(row: Row, columns: Sequence[str]) -> list[Any]:
    line = []
    for name in columns:
        value = getattr(row, name)
        if name == "wrong" and columns is OF_PEER:
            value = len(value)
        if name == "shares":
            value = [None if x is None else float(f"{x:.3g}") for x in value]
        if isinstance(value, float) and name in DIGITS:
            value = float(f"{value:.{DIGITS[name]}g}")
        line.append(int(value) if isinstance(value, bool) else value)
    return line


def write(path: Path, scored: Scored) -> None:
    """Write scored cases: a head, then one line a case with the peers' lines at its end."""
    head = {
        "seeds": scored.seeds,
        **scored.about,
        "discarded": scored.discarded,
        "given_up": scored.given_up,
        "columns": COLUMNS,
        "columns_of_peers": OF_PEER,
        "peers": list(scored.peers),
    }
    lines = []
    for i, row in enumerate(scored.rows):
        others = [_line(rows[i], OF_PEER) for rows in scored.peers.values()]
        lines.append(json.dumps([*_line(row, COLUMNS), *others], separators=(",", ":")))
    text = json.dumps(head, indent=1).rstrip("}\n") + ',\n "cases": [\n'
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text + ",\n".join(lines) + "\n]}\n", encoding="utf-8")


def read(path: Path) -> Scored:
    """Read what :func:`write` wrote; columns that an older file has not are at their defaults."""
    whole = json.loads(path.read_text(encoding="utf-8"))
    rows, peers = [], {name: [] for name in whole["peers"]}  # type: ignore[var-annotated]
    columns = whole["columns"]
    for line in whole["cases"]:
        row = _row(dict(zip(columns, line, strict=False)))
        rows.append(row)
        for name, part in zip(peers, line[len(columns) :], strict=True):
            peers[name].append(_of_peer(row, dict(zip(OF_PEER, part, strict=True))))
    known = {"seeds", "discarded", "given_up", "columns", "columns_of_peers", "peers", "cases"}
    return Scored(
        whole["seeds"],
        tuple(rows),
        {name: tuple(own) for name, own in peers.items()},
        whole["discarded"],
        whole["given_up"],
        {key: value for key, value in whole.items() if key not in known},
    )


def _row(said: dict[str, Any]) -> Row:
    hits, shares = tuple(said.pop("hits")), tuple(said.pop("shares"))
    forces = [x for x in shares if x is not None]
    words = {key: tuple(said.pop(key)) for key in ("wrong", "missed")}
    flags = {key: bool(said.pop(key, False)) for key in ("rates", "structure", "may_refuse")}
    return Row(
        **said,
        **words,
        **flags,
        hits=hits,
        shares=shares,
        wanted=len(hits),
        share=min(forces) if forces else None,
        place=sum(h > 0 for h in hits),
        name=sum(h == 2 for h in hits),
    )


def _of_peer(row: Row, said: dict[str, Any]) -> Row:
    hits = tuple(said["hits"])
    wrong = ("?",) * said["wrong"]
    return replace(
        row,
        hits=hits,
        twins=said["twins"],
        structure=bool(said["structure"]),
        wrong=wrong,
        covered=said["covered"],
        counted=said["counted"],
        cpu=said["cpu"],
        fit=said["fit"],
        seconds=said["cpu"],
        error=None,
        failed="",
        missed=(),
        verdict="",
        place=sum(h > 0 for h in hits),
        name=sum(h == 2 for h in hits),
    )

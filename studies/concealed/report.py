"""Tables of scored cases in Markdown, and the section of docs/concealed.md that holds them.

python studies/concealed/report.py --docs     # rewrite the section from results/*.json
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from bars import bars
from claims import Row
from results import HERE, Scored, read
from tables import (
    WORDLESS,
    Key,
    against,
    by_hardship,
    by_noise,
    by_sensing,
    by_size,
    by_system,
    detection,
    hard,
    header,
    nothing,
    refusals,
    table,
)

DOCS = Path(__file__).resolve().parents[2] / "docs" / "concealed.md"
BEGIN, END = "<!-- results: written by report.py -->", "<!-- end of results -->"
SETS = (
    ("latest", "Seeds that were never used before, by the latest state that was frozen"),
    ("report", "Seeds that were never used before, by a state before"),
    ("development", "Development seeds"),
)


def section(scored: Scored, level: str = "###") -> str:
    """All tables of a set of cases; incomplete draws stand apart."""
    spared = [row for row in scored.rows if row.may_refuse]
    scored = _judged(scored)
    nulls = [row for row in scored.rows if not row.wanted]
    hidden = [row for row in scored.rows if row.wanted]
    about = scored.about
    text = [
        f"Seeds {scored.seeds}; symhyb {', '.join(about.get('symhyb', ['?']))}, commit "
        f"{', '.join(about.get('commits', ['?']))}. {len(hidden)} cases with something concealed, "
        f"{len(nulls)} with nothing; {scored.discarded} draws discarded, {scored.given_up} seeds "
        f"without a complete draw. {sum(row.verdict == 'crash' for row in scored.rows)} crashes. "
        "Times are medians: computed, and on the clock in brackets."
    ]
    if scored.rows:
        text += [f"{level} The bars", bars(scored.rows)]
    if hidden:
        text += [f"{level} Something concealed", *_concealed(hidden)]
        text += [f"{level} Detection against size", detection(hidden, {})]
    if spared:
        text += [f"{level} What may be refused", hard(spared)]
        text.append(table(spared, "kind", lambda row: row.kind))
    if nulls:
        text += [f"{level} Nothing concealed", nothing(nulls)]
        systems = {name: 0 for _, name in sorted({by_system(row) for row in nulls})}
        for row in nulls:
            systems[by_system(row)[1]] += 1
        text.append("By system: " + ", ".join(f"{k} {v}" for k, v in systems.items()) + ".")
    if scored.peers:
        text += [f"{level} Peers on the same cases", *_peers(scored, hidden)]
    return "\n\n".join(text) + "\n"


def _judged(scored: Scored) -> Scored:
    """The scores without the cases that may be refused."""
    peers = {
        name: tuple(row for row in rows if not row.may_refuse)
        for name, rows in scored.peers.items()
    }
    return replace(scored, rows=tuple(r for r in scored.rows if not r.may_refuse), peers=peers)


def _concealed(hidden: Sequence[Row]) -> list[str]:
    keys: tuple[tuple[str, Key], ...] = (
        ("kind", lambda row: row.kind),
        ("noise", by_noise),
        ("coordinates", by_size),
        ("sensing", by_sensing),
        ("system", by_system),
    )
    if any(row.hardship for row in hidden):
        keys = (("harder by", by_hardship), *keys)
    return [refusals(hidden), *(table(hidden, title, key) for title, key in keys)]


def _peers(scored: Scored, hidden: Sequence[Row]) -> list[str]:
    talking = {
        name: [row for row in rows if row.wanted]
        for name, rows in scored.peers.items()
        if name not in WORDLESS
    }
    chosen = "; ".join(f"{k}: `{v}`" for k, v in scored.about.get("settings", {}).items())
    return [f"Settings: {chosen}.", against(scored.rows, scored.peers), detection(hidden, talking)]


def docs_text(folder: Path = HERE) -> str:
    """The section between the marks: one part for each set of seeds that was scored."""
    parts = []
    for name, title in SETS:
        path = folder / f"{name}.json"
        said = section(read(path), "####") if path.exists() else "Not run yet.\n"
        parts.append(f"### {title}\n\n{said}")
    if (folder / "peers.json").exists():
        parts.append("### How the peers were tuned\n\n" + _tuning(folder / "peers.json"))
    return "\n".join(parts)


def _tuning(path: Path) -> str:
    tuned = json.loads(path.read_text(encoding="utf-8"))
    lines = [
        f"On {tuned['cases']} drawn cases of the development seeds {tuned['seeds']}, "
        f"{tuned['tried']} settings.",
        "",
        header("peer", "chosen setting", "F1", "named", "wrong on null cases"),
    ]
    for name, row in tuned["chosen"].items():
        f1 = f"{row['f1']:.2f}" if row["f1"] is not None else "–"
        lines.append(f"| {name} | `{row['setting']}` | {f1} | {row['named']} | {row['nulls']} |")
    return "\n".join(lines) + "\n"


def between_marks(page: str, text: str) -> str:
    """The page with the text between the marks."""
    head, _, rest = page.partition(BEGIN)
    _, mark, tail = rest.partition(END)
    if not mark:
        raise SystemExit(f"the page has no marks '{BEGIN}' and '{END}'")
    return f"{head}{BEGIN}\n\n{text}\n{END}{tail}"


def main() -> None:
    """Print the section, or write it into the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--docs", action="store_true", help="write it into docs/concealed.md")
    options = parser.parse_args()
    if options.docs:
        page = DOCS.read_text(encoding="utf-8")
        DOCS.write_text(between_marks(page, docs_text()), encoding="utf-8")
    else:
        print(docs_text())


if __name__ == "__main__":
    main()

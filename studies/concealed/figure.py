"""Two pictures for docs/concealed.md: what is found against its size, and which kinds are named.

python studies/concealed/figure.py [--of report]     # reads results/report.json
"""

import argparse
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from claims import Row
from results import HERE, Scored, read
from scipy.stats import beta
from tables import BINS, EDGES, WORDLESS

DOCS = Path(__file__).resolve().parents[2] / "docs" / "concealed.png"
COLOURS = {"symhyb": "#1b5e8c", "pysindy": "#c9722b", "weak": "#6a9a3b", "deltaf": "#8d5fa8"}


def rates(rows: Sequence[Row]) -> tuple[list[float], list[tuple[float, float]], list[int]]:
    """Share of the forces that are named in every class of size, with its 90 % interval, and how
    many there are."""
    middle, spread, count = [], [], []
    for low, high in pairwise(EDGES):
        hits = [
            hit
            for row in rows
            for share, hit in zip(row.shares, row.hits, strict=True)
            if share is not None and low <= share < high
        ]
        named, whole = sum(hit == 2 for hit in hits), len(hits)
        middle.append(named / whole if whole else np.nan)
        low_end = beta.ppf(0.05, named, whole - named + 1) if named else 0.0
        high_end = beta.ppf(0.95, named + 1, whole - named) if named < whole else 1.0
        spread.append((float(low_end), float(high_end)))
        count.append(whole)
    return middle, spread, count


def shown(scored: Scored) -> dict[str, Sequence[Row]]:
    """symhyb and the peers that have words, at their best setting, on the concealed cases."""
    everybody = {"symhyb": scored.rows, **scored.peers}
    return {
        name: [row for row in rows if row.wanted]
        for name, rows in everybody.items()
        if name not in WORDLESS and "quiet" not in name
    }


def sizes(axes: Any, scored: Scored) -> None:
    """Named forces against their size."""
    for k, (name, rows) in enumerate(shown(scored).items()):
        middle, spread, count = rates(rows)
        used = [i for i, whole in enumerate(count) if whole]
        x = np.array(used) + 0.06 * (k - 1.5)
        y = np.array([middle[i] for i in used])
        reach = np.abs(np.array([spread[i] for i in used]).T - y)
        axes.errorbar(x, 100 * y, 100 * reach, fmt="o-", color=COLOURS[name], label=name, lw=1.5)
    axes.set_xticks(
        range(len(BINS)),
        [words.replace(" %", "").replace(" to ", "–") for words in BINS],
        fontsize=8,
    )
    axes.set_xlabel("RMS of the concealed force, % of the known force")
    axes.set_ylabel("forces named, %")
    axes.set_ylim(-3, 103)
    axes.set_xlim(-0.4, len(BINS) - 0.6)


def kinds(axes: Any, scored: Scored) -> None:
    """Named causes of every kind."""
    reported = shown(scored)
    names = sorted({row.kind for row in reported["symhyb"]}, reverse=True)
    height = 0.8 / len(reported)
    for k, (name, rows) in enumerate(reported.items()):
        mine = [[row for row in rows if row.kind == kind] for kind in names]
        y = [100 * sum(r.name for r in own) / sum(r.wanted for r in own) for own in mine]
        axes.barh(np.arange(len(names)) + 0.4 - (k + 0.5) * height, y, height, color=COLOURS[name])
    counts = [sum(row.wanted for row in reported["symhyb"] if row.kind == kind) for kind in names]
    words = [f"{kind} ({count})" for kind, count in zip(names, counts, strict=True)]
    axes.set_yticks(range(len(names)), words, fontsize=7)
    axes.set_xlabel("causes named, %")
    axes.set_ylim(-0.6, len(names) - 0.4)


def main() -> None:
    """Draw both side by side."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--of", default="report", help="which set of seeds")
    parser.add_argument("--from", dest="folder", type=Path, default=HERE)
    parser.add_argument("-o", "--output", type=Path, default=DOCS)
    options = parser.parse_args()
    scored = read(options.folder / f"{options.of}.json")
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 5.2), layout="constrained")
    sizes(left, scored)
    kinds(right, scored)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(alpha=0.25)
        axes.set_axisbelow(True)
    figure.legend(
        *left.get_legend_handles_labels(), loc="outside upper center", ncols=4, frameon=False
    )
    figure.savefig(options.output, dpi=110)


if __name__ == "__main__":
    main()

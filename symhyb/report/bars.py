"""Pictures of shares as bars: scores before and after, and how much each place explains."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from symhyb.discrepancy.words.wording import number_text, percent_text
from symhyb.report.canvas import AFTER, BEFORE, PAPER, QUIET, drawing, svg
from symhyb.report.contract import finite
from symhyb.report.series import shortened

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True)
class Pair:
    """A score before and after the correction, as a share of one (None: not computable)."""

    label: str
    before: float | None
    after: float | None


def score_figure(pairs: Sequence[Pair]) -> bytes:
    """Draw scores before and after as paired bars in percent, logarithmic if they differ much."""
    values = [finite(value) for pair in pairs for value in (pair.before, pair.after)]
    shown = [100.0 * value for value in values if value is not None and value > 0.0]
    logarithmic = bool(shown) and max(shown) > 20.0 * min(shown)
    with drawing(0.52 * len(pairs) + 0.75) as figure:
        panel = figure.subplots()
        if logarithmic:
            panel.set_xscale("log")
            panel.set_xlim(min(shown) / 2.0, max(shown) * 3.0)
        elif shown:
            panel.set_xlim(0.0, max(shown) * 1.18)
        for row, pair in enumerate(pairs):
            _above(panel, float(row), pair.label)
            _bar(panel, row + 0.32, pair.before, BEFORE, "////")
            _bar(panel, row + 0.57, pair.after, AFTER)
        panel.set_ylim(len(pairs) - 0.2, -0.3)
        _percent_axis(panel, logarithmic)
        panel.set_xlabel("error [%]" + (", logarithmic" if logarithmic else ""))
        return svg(figure)


def places_figure(places: Sequence[tuple[str, float | None, bool]]) -> bytes:
    """Draw the share of the mismatch that each place explains; found places stand out.

    ``places`` are (words, explained share or None, whether something was found there).
    """
    with drawing(0.48 * len(places) + 0.8) as figure:
        panel = figure.subplots()
        panel.set_xlim(0.0, 118.0)
        for row, (words, explained, found) in enumerate(places):
            _above(panel, float(row), words)
            _bar(panel, row + 0.4, explained, AFTER if found else QUIET)
        panel.set_ylim(len(places), -0.4)
        _percent_axis(panel, logarithmic=False)
        panel.set_xticks(range(0, 101, 20))
        panel.set_xlabel("explained share of the mismatch [%]")
        return svg(figure)


def _bar(panel: "Axes", height: float, share: float | None, color: str, hatch: str = "") -> None:
    known = finite(share)
    left = panel.get_xlim()[0]
    if known is not None:
        wide = 100.0 * known - left
        style: dict[str, Any] = {"hatch": hatch, "ec": PAPER, "lw": 0.0}
        panel.barh(height, wide, left=left, height=0.24, color=color, **style)
    said = "not computable" if known is None else percent_text(known)
    end = left if known is None else max(100.0 * known, left)
    panel.annotate(
        said, (end, height), xytext=(3, 0), textcoords="offset points", va="center", fontsize=8
    )


def _above(panel: "Axes", height: float, text: str) -> None:
    across = panel.get_yaxis_transform()
    panel.annotate(shortened(text), (0.0, height), xycoords=across, va="center")


def _percent_axis(panel: "Axes", logarithmic: bool) -> None:
    panel.set_yticks([])
    panel.spines["left"].set_visible(False)
    panel.grid(visible=True, axis="x", which="major")
    if logarithmic:
        panel.xaxis.set_major_formatter(lambda value, _: number_text(float(value)))
        panel.xaxis.set_minor_formatter(lambda value, _: "")

"""The sheet that every picture of the report is drawn on: style, colours, SVG.

matplotlib without pyplot: nothing is shown, and nothing stays open.
"""

import io
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 5.4  # inches; with type of 9 pt that reads at 760 px and on a phone
# of Okabe and Ito, which colour-blind readers tell apart; before is dashed too, for grey prints
MEASURED, BEFORE, AFTER = "#1f2933", "#d55e00", "#0072b2"
LAW = "#b0417c"
IN_DOUBT, UNSURE, SURE = "#f3b6ae", "#f7e0ac", "#cfe3f3"
QUIET, BAND, SHADE, PAPER = "#8a949e", "#dfe4e8", "#eef1f4", "#fffffe"
LINK, DRIVEN, FILLED = "#56616c", "#a8571a", "#cfd6dd"  # of a drawn machine
DASHED = (0, (5.0, 1.6))
_GRID, _TICKS = "#e6e9ec", "#4a5560"
# what each colour is where the reader's screen is dark
DARK = {
    MEASURED: "#e8eaed",
    BEFORE: "#e69f00",
    AFTER: "#56b4e9",
    LAW: "#e79ac2",
    IN_DOUBT: "#7a2e26",
    UNSURE: "#65501a",
    SURE: "#24486a",
    QUIET: "#8e98a2",
    BAND: "#414a53",
    SHADE: "#2a3037",
    PAPER: "#1d2126",
    LINK: "#9aa5b0",
    DRIVEN: "#e0a26a",
    FILLED: "#4a545e",
    _GRID: "#31383f",
    _TICKS: "#b3bcc5",
}
_STYLE: dict[Any, Any] = {  # matplotlib's own type lists every key it knows
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "text.parse_math": False,  # a name may hold a dollar sign
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.titley": 1.0,  # nothing stands between it and the panel, which need not be measured
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": QUIET,
    "axes.facecolor": "none",
    "axes.labelcolor": MEASURED,
    "text.color": MEASURED,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.xmargin": 0.01,
    "grid.color": _GRID,
    "grid.linewidth": 0.6,
    "xtick.color": _TICKS,
    "ytick.color": _TICKS,
    "lines.linewidth": 1.1,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "svg.fonttype": "path",  # looks the same without any font installed
    "svg.hashsalt": "symhyb",
}


@contextmanager
def drawing(height: float) -> Iterator["Figure"]:
    """Yield a figure in the style of the page, ``height`` in inches."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from symhyb.report.stacked import Stacked

    with mpl.rc_context(_STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing", category=UserWarning)
        yield Figure(figsize=(WIDTH, height), dpi=100, layout=Stacked(), facecolor="none")


def svg(figure: "Figure") -> bytes:
    """Give a figure as the bytes of an SVG that is the same every time.

    The layout is part of drawing; ``savefig`` would draw everything once before, unseen.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    for panel in figure.axes:
        for axis in (panel.xaxis, panel.yaxis):
            if not axis.get_label_text():  # its place would be found from every number of the axis
                axis.set_label_coords(0.5, 0.5)
    target = io.BytesIO()
    about = {"Date": None, "Creator": "symhyb"}
    FigureCanvasSVG(figure).print_svg(target, metadata=about)  # type: ignore[no-untyped-call]
    return _for_both(target.getvalue())


def _for_both(drawn: bytes) -> bytes:
    """A drawing whose colours follow whether the reader's screen is light or dark, and whose paths
    have no more digits than a screen shows."""
    drawn = re.sub(rb' d="[^"]*"', lambda path: re.sub(rb"(\.\d\d)\d+", rb"\1", path[0]), drawn)
    rules = []
    for number, (light, dark) in enumerate(DARK.items()):
        drawn = drawn.replace(f": {light}".encode(), f": var(--c{number})".encode())
        rules.append((f"--c{number}:{light}", f"--c{number}:{dark}"))
    light, dark = (";".join(column) for column in zip(*rules, strict=True))
    style = f"svg{{{light}}}@media (prefers-color-scheme:dark){{svg{{{dark}}}}}"
    return drawn.replace(b"<defs>", f"<defs><style>{style}</style>".encode(), 1)


def picture(figure: "Figure", suffix: str) -> bytes:
    """Give a figure as the bytes of a ``.png`` or, by any other suffix, of an SVG."""
    if suffix.lower() != ".png":
        return svg(figure)
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    target = io.BytesIO()
    FigureCanvasAgg(figure).print_png(target)  # type: ignore[no-untyped-call]
    return target.getvalue()


def legend(panel: "Axes") -> None:
    """Put the legend above the panel, on the right."""
    panel.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=3, borderaxespad=0.0)


def bracketed(unit: str) -> str:
    """Write a unit behind the name of an axis."""
    return f" [{unit}]" if unit else " [1]"

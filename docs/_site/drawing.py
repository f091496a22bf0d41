"""Small line drawings as SVG that take their colours from the page, in light and in dark."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

WIDTH, HEIGHT = 360, 230
LEFT, TOP, RIGHT, BOTTOM = 22, 26, 56, 22  # margins around the curve
HEADROOM = 1.08  # of the axes beyond the curve


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis: its ``name``, the ``unit`` of its numbers, and the span (low, high) that is drawn,
    which holds 0."""

    name: str
    unit: str
    low: float
    high: float

    def share(self, value: float) -> float:
        """Where a value lies between both ends, 0 to 1."""
        return (value - self.low) / (self.high - self.low)

    def told(self, value: float) -> str:
        """A number with its unit."""
        return f"{value:.3g} {self.unit}".strip()


def axis(name: str, unit: str, values: Sequence[float]) -> Axis:
    """An axis on which all values have room; one of equal values reaches from 0 to beyond them."""
    low, high = min(0.0, *values), max(0.0, *values)
    if low == high:
        low, high = -1.0, 1.0
    if high < 0.15 * (high - low):
        high = 0.15 * (high - low)
    if -low < 0.15 * (high - low):
        low = -0.15 * (high - low)
    return Axis(name, unit, HEADROOM * low, HEADROOM * high)


def drawn(x: Sequence[float], y: Sequence[float], across: Axis, up: Axis, title: str) -> str:
    """A curve over two axes that cross at 0, with the largest value of each written at it."""

    def place(a: float, b: float) -> tuple[float, float]:
        return (
            LEFT + across.share(a) * (WIDTH - LEFT - RIGHT),
            HEIGHT - BOTTOM - up.share(b) * (HEIGHT - TOP - BOTTOM),
        )

    points = thinned([place(a, b) for a, b in zip(x, y, strict=True)])
    path = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
    x0, y0 = place(0.0, 0.0)
    far, high = extreme(x), extreme(y)
    xf, yh = place(far, 0.0)[0], place(0.0, high)[1]
    # beside the axis where the curve is not, and on it last, with a rim in the page's colour
    left = x0 > 80 and x[[float(b) for b in y].index(high)] >= 0.0
    parts = [
        f'<svg class="plot" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" role="img"'
        f' aria-label="{escape(title)}" font-size="12" fill="currentColor">',
        line(LEFT - 8, y0, WIDTH - RIGHT + 14, y0),
        line(x0, HEIGHT - BOTTOM + 8, x0, TOP - 14),
        arrow(WIDTH - RIGHT + 22, y0, 1, 0),
        arrow(x0, TOP - 22, 0, -1),
        line(xf, y0 - 4, xf, y0 + 4),
        line(x0 - 4, yh, x0 + 4, yh),
        f'<polyline class="curve" points="{path}" fill="none" stroke="currentColor"'
        ' stroke-width="2" stroke-linejoin="round"/>',
        words(WIDTH - RIGHT + 28, y0 + 4, across.name),
        words(x0 + 9, TOP - 12, up.name),
        words(xf, y0 + (17 if high > 0 else -8), across.told(far), "middle"),
        words(x0 + (-8 if left else 8), yh + 4, up.told(high), "end" if left else "start"),
        "</svg>",
    ]
    return "".join(parts)


def extreme(values: Sequence[float]) -> float:
    """The value that an axis states: the largest, or the smallest where that is far larger."""
    low, high = min(values), max(values)
    return float(low if -low > 2 * high else high)


def thinned(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points without those that lie within a pixel of the one before."""
    kept = points[:1]
    for point in points[1:]:
        if abs(point[0] - kept[-1][0]) + abs(point[1] - kept[-1][1]) > 1.0:
            kept.append(point)
    return kept


def words(x: float, y: float, text: str, anchor: str = "start") -> str:
    """A text that begins, ends or has its middle at x."""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def line(x1: float, y1: float, x2: float, y2: float) -> str:
    """A thin line."""
    ends = f'x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"'
    return f'<line {ends} stroke="currentColor" stroke-width="1" opacity="0.6"/>'


def arrow(x: float, y: float, right: int, down: int) -> str:
    """The head of an arrow with its tip at (x, y)."""
    back, side = 9, 3.5
    a = (x - back * right - side * down, y - back * down - side * right)
    b = (x - back * right + side * down, y - back * down + side * right)
    points = " ".join(f"{p:.1f},{q:.1f}" for p, q in ((x, y), a, b))
    return f'<polygon points="{points}" opacity="0.6"/>'

"""Draw the pictures of signs.md as SVG files: python docs/how-to/drawings.py.

Lengths are pixels; y counts downwards, as SVG has it. The background is white, so that a drawing is
legible on a dark page, too. Forces are orange and coordinates blue, which colour-blind readers can
distinguish.
"""

from collections.abc import Iterable
from pathlib import Path
from xml.sax.saxutils import escape

FOLDER = Path(__file__).parent / "signs"
INK, FORCE, MOTION, FILL = "#222222", "#b34700", "#0060a8", "#e6e6e6"

Parts = Iterable[str]


def line(x1: float, y1: float, x2: float, y2: float, colour: str = INK, width: float = 2) -> str:
    """A straight line."""
    ends = f'x1="{x1:g}" y1="{y1:g}" x2="{x2:g}" y2="{y2:g}"'
    return f'<line {ends} stroke="{colour}" stroke-width="{width:g}"/>'


def arrow(x1: float, y1: float, x2: float, y2: float, colour: str) -> str:
    """A line with a head at its second end."""
    length = ((x2 - x1) ** 2 + (y2 - y1) ** 2) ** 0.5
    ux, uy = (x2 - x1) / length, (y2 - y1) / length
    bx, by = x2 - 11 * ux, y2 - 11 * uy
    head = [(x2, y2), (bx - 5 * uy, by + 5 * ux), (bx + 5 * uy, by - 5 * ux)]
    corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in head)
    return line(x1, y1, bx, by, colour, 2.5) + f'<polygon points="{corners}" fill="{colour}"/>'


def text(x: float, y: float, words: str, colour: str = INK, anchor: str = "middle") -> str:
    """Words whose middle, start or end is at x, on the line y."""
    place = f'x="{x:g}" y="{y:g}" text-anchor="{anchor}"'
    return f'<text {place} fill="{colour}">{escape(words)}</text>'


def path(points: Iterable[tuple[float, float]], colour: str = INK, width: float = 2) -> str:
    """An open line through points."""
    corners = " ".join(f"{x:g},{y:g}" for x, y in points)
    return f'<polyline points="{corners}" fill="none" stroke="{colour}" stroke-width="{width:g}"/>'


def box(x: float, y: float, width: float, height: float, words: str = "") -> str:
    """A body with its name."""
    shape = f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}"'
    middle = text(x + width / 2, y + height / 2 + 5, words) if words else ""
    return f'{shape} fill="{FILL}" stroke="{INK}" stroke-width="2"/>{middle}'


def dot(x: float, y: float) -> str:
    """A point of the model."""
    return f'<circle cx="{x:g}" cy="{y:g}" r="5" fill="{INK}"/>'


def wall(x: float, y1: float, y2: float) -> str:
    """A wall to the left of x."""
    hatch = "".join(line(x, y, x - 10, y + 10, width=1) for y in range(int(y1), int(y2), 10))
    return line(x, y1, x, y2, width=3) + hatch


def spring(x1: float, x2: float, y: float) -> str:
    """A spring between two places."""
    step = (x2 - x1 - 20) / 8
    zigzag = [(x1 + 10 + step * (i + 0.5), y + (-9 if i % 2 else 9)) for i in range(8)]
    return path([(x1, y), (x1 + 10, y), *zigzag, (x2 - 10, y), (x2, y)])


def coordinate() -> Parts:
    """A force on a coordinate: what resists and what pushes."""
    yield wall(30, 30, 110)
    yield spring(30, 150, 70)
    yield box(150, 45, 80, 50, "m")
    yield arrow(190, 30, 260, 30, MOTION) + text(270, 35, "x > 0", MOTION, "start")
    yield arrow(150, 112, 80, 112, FORCE) + text(
        20, 140, "passive: F > 0 resists, acts along −x", FORCE, "start"
    )
    yield arrow(230, 70, 300, 70, FORCE) + text(
        308, 75, "active: F > 0 pushes along +x", FORCE, "start"
    )


def points() -> Parts:
    """A force between two points: a tension."""
    yield dot(60, 60) + text(60, 42, "a") + dot(340, 60) + text(340, 42, "b")
    yield spring(60, 340, 60)
    yield arrow(60, 95, 140, 95, FORCE) + arrow(340, 95, 260, 95, FORCE)
    yield text(200, 100, "F > 0", FORCE)
    yield text(200, 135, "a tension: it pulls a and b together")
    yield arrow(60, 158, 340, 158, MOTION) + text(350, 163, "|b − a| = s + length", MOTION, "start")


def at_a_point() -> Parts:
    """A force at a point: against its velocity."""
    yield dot(200, 100) + text(222, 118, "p")
    yield arrow(200, 100, 300, 50, MOTION) + text(310, 50, "v", MOTION, "start")
    yield arrow(200, 100, 120, 140, FORCE) + text(20, 165, "passive: against v", FORCE, "start")
    yield arrow(200, 100, 200, 30, FORCE)
    yield text(20, 25, "active: the vector [Fx, Fy]", FORCE, "start")
    yield arrow(350, 150, 400, 150, INK) + text(410, 155, "x", anchor="start")
    yield arrow(350, 150, 350, 100, INK) + text(350, 92, "y")


def missing() -> Parts:
    """The force that a model lacks, over speed: its sign is that of a force that acts."""
    for left, title in ((20, "dry friction left out"), (230, "viscous damping left out")):
        middle = left + 85
        yield line(left, 80, left + 170, 80, width=1) + line(middle, 20, middle, 140, width=1)
        yield text(left + 170, 98, "q′", MOTION, "end") + text(middle + 8, 28, "ΔF", FORCE, "start")
        yield text(middle, 165, title)
    yield path([(25, 45), (105, 45), (105, 115), (185, 115)], FORCE, 3)
    yield path([(235, 30), (395, 130)], FORCE, 3)


def gap() -> Parts:
    """Stops of a gap: free travel on either side of s = 0."""
    yield wall(70, 40, 100) + line(370, 40, 370, 100, width=3)
    yield "".join(line(370, y, 380, y + 10, width=1) for y in range(40, 100, 10))
    yield box(195, 50, 50, 40, "")
    yield line(220, 30, 220, 110, MOTION, 1) + text(220, 24, "s = 0", MOTION)
    yield arrow(245, 70, 365, 70, INK) + text(305, 62, "clearance")
    yield arrow(195, 70, 75, 70, INK) + text(135, 62, "clearance")
    yield text(70, 125, "side = lower") + text(370, 125, "side = upper")
    yield arrow(190, 150, 250, 150, MOTION) + text(260, 155, "s", MOTION, "start")


def angle() -> Parts:
    """Angles count counter-clockwise; an accelerometer feels its support."""
    yield line(40, 140, 200, 140, width=1) + text(205, 145, "x", anchor="start")
    yield line(40, 140, 150, 60, width=4) + dot(40, 140)
    arc = 'd="M 120 140 A 80 80 0 0 0 105 93" fill="none"'
    yield f'<path {arc} stroke="{MOTION}" stroke-width="2.5"/>'
    yield text(128, 118, "φ > 0", MOTION, "start")
    yield text(20, 170, "counter-clockwise; z towards you", anchor="start")
    yield box(330, 80, 50, 40, "") + line(310, 120, 400, 120, width=3)
    yield arrow(355, 80, 355, 30, FORCE) + text(365, 40, "+9.81 m/s² at rest", FORCE, "start")
    yield text(300, 150, "an accelerometer shows a − g,", anchor="start")
    yield text(300, 170, "along the axes of its body", anchor="start")


DRAWINGS = {
    "coordinate": (coordinate, 600, 160, "A force on a coordinate"),
    "between": (points, 560, 180, "A force between two points"),
    "at": (at_a_point, 440, 185, "A force at a point"),
    "missing": (missing, 440, 180, "The force that the model lacks, over speed"),
    "gap": (gap, 440, 170, "The stops of a gap"),
    "angle": (angle, 600, 185, "Angles and accelerometers"),
}


def drawing(name: str) -> str:
    """A drawing as the text of an SVG file."""
    parts, width, height, title = DRAWINGS[name]
    head = f'xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}"'
    font = 'font-family="sans-serif" font-size="15"'
    body = "\n".join(parts())
    return (
        f'<svg {head} viewBox="0 0 {width} {height}" {font} role="img">\n<title>{title}</title>\n'
        f'<rect width="{width}" height="{height}" rx="6" fill="white"/>\n{body}\n</svg>\n'
    )


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for each in DRAWINGS:
        (FOLDER / f"{each}.svg").write_text(drawing(each), encoding="utf-8")

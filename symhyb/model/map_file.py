"""The grid of a map from a CSV file: a line of the places along y, below it a line for each x.

    mm \\ m/s,  -0.5,    0,  0.5        the first cell is for people; comma, semicolon or tab;
    -40,       -900,    0,  700        # begins a remark
     40,       -300,    0,  250

Strict: whatever is no number, and every line that has another number of cells, is a fault.
"""

from dataclasses import dataclass

from symhyb.model.curve_file import DELIMITERS, lines_of, number_fault


@dataclass(frozen=True, slots=True)
class Gridded:
    """What a file says: places and rows of values, the number of the line of the y values and that
    of each x, and every fault as (line, sentence)."""

    x: tuple[float, ...] = ()
    y: tuple[float, ...] = ()
    values: tuple[tuple[float, ...], ...] = ()
    head: int = 0
    lines: tuple[int, ...] = ()
    faults: tuple[tuple[int, str], ...] = ()


def grid_in(content: str) -> Gridded:
    """Read the grid that a text holds."""
    lines = lines_of(content)
    if not lines:
        return Gridded(faults=((0, "holds no line of numbers"),))
    (head, first), *rest = lines
    delimiter = max(DELIMITERS, key=first.count)
    across = [cell.strip() for cell in first.split(delimiter)][1:]
    faults = [(head, fault) for cell in across if (fault := number_fault(cell))]
    rows: list[tuple[float, ...]] = []
    for line, text in rest:
        cells = [cell.strip() for cell in text.split(delimiter)]
        if len(cells) != len(across) + 1:
            said = f"has {len(cells)} cells; the first line has {len(across) + 1}"
            faults.append((line, said))
            continue
        wrong = [(line, fault) for cell in cells if (fault := number_fault(cell))]
        faults += wrong
        if not wrong:
            rows.append(tuple(map(float, cells)))
    if faults:
        return Gridded(faults=tuple(faults))
    return Gridded(
        tuple(row[0] for row in rows),
        tuple(map(float, across)),
        tuple(row[1:] for row in rows),
        head,
        tuple(line for line, _ in rest),
    )

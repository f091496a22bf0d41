"""A table of the groups that recordings are of.

recording,   mount
fall-1.csv,  light
fall-2.csv,  heavy

A column a grouping; a row belongs to the recording whose path ends with its name.
"""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from symhyb.data.by_recording import NAMES, cells_of, row_of
from symhyb.errors import InputError, Problem


@dataclass(frozen=True, slots=True)
class GroupTable:
    """The ``rows`` of a table: the name of a recording with its groups by grouping."""

    file: str
    rows: tuple[tuple[str, Mapping[str, str]], ...]

    def of(self, recording: str | os.PathLike[str]) -> Mapping[str, str]:
        """The groups of the recording at a path; none of a cell that is empty.

        Raises:
            InputError: no row for it.
        """
        return row_of(self.rows, recording, self.file)


def read_groups(path: str | os.PathLike[str]) -> GroupTable:
    """Read a table of groups: CSV with a column ``recording`` and one a grouping.

    Raises:
        InputError: no table, no column of a grouping, one that stands twice, or recordings that are
            not named or named twice: all problems at once.
    """
    file = Path(path)
    rows = cells_of(file)
    if len(rows) < 2:
        raise InputError(Problem("needs a header and a row for each recording", file=str(file)))
    (line, head), *body = rows
    problems: list[Problem] = []
    if NAMES not in head:
        text = f"a column '{NAMES}' with the names of the recordings is missing"
        problems.append(Problem(text, file=str(file), line=line))
    groupings = [cell for cell in head if cell != NAMES]
    if not groupings:
        problems.append(Problem("has no column of a grouping", file=str(file), line=line))
    for cell in dict.fromkeys(head):
        if not cell or head.count(cell) > 1:
            text = "has two columns" if cell else "a column has no name"
            problems.append(Problem(text, cell, str(file), line))
    if problems:
        raise InputError(problems)
    found: dict[str, Mapping[str, str]] = {}
    for number, cells in body:
        values = dict(zip(head, cells, strict=False))
        name = values.pop(NAMES, "")
        if len(cells) != len(head):
            text = f"has {len(cells)} cells below a header of {len(head)}"
            problems.append(Problem(text, file=str(file), line=number))
        elif not name or name in found:
            text = f"'{name}' has a row already" if name else "names no recording"
            problems.append(Problem(text, NAMES, str(file), number))
        found[name] = {by: label for by, label in values.items() if label}
    if problems:
        raise InputError(problems)
    return GroupTable(str(file), tuple(found.items()))

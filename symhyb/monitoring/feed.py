"""From lines of text to recordings, a piece at a time: the first rows name the columns."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from symhyb.data.columns import map_columns
from symhyb.data.files.csv_file import read_csv
from symhyb.data.recording import Recording, recorded_part
from symhyb.errors import InputError, Problem
from symhyb.model.types import Model

HEADER_MOST = 200  # lines before the first row of numbers
DELIMITERS = (",", ";", "\t")
CELL = re.compile(r'\s*"?([-+]?[\d.,]*\d\.?([eE][-+]?\d+)?|\d{4}-\d\d-\d\d.*|nan|NaN|-*|#N/A)"?\s*')
"""A number, a date, or what is written where nothing was measured."""


@dataclass(slots=True)
class Feed:
    """Lines of a source as they come, cut into recordings of ``model``; ``columns`` maps channels
    as for :func:`~symhyb.data.recording.read_recording`."""

    model: Model
    columns: Mapping[str, str] | None
    name: str
    header: list[str] = field(default_factory=list)
    rows: list[str] = field(default_factory=list)

    def take(self, line: str) -> None:
        """Take one line: of the header until the first row of numbers.

        Raises:
            InputError: no row of numbers among the first lines.
        """
        if not line.strip():
            return
        if self.rows or (self.header and _numbers(line)):
            self.rows.append(line)
            return
        self.header.append(line)
        if len(self.header) > HEADER_MOST:
            text = f"no row of numbers within the first {HEADER_MOST} lines"
            raise InputError(Problem(text, file=self.name))

    def piece(self, rows: int) -> Recording:
        """The first so many rows as a recording; they are taken out, readable or not.

        Raises:
            InputError: as :func:`~symhyb.data.recording.read_recording`.
        """
        taken, self.rows = self.rows[:rows], self.rows[rows:]
        return self._read(taken)

    def step_s(self, rows: int) -> float:
        """How far apart the first so many rows lie, s (the median); they stay.

        Raises:
            InputError: as :func:`~symhyb.data.recording.read_recording`.
        """
        return float(np.median(np.diff(self._read(self.rows[:rows]).t)))

    def _read(self, rows: Sequence[str]) -> Recording:
        content = "\n".join([*self.header, *rows]).encode()
        table = read_csv(content, self.name)
        return recorded_part(table, map_columns(table, self.model, self.columns), self.model)


def _numbers(line: str) -> bool:
    """Whether a line is a row of numbers, some of which may be missing."""
    delimiter = max(DELIMITERS, key=line.count)
    return all(map(CELL.fullmatch, line.split(delimiter)))

"""Small pictures of signals: every peak is in them, and gaps stay open."""

import numpy as np
import pytest

from symhyb.console.sparkline import EMPTY, sparkline


def dots(lines: list[str]) -> np.ndarray:
    """The dots (4·rows, 2·width) of a picture, from the top."""
    places = {0x01: (0, 0), 0x02: (1, 0), 0x04: (2, 0), 0x40: (3, 0)}
    places |= {0x08: (0, 1), 0x10: (1, 1), 0x20: (2, 1), 0x80: (3, 1)}
    grid = np.zeros((4 * len(lines), 2 * len(lines[0])), bool)
    for row, line in enumerate(lines):
        for column, letter in enumerate(line):
            for bit, (down, right) in places.items():
                if (ord(letter) - EMPTY) & bit:
                    grid[4 * row + down, 2 * column + right] = True
    return grid


def test_a_ramp_goes_from_the_lower_left_to_the_upper_right() -> None:
    lines = sparkline(np.arange(1000.0), 20)
    assert [len(line) for line in lines] == [20, 20]
    grid = dots(lines)
    heights = [float(np.flatnonzero(column).mean()) for column in grid.T]
    assert heights[0] > 6.5
    assert heights[-1] < 0.5
    assert np.all(np.diff(heights) <= 0)


def test_a_single_peak_is_seen() -> None:
    values = np.zeros(100_000)
    values[70_123] = 1.0
    grid = dots(sparkline(values, 30))
    assert np.flatnonzero(grid[0]).tolist() == [70_123 * 60 // 100_000]


def test_what_is_missing_stays_open_and_a_constant_is_a_line() -> None:
    values = np.ones(600)
    values[200:400] = np.nan
    grid = dots(sparkline(values, 30))
    assert not grid[:, 21:39].any()
    assert (grid[:, :20].sum(axis=0) == 1).all()


@pytest.mark.parametrize("values", [np.full(5, np.nan), np.empty(0)])
def test_nothing_is_drawn_of_nothing(values: np.ndarray) -> None:
    assert not dots(sparkline(values, 4)).any()

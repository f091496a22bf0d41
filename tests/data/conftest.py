"""A small model and files to read with it."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from symhyb.model.expression import parse_expression
from symhyb.model.types import Coordinate, Input, Model, Sensor
from symhyb.units import parse_unit

Write = Callable[[str, str | bytes], Path]
Table = Callable[..., str]


@pytest.fixture
def model() -> Model:
    """A mass with a force in N, a laser in mm and an accelerometer."""
    return Model(
        "mass",
        (Coordinate("x", parse_unit("m")),),
        inputs=(Input("f", parse_unit("N")),),
        sensors=(
            Sensor("laser", parse_expression("x"), parse_unit("mm")),
            Sensor("accel", parse_expression("x''"), parse_unit("m/s^2")),
        ),
    )


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Return ``write(name, content)``: the path of a file with this content."""

    def write_file(name: str, content: str | bytes) -> Path:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write_file


@pytest.fixture
def signals() -> dict[str, NDArray[np.float64]]:
    """A hundred plain samples at 100 Hz: t, f, laser, accel."""
    t = np.arange(100) / 100
    wave = np.sin(2 * np.pi * t)
    return {"t": t, "f": 5 * wave, "laser": 2 * wave + 0.1 * np.cos(9 * t), "accel": -3 * wave}


@pytest.fixture
def table() -> Table:
    """Return ``table(columns, delimiter)``: a text with a header; NaN becomes an empty cell."""

    def text(columns: Mapping[str, ArrayLike], delimiter: str = ",") -> str:
        rows = zip(*(np.asarray(values, dtype=float) for values in columns.values()), strict=True)
        lines = [delimiter.join(columns)]
        lines += [
            delimiter.join("" if np.isnan(cell) else repr(float(cell)) for cell in row)
            for row in rows
        ]
        return "\n".join(lines) + "\n"

    return text

"""The picture of a fleet: every unit is drawn, and those that deviate have their names."""

from xml.etree import ElementTree

import numpy as np
import pytest

from symhyb.report import canvas, fleet_figure
from symhyb.report.fleet_figure import Panel


def panel(name: str, sd: float = 0.1) -> Panel:
    x = np.arange(5.0)
    odd = ["", "", "drive-2", "", ""]
    line = np.array([1.0, 1.0])
    return Panel(
        name, "N/m", "hours", x, 1 + 0.1 * x, np.full(5, sd), x[[0, -1]], line, 0.1 * line, odd
    )


@pytest.mark.parametrize("sd", [0.1, np.inf])
def test_units_and_names_are_drawn(monkeypatch: pytest.MonkeyPatch, sd: float) -> None:
    seen = []
    real = canvas.picture

    def kept(figure, suffix):  # type: ignore[no-untyped-def]
        seen.append(figure)
        return real(figure, suffix)

    monkeypatch.setattr("symhyb.report.fleet_figure.picture", kept)
    drawn = fleet_figure.fleet_figure([[panel("k", sd)], [panel("d", sd)]], "a fleet")
    ElementTree.fromstring(drawn)
    (figure,) = seen
    assert len(figure.axes) == 2
    for axis in figure.axes:
        assert [text.get_text() for text in axis.texts] == ["drive-2"]
        points = sum(len(line.get_xdata()) for line in axis.lines if line.get_marker() == "o")
        assert points == 5
    assert figure.axes[-1].get_xlabel() == "hours"


def test_a_fleet_with_many_numbers_is_drawn_in_part() -> None:
    rows = [[panel(f"k{i}")] for i in range(40)]
    assert fleet_figure.fleet_figure(rows, "", ".png").startswith(b"\x89PNG")

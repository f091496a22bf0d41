"""The layout of pictures: nothing is cut off, and no panel lies on what stands around another."""

from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest
from made_results import rival
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure
from snippets import ROOT

from symhyb.discrepancy.evidence import Correlations
from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.report.canvas import WIDTH, drawing, picture, svg
from symhyb.report.doubts import correlations_figure
from symhyb.report.machine_figure import machine_figure
from symhyb.report.page import render_page
from symhyb.report.rivals import rivals_figure
from symhyb.report.sketch import sketch_of
from symhyb.report.stacked import Stacked

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]
Drawn = list[Figure]
DPI = 72.0


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> Drawn:
    """The figures that are drawn meanwhile."""
    kept: Drawn = []
    place = Stacked.execute

    def placed(self: Stacked, fig: Figure) -> None:
        kept.append(fig)
        place(self, fig)

    monkeypatch.setattr(Stacked, "execute", placed)
    return kept


def require_room(figure: Figure) -> None:
    """All that is drawn is inside of the picture, and no two panels share a pixel."""
    figure.dpi = DPI
    renderer = RendererAgg(1, 1, DPI)
    whole = figure.get_tightbbox(renderer)
    width, height = figure.get_size_inches()
    assert whole.x0 > -0.02
    assert whole.y0 > -0.02
    assert whole.x1 < width + 0.02
    assert whole.y1 < height + 0.02
    around = [panel.get_tightbbox(renderer) for panel in figure.axes]
    for one, other in combinations(around, 2):
        apart = max(one.x0 - other.x1, other.x0 - one.x1, one.y0 - other.y1, other.y0 - one.y1)
        assert apart > -1.0


@pytest.mark.filterwarnings("ignore:Glyph .* missing")
@pytest.mark.parametrize("name", ["missing", "hostile", "failed"])
def test_nothing_of_a_page_is_cut_off(cases: Cases, drawn: Drawn, model: Model, name: str) -> None:
    render_page("Slide", *cases[name](), model=model)
    assert len(drawn) >= 3
    for figure in drawn:
        require_room(figure)


def test_names_of_any_length_have_room(drawn: Drawn) -> None:
    names = ("a_number_with_a_very_long_name_of_its_own", "b")
    correlations_figure(Correlations(names, np.array([[1.0, 0.5], [0.5, 1.0]])))
    rivals_figure([rival(f"a cause with many words {i}", 1.0 + i) for i in range(3)], {})
    for figure in drawn:
        require_room(figure)


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_a_machine_with_a_title_has_room(drawn: Drawn, suffix: str) -> None:
    machine_figure(sketch_of(read_model(ROOT / "models" / "cartpole.toml")), "Cart", suffix)
    require_room(drawn[0])


@pytest.mark.parametrize("size", [1e-9, 1.0, 123456.0, 1e9])
def test_numbers_of_any_size_have_room(drawn: Drawn, size: float) -> None:
    with drawing(4.0) as figure:
        for panel in figure.subplots(2, 1):
            panel.plot([0.0, size], [-size, size])
            panel.set_title("force")
            panel.set_xlabel("time")
        svg(figure)
    require_room(drawn[0])


def test_panels_share_the_height_by_their_ratios_and_the_whole_width() -> None:
    with drawing(4.0) as figure:
        upper, lower = figure.subplots(2, 1, height_ratios=[2.0, 1.0])
        lower.set_xlabel("time")
        picture(figure, ".png")
    boxes = [panel.get_position() for panel in (upper, lower)]
    assert boxes[0].height == pytest.approx(2.0 * boxes[1].height)
    assert boxes[0].x0 == boxes[1].x0 < 0.5 / WIDTH
    assert boxes[0].x1 == boxes[1].x1 > 1.0 - 0.3 / WIDTH
    assert boxes[1].y0 > 0.3 / 4.0  # its numbers and its label

"""What ``.plot()`` draws: the numbers on the axes, their names and units, whose axes they are."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from builders import DRIVEN_MASS
from fakes import friction, verdict
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import symhyb as sh
from symhyb.discrepancy.results import Cloud
from symhyb.model.types import On
from symhyb.units import parse_unit

MODEL = sh.parse_model(
    DRIVEN_MASS.replace(
        'laser = { measures = "x", unit = "m" }', 'laser = { measures = "x", unit = "mm" }'
    )
)
T = np.linspace(0.0, 10.0, 400)
RUN = sh.Recording.from_frame({"t": T, "f": np.sin(T), "laser": 3 * np.cos(T)}, MODEL, name="run")


@pytest.fixture(autouse=True)
def _unseen() -> Iterator[None]:
    """No window is opened, and no figure stays."""
    import matplotlib.pyplot as plt

    plt.switch_backend("Agg")
    yield
    plt.close("all")


def drawn(panel: Axes, number: int = 0) -> tuple[np.ndarray, np.ndarray]:
    return panel.lines[number].get_data()


def test_a_recording_has_a_panel_a_channel() -> None:
    panels = RUN.plot()
    assert [panel.get_ylabel() for panel in panels] == ["f [N]", "laser [mm]"]
    assert [panel.get_xlabel() for panel in panels] == ["", "time [s]"]
    assert panels[0].get_shared_x_axes().joined(*panels)
    np.testing.assert_array_equal(drawn(panels[1])[0], T)
    np.testing.assert_allclose(drawn(panels[1])[1], 3 * np.cos(T))
    assert panels[0].figure.get_suptitle() == "run"


def test_one_channel_is_drawn_on_the_axes_given() -> None:
    figure = Figure()
    ax = figure.subplots()
    assert RUN.plot("laser", ax=ax) is ax
    np.testing.assert_allclose(drawn(ax)[1], 3 * np.cos(T))
    assert ax.get_ylabel() == "laser [mm]"


def test_all_channels_go_together_on_one_axes_and_apart_on_several() -> None:
    ax = Figure().subplots()
    assert RUN.plot(ax=ax) is ax
    assert [line.get_label() for line in ax.lines] == ["f [N]", "laser [mm]"]
    assert ax.get_legend() is not None
    two = Figure().subplots(2)
    assert list(RUN.plot(ax=two)) == list(two)
    np.testing.assert_allclose(drawn(two[0])[1], np.sin(T))


def test_names_are_no_formulas_and_none_is_hidden() -> None:
    odd = sh.Recording("a $b$", T, {}, {"_x": T, "$y$": T})
    ax = odd.plot(ax=Figure().subplots())
    assert len(ax.get_legend().get_texts()) == 2
    assert not any(text.get_parse_math() for text in ax.get_legend().get_texts())
    panels = odd.plot("$y$")
    assert panels.get_ylabel() == "$y$ [SI]"
    assert not panels.yaxis.label.get_parse_math()
    panels.figure.canvas.draw()


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda: RUN.plot("lasr"), "there is no 'lasr' to draw; did you mean 'laser'"),
        (lambda: RUN.plot(ax="left"), "ax: must be axes of matplotlib, not str"),
        (
            lambda: RUN.plot(ax=Figure().subplots(3)),
            "ax: 2 panels are to be drawn; give one axes or 2, not 3",
        ),
        (lambda: verdict().plot("laser"), "there is no 'laser' to draw"),
        (lambda: replace(verdict(), traces=()).plot(), "no recording was given to judge on"),
        (lambda: sh.Diagnosis("undecided", "").plot(), r"nothing to draw.*\(undecided\)"),
    ],
)
def test_what_cannot_be_drawn_is_said(ask, said: str) -> None:
    with pytest.raises(sh.InputError, match=said):
        ask()


def test_a_run_shows_sensors_and_coordinates_and_rates_when_asked() -> None:
    run = sh.simulate(MODEL, end=1, start={"x": 0.1})
    panels = run.plot()
    assert [panel.get_ylabel() for panel in panels] == ["laser [mm]", "x [m]"]
    np.testing.assert_allclose(drawn(panels[0])[1], 1000 * run.q[:, 0])
    rate = run.plot("x'")
    assert rate.get_ylabel() == "x' [m/s]"
    np.testing.assert_array_equal(drawn(rate)[1], run.v[:, 0])


def test_a_gap_is_drawn_over_time_and_over_the_rate() -> None:
    run = sh.simulate(MODEL, end=10, step=0.02, inputs={"f": np.sin}, start={"x": 0.1})
    bare = replace(MODEL, elements=MODEL.elements[:1] + MODEL.elements[2:])  # without its damper
    seen = sh.Recording("run", run.t, {"f": np.sin(run.t)}, {"laser": run.q[:, 0]})
    gap = sh.compare(bare, seen)
    over_time, over_rate = gap.plot()
    assert over_time.get_ylabel() == over_rate.get_ylabel() == "ΔF on x [N]"
    np.testing.assert_array_equal(drawn(over_time)[1], gap.force[:, 0])
    speed, force = drawn(over_rate)
    assert np.polyfit(speed, force, 1)[0] == pytest.approx(-0.6, rel=0.05)  # the damper
    assert over_rate.get_xlabel() == "x' [m/s]"
    place = gap.plot("x", over="place", ax=Figure().subplots())
    np.testing.assert_array_equal(drawn(place)[0], gap.motion.q[:, 0])
    shown = gap.to_frame()
    assert list(shown.columns) == ["x", "x'", "x''", "dF_x", "dF_x_sd", "k_e_x"]
    np.testing.assert_array_equal(shown["dF_x"], gap.force[:, 0])
    np.testing.assert_array_equal(shown["k_e_x"], gap.applied[:, 0])
    np.testing.assert_array_equal(shown["dF_x_sd"], gap.band[:, 0])
    assert shown.attrs["units"]["dF_x"] == "N"
    with pytest.raises(sh.InputError, match="'speed' is none of time, rate, place"):
        gap.plot(over="speed")
    machine = sh.compare(sh.build(bare), seen)
    np.testing.assert_array_equal(machine.force, gap.force)


def test_a_verdict_shows_measured_before_and_after_on_what_is_unseen() -> None:
    said = verdict()
    trace = said.traces[0]
    mm = parse_unit("mm")
    trace = replace(trace, after={"position": 2 * trace.t}, units={"position": mm})
    training = replace(trace, role="train", measured={"position": 0 * trace.t})
    said = replace(said, traces=(training, trace))
    panel = said.plot("position")
    assert [line.get_label() for line in panel.lines] == ["measured", "before", "after"]
    np.testing.assert_allclose(drawn(panel)[1], 1000 * trace.measured["position"])
    np.testing.assert_allclose(drawn(panel, 2)[1], 2000 * trace.t)
    assert panel.get_ylabel() == "position [mm]"
    assert training.plot("position").get_ylabel() == "position [mm]"


def test_a_diagnosis_shows_its_law_through_what_is_missing() -> None:
    answer = friction(0.5)
    rate = np.sin(T)
    cloud = Cloud(
        On("q"), "run", T, T, rate, -0.5 * np.sign(rate) + 0.01, 0.1 + 0 * T, -0.5 * np.sign(rate)
    )
    elsewhere = replace(cloud, place=On("p"))
    model = sh.parse_model(DRIVEN_MASS.replace("x = {", "q = {").replace('"x"', '"q"'))
    answer = replace(answer, clouds=(cloud, elsewhere), model=model)
    over_rate, over_time = answer.plot("friction")
    np.testing.assert_array_equal(drawn(over_rate, 1)[0], rate)
    np.testing.assert_array_equal(drawn(over_rate, 1)[1], cloud.law)
    np.testing.assert_array_equal(drawn(over_time, 0)[1], cloud.force)
    assert over_rate.get_xlabel() == "rate [m/s]"
    assert over_rate.get_ylabel() == "ΔF on q [N]"
    one = answer.plot(ax=Figure().subplots())
    np.testing.assert_array_equal(drawn(one, 0)[0], rate)
    with pytest.raises(KeyError, match="there is no 'drag'"):
        answer.plot("drag")

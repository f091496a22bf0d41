"""Pictures: valid, labelled with units, and nothing lost where long series are thinned."""

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.report import figures
from symhyb.report.bars import Pair, places_figure, score_figure
from symhyb.report.canvas import DARK
from symhyb.report.figures import PlaceUnits
from symhyb.report.series import (
    binned,
    envelope,
    follows,
    halves,
    passages,
    shortened,
    shown_unit,
    zoom_window,
)
from symhyb.units import parse_unit

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]
UNITS = PlaceUnits(parse_unit("m"), parse_unit("m/s"), parse_unit("N"))


def texts(svg: bytes) -> str:
    """All the text that a picture shows (kept as comments beside the drawn letters)."""
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    root = ElementTree.fromstring(svg, parser)
    return "\n".join(node.text or "" for node in root.iter() if node.tag is ElementTree.Comment)


def test_traces_are_labelled_with_units(cases: Cases) -> None:
    trace = cases["missing"]()[1].traces[0]
    shown = texts(figures.trace_figure(trace, "encoder", parse_unit("mm")))
    for label in ("encoder [mm]", "residual [mm]", "time [s]", "measured", "before: RMS", "after"):
        assert label in shown


def test_without_a_correction_one_simulation_is_drawn(cases: Cases) -> None:
    trace = cases["null"]()[1].traces[0]
    shown = texts(figures.trace_figure(trace, "encoder", parse_unit("m")))
    assert "simulated: RMS" in shown
    assert "before" not in shown


def test_a_long_record_gets_a_zoom(cases: Cases) -> None:
    trace = cases["missing"]()[1].traces[0]
    wave = {"encoder": np.sin(2 * np.pi * 2.0 * trace.t)}
    long = replace(trace, measured=wave, before=wave, after=wave)
    assert "zoom: encoder" in texts(figures.trace_figure(long, "encoder", parse_unit("m")))
    assert "zoom" not in texts(figures.trace_figure(trace, "encoder", parse_unit("m")))


def test_clouds_are_labelled_with_units_and_name_the_law(cases: Cases) -> None:
    cloud = cases["missing"]()[0].clouds[0]
    shown = texts(figures.cloud_figure(cloud, UNITS))
    for label in ("ΔF [N]", "rate [m/s]", "stretch [m]", "found law", "mean"):
        assert label in shown
    shown = texts(figures.force_figure(cloud, UNITS.force))
    assert "ΔF [N]" in shown
    assert "time [s]" in shown
    bare = replace(cloud, law=np.zeros_like(cloud.law))
    assert "no law: 0" in texts(figures.cloud_figure(bare, UNITS))
    assert "found law" not in texts(figures.force_figure(bare, UNITS.force))


@pytest.mark.parametrize(
    ("values", "axis"),
    [((0.5, 0.01), "error [%], logarithmic"), ((0.5, 0.3), "error [%]"), ((None, None), "error")],
)
def test_scores_are_drawn_logarithmic_only_where_needed(
    values: tuple[float | None, float | None], axis: str
) -> None:
    shown = texts(score_figure([Pair("window error, laser", *values)]))
    assert axis in shown
    assert ("logarithmic" in axis) == ("logarithmic" in shown)
    assert ("not computable" in shown) == (values[0] is None)


def test_places_show_their_share() -> None:
    rows = [("on x", 0.9962, True), ("between anchor and tip", None, False)]
    shown = texts(places_figure(rows))
    for label in ("on x", "99.6 %", "between anchor and tip", "not computable", "mismatch [%]"):
        assert label in shown


@pytest.mark.parametrize("name", ["failed", "hostile"])
def test_gaps_and_hostile_names_still_make_valid_pictures(cases: Cases, name: str) -> None:
    diagnosis, verdict = cases[name]()
    for trace in verdict.traces:
        for sensor in trace.measured:
            assert texts(figures.trace_figure(trace, sensor, parse_unit("m")))
    for cloud in diagnosis.clouds:
        assert texts(figures.cloud_figure(cloud, UNITS))
        assert texts(figures.force_figure(cloud, UNITS.force))


def test_a_run_that_diverged_does_not_hide_the_others(cases: Cases) -> None:
    trace = cases["missing"]()[1].traces[0]
    runaway = {"encoder": np.exp(np.linspace(0.0, 700.0, len(trace.t)))}
    svg = figures.trace_figure(replace(trace, before=runaway), "encoder", parse_unit("m"))
    assert "before: RMS not known" in texts(svg)
    assert "residual [mm]" in texts(svg) or "residual [m]" in texts(svg)


def test_a_place_without_samples_is_drawn_empty(cases: Cases) -> None:
    cloud = cases["missing"]()[0].clouds[0]
    names = ("t", "stretch", "rate", "force", "band", "law")
    empty = replace(cloud, **{name: np.empty(0) for name in names})
    assert texts(figures.cloud_figure(empty, UNITS))
    assert texts(figures.force_figure(empty, UNITS.force))


def test_pictures_do_not_change_from_run_to_run(cases: Cases) -> None:
    cloud = cases["missing"]()[0].clouds[0]
    assert figures.cloud_figure(cloud, UNITS) == figures.cloud_figure(cloud, UNITS)


def test_thinning_keeps_every_peak_and_gap() -> None:
    t = np.linspace(0.0, 1.0, 100_000)
    y = np.sin(20.0 * t)
    y[54_321], y[12_345] = 9.0, -9.0
    y[70_000:80_000] = np.nan
    thin_t, thin_y = envelope(t, y, bins=100)
    assert len(thin_t) <= 200
    assert np.all(np.diff(thin_t) > 0.0)
    assert (np.nanmax(thin_y), np.nanmin(thin_y)) == (9.0, -9.0)
    assert np.isnan(thin_y).any()
    assert thin_t[np.nanargmax(thin_y)] == t[54_321]
    assert len(envelope(t[:100], y[:100], bins=100)[0]) == 100


def test_zoom_shows_a_few_cycles_where_most_happens() -> None:
    t = np.linspace(0.0, 100.0, 20_000)
    y = np.sin(2 * np.pi * t) * (1.0 + 4.0 * (np.abs(t - 70.0) < 5.0))
    noisy = y + np.random.default_rng(0).normal(0.0, 0.05, len(t))
    window = zoom_window(t, noisy)
    assert window is not None
    start, end = window
    assert 60.0 < start < end < 80.0
    assert 3.0 < end - start < 7.0
    assert zoom_window(t[:1000], y[:1000]) is None
    assert zoom_window(t, np.full_like(t, np.nan)) is None
    assert zoom_window(t, np.ones_like(t)) is None


def test_a_law_of_the_rate_is_drawn_exactly() -> None:
    rate = np.random.default_rng(0).uniform(-1.0, 1.0, 5000)
    law, band = -3.0 * rate, np.full(5000, 0.5)
    centre, middle, lower, upper = binned(rate, law, band)
    np.testing.assert_allclose(middle, -3.0 * centre, atol=1e-12)
    np.testing.assert_allclose(upper - lower, 1.0)
    assert all(part.size == 0 for part in binned(rate[:0], law[:0], band[:0]))


def test_branches_are_split_by_sign_or_at_the_median() -> None:
    below, above = halves(np.array([-2.0, -1.0, 1.0, 2.0]))
    assert below.tolist() == [True, True, False, False]
    assert above.tolist() == [False, False, True, True]
    assert halves(np.array([1.0, 2.0, 3.0, 4.0]))[1].tolist() == [False, False, True, True]


@pytest.mark.parametrize(
    ("size", "unit", "factor", "label"),
    [
        (20.0, "N", 1.0, "N"),
        (0.25, "m", 1.0, "m"),
        (0.02, "m", 1e-3, "mm"),
        (3e-5, "m/s", 1e-6, "µm/s"),
        (2e6, "N*s/m", 1e6, "10⁶ N·s/m"),
        (2e6, "N", 1e6, "MN"),
        (0.02, "m^2", 1e-3, "10⁻³ m²"),
        (3e-3, "kg", 1e-3, "10⁻³ kg"),
        (0.0, "m", 1.0, "m"),
        (float("nan"), "1", 1.0, ""),
    ],
)
def test_axes_take_the_prefix_that_reads_best(
    size: float, unit: str, factor: float, label: str
) -> None:
    assert shown_unit(size, unit) == (pytest.approx(factor), label)


def test_names_are_made_fit_for_a_picture() -> None:
    assert shortened("encoder") == "encoder"
    assert len(shortened("x" * 500)) == 60
    assert shortened("a\x1bb\n") == "a\ufffdb\ufffd"


def swing(samples: int = 4000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, stretches and rates of a motion of two tones, 20 s long."""
    t = np.linspace(0.0, 20.0, samples)
    tones = ((0.9, 0.03), (1.7, 0.015))
    stretch = sum(a * np.sin(2 * np.pi * f * t) for f, a in tones)
    rate = sum(2 * np.pi * f * a * np.cos(2 * np.pi * f * t) for f, a in tones)
    return t, np.asarray(stretch), np.asarray(rate)


def test_a_law_that_remembers_is_drawn_as_loops(cases: Cases) -> None:
    t, stretch, rate = swing()
    law = -30.0 * (stretch - 0.02 * np.tanh(rate))
    band = np.full_like(t, 0.1)
    cloud = replace(
        cases["missing"]()[0].clouds[0],
        t=t,
        stretch=stretch,
        rate=rate,
        force=law,
        law=law,
        band=band,
    )
    loops = texts(figures.cloud_figure(cloud, UNITS, remembers=True))
    assert "found law, a few cycles" in loops
    assert "mean" not in loops  # over loops it would mean nothing
    lines = texts(figures.cloud_figure(cloud, UNITS))
    assert "a few cycles" not in lines
    empty = replace(
        cloud, **{name: np.empty(0) for name in ("t", "stretch", "rate", "force", "band", "law")}
    )
    assert texts(figures.cloud_figure(empty, UNITS, remembers=True))


def test_a_law_is_drawn_only_over_what_it_is_a_function_of(cases: Cases) -> None:
    t, stretch, rate = swing()
    stop = -900.0 * np.maximum(stretch - 0.02, 0.0)
    old = cases["missing"]()[0].clouds[0]
    cloud = replace(old, t=t, stretch=stretch, rate=rate, force=stop, law=stop, band=0.1 + 0 * t)
    shown = texts(figures.cloud_figure(cloud, UNITS))
    assert "rate [m/s] (of which the found law is no function)" in shown
    assert "stretch [mm] (of which" not in shown
    whole = (np.ones_like(t, dtype=bool),)
    assert follows(stretch, stop, whole)
    assert not follows(rate, stop, whole)
    assert follows(stretch, -np.sign(rate), halves(rate))
    assert not follows(stretch, np.sin(2 * np.pi * 3.7 * t), halves(rate))
    assert follows(stretch, np.zeros_like(t), whole)
    assert follows(t[:0], t[:0], (np.zeros(0, dtype=bool),))


def test_means_are_of_passages_not_of_samples() -> None:
    """Of a triangle with 20 passages, one of which stays a thousand samples at one place."""
    once = np.concatenate([np.linspace(0.0, 1.0, 50), np.linspace(1.0, 0.0, 50)])
    x = np.concatenate([np.tile(once, 10), np.full(1000, 0.5)])
    y = 2.0 * x + np.random.default_rng(0).normal(0.0, 0.1, x.size)
    y[-1000:] += 5.0
    centre, mean, sd = passages(x, y, bins=5)
    assert centre.size == 5
    aside = np.arange(5) != 2
    np.testing.assert_allclose(mean[aside], 2.0 * centre[aside], atol=0.1)
    assert mean[2] < 2.0  # the long stay weighs as one passage of twenty-one
    assert np.all(sd > 0.0)
    assert passages(x[:0], y[:0])[0].size == 0
    assert passages(x[:50], y[:50])[0].size == 0  # one passage tells nothing of the scatter


def test_a_residual_far_larger_before_leaves_its_panel_and_that_is_said(cases: Cases) -> None:
    trace = cases["missing"]()[1].traces[0]
    shown = texts(figures.trace_figure(trace, "encoder", parse_unit("mm"), 0.04))
    assert "(beyond)" in shown
    near = replace(trace, after={"encoder": 0.9 * trace.before["encoder"]})
    assert "(beyond)" not in texts(figures.trace_figure(near, "encoder", parse_unit("mm"), 0.04))


def test_colours_follow_the_scheme_of_the_reader(cases: Cases) -> None:
    svg = figures.cloud_figure(cases["missing"]()[0].clouds[0], UNITS)
    assert b"prefers-color-scheme:dark" in svg
    drawn = re.sub(rb"<style>.*?</style>", b"", svg, flags=re.DOTALL)
    assert not [light for light in DARK if f": {light}".encode() in drawn]


def test_a_ripple_keeps_its_height_where_it_is_drawn() -> None:
    t, stretch, _ = swing()
    law = 1.5 * np.sin(2 * np.pi * stretch / 0.01)
    _, middle, _, _ = binned(stretch, law, np.zeros_like(t))
    assert middle.max() > 1.4
    assert middle.min() < -1.4


def test_the_zoom_of_the_force_leaves_out_the_ends(cases: Cases) -> None:
    t, stretch, rate = swing()
    force = np.sin(2 * np.pi * t) + 50.0 * (t > 19.9)
    old = cases["missing"]()[0].clouds[0]
    cloud = replace(old, t=t, stretch=stretch, rate=rate, force=force, law=0 * t, band=0.1 + 0 * t)
    shown = [line.strip() for line in texts(figures.force_figure(cloud, UNITS.force)).splitlines()]
    ticks = shown[shown.index("time [s]") + 1 : shown.index("ΔF [N], zoomed")]
    assert [float(tick.replace("\N{MINUS SIGN}", "-")) for tick in ticks][-1] == 1.0
    assert "40" in shown  # the whole recording above shows the end as it is

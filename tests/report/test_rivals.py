"""Where rivals would differ: on the page and in diagnosis.json."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from made_results import rival

from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.report import render_page, to_json
from symhyb.report.rivals import rival_sentence, rivals_figure
from symhyb.units import parse_unit

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]


def test_a_sentence_says_where_and_by_how_much() -> None:
    assert rival_sentence(rival("a delay in channel tacho", 1.4)) == (
        "A delay in channel tacho in place of viscous damping on q (probability 10 %): encoder "
        "would differ most, at t = 6.002 s of DATA_EMPS.mat, by 1.4 standard deviations of its "
        "noise (0.47 RMS over all windows); no single sample shows it."
    )
    assert "one sample there shows it" in rival_sentence(rival("drag on q", -2.5))


def test_a_rival_without_a_share_has_no_probability() -> None:
    said = rival_sentence(replace(rival("drag on q", 1.0), probability=None))
    assert said.startswith("Drag on q in place of viscous damping on q: encoder")


def test_rivals_that_show_the_same_are_said_to() -> None:
    said = rival_sentence(rival("drag on q", 0.0))
    assert said.endswith("nowhere in DATA_EMPS.mat would any sensor show a difference.")


def test_what_the_band_hides_is_enlarged() -> None:
    units = {"encoder": parse_unit("mm")}
    heights = [
        float(rivals_figure([rival("a", size)], units).split(b'height="')[1].split(b"pt")[0])
        for size in (3.0, 0.3)
    ]
    assert heights[1] > heights[0] + 80


@pytest.mark.parametrize("size", [0.0, 1e-9, 1e9])
def test_any_size_is_drawn(size: float) -> None:
    assert rivals_figure([rival("a", size), rival("b", size / 2)], {}).startswith(b"<?xml")


def test_at_most_three_sensors_are_drawn_those_that_differ_most() -> None:
    one = rival("a", 3.0)
    (values,) = one.apart.values()
    apart = {f"s{i}": i * values for i in range(6)}
    many = replace(one, apart=apart, noise=dict.fromkeys(apart, 1.2e-5))
    assert many.largest[0] == "s5"
    few = replace(many, apart={name: apart[name] for name in ("s3", "s4", "s5")})
    assert rivals_figure([many], {}) == rivals_figure([few], {})


def test_a_sensor_that_one_rival_alone_can_be_told_by_is_drawn() -> None:
    other = rival("b", 2.0, sensor="tacho")
    drawn = rivals_figure([rival("a", 1.0), other], {})
    assert drawn.startswith(b"<?xml")


@pytest.mark.slow
def test_the_page_shows_rivals_where_there_are_any(cases: Cases) -> None:
    shown = render_page("Slide", *cases["undecided"]())
    assert "Where the rivals would differ" in shown
    assert "What each rival would show beyond what was chosen" in shown
    assert "Where the rivals would differ" not in render_page("Slide", *cases["null"]())


def test_rivals_stand_in_the_contract(cases: Cases) -> None:
    first, second = to_json(*cases["undecided"]())["rivals"]
    assert (first["sensor"], first["recording"]) == ("encoder", "DATA_EMPS.mat")
    assert first["time_s"] == pytest.approx(6.0, abs=0.01)
    assert first["deviations"] == pytest.approx(1.4, rel=1e-3)
    assert second["deviations"] == pytest.approx(-0.3, rel=1e-3)
    assert first["rms"]["encoder"] == pytest.approx(0.47, abs=0.01)
    assert to_json(*cases["null"]())["rivals"] == []


def test_where_a_run_has_no_values_it_tells_nothing() -> None:
    one = rival("a", 1.0)
    blind = replace(one, apart={**one.apart, "tacho": np.full(one.t.size, np.nan)})
    assert blind.largest == one.largest
    assert blind.typical == one.typical

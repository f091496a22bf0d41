"""Figures that can be zoomed: what they hold, and that no peak is lost."""

import gzip
import json
from base64 import b64decode
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from made_results import HOSTILE

from symhyb.discrepancy.results import Diagnosis, Trace, Verdict
from symhyb.report.embed import embedded, library, policy_of
from symhyb.report.live import POINTS, Live, Signal, live_figures
from symhyb.report.series import extremes
from symhyb.units import parse_unit

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]
MM, NEWTON = parse_unit("mm"), parse_unit("N")


def columns(live: Live) -> dict[str, np.ndarray]:
    """The data of all figures by column."""
    found: dict[str, np.ndarray] = {}

    def look(node: Any) -> None:
        if isinstance(node, dict) and node.get("type") == "map":
            for key, value in node["entries"]:
                if isinstance(value, dict) and value.get("type") == "ndarray":
                    raw = b64decode(value["array"]["data"])
                    raw = gzip.decompress(raw) if raw[:2] == b"\x1f\x8b" else raw
                    found[key] = np.frombuffer(raw, value["dtype"])
        for one in node.values() if isinstance(node, dict) else node:
            if isinstance(one, dict | list):
                look(one)

    look(json.loads(json.dumps(live.item)))
    return found


def test_a_recording_is_drawn_on_one_axis_with_its_residual(cases: Cases) -> None:
    diagnosis, verdict = cases["missing"]()
    trace = replace(verdict.traces[0], band={"encoder": np.full(8000, 3e-4)})
    cloud = [(diagnosis.clouds[0], NEWTON, "on q")]
    live = live_figures(trace, [Signal("encoder", MM, 0.4)], cloud, "here")
    text = json.dumps(live.item)
    assert text.count('"name": "Range1d"') == 1
    assert text.count('"name": "Figure"') == 3
    assert [name for name, _, _ in live.switches] == [
        "measured",
        "before",
        "after",
        "left",
        "force",
        "law",
    ]
    held = columns(live_figures(trace, [Signal("encoder", MM, 0.4)], [], "here"))
    np.testing.assert_allclose(held["high"], 1.0, rtol=1e-5)  # mm, twice (0.3, 0.4)
    np.testing.assert_allclose(held["low"], -held["high"])
    assert held["measured"].dtype == np.float32


def test_an_uncorrected_run_has_one_simulation(cases: Cases) -> None:
    _, verdict = cases["null"]()
    live = live_figures(verdict.traces[0], [Signal("encoder", MM)], [], "here")
    assert [words for _, words, _ in live.switches] == ["measured", "simulated"]


def test_long_recordings_are_thinned_but_keep_their_peaks() -> None:
    t = np.linspace(0.0, 1000.0, 400_000)
    measured = np.sin(t)
    measured[123_457] = 7.0
    trace = Trace("a.csv", "train", t, {"s": measured}, {"s": 0 * t}, {"s": np.cos(t)})
    live = live_figures(trace, [Signal("s", parse_unit("m"))], [], "here")
    held = columns(live)
    assert held["measured"].max() == 7.0
    assert held["t"][[0, -1]].tolist() == [0.0, 1000.0]
    assert sum(column.size for column in held.values()) < POINTS
    few = live_figures(trace, [Signal("s", parse_unit("m"))], [], "here", share=0.02)
    assert columns(few)["measured"].max() == 7.0
    assert columns(few)["t"].size < held["t"].size / 5


def test_extremes_are_of_every_series() -> None:
    y, z = np.zeros(10_000), np.zeros(10_000)
    y[17], z[4711] = 1.0, -1.0
    kept = extremes([y, z], bins=20)
    assert {0, 17, 4711, 9999} <= {*kept.tolist()}
    assert kept.size < 100
    assert extremes([]).size == 0


def test_a_run_that_leaves_is_not_drawn_and_nothing_that_is_no_number(cases: Cases) -> None:
    _, verdict = cases["failed"]()
    for trace in verdict.traces:
        live = live_figures(trace, [Signal("encoder", MM, 0.1)], [], "here")
        embedded([live])  # refuses what JSON has no words for
    t = np.linspace(0.0, 1.0, 50)
    runaway = Trace("a", "train", t, {"s": t}, {"s": np.exp(700 * t)}, {"s": t})
    held = columns(live_figures(runaway, [Signal("s", parse_unit("m"))], [], "here"))
    assert np.nanmax(held["before"]) <= 2.0
    assert np.isnan(held["before"][-1])


def test_names_cannot_end_the_script_that_holds_them(cases: Cases) -> None:
    _, verdict = cases["hostile"]()
    live = live_figures(verdict.traces[0], [Signal(HOSTILE, MM)], [], "here")
    data = str(embedded([live]).data["figures"])
    assert not {"<", ">", "&"} & {*data}
    assert "alert" in json.dumps(json.loads(data))
    assert "</script" not in library().lower()


@pytest.mark.parametrize(("scripts", "said"), [((), "'none'"), (("a()",), "'sha256-")])
def test_the_policy_names_scripts_by_their_hash(scripts: tuple[str, ...], said: str) -> None:
    policy = policy_of(scripts)
    assert policy.startswith("default-src 'none'; ")
    assert policy.split("script-src ")[1].startswith(said)

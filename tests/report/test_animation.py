"""The machine that is played: what the page holds of it, and when there is none."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from made_results import HOSTILE
from moved import along, moved
from test_page import Page

from symhyb.report import render_page
from symhyb.report.animation import BEYOND, INSTANTS, WIDTH, Animation, animation, instants
from symhyb.report.embed import embedded, policy_of, script_of
from symhyb.report.pictures import machine_motion


def played() -> Animation:
    found = machine_motion(*moved())
    assert found is not None
    return found


def places(found: Animation, which: int) -> np.ndarray:
    """Where a shape is at every instant (F, numbers), as the script reads it."""
    size, *steps = found.data["moves"][which]
    return np.cumsum(np.reshape(steps, (-1, size)), axis=0)


def body_of(found: Animation) -> int:
    """Which of all shapes is the mass."""
    wanted = [("body", "polygon")]
    shapes = [(one.attributes["class"], one.tag) for one in found.shapes]
    return len(found.ghost) + shapes.index(wanted[0])


def test_a_body_is_shifted_as_it_was_measured() -> None:
    found = played()
    shift = places(found, body_of(found))
    assert shift.shape == (INSTANTS, 2)
    assert shift[0].tolist() == [0, 0]
    assert not shift[:, 1].any()
    t = np.array(found.data["t"])
    motion = np.sin(np.pi * t)  # of half a hertz
    scale = np.ptp(shift[:, 0]) / np.ptp(motion)  # units of the drawing, of the amplitude
    assert shift[:, 0] == pytest.approx(scale * motion, abs=1.5)
    assert 0.15 * WIDTH < 2 * scale < 0.8 * WIDTH


def test_what_stands_still_takes_one_number_and_springs_all_corners() -> None:
    found = played()
    sizes = {move[0] for move in found.data["moves"]}
    assert {0, 2} < sizes
    assert len(found.data["moves"]) == len(found.ghost) + len(found.shapes)
    kinds = [one.attributes["class"] for one in found.shapes]
    grounds = [i for i, kind in enumerate(kinds) if kind.startswith("ground")]
    assert grounds
    assert all(found.data["moves"][len(found.ghost) + i] == [0] for i in grounds)
    assert any(kind.endswith("shown") for kind in kinds)


def test_the_model_as_given_is_seen_until_it_stops() -> None:
    found = played()
    t = np.array(found.data["t"])
    assert found.data["seen"] == np.count_nonzero(t <= 7.5)
    shift = places(found, 0)
    assert np.abs(shift).max() <= 2 * BEYOND
    assert "a free run of the model as given" in found.caption
    assert "0 to 10 s of run.csv (unseen recording)" in found.caption


def test_without_a_motion_of_the_model_there_is_no_ghost() -> None:
    diagnosis, verdict, model = moved()
    trace = replace(verdict.traces[0], motion_before={})
    found = machine_motion(diagnosis, replace(verdict, traces=(trace,)), model)
    assert found is not None
    assert (found.ghost, found.data["seen"]) == ((), 0)
    assert "as given" not in found.caption


def test_the_first_unseen_recording_is_played() -> None:
    diagnosis, verdict, model = moved()
    seen = replace(verdict.traces[0], recording="train.csv", role="train")
    found = machine_motion(diagnosis, replace(verdict, traces=(seen, *verdict.traces)), model)
    assert found is not None
    assert "run.csv" in found.words


@pytest.mark.parametrize("spoiled", ["no motion", "no number", "one sample", "no trace", "lost"])
def test_nothing_is_played_where_the_motion_is_not_known(spoiled: str) -> None:
    diagnosis, verdict, model = moved()
    (trace,) = verdict.traces
    q = trace.motion["q"].copy()
    if spoiled == "no number":
        q[4] = np.nan
    if spoiled == "lost":
        q[4:] = 1e12
    trace = replace(trace, motion={} if spoiled == "no motion" else {"q": q})
    if spoiled == "one sample":
        trace = along(model, trace.t[:1], q[:1, None])
    traces = () if spoiled == "no trace" else (trace,)
    assert machine_motion(diagnosis, replace(verdict, traces=traces), model) is None


def test_nothing_is_played_where_nothing_was_found() -> None:
    diagnosis, verdict, model = moved()
    assert machine_motion(replace(diagnosis, found=()), verdict, model) is None
    assert machine_motion(diagnosis, verdict, None) is None


def test_a_machine_without_any_part_is_not_played() -> None:
    _, verdict, model = moved()
    assert animation(verdict, replace(model, elements=(), bodies=()), ["x"]) is None


def test_all_of_a_slow_motion_is_drawn_and_of_a_fast_one_the_first_lively_part() -> None:
    t = np.linspace(0, 100, 20001)
    slow = np.sin(0.3 * t)[:, None]
    assert instants(t, slow)[[0, -1]].tolist() == [0, 100]
    fast = np.where(t < 50, 0.0, np.sin(2 * np.pi * 5 * t))[:, None]
    drawn = instants(t, fast)
    assert drawn.size == INSTANTS
    assert 40 < drawn[0] < 52
    per_cycle = 0.2 / float(np.diff(drawn)[0])
    assert 10 < per_cycle < 14
    assert instants(t[:50], slow[:50]).size == 50
    assert instants(t, np.zeros((t.size, 1)))[[0, -1]].tolist() == [0, 100]


@pytest.mark.parametrize(("factor", "said"), [(0.01, "0.02 times"), (12.0, "4 times"), (1.0, "")])
def test_what_is_too_fast_or_too_slow_is_played_at_another_speed(factor: float, said: str) -> None:
    diagnosis, verdict, model = moved()
    (trace,) = verdict.traces
    other = replace(trace, t=factor * trace.t)
    found = machine_motion(diagnosis, replace(verdict, traces=(other,)), model)
    assert found is not None
    assert (said in found.caption) if said else ("times the speed" not in found.caption)
    assert 5 <= found.data["seconds"] <= 30


def page_of(name: str = "found_friction") -> tuple[str, Page]:
    diagnosis, verdict, model = moved(name)
    html = render_page("Oscillator", diagnosis, verdict, model=model)
    return html, Page(html)


def test_the_page_has_the_machine_that_moves_beside_its_still_picture() -> None:
    html, page = page_of()
    assert html.count('<figure class="motion" hidden>') == 1
    assert html.count('<figure class="motionless">') == 1
    held = page.values("meta", "content")
    (policy,) = [one for one in held if one and "default-src" in one]
    script = script_of("motion.js")
    assert policy_of([script]).split("script-src ")[1] in policy
    assert f"<script>{script}</script>" in html
    data = html.split('id="motion">')[1].split("</script>")[0]
    assert json.loads(data)["t"][-1] == 10.0
    assert len(data) < 200_000


def test_hostile_names_of_what_moves_stay_text() -> None:
    html, page = page_of(HOSTILE)
    assert "<script>alert" not in html
    assert page.seen.count("script") == 5
    assert any(HOSTILE[:10] in text for text in page.texts)


def test_a_page_without_a_machine_has_no_script_of_it() -> None:
    none: Any = embedded([])
    assert (none.data, none.scripts) == ({}, ())
    alone = embedded([], {"t": [0.0, 1.0]})
    assert [*alone.data] == ["motion"]
    assert len(alone.scripts) == 1

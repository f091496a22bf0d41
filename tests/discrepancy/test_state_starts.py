"""What is known of declared states where windows and recordings begin."""

import numpy as np
import pytest
from motors import L, R, motor, recorded

from symhyb.discrepancy.fitting.anchors import SPREAD, UNSEEN, anchored, begin_spread
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.runs import Run, cut_into_windows
from symhyb.discrepancy.recorded.watching import shown_states, watching_model
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.windows import WindowModel
from tests.motors import MOTOR


def cut(model: Model, ammeter: bool = False, length_s: float = 0.02) -> tuple[WindowModel, Cut]:
    machine, recording = build(model), recorded(ammeter, samples=400)
    motion = motion_of(recording, machine)
    found = cut_into_windows(Run(recording, motion, motion.sd), machine, length_s)
    assert found is not None
    return WindowModel(machine), found.suited(machine)


def test_a_sensor_of_a_state_shows_no_motion() -> None:
    model, recording = motor(ammeter=True), recorded(True, samples=50)
    watching, _ = watching_model(model, recording)
    assert watching.sensors.names() == ("encoder",)
    y = np.stack([recording.sensors[name] for name in ("encoder", "amps")], axis=1)
    assert shown_states(model, y).tolist() == [True]
    assert shown_states(model, y * [1, np.nan]).tolist() == [False]


def test_what_a_start_leaves_fades_as_the_state_forgets() -> None:
    """The windows begin every 25 ms; e^(−R t/L) of the RMS is left, beside 5 % of it."""
    model, item = cut(motor(), length_s=0.025)
    anchor = anchored(model, item, model.machine.values)
    course = item.course(model.machine)
    size = float(np.sqrt(np.mean(course.z[:, 0] ** 2)))
    elapsed = item.block.t[:, 0] - course.t[0]
    expected = size * np.hypot(SPREAD, np.exp(-elapsed * R / L))
    np.testing.assert_allclose(anchor.spread[:, 0], expected, rtol=0.03)
    assert begin_spread(model, item, model.machine.values, np.array([size])) == pytest.approx(size)


def test_a_state_that_is_measured_is_free_in_every_window() -> None:
    model, item = cut(motor(ammeter=True), ammeter=True)
    size = np.sqrt(np.mean(item.course(model.machine).z[:, 0] ** 2))
    assert np.all(anchored(model, item, model.machine.values).spread >= 0.999 * size)


def test_an_integrator_that_is_not_seen_may_begin_anywhere() -> None:
    """Along the motion it begins at its start; in a window a hundred times its RMS beside that."""
    text = MOTOR.replace(
        "[parameters]", "e = { unit = 'rad*s', start = 2.0, rate = 'phi' }\n[parameters]"
    )
    model, item = cut(parse_model(text))
    z = item.course(model.machine).z[:, 1]
    assert z[0] == 2.0
    anchor = anchored(model, item, model.machine.values)
    far = UNSEEN * np.sqrt(np.mean(z**2))
    np.testing.assert_allclose(anchor.spread[:, 1], far, rtol=1e-4)


def test_a_state_that_runs_away_under_trial_parameters_costs_as_much() -> None:
    model, item = cut(motor())
    p = model.machine.values.copy()
    p[model.machine.column("R")] = -1e4 * L / item.block.t.max()
    assert not np.all(anchored(model, item, p).spread < 1e150)

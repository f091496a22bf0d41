"""A sensor that lags, from recordings to the corrected model; machines and lags by SciPy alone."""

import json
from pathlib import Path

import numpy as np
import pytest
from builders import DRIVEN_MASS
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.model.read import parse_model

TAU = 0.05
HARDENING = (
    DRIVEN_MASS
    + """
[elements.hardens]
kind = "spring"
on = "x"
cubic = "k_3"
[parameters.k_3]
value = 400.0
unit = "N/m^3"
"""
)
TILTING = (
    DRIVEN_MASS
    + """
[coordinates.y]
unit = "m"
[inputs.g]
unit = "N"
[bodies.other]
mass = "m"
at = ["0", "y"]
[elements.holds]
kind = "spring"
on = "y"
stiffness = "k"
[elements.rubs]
kind = "damper"
on = "y"
damping = "d"
[elements.pushes]
kind = "force"
on = "y"
force = "g"
[sensors.camera]
measures = "y"
unit = "m"
"""
)


def late(seed: int, cubic: float, where: str) -> Recording:
    """Positions at 100 Hz of two masses of 1 kg on 25 N/m with 0.6 N·s/m, each under its multisine
    of 5 N, that do not act on each other; ``where``: what lags, the laser or the force f. The noise
    is 0.3 % of the deviation of each."""
    random = np.random.default_rng(seed)
    lines, phases = np.linspace(0.2, 2.5, 12), random.uniform(0, 2 * np.pi, (2, 12))

    def push(t: float, which: int) -> float:
        waves = np.sin(2 * np.pi * lines * t + phases[which])
        return float(5.0 * np.sqrt(2 / 12) * waves.sum())

    def rate(t: float, s: np.ndarray) -> list[float]:
        x, v, y, w, z = s
        f = push(t, 0)
        follows = f if where == "force" else x
        acts = z if where == "force" else f
        pull = 25 * x + cubic * x**3 + 0.6 * v
        return [v, acts - pull, w, push(t, 1) - 25 * y - 0.6 * w, (follows - z) / TAU]

    t = np.arange(0, 15.0, 0.01)
    run = solve_ivp(rate, (0, 15), [0.0] * 5, t_eval=t, rtol=1e-8, atol=1e-10, max_step=0.01)
    shown = {"laser": run.y[0] if where == "force" else run.y[4], "camera": run.y[2]}
    sensors = {
        name: y + 0.003 * y.std() * random.standard_normal(t.size) for name, y in shown.items()
    }
    inputs = {name: np.array([push(s, i) for s in t]) for i, name in enumerate("fg")}
    return Recording("rig.csv", t, inputs, sensors, (), "")


def of_one(recording: Recording) -> Recording:
    """The recording of the first mass alone."""
    inputs = {"f": recording.inputs["f"]}
    return Recording("rig.csv", recording.t, inputs, {"laser": recording.sensors["laser"]}, (), "")


@pytest.mark.slow
def test_a_sensor_that_lags_is_named_and_written_as_a_state(tmp_path: Path) -> None:
    model = parse_model(HARDENING)
    seen, unseen = (of_one(late(seed, 400.0, "laser")) for seed in (1, 2))
    diagnosis = sh.diagnose(model, seen)
    assert diagnosis.verdict == "measurement"
    assert "laser shows what it measures through a lag of" in diagnosis.sentence
    (lag,) = diagnosis.measurement
    assert (lag.channel, lag.kind, lag.unit) == ("laser", "sensor_lag", "s")
    assert lag.value == pytest.approx(TAU, abs=3 * lag.sd)
    assert lag.sd < 0.01 * TAU
    assert not any((diagnosis.found, diagnosis.parameters, diagnosis.classes))
    corrected = sh.apply(model, diagnosis.found, diagnosis.parameters, diagnosis.measurement)
    assert corrected.sensors["laser"].measures.text == "laser_late"
    verdict = sh.judge(model, corrected, on=unseen)
    before, after = (
        scores.free_run_nrmse["laser"] for scores in (verdict.holdout.before, verdict.holdout.after)
    )
    assert before
    assert after
    assert after < 0.1 * before
    sh.write_model(corrected, tmp_path / "corrected.toml")
    assert sh.read_model(tmp_path / "corrected.toml").states == corrected.states
    sh.write_report(tmp_path / "report.html", diagnosis, verdict)
    sh.write_diagnosis(tmp_path / "diagnosis.json", diagnosis, verdict)
    said = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))
    assert [(one["channel"], one["kind"]) for one in said["measurement"]] == [
        ("laser", "sensor_lag")
    ]


@pytest.mark.thorough
def test_an_input_that_lags_is_named_as_before_and_no_sensor() -> None:
    """Where the machine bends, its motion shows on which side the lag is."""
    diagnosis = sh.diagnose(parse_model(HARDENING), of_one(late(1, 400.0, "force")))
    assert diagnosis.verdict == "missing physics"
    (lag,) = diagnosis.measurement
    assert (lag.channel, lag.kind) == ("f", "lag")
    assert lag.value == pytest.approx(TAU, abs=3 * lag.sd)


@pytest.mark.slow
@pytest.mark.parametrize("where", ["laser", "force"])
def test_on_one_of_two_axes_that_are_linear_nothing_is_named_but_the_way(where: str) -> None:
    """Two inputs and two sensors, and yet no motion shows which end of an axis lags: it was named
    as a lag of the input, whichever it was."""
    diagnosis = sh.diagnose(parse_model(TILTING), late(1, 0.0, where))
    assert diagnosis.verdict == "undecided"
    assert not diagnosis.measurement
    (one, *_) = diagnosis.classes
    assert one.sentence.startswith("Something lags on the way from the input f to laser, of the ")
    lags = {a.channel: a for a in diagnosis.alternatives if a.kind in ("lag", "sensor_lag")}
    assert lags.keys() == {"f", "laser"}
    for rival in lags.values():
        (number,) = rival.estimates
        assert number.value == pytest.approx(TAU, abs=3 * number.sd)
    assert diagnosis.record_next is not None
    assert diagnosis.record_next.startswith("What acts in place of f, behind its actuator")

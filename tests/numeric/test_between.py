"""Inputs that are smooth between samples, against the closed form of a linear oscillator."""

from dataclasses import replace

import numpy as np
import pytest
from builders import DRIVEN_MASS

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.windows import lay
from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.model.write import text_of
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.between import finer
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import WindowModel

TEXT = DRIVEN_MASS.replace("25.0", "100.0").replace(", sd = 0.5", "").replace("0.6", "2.0")
SMOOTH = ', between = "smooth"'
RATE = 10.0  # rad/s, of excitation and resonance
STEP = 2 * np.pi / RATE / 9  # nine samples a period


def model(more: str = "") -> Model:
    return parse_model(TEXT.replace('f = { unit = "N"', f'f = {{ unit = "N"{more}'))


def steady(t: Array) -> tuple[Array, Array]:
    """Position and speed under sin(10 t), at resonance: x = −cos(10 t)/20."""
    return -np.cos(RATE * t) / (2 * RATE), np.sin(RATE * t) / 2


def missed(more: str) -> float:
    """How far CVODES comes out from the closed form, relative."""
    t = np.arange(200) * STEP
    x, v = steady(t)
    scenario = Scenario(t, x[:1], v[:1], t, np.sin(RATE * t)[:, None])
    run = simulate(build(model(more)), scenario)
    return float(np.abs(run.q[:, 0] - x).max() * 2 * RATE)


def test_a_line_cuts_the_corners_and_a_spline_does_not() -> None:
    cut = (RATE * STEP / 2) ** 2 / 3  # to first order, of the fundamental
    assert missed("") == pytest.approx(cut, rel=0.15)
    assert missed(SMOOTH) < cut / 50


@pytest.mark.parametrize("delay", [0.0, 0.02])
def test_windows_follow_the_spline_and_its_delay(delay: float) -> None:
    machine = build(model(SMOOTH + (f", delay = {delay}" if delay else "")))
    t = np.arange(300) * STEP
    x, v = steady(t)
    recording = Recording("r", t, {"f": np.sin(RATE * (t + delay))}, {"laser": x}, (), "")
    cut = lay(recording, machine, motion_of(recording, machine), 2.0, np.full(299, 8))
    assert cut is not None
    start = np.column_stack([x, v])[cut.rows[:, 0]]
    _, y = WindowModel(machine).simulate(cut.block, start, machine.values)
    inner = cut.rows[:, 0] > 5  # the delayed signal is not known before its first sample
    assert np.abs(y - x[cut.rows][..., None])[inner].max() * 2 * RATE < 2e-3


def test_other_columns_stay_lines() -> None:
    t = np.array([0.0, 1.0, 2.0, 4.0, 5.0, 6.0, 7.0])
    at, values = finer(t, np.column_stack([t**2, t**2]), (1,))
    assert values[:, 1] == pytest.approx(at**2)
    assert np.array_equal(values[:, 0], np.interp(at, t, t**2))
    assert finer(t, np.zeros((7, 1)), ())[0] is t


def test_the_word_is_checked_and_written() -> None:
    with pytest.raises(
        InputError, match="must be one of line, smooth, held, not 'smoth'; did you mean"
    ):
        model(', between = "smoth"')
    assert model(SMOOTH).inputs[0].between == "smooth"
    rendered = text_of(replace(model(SMOOTH), text=""))
    assert parse_model(rendered).inputs == model(SMOOTH).inputs

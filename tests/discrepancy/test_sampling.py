"""How inputs run between their samples, where the model file leaves that open."""

import numpy as np
import pytest
from builders import DRIVEN_MASS
from numpy.typing import NDArray

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.runs.between import FEWEST, looks_smooth

Array = NDArray[np.float64]
T = np.arange(2001) / 100.0
RANDOM = np.random.default_rng(0)


def reported(values: Array, name: str = "r") -> Recording:
    return Recording(name, T, {"f": values}, {"laser": np.zeros(T.size)}, (), "")


def model(more: str = "") -> Model:
    return parse_model(DRIVEN_MASS.replace('f = { unit = "N"', f'f = {{ unit = "N"{more}'))


@pytest.mark.parametrize(
    ("values", "smooth"),
    [
        (np.sin(2 * np.pi * 4 * T), True),
        (np.sin(2 * np.pi * 4 * T) + np.sin(2 * np.pi * 9.3 * T), True),
        (np.sign(np.sin(2 * np.pi * 0.7 * T)), False),
        (np.repeat(RANDOM.standard_normal(201), 10)[: T.size], False),
        (np.sin(2 * np.pi * 0.5 * T) + 0.02 * RANDOM.standard_normal(T.size), False),
        (np.where(T > 5.03, np.sin(2 * np.pi * 0.5 * T), 0.0), False),
    ],
    ids=["sine", "two sines", "square", "held", "noisy", "switched on"],
)
def test_left_out_samples_tell_what_is_smooth(values: Array, smooth: bool) -> None:
    assert looks_smooth(T, values) is smooth
    assert as_sampled(model(), [reported(values)]).inputs[0].between == (
        "smooth" if smooth else "line"
    )


def test_few_samples_and_constant_signals_are_lines() -> None:
    few = slice(0, FEWEST - 2)
    assert not looks_smooth(T[few], np.sin(T[few]))
    assert as_sampled(model(), [reported(0 * T)]).inputs[0].between == "line"


def test_all_recordings_must_agree_and_the_file_goes_first() -> None:
    sine, square = reported(np.sin(9 * T)), reported(np.sign(np.sin(2 * T)))
    assert as_sampled(model(), [sine, reported(0 * T)]).inputs[0].between == "smooth"
    assert as_sampled(model(), [sine, square]).inputs[0].between == "line"
    stated = model(', between = "line"')
    assert as_sampled(stated, [sine]) is stated
    assert as_sampled(model(), ()).inputs[0].between == "line"


@pytest.mark.thorough
def test_a_smooth_input_is_no_missing_physics() -> None:
    """At 25 samples a period and 0.1 % noise the corners that lines cut would be seen."""
    omega, m, k, d = 2 * np.pi * 4, 1.0, 25.0, 0.6
    gain = 1 / (k - m * omega**2 + 1j * d * omega)
    slow, weak = 2 * np.pi * 0.7, 1 / (k - m * (2 * np.pi * 0.7) ** 2 + 1j * d * 2 * np.pi * 0.7)
    f = 40 * np.sin(omega * T) + np.sin(slow * T)
    x = np.imag(40 * gain * np.exp(1j * omega * T) + weak * np.exp(1j * slow * T))
    noise = 1e-3 * x.std() * np.random.default_rng(1).standard_normal(T.size)
    run = Recording("r", T, {"f": f}, {"laser": x + noise}, (), "")
    assert sh.diagnose(model(), run).verdict == "nothing missing"
    assert sh.diagnose(model(', between = "line"'), run).verdict != "nothing missing"

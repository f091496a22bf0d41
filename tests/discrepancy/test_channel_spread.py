"""What of a residual is noise: neither what bursts, nor what a model gets wrong."""

import numpy as np
import pytest
from builders import model_of, oscillator, recording

from symhyb.discrepancy.recorded.channel_spread import noise_spread
from symhyb.discrepancy.recorded.cyclic import cyclic
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build

NOISE = 0.02
T = np.arange(0, 4, 1e-3)


def residual(seed: int = 3) -> np.ndarray:
    return np.random.default_rng(seed).normal(0, NOISE, T.size)


def test_normal_noise_is_its_root_mean_square() -> None:
    left = residual()
    spread = noise_spread(left, np.sin(T) + left, T)
    assert spread == pytest.approx(float(np.sqrt(np.mean(left**2))), rel=1e-3)


def test_noise_that_grows_with_the_signal_counts_whole() -> None:
    left = residual() * np.abs(np.sin(3 * T)) * np.sqrt(2)
    assert noise_spread(left, np.sin(3 * T) + left, T) == pytest.approx(NOISE, rel=0.05)


def test_what_a_spline_misses_after_impacts_is_no_noise() -> None:
    left = residual()
    for begin in range(100, T.size - 50, 300):
        left[begin : begin + 6] += 1.0
    assert np.sqrt(np.mean(left**2)) > 5 * NOISE
    assert noise_spread(left, np.sin(T) + left, T) == pytest.approx(NOISE, rel=0.1)


def test_few_samples_and_none() -> None:
    left = residual()[:30]
    assert noise_spread(left, left, T[:30]) == pytest.approx(float(np.sqrt(np.mean(left**2))))
    assert np.isnan(noise_spread(np.full(9, np.nan), np.full(9, np.nan), T[:9]))


def circuit(capacitor: bool = False) -> Model:
    stored = " + q**2/(2*C)" if capacitor else ""
    return model_of(
        coordinates={"x": {"unit": "m"}, "q": {"unit": "C"}},
        inputs={"u": {"unit": "V"}},
        parameters={
            "m": (0.2, "kg"),
            "k": (80.0, "N/m"),
            "d": (0.5, "N*s/m"),
            "L": (2e-3, "H"),
            "R": (1.5, "ohm"),
            "C": (1e-3, "F"),
            "b": (0.8, "N/A"),
        },
        energy={"kinetic": "m*x'**2/2 + L*q'**2/2", "potential": "k*x**2/2" + stored},
        elements={
            "damper": {"kind": "damper", "on": "x", "damping": "d"},
            "coil": {"kind": "law", "on": "x", "force": "b*q'"},
            "circuit": {"kind": "law", "on": "q", "force": "u - R*q' - b*x'"},
        },
        sensors={
            "place": {"measures": "x", "unit": "m"},
            "current": {"measures": "q'", "unit": "A"},
        },
    )


def test_a_charge_without_a_capacitor_is_cyclic() -> None:
    u = np.zeros((T.size, 1))
    assert cyclic(build(circuit()), u, T) == {1}
    assert cyclic(build(circuit(capacitor=True)), u, T) == frozenset()
    assert cyclic(build(oscillator({})), np.zeros((T.size, 0)), T) == frozenset()


def test_the_model_does_not_bend_a_motion_that_sensors_show_but_for_a_constant() -> None:
    """The circuit's force is ten times what the model says: that is not the encoder's noise."""
    random = np.random.default_rng(0)
    x, current = 1e-2 * np.sin(20 * T), 0.5 * np.cos(20 * T)
    run = recording(
        T,
        {"u": 9.0 * np.sin(20 * T)},
        place=x + random.normal(0, 1e-5, T.size),
        current=current + random.normal(0, 1e-2, T.size),
    )
    motion = motion_of(run, build(circuit()))
    assert motion.blind == ()
    assert motion.sd == pytest.approx([1e-5, 1e-2], rel=0.1)
    assert motion_of(run, build(circuit(capacitor=True))).blind == ("q",)

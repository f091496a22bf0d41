"""Sentences on sampling, missing samples, clipping and steps, each against what was planted."""

import numpy as np
import pytest

from symhyb.data.inspection import lattice_step, sampling_notes, sensor_notes
from symhyb.data.recording import read_recording
from symhyb.units import parse_unit

T = np.arange(4000) / 1000
WAVE = np.sin(2 * np.pi * 1.3 * T) + 0.2 * np.sin(2 * np.pi * 7.1 * T)


def random() -> np.random.Generator:
    """The same numbers in every test, whichever ran before."""
    return np.random.default_rng(3)


def notes(values, unit="m", t=T):
    return list(sensor_notes(t, {"x": values}, {"x": parse_unit(unit)}))


def test_even_sampling_is_not_worth_a_word():
    assert list(sampling_notes(T)) == []
    assert list(sampling_notes(1e4 + T)) == []
    assert list(sampling_notes(np.round(np.arange(500) / 100, 6))) == []


def test_uneven_sampling_is_noted_with_its_steps():
    steps = np.tile([0.009, 0.010, 0.012], 100)
    (note,) = sampling_notes(np.cumsum(steps))
    assert note == ("sampling is uneven: steps of 0.009 to 0.012 s, median 0.01 s; kept as it is")


def test_gaps_are_noted_with_their_place_and_do_not_make_sampling_uneven():
    t = np.concatenate([T[:1000], T[1500:2000], T[3000:]])
    assert list(sampling_notes(t)) == [
        "2 gaps in time: t = 0.999 … 1.5 s, 1.999 … 3 s (step otherwise 0.001 s)"
    ]


def test_many_gaps_are_counted():
    t = np.concatenate([np.arange(10) * 0.01 + k for k in range(6)])
    (note,) = sampling_notes(t)
    assert note.startswith("5 gaps in time: t = 0.09 … 1 s, ")
    assert "and 2 more" in note


def test_a_plain_noisy_signal_is_not_worth_a_word():
    assert notes(WAVE + 0.01 * random().standard_normal(T.size)) == []
    assert notes(WAVE) == []


def test_missing_samples_are_noted_with_the_longest_block():
    values = WAVE + 0.01 * random().standard_normal(T.size)
    values[[5, 6, 900]] = np.nan
    values[1200:1500] = np.nan
    assert notes(values) == [
        "sensor x: 303 of 4000 samples are missing;"
        " the longest block lasts 0.3 s, t = 1.2 … 1.499 s"
    ]
    values = WAVE.copy()
    values[[500, 900]] = np.nan
    assert notes(values) == [
        "sensor x: 2 of 4000 samples are missing, one at a time, first at t = 0.5 s"
    ]


def test_constant_channels_are_noted(model, write, table, signals):
    signals["f"][:] = -2.5
    signals["accel"][:] = 9.81
    recording = read_recording(write("run.csv", table(signals)), model)
    assert recording.notes == (
        "input f is constant at -2.5 N",
        "sensor accel is constant at 9.81 m/s^2",
    )


def test_saturation_is_noted_with_level_and_longest_run():
    noisy = WAVE + 0.01 * random().standard_normal(T.size)
    (note,) = notes(np.minimum(noisy, 0.9) / 1e3, "mm")
    share = 100 * np.mean(noisy >= 0.9)
    assert note.startswith(
        f"sensor x stands at its maximum of 0.9 mm in {share:.2g} % of the samples (longest: t = "
    )
    both = notes(np.clip(noisy, -0.5, 0.9))
    assert ["maximum" in both[0], "minimum" in both[1], len(both)] == [True, True, 2]


@pytest.mark.parametrize("step", [0.001, 0.01, 0.05])
def test_crests_of_a_coarse_signal_are_not_called_saturation(step):
    coarse = np.round((WAVE + 0.01 * random().standard_normal(T.size)) / step) * step
    assert not any("stands at" in note for note in notes(coarse))


def test_single_samples_at_the_extreme_are_not_called_saturation():
    spikes = WAVE + 0.01 * random().standard_normal(T.size)
    spikes[::40] = 3.0
    assert not any("stands at" in note for note in notes(spikes))


def test_a_coarse_signal_that_is_clipped_is():
    coarse = np.round(np.minimum(WAVE, 0.7) / 0.02) * 0.02
    assert any("stands at its maximum of 0.7 m" in note for note in notes(coarse))


@pytest.mark.parametrize("step", [1e-4, 8.7266e-5, 0.0123, 0.2])
@pytest.mark.parametrize("offset", [0.0, 0.31415, -20.0])
def test_quantisation_is_noticed_and_measured(step, offset):
    slow = 0.5 * np.sin(2 * np.pi * 0.05 * T) if step < 1e-3 else WAVE
    quantised = offset + np.round(slow / step) * step
    assert lattice_step(quantised) == pytest.approx(step, rel=1e-6)


def test_a_lattice_with_empty_places_still_shows():
    counts = random().choice([0, 2, 3, 7, 11, 12], 500)
    assert lattice_step(1.5 + 0.25 * counts) == pytest.approx(0.25)


def test_rounding_of_the_last_digit_does_not_hide_a_lattice():
    counts = random().integers(0, 500, 1000)
    assert lattice_step(np.concatenate([counts * 0.1, counts * 0.3 / 3])) == pytest.approx(0.1)


def test_a_few_values_beside_the_lattice_do_not_hide_it():
    values = np.round(WAVE / 0.02) * 0.02
    strays = random().choice(values.size, 60, replace=False)
    values[strays] += 0.02 * random().random(60)
    assert lattice_step(values) == pytest.approx(0.02)


@pytest.mark.parametrize(
    "values",
    [
        np.cumsum(random().choice([1, 20000], 1000)) * 1e-9,  # finer than the digits of a file
        random().standard_normal(1000),
        np.round(random().standard_normal(1000), 9),
        random().standard_normal(1000).astype(np.float32).astype(float),
        np.repeat(random().standard_normal(300), 4),  # a slow sensor, held
        np.repeat([0.0, 1.0, 3.0, 4.0], 50),  # so few levels are on a lattice by chance
    ],
)
def test_no_lattice_is_seen_where_there_is_none(values):
    assert lattice_step(values) is None


def test_the_step_is_said_in_the_unit_of_the_model():
    assert notes(np.round(WAVE / 0.01) * 0.01 / 1e3, "mm") == [
        "sensor x is quantised in steps of 0.01 mm (noise at least 0.002887 mm)"
    ]

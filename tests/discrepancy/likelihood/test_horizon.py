"""The noise model by maximum likelihood: planted forces and coloured sensors are distinguished."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.likelihood.horizon import maximised, total
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import Track, smoothed, track
from symhyb.numeric.runs.windows import WindowModel
from tests.pushed import NOISE, lowered, markov, pushed, task_of

MACHINE = lowered()
SAMPLES = 1500
BEGIN = NoiseModel(np.array([0.4]), 0.4, np.array([NOISE]), np.array([0.5 * NOISE]), 0.4)
FLOOR = np.array([1e-2 * NOISE])


def along(recording: Recording) -> list[Track]:
    """The tracks of a recording along its measured motion (the machine is linear: any will do)."""
    task = task_of(MACHINE, recording)
    model = WindowModel(MACHINE)
    return [track(model, item, item.states[0], MACHINE.values) for item in task.items]


def unknown(seed: int, rms: float, memory_s: float) -> NDArray[np.float64]:
    return markov(np.random.default_rng(1000 + seed), SAMPLES, rms, memory_s)


def test_an_unknown_force_is_recovered_with_its_course() -> None:
    """150 correlation times: the RMS is known to some 6 %."""
    planted = unknown(1, 1.0, 0.2)
    tracks = along(pushed(1, samples=SAMPLES, beside=planted))
    noise, _ = maximised(tracks, BEGIN, FLOOR)
    assert noise.force[0] == pytest.approx(float(planted.std()), rel=0.2)
    assert 0.1 < noise.memory_s < 0.4
    assert noise.white[0] == pytest.approx(NOISE, rel=0.1)
    assert noise.colour[0] == 0
    (force,) = (smoothed(one, noise, np.zeros(0)) for one in tracks)
    error = (force.force[:, 0] - planted) / force.force_sd[:, 0]
    assert 0.8 < float(error.std()) < 1.2
    assert np.corrcoef(force.force[:, 0], planted)[0, 1] > 0.9


@pytest.mark.parametrize("seed", range(5))
def test_white_noise_alone_leaves_no_force_and_no_colour(seed: int) -> None:
    noise, logl = maximised(along(pushed(seed, samples=SAMPLES)), BEGIN, FLOOR)
    assert noise.force[0] == 0
    assert noise.colour[0] == 0
    assert noise.white[0] == pytest.approx(NOISE, rel=4 / np.sqrt(2 * SAMPLES))
    assert np.isfinite(logl)


@pytest.mark.parametrize("seed", range(3))
def test_a_coloured_sensor_and_an_unknown_force_are_reported_apart(seed: int) -> None:
    coloured = along(pushed(seed, samples=SAMPLES, colour=(5 * NOISE, 0.05)))
    forced = along(pushed(seed, samples=SAMPLES, beside=unknown(seed, 0.5, 0.3)))
    gains = []
    for tracks in (coloured, forced):
        _, by_force = maximised(tracks, BEGIN, FLOOR, colour=False)
        _, by_colour = maximised(tracks, BEGIN, FLOOR, force=False)
        gains.append(by_force - by_colour)
    assert gains[0] < -100
    assert gains[1] > 100


def test_where_both_act_both_are_found() -> None:
    made = pushed(7, samples=SAMPLES, beside=unknown(7, 1.0, 0.3), colour=(5 * NOISE, 0.05))
    noise, _ = maximised(along(made), BEGIN, FLOOR)
    assert noise.force[0] == pytest.approx(1.0, rel=0.4)
    assert noise.colour[0] == pytest.approx(5 * NOISE, rel=0.3)


def test_it_is_a_maximum() -> None:
    tracks = along(pushed(3, samples=SAMPLES, beside=unknown(3, 0.5, 0.3)))
    noise, logl = maximised(tracks, BEGIN, FLOOR)
    assert total(tracks, noise) == pytest.approx(logl)
    for share in (0.8, 1.25):
        for changed in (
            replace(noise, force=share * noise.force),
            replace(noise, memory_s=share * noise.memory_s),
            replace(noise, white=share * noise.white),
        ):
            assert total(tracks, changed) < logl


def test_sizes_that_are_none_stay_none_and_no_sensor_is_better_than_its_floor() -> None:
    tracks = along(pushed(3, samples=SAMPLES, beside=unknown(3, 0.5, 0.3)))
    noise, _ = maximised(tracks, BEGIN.without_force(), FLOOR)
    assert noise.force[0] == 0
    assert noise.coloured
    high = np.array([3 * NOISE])
    held, _ = maximised(tracks, BEGIN, high)
    assert held.white[0] == pytest.approx(3 * NOISE)


def test_a_noise_model_counts_its_numbers() -> None:
    assert BEGIN.numbers == 5
    assert BEGIN.without_force().numbers == 3
    assert BEGIN.without_force().without_colour().numbers == 1

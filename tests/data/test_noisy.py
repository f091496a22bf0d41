"""Noise that is added to recordings: its size, and what its random numbers depend on."""

import numpy as np

from symhyb.data.noisy import noisier
from symhyb.data.recording import Recording

T = np.linspace(0, 10, 4001)


def recording(name: str = "a.csv", phase: float = 0.0) -> Recording:
    y = 3 * np.sin(5 * T + phase)
    y[7] = np.nan
    return Recording(name, T, {"f": np.cos(T)}, {"y": y, "z": 0.1 * y})


def test_every_sensor_gets_a_part_of_its_deviation() -> None:
    plain = recording()
    (noisy,) = noisier([plain], 0.05, seed=1)
    for name in ("y", "z"):
        added = (noisy[name] - plain[name])[np.isfinite(plain[name])]
        wanted = 0.05 * np.nanstd(plain[name])
        assert abs(added.std() / wanted - 1) < 4 / np.sqrt(2 * added.size)
        assert abs(added.mean()) < 4 * wanted / np.sqrt(added.size)
    assert np.isnan(noisy["y"][7])
    assert noisy["f"] is plain["f"]
    assert noisy.sha256 == plain.sha256
    assert noisy.notes == ("noise of 5 % of its standard deviation was added to each sensor",)


def test_its_random_numbers_are_those_of_seed_recording_and_sensor() -> None:
    first, second = recording(), recording("b.csv", phase=1)
    (alone,) = noisier([first], 0.05, seed=1)
    _, beside = noisier([second, first], 0.05, seed=1)
    assert np.array_equal(alone["y"], beside["y"], equal_nan=True)
    (other,) = noisier([first], 0.05, seed=2)
    (double,) = noisier([first], 0.1, seed=1)
    assert not np.array_equal(alone["y"], other["y"], equal_nan=True)
    np.testing.assert_allclose(double["y"] - first["y"], 2 * (alone["y"] - first["y"]), atol=1e-12)
    drawn = [(alone[name] - first[name])[8:] / np.nanstd(first[name]) for name in ("y", "z")]
    assert abs(np.corrcoef(*drawn)[0, 1]) < 4 / np.sqrt(drawn[0].size)


def test_a_level_of_zero_changes_nothing() -> None:
    plain = recording()
    assert noisier([plain], 0.0, seed=1) == (plain,)

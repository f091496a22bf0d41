"""The study of the beam whose support moves: what it reads and follows of a made signal."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from tests.scripts import scripts

HEAD = "file\nProgrammer - None\n\nSampling Frequency - 5000\nday\nAccel\tPinLoc\tTime\nunits\n\n\n"
RATE = 5000


@pytest.fixture(scope="module")
def study() -> Iterator[Mapping[str, ModuleType]]:
    with scripts("dropbear", ("measure",)) as found:
        yield found


def ringing(frequency: float, t: np.ndarray, begin: float) -> np.ndarray:
    """A mode of 1 % damping that is struck at ``begin``, s."""
    w = 2 * np.pi * frequency
    past = np.maximum(t - begin, 0.0)
    return np.where(t >= begin, np.exp(-0.01 * w * past) * np.sin(w * past), 0.0)


def made(folder: Path) -> Path:
    """A mode at 30 Hz that moves to 36 Hz at 2 s, with the second one and noise beside it."""
    t = np.arange(0.0, 3.0, 1 / RATE)
    accel = np.where(t < 2.0, ringing(30.0, t, 1.0), ringing(36.0, t, 2.0))
    accel += 0.3 * ringing(200.0, t, 1.0)
    accel += 0.01 * np.random.default_rng(1).standard_normal(t.size)
    roller = np.interp(t, [1.98, 2.02], [1.5, 2.5])
    rows = "\n".join(f"{a:.6e}\t{r:.4e}\t{s:.5e}" for a, r, s in zip(accel, roller, t, strict=True))
    path = folder / "made.txt"
    path.write_text(HEAD + rows + "\n", encoding="latin-1")
    return path


def test_a_mode_that_moves_is_followed(
    study: Mapping[str, ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    measure = study["measure"]
    table = measure.read(made(tmp_path))
    assert (table.t.size, table.gauge) == (3 * RATE, None)
    monkeypatch.setattr(measure, "HOP", 0.5)
    monkeypatch.setattr(measure, "SETTLES", 1.5)
    seen = list(measure.followed(table))
    assert [one.t for one in seen] == pytest.approx([1.5, 2.0, 2.5])
    assert seen[1].frequency == pytest.approx(30.0, rel=0.025)  # the filter ends there
    assert seen[2].frequency == pytest.approx(36.0, rel=0.01)
    assert seen[2].stiffness == pytest.approx((2 * np.pi * seen[2].frequency) ** 2)


def test_stops_are_where_the_roller_stands(study: Mapping[str, ModuleType], tmp_path: Path) -> None:
    found = study["measure"].stops(study["measure"].read(made(tmp_path)))
    last = found[-1]
    assert last.begin == pytest.approx(2.02, abs=0.06)
    assert (last.roller, last.frequency) == pytest.approx((2.5, 36.0), abs=0.25)


def test_a_damped_sine_has_its_frequency(study: Mapping[str, ModuleType]) -> None:
    t = np.arange(0.0, 0.6, 10 / RATE)
    assert study["measure"].sine_of(ringing(33.7, t, 0.0)) == pytest.approx(33.7, abs=0.051)

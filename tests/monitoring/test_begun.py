"""Where a watch begins: blocks of a recording become a reference."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.data.thin import stretch
from symhyb.errors import InputError
from symhyb.monitoring.begun import REFERENCE_BLOCKS, begun
from symhyb.monitoring.changes import level
from tests.pushed import pushed, pushed_model


def test_the_reference_is_made_of_whole_blocks() -> None:
    recording = pushed(1, samples=1500)
    found = begun(pushed_model(), recording, 1.0, "good.csv")
    assert found.rows * np.median(np.diff(recording.t)) >= found.gauge.block_s
    assert REFERENCE_BLOCKS <= found.reference.count <= len(recording) // found.rows
    assert found.least == level(1.0, found.gauge.block_s, found.reference)


def test_more_false_alarms_make_every_test_easier() -> None:
    found = begun(pushed_model(), pushed(1, samples=1500), 10.0, "good.csv")
    rare = level(1.0, found.gauge.block_s, found.reference)
    assert found.least == pytest.approx(10 * rare)


def test_too_few_blocks_are_refused_with_the_time_that_is_needed() -> None:
    recording = stretch(pushed(1, samples=1500), slice(0, 400))
    with pytest.raises(InputError, match="at least 20 are needed, which take"):
        begun(pushed_model(), replace(recording, name="good.csv"), 1.0, "good.csv")

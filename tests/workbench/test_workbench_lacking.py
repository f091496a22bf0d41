"""The missing force and what it is within a range of time."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.discrepancy.recorded.residual import compare
from symhyb.workbench.bench import Bench, current, with_elements, with_value
from symhyb.workbench.lacking import lacking, rows_within, within
from symhyb.workbench.simulated import Prepared


def test_it_is_what_compare_says(bench: Bench, prepared: Prepared) -> None:
    (found,) = lacking(prepared, bench.model)
    gap = compare(bench.model, prepared.recording)
    assert np.allclose(found.force, gap.force[:, 0])
    assert np.allclose(found.band, gap.band[:, 0])
    assert (found.force_unit.text, found.place_unit.text) == ("N", "m")


def test_without_an_element_its_force_is_missing_too(bench: Bench, prepared: Prepared) -> None:
    (before,) = lacking(prepared, bench.model)
    (after,) = lacking(prepared, current(with_elements(bench, ["damper", "shaker"])))
    assert np.allclose(after.force - before.force, -200.0 * before.place, atol=1e-6)
    (moved,) = lacking(prepared, current(with_value(bench, "k", 150.0)))
    assert np.allclose(moved.force - before.force, -50.0 * before.place, atol=1e-6)


def test_a_range_of_time_has_its_own_numbers(bench: Bench, prepared: Prepared) -> None:
    (found,) = lacking(prepared, bench.model)
    whole, part = within(found, None), within(found, (1.0, 2.0))
    assert whole is not None
    assert part is not None
    rows = (found.t >= 1.0) & (found.t <= 2.0)
    assert part.samples == rows.sum() < whole.samples == found.t.size
    assert part.rms == pytest.approx(float(np.sqrt(np.mean(found.force[rows] ** 2))))
    assert part.place == (found.place[rows].min(), found.place[rows].max())
    assert within(found, (99.0, 100.0)) is None
    assert rows_within(replace(found, t=found.t), None).all()

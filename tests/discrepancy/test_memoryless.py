"""Whether a missing force is a function of the state: fits of functions, and three recordings."""

import numpy as np
import pytest
from law_rigs import RIG, Law, bouc_wen, on_rig, stop

import symhyb as sh
from symhyb.correction.search.preparing import prepare, settle
from symhyb.discrepancy.places.memoryless import CHOSEN, RIDGES, memoryless
from symhyb.discrepancy.places.memoryless import _fits as fits
from symhyb.discrepancy.results import Memory
from symhyb.model.read import parse_model


def asked(law: Law) -> Memory | None:
    prepared = prepare(parse_model(RIG, "rig.toml"), on_rig(law, 1))
    setting = settle(prepared)
    cuts, values = setting.stages[-1].cuts, prepared.machine.values
    return memoryless(setting.library, setting.windows, cuts, values, setting.sd)


def test_a_stop_is_a_function_of_the_state() -> None:
    memory = asked(stop(800.0, 0.012))
    assert memory is not None
    assert memory.state > 0.98
    assert "is a function" in memory.sentence


def test_hysteresis_is_none() -> None:
    memory = asked(bouc_wen(150.0, 100.0, 60.0))
    assert memory is not None
    assert memory.state < 0.9 < memory.past
    assert "remembers" in memory.sentence


def test_where_nothing_is_missing_nothing_is_asked() -> None:
    quiet = sh.diagnose(parse_model(RIG, "rig.toml"), on_rig(stop(0.0, 0.1), 1))
    assert quiet.verdict == "nothing missing"
    assert quiet.memory is None


def test_fits_recover_a_sum_of_two_columns() -> None:
    """Columns that are zero or twice there do no harm."""
    random = np.random.default_rng(1)
    columns = random.normal(size=(400, 6))
    columns[:, 4], columns[:, 5] = 0.0, columns[:, 0]
    joined = np.column_stack([columns, 2 * columns[:, 1] - columns[:, 3]])
    found = fits(joined.T @ joined)
    assert len(found) == len(RIDGES) + sum(few <= 6 for few in CHOSEN)
    assert found[len(RIDGES) + 1] == pytest.approx([0, 2, 0, -1, 0, 0], abs=1e-6)
    assert found[0] == pytest.approx([0, 2, 0, -1, 0, 0], abs=1e-6)

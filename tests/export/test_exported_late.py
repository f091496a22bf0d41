"""A sensor that lags in exported code: the state that a corrected model gives it."""

from pathlib import Path

import pytest
from builders import DRIVEN_MASS
from fmus import get, loaded, places, put, started, written
from test_c_code import compiled
from test_c_code import put as put_files

from symhyb.export.c_code import SAMPLES, c_files
from symhyb.export.spec import Spec, spec_of
from symhyb.model.late import written_with_lag
from symhyb.model.read import parse_model

TAU = 0.08


def late_spec() -> Spec:
    text = DRIVEN_MASS.replace('x = { unit = "m" }', 'x = { unit = "m", start = 0.2 }')
    return spec_of(written_with_lag(parse_model(text), "laser", TAU, 0.001), "late", whole=True)


def test_the_c_program_sees_no_difference(tmp_path: Path) -> None:
    put_files(tmp_path, c_files(late_spec()))
    reported = compiled(tmp_path, "late.c", "late_check.c")
    assert reported == f"0 late: {SAMPLES} samples, largest relative difference 0\n"


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_shows_the_state_that_follows_the_motion(fmi: int, tmp_path: Path) -> None:
    spec = late_spec()
    at = places(spec)
    with loaded(written(tmp_path, spec, fmi), fmi, "me") as instance:
        started(instance, fmi)
        assert get(instance, fmi, at.state) == pytest.approx([0.2, 0.0, 0.2])
        if fmi == 3:
            instance.enterContinuousTimeMode()
        put(instance, fmi, at.state, [0.2, 0.0, 0.15])
        put(instance, fmi, at.input, [1.0])
        rates = get(instance, fmi, at.rate)
    assert rates == pytest.approx([0.0, 1.0 - 25 * 0.2, (0.2 - 0.15) / TAU])

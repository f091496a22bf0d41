"""Declared states in exported code: C and FMUs begin at their start and give what symhyb gives."""

from pathlib import Path

import numpy as np
import pytest
from fmus import get, loaded, places, put, started, written
from motors import K, L, R, motor
from test_c_code import compiled
from test_c_code import put as put_files

from symhyb.errors import InputError
from symhyb.export.adams import adams_files
from symhyb.export.c_code import SAMPLES, c_files
from symhyb.export.spec import spec_of
from symhyb.model.read import parse_model
from tests.motors import MOTOR


@pytest.mark.parametrize("whole", [False, True])
def test_the_c_program_sees_no_difference(whole: bool, tmp_path: Path) -> None:
    spec = spec_of(motor(), "motor", () if whole else ("motor",), whole=whole)
    put_files(tmp_path, c_files(spec))
    reported = compiled(tmp_path, "motor.c", "motor_check.c")
    assert reported == f"0 motor: {SAMPLES} samples, largest relative difference 0\n"


def test_an_element_takes_the_states_along_that_it_needs() -> None:
    """The torque k i needs the current, which needs voltage and speed; the bearing none of them."""
    e = spec_of(motor(), "drive", ("motor",)).exported
    assert e.states == (("s", "i"),)
    assert set(e.inputs) == {("v", "phi"), ("u", "u")}
    (rate,), (torque,) = e.evaluate(
        0.0, np.array([2.0]), np.array([{"v": 3.0, "u": 5.0}[kind] for kind, _ in e.inputs]), e.p
    )
    assert torque == pytest.approx(2.0 * K)
    assert rate == pytest.approx((5.0 - 2.0 * R - 3.0 * K) / L)
    assert spec_of(motor(), "rub", ("bearing",)).exported.states == ()


def test_states_have_units_and_sizes_of_their_own() -> None:
    spec = spec_of(motor(), "motor", whole=True)
    by_name = {v.name: v for v in spec.variables}
    assert by_name["s.i"].unit.text == "A"
    assert by_name["s.i"].about == "current of the armature"
    assert by_name["der(s.i)"].unit.text == "A/s"
    assert spec.nominal(by_name["s.i"]) == 1.0


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_begins_at_the_start_and_has_the_rates(fmi: int, tmp_path: Path) -> None:
    model = parse_model(MOTOR.replace('unit = "A",', 'unit = "mA", start = 250.0,'))
    spec = spec_of(model, "motor", whole=True)
    at = places(spec)
    with loaded(written(tmp_path, spec, fmi), fmi, "me") as instance:
        started(instance, fmi)
        assert get(instance, fmi, at.state) == [0.0, 0.0, 0.25]
        if fmi == 3:
            instance.enterContinuousTimeMode()
        put(instance, fmi, at.input, [2.0])
        rates = get(instance, fmi, at.rate)
    assert rates == pytest.approx([0.0, K * 0.25 / 2e-4, (2.0 - 0.25 * R) / L])


def test_what_a_program_cannot_hold_is_refused() -> None:
    with pytest.raises(InputError, match=r"states\.i: is a declared state, which the Adams source"):
        adams_files(spec_of(motor(), "drive", ("motor",)))
    late = parse_model(MOTOR.replace('u = { unit = "V" }', 'u = { unit = "V", delay = 0.01 }'))
    with pytest.raises(InputError, match=r"elements\.motor: uses the input u, which has a delay"):
        spec_of(late, "drive", ("motor",))
    assert spec_of(late, "rub", ("bearing",)).exported.states == ()

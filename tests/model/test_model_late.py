"""A sensor that lags, as a state: written, simulated, refused."""

from dataclasses import replace

import numpy as np
import pytest
from builders import DRIVEN_MASS
from scipy.signal import lsim

import symhyb as sh
from symhyb.discrepancy.results import Measurement
from symhyb.errors import InputError
from symhyb.model.late import lag_name, may_lag, with_lag, written_with_lag
from symhyb.model.read import parse_model

TAU = 0.08


def test_the_file_says_what_the_model_says() -> None:
    model = parse_model(DRIVEN_MASS)
    written = written_with_lag(model, "laser", TAU, 0.004)
    made = with_lag(model, ("laser",), TAU, 0.004)
    assert replace(written, text="") == replace(made, text="")
    before = DRIVEN_MASS.replace('measures = "x"', 'measures = "laser_late"')
    assert written.text.startswith(before)
    (state,) = written.states
    assert str(state.rate) == "(x - laser_late)/laser_lag"
    time = written.parameters["laser_lag"]
    assert (time.si, time.sd, time.unit.text) == (TAU, 0.004, "s")


def test_a_diagnosis_is_applied_with_its_gain() -> None:
    """recorded(t) = gain·shown(t − delay) + offset, and what is shown lags."""
    faults = [
        Measurement("laser", "gain", 1.1, 0.01, "1"),
        Measurement("laser", "sensor_lag", TAU, 0.004, "s"),
    ]
    model = sh.apply(parse_model(DRIVEN_MASS), (), (), faults)
    laser = model.sensors["laser"]
    assert laser.gain is not None
    assert (laser.gain.value, laser.measures.text) == (1.1, "laser_late")


def test_names_that_are_taken_get_a_stroke() -> None:
    text = DRIVEN_MASS.replace("[inputs]", 'laser_lag = { value = 1.0, unit = "s" }\n[inputs]')
    model = parse_model(text)
    assert lag_name(model, "laser") == "laser_lag_"
    assert str(written_with_lag(model, "laser", TAU, None).states[0].rate).endswith("/laser_lag_")


@pytest.mark.parametrize(
    ("measures", "unit", "may"),
    [
        ("x", "m", True),
        ("x'", "m/s", True),
        ("x - f/k", "m", True),
        ("x''", "m/s^2", False),
        ("force(spring)", "N", False),
    ],
)
def test_what_no_rate_contains_does_not_lag(measures: str, unit: str, may: bool) -> None:
    text = DRIVEN_MASS.replace('"x", unit = "m" }\n', f'"{measures}", unit = "{unit}" }}\n')
    text = text if measures != "x" else DRIVEN_MASS
    model = parse_model(text)
    assert may_lag(model, model.sensors["laser"]) == may
    if not may:
        with pytest.raises(InputError):
            written_with_lag(model, "laser", TAU, None)


@pytest.mark.parametrize("exact", [False, True])
def test_it_shows_what_a_lag_makes_of_the_motion(exact: bool) -> None:
    """Released from 0.2 m, which the sensor shows at first: against SciPy's lag of x(t)."""
    text = DRIVEN_MASS.replace('x = { unit = "m" }', 'x = { unit = "m", start = 0.2 }')
    plain = parse_model(text.replace('measures = "x", unit = "m"', 'measures = "x", unit = "mm"'))
    true = sh.simulate(plain, end=4.0, step=0.002, exact=exact)
    shown = sh.simulate(
        written_with_lag(plain, "laser", TAU, None), end=4.0, step=0.002, exact=exact
    )
    x, z = true.y[:, 0], shown.y[:, 0]
    assert (x[0], z[0]) == pytest.approx((0.2, 0.2))
    # from rest at 0, about where it begins
    lagged = lsim(([1.0], [TAU, 1.0]), x - x[0], true.t)[1] + x[0]
    assert np.max(np.abs(z - lagged)) < 1e-4 * np.ptp(x)
    assert np.max(np.abs(z - x)) > 0.1 * np.ptp(x)

"""A run as a script asks for it: against closed forms, by name, in the units of the model."""

import numpy as np
import pytest
from builders import DRIVEN_MASS

import symhyb as sh

IN_MM = DRIVEN_MASS.replace('x = { unit = "m" }', 'x = { unit = "mm", start = 5.0 }').replace(
    'f = { unit = "N" }', 'f = { unit = "kN" }'
)
MODEL, FINE = sh.parse_model(DRIVEN_MASS), sh.parse_model(IN_MM)
M, K, D = 1.0, 25.0, 0.6


def decay(t: np.ndarray, x0: float, v0: float = 0.0, k: float = K) -> np.ndarray:
    """The free motion of the mass."""
    a = D / (2 * M)
    w = np.sqrt(k / M - a**2)
    return np.exp(-a * t) * (x0 * np.cos(w * t) + (v0 + a * x0) / w * np.sin(w * t))


def test_a_run_begins_where_it_is_told_in_the_units_of_the_model() -> None:
    run = sh.simulate(FINE, end=2)
    assert run.complete
    assert len(run) == 1001
    np.testing.assert_allclose(run.q[:, 0], decay(run.t, 0.005), atol=1e-8)
    moved = sh.simulate(FINE, end=2, step=0.01, start={"x": 20.0, "x'": -300.0})
    assert len(moved) == 201
    np.testing.assert_allclose(moved.q[:, 0], decay(moved.t, 0.02, -0.3), atol=1e-8)


def test_a_machine_and_its_model_run_alike() -> None:
    machine = sh.build(FINE)
    np.testing.assert_array_equal(sh.simulate(machine, end=1).q, sh.simulate(FINE, end=1).q)


def test_inputs_are_numbers_functions_or_values() -> None:
    t = np.linspace(0, 40, 1001)
    held = sh.simulate(FINE, end=40, inputs={"f": 0.05})
    assert held.q[-1, 0] == pytest.approx(50.0 / K, rel=1e-4)
    by_function = sh.simulate(FINE, end=40, inputs={"f": lambda s: 0.05 * np.sin(s)})
    by_values = sh.simulate(FINE, end=40, inputs={"f": 0.05 * np.sin(t)})
    np.testing.assert_allclose(by_function.q, by_values.q, atol=1e-12)
    size = 50.0 / abs(K - M + 1j * D)
    assert np.ptp(by_values.q[-200:, 0]) / 2 == pytest.approx(size, rel=2e-3)


def test_parameters_are_given_by_name() -> None:
    run = sh.simulate(MODEL, end=2, start={"x": 0.1}, parameters={"k": 100.0})
    np.testing.assert_allclose(run.q[:, 0], decay(run.t, 0.1, k=100.0), atol=1e-7)
    machine = sh.build(MODEL)
    p = machine.values.copy()
    p[machine.column("k")] = 100.0
    np.testing.assert_array_equal(sh.simulate(MODEL, p=p, end=2, start={"x": 0.1}).q, run.q)


def test_a_scenario_says_everything_itself() -> None:
    t = np.linspace(0, 1, 101)
    case = sh.Scenario(t, np.array([0.1]), np.zeros(1), t, np.zeros((101, 1)))
    run = sh.simulate(MODEL, case)
    np.testing.assert_allclose(run.q[:, 0], decay(t, 0.1), atol=1e-7)
    with pytest.raises(sh.InputError, match="leave out end, inputs"):
        sh.simulate(MODEL, case, end=2, inputs={"f": 1.0})


def test_a_recording_drives_a_run() -> None:
    made = sh.simulate(MODEL, end=10, step=0.01, inputs={"f": np.sin})
    record = sh.Recording.from_frame(made.to_frame().assign(f=np.sin(made.t)), MODEL)
    again = sh.simulate(MODEL, record)
    np.testing.assert_allclose(again.t, made.t)
    np.testing.assert_allclose(again.q, made.q, atol=1e-5)  # inputs run smoothly between samples
    assert sh.simulate(MODEL, record, end=5).t[-1] == pytest.approx(5.0)
    with pytest.raises(sh.InputError, match="the inputs stop at 10 s"):
        sh.simulate(MODEL, record, end=20)
    with pytest.raises(sh.InputError, match="leave out inputs"):
        sh.simulate(MODEL, record, inputs={"f": 1.0})


def test_a_run_is_a_frame_in_the_units_of_the_model() -> None:
    run = sh.simulate(FINE, end=1, step=0.1, inputs={"f": 0.05})
    shown = run.to_frame()
    assert list(shown.columns) == ["laser", "x", "x'", "x''"]
    assert shown.attrs["units"] == {
        "t": "s",
        "laser": "m",
        "x": "mm",
        "x'": "mm/s",
        "x''": "mm/s^2",
    }
    np.testing.assert_allclose(shown["laser"], run.q[:, 0], rtol=1e-14)
    np.testing.assert_allclose(shown["x"], 1000 * run.q[:, 0], rtol=1e-14)
    np.testing.assert_allclose(shown["x''"], 1000 * run.a[:, 0], rtol=1e-14)
    np.testing.assert_array_equal(shown.index, run.t)
    np.testing.assert_array_equal(run.to_xarray()["x'"].values, shown["x'"])
    assert run.to_xarray()["x'"].attrs == {"units": "mm/s"}


def test_an_exact_run_knows_its_model() -> None:
    rubbing = sh.parse_model(
        DRIVEN_MASS + '[elements.rub]\nkind = "friction"\non = "x"\ncoulomb = "c"\n'
        '[elements.rub.parameters]\nc = { value = 1.0, unit = "N" }\n'
    )
    run = sh.simulate(rubbing, end=5, exact=True, start={"x": 0.3})
    assert run.events[-1].transition == "sticks"
    assert list(run.to_frame().columns) == ["laser", "x", "x'", "x''"]
    assert "events" in repr(run)


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({}, "say when the simulation ends"),
        ({"end": 0}, "must come after the start"),
        ({"end": 1, "step": 3.0}, "a step of 3 s does not fit"),
        ({"end": 1, "inputs": {"g": 1}}, "inputs: 'g' is no input of the model; known: f"),
        ({"end": 1, "inputs": {"f": [1, 2]}}, r"a function of the time or 1001 numbers.*\(2,\)"),
        ({"end": 1, "inputs": {"f": "much"}}, r"inputs\['f'\]: must be a number.*not str"),
        ({"end": 1, "inputs": {"f": np.nan}}, r"inputs\['f'\]: is not finite"),
        ({"end": 1, "start": {"y": 1}}, "start: 'y' is no coordinate or rate of the model"),
        ({"end": 1, "start": {"x": "far"}}, r"start\['x'\]: must be a number, not str"),
        ({"end": 1, "parameters": {"kk": 1}}, "'kk' is no parameter of the model"),
        ({"end": 1, "parameters": {"k": np.inf}}, r"parameters\['k'\]: must be finite"),
        ({"end": 1, "p": [1.0]}, r"p: must be \(3,\), one value a parameter, not \(1,\)"),
    ],
)
def test_what_makes_no_run_is_said(asked: dict, said: str) -> None:
    with pytest.raises(sh.InputError, match=said):
        sh.simulate(MODEL, **asked)


def test_imposed_motion_needs_a_recording() -> None:
    imposed = sh.parse_model(DRIVEN_MASS.replace('unit = "m" }', 'unit = "m", imposed = true }', 1))
    with pytest.raises(sh.InputError, match="the motion of x is imposed"):
        sh.simulate(imposed, end=1)

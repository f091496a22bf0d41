"""Runs of a machine that MuJoCo has: MuJoCo's own, with what the model file adds as forces."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pandas as pd
import pytest
from command import Call

import symhyb as sh
from symhyb.errors import InputError
from symhyb.model.read import parse_model
from tests.mujoco_rigs import FINGER, PRESS, SHORT, STEP, finger, press, written

EXACT = 1e-9
DAMPER = """
[elements.rub]
kind = "damper"
on = "x"
damping = "d"
[elements.rub.parameters]
d = { value = 0.03, unit = "N*m*s/rad" }
"""


def push(t: float) -> float:
    return 2.0 + 0.7 * float(np.sin(12 * t))


def by_mujoco(xml: str, steps: int, every: int) -> tuple[np.ndarray, np.ndarray]:
    """Place and rate of a machine of one coordinate, row by row, by a loop of MuJoCo."""
    model = mujoco.MjModel.from_xml_string(xml)
    data, rows = mujoco.MjData(model), []
    for k in range(steps + 1):
        if k % every == 0:
            rows.append((data.qpos[0], data.qvel[0]))
        t = np.arange(0, steps + 1, every) * STEP
        u = [push(one) for one in t]
        data.ctrl[0] = np.interp((k + 0.5) * STEP, t, u)
        mujoco.mj_step(model, data)
    q, v = np.array(rows).T
    return q, v


def lined(model: sh.Model) -> sh.Model:
    """Inputs run straight between their samples."""
    text = model.text.replace('f = { unit = "N" }', 'f = { unit = "N", between = "line" }')
    return parse_model(text, model.file)


@pytest.mark.parametrize("integrator", ["RK4", "Euler", "implicitfast"])
def test_a_run_is_that_of_a_loop_of_mujoco(integrator: str, tmp_path: Path) -> None:
    xml = FINGER.replace('integrator="RK4"', f'integrator="{integrator}"')
    text = SHORT.format(joint="knuckle", actuator="pull", unit="rad")
    model = lined(written(tmp_path, xml, text))
    run = sh.simulate(model, end=0.2, step=0.002, inputs={"f": push})
    assert run.complete
    assert run.method == "mujoco"
    q, v = by_mujoco(xml, 2000, 20)
    np.testing.assert_allclose(run.q[:, 0], q, atol=EXACT)
    np.testing.assert_allclose(run.v[:, 0], v, atol=100 * EXACT)
    np.testing.assert_array_equal(run.y[:, 0], run.q[:, 0])  # what the sensor shows
    slope = np.gradient(run.v[:, 0], run.t, edge_order=2)
    np.testing.assert_allclose(run.a[:, 0], slope, atol=0.02 * np.abs(slope).max())


@pytest.mark.slow
def test_rows_between_steps_are_on_the_motion(tmp_path: Path) -> None:
    model = lined(finger(tmp_path))
    coarse = sh.simulate(model, end=0.1, step=0.01, inputs={"f": 2.0}, start={"x": 0.3})
    odd = sh.simulate(model, end=0.1, step=0.01 / 3, inputs={"f": 2.0}, start={"x": 0.3})
    np.testing.assert_allclose(odd.q[::3], coarse.q, atol=1e-8)
    assert coarse.q[0, 0] == 0.3
    fine = sh.simulate(model, end=0.1, step=1e-4, inputs={"f": 2.0}, start={"x": 0.3})
    np.testing.assert_allclose(np.interp(odd.t, fine.t, fine.q[:, 0]), odd.q[:, 0], atol=1e-6)


@pytest.mark.slow
def test_elements_act_as_forces_beside_it(tmp_path: Path) -> None:
    """A damper of the model file, beside one that MuJoCo's own file has."""
    model = lined(finger(tmp_path))
    rubbing = parse_model(model.text + DAMPER, model.file)
    beside = sh.simulate(rubbing, end=0.5, step=0.01, inputs={"f": push})
    inside, _ = by_mujoco(FINGER.replace('damping="0.02"', 'damping="0.05"'), 5000, 100)
    without = sh.simulate(model, end=0.5, step=0.01, inputs={"f": push})
    moved = np.abs(without.q[:, 0] - beside.q[:, 0]).max()
    assert moved > 0.01
    t = np.arange(51) * 0.01
    line = sh.simulate(
        rubbing,
        sh.Scenario(t, np.zeros(1), np.zeros(1), t, np.array([[push(one)] for one in t])),
    )
    np.testing.assert_array_equal(line.q, beside.q)
    assert np.abs(beside.q[:, 0] - inside).max() < 2e-3 * moved


@pytest.mark.slow
def test_forces_at_joints_act_along_them(tmp_path: Path) -> None:
    text = SHORT.format(joint="guide", actuator="drive", unit="m")
    by_joint = text.replace('f = "drive"', 'f = { joint = "guide" }')
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    runs = [
        sh.simulate(written(tmp_path / name, PRESS, one), end=0.1, step=1e-3, inputs={"f": -8.0})
        for name, one in (("a", text), ("b", by_joint))
    ]
    np.testing.assert_allclose(runs[0].q, runs[1].q, atol=1e-12)
    assert np.ptp(runs[0].q) > 1e-4


@pytest.mark.slow
def test_a_parameter_is_set_and_a_wrong_one_is_said(tmp_path: Path) -> None:
    number = '[mujoco.parameters]\nk = { tendon = "cord", field = "stiffness" }\n[parameters]\n'
    number += 'k = { value = 200.0, unit = "N/m" }\n'
    model = finger(tmp_path)
    model = parse_model(model.text.replace("[coordinates]", f"{number}[coordinates]"), model.file)
    soft = sh.simulate(model, end=0.3, inputs={"f": 2.0}, parameters={"k": 100.0})
    stated = parse_model(model.text.replace("value = 200.0", "value = 100.0"), model.file)
    np.testing.assert_array_equal(soft.q, sh.simulate(stated, end=0.3, inputs={"f": 2.0}).q)
    assert np.abs(soft.q - sh.simulate(model, end=0.3, inputs={"f": 2.0}).q).max() > 0.01


@pytest.mark.slow
def test_a_run_that_diverges_says_when(tmp_path: Path) -> None:
    wild = PRESS.replace('damping="2"', 'damping="-4000"')
    text = SHORT.format(joint="guide", actuator="drive", unit="m")
    run = sh.simulate(written(tmp_path, wild, text), end=2.0, step=0.01, inputs={"f": 1.0})
    assert "MuJoCo's run diverges before" in run.reason
    assert np.isnan(run.q[-1]).all()
    assert np.isfinite(run.q[0]).all()


@pytest.mark.parametrize(
    ("element", "said"),
    [
        ('kind = "added_mass"\non = "x"\nmass = 1.0', "elements.more: has mass"),
        (
            'kind = "relaxation"\non = "x"\nstiffness = "k"\ndamping = "d"\n'
            '[elements.more.parameters]\nk = { value = 1.0, unit = "N*m/rad" }\n'
            'd = { value = 1.0, unit = "N*m*s/rad" }',
            "what remembers",
        ),
    ],
)
def test_what_is_no_force_is_refused(element: str, said: str, tmp_path: Path) -> None:
    model = finger(tmp_path)
    element = element.replace(
        "mass = 1.0",
        'mass = "J"\n[elements.more.parameters]\nJ = { value = 1.0, unit = "kg*m^2/rad^2" }',
    )
    more = parse_model(f"{model.text}\n[elements.more]\n{element}\n", model.file)
    with pytest.raises(InputError) as caught:
        sh.simulate(more, end=0.1)
    assert said in str(caught.value)


def test_exact_runs_and_too_many_steps_are_refused(tmp_path: Path) -> None:
    model = press(tmp_path)
    with pytest.raises(InputError, match="has its own steps and contacts; leave out 'exact'"):
        sh.simulate(model, end=0.1, exact=True)
    with pytest.raises(InputError, match="more than 5,000,000"):
        sh.simulate(model, end=1000.0, step=1.0)
    missing = replace(model, mujoco=replace(model.mujoco, file="other.xml"))
    with pytest.raises(InputError, match="there is no such file"):
        sh.simulate(missing, end=0.1)


def test_the_command_line_writes_a_run(tmp_path: Path, symhyb: Call) -> None:
    model = press(tmp_path)
    t = np.arange(0, 0.2, 0.004)
    frame = pd.DataFrame({"t": t, "f": -5 + np.sin(30 * t)}).set_index("t")
    frame.to_csv(tmp_path / "drive.csv")
    out = tmp_path / "run.csv"
    order = ("simulate", model.file, "--input", str(tmp_path / "drive.csv"), "-o", str(out))
    done = symhyb(*order)
    assert done.status == 0
    assert "MuJoCo's own steps" in done.out
    written_ = pd.read_csv(out)
    assert list(written_.columns) == ["t [s]", "f [N]", "laser [m]", "x [m]", "x' [m/s]"]
    assert len(written_) == len(t)

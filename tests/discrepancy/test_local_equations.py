"""The equations of an FMU along a recording: those of the model that it was made from, exactly
where they are linear, and to first order beside the motion where they are not."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import DRIVEN_MASS

from symhyb.data.recording import Recording
from symhyb.discrepancy.checks.repeats import repeated
from symhyb.discrepancy.fitting.judge import judge
from symhyb.discrepancy.places.placements import places_of
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.local import along_recordings, beside, plain
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.residual import compare, discrepancy
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.errors import InputError
from symhyb.model.bare import bare
from symhyb.model.local import COLUMN
from symhyb.model.read import parse_model, read_model
from symhyb.model.types import Model, On
from symhyb.model.write import replace_parameters
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from tests.fmu_rigs import as_fmu

MODELS = Path(__file__).parents[2] / "models"
MASS = parse_model(DRIVEN_MASS)
SWING = parse_model(
    """symhyb = 1
gravity = ["0", "-g"]
[coordinates]
phi = { unit = "rad" }
x = { unit = "m" }
[parameters]
m = { value = 2.0, unit = "kg", sd = 0.2 }
l = { value = 0.7, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
[inputs]
f = { unit = "N" }
[bodies.cart]
mass = "m"
at = ["x", "0"]
[bodies.bob]
mass = "m"
at = ["x + l*sin(phi)", "-l*cos(phi)"]
[elements.push]
kind = "force"
on = "x"
force = "f"
[sensors]
angle = { measures = "phi", unit = "rad" }
place = { measures = "x", unit = "m" }
"""
)

CHAIN = """symhyb = 1
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
[parameters]
m = { value = 1.0, unit = "kg" }
k = { value = 40.0, unit = "N/m" }
c = { value = 30.0, unit = "N/m^3" }
[inputs]
f = { unit = "N" }
[bodies.first]
mass = "m"
at = ["x", "0"]
[bodies.second]
mass = "m"
at = ["y", "0"]
[elements.wall]
kind = "spring"
on = "x"
cubic = "c"
[elements.shaft]
kind = "spring"
on = "x - y"
stiffness = "k"
[elements.push]
kind = "force"
on = "x"
force = "f"
[sensors]
first = { measures = "x", unit = "m" }
second = { measures = "y", unit = "m" }
"""


def recording(model: Model, seed: int = 0, name: str = "run.csv") -> Recording:
    """A large motion of all coordinates at 100 Hz with 0.1 % of noise, and what drives it."""
    random, t = np.random.default_rng(seed), np.arange(0, 8, 0.01)
    sensors = {}
    for i, sensor in enumerate(model.sensors):
        signal = 0.6 * np.sin((1.3 + i) * t) + 0.5 * np.cos((2.9 + i) * t)
        sensors[sensor.name] = signal + 1e-3 * np.random.default_rng(seed + i).normal(size=t.size)
    return Recording(name, t, {"f": random.normal(size=t.size)}, sensors, (), "")


@pytest.mark.slow
def test_a_linear_fmu_becomes_its_own_equations(tmp_path: Path) -> None:
    run = recording(MASS)
    local, ((same,),) = along_recordings(as_fmu(MASS, tmp_path), [run])
    assert same.inputs.keys() == run.inputs.keys()  # nothing varies
    terms = {(term.kind, term.path): term.value for term in local.local.terms}
    assert terms == pytest.approx(
        {
            ("mass", ""): 1.0,
            ("place", ""): -25.0,
            ("rate", ""): -0.6,
            ("input", ""): 1.0,
            ("place", "k"): -1.0,
        },
        rel=1e-6,
    )
    machine, mine = build(MASS), build(local)
    random = np.random.default_rng(0)
    for _ in range(5):
        q, v, u, w = random.normal(size=(4, 1))
        p = machine.values * [1, 1.7, 1]
        given = (q, v, np.zeros(0), u, 0.0, p, w, np.zeros(0))
        np.testing.assert_allclose(
            call(mine.acceleration, given)[0], call(machine.acceleration, given)[0], rtol=1e-7
        )


@pytest.mark.slow
def test_a_nonlinear_fmu_lacks_what_its_model_lacks(tmp_path: Path) -> None:
    closed, run = as_fmu(SWING, tmp_path), recording(SWING)
    found, known = compare(closed, run), compare(SWING, run)
    size = np.abs(known.force).max(axis=0)
    assert np.all(np.abs(found.force - known.force).max(axis=0) < 1e-4 * size)
    np.testing.assert_allclose(found.band, known.band, rtol=0.02, atol=1e-3 * size.max())


def test_mass_and_momentum_follow_the_motion(tmp_path: Path) -> None:
    closed, run = as_fmu(SWING, tmp_path), recording(SWING)
    local, ((along,),) = along_recordings(closed, [run])
    assert all(name.startswith(COLUMN) for name in along.inputs if name not in run.inputs)
    machine, mine = (build(as_sampled(one, [along])) for one in (SWING, local))
    motion = motion_of(run, machine)
    course, other = course_of(run, machine, motion), course_of(along, mine, motion)
    for values in (
        machine.values,
        machine.values * [1.2, 1, 1],
    ):  # a mass that is linear in M and c
        for i in (100, 371, 640):
            a, b = ((c.q[i], c.v[i], c.z[i], c.u[i], c.t[i], values) for c in (course, other))
            for first, second in zip(call(machine.weak, a), call(mine.weak, b), strict=True):
                assert np.abs(first - second).max() < 2e-3 * np.abs(first).max() + 0.05
        given = replace(course, known={}), replace(other, known={})
        size = np.abs(discrepancy(machine, given[0], values)).max(axis=0)
        apart = discrepancy(machine, given[0], values) - discrepancy(mine, given[1], values)
        assert np.all(np.abs(apart).max(axis=0) < 1e-4 * size)


def test_a_simulation_beside_the_motion_is_right_to_first_order(tmp_path: Path) -> None:
    local, ((along,),) = along_recordings(as_fmu(SWING, tmp_path), [recording(SWING)])
    machine, mine = (build(as_sampled(one, [along])) for one in (SWING, local))
    motion = motion_of(along, machine)
    course, other = course_of(along, machine, motion), course_of(along, mine, motion)
    i, free = 250, np.zeros(0)
    push = -discrepancy(machine, course, machine.values)[i]
    errors = []
    for size in (0.04, 0.02):
        q, v = course.q[i] + [size, -size], course.v[i] + [2 * size, size]
        z, t, p = course.z[i], course.t[i], machine.values
        here = call(machine.acceleration, (q, v, z, course.u[i], t, p, -push, free))[0]
        there = call(mine.acceleration, (q, v, z, other.u[i], t, p, -push, free))[0]
        errors.append(float(np.abs(here - there).max()))
    assert errors[1] < 0.35 * errors[0]  # a quarter, and what is of higher order


def test_the_correction_is_judged_with_the_equations_of_the_model(tmp_path: Path) -> None:
    closed, run = as_fmu(MASS, tmp_path), recording(MASS)
    changed = replace_parameters(closed, {"k": (30.0, 0.1)})
    symbolic = judge(MASS, replace_parameters(MASS, {"k": (30.0, 0.1)}), run)
    through = judge(closed, changed, run)
    for side in ("before", "after"):
        a, b = (getattr(one.holdout, side).window_nrmse["laser"] for one in (symbolic, through))
        assert b == pytest.approx(a, rel=1e-3)
    assert [[*one.cross] for one in through.whiteness] == [["f"]]


def test_recordings_and_models_of_others_stay_as_they_are() -> None:
    run = recording(MASS)
    assert along_recordings(MASS, [run], []) == (MASS, ((run,), ()))
    assert beside(MASS, MASS) is MASS
    assert plain(run) is run


@pytest.mark.slow
def test_repeats_are_told_by_what_was_recorded(tmp_path: Path) -> None:
    random = np.random.default_rng(9)
    first = recording(SWING)
    moved = {name: y + 1e-3 * random.normal(size=y.size) for name, y in first.sensors.items()}
    second = replace(first, name="again.csv", sensors=moved, sha256="")
    local, (runs,) = along_recordings(as_fmu(SWING, tmp_path), [first, second])
    machine = build(as_sampled(local, runs))
    made = [Run(one, motion_of(one, machine), np.full(2, 1e-3)) for one in runs]
    assert [found.runs for found in repeated(made, ["angle", "place"])] == [(0, 1)]


def test_a_coordinate_that_no_sensor_shows_is_refused(tmp_path: Path) -> None:
    closed = as_fmu(SWING, tmp_path)
    blind = replace(closed, sensors=closed.sensors[:1])
    with pytest.raises(InputError, match="shows the place of x, where the machine has to be"):
        along_recordings(blind, [recording(SWING)])


def test_elements_and_sensors_are_there_without_the_fmu(tmp_path: Path) -> None:
    machine = build(bare(as_fmu(read_model(MODELS / "two_link_arm.toml"), tmp_path)))
    (mass,) = call(machine.M, (np.zeros(2), 0.0, machine.values))
    np.testing.assert_array_equal(mass, np.eye(2))


def test_places_that_an_element_of_no_strength_states_are_searched(tmp_path: Path) -> None:
    model = as_fmu(SWING, tmp_path)
    text = model.text + '\n[elements.rope]\nkind = "damper"\non = "x - l*phi"\ndamping = "0*c"\n'
    text = text.replace("[inputs]", 'c = { value = 1.0, unit = "N*s/m" }\n[inputs]')
    stated = parse_model(text, model.file)
    assert On("x - l*phi") in places_of(bare(stated))
    assert On("x - l*phi") not in places_of(bare(model))


def test_couplings_are_told_by_the_mean_of_what_varies(tmp_path: Path) -> None:
    chain = parse_model(CHAIN)
    local, _ = along_recordings(as_fmu(chain, tmp_path), [recording(chain)])
    assert any(item.local for item in local.inputs)
    assert On("x - y") in places_of(local)

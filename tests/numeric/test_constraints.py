"""Closed loops against mechanisms in minimal coordinates, and what no loop can do."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from mechanisms import MECHANISMS, slider_crank
from scipy.integrate import solve_ivp

from symhyb.errors import InputError
from symhyb.model.read import parse_model, read_model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.manifold import closed, free_part, gaps_of, tangent
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

MODELS = Path(__file__).parents[2] / "models"
EMPTY = np.zeros(0)
HEAD = """\
symhyb = 1
[parameters]
m = { value = 1.0, unit = "kg" }
J = { value = 0.1, unit = "kg*m^2" }
l = { value = 0.4, unit = "m" }
"""
GEARS = f"""{HEAD}
[coordinates]
phi = {{ unit = "rad", start = 0.3 }}
psi = {{ unit = "rad" }}
[energy]
kinetic = "J*phi'**2/2 + J*psi'**2/2"
[constraints.first]
kind = "gear"
on = ["phi", "psi"]
ratio = 3
offset = 0
[constraints.second]
kind = "gear"
on = ["phi", "psi"]
ratio = 3
offset = OFFSET
"""
PARALLELOGRAM = f"""{HEAD}
gravity_is = 0
[coordinates]
x   = {{ unit = "m", start = 0.2 }}
y   = {{ unit = "m", start = -0.3464101615137755 }}
phi = {{ unit = "rad", start_rate = 0.0 }}
[points]
a = ["0", "0"]
b = ["l", "0"]
c = ["2*l", "0"]
d = {{ body = "beam", at = ["0", "0"] }}
e = {{ body = "beam", at = ["l", "0"] }}
f = {{ body = "beam", at = ["2*l", "0"] }}
[bodies.beam]
joint = ["x", "y"]
mass = "m"
at = ["l", "0"]
inertia = "J"
angle = "phi"
[constraints.left]
kind = "distance"
between = ["a", "d"]
length = "l"
[constraints.middle]
kind = "distance"
between = ["b", "e"]
length = "l"
[constraints.right]
kind = "distance"
between = ["c", "f"]
length = "l"
""".replace("gravity_is = 0\n", "")


@cache
def machine_of(name: str) -> Machine:
    return build(read_model(MODELS / f"{name}.toml"))


def run(machine: Machine, end: float, rows: int) -> Trajectory:
    q, v = (np.array(part) for part in machine.model.start())
    t = np.linspace(0.0, end, rows)
    still = np.zeros((2, len(machine.model.inputs)))
    return simulate(machine, Scenario(t, q, v, t[[0, -1]], still))


@pytest.mark.parametrize("name", MECHANISMS)
def test_accelerations_agree_with_minimal_coordinates_at_1000_states(name: str) -> None:
    machine, book = machine_of(name), MECHANISMS[name]
    random = np.random.default_rng(1)
    worst = 0.0
    for _ in range(1000):
        angle, rate, torque = random.uniform(-7, 7), 6 * random.normal(), random.normal()
        by_hand = book(angle)
        acceleration = by_hand.acceleration(rate, torque)
        wanted = by_hand.slope * acceleration + by_hand.curve * rate**2
        given = by_hand.q, by_hand.slope * rate, EMPTY, np.array([torque]), 0.0, machine.values
        (found,) = call(machine.acceleration, (*given, np.zeros(3), EMPTY))
        worst = max(worst, np.abs(found[0] - wanted).max() / np.abs(wanted).max())
    assert worst < 1e-9


@pytest.mark.parametrize("name", MECHANISMS)
def test_a_minute_keeps_the_loop_closed_and_its_energy(name: str) -> None:
    machine = machine_of(name)
    found = run(machine, 60.0, 1201)
    assert found.complete
    gaps = gaps_of(machine, found.q, found.v, found.a, found.t, machine.values)
    assert np.abs(gaps.gap).max() < 1e-8
    assert np.abs(gaps.rate).max() < 1e-8
    reduced = [MECHANISMS[name](float(angle)) for angle in found.q[:, 0]]
    energy = np.array([one.energy(float(v)) for one, v in zip(reduced, found.v[:, 0], strict=True)])
    kinetic = energy - np.array([one.potential for one in reduced])
    assert np.ptp(energy) < 1e-4 * kinetic.max()


def test_andrews_squeezing_mechanism_reaches_the_published_solution() -> None:
    """Hairer & Wanner, Solving ODEs II, sec. VII.7; the reference solution at 0.03 s is that of the
    Test Set for Initial Value Problem Solvers (Mazzia & Magherini, Bari). Each of the seven angles
    is met to 1e-7 of how far beta turns."""
    machine = machine_of("squeezer")
    assert machine.notes == ()
    found = run(machine, 0.03, 31)
    published = np.array(
        [
            15.81077119629904,
            -15.75637105984298,
            0.04082224013073101,
            -0.5347301163226948,
            0.5244099658805304,
            0.5347301163226948,
            1.048080741042263,
        ]
    )
    assert np.abs(found.q[-1] - published).max() < 1e-7 * published[0]


def test_a_start_is_completed_and_what_is_stated_stays() -> None:
    machine = machine_of("slider_crank")
    q, v = (np.array(part) for part in machine.model.start())
    by_hand = slider_crank(0.7)
    assert np.abs(q - by_hand.q).max() < 1e-12
    assert np.abs(v - 6.0 * by_hand.slope).max() < 1e-11
    (note,) = machine.notes
    assert note.startswith("from the constraints: the start of psi is 0.21642")


def test_a_stated_start_that_does_not_close_moves_and_says_so() -> None:
    text = (MODELS / "four_bar.toml").read_text(encoding="utf-8")
    machine = build(parse_model(text.replace("start = 1.2317", "start = 1.5")))
    q, _ = (np.array(part) for part in machine.model.start())
    assert np.abs(MECHANISMS["four_bar"](float(q[0])).q - q).max() < 1e-11
    assert any("the start of gamma is" in note and "not 1.5" in note for note in machine.notes)


def test_a_loop_that_cannot_close_names_its_constraint() -> None:
    text = (MODELS / "four_bar.toml").read_text(encoding="utf-8")
    with pytest.raises(InputError) as caught:
        build(parse_model(text.replace("0.22,   unit", "0.80,   unit"), "bars.toml"))
    (problem,) = caught.value.problems
    assert problem.place == "constraints.knee"
    assert "cannot be closed" in problem.text
    assert "still off by 0.25" in problem.text  # 0.80 − (0.10 + 0.25 + 0.20)
    assert "alpha = " in problem.text


def test_a_constraint_that_repeats_another_is_left_out_by_name() -> None:
    machine = build(parse_model(GEARS.replace("OFFSET", "0")))
    assert machine.constraints == 1
    assert "constraints.second repeats what first say already and is left out" in machine.notes
    given = np.array([0.3, 0.1]), np.zeros(2), EMPTY, EMPTY, 0.0, machine.values
    (a,) = call(machine.acceleration, (*given, np.array([1.0, 0.0]), EMPTY))
    assert a[0] == pytest.approx([1 / (0.1 + 0.1 / 9), 1 / (0.1 + 0.1 / 9) / 3])


def test_a_third_parallel_rod_is_left_out_and_the_beam_swings_on() -> None:
    text = PARALLELOGRAM.replace("symhyb = 1", 'symhyb = 1\ngravity = ["0", "-9.81*l/l_s2"]')
    text = text.replace("[coordinates]", 'l_s2 = { value = 0.4, unit = "s^2" }\n[coordinates]')
    machine = build(parse_model(text))
    assert machine.model.assembly is not None
    assert machine.model.assembly.left_out == ("right",)
    found = run(machine, 3.0, 301)
    assert found.complete
    assert np.abs(found.q[:, 2]).max() < 1e-8  # the beam stays level
    ends = np.hypot(found.q[:, 0], found.q[:, 1])
    assert np.abs(ends - 0.4).max() < 1e-9
    falls = -9.81 * found.q[:, 1]
    speed = found.v[:, 0] ** 2 + found.v[:, 1] ** 2
    assert np.ptp(speed / 2 - falls) < 1e-5


def test_constraints_that_contradict_each_other_are_named() -> None:
    with pytest.raises(InputError) as caught:
        build(parse_model(GEARS.replace("OFFSET", "0.5"), "gears.toml"))
    (problem,) = caught.value.problems
    assert problem.place in ("constraints.first", "constraints.second")
    assert "contradicts constraints." in problem.text


def test_a_constraint_of_imposed_motion_alone_is_refused() -> None:
    text = GEARS.replace("OFFSET", "0").replace("start = 0.3 }", "start = 0.3, imposed = true }")
    text = text.replace('psi = { unit = "rad" }', 'psi = { unit = "rad", imposed = true }')
    with pytest.raises(InputError) as caught:
        build(parse_model(text))
    assert [problem.place for problem in caught.value.problems] == [
        "constraints.first",
        "constraints.second",
    ]
    assert "holds nothing that is free to move" in str(caught.value)


def driven(start: float) -> Machine:
    """A slider-crank whose slider is given and whose crank has to follow."""
    text = (MODELS / "slider_crank.toml").read_text(encoding="utf-8")
    text = text.replace(
        'x   = { unit = "m",', f'x   = {{ unit = "m", imposed = true, start = {start},'
    )
    return build(parse_model(text.replace("start_rate = 6.0, ", "")))


def test_a_loop_that_locks_ends_the_run_with_constraint_and_position() -> None:
    machine = driven(0.36)
    q, v = (np.array(part) for part in machine.model.start())
    t = np.linspace(0, 1, 101)
    given = np.column_stack([0.36 + 0.1 * t, 0.1 + 0 * t, 0 * t])  # full reach, 0.4 m, at 0.4 s
    found = simulate(machine, Scenario(t, q, v, t, np.zeros((101, 1)), given=given))
    assert not found.complete
    assert found.reason.startswith(("the loop locks after 0.39 s", "the loop locks after 0.4 s"))
    assert "constraints.wrist_pin cannot follow at phi = " in found.reason
    ends = np.flatnonzero(np.isnan(found.q[:, 0]))[0]
    assert 0.3 < t[ends] < 0.415
    x = found.q[: ends - 1, 2]
    assert np.abs(x - given[: ends - 1, 0]).max() < 1e-12


def test_a_start_in_a_lock_is_refused() -> None:
    with pytest.raises(InputError, match=r"constraints.wrist_pin: the loop locks at its start"):
        driven(0.4)


MASSLESS = f"""{HEAD}
r = {{ value = 0.1, unit = "m" }}
[coordinates]
phi = {{ unit = "rad", start = 0.7 }}
psi = {{ unit = "rad" }}
x   = {{ unit = "m" }}
[energy]
kinetic = "J*phi'**2/2 + m*x'**2/2"
[constraints.along]
kind = "equation"
zero = "r*cos(phi) + l*cos(psi) - x"
[constraints.across]
kind = "equation"
zero = "r*sin(phi) - l*sin(psi)"
"""


def test_a_coordinate_without_mass_is_carried_by_constraints() -> None:
    machine = build(parse_model(MASSLESS))
    for angle in (0.3, 2.0, 4.0):
        s, c = np.sin(angle), np.cos(angle)
        psi = np.arcsin(0.25 * s)
        slope = -0.1 * s - 0.1 * c * np.tan(psi)
        given = np.array([angle, psi, 0.1 * c + 0.4 * np.cos(psi)]), np.zeros(3), EMPTY, EMPTY
        w = np.array([0.7, 0.0, -0.2])
        (a,) = call(machine.acceleration, (*given, 0.0, machine.values, w, EMPTY))
        wanted = (0.7 - 0.2 * slope) / (0.1 + slope**2)
        assert a[0, 0] == pytest.approx(wanted, rel=1e-10)
        assert a[0, 2] == pytest.approx(wanted * slope, rel=1e-9)


def test_a_coordinate_without_mass_and_without_a_tie_is_refused() -> None:
    text = MASSLESS.replace("l*cos(psi)", "l").replace(" - l*sin(psi)", "")
    with pytest.raises(InputError, match="nothing that moves with psi has mass"):
        build(parse_model(text))


def test_the_discrepancy_is_without_reactions_and_keeps_its_power() -> None:
    machine, by_hand = machine_of("four_bar"), MECHANISMS["four_bar"](1.1)
    rate, w, p = 3.0, np.array([0.3, -0.2, 0.5]), machine.values
    q, v, u = by_hand.q, by_hand.slope * rate, np.array([0.4])
    (a,) = call(machine.acceleration, (q, v, EMPTY, u, 0.0, p, w, EMPTY))
    (force,) = call(machine.discrepancy, (q, v, a, EMPTY, u, 0.0, p))
    shown = free_part(machine, q[None], np.zeros(1), p, w[None])
    assert force[0] == pytest.approx(shown[0], rel=1e-9)
    assert force[0] @ v == pytest.approx(w @ v, rel=1e-9)
    assert free_part(machine, q[None], np.zeros(1), p, shown) == pytest.approx(shown, rel=1e-9)
    (mass,) = call(machine.M, (q, 0.0, p))
    (alone,) = call(machine.acceleration, (q, v, EMPTY, u, 0.0, p, 0 * w, EMPTY))
    assert force[0] == pytest.approx(mass @ (a - alone)[0], rel=1e-9)


def test_free_directions_stay_on_the_constraints_to_first_order() -> None:
    machine, by_hand = machine_of("slider_crank"), slider_crank(1.3)
    q, v, t = by_hand.q[None], 5.0 * by_hand.slope[None], np.zeros(1)
    column = machine.column("r")
    held = tangent(machine, q, v, t, machine.values, (), (column,))
    assert held.basis.shape == (1, 6, 2)
    step = 1e-6
    for direction in held.basis[0].T:
        there = gaps_of(
            machine, q + step * direction[:3], v + step * direction[3:], 0 * v, t, machine.values
        )
        assert np.abs(there.gap).max() < 10 * step**2
        assert np.abs(there.rate).max() < 100 * step**2
    longer = machine.values.copy()
    longer[column] += step
    moved = held.by_p[0, :, 0]
    there = gaps_of(machine, q + step * moved[:3], v + step * moved[3:], 0 * v, t, longer)
    assert np.abs(there.gap).max() < 10 * step**2
    assert np.abs(there.rate).max() < 100 * step**2


def test_motion_beside_the_constraints_is_moved_onto_them() -> None:
    machine = machine_of("four_bar")
    random, angles = np.random.default_rng(3), np.linspace(0, 6, 40)
    rows = [MECHANISMS["four_bar"](float(angle)) for angle in angles]
    q = np.array([row.q for row in rows]) + 1e-3 * random.standard_normal((40, 3))
    v = np.array([2.0 * row.slope for row in rows]) + 1e-2 * random.standard_normal((40, 3))
    on = closed(machine, (q, v, 0 * q), angles, machine.values)
    gaps = gaps_of(machine, on.q, on.v, on.a, angles, machine.values)
    for open_by in (gaps.gap, gaps.rate, gaps.bend):
        assert np.abs(open_by).max() < 1e-9
    assert np.abs(on.q - q).max() < 0.02
    kept = closed(machine, (q, v, 0 * q), angles, machine.values, given=(0,))
    assert np.array_equal(kept.q[:, 0], q[:, 0])
    assert np.abs(kept.left).max() < 1e-9


PENDULUM = f"""{HEAD}
g = {{ value = 9.81, unit = "m/s^2" }}
[coordinates]
x = {{ unit = "m", start = 0.24 }}
y = {{ unit = "m", start = -0.32 }}
[points]
pivot = ["0", "0"]
bob = ["x", "y"]
[bodies.bob]
mass = "m"
at = "bob"
[constraints.string]
kind = "distance"
between = ["pivot", "bob"]
length = "l"
[sensors]
tension = {{ measures = "reaction(string)", unit = "N" }}
"""


def test_the_reaction_of_a_rod_is_its_tension() -> None:
    text = PENDULUM.replace("symhyb = 1", 'symhyb = 1\ngravity = ["0", "-g"]')
    found = run(build(parse_model(text)), 5.0, 501)
    speed = found.v[:, 0] ** 2 + found.v[:, 1] ** 2
    wanted = speed / 0.4 - 9.81 * found.q[:, 1] / 0.4  # m = 1: v²/l and the weight along the rod
    assert np.abs(found.y[:, 0] - wanted).max() < 1e-8 * wanted.max()


def test_a_reaction_that_cannot_be_reported_is_refused() -> None:
    gauge = '[sensors]\ngauge = { measures = "reaction(right)", unit = "N" }\n'
    with pytest.raises(InputError, match=r"sensors.gauge.measures: constraints.right repeats"):
        build(parse_model(PARALLELOGRAM + gauge))


def four_bars(count: int) -> str:
    """The N-four-bar benchmark: N squares of rods of 1 m and 1 kg side by side, upright, whose top
    starts with 1 m/s to the right."""
    lines = ["symhyb = 1", 'gravity = ["0", "-g"]', "[parameters]"]
    lines += ['g = { value = 9.81, unit = "m/s^2" }', 'a = { value = 1.0, unit = "m" }']
    lines += ['m = { value = 1.0, unit = "kg" }', "[coordinates]"]
    for i in range(count + 1):
        lines += [f't{i} = {{ unit = "deg", start = 90, start_rate = -57.29577951308232 }}']
    lines += [f'c{i} = {{ unit = "deg" }}' for i in range(1, count + 1)]
    lines += [
        "[points]",
        *(f'b{i} = {{ body = "r{i}", at = ["a", "0"] }}' for i in range(count + 1)),
    ]
    lines += [f'e{i} = {{ body = "k{i}", at = ["a", "0"] }}' for i in range(1, count + 1)]
    rod = ['mass = "m"', 'at = ["a/2", "0"]', 'inertia = "m*a**2/12"']
    for i in range(count + 1):
        lines += [f"[bodies.r{i}]", f'joint = ["{i}*a", "0"]', f'angle = "t{i}"', *rod]
    for i in range(1, count + 1):
        lines += [f"[bodies.k{i}]", f'parent = "r{i - 1}"', 'joint = ["a", "0"]', *rod]
        lines += [f'angle = "c{i} - t{i - 1}"']
        lines += [f"[constraints.pin{i}]", 'kind = "pin"', f'points = ["e{i}", "b{i}"]']
    return "\n".join(lines) + "\n"


def test_four_bars_side_by_side_and_where_they_can_fold_over() -> None:
    """The benchmark of the IFToMM library, A02: as long as they move as parallelograms, one angle
    says it all; lying flat they have three freedoms, and that is reported."""
    machine = build(parse_model(four_bars(2), "four_bars.toml"))
    found = run(machine, 4.0, 401)
    t = found.t
    inertia, weight = 3 / 3 + 2, 3 / 2 + 2  # over m l² and m l: rods that turn, rods that go along

    def rate(_: float, y: np.ndarray) -> list[float]:
        return [y[1], -9.81 * weight * np.cos(y[0]) / inertia]

    angle = solve_ivp(rate, (0, 4), [np.pi / 2, -1.0], "DOP853", t, rtol=1e-12, atol=1e-13).y[0]
    flat = int(np.flatnonzero(angle < 0)[0])
    assert found.q[:flat, :3] == pytest.approx(np.tile(angle[:flat, None], 3), abs=1e-5)
    assert np.abs(found.q[:flat, 3:]).max() < 1e-5
    # whether the integrator gets past it hangs on the last digit too
    reported = f"between {t[flat - 1]:.6g} and {t[flat]:.6g} s", f"after {t[flat - 1]:.6g} s"
    assert found.note.startswith(reported)
    assert "fold over" in found.note


@pytest.mark.parametrize("name", ["four_bar", "slider_crank", "five_bar"])
def test_loops_that_cannot_fold_over_are_not_said_to(name: str) -> None:
    assert run(machine_of(name), 5.0, 1001).note == ""

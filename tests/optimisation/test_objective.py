"""Objectives for SciPy, black boxes and CasADi: right slopes, threads, watches, flat memory."""

import gc
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from builders import cart_pole, damper, oscillator, pendulum, push, spring
from scipy.optimize import differential_evolution, minimize

from symhyb.numeric.kernels import compiled
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.optimisation.objective import Objective, Stopped, squares, values
from symhyb.optimisation.opti import step_function, whole_run
from symhyb.optimisation.rollout import Rollout

needs_compiler = pytest.mark.skipif(compiled.find_compiler() is None, reason="no C compiler")
SD = np.array([1e-3])


def shaken() -> Rollout:
    """A mass on a spring with a damper, driven."""
    machine = build(
        oscillator(
            {"hold": spring("k"), "oil": damper("d"), "motor": push("f")},
            {"k": (300.0, "N/m"), "d": (1.5, "N*s/m")},
            inputs={"f": {"unit": "N"}},
        )
    )
    t = np.linspace(0, 2, 101)
    scenario = Scenario(t, np.array([0.02]), np.zeros(1), t, np.sin(5 * t)[:, None])
    return Rollout(machine, scenario, ["k", "d"])


@needs_compiler
def test_scipy_finds_the_parameters_and_the_start() -> None:
    run = shaken()
    wanted = run(np.array([270.0, 2.0]), np.array([0.015, 0.1]))
    goal = Objective(run, squares(wanted, SD), ("free", "start"))
    found = minimize(goal, goal.begin, jac=True, tol=1e-12)
    assert found.x * goal.scale == pytest.approx([270.0, 2.0, 0.015, 0.1], rel=1e-5)


@needs_compiler
def test_the_gradient_is_that_of_the_value_for_two_hundred_numbers() -> None:
    """Parameters, start and 101 inputs at once; missing samples do not count."""
    run = shaken()
    wanted = run(np.array([270.0, 2.0]))
    wanted[7] = np.nan
    goal = Objective(run, squares(wanted, SD), ("inputs", "start", "free"))
    rng = np.random.default_rng(1)
    at, way = goal.begin + 0.01 * rng.normal(size=105), rng.normal(size=105)
    value, slopes = goal(at)
    assert value == goal.value(at) > 0
    h = 1e-4
    steps = [goal.value(at + i * h * way) for i in (-2, -1, 1, 2)]
    known = (steps[0] - 8 * steps[1] + 8 * steps[2] - steps[3]) / (12 * h)
    assert slopes @ way == pytest.approx(known, rel=1e-8)


@needs_compiler
def test_a_black_box_needs_the_value_alone() -> None:
    run = shaken()
    goal = Objective(run, squares(run(), SD))
    found = differential_evolution(goal.value, [(0.8, 1.2)] * 2, maxiter=15, seed=1, tol=1e-10)
    assert found.x == pytest.approx([1, 1], abs=0.01)


@needs_compiler
def test_a_watch_sees_every_evaluation_and_stops_the_optimiser() -> None:
    run, seen = shaken(), []

    def watch(count: int, best: float) -> bool:
        seen.append((count, best))
        return count == 5

    goal = Objective(run, squares(run(), SD), watch=watch)
    with pytest.raises(Stopped, match="stopped on request") as stopped:
        minimize(goal, goal.begin * 1.2, jac=True)
    assert [count for count, _ in seen] == [1, 2, 3, 4, 5]
    assert stopped.value.value == min(best for _, best in seen)
    assert goal.quiet(stopped.value.at) == stopped.value.value


@needs_compiler
def test_a_run_that_fails_is_infinitely_bad() -> None:
    run = shaken()
    goal = Objective(run, squares(run(), SD))
    bad = np.array([-1e6, 1.0])
    value, slopes = goal(bad)
    assert value == goal.value(bad) == np.inf
    assert np.isnan(slopes).all()


@needs_compiler
def test_many_points_in_threads_give_the_numbers_of_one() -> None:
    run = shaken()
    goal = Objective(run, squares(run(np.array([270.0, 2.0])), SD))
    points = goal.begin * np.linspace(0.8, 1.2, 23)[:, None]
    alone = values(goal, points)
    assert np.array_equal(alone, [goal.quiet(point) for point in points])
    reported: list[tuple[int, float]] = []
    shared = values(goal, points, 3, lambda done, best: reported.append((done, best)))
    assert np.array_equal(shared, alone)
    assert [done for done, _ in reported] == list(range(1, 24))
    assert reported[-1][1] == alone.min()


@needs_compiler
def test_a_watch_leaves_out_what_has_not_begun() -> None:
    run = shaken()
    goal = Objective(run, squares(run(), SD))
    found = values(goal, np.tile(goal.begin, (50, 1)), 2, lambda done, best: done >= 3)
    assert 3 <= np.isfinite(found).sum() < 12
    assert values(goal, np.empty((0, 2))).shape == (0,)


def test_what_cannot_vary_is_refused() -> None:
    with pytest.raises(ValueError, match="'mass' cannot vary; it is one of free, start, inputs"):
        Objective(None, squares(np.zeros((1, 1)), SD), ("mass",))  # type: ignore[arg-type]


@needs_compiler
def test_a_whole_run_in_an_opti_problem_with_a_bound_on_a_state() -> None:
    run = shaken()
    whole, wanted = whole_run(run), run(np.array([270.0, 2.0]))
    problem = ca.Opti()
    theta = problem.variable(2)
    y, x = whole(theta * run.theta, run.start, run.inputs.T)
    problem.minimize(ca.sumsqr((y - wanted.T) / SD[0]))
    problem.subject_to(theta >= 0.1)
    problem.subject_to(x[0, -1] <= 1.0)
    problem.set_initial(theta, [1.0, 1.0])
    quiet = {"print_level": 0, "sb": "yes", "hessian_approximation": "limited-memory"}
    problem.solver("ipopt", {"print_time": False, "ipopt": quiet})
    found = problem.solve().value(theta) * run.theta
    assert found == pytest.approx([270.0, 2.0], rel=1e-5)


@needs_compiler
def test_a_whole_run_has_both_derivatives() -> None:
    run = shaken()
    whole = whole_run(run)
    theta, way = ca.MX.sym("theta", 2), ca.MX.sym("way", 2)
    y = whole(theta, run.start, run.inputs.T)[0]
    forward = ca.Function("forward", [theta, way], [ca.jtimes(y, theta, way)])
    weights = np.random.default_rng(4).normal(size=(101, 1))
    total = ca.Function("total", [theta], [ca.gradient(ca.sum2(y * weights.T), theta)])
    one = np.array([3.0, 0.2])
    pushed = np.asarray(forward(run.theta, one)).ravel() @ weights[:, 0]
    pulled = np.asarray(total(run.theta)).ravel() @ one
    assert pushed == pytest.approx(pulled, rel=1e-9)


@needs_compiler
@pytest.mark.parametrize("vary", [("free",), ("start", "free"), ("inputs",), ("inputs", "start")])
def test_a_whole_run_of_some_arguments_holds_the_others(vary: tuple[str, ...]) -> None:
    """Values and both derivatives are those of the run of all arguments, in its order."""
    run, rng = shaken(), np.random.default_rng(8)
    nominal = {"free": run.theta[:, None], "start": run.start[:, None], "inputs": run.inputs.T}
    kinds = [kind for kind in nominal if kind in vary]
    symbols = {kind: ca.MX.sym(kind, *nominal[kind].shape) for kind in kinds}
    part, asked = whole_run(run, vary), [symbols[kind] for kind in kinds]
    assert part.n_in() == len(kinds)
    whole = whole_run(run)
    results = whole(*(symbols.get(kind, value) for kind, value in nominal.items())), part(*asked)
    weights = [rng.normal(size=shape) for shape in ((1, 101), (2, 101))]
    ways = [rng.normal(size=nominal[kind].shape) for kind in kinds]
    at = [nominal[kind] + 0.01 * rng.normal(size=nominal[kind].shape) for kind in kinds]
    found = []
    for y, x in results:
        moved = sum(ca.jtimes(y, one, way) for one, way in zip(asked, ways, strict=True))
        total = ca.dot(y, weights[0]) + ca.dot(x, weights[1])
        slopes = [ca.gradient(total, one) for one in asked]
        made = ca.Function("made", asked, [y, x, moved, *slopes])
        found.append([value.full() for value in made.call(at)])
    for all_given, some in zip(*found, strict=True):
        assert np.array_equal(all_given, some)
        assert np.abs(some).max() > 0


@needs_compiler
def test_a_long_recording_that_is_held_costs_no_slopes() -> None:
    """The slopes of 20 001 outputs by two parameters: a matrix by all inputs would have 4·10⁸."""
    short = shaken()
    t = np.linspace(0, 2, 20_001)
    scenario = Scenario(t, short.start[:1], short.start[1:], t, np.sin(5 * t)[:, None])
    run = Rollout(short.machine, scenario, ["k", "d"])
    whole, theta = whole_run(run, ["free"]), ca.MX.sym("theta", 2)
    jacobian = ca.Function("jacobian", [theta], [ca.jacobian(ca.vec(whole(theta)[0]), theta)])
    found = jacobian(run.theta).full()
    assert found == pytest.approx(run.jacobian()[:, 0], rel=1e-12)


@pytest.mark.parametrize(("stiff", "model"), [(False, pendulum()), (True, cart_pole())])
def test_steps_follow_the_run_with_their_order(stiff: bool, model) -> None:
    """Halving the steps of order 4 leaves about a sixteenth of the error."""
    machine = build(model)
    step = step_function(machine, stiff)
    k = len(model.inputs)
    errors = []
    for count in (400, 800):
        t = np.linspace(0, 1, count + 1)
        u = np.sin(3 * t)[:, None] * np.ones(k)
        x = np.full(2 * machine.n, 0.3)
        truth = simulate(machine, Scenario(t, x[: machine.n], x[machine.n :], t, u))
        for i in range(count):
            given = (x, u[i], u[i + 1], t[i], 1 / count, machine.values)
            x = call(step, given)[0].ravel()
        errors.append(np.abs(x[: machine.n] - truth.q[-1]).max())
    assert errors[0] < 1e-5
    assert errors[1] < errors[0] / 8 or errors[1] < 1e-9


def test_a_step_has_second_derivatives() -> None:
    step = step_function(build(pendulum()))
    x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 4)
    after = step(x, ca.SX(0, 1), ca.SX(0, 1), 0, 0.01, p)
    (hessian, _) = ca.hessian(after[0], x)
    found = ca.Function("H", [x, p], [hessian])([1.0, 0.5], build(pendulum()).values)
    inertia = 0.01 + 0.4 * 0.3**2
    known = 0.5 * 0.01**2 * 0.4 * 9.81 * 0.3 * np.sin(1.0) / inertia
    assert float(found[0, 0]) == pytest.approx(known, rel=0.02)


@pytest.mark.thorough
@needs_compiler
def test_memory_stays_flat_over_ten_thousand_calls() -> None:
    """Resident memory, so that what C and CasADi hold counts too."""
    run = shaken()
    goal, whole = Objective(run, squares(run(), SD)), whole_run(run)

    def resident() -> float:
        gc.collect()
        fields = Path("/proc/self/statm").read_text(encoding="ascii").split()
        return int(fields[1]) * 4096 / 1e6

    def work(count: int) -> None:
        for _ in range(count):
            goal(goal.begin * 1.01)
        for _ in range(count // 100):
            whole(run.theta, run.start, run.inputs.T)

    if not Path("/proc/self/statm").exists():
        pytest.skip("no /proc")
    work(500)
    before = resident()
    work(10_000)
    assert resident() - before < 4.0

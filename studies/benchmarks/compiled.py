r"""What the C compiler of the system brings: whole runs, right-hand sides, gradients, matching.

- The oscillator of :mod:`oscillators`, 60 s, by ``simulate`` against CVODES as CasADi offers it:
  one integrator over the whole grid, built before the clock starts, with the same tolerances and
  with states divided by their sizes.
- The accelerations of n links on a cart (:mod:`links`, relative angles) against pinocchio's
  articulated-body algorithm, called from Python as one calls it; ours in the loop in which the
  integrator calls them, and one at a time from Python for information.
- The gradient of a misfit by 200 values of an input against one run.
- The matching of :mod:`trajectories` against the same without a compiler.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable

import casadi as ca
import links
import numpy as np
import oscillators
from numpy.typing import NDArray
from timing import Row, Work, in_turns, middle, milliseconds

from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.explicit import Field, field
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.optimisation.objective import Objective, squares
from symhyb.optimisation.rollout import Rollout

Array = NDArray[np.float64]


def ready(machine: Machine) -> Field:
    """The rates of a machine, compiled.

    Raises:
        RuntimeError: there is no compiler, and so nothing to measure.
    """
    rates = field(state_form(machine))
    if rates is None or not rates.compile():
        raise RuntimeError("these benchmarks need a C compiler")
    return rates


def cvodes(machine: Machine, t: Array, size: Array, relative: float = 1e-8) -> Callable[[], Array]:
    """States (N, 2) of the oscillator by CasADi's CVODES, ``size`` (2,) those of its states."""
    x, time, p = ca.SX.sym("x", 2), ca.SX.sym("t"), ca.SX.sym("p", machine.values.size)
    slopes = state_form(machine).rates()(x * size, ca.SX(0, 1), time, p, ca.SX.zeros(1))
    run = ca.integrator(
        "run",
        "cvodes",
        {"x": x, "t": time, "p": p, "ode": ca.vertcat(x[1] * size[1], slopes) / size},
        t[0],
        t[1:].tolist(),
        {"reltol": relative, "abstol": 1e-2 * relative},
    )

    def states() -> Array:
        later = run(x0=np.zeros(2), p=machine.values)["xf"].full().T * size
        return np.concatenate([np.zeros((1, 2)), later])

    return states


def run_rows(duration: float = 60.0, outputs: int = 60_001, repeats: int = 9) -> list[Row]:
    """The bar of a whole run."""
    machine, scenario = oscillators.machine_of(), oscillators.scenario_of(duration, outputs)
    ready(machine)
    truth = oscillators.reference(oscillators.right_side(), scenario.t)
    size = np.abs(truth).max(axis=0)
    theirs = cvodes(machine, scenario.t, size)
    found = simulate(machine, scenario)
    wrong, others = oscillators.error(found.q, truth), oscillators.error(theirs(), truth)
    alike = oscillators.as_accurate(
        lambda relative: cvodes(machine, scenario.t, size, relative)(), truth, wrong
    )
    times = middle(
        in_turns(
            {
                "ours": lambda: simulate(machine, scenario),
                "cvodes": theirs,
                "as accurate": cvodes(machine, scenario.t, size, alike),
            },
            repeats,
        )
    )
    name = f"{duration:.0f} s, {outputs} outputs, compiled"
    return [
        Row(
            name,
            "time of CasADi's CVODES over ours by the explicit method, both at rtol 1e-8",
            times["cvodes"] / times["ours"],
            15,
            True,
            "×",
            f"{milliseconds(times['cvodes'])}, {milliseconds(times['ours'])}; NRMSE of x: CVODES "
            f"{others:.1e}, ours {wrong:.1e} ({found.method})",
        ),
        Row(
            name,
            "the same with CVODES at the loosest rtol of 1, 2, 5·10ⁿ that is as accurate as ours",
            times["as accurate"] / times["ours"],
            None,
            True,
            "×",
            f"{milliseconds(times['as accurate'])}, rtol {alike:.0e}",
        ),
    ]


def articulated(n: int, p: dict[str, float]) -> Callable[[Array, Array, Array], Array]:
    """(q, v, forces) -> accelerations (n + 1,) of n links on a cart by pinocchio."""
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array([0.0, -p["g"], 0.0])
    none, here = np.zeros((3, 3)), pin.SE3.Identity()
    joint = model.addJoint(0, pin.JointModelPX(), here, "x")
    model.appendBodyToJoint(joint, pin.Inertia(p["m_0"], np.zeros(3), none), here)
    for i in range(1, n + 1):
        hung = np.array([0.0, -p[f"l_{i - 1}"] if i > 1 else 0.0, 0.0])
        joint = model.addJoint(joint, pin.JointModelRZ(), pin.SE3(np.eye(3), hung), f"q{i}")
        end = np.array([0.0, -p[f"l_{i}"], 0.0])
        model.appendBodyToJoint(joint, pin.Inertia(p[f"m_{i}"], end, none), here)
    data = model.createData()
    return lambda q, v, forces: pin.aba(model, data, q, v, forces)


def right_sides(n: int, calls: int = 20_000, repeats: int = 7) -> tuple[dict[str, float], float]:
    """Times of one evaluation, s, and the largest difference of the accelerations, relative."""
    machine = build(links.model_of(n, True))
    rates, rng = ready(machine), np.random.default_rng(n)
    p = {item.name: item.si for item in machine.model.parameters}
    theirs = articulated(n, p)
    x, u, t = rng.normal(size=(calls, 2 * n + 2)), rng.normal(size=(calls, 1)), np.zeros(calls)
    ours = rates.along(t[:9], x[:9], u[:9], machine.values)[:, n + 1 :]
    forces = np.zeros(n + 1)

    def aba(row: int) -> Array:
        forces[0] = u[row, 0]
        return theirs(x[row, : n + 1], x[row, n + 1 :], forces)

    apart = max(float(np.abs(aba(i) - ours[i]).max() / np.abs(ours[i]).max()) for i in range(9))
    q, v = x[:, : n + 1].copy(), x[:, n + 1 :].copy()

    def called() -> None:
        for i in range(calls):
            theirs(q[i], v[i], forces)

    contenders: dict[str, Work] = {
        "ours": lambda: rates.along(t, x, u, machine.values),
        "aba": called,
    }
    return {k: s / calls for k, s in middle(in_turns(contenders, repeats)).items()}, apart


def side_rows(sizes: tuple[tuple[int, float], ...] = ((8, 0.2), (20, 0.5))) -> list[Row]:
    """The bars of the right-hand side; none without pinocchio."""
    try:
        import pinocchio  # noqa: F401
    except ImportError:
        return []
    result = []
    for n, bar in sizes:
        times, apart = right_sides(n)
        result.append(
            Row(
                f"right-hand side of {n} links on a cart",
                "our time over pinocchio's aba, called from Python",
                times["ours"] / times["aba"],
                bar,
                False,
                "×",
                f"{1e6 * times['ours']:.2g} µs, {1e6 * times['aba']:.2g} µs; accelerations differ "
                f"by {apart:.0e}",
            )
        )
    return result


def gradient_rows(values: int = 200, outputs: int = 2001, repeats: int = 9) -> list[Row]:
    """The bar of the adjoint: three links on a cart, pushed along straight lines."""
    machine = build(links.model_of(3, True))
    t_u, t = np.linspace(0, 4, values), np.linspace(0, 4, outputs)
    push = 3 * np.sin(3 * t_u)[:, None]
    scenario = Scenario(t, np.array([0.0, 0.5, 0.2, 0.1]), np.zeros(4), t_u, push)
    run = Rollout(seen(machine), scenario)
    goal = Objective(run, squares(0 * run(), np.ones(run.shape[1])), ("inputs",))
    for _ in range(20):
        goal(goal.begin)  # both are compiled by now
    times = middle(
        in_turns(
            {
                "value": lambda: goal.value(goal.begin),
                "gradient": lambda: goal(goal.begin),
            },
            repeats,
        )
    )
    return [
        Row(
            f"gradient by {values} numbers",
            "time of value and gradient by the adjoint over that of one run",
            times["gradient"] / times["value"],
            5,
            False,
            "×",
            f"{milliseconds(times['gradient'])}, {milliseconds(times['value'])}",
        ),
    ]


def seen(machine: Machine) -> Machine:
    """The machine with its coordinates measured."""
    from symhyb.model.read import parse_model

    rows = [
        f's_{c.name} = {{ measures = "{c.name}", unit = "{c.unit}" }}'
        for c in machine.model.coordinates
    ]
    text = "\n".join([machine.model.text, "[sensors]", *rows]) + "\n"
    return build(parse_model(text, "links.toml"))


def matched_apart(samples: int, repeats: int, **settings: str) -> float:
    """Seconds of the matching of four parameters in a process of its own with these variables."""
    command = [sys.executable, __file__, str(samples), str(repeats)]
    environment = {**os.environ, **settings}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    return float(json.loads(done.stdout))


def matching_rows(samples: int = 100_000, repeats: int = 1) -> list[Row]:
    """The bar of the matching."""
    fast = matched_apart(samples, repeats)
    slow = matched_apart(samples, repeats, SYMHYB_CC="")
    return [
        Row(
            f"4 parameters, {samples} samples, compiled",
            "time of our matching without a compiler over that with one",
            slow / fast,
            5,
            True,
            "×",
            f"{milliseconds(slow)}, {milliseconds(fast)}",
        ),
    ]


def rows() -> list[Row]:
    """All of them."""
    return [*run_rows(), *side_rows(), *gradient_rows(), *matching_rows()]


def _matching(samples: int, repeats: int) -> float:
    import trajectories

    work = trajectories.matched(trajectories.record(samples + 1))
    work()  # compiled, or its loops built
    return middle(in_turns({"ours": work}, repeats))["ours"]


if __name__ == "__main__":
    print(json.dumps(_matching(int(sys.argv[1]), int(sys.argv[2]))))

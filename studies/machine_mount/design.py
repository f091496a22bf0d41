"""The mount of a machine, designed in four ways against a recorded excitation.

    python studies/machine_mount/design.py          # writes results.json, design.png; minutes

    minimise  RMS of the force that the mount passes to the floor, over k and d
    so that   |travel| ≤ 0.8 mm at every sample
              weight/k ≤ 10 mm,  k ≤ 800 N/mm,  0.1 ≤ d ≤ 20 N·s/mm

Three optimisers ask symhyb; ``by_filter`` shares no code with it. Sizes: N samples, C pieces.
"""

import json
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, differential_evolution, minimize, minimize_scalar
from scipy.signal import lfilter

import symhyb as sh
from symhyb.optimisation.objective import values
from symhyb.optimisation.opti import whole_run
from symhyb.simulation import read_inputs

HERE = Path(__file__).resolve().parent
Array = NDArray[np.float64]

MASS, GRAVITY = 120.0, 9.81  # kg, m/s²
ROOM = 0.8e-3  # m, of travel
SAG = 10e-3  # m, under the weight
LOW, HIGH = np.array([MASS * GRAVITY / SAG, 100.0]), np.array([800e3, 20e3])  # N/m, N·s/m
PIECE = 20  # samples, 50 ms: in each the largest travel is one bound for SLSQP
TOO_FAR = 1e4  # N a share of ROOM: what travel beyond it costs a black box
ROOMS = 1e-3 * np.array([0.5, 0.6, 0.7, 0.8, 0.9, 1.0])  # m, of the trade-off
STARTS = (np.array([150e3, 2e3]), np.array([250e3, 3e3]), np.array([400e3, 1.5e3]))  # of these


@dataclass(frozen=True, slots=True)
class Design:
    """A mount, what it does (SI), and how many runs with and without slopes it took, and s."""

    k: float
    d: float
    felt: float
    travel: float
    runs: int
    slopes: int
    seconds: float


def rig() -> sh.Rollout:
    """The machine under the recording as a function of k and d."""
    model = sh.read_model(HERE / "machine.toml")
    recording = read_inputs(HERE / "excitation.csv", model)
    u = np.column_stack([recording.inputs[item.name] for item in model.inputs])
    scenario = sh.Scenario(recording.t, np.zeros(1), np.zeros(1), recording.t, u)
    return sh.Rollout(sh.build(model), scenario, free=["k", "d"])


def rms(y: Array) -> tuple[float, Array]:
    """The RMS of the force felt, in N, and its slopes by y (N, 2)."""
    felt = y[:, 1]
    value = float(np.sqrt(np.mean(felt**2)))
    slopes = np.zeros_like(y)
    slopes[:, 1] = felt / (value * felt.size)
    return value, slopes


def by_slsqp(run: sh.Rollout, start: Array | None = None, room: float = ROOM) -> Design:
    """SciPy: the gradient of the force by the adjoint, the slopes of the bounds forwards."""
    goal, begun = sh.Objective(run, rms), time.perf_counter()
    asked = {"force": 0, "bounds": 0, "slopes": 0}

    def felt(at: Array) -> tuple[float, Array]:
        asked["force"] += 1
        return goal(at)

    def spare(at: Array) -> Array:
        asked["bounds"] += 1
        travel = run(at * goal.scale)[:, 0]
        return 1 - np.abs(travel[_largest(travel)]) / room

    def spare_slopes(at: Array) -> Array:
        asked["slopes"] += 1
        theta = at * goal.scale
        travel = run(theta)[:, 0]
        worst = _largest(travel)
        slopes = run.jacobian(theta)[worst, 0] * goal.scale
        return -np.sign(travel[worst])[:, None] * slopes / room

    found = minimize(
        felt,
        goal.begin if start is None else start / goal.scale,
        jac=True,
        method="SLSQP",
        bounds=list(zip(LOW / goal.scale, HIGH / goal.scale, strict=True)),
        constraints={"type": "ineq", "fun": spare, "jac": spare_slopes},
        options={"ftol": 1e-9, "maxiter": 200},
    )
    if not found.success:
        raise RuntimeError(found.message)
    slopes = asked["force"] + asked["slopes"]
    return _reported(run, found.x * goal.scale, asked["bounds"], slopes, begun)


def _largest(travel: Array) -> NDArray[np.int64]:
    """The sample of the largest travel in each piece (C,): there it is smooth in k and d."""
    first = np.arange(0, travel.size - PIECE + 1, PIECE)
    pieces = np.abs(travel[: first.size * PIECE]).reshape(-1, PIECE)
    return np.asarray(first + np.argmax(pieces, axis=1))


def by_opti(run: sh.Rollout) -> Design:
    """CasADi and IPOPT: every sample of the travel is bounded."""
    begun, problem, whole = time.perf_counter(), ca.Opti(), whole_run(run, ["free"])
    at = problem.variable(2)
    y, _ = whole(at * run.theta)
    problem.minimize(ca.sqrt(ca.sumsqr(y[1, :]) / y.shape[1]))
    problem.subject_to(problem.bounded(-1, y[0, :] / ROOM, 1))
    problem.subject_to(problem.bounded(LOW / run.theta, at, HIGH / run.theta))
    problem.set_initial(at, 1)
    quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}
    problem.solver("ipopt", quiet | {"ipopt.hessian_approximation": "limited-memory"})
    found = problem.solve()
    asked = found.stats()
    runs = asked["n_call_nlp_f"] + asked["n_call_nlp_g"]
    slopes = asked["n_call_nlp_grad_f"] + asked["n_call_nlp_jac_g"]
    return _reported(run, found.value(at) * run.theta, runs, slopes, begun)


def by_evolution(run: sh.Rollout, seed: int = 1) -> Design:
    """A black box: differential evolution on values alone, a generation on two threads."""

    def cost(y: Array) -> tuple[float, Array]:
        beyond = np.abs(y[:, 0]).max() / ROOM - 1
        return rms(y)[0] + TOO_FAR * max(beyond, 0.0), y

    goal, begun = sh.Objective(run, cost), time.perf_counter()

    asked = 0

    def generation(at: Array) -> Array:
        nonlocal asked
        asked += at.shape[1]
        return values(goal, at.T, threads=2)

    found = differential_evolution(
        generation,
        list(zip(LOW / goal.scale, HIGH / goal.scale, strict=True)),
        rng=seed,
        vectorized=True,
        updating="deferred",
        polish=False,
        tol=1e-8,
        maxiter=300,
    )
    return _reported(run, found.x * goal.scale, asked, 0, begun)


def _reported(run: sh.Rollout, theta: Array, runs: int, slopes: int, begun: float) -> Design:
    seconds, y = time.perf_counter() - begun, run(theta)
    travel = float(np.abs(y[:, 0]).max())
    return Design(float(theta[0]), float(theta[1]), rms(y)[0], travel, runs, slopes, seconds)


def filtered(k: float, d: float, record: Array) -> Array:
    """Travel and force (N, 2), SI, without symhyb, from rest: z = (x₁ − x₂)/(λ₁ − λ₂) with
    x' = λx + u, exact where u runs straight between the samples of the ``record`` (t, floor,
    force); λ are the roots of mλ² + dλ + k."""
    t, floor, force = record.T
    u, h = force / MASS - floor, t[1] - t[0]
    swing = np.sqrt(complex(d**2 - 4 * k * MASS))
    roots = np.array([-d + swing, -d - swing]) / (2 * MASS)
    modes = []
    for root in roots:
        grown = np.exp(root * h)
        then = (grown - 1 - root * h) / (root**2 * h)
        here = (grown - 1) / root - then
        modes.append(lfilter([then, here], [1, -grown], u, zi=[-then * u[0]])[0])
    z, v = (
        ((roots[0] ** n * modes[0] - roots[1] ** n * modes[1]) / (roots[0] - roots[1])).real
        for n in (0, 1)
    )
    return np.column_stack([z, k * z + d * v])


def by_filter(record: Array, room: float = ROOM) -> Design:
    """The same optimum without symhyb: for each k the d that passes least and keeps the room,
    on ever finer grids of k."""
    begun, count = time.perf_counter(), 0

    def at(k: float, d: float) -> tuple[float, float]:
        nonlocal count
        count += 1
        y = filtered(k, d, record)
        return rms(y)[0], float(np.abs(y[:, 0]).max())

    def best_d(k: float) -> float:
        def beyond(d: float) -> float:
            return at(k, d)[1] - room

        span = (LOW[1], HIGH[1])
        free = float(minimize_scalar(lambda d: at(k, d)[0], bounds=span, method="bounded").x)
        if beyond(free) <= 0:
            return free
        found = [_first_root(beyond, np.geomspace(free, end, 40)) for end in span]
        return min((d for d in found if d), default=HIGH[1], key=lambda d: at(k, d)[0])

    def felt(k: float) -> float:
        return at(k, best_d(k))[0]

    low, high, points = LOW[0], HIGH[0], 25
    while high - low > 1e-9 * high:  # no golden section: where a way out ends, the force jumps
        grid = np.linspace(low, high, points)
        i = int(np.argmin([felt(k) for k in grid]))
        low, high, points = grid[max(i - 1, 0)], grid[min(i + 1, grid.size - 1)], 9
    k = float(grid[i])
    d = best_d(k)
    return Design(k, d, *at(k, d), count, 0, time.perf_counter() - begun)


def _first_root(beyond: Callable[[float], float], way: Array) -> float | None:
    """Where what is positive at way[0] first falls to 0, dips between the points included."""
    height = np.array([beyond(d) for d in way])
    for i in range(1, way.size):
        there = way[i]
        if height[i] > 0 and i + 1 < way.size and height[i] <= min(height[i - 1], height[i + 1]):
            sides = sorted((way[i - 1], way[i + 1]))
            fine = {"xatol": 1e-9 * way[i]}
            there = minimize_scalar(beyond, bounds=sides, method="bounded", options=fine).x
        if beyond(there) <= 0:
            return float(brentq(beyond, way[i - 1], there, xtol=1e-9))
    return None


def trade_off(run: sh.Rollout) -> list[tuple[float, Design]]:
    """The best mount for each room in m: the lowest of a few starts, for each has its valleys."""
    best = []
    for room in ROOMS:
        tried = []
        for start in STARTS:
            with suppress(RuntimeError):  # SLSQP gives up: the other starts are there for that
                tried.append(by_slsqp(run, start, room))
        best.append((float(room), min(tried, key=lambda design: design.felt)))
    return best


def excitation() -> Array:
    """The recording (N, 3): t, floor, force, read without symhyb."""
    return np.loadtxt(HERE / "excitation.csv", delimiter=",", skiprows=1)


def picture(
    run: sh.Rollout, before: Design, after: Design, curve: list[tuple[float, Design]]
) -> None:
    """The trade-off with the mount chosen, and what the recording does before and after."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=(9.5, 5.2), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.9))
    axes = figure.add_subplot(grid[:, 0])
    axes.plot(
        [1e3 * room for room, _ in curve],
        [d.felt for _, d in curve],
        "o-",
        ms=4,
        label="best mounts",
    )
    axes.plot(1e3 * before.travel, before.felt, "s", color="0.4", label="as delivered")
    axes.plot(
        1e3 * after.travel, after.felt, "o", ms=11, mfc="none", mew=2, color="C3", label="chosen"
    )
    for room, mount in curve:
        axes.annotate(
            f"{1e-3 * mount.k:.0f} N/mm, {1e-3 * mount.d:.2f} N·s/mm",
            (1e3 * room, mount.felt),
            xytext=(7, 4),
            textcoords="offset points",
            fontsize=7,
            clip_on=False,
        )
    axes.set(
        xlabel="largest travel [mm]", ylabel="RMS of the force to the floor [N]", ylim=(0, None)
    )
    axes.legend(fontsize=8, frameon=False, loc="lower left")
    panels = [figure.add_subplot(grid[0, 1])]
    panels.append(figure.add_subplot(grid[1, 1], sharex=panels[0]))
    for mount, color, said in ((before, "0.6", "as delivered"), (after, "C3", "chosen")):
        y = run(np.array([mount.k, mount.d]))
        panels[0].plot(run.t, y[:, 1], color=color, lw=0.6, label=said)
        panels[1].plot(run.t, 1e3 * y[:, 0], color=color, lw=0.6)
    for side in (-1, 1):
        panels[1].axhline(1e3 * side * ROOM, color="k", lw=0.8, ls="--")
    panels[0].set_ylabel("force [N]")
    panels[0].legend(fontsize=8, frameon=False, loc="upper left", ncols=2)
    panels[1].set(xlabel="t [s]", ylabel="travel [mm]", xlim=(0, run.t[-1]))
    panels[0].tick_params(labelbottom=False)
    figure.savefig(HERE / "design.png", dpi=110)


def main() -> None:
    """Design in four ways, and along the trade-off."""
    run, record = rig(), excitation()
    delivered = _reported(run, run.theta, 1, 0, time.perf_counter())
    ways = {
        "as delivered": replace(delivered, seconds=0.0),
        "SLSQP, adjoint": by_slsqp(run),
        "casadi.Opti, IPOPT": by_opti(run),
        "differential evolution": by_evolution(run),
        "without symhyb": by_filter(record),
    }
    curve = trade_off(run)
    reported = {
        "room_m": ROOM,
        "ways": {name: asdict(design) for name, design in ways.items()},
        "trade_off": [
            {"room_m": room, **asdict(design), "without symhyb": asdict(by_filter(record, room))}
            for room, design in curve
        ],
    }
    for name, design in ways.items():
        print(f"{name:24} {design}")
    for room, design in curve:
        print(f"{1e3 * room:4.1f} mm {design}")
    (HERE / "results.json").write_text(json.dumps(reported, indent=1) + "\n", encoding="utf-8")
    picture(run, delivered, ways["SLSQP, adjoint"], curve)


if __name__ == "__main__":
    main()

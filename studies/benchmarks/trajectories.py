r"""Four parameters matched to a simulation: Gauss–Newton over windows, and IPOPT's shooting.

    wall |--/\/\/--[m]--> x      m x'' = u(t) − c x − d x' − μ m g tanh(x'/w)
         |---|-]----|

m = 1 kg, c = 100 N/m, d = 0.5 N·s/m, μ = 0.05, w = 1 cm/s, driven by a multisine, recorded at
200 Hz with 1 mm of noise; begun 15 to 30 % away. Both get the same rough states to begin with, and
their functions before the clock starts: IPOPT its problem with its derivatives built, symhyb its
steps compiled. IPOPT solves multiple shooting as CasADi's own example of system identification
does: Runge–Kutta steps from sample to sample, a free state every 100 samples that has to meet the
end of the stretch before, the Gauss–Newton Hessian. symhyb fits windows, each with an initial
state of its own, first of 100 samples, then of 1000, as the diagnosis does.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from threadpoolctl import threadpool_limits
from timing import Row, in_turns, middle, milliseconds

from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.matching import TRIAL_DECREASE, TRIAL_ITERATIONS, fit
from symhyb.discrepancy.fitting.task import Fit, Task
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.windows import lay
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.windows import WindowModel

Array = NDArray[np.float64]
NAMES = ("m", "c", "d", "mu")
TRUE = np.array([1.0, 100.0, 0.5, 0.05])
BEGIN = TRUE * [1.15, 0.8, 1.3, 0.7]
GRAVITY, WIDTH, STEP, NOISE = 9.81, 1e-2, 5e-3, 1e-3
SUBSTEPS = 5
INTERVAL, WINDOWS = 100, (100, 1000)  # samples
TEXT = f"""
symhyb = 1
title = "oscillator"
[coordinates]
x = {{ unit = "m" }}
[parameters]
m = {{ value = {BEGIN[0]}, unit = "kg" }}
c = {{ value = {BEGIN[1]}, unit = "N/m" }}
d = {{ value = {BEGIN[2]}, unit = "N*s/m" }}
mu = {{ value = {BEGIN[3]}, unit = "1" }}
grav = {{ value = {GRAVITY}, unit = "m/s^2" }}
w = {{ value = {WIDTH}, unit = "m/s" }}
[inputs]
u = {{ unit = "N" }}
[bodies]
block = {{ mass = "m", at = ["x", "0"] }}
[elements]
spring = {{ kind = "spring", on = "x", stiffness = "c" }}
damper = {{ kind = "damper", on = "x", damping = "d" }}
rail = {{ kind = "friction", on = "x", coulomb = "mu*m*grav", transition = "w" }}
shaker = {{ kind = "force", on = "x", force = "u" }}
[sensors]
laser = {{ unit = "m", measures = "x" }}
"""


@dataclass(frozen=True, slots=True)
class Record:
    """Times (N,), input (N,), measured place (N,), and rough places and speeds (N,), SI."""

    t: Array
    u: Array
    y: Array
    q: Array
    v: Array


def record(samples: int, seed: int = 1) -> Record:
    """The first samples of a run, by Runge–Kutta steps of a fifth of a sample; the input is a
    straight line between samples."""
    rng = np.random.default_rng(seed)
    t = np.arange(samples) * STEP
    lines, phase = np.linspace(0.2, 4, 20), rng.uniform(0, 2 * np.pi, 20)
    u = np.zeros(samples)
    for line, shift in zip(lines, phase, strict=True):
        u += 0.7 * np.sin(2 * np.pi * line * t + shift)
    fine = np.linspace(0, 1, SUBSTEPS + 1)
    inside = u[:-1, None] + np.diff(u)[:, None] * fine
    drive = np.stack([inside[:, :-1], inside[:, 1:]]).reshape(2, -1)
    step = runge_kutta(STEP / SUBSTEPS).mapaccum("run", drive.shape[1])
    x = step(np.zeros(2), drive, np.ones(4)).full()[0, SUBSTEPS - 1 :: SUBSTEPS]
    y = np.append(0.0, x) + NOISE * rng.standard_normal(samples)
    smooth = uniform_filter1d(y, 9)
    return Record(t, u, y, smooth, uniform_filter1d(np.gradient(smooth, t), 9))


def runge_kutta(h: float) -> ca.Function:
    """(state, input before and after, parameters over the true ones) -> state ``h`` seconds on."""
    x, u, p = ca.SX.sym("x", 2), ca.SX.sym("u", 2), ca.SX.sym("p", 4)
    m, c, d, mu = ca.vertsplit(p * TRUE)

    def rate(state: ca.SX, push: ca.SX) -> ca.SX:
        place, speed = state[0], state[1]
        pull = (push - c * place - d * speed) / m
        return ca.vertcat(speed, pull - mu * GRAVITY * ca.tanh(speed / WIDTH))

    k1 = rate(x, u[0])
    k2 = rate(x + h / 2 * k1, (u[0] + u[1]) / 2)
    k3 = rate(x + h / 2 * k2, (u[0] + u[1]) / 2)
    k4 = rate(x + h * k3, u[1])
    return ca.Function("step", [x, u, p], [x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])


def matched(given: Record) -> Callable[[], Fit]:
    """The fit by symhyb, ready to run."""
    machine = build(parse_model(TEXT, "oscillator.toml"))
    model = WindowModel(machine, tuple(machine.column(name) for name in NAMES))
    run, motion = _recording(given), _motion(given)
    none, free = np.zeros(4), np.full(4, np.inf)
    tasks = []
    for samples in WINDOWS:
        cut = lay(run, machine, motion, samples * STEP)
        assert cut is not None
        tasks.append(Task((cut,), np.array([NOISE]), none, free, none, free, everything=True))
    rough = replace(tasks[0], decrease=TRIAL_DECREASE, iterations=TRIAL_ITERATIONS)

    def work() -> Fit:
        p = machine.values.copy()
        p[list(model.free)] = fit(model, rough, p).values
        return fit(model, tasks[1], p)

    return work


def _recording(given: Record) -> Recording:
    return Recording("run.csv", given.t, {"u": given.u}, {"laser": given.y}, (), "")


def _motion(given: Record) -> Motion:
    one, noise = np.ones(1), np.full(1, NOISE)
    q, v = given.q[:, None], given.v[:, None]
    return Motion(given.t, q, v, 0 * q, noise, one, one, noise, STEP)


def shooting(given: Record) -> Callable[[], Array]:
    """Parameters (4,) by IPOPT, built and ready to run; after CasADi's example."""
    count = (given.t.size - 1) // INTERVAL
    used = count * INTERVAL
    drive = np.stack([given.u[:used], given.u[1 : used + 1]])
    along = runge_kutta(STEP).mapaccum("interval", INTERVAL).map(count)
    begin, numbers = ca.MX.sym("begin", 2, count), ca.MX.sym("numbers", 4)
    after = along(begin, drive, ca.repmat(numbers, 1, used))
    ends = after[:, INTERVAL - 1 :: INTERVAL]
    gaps = ca.vec(ends[:, :-1] - begin[:, 1:])
    miss = ca.vertcat(begin[0, 0] - given.y[0], after[0, :].T - given.y[1 : used + 1]) / NOISE
    return _solver(ca.veccat(numbers, begin), miss, gaps, given, count)


def _solver(
    unknown: ca.MX, miss: ca.MX, gaps: ca.MX, given: Record, count: int
) -> Callable[[], Array]:
    slope, weight = ca.jacobian(miss, unknown), ca.MX.sym("weight")
    curve = weight * ca.triu(slope.T @ slope)
    size = gaps.size1()
    hessian = ca.Function(
        "hessian",
        [unknown, ca.MX.sym("p", 0), weight, ca.MX.sym("lam", size)],
        [curve],
        ["x", "p", "lam_f", "lam_g"],
        ["hess_gamma_x_x"],
    )
    quiet = {"hess_lag": hessian, "print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}
    nlp = {"x": unknown, "f": 0.5 * ca.dot(miss, miss), "g": gaps}
    solver = ca.nlpsol("solver", "ipopt", nlp, quiet)
    rows = np.arange(count) * INTERVAL
    states = np.column_stack([given.q[rows], given.v[rows]]).reshape(-1)
    first = np.concatenate([BEGIN / TRUE, states])

    def run() -> Array:
        found = solver(x0=first, lbg=0, ubg=0)
        assert solver.stats()["success"], solver.stats()["return_status"]
        return np.asarray(found["x"][:4]).ravel() * TRUE

    return run


def off(values: Array) -> float:
    """The largest relative error of the four."""
    return float(np.abs(values / TRUE - 1).max())


def rows(sizes: tuple[int, ...] = (10_000, 30_000, 100_000), repeats: int = 3) -> list[Row]:
    """Bars of the fit, everybody's BLAS in one thread."""
    whole = record(max(sizes) + 1)
    with threadpool_limits(1):
        ours = {size: matched(_first(whole, size)) for size in sizes}
        theirs = shooting(whole)
        contenders: dict[str, Callable[[], object]] = {str(size): ours[size] for size in sizes}
        for work in ours.values():
            work()  # compiled
        times = middle(in_turns({**contenders, "ipopt": theirs}, repeats))
    small, large = min(sizes), max(sizes)
    slope = float(np.polyfit(np.log(sizes), [np.log(times[str(size)]) for size in sizes], 1)[0])
    reported = ", ".join(f"{size} samples {milliseconds(times[str(size)])}" for size in sizes)
    name, best = f"4 parameters, {large} samples", ours[large]()
    return [
        Row(
            name,
            "time of IPOPT's multiple shooting over ours",
            times["ipopt"] / times[str(large)],
            3,
            True,
            "×",
            f"{milliseconds(times['ipopt'])}, {milliseconds(times[str(large)])}; "
            f"largest relative error: IPOPT {off(theirs()):.1e}, ours {off(best.values):.1e}",
        ),
        Row(
            name,
            f"our time a sample over that with {small} samples",
            times[str(large)] / large / (times[str(small)] / small),
            1.5,
            False,
            "×",
            f"{reported}; time grows with the power {slope:.2f} of the samples",
        ),
    ]


def _first(given: Record, samples: int) -> Record:
    some = slice(0, samples + 1)
    return Record(given.t[some], given.u[some], given.y[some], given.q[some], given.v[some])

"""Sensors that record late by many samples: reported by their delay alone, without a gain."""

from functools import cache

import numpy as np
import pytest
from builders import damper, oscillator, push, recording, spring
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.matching import fit
from symhyb.discrepancy.fitting.task import Fit, Task
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.windows import Cut, lay
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.windows import WindowModel

Array = NDArray[np.float64]

STEP, LATE = 0.01, 0.0737  # s: 7.4 samples, of a motion whose fastest line turns by 1.8 rad in it
T = np.arange(1200) * STEP
LINES, PHASES = np.array([4.0, 9.0, 15.0, 24.0]), np.array([0.0, 1.0, 2.0, 3.0])
SD = np.array([3e-4, 6e-3])
STATED = {"unit": "s", "value": 0.0}


def force(t: float) -> float:
    return float(np.sum(3 * np.sin(LINES * t + PHASES)))


@cache
def recorded() -> Recording:
    """A mass on a spring by SciPy: its place at once, its speed late."""

    def rate(t: float, x: Array) -> list[float]:
        return [x[1], (force(t) - 300 * x[0] - 1.5 * x[1]) / 1.2]

    run = solve_ivp(
        rate, (-1, T[-1]), [0, 0], "DOP853", rtol=1e-9, atol=1e-11, max_step=STEP, dense_output=True
    )
    noise = np.random.default_rng(3).normal(size=(2, T.size)) * SD[:, None]
    return recording(
        T,
        {"f": np.array([force(t) for t in T])},
        place=run.sol(T)[0] + noise[0],
        speed=run.sol(T - LATE)[1] + noise[1],
    )


@cache
def rig(*free: str) -> tuple[Machine, WindowModel]:
    model = oscillator(
        {"hold": spring("k"), "oil": damper("d"), "motor": push("f")},
        {"k": (300.0, "N/m"), "d": (1.5, "N*s/m")},
        inputs={"f": {"unit": "N"}},
        sensors={
            "place": {"measures": "x", "unit": "m"},
            "speed": {
                "measures": "x'",
                "unit": "m/s",
                "delay": STATED,
                "gain": {"unit": "1", "value": 1.0},
            },
        },
    )
    machine = build(model)
    return machine, WindowModel(machine, tuple(machine.column(name) for name in free))


def windows(of: Recording) -> Cut:
    machine, _ = rig("speed.delay")
    cut = lay(of, machine, motion_of(of, machine), 1.0)
    assert cut is not None
    return cut


def fitted(*free: str) -> Fit:
    machine, model = rig(*free)
    wide = np.full(len(free), np.inf)
    task = Task((windows(recorded()),), SD, -wide, wide, np.zeros(len(free)), wide)
    return fit(model, task, machine.values.copy())


def test_a_delay_of_many_samples_is_all_that_is_needed() -> None:
    found = fitted("speed.delay")
    sd = float(np.sqrt(found.covariance[0, 0]))
    assert sd < 1e-3
    assert found.values[0] == pytest.approx(LATE, abs=3 * sd)
    assert found.scale == pytest.approx(1.0, abs=0.15)


def test_no_gain_stands_for_a_part_of_it() -> None:
    found = fitted("speed.delay", "speed.gain")
    sd = np.sqrt(np.diag(found.covariance))
    assert found.values == pytest.approx([LATE, 1.0], abs=4 * float(sd.max()))
    assert sd[1] < 0.02


def test_signals_are_taken_later_by_whole_samples() -> None:
    machine, model = rig("speed.delay")
    run, p = recorded(), machine.values.copy()
    cut = windows(run)
    p[machine.column("speed.delay")] = 0.4 * STEP
    assert cut.in_time(model, p) is cut
    p[machine.column("speed.delay")] = LATE
    later = cut.in_time(model, p)
    assert later.block.late == pytest.approx((0.0, 7 * STEP))
    assert np.array_equal(later.block.y[0, :, 1], run.sensors["speed"][cut.rows[0] + 7])
    assert np.array_equal(later.block.y[..., 0], cut.block.y[..., 0])
    assert later.in_time(model, p) is later
    assert np.isnan(later.block.y[-1, cut.rows[-1] + 7 >= T.size, 1]).all()
    assert later.in_time(model, machine.values).block.late == ()


def test_nothing_is_taken_across_a_gap() -> None:
    gone = (T > 5) & (T < 6)
    run = recorded()
    short = Recording(
        "gap.csv",
        T[~gone],
        {"f": run.inputs["f"][~gone]},
        {name: values[~gone] for name, values in run.sensors.items()},
        (),
        "",
    )
    machine, model = rig("speed.delay")
    p = machine.values.copy()
    p[machine.column("speed.delay")] = LATE
    cut = windows(short)
    late = cut.in_time(model, p).block
    then = cut.rows + 7
    inside = then < short.t.size
    across = np.zeros_like(inside)
    across[inside] = short.t[then[inside]] - late.t[inside] > 0.1
    assert across.any()
    assert np.isnan(late.y[..., 1][across]).all()
    assert np.isfinite(late.y[..., 1][inside & ~across]).all()

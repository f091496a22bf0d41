"""Machines with a monitor in C: their recordings, and what the compiled program says of them."""

import subprocess
from functools import cache
from math import cos, sin, tanh
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from symhyb.data.recording import Recording
from symhyb.data.thin import stretch
from symhyb.export.monitor.files import monitor_files
from symhyb.model.read import parse_model
from symhyb.monitoring.begun import Begun, begun
from symhyb.numeric.kernels.buffers import Array

FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter", "-pedantic")

CART = """symhyb = 1
gravity = ["0", "-g"]
[coordinates]
x = { unit = "m" }
a = { unit = "deg" }
[parameters]
m = { value = 1.0, unit = "kg" }
b = { value = 0.4, unit = "kg" }
l = { value = 0.5, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
k = { value = 25.0, unit = "N/m", sd = 0.5 }
mu = { value = 0.8, unit = "N", sd = 0.1 }
rub = { value = 0.02, unit = "N*m" }
pre = { value = 2.0, unit = "N*m/rad" }
[inputs]
f = { unit = "N" }
[bodies.cart]
mass = "m"
at = ["x", "0"]
[bodies.bob]
mass = "b"
at = ["x + l*sin(a)", "-l*cos(a)"]
[elements.spring]
kind = "spring"
on = "x"
stiffness = "k"
[elements.guide]
kind = "friction"
on = "x"
coulomb = "mu"
[elements.bearing]
kind = "friction_dynamic"
on = "a"
coulomb = "rub"
stiffness = "pre"
[elements.push]
kind = "force"
on = "x"
force = "f"
[sensors]
pos = { measures = "x", unit = "mm" }
tilt = { measures = "l*sin(a)", unit = "m" }
"""
"""A pendulum on a cart with dry friction, whose bearing remembers."""


def compiled(folder: Path, name: str, *more: str) -> Path:
    """The program of a monitor, without a warning."""
    sources = (f"{name}.c", f"{name}_main.c")
    command = ["cc", "-O1", "-ffp-contract=off", *FLAGS, *more, *sources, "-lm", "-o", "program"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / "program"


def rows_of(recording: Recording) -> str:
    """What the program reads: time, inputs and sensors, SI."""
    channels = [recording.t, *recording.inputs.values(), *recording.sensors.values()]
    return "".join(",".join(map(repr, row)) + "\n" for row in np.column_stack(channels).tolist())


def answered(program: Path, rows: str, *options: str) -> tuple[int, list[str]]:
    """How the program ends, and the lines it prints."""
    done = subprocess.run(
        [program, *options], input=rows, capture_output=True, text=True, check=False
    )
    return done.returncode, [*done.stdout.splitlines(), *done.stderr.splitlines()]


def made(found: Begun, folder: Path, name: str = "monitor") -> Path:
    """The compiled monitor of a reference."""
    for file, text in monitor_files(found, name, "good.csv", 1.0).items():
        (folder / file).write_text(text, encoding="utf-8")
    return compiled(folder, name)


def scores_of(lines: list[str]) -> Array:
    """Begin, end, motion and of every column information and score of each block (B, 3 + 2 F)."""
    kept = [line.split()[1:] for line in lines if line.startswith("block ")]
    return np.array(kept, dtype=float)


@cache
def cart(seed: int, seconds: float = 45.0, rate: float = 200.0) -> Recording:
    """The pendulum on its cart under a push that noise keeps from being smooth, SI."""
    random = np.random.default_rng(seed)
    t = np.arange(0, seconds, 1 / rate)
    waves, phases = random.uniform(0.2, 1.6, 8), random.uniform(0, 2 * np.pi, 8)
    push = 3 * np.sin(2 * np.pi * np.outer(t, waves) + phases).sum(axis=1) / 2
    push += 0.3 * random.standard_normal(t.size)

    def rates(now: float, state: Array) -> tuple[float, ...]:
        x, a, v, w, z = state.tolist()
        on_x = float(np.interp(now, t, push)) - 25 * x - 0.8 * tanh(v / 5e-3)
        on_x += 0.2 * sin(a) * w**2
        on_a = -1.962 * sin(a) - 2 * z
        joint = 0.2 * cos(a)  # of the mass matrix [[1.4, joint], [joint, 0.1]]
        whole = 0.14 - joint**2
        first = (0.1 * on_x - joint * on_a) / whole
        return v, w, first, (1.4 * on_a - joint * on_x) / whole, w - 2 * abs(w) * z / 0.02

    run = solve_ivp(rates, (0, t[-1]), np.zeros(5), "LSODA", t, rtol=1e-6, atol=1e-8)
    pos = run.y[0] + 1e-4 * random.standard_normal(t.size)
    tilt = 0.5 * np.sin(run.y[1]) + 1e-4 * random.standard_normal(t.size)
    return Recording("cart.csv", t, {"f": push}, {"pos": pos, "tilt": tilt}, (), "")


@cache
def cart_begun() -> Begun:
    """The cart as it is, by its first 40 s."""
    whole = cart(3)
    return begun(parse_model(CART, "cart.toml"), stretch(whole, slice(0, 8000)), 1.0, "cart.csv")

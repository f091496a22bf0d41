"""An arm with seven joints at 1 kHz: what its watch costs, and whether it names the joint.

    python studies/watch/arm.py [--first 0] [--changes 7] [--nulls 1] [--null-s 240] [--in-c]

MuJoCo simulates the arm of `arm.xml`, with dry friction and a controller that are written here: the
arm follows sums of sines whose lines and phases a seed draws, and stands still now and then. After
90 s the dry friction of one joint, seed by seed the next one, is 30 % more. With --in-c the monitor
in C watches. The time of the processor counts from the end of the reference on. Prints a table;
nothing here is a test.
"""

import argparse
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import mujoco  # type: ignore[import-untyped]
import numpy as np
from in_c import played_in_c
from numpy.typing import NDArray

from symhyb.imports.deliver import Order, model_of, read_robot
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.monitoring.watching import Watch, watch

Array = NDArray[np.float64]

ROBOT = Path(__file__).parent / "arm.xml"
JOINTS, RATE, PARTS = 7, 1000, 2  # steps of MuJoCo between two rows
REFERENCE_S, AT_S, AFTER_S = 60.0, 90.0, 20.0
MORE = 0.3  # of the dry friction
TURNING = 0.01  # rad/s, over which dry friction turns over
NOISE, RIPPLE = 2e-5, 1e-3  # of the encoders, rad, and of the torques, as a share of their size
SIZE = np.array([0.5, 0.35, 0.5, 0.45, 0.6, 0.6, 0.7])  # of the path, rad
MIDDLE = np.array([0.0, 0.5, 0.0, 1.2, 0.0, 0.8, 0.0])
STIFF = np.array([3000.0, 3500.0, 1500.0, 1500.0, 400.0, 350.0, 150.0])  # N·m/rad
RATES = STIFF * 0.03  # of the controller, N·m·s/rad
MOVING_S, STILL_S, FADE_S = 14.0, 1.5, 0.5  # how long it moves, stands, and comes to rest


def arm_model() -> Model:
    """What `symhyb import` makes of the robot, with what is known of losses in its joints."""
    model, _ = model_of(read_robot(ROBOT), Order(), "arm.toml")
    text = re.sub(
        r"(?m)^(j_\d_(?:damping|friction) += \{ value = ([\d.]+),)",
        lambda found: f"{found[1]} sd = {0.2 * float(found[2]):.3g},",
        model.text,
    )
    text = text.replace(
        "[parameters]", f'[parameters]\nturn = {{ value = {TURNING}, unit = "rad/s" }}'
    )
    return parse_model(re.sub(r"(?m)^(coulomb .*)$", r'\1\ntransition = "turn"', text), "arm.toml")


@cache
def _travelled(seconds: float) -> Array:
    """How far along its path the arm is at every half step, s: it stands still now and then."""
    t = np.arange(2 * PARTS * RATE * seconds + 2) / (2 * PARTS * RATE)
    within = t % (MOVING_S + STILL_S)
    rise = np.clip(np.minimum(within, MOVING_S - within) / FADE_S, 0, 1)
    speed = rise**3 * (10 - 15 * rise + 6 * rise**2)
    return np.asarray(np.cumsum(speed) / (2 * PARTS * RATE))


def _path(seed: int, seconds: float) -> tuple[Array, Array]:
    """Commanded angles and rates (half steps, 7), rad and rad/s."""
    rng = np.random.default_rng(20_000 + seed)
    waves, phases = rng.uniform(0.15, 1.2, (4, JOINTS)), rng.uniform(0, 2 * np.pi, (4, JOINTS))
    along = _travelled(seconds)
    angle = np.zeros((along.size, JOINTS)) + MIDDLE
    for wave, phase in zip(waves, phases, strict=True):
        angle += SIZE / 4 * np.sin(2 * np.pi * np.outer(along, wave) + phase)
    return angle, np.gradient(angle, axis=0) * 2 * PARTS * RATE


@dataclass(frozen=True, slots=True)
class Drawn:
    """The ``joint``, from 0 on, of which the dry friction changes."""

    joint: int


def moved(seed: int, seconds: float, change: Drawn | None) -> tuple[Array, Array]:
    """Torques and angles (rows, 7), N·m and rad, as they are."""
    spec = mujoco.MjSpec.from_file(str(ROBOT))
    levels = np.array([joint.frictionloss for joint in spec.joints])
    for joint in spec.joints:
        joint.frictionloss = 0  # MuJoCo's own is soft
    spec.option.timestep = 1 / (PARTS * RATE)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model = spec.compile()
    data = mujoco.MjData(model)
    angle, rate = _path(seed, seconds)
    half = 2 * PARTS * RATE
    later = levels.copy()
    if change is not None:
        later[change.joint] *= 1 + MORE

    def torque(now: float, q: Array, v: Array) -> Array:
        at = round(now * half)
        return np.asarray(STIFF * (angle[at] - q) + RATES * (rate[at] - v))

    def push(_: object, now: mujoco.MjData) -> None:
        rubs = later if now.time > AT_S else levels
        driven = torque(now.time, now.qpos, now.qvel)
        now.qfrc_applied[:] = driven - rubs * np.tanh(now.qvel / TURNING)

    rows = round(seconds * RATE)
    torques, angles = np.empty((rows, JOINTS)), np.empty((rows, JOINTS))
    data.qpos[:] = angle[0]
    mujoco.set_mjcb_control(push)
    try:
        for row in range(rows):
            torques[row] = torque(row / RATE, data.qpos, data.qvel)
            angles[row] = data.qpos
            mujoco.mj_step(model, data, nstep=PARTS)
    finally:
        mujoco.set_mjcb_control(None)
    return torques, angles


def lines(seed: int, seconds: float, change: Drawn | None) -> Iterator[str]:
    """The rows of a logger."""
    rng = np.random.default_rng(30_000 + seed)
    torques, angles = moved(seed, seconds, change)
    torques = torques + RIPPLE * torques.std(axis=0) * rng.standard_normal(torques.shape)
    angles = angles + NOISE * rng.standard_normal(angles.shape)
    names = [f"j_{i + 1}" for i in range(JOINTS)]
    yield ",".join(["t", *(f"{name}_torque" for name in names), *names])
    for i, row in enumerate(np.column_stack([torques, angles])):
        yield f"{i / RATE:.4f}," + ",".join(f"{value:.7g}" for value in row)


@dataclass(frozen=True, slots=True)
class Said:
    """What a watch says of a run: when something has changed and what it is named, s and words; and
    the seconds of processor for each second of the source after the reference."""

    at: tuple[float, ...]
    names: tuple[str, ...]
    cost: float


def said_in_python(rows: list[str]) -> Said:
    """By `symhyb watch`'s own loop."""
    first = 1 + round(REFERENCE_S * RATE)
    spent = []

    def given() -> Iterator[str]:
        yield from rows[:first]
        spent.append(time.process_time())
        yield from rows[first:]

    events = list(watch(Watch(arm_model(), REFERENCE_S), given()))
    cost = (time.process_time() - spent[0]) / ((len(rows) - first) / RATE)
    at = tuple(e.at_s for e in events if e.kind == "changed")
    return Said(at, tuple(e.sentence for e in events if e.kind == "named"), cost)


def said_in_c(rows: list[str]) -> Said:
    """By the monitor in C, which is silent after its first name."""
    first = round(REFERENCE_S * RATE)
    played = played_in_c(arm_model(), rows, first, "arm")
    at = tuple(float(one.split(" ")[0]) for one in played.lines if "something has changed" in one)
    names = tuple(one for one in played.lines if "what has changed" in one)
    return Said(at, names, played.spent_s / ((len(rows) - first - 1) / RATE))


def main() -> None:
    """Simulate, watch and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--changes", type=int, default=JOINTS)
    parser.add_argument("--nulls", type=int, default=1)
    parser.add_argument("--null-s", type=float, default=240.0)
    parser.add_argument("--in-c", action="store_true", help="by the monitor in C")
    options = parser.parse_args()
    watched: Callable[[list[str]], Said] = said_in_c if options.in_c else said_in_python
    soon = right = false = 0
    costs = []
    for seed in range(options.first, options.first + options.changes):
        change = Drawn(seed % JOINTS)
        said = watched(list(lines(seed, AT_S + AFTER_S, change)))
        after = [at - AT_S for at in said.at if at > AT_S]
        false += len(said.at) - len(after)
        soon += bool(after) and after[0] <= 5
        name = said.names[-1] if said.names else "not named"
        joint = f"j_{change.joint + 1}"
        hit = bool(after) and f"parameter {joint}_friction" in name
        right += hit
        costs.append(said.cost)
        when = f"told after {after[0]:.1f} s" if after else "not told"
        when += f", {said.cost:.3f} s/s"
        print(
            f"{seed}: {joint}: {when}, {name}{'' if hit else ' (wrong)'}",
            flush=True,
        )
    for seed in range(1000 + options.first, 1000 + options.first + options.nulls):
        said = watched(list(lines(seed, options.null_s, None)))
        false += len(said.at)
        costs.append(said.cost)
        print(f"{seed}: nothing changes: {len(said.at)} alarms, {said.cost:.3f} s/s", flush=True)
    hours = options.nulls * (options.null_s - REFERENCE_S) / 3600
    hours += options.changes * (AT_S - REFERENCE_S) / 3600
    print(
        f"\ntold within 5 s: {soon} of {options.changes}; named: {right} of {options.changes}; "
        f"false alarms: {false} in {hours:.2f} h; {np.median(costs):.3f} s of processor for a "
        f"second of the source"
    )


if __name__ == "__main__":
    main()

"""A simulated fleet of drives, one of twenty of them odd, with NumPy alone: no code of symhyb.

python studies/fleet/generate.py SEED OUT [COUNT]   # recordings, units.csv, study.toml, truth.json

    J q″ = g τ − c q′ − F tanh(q′/w) − m g₀ l sin q,      fourth-order Runge–Kutta, all at once

Values differ from drive to drive: inertia by 2 %, dry friction by 6 %, viscous friction by 6 %, the
gain of the torque and that of the tachometer by 0.4 %. Viscous friction falls with the ambient
temperature by 1.2 % of its mean per K, dry friction grows with the hours of service by 3 % per
1000 h. Encoders have noise of 0.2 mrad, tachometers of 5 mrad/s. With play the motor and the load
are two inertias, and the encoder is that of the motor.
"""

import csv
import json
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
GRAVITY, MASS, LENGTH, WIDTH = 9.81, 2.0, 0.15, 0.05
INERTIA, VISCOUS, DRY = 0.06, 0.30, 0.40
LASTS, RATE, STEP = 4.0, 250.0, 1e-4  # s, Hz, s
PER_KELVIN, PER_HOUR = -0.012 * VISCOUS, 0.03 * DRY / 1000.0
SHAFT, LOSS, LOAD = 1500.0, 1.0, 0.3  # of play: N·m/rad, N·m·s/rad, share of the inertia behind it
KINDS = (
    "inertia",
    "inertia",
    "dry friction",
    "dry friction",
    "viscous friction",
    "torque gain",
    "tacho gain",
    "encoder delay",
    "play",
    "stiffness",
)
"""What is wrong with the odd ones."""
REASONS = {
    "inertia": "J",
    "dry friction": "F",
    "viscous friction": "c",
    "torque gain": "torque.gain",
    "tacho gain": "tacho.gain",
    "encoder delay": "encoder.delay",
    "play": "structure",
    "stiffness": "structure",
}
"""What is to be named: a number that is fitted, or that the structure does not hold."""


@dataclass(frozen=True)
class Drive:
    """One drive in SI; ``odd`` is what is wrong with it, else empty."""

    name: str
    inertia: float
    viscous: float
    dry: float
    torque_gain: float
    tacho_gain: float
    temperature: float
    hours: float
    delay: float = 0.0
    play: float = 0.0
    stiffness: float = 0.0
    odd: str = ""


def drives(seed: int, count: int = 200) -> list[Drive]:
    """The drives of a fleet; which are odd, and how much, is drawn too."""
    chance = np.random.default_rng([seed, 1])
    found = []
    for number in range(count):
        warm, hours = chance.uniform(10, 40), chance.uniform(0, 5000)
        found.append(
            Drive(
                f"drive-{number:03d}",
                INERTIA * (1 + 0.02 * chance.standard_normal()),
                VISCOUS * (1 + 0.06 * chance.standard_normal()) + PER_KELVIN * (warm - 25),
                DRY * (1 + 0.06 * chance.standard_normal()) + PER_HOUR * (hours - 2500),
                1 + 0.004 * chance.standard_normal(),
                1 + 0.004 * chance.standard_normal(),
                round(warm, 1),
                round(hours),
            )
        )
    kinds = KINDS[: max(1, count * len(KINDS) // 200)]
    places = chance.choice(count, len(kinds), replace=False)
    for place, kind in zip(places, kinds, strict=True):
        found[place] = spoiled(found[place], kind, chance)
    return found


def spoiled(drive: Drive, kind: str, chance: np.random.Generator) -> Drive:
    """A drive with something wrong."""
    sign = chance.choice([-1.0, 1.0])
    changes = {
        "inertia": {"inertia": drive.inertia * (1 + sign * chance.uniform(0.15, 0.3))},
        "dry friction": {"dry": drive.dry * 1.5},
        "viscous friction": {"viscous": drive.viscous * 1.5},
        "torque gain": {"torque_gain": drive.torque_gain * (1 + sign * 0.03)},
        "tacho gain": {"tacho_gain": drive.tacho_gain * (1 + sign * 0.03)},
        "encoder delay": {"delay": chance.uniform(0.002, 0.004)},
        "play": {"play": chance.uniform(0.01, 0.03)},
        "stiffness": {"stiffness": chance.uniform(0.5, 1.0)},
    }[kind]
    return replace(drive, odd=kind, **changes)


def torque(seed: int, count: int) -> tuple[Array, Array, Array]:
    """Amplitudes (N·m), frequencies (Hz) and phases (rad) of the sines of every drive (count, 6):
    a slow one that swings the weight far, and faster ones."""
    chance = np.random.default_rng([seed, 2])
    low = np.array([0.4, 0.9, 1.7, 3.1, 5.3, 8.0])
    frequencies = low * chance.uniform(0.9, 1.1, (count, low.size))
    sizes = np.array([2.2, 1.8, 1.6, 1.6, 1.6, 1.6]) * chance.uniform(0.9, 1.1, (count, low.size))
    return sizes, frequencies, chance.uniform(0, 2 * np.pi, (count, low.size))


def simulate(fleet: list[Drive], seed: int) -> tuple[Array, Array, Array, Array]:
    """Times (N,) and, of every drive, torque, angle and speed (N, count) without noise, SI."""
    sizes, frequencies, phases = torque(seed, len(fleet))
    value = {
        key: np.array([getattr(one, key) for one in fleet])
        for key in ("inertia", "viscous", "dry", "torque_gain", "play", "stiffness")
    }
    behind = np.where(value["play"] > 0, LOAD * value["inertia"], 0.0)
    weight = MASS * LENGTH**2
    split = value["play"] > 0

    def pushed(t: float) -> Array:
        return np.asarray(np.sum(sizes * np.sin(2 * np.pi * frequencies * t + phases), axis=1))

    def rates(t: float, x: Array) -> Array:
        """Angle, speed of the motor, and of the load behind the play."""
        q, v, p, w = x
        drive = value["torque_gain"] * pushed(t)
        loss = value["viscous"] * v + value["dry"] * np.tanh(v / WIDTH)
        turn, slip = q - p, v - w
        over = turn - np.clip(turn, -value["play"] / 2, value["play"] / 2)
        shaft = np.where(over != 0, SHAFT * over + LOSS * slip, 0.0)
        shaft = np.where(np.sign(shaft) == np.sign(over), shaft, 0.0)
        place = np.where(split, p, q)
        held = MASS * GRAVITY * LENGTH * np.sin(place) + value["stiffness"] * place
        whole = (drive - loss - held) / (value["inertia"] + weight)
        motor = (drive - loss - shaft) / (value["inertia"] - behind)
        load = (shaft - held) / (behind + weight)
        return np.array([v, np.where(split, motor, whole), w, np.where(split, load, whole)])

    count = round(LASTS * RATE) + 1
    inner = round(1 / RATE / STEP)
    x, times = np.zeros((4, len(fleet))), np.arange(count) / RATE
    states = np.empty((count, 2, len(fleet)))
    h = 1 / RATE / inner
    for i, start in enumerate(times):
        states[i] = x[:2]
        for j in range(inner):
            t = start + j * h
            k1 = rates(t, x)
            k2 = rates(t + h / 2, x + h / 2 * k1)
            k3 = rates(t + h / 2, x + h / 2 * k2)
            k4 = rates(t + h, x + h * k3)
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    torques = np.array([pushed(t) for t in times])
    return times, torques, states[:, 0], states[:, 1]


def recorded(fleet: list[Drive], seed: int) -> list[Array]:
    """What is recorded of each drive (N, 4): time, torque, encoder and tachometer."""
    chance = np.random.default_rng([seed, 3])
    t, torques, angles, speeds = simulate(fleet, seed)
    found = []
    for i, drive in enumerate(fleet):
        angle = np.interp(t - drive.delay, t, angles[:, i]) if drive.delay else angles[:, i]
        angle = angle + 2e-4 * chance.standard_normal(t.size)
        speed = drive.tacho_gain * speeds[:, i] + 5e-3 * chance.standard_normal(t.size)
        found.append(np.c_[t, torques[:, i], angle, speed])
    return found


def write_fleet(seed: int, out: Path, count: int = 200) -> None:
    """Leave a folder with recordings, a table of them, a study of fits and the truth."""
    fleet = drives(seed, count)
    (out / "runs").mkdir(parents=True, exist_ok=True)
    for drive, rows in zip(fleet, recorded(fleet, seed), strict=True):
        file = out / "runs" / f"{drive.name}.csv"
        np.savetxt(
            file, rows, fmt="%.7g", delimiter=",", header="t,torque,encoder,tacho", comments=""
        )
    with open(out / "units.csv", "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["file", "groups.drive", "groups.temperature", "groups.hours"])
        for one in fleet:
            writer.writerow([f"runs/{one.name}.csv", one.name, one.temperature, one.hours])
    model = Path(__file__).with_name("machine.toml").read_text(encoding="utf-8")
    (out / "machine.toml").write_text(model, encoding="utf-8")
    study = Path(__file__).with_name("units.toml").read_text(encoding="utf-8")
    (out / "study.toml").write_text(study, encoding="utf-8")
    odd = {one.name: [one.odd, REASONS[one.odd]] for one in fleet if one.odd}
    (out / "truth.json").write_text(json.dumps(odd, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write_fleet(int(sys.argv[1]), Path(sys.argv[2]), *map(int, sys.argv[3:]))

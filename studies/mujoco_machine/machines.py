"""Machines of MuJoCo with what a model file has no words for, and what is concealed in them.

A tendon over a pulley (one joint, two joints), a contact that bears (press) and one that opens
(hammer), and a loop that an equality closes, softly as by default (loop) or as hard as it gets
(tight). MuJoCo records them, by Runge-Kutta of order 4 with steps of 0.1 ms, at 250 Hz with noise.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

import symhyb as sh
from symhyb.imports.deliver import Order, deliver

Array = NDArray[np.float64]

STEP_S, EVERY = 1e-4, 40  # of MuJoCo; steps from row to row
SETTLES_S, SECONDS = 1.0, 8.0
LINES = 14
HARD = ((2 * STEP_S, 1.0), (0.9999, 0.9999, 0.001, 0.5, 2.0))  # solref and solimp of dry friction
HEAD = f"""<mujoco><compiler angle="radian"/><option timestep="{STEP_S}" integrator="RK4"/>
<default><geom contype="0" conaffinity="0"/></default>
"""
PULLEY = """<site name="anchor" pos="-0.15 0 0.05"/><site name="side" pos="0 0 0.06"/>
 <geom name="pulley" type="cylinder" size="0.03 0.02" euler="1.5707963 0 0"/>"""
CORD = '<site site="anchor"/><geom geom="pulley" sidesite="side"/>'
FINGER = f"""{HEAD}<worldbody>{PULLEY}
 <body name="finger"><joint name="knuckle" axis="0 1 0" damping="0.02"/>
  <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.012" mass="0.3"/>
  <site name="tip" pos="0.1 0 0.01"/></body></worldbody>
<tendon><spatial name="cord" stiffness="200" damping="1" springlength="0.24">{CORD}
 <site site="tip"/></spatial></tendon>
<actuator><motor name="pull" tendon="cord" gear="-1"/></actuator></mujoco>"""
FINGERS = f"""{HEAD}<worldbody>{PULLEY}
 <body name="upper"><joint name="knuckle" axis="0 1 0" damping="0.02"/>
  <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.012" mass="0.3"/>
  <site name="a" pos="0.1 0 0.02"/>
  <body name="lower" pos="0.2 0 0"><joint name="middle" axis="0 1 0" damping="0.01"
   stiffness="0.3" springref="0.3"/>
   <geom type="capsule" fromto="0 0 0 0.15 0 0" size="0.01" mass="0.15"/>
   <site name="b" pos="0.08 0 0.015"/></body></body></worldbody>
<tendon><spatial name="cord" stiffness="200" damping="1" springlength="0.4">{CORD}
 <site site="a"/><site site="b"/></spatial></tendon>
<actuator><motor name="pull" tendon="cord" gear="-1"/><motor name="push" joint="middle"/></actuator>
</mujoco>"""
PRESS = f"""<mujoco><option timestep="{STEP_S}" integrator="RK4"/>
<default><geom solref="-3000 -20" solimp="0.9 0.9 0.01"/></default>
<worldbody><geom name="pad" type="plane" size="1 1 0.1"/>
 <body name="ram" pos="0 0 0.05"><joint name="guide" type="slide" axis="0 0 1" damping="2"/>
  <geom name="head" type="sphere" size="0.05" mass="1"/></body></worldbody>
<actuator><motor name="drive" joint="guide"/></actuator></mujoco>"""
LOOP = f"""{HEAD}<worldbody>
 <body name="crank"><joint name="crank" axis="0 1 0" damping="0.02"/>
  <geom type="capsule" fromto="0 0 0 0 0 0.1" size="0.01" mass="0.2"/>
  <body name="coupler" pos="0 0 0.1"><joint name="coupler" axis="0 1 0" damping="0.005"/>
   <geom type="capsule" fromto="0 0 0 0.3 0 0.1" size="0.01" mass="0.3"/></body></body>
 <body name="rocker" pos="0.3 0 0"><joint name="rocker" axis="0 1 0" damping="0.02" stiffness="2"/>
  <geom type="capsule" fromto="0 0 0 0 0 0.2" size="0.01" mass="0.3"/></body></worldbody>
<equality><connect body1="coupler" body2="rocker" anchor="0.3 0 0.1"/></equality>
<actuator><motor name="drive" joint="crank"/></actuator></mujoco>"""
TIGHT = f'solref="{2 * STEP_S} 1" solimp="0.9999 0.9999 0.001"'


@dataclass(frozen=True, slots=True)
class Machine:
    """The owner's file (``xml``) with its ``joints`` in their order, in ``unit``; by actuator the
    amplitude of its 14 lines and its mean; the highest line in Hz; the ``noise`` of the sensors,
    one standard deviation; in which joint what is concealed, with its size, SI."""

    xml: str
    joints: tuple[str, ...]
    unit: str
    drives: Mapping[str, tuple[float, float]]
    highest: float
    noise: float
    joint: str
    friction: float
    damping: float


FINGERS_DRIVES = {"pull": (0.7, 2.0), "push": (0.03, 0.0)}
MACHINES = {
    "finger": Machine(
        FINGER, ("knuckle",), "rad", {"pull": (0.7, 2.0)}, 5.0, 1e-4, "knuckle", 0.02, 0.02
    ),
    "fingers": Machine(
        FINGERS, ("knuckle", "middle"), "rad", FINGERS_DRIVES, 5.0, 1e-4, "middle", 0.02, 0.02
    ),
    "press": Machine(
        PRESS, ("guide",), "m", {"drive": (1.0, -5.0)}, 12.0, 2e-6, "guide", 0.5, 30.0
    ),
    "hammer": Machine(
        PRESS, ("guide",), "m", {"drive": (3.0, -5.0)}, 12.0, 1e-5, "guide", 0.5, 30.0
    ),
    "loop": Machine(
        LOOP,
        ("crank", "coupler", "rocker"),
        "rad",
        {"drive": (0.1, 0.0)},
        5.0,
        1e-4,
        "rocker",
        0.05,
        0.03,
    ),
}
MACHINES["tight"] = replace(MACHINES["loop"], xml=LOOP.replace("<connect", f"<connect {TIGHT}"))


def real(machine: Machine, concealed: str) -> Any:
    """MuJoCo's model of the real machine, with ``friction``, ``damping`` or ``nothing`` in it."""
    spec = mujoco.MjSpec.from_string(machine.xml)
    joint = spec.joint(machine.joint)
    if concealed == "friction":
        joint.frictionloss = machine.friction
        joint.solref_friction[:], joint.solimp_friction[:] = HARD
    if concealed == "damping":
        joint.damping[0] += machine.damping
    return spec.compile()


def record(machine: Machine, concealed: str, seed: int) -> dict[str, Array]:
    """The run of the real machine by columns, each (N,), SI: forces, and joints with noise."""
    model = real(machine, concealed)
    data, chance = mujoco.MjData(model), np.random.default_rng(seed)
    lines = 2 * np.pi * np.linspace(0.3, machine.highest, LINES)
    phases = chance.uniform(0, 2 * np.pi, (len(machine.drives), LINES))
    size, mean = np.array(list(machine.drives.values())).T

    def forces(t: float) -> Array:
        return np.asarray(mean + size * np.sin(lines * t + phases).sum(axis=1))

    first, last = (round(end / STEP_S) for end in (SETTLES_S, SETTLES_S + SECONDS))
    rows = []
    for step in range(last):
        if step >= first and step % EVERY == 0:
            rows.append([data.time - SETTLES_S, *forces(data.time), *data.qpos])
        data.ctrl[:] = forces(data.time + STEP_S / 2)  # held over a step: its middle counts
        mujoco.mj_step(model, data)
    names = ("t", *machine.drives, *machine.joints)
    columns = dict(zip(names, np.array(rows).T, strict=True))
    for joint in machine.joints:
        columns[joint] = columns[joint] + machine.noise * chance.standard_normal(len(rows))
    return columns


def short_model(machine: Machine, folder: Path) -> sh.Model:
    """The owner's file as the machine."""
    (folder / "machine.xml").write_text(machine.xml)
    unit, force = machine.unit, {"rad": "N*m", "m": "N"}[machine.unit]
    tables = {
        "mujoco": ['file = "machine.xml"'],
        "mujoco.coordinates": [f'q_{name} = "{name}"' for name in machine.joints],
        "mujoco.inputs": [f'{name} = "{name}"' for name in machine.drives],
        "coordinates": [f'q_{name} = {{ unit = "{unit}" }}' for name in machine.joints],
        "inputs": [f'{name} = {{ unit = "{force}" }}' for name in machine.drives],
        "sensors": [
            f'{name} = {{ measures = "q_{name}", unit = "{unit}" }}' for name in machine.joints
        ],
    }
    parts = ("\n".join((f"[{key}]", *lines)) for key, lines in tables.items())
    (folder / "machine.toml").write_text("\n\n".join(("symhyb = 1", *parts)) + "\n")
    return sh.read_model(folder / "machine.toml")


def imported_model(machine: Machine, folder: Path) -> sh.Model:
    """The owner's file as a model file, whose inputs are called as the motors."""
    source, target = folder / "machine.xml", folder / "imported.toml"
    source.write_text(machine.xml)
    deliver(source, Order(force=True), target)
    return sh.read_model(target)

"""Machines of MuJoCo that no model file has by import, recorded by MuJoCo itself."""

from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np

from symhyb.data.recording import Recording
from symhyb.model.read import read_model
from symhyb.model.types import Model

HARD = 'solreffriction="0.0002 1" solimpfriction="0.9999 0.9999 0.001"'  # dry, within 1e-8 m/s
STEP = 1e-4  # s

# A finger that hangs on a cord, which runs over a pulley: its lever arm changes with the angle.
FINGER = f"""<mujoco model="finger">
<compiler angle="radian"/><option timestep="{STEP}" integrator="RK4"/>
<worldbody>
 <site name="anchor" pos="-0.15 0 0.05"/><site name="side" pos="0 0 0.06"/>
 <geom name="pulley" type="cylinder" size="0.03 0.02" euler="1.5707963 0 0" contype="0"
  conaffinity="0"/>
 <body name="finger"><joint name="knuckle" axis="0 1 0" damping="0.02"/>
  <geom name="bone" type="capsule" fromto="0 0 0 0.2 0 0" size="0.012" mass="0.3" contype="0"
   conaffinity="0"/>
  <site name="tip" pos="0.1 0 0.01"/></body>
</worldbody>
<tendon><spatial name="cord" stiffness="200" damping="1" springlength="0.24">
 <site site="anchor"/><geom geom="pulley" sidesite="side"/><site site="tip"/></spatial></tendon>
<actuator><motor name="pull" tendon="cord" gear="-1"/></actuator>
</mujoco>
"""

# A ram that presses on a soft pad: a contact, which bears its weight and more.
PRESS = f"""<mujoco model="press">
<option timestep="{STEP}" integrator="RK4"/>
<default><geom solref="-3000 -20" solimp="0.9 0.9 0.01"/></default>
<worldbody>
 <geom name="pad" type="plane" size="1 1 0.1"/>
 <body name="ram" pos="0 0 0.05"><joint name="guide" type="slide" axis="0 0 1" damping="2"/>
  <geom name="head" type="sphere" size="0.05" mass="1"/></body>
</worldbody>
<actuator><motor name="drive" joint="guide"/></actuator>
</mujoco>
"""

SHORT = """symhyb = 1
[mujoco]
file = "machine.xml"
[mujoco.coordinates]
x = "{joint}"
[mujoco.inputs]
f = "{actuator}"
[coordinates]
x = {{ unit = "{unit}" }}
[inputs]
f = {{ unit = "N" }}
[sensors]
laser = {{ measures = "x", unit = "{unit}" }}
"""


def written(folder: Path, xml: str, text: str) -> Model:
    """The model of a short file beside a file of MuJoCo."""
    (folder / "machine.xml").write_text(xml)
    (folder / "machine.toml").write_text(text)
    return read_model(folder / "machine.toml")


def finger(folder: Path) -> Model:
    """The finger as the machine."""
    return written(folder, FINGER, SHORT.format(joint="knuckle", actuator="pull", unit="rad"))


def press(folder: Path) -> Model:
    """The press as the machine."""
    return written(folder, PRESS, SHORT.format(joint="guide", actuator="drive", unit="m"))


def rubbing(xml: str, joint: str, friction: float) -> str:
    """The machine with dry friction in a joint, N or N·m."""
    assert xml.count(f'name="{joint}"') == 1
    return xml.replace(f'name="{joint}"', f'name="{joint}" frictionloss="{friction}" {HARD}')


def drive(seed: int, size: float, mean: float, highest: float) -> Callable[[float], float]:
    """A force of 14 lines from 0.3 Hz to the ``highest``."""
    lines = np.linspace(0.3, highest, 14)
    phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, 14)

    def force(t: float) -> float:
        return float(mean + size / 3 * np.sin(2 * np.pi * lines * t + phases).sum())

    return force


def recorded(
    xml: str, force: Callable[[float], float], noise: float, end: float = 8.0, seed: int = 0
) -> Recording:
    """What MuJoCo's machine of one coordinate does under a force, at 250 Hz with noise, after a
    second in which it settles."""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    begin, every = 250, round(0.004 / STEP)
    t = np.arange(round(end * 250)) * 0.004
    q = np.empty(t.size)
    for i in range(-begin, t.size):
        if i >= 0:
            q[i] = data.qpos[0]
        for k in range(every):  # held over a step, so that its middle counts
            data.ctrl[0] = force(0.004 * i + (k + 0.5) * STEP)
            mujoco.mj_step(model, data)
    laser = q + noise * np.random.default_rng(seed).normal(size=t.size)
    u = np.array([force(one) for one in t])
    return Recording(f"run{seed}.csv", t, {"f": u}, {"laser": laser}, (), "")

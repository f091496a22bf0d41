"""An arm with three joints that MuJoCo simulates, with one thing in it that its owner's file lacks.

python studies/mujoco_arm/recordings.py OUT    # model.toml, train.csv, unseen.csv of each case

The owner's file is arm.xml (geared.xml, where there is a gear). The real arm is the same file with
one change (`CASES`); its torques come from a sampled PD controller, act 3 ms after they were
commanded, and are logged as commanded.
"""

import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

import symhyb as sh
from symhyb.imports.deliver import Order, deliver

Array = NDArray[np.float64]

HERE = Path(__file__).parent
STEP_S = 2e-4  # of MuJoCo
CYCLE_S = 4e-3  # of controller and logger
DELAY_S = 3e-3  # from a command to its torque
COUNT = 2 * np.pi / 2**16  # of the encoders, rad
NOISE = 5e-5  # of the angles before they are counted, one standard deviation, rad
SECONDS = {"train": 8.0, "unseen": 6.0}
SEEDS = {"train": 1, "unseen": 2}
RATE_S = 8e-3  # time constant of the filter of the controller's rates
FADE_S = 1.0
PLAY = 0.005  # to either side, rad
POINT = 1e-4  # radius of a ball that is next to a point, m


@dataclass(frozen=True, slots=True)
class Arm:
    """The owner's file (``robot``), those of its ``joints`` that move, in the order of the file,
    each with an encoder, and of the joints that are driven (D): their indices, and a path and a
    controller, whose torques are no larger than ``most``, N·m."""

    robot: Path
    joints: tuple[str, ...]
    driven: tuple[int, ...]
    middle: Array  # of the path, (D,), rad
    frequencies: Array  # of its sines, (D, 3), Hz
    stiffness: Array  # of the controller, (D,), N·m/rad
    damping: Array  # (D,), N·m·s/rad
    amplitudes: Array  # of the sines, (3,), rad
    most: float = np.inf


ARM = Arm(
    HERE / "arm.xml",
    ("base", "shoulder", "elbow"),
    (0, 1, 2),
    np.array([0.0, -0.3, 0.6]),
    np.array([[0.31, 0.83, 1.61], [0.37, 0.71, 1.49], [0.43, 0.97, 1.87]]),
    np.array([100.0, 250.0, 40.0]),
    np.array([6.0, 12.0, 1.0]),
    np.array([0.45, 0.25, 0.15]),
)
GEARED = Arm(
    HERE / "geared.xml",
    ("shoulder", "elbow", "gear"),
    (0, 1),
    ARM.middle[1:],
    ARM.frequencies[1:],
    ARM.stiffness[1:],
    ARM.damping[1:],
    ARM.amplitudes,
)


@dataclass(frozen=True, slots=True)
class Case:
    """What is ``concealed``; ``change`` puts it into the real arm, and ``adds`` adds what the owner
    knows to the text of the model file."""

    concealed: str
    change: Callable[[Any], None] | None = None
    adds: Callable[[str], str] = str
    arm: Arm = ARM


def _rubs(spec: Any) -> None:
    """Dry friction as MuJoCo has it: a soft one, which creeps at 20 mrad/s under 98 % of its level,
    and slides from 0.2 rad/s on."""
    spec.joint("elbow").frictionloss = 0.5


def rub_hard(spec: Any, name: str, level: float) -> None:
    """Give a joint dry friction of a ``level``, N·m, as hard as the step allows: 0.5 N·m creep at
    4 µrad/s under 98 % of their level."""
    joint = spec.joint(name)
    joint.frictionloss = level
    joint.solref_friction[:] = 2 * STEP_S, 1.0
    joint.solimp_friction[:] = 0.999, 0.9999, 0.001, 0.5, 2.0


def _rubs_hard(spec: Any) -> None:
    rub_hard(spec, "elbow", 0.5)


def _damps(spec: Any) -> None:
    spec.joint("shoulder").damping[0] += 1.5


def _turns(spec: Any) -> None:
    spec.joint("elbow").armature += 0.03


def load(spec: Any, name: str, mass: float, radius: float, along: float = 0.0) -> None:
    """Fix a ball of a ``mass``, kg, and a ``radius``, m, to a body, so far ``along`` its x, m."""
    spec.body(name).add_geom(
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        pos=[along, 0, 0],
        size=[radius, 0, 0],
        mass=mass,
        contype=0,
        conaffinity=0,
    )


def _weighs(spec: Any) -> None:
    load(spec, "hand", 0.4, 0.03)


def _weighs_at_a_point(spec: Any) -> None:
    """A ball of 0.1 mm, whose own inertia is 2·10⁻⁹ kg·m²."""
    load(spec, "hand", 0.4, POINT)


def _pulls(spec: Any) -> None:
    spec.joint("shoulder").stiffness[0] = 12.0


def _may_hold(text: str) -> str:
    """A mass at the hand that is not known: 1 g, for a model has no body without mass."""
    numbers = """
payload = { value = 0.001, unit = "kg", sd = 0.3, about = "what the hand may hold" }
"""
    body = """
[bodies.payload]
parent = "fore"
joint  = "hand"
mass   = "payload"
at     = ["0", "0", "0"]
"""
    return text.replace("[parameters]\n", "[parameters]" + numbers, 1) + body


def loosen(spec: Any, name: str) -> None:
    """Give the spring of a joint a dead zone, as springs of MuJoCo's tendons have one."""
    joint = spec.joint(name)
    tendon = spec.add_tendon(stiffness=joint.stiffness, springlength=[-PLAY, PLAY])
    tendon.wrap_joint(name, 1.0)
    joint.stiffness = np.zeros(3)


def _plays(spec: Any) -> None:
    loosen(spec, "gear")


def _act_late(text: str) -> str:
    """The delay of the drives, which is known."""
    return text.replace('between = "held",', f'between = "held", delay = {DELAY_S},')


def _may_give(text: str) -> str:
    """The same, and a stiffness of the gear that is known to 20 %."""
    return re.sub(r"(?m)^(gear_spring += \{ value = 400.0,)", r"\1 sd = 80.0,", _act_late(text))


CASES: Mapping[str, Case] = {
    "nothing": Case("nothing"),
    "friction": Case("dry friction of 0.5 N·m in the elbow", _rubs_hard),
    "soft_friction": Case("the same, as soft as MuJoCo has it by default", _rubs),
    "damping": Case("1.5 N·m·s/rad more of viscous damping in the shoulder", _damps),
    "rotor": Case("a rotor of 0.03 kg·m² in the elbow", _turns),
    "payload": Case("a ball of 0.4 kg in the hand", _weighs),
    "payload_point": Case("the same mass at a point", _weighs_at_a_point),
    "payload_stated": Case("the ball; the model has a mass there, with an sd", _weighs, _may_hold),
    "spring": Case("a spring of 12 N·m/rad at the shoulder", _pulls),
    "play": Case("a play of 5 mrad to either side in the gear", _plays, arm=GEARED),
    "play_delay": Case("the same; the model has the delay", _plays, _act_late, GEARED),
    "play_stated": Case("the same; its stiffness has an sd", _plays, _may_give, GEARED),
}


def real_arm(arm: Arm, change: Callable[[Any], None] | None) -> Any:
    """MuJoCo's model of the real arm; without a ``change``, of the owner's file. Joints that do not
    move are locked where they are, and their motors are gone."""
    spec = mujoco.MjSpec.from_file(str(arm.robot))
    for motor in [one for one in spec.actuators if one.target not in arm.joints]:
        spec.delete(motor)
    for joint in [one for one in spec.joints if one.name not in arm.joints]:
        spec.delete(joint)
    spec.option.timestep = STEP_S
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.tolerance = 1e-12
    if change:
        change(spec)
    return spec.compile()


def path(arm: Arm, t: float, phases: Array) -> tuple[Array, Array]:
    """Where the driven joints shall be at t, (D,) in rad, and how fast, (D,) in rad/s, along sines
    with ``phases`` (D, 3), rad; fades in from the middle."""
    turn = 2 * np.pi * arm.frequencies
    swing = np.sin(turn * t + phases) @ arm.amplitudes
    rate = (turn * np.cos(turn * t + phases)) @ arm.amplitudes
    share = min(t / FADE_S, 1.0)
    fade, faster = share**2 * (3 - 2 * share), 6 * share * (1 - share) / FADE_S
    return arm.middle + fade * swing, fade * rate + faster * swing


def record(case: Case, part: str) -> dict[str, Array]:
    """The run of the real arm by the columns of its logger, each (N,), SI: angles as counted, and
    torques as commanded in the same cycle."""
    arm, model = case.arm, real_arm(case.arm, case.change)
    data, driven = mujoco.MjData(model), list(case.arm.driven)
    chance = np.random.default_rng(SEEDS[part])
    phases = chance.uniform(0, 2 * np.pi, arm.frequencies.shape)
    data.qpos[driven] = arm.middle
    late, each = round(DELAY_S / STEP_S), round(CYCLE_S / STEP_S)
    count = round(SECONDS[part] / CYCLE_S)
    angles, torques = np.zeros((count, len(arm.joints))), np.zeros((count, len(driven)))
    rate = np.zeros(len(driven))
    for row in range(count):
        noisy = data.qpos + chance.normal(0, NOISE, len(arm.joints))
        angles[row] = COUNT * np.round(noisy / COUNT)
        if row:
            moved = (angles[row] - angles[row - 1])[driven] / CYCLE_S
            rate += CYCLE_S / (CYCLE_S + RATE_S) * (moved - rate)
        goal, speed = path(arm, row * CYCLE_S, phases)
        asked = arm.stiffness * (goal - angles[row, driven]) + arm.damping * (speed - rate)
        torques[row] = np.clip(asked, -arm.most, arm.most)
        for step in range(each):
            if step == late:
                data.ctrl[:] = torques[row]
            mujoco.mj_step(model, data)
    columns = {"t": np.linspace(0, CYCLE_S * (count - 1), count)}
    columns |= {joint: angles[:, i] for i, joint in enumerate(arm.joints)}
    columns |= {f"{arm.joints[i]}_torque": torques[:, k] for k, i in enumerate(driven)}
    return columns


def owners_model(case: Case, target: Path) -> sh.Model:
    """What `symhyb import` makes of the owner's file, written to ``target``, with what the owner
    adds to it: that the controller holds a torque until the next one, and what the case adds."""
    deliver(case.arm.robot, Order(joints=case.arm.joints, force=True), target)
    text = target.read_text(encoding="utf-8")
    stated = r'(?m)^(\w+_torque += \{ unit = "N\*m",)(?= about)'  # among the inputs, not the limits
    held = re.sub(stated, r'\1 between = "held",', text)
    target.write_text(case.adds(held), encoding="utf-8")
    return sh.read_model(target)


def main() -> None:
    """Write the model and both recordings of every case, each in a folder of its own."""
    for name, case in CASES.items():
        folder = Path(sys.argv[1]) / name
        folder.mkdir(parents=True, exist_ok=True)
        owners_model(case, folder / "model.toml")
        for part in SECONDS:
            run = record(case, part)
            table = np.column_stack(list(run.values()))
            head = ",".join(run)
            np.savetxt(folder / f"{part}.csv", table, "%.9g", ",", header=head, comments="")


if __name__ == "__main__":
    main()

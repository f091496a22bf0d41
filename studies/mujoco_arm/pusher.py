"""The arm of Gymnasium's Pusher, from its package, with friction, play and a load that its file
lacks, recorded by MuJoCo and diagnosed as in diagnose.py.

python studies/mujoco_arm/pusher.py OUT [CASE…] [--runs N]    # N pairs of recordings a case

Four of its joints move; those that roll are locked. Needs `pip install gymnasium`, of which one
file is read.
"""

import argparse
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import mujoco  # type: ignore[import-untyped]
import numpy as np
from diagnose import tell
from recordings import POINT, SEEDS, Arm, Case, load, loosen, rub_hard

JOINTS = ("r_shoulder_pan_joint", "r_shoulder_lift_joint", "r_elbow_flex_joint")
WRIST = "r_wrist_flex_joint"
GEAR = "r_elbow_gear"
STIFFNESS = 150.0  # of the gear, N·m/rad


def owners_file() -> Path:
    """Where the package has its robot."""
    found = find_spec("gymnasium")
    if found is None or found.origin is None:
        raise SystemExit("Gymnasium is not installed: pip install gymnasium")
    return Path(found.origin).parent / "envs" / "mujoco" / "assets" / "pusher_v5.xml"


def geared(target: Path) -> Path:
    """The owner's file with an elastic gear behind the rotor of the elbow, left at ``target``."""
    spec = mujoco.MjSpec.from_file(str(owners_file()))
    elbow = spec.joint(JOINTS[2])
    gear = spec.body("r_elbow_flex_link").add_joint(name=GEAR, type=elbow.type, axis=elbow.axis)
    gear.stiffness[0], gear.damping[0], gear.armature, gear.limited = STIFFNESS, 0.3, 0.0, 0
    target.write_text(spec.to_xml(), encoding="utf-8")
    return target


def arm_of(robot: Path, joints: tuple[str, ...], driven: tuple[int, ...]) -> Arm:
    """Along paths within the travel of the joints, with torques that the motors have."""
    return Arm(
        robot,
        joints,
        driven,
        np.array([0.0, 0.35, -1.1, -0.55]),
        np.array([[0.11, 0.29, 0.61], [0.13, 0.31, 0.67], [0.17, 0.37, 0.79], [0.19, 0.43, 0.83]]),
        np.array([40.0, 40.0, 15.0, 10.0]),
        np.array([4.0, 4.0, 1.0, 0.5]),
        np.array([0.22, 0.13, 0.08]),
        2.0,
    )


def rubs(spec: Any) -> None:
    """Dry friction in the elbow."""
    rub_hard(spec, JOINTS[2], 0.15)


def carries(spec: Any) -> None:
    """A mass at the tips, 0.1 m beyond the wrist."""
    load(spec, "r_wrist_flex_link", 0.15, POINT, along=0.1)


def plays(spec: Any) -> None:
    """Play in the gear."""
    loosen(spec, GEAR)


def all_three(spec: Any) -> None:
    """All of it."""
    for change in (rubs, carries, plays):
        change(spec)


def has_tips(text: str) -> str:
    """The point between the tips, at which the owner says that something may be carried."""
    where = '[points]\ntips = { body = "r_wrist_flex_link", at = ["0.1 m", "0", "0"] }\n'
    return f"{text}\n{where}"


def cases(out: Path) -> dict[str, Case]:
    """What is concealed, by name; files of robots that are written go to ``out``."""
    arm = arm_of(owners_file(), (*JOINTS, WRIST), (0, 1, 2, 3))
    gear = arm_of(geared(out / "geared.xml"), (*JOINTS, GEAR, WRIST), (0, 1, 2, 4))
    return {
        "nothing": Case("nothing", None, has_tips, arm),
        "friction": Case("0.15 N·m of dry friction in the elbow", rubs, has_tips, arm),
        "load": Case("0.15 kg at the tips", carries, has_tips, arm),
        "play": Case("5 mrad of play to either side in the gear", plays, has_tips, gear),
        "all": Case("all three", all_three, has_tips, gear),
    }


def main() -> None:
    """Diagnose the cases, each on several pairs of recordings."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--runs", type=int, default=1)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    known = cases(options.out)
    for name in options.cases or known:
        for run in range(options.runs):
            SEEDS.update(train=2 * run + 1, unseen=2 * run + 2)
            folder = options.out / name / str(run)
            tell(f"{name} {run}", known[name], folder)


if __name__ == "__main__":
    main()

"""The same diagnoses with MuJoCo as the machine, and with the model file that was imported.

python studies/mujoco_arm/as_machine.py OUT [CASE…]    # names, numbers and seconds of both

The short model file names joints and actuators of the owner's file, and nothing else. Seconds are
those of a processor, with all processes that a diagnosis starts.
"""

import shutil
import sys
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage

from diagnose import errors, numbers
from recordings import CASES, Case, owners_model, record

import symhyb as sh

USUAL = ("nothing", "friction", "damping", "rotor", "spring")


def short_model(case: Case, folder: Path) -> sh.Model:
    """The owner's file of MuJoCo as the machine, with torques that are held from cycle to cycle."""
    arm = case.arm
    shutil.copy(arm.robot, folder / "machine.xml")
    driven = [arm.joints[i] for i in arm.driven]
    tables = {
        "mujoco": ['file = "machine.xml"'],
        "mujoco.inputs": [f'{name}_torque = {{ joint = "{name}" }}' for name in driven],
        "coordinates": [f'{name} = {{ unit = "rad" }}' for name in arm.joints],
        "inputs": [f'{name}_torque = {{ unit = "N*m", between = "held" }}' for name in driven],
        "sensors": [f'{name} = {{ measures = "{name}", unit = "rad" }}' for name in arm.joints],
    }
    parts = ("\n".join((f"[{key}]", *lines)) for key, lines in tables.items())
    (folder / "short.toml").write_text("\n\n".join(("symhyb = 1", *parts)) + "\n")
    return sh.read_model(folder / "short.toml")


def seconds() -> float:
    """Of a processor, so far."""
    used = [getrusage(who) for who in (RUSAGE_SELF, RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def main() -> None:
    """Diagnose the cases with both models of the owner's file."""
    out, names = Path(sys.argv[1]), sys.argv[2:] or list(USUAL)
    for name in names:
        case, folder = CASES[name], out / name
        folder.mkdir(parents=True, exist_ok=True)
        runs = {part: record(case, part) for part in ("train", "unseen")}
        models = {
            "imported": owners_model(case, folder / "model.toml"),
            "MuJoCo": short_model(case, folder),
        }
        for way, model in models.items():
            train, unseen = (
                sh.Recording.from_frame(run, model, name=part) for part, run in runs.items()
            )
            begin = seconds()
            found = sh.diagnose(model, train, unseen)
            corrected = sh.apply(model, found.found, found.parameters, found.measurement)
            verdict = sh.judge(model, corrected, on=unseen)
            print(f"{name}, {way}, {seconds() - begin:.0f} s: {found.sentence}")
            for line in (*numbers(found), *errors(verdict)):
                print(f"  {line}", flush=True)


if __name__ == "__main__":
    main()

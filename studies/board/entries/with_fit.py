"""Parameter fitting alone, with the list of MuJoCo's system identification: no cause is sought.

with_fit.py CASE ANSWER

Free are every number of the model that states an sd, the gain, offset and delay of every channel,
and on every coordinate a damping, a dry friction and an added inertia (armature). All are fitted at
once by simulation error over windows. Many of them stand for each other, so that the one whose
Wald statistic is least, but for those of the model, is set back and all others are fitted anew,
until each is more than 3 sd from where it began; these are claimed.
"""

from collections.abc import Callable, Sequence
from typing import Any

from common import element, folders, write

CLEAR = 3.0  # sd
ADDED = {"damper": "damping", "friction": "coulomb", "added_mass": "mass"}
UNITS = {  # by the unit of a coordinate: of damping, friction, inertia
    "m": ("N*s/m", "N", "kg"),
    "rad": ("N*m*s/rad", "N*m", "kg*m^2"),
}
FAULTS = ("gain", "offset", "delay")
Numbers = dict[str, float]  # where each number begins


def added(coordinate: str, unit: str) -> str:
    """The text of the elements of a joint, each of size 0."""
    lines = []
    for (kind, key), of in zip(ADDED.items(), UNITS.get(unit, ()), strict=False):
        name = f"joint_{kind}_{coordinate}"
        lines += ["", f"[elements.{name}]", f'kind = "{kind}"', f'on = "{coordinate}"']
        lines += [f'{key} = "b_"', f"[elements.{name}.parameters]"]
        lines += [f'b_ = {{ value = 0.0, unit = "{of}" }}']
    return "\n".join([*lines, ""])


def eliminated(fit: Callable[[Sequence[str]], Any], own: Sequence[str], neutral: Numbers) -> Any:
    """The last of the fits: of ``own`` numbers and those of all others that stay."""
    free = list(neutral)
    while True:
        fitted = fit(free)
        off = {
            one.name: abs(one.value - neutral[one.name]) / max(one.sd, 1e-300)
            for one in fitted.parameters
            if one.name not in own
        }
        least = min(off, key=lambda name: off[name], default=None)
        if least is None or off[least] > CLEAR or len(free) == 1:
            return fitted
        free.remove(least)


def claims(numbers: Any, neutral: Numbers) -> dict[str, list[dict[str, Any]]]:
    """What has moved, as found elements, parameters and faults of channels."""
    said: dict[str, list[dict[str, Any]]] = {"found": [], "parameters": [], "measurement": []}
    for one in numbers:
        if not abs(one.value - neutral[one.name]) > CLEAR * one.sd:
            continue
        owner, _, key = one.name.rpartition(".")
        value = {"value": one.value, "sd": one.sd}
        if owner.startswith("joint_"):
            kind = next(kind for kind in ADDED if owner.startswith(f"joint_{kind}_"))
            place = {"on": owner.removeprefix(f"joint_{kind}_")}
            said["found"].append(element(kind, place, {ADDED[kind]: (one.value, one.sd)}))
        elif owner and key in FAULTS:
            said["measurement"].append({"channel": owner, "kind": key, **value})
        else:
            said["parameters"].append({"name": one.name, **value})
    return said


def main() -> None:
    """Fit."""
    case, answer = folders()
    import symhyb as sh
    from symhyb.correction.calibration import calibrated

    text = (case / "model.toml").read_text(encoding="utf-8")
    model = sh.parse_model(text)
    moving = [one for one in model.coordinates if not one.imposed]
    joints = [added(one.name, one.unit.text) for one in moving]
    whole = sh.parse_model(text.rstrip("\n") + "\n" + "".join(joints))
    uncertain = {one.path: one.value for one in model.all_parameters() if one.sd is not None}
    neutral = {
        **uncertain,
        **{
            f"{c.name}.{k}": float(k == "gain")
            for c in (*model.inputs, *model.sensors)
            for k in FAULTS
        },
        **{f"{e.name}.b_": 0.0 for e in whole.elements[len(model.elements) :]},
    }
    train = sh.read_recording(case / "train.csv", whole)
    fitted = eliminated(lambda free: calibrated(whole, train, free), list(uncertain), neutral)
    said = claims(fitted.parameters, neutral)
    verdicts = {
        "found": "missing physics",
        "measurement": "measurement",
        "parameters": "parameters",
    }
    verdict = next((word for key, word in verdicts.items() if said[key]), "nothing missing")
    write(answer, verdict=verdict, sentence=fitted.sentence(), **said)
    sh.write_model(fitted.model, answer / "corrected.toml")


if __name__ == "__main__":
    main()

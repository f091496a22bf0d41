"""A pole swung up with a plan of the model as it is, and with one of the corrected model.

    python studies/swing_up/swing.py learn      # diagnoses train.csv: corrected.toml
    python studies/swing_up/swing.py            # plans, plays: plans.csv, results.json, swing.png
    python studies/swing_up/swing.py seeds 8    # learns and plays with other noise: results.json

engine.py plays the real machine and knows nothing of symhyb.
"""

import json
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

import generate
import numpy as np
from engine import COULOMB, DAMPING, Machine
from feedback import END, HELD, STEP, follow, gains, hold, off
from numpy.typing import NDArray
from plan import Plan, make

import symhyb as sh
from symhyb.model.read import parse_model

HERE = Path(__file__).resolve().parent
Array = NDArray[np.float64]
UPRIGHT_WITHIN = np.radians(5.0)  # in the last second

# What is concealed, written down as somebody would who knew it: what a plan can reach at best.
CONCEALED = f"""
[elements.rail]
kind       = "friction"
on         = "x"
coulomb    = "F_c"
transition = "v_t"
[elements.rail.parameters]
F_c = {{ value = {COULOMB}, unit = "N" }}
v_t = {{ value = 3e-4, unit = "m/s" }}

[elements.bearing]
kind    = "damper"
on      = "phi"
damping = "d"
[elements.bearing.parameters]
d = {{ value = {DAMPING}, unit = "N*m*s/rad" }}
"""


@dataclass(frozen=True, slots=True)
class Played:
    """What the real machine does under a plan: at its end off upright in rad and off the middle in
    m, its largest distance from the middle on the way in m, from the plan in rad, and whether
    feedback holds it upright after the end."""

    angle: float
    place: float
    travel: float
    deviation: float
    held: bool


def learn(folder: Path) -> sh.Diagnosis:
    """Diagnose the recordings of a folder, with the model as given."""
    model = sh.read_model(HERE / "machine.toml")
    train, proof = (sh.read_recording(folder / f"{n}.csv", model) for n in ("train", "holdout"))
    return sh.diagnose(model, train, proof)


def correct(diagnosis: sh.Diagnosis) -> sh.Model:
    """The model with all that was found."""
    model = sh.read_model(HERE / "machine.toml")
    return sh.apply(
        model, diagnosis.found, diagnosis.parameters, diagnosis.measurement, diagnosis.courses
    )


def planned(model: sh.Model) -> Plan:
    """The plan of a model; its dry frictions turn softly at first."""
    dry = [f"{element.name}.v_t" for element in model.elements if element.kind == "friction"]
    return make(sh.build(model), dry)


def play(plan: Plan) -> tuple[dict[str, Played], Array]:
    """Play a plan on the real machine, its force alone and with feedback along it, and hold the
    pole after it; the states of the first."""
    real, held = Machine(), gains(sh.build(sh.read_model(HERE / "machine.toml")), plan)
    alone, led = follow(real, plan), follow(real, plan, held.along)
    after, after_led = hold(real, alone[-1], held.upright), hold(real, led[-1], held.upright)
    played = {
        "force alone": _reported(plan, alone, after),
        "feedback": _reported(plan, led, after_led),
    }
    return played, np.concatenate([alone, after[1:]])


def _reported(plan: Plan, states: Array, after: Array) -> Played:
    x, phi, _, _ = off(states[-1])
    travel = float(np.abs(states[:, 0]).max())
    deviation = float(np.abs(states[:, 1] - plan.states[:, 1]).max())
    last = np.array([off(state) for state in after[-round(1 / STEP) :]])
    to_the_end = travel < END and len(after) == round(HELD / STEP) + 1
    held = to_the_end and np.abs(last[:, 1]).max() < UPRIGHT_WITHIN
    return Played(float(phi), float(x), travel, deviation, bool(held))


def main(arguments: list[str]) -> None:
    """Learn, or plan and play, or both with other noise."""
    if arguments[:1] == ["learn"]:
        diagnosis = learn(HERE)
        sh.write_model(correct(diagnosis), HERE / "corrected.toml")
        print(diagnosis.sentence)
    elif arguments[:1] == ["seeds"]:
        for seed in arguments[1:]:
            _keep({f"noise {seed}": _with_noise(int(seed))})
    else:
        _compare()


def _with_noise(seed: int) -> dict[str, object]:
    with tempfile.TemporaryDirectory() as name:
        generate.write(Path(name), seed)
        diagnosis = learn(Path(name))
    played, _ = play(planned(correct(diagnosis)))
    print(diagnosis.sentence, played, sep="\n", flush=True)
    return {"sentence": diagnosis.sentence, **_plain(played)}


def _plain(played: dict[str, Played]) -> dict[str, object]:
    return {way: asdict(one) for way, one in played.items()}


def _compare() -> None:
    given = sh.read_model(HERE / "machine.toml")
    models = {
        "as given": given,
        "corrected": sh.read_model(HERE / "corrected.toml"),
        "concealed values": parse_model(given.text + CONCEALED),
    }
    plans = {name: planned(model) for name, model in models.items()}
    runs = {name: play(plan) for name, plan in plans.items()}
    for name, (played, _) in runs.items():
        print(name, played)
    effort = {name: STEP * float(np.sum(plan.push**2)) for name, plan in plans.items()}
    _keep({name: {"effort_N2s": effort[name], **_plain(runs[name][0])} for name in runs})
    t = STEP * np.arange(plans["as given"].push.size)
    np.savetxt(
        HERE / "plans.csv",
        np.column_stack([t, *(plan.push for plan in plans.values())]),
        fmt=("%.2f", *["%.12g"] * len(plans)),
        delimiter=",",
        header=",".join(["t", *(name.replace(" ", "_") for name in plans)]),
        comments="",
    )
    picture(plans, {name: states for name, (_, states) in runs.items()})


def _keep(rows: dict[str, object]) -> None:
    file = HERE / "results.json"
    kept = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    file.write_text(json.dumps(kept | rows, indent=1) + "\n", encoding="utf-8")


def picture(plans: dict[str, Plan], runs: dict[str, Array]) -> None:
    """Angle, place and force over time: planned, and what the real machine does."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(
        3,
        2,
        figsize=(9.5, 6.4),
        sharex=True,
        sharey="row",
        layout="constrained",
        height_ratios=(2, 1.2, 1),
    )
    for column, name in zip(panels.T, ("as given", "corrected"), strict=True):
        plan, real = plans[name], runs[name]
        t, late = STEP * np.arange(len(plan.push)), STEP * np.arange(len(real))
        end = t[-1]
        column[0].plot(t, np.degrees(plan.states[:, 1]), "0.55", lw=3, label="planned")
        column[0].plot(late, np.degrees(real[:, 1]), "C3", lw=1.2, label="real machine")
        column[1].plot(t, plan.states[:, 0], "0.55", lw=3)
        column[1].plot(late, real[:, 0], "C3", lw=1.2)
        column[2].plot(t, plan.push, "C0", lw=1.2)
        for axes in column:
            axes.axvspan(end, late[-1], color="0.94", zorder=0)
        if len(real) < len(t) + round(HELD / STEP):
            where = {"xytext": (14, 4), "textcoords": "offset points", "fontsize": 8}
            column[1].annotate("end of the rail", (late[-1], real[-1, 0]), **where)
        words = {"as given": "model as given", "corrected": "corrected model"}
        column[0].set_title(f"plan of the {words[name]}", fontsize=10)
    panels[0, 0].legend(fontsize=8, frameon=False, loc="upper left")
    panels[0, 0].set_ylabel("pole [°], 180 upright")
    panels[1, 0].set_ylabel("cart [m]")
    panels[2, 0].set_ylabel("planned force [N]")
    for axes in panels[2]:
        axes.set_xlabel("t [s]; grey: feedback holds upright")
    figure.savefig(HERE / "swing.png", dpi=110)


if __name__ == "__main__":
    main(sys.argv[1:])

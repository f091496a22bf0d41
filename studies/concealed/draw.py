"""Draw cases from seeds, before any diagnosis, and write them with their answers sealed.

    python studies/concealed/draw.py --seeds 0-99 -o build/concealed
    python studies/concealed/draw.py --seeds 0-99 --harder      # in build/concealed-harder

A case is a folder with model.toml, train.csv, holdout.csv and sealed.json; where no draw was
complete it holds discarded.json alone.
"""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from conceal import Case, draw
from harder import harder
from hidden import seen, targets
from laws import Array
from plans import PLAIN, Sort, add_sort, folder_of, plan_of, seeds_of
from seal import seal
from systems import System


def measured(case: Case, index: int) -> tuple[list[str], Array]:
    """Column names and the recording (N, columns) of a run, noise and delays included."""
    run = case.runs[index]
    late = {name: run.hidden.fault(name, "delay") for name in run.names}
    y = seen(run.plant, run.motion, run.hidden, run.names)
    y = np.array(
        [
            np.interp(run.motion.t - late[name], run.motion.t, row)
            for name, row in zip(run.names, y, strict=True)
        ]
    )
    random = np.random.default_rng([case.plan.seed, 3, index])
    y = y + run.sd[:, None] * _noise(random, y.shape, case.colour)
    given = [run.motion.t, *run.inputs]
    names = ["t", *run.system.inputs]
    if run.system.imposed:
        given, names = [run.motion.t, run.motion.q[0]], ["t", run.system.coordinates[0]]
    return [*names, *run.names], np.column_stack([*given, *y])


def _noise(random: np.random.Generator, shape: tuple[int, ...], colour: float) -> Array:
    """Noise of variance 1, white or with a correlation time of ``colour`` samples."""
    white = random.standard_normal(shape)
    if not colour:
        return white
    keep = float(np.exp(-1 / colour))
    y = white.copy()
    for i in range(1, shape[1]):
        y[:, i] = keep * y[:, i - 1] + np.sqrt(1 - keep**2) * white[:, i]
    return y


def answer(case: Case) -> dict[str, Any]:
    """What was concealed, for the seal."""
    hidden, plan = case.hidden, case.plan
    null = not targets(hidden)
    verdict = "nothing missing"
    if hidden.effects:
        verdict = "missing physics"
    elif hidden.faults or hidden.parameters:
        verdict = "measurement" if hidden.faults else "parameters"
    return {
        "verdict": verdict,
        "kind": f"null.{case.hardship['sort']}" if null and case.hardship else plan.kind,
        "noise": plan.noise,
        "colour": case.colour,
        "complete": plan.complete,
        "effects": [
            {"kind": e.kind, "place": e.place, "side": e.side, "keys": e.keys, "share": share}
            for e, share in zip(hidden.effects, case.share, strict=True)
        ],
        "parameters": dict(hidden.parameters),
        "faults": [{"channel": f.channel, "kind": f.kind, "value": f.value} for f in hidden.faults],
        "oracle": [
            {
                "target": [g.sort, g.index, g.key],
                "relative_sd": float(s) if np.isfinite(s) else None,
            }
            for g, s in zip(targets(hidden), case.sd, strict=True)
        ],
        "rivals": case.rivals,
        "names": list(case.runs[0].names),
        "sd": [float(x) for x in case.runs[0].sd],
        "sticks": case.runs[0].motion.sticks,
        "discarded": case.discarded,
        "may_refuse": case.may_refuse,
        "hardship": dict(case.hardship),
    }


def model_text(system: System, names: tuple[str, ...]) -> str:
    """The model file with the sensors of the case alone."""
    head, mark, sensors = system.text().partition("[sensors]\n")
    kept = [line for line in sensors.splitlines() if line.split(" ")[0] in names]
    return head + mark + "\n".join(kept) + "\n"


def write(seed: int, build: Path, sort: Sort = PLAIN) -> Path | None:
    """Draw a case into its folder unless it is there; None where no draw was kept."""
    folder = folder_of(seed, build)
    given_up = folder / "discarded.json"
    if (folder / "sealed.json").exists():
        return folder
    if given_up.exists():
        return None
    folder.mkdir(parents=True, exist_ok=True)
    case = draw(seed, sort.keep_hard)
    if not isinstance(case, int) and sort.harder:
        case = harder(case) or case.discarded
    if isinstance(case, int):
        given_up.write_text(json.dumps({"discarded": case, "kind": plan_of(seed).kind}) + "\n")
        return None
    (folder / "model.toml").write_text(model_text(case.plan.system, case.runs[0].names))
    for index, name in enumerate(("train.csv", "holdout.csv")):
        header, columns = measured(case, index)
        np.savetxt(
            folder / name, columns, fmt="%.9g", delimiter=",", header=",".join(header), comments=""
        )
    (folder / "sealed.json").write_text(seal(answer(case)), encoding="ascii")
    return folder


def main() -> None:
    """Write the cases of some seeds."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-99")
    add_sort(parser)
    options = parser.parse_args()
    sort = Sort(options.harder, options.keep_hard)
    for seed in seeds_of(options.seeds):
        folder = write(seed, options.output or sort.build, sort)
        print(seed, plan_of(seed).system.name, "kept" if folder else "no complete draw")


if __name__ == "__main__":
    main()

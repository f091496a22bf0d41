"""Twenty runs altered by hand among those of a study: does the fleet name them, and no others?

python studies/servo_pendulums/altered.py OUT FITS SEED
symhyb run OUT/ladder.toml -o FITS --resume            # weight and friction; only the twenty
symhyb run OUT/gain.toml -o GAINS --resume             # the gain
symhyb fleet FITS --among mount,trajectory,gain

FITS and GAINS are what symhyb run left of the ladder and of the gains of the runs as they are, or
copies of them. What is not altered is found there by its content.

Of the runs in FITS that nothing was developed on twenty are drawn:

mass      the stated weight is the next one of the four, what the arm carries stays
gain      the stated gain is 1/1.03 of what the controller has
friction  damping, dry friction and friction by load are 1.5 times what was fitted to this run. The
          run is simulated with both by the equations below, and the difference of the simulations
          is added to the recorded angle, in whole steps of the encoder. The duty is what the
          controller makes of that, its goal being the same; where it was at its limit, the
          difference of the simulations is added. What the model lacks and noise stay as recorded.

    (m l² + J) q'' = k u − k_e on q' − c q' − (F + mu |m g l sin q|) tanh(q'/w) − m g l sin q
    u = on clip(g kp (passed(goal) − q), ±1), passed: 25 ms late and no faster than 7.5 rad/s
"""

import csv
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from falls import FOLDER, folder_of_runs
from numpy.typing import NDArray
from runs import PER_RAD, STEPS, Run, read_runs, restated, write_runs

from symhyb.tasks.outcome import NOT_RUN, Outcomes, read_outcomes

MORE_GAIN, MORE_FRICTION = 1.03, 1.5
COUNT = 20
KINDS = ("mass", "friction", "gain")
STRUCTURE = "load"
STEP = 5e-4  # s
WIDTH = 0.02  # rad/s: within it friction turns over
GRAVITY = 9.81  # m/s²
TORQUE, COUNTER = 9.6, 1.10  # N·m at full duty, N·m·s/rad: k and k_e of motor.toml
LATE, FASTEST = 0.025, 7.5  # s, rad/s: of the controller

Array = NDArray[np.float64]


def passed(goal: Array) -> Array:
    """The wanted angle (N,) every ``STEP`` as the controller follows it."""
    late = round(LATE / STEP)
    target = np.concatenate([np.full(late, goal[0]), goal[: goal.size - late]])
    found, now = np.empty_like(target), float(target[0])
    for i, wanted in enumerate(target):
        now += float(np.clip(wanted - now, -FASTEST * STEP, FASTEST * STEP))
        found[i] = now
    return found


def simulated(run: Run, numbers: Mapping[str, float], more: float = 1.0) -> tuple[Array, Array]:
    """Angles and duties (N,) at the times of a run under its controller, from its first angle at
    rest, with ``more`` times the friction of ``numbers`` J, c, F and mu, SI."""
    fine = np.arange(0.0, run.t[-1] + STEP, STEP)
    goal = passed(np.interp(fine, run.t, run.goal))
    on = run.on[np.clip(np.searchsorted(run.t, fine, side="right") - 1, 0, None)]
    seen = np.isfinite(run.q)
    q, v = float(run.q[seen][0]), 0.0
    inertia = run.mass * run.length**2 + numbers["J"]
    pull = run.mass * GRAVITY * run.length
    c, dry, load = (more * numbers[name] for name in ("c", "F", "mu"))
    angles, duties = np.empty_like(fine), np.empty_like(fine)
    for i in range(fine.size):
        duty = on[i] * min(max(PER_RAD * run.kp * (goal[i] - q), -1.0), 1.0)
        angles[i], duties[i] = q, duty
        weight = pull * np.sin(q)
        steep = np.tanh(v / WIDTH) / v if v else 1 / WIDTH  # of friction, taken at the next speed
        lost = c + COUNTER * on[i] + (dry + load * abs(weight)) * steep
        v = (v + STEP * (TORQUE * duty - weight) / inertia) / (1 + STEP * lost / inertia)
        q += STEP * v
    return np.interp(run.t, fine, angles), np.interp(run.t, fine, duties)


def with_friction(run: Run, numbers: Mapping[str, float]) -> Run:
    """A run as it would have been with more friction."""
    before, after = (simulated(run, numbers, more) for more in (1.0, MORE_FRICTION))
    step = 2 * np.pi / STEPS
    moved = step * np.round((after[0] - before[0]) / step)
    made = np.where(abs(run.duty) < 1, -PER_RAD * run.kp * run.on * moved, after[1] - before[1])
    return replace(run, q=run.q + moved, duty=np.clip(run.duty + made, -1.0, 1.0))


def picked(runs: Sequence[Run], seed: int) -> dict[int, str]:
    """The runs to be altered, by their number, with the kind: drawn of the half of the figures."""
    half = sorted((one for one in runs if one.half == 1), key=lambda one: one.run)
    some = np.random.default_rng(seed).permutation(len(half))[:COUNT]
    return {half[place].run: KINDS[i % len(KINDS)] for i, place in enumerate(some)}


def next_weight(mass: float, weights: Sequence[float]) -> float:
    """Another of the weights: the next one up, of the heaviest the one below."""
    at = weights.index(mass)
    return weights[at + 1] if at + 1 < len(weights) else weights[at - 1]


def altered(run: Run, kind: str, weights: Sequence[float], numbers: Mapping[str, float]) -> Run:
    """A run with one thing changed."""
    match kind:
        case "mass":
            return restated(run, mass=next_weight(run.mass, weights) / run.mass)
        case "gain":
            return restated(run, kp=1 / MORE_GAIN)
    return with_friction(run, numbers)


def fitted_numbers(outcomes: Outcomes) -> dict[str, dict[str, float]]:
    """What was fitted to each run, by the name of its file, SI."""
    found = {}
    for one in outcomes.tasks:
        rungs = () if one.fitted is None else one.fitted.rungs
        for rung in rungs:
            if rung.name == STRUCTURE and rung.fitted is not None:
                values = map(float, rung.fitted.values)
                name = dict(one.entry.settings)["recordings"]
                found[name] = dict(zip(rung.fitted.names, values, strict=True))
    return found


def main() -> None:
    """Write the folder that is named, and altered.csv with what was changed."""
    folder, out = folder_of_runs(), Path(sys.argv[1])
    if folder is None:
        raise SystemExit(f"no {FOLDER} in the folder that SYMHYB_DATA names")
    fits, seed = read_outcomes(Path(sys.argv[2])), int(sys.argv[3])
    numbers = fitted_numbers(fits)
    tasks = [one for one in fits.tasks if one.state != NOT_RUN]
    names = {dict(one.entry.settings)["recordings"] for one in tasks}
    runs = [one for one in read_runs(folder) if one.name in names]
    kinds = picked([one for one in runs if one.name in numbers], seed)
    weights = sorted({one.mass for one in runs})
    changed = [
        altered(one, kinds[one.run], weights, numbers[one.name]) if one.run in kinds else one
        for one in runs
    ]
    write_runs(changed, out)
    with open(out / "altered.csv", "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["file", "altered"])
        writer.writerows([f"run-{number}.csv", kind] for number, kind in kinds.items())
    print(f"{out}: {len(runs)} runs, {len(kinds)} of them altered, in altered.csv")


if __name__ == "__main__":
    main()

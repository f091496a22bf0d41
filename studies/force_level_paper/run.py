"""One parameter set after the other: draw, record, learn, simulate in every host, keep as JSON.

    python studies/force_level_paper/run.py --seeds 80-99

A set that has its file in ``results`` is left as it is. Errors are those of displacement and
velocity, [m, m/s], against the exact reference, and null where a run was not finite.
"""

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import hosts
import learn
import numpy as np
import truth
from joblib import Parallel, delayed
from truth import Array, Data, Drive, Oscillator, Run

import symhyb as sh
from symhyb import Scenario
from symhyb.learning import lacking, measured_course, simulate_corrected, values_along

HERE = Path(__file__).resolve().parent
KEPT = HERE / "results"
SIMULATED = 10.0  # s
STEPS = (1e-2, 1e-3)
Learned = dict[str, learn.Learned]
Pair = list[float | None]


def one(seed: int, steps: tuple[float, ...] = STEPS, excitations: int = 99) -> dict[str, Any]:
    """All that is measured of a set of parameters."""
    began = time.time()
    drawn = truth.draw(seed)
    it = drawn.machine
    data = truth.recorded(it, seed)
    full = dict(learn.learn(it, data, seed))
    place = dict(learn.learn(it, data, seed, only_place=True))
    tried = list(truth.drives(it.drive).items())[:excitations]
    return {
        "seed": seed,
        "discarded": drawn.discarded,
        "machine": {
            "m": it.m,
            "c": it.c,
            "d": it.d,
            "mu": it.mu,
            "q0": it.q0,
            "coulomb": it.coulomb,
            "F": it.drive.amplitude,
            "f": it.drive.frequency,
        },
        "noise": data.sd[:, 0].tolist(),
        "learned": said(full),
        "learned from place": said(place),
        "nrmse": discrepancies(it, data, full),
        "simulated": {name: simulated(it, drive, data, full) for name, drive in tried},
        "simulated from place": {
            name: simulated(it, drive, data, place, few=True) for name, drive in tried
        },
        "hosts": in_hosts(it, data, full, steps),
        "seconds": time.time() - began,
    }


def said(learned: Learned) -> dict[str, Any]:
    """Laws by row: kinds and values of the elements, and the sentence."""
    return {
        row: {
            "elements": {
                e.name: [e.kind, {p.name: p.value for p in e.parameters}] for e in found.elements
            },
            "said": found.said,
        }
        for row, found in learned.items()
    }


def discrepancies(it: Oscillator, data: Data, learned: Learned) -> dict[str, Any]:
    """NRMSE of Δq'' (of rates) and of ΔF against what was measured, on samples trained on and not;
    ``noise`` is that of the true force: nothing learned can be expected below it."""
    model = learn.model_of(it, it.drive, data)
    machine, no = sh.build(model), np.empty((data.t.size, 0))
    course = measured_course(machine, data.t, (data.q, data.v, data.a), no)
    force, rates = (lacking(machine, course, form) for form in ("force", "rates"))

    def both(found: Array, wanted: Array) -> list[float]:
        return [truth.nrmse(found[rows], wanted[rows]) for rows in (data.train, ~data.train)]

    table = {"noise": {"force": both(it.missing(data.exact[1])[:, 0], force[:, 0])}}
    for row, found in learned.items():
        corrected = sh.build(found.on(model))
        left = lacking(
            corrected, measured_course(corrected, data.t, (data.q, data.v, data.a), no), "force"
        )
        laws = [values_along(machine, course, law) for law in found.correction.laws]
        total = np.sum(laws, axis=0)[:, -1]
        if row == learn.REGRESSION:
            table[row] = {"force": both(total, force[:, 0])}
        else:
            table[row] = {
                "force": both((force - left)[:, 0], force[:, 0]),
                "rates": both(total, rates[:, 1]),
            }
    return table


def scenario_of(it: Oscillator, exact: Run) -> Scenario:
    """The start and the sizes of the motion."""
    t = truth.times(SIMULATED)
    sizes = np.array([np.abs(part).max() for part in exact[:2]])
    return Scenario(t, np.array([it.q0]), np.zeros(1), t, np.empty((t.size, 0)), sizes)


def reference(it: Oscillator, drive: Drive) -> Run:
    return truth.simulate(it.plant(drive), truth.times(SIMULATED), np.array([it.q0]), np.zeros(1))


def error(q: Array, v: Array, wanted: tuple[Array, Array] | Run) -> Pair:
    """RMSE of q and v; null where it is not finite."""
    pair = [truth.rmse(x, y) for x, y in zip((q, v), wanted[:2], strict=True)]
    return [x if np.isfinite(x) else None for x in pair]


def lags(it: Oscillator, found: tuple[Array, Array], wanted: Run) -> list[float]:
    """How late it is in the first two periods and in the last five, s."""
    t, period = truth.times(SIMULATED), 1 / it.drive.frequency
    run = (found[0], found[1], found[1])
    windows = ((0.0, 2 * period), (SIMULATED - 5 * period, SIMULATED))
    return [truth.lag(t, run, wanted, window) for window in windows]


def simulated(
    it: Oscillator, drive: Drive, data: Data, learned: Learned, few: bool = False
) -> dict[str, Any]:
    """Every correction in CVODES under one excitation, at both levels (``few``: those of rates
    only where they are sparse)."""
    model, exact = learn.model_of(it, drive, data), reference(it, drive)
    scenario = scenario_of(it, exact)
    machine = sh.build(model)
    alone = simulate_corrected(machine, scenario)
    table: dict[str, Any] = {
        "alone": {
            "force": error(alone.q, alone.v, exact),
            "lag": lags(it, (alone.q, alone.v), exact),
        }
    }
    same: dict[tuple[str, ...], Any] = {}
    for row, found in learned.items():
        if row == learn.REGRESSION:
            if not few:
                forces = simulate_corrected(machine, scenario, found.correction)
                table[row] = {"force": error(forces.q, forces.v, exact)}
            continue
        names = tuple(e.name for e in found.elements)
        force = same.get(names)
        if force is None:
            corrected = sh.build(found.on(model))
            force = same[names] = simulate_corrected(corrected, scenario) if names else alone
        table[row] = {
            "force": error(force.q, force.v, exact),
            "lag": lags(it, (force.q, force.v), exact),
        }
        if row == "sparse" or not few:
            rates = simulate_corrected(machine, scenario, found.correction)
            table[row]["rates"] = error(rates.q, rates.v, exact)
    return table


def in_hosts(
    it: Oscillator, data: Data, learned: Learned, steps: tuple[float, ...]
) -> dict[str, Any]:
    """Every correction of forces in every host by every coupling: ``error`` against the reference,
    ``coupling`` against CVODES with the same correction."""
    model, exact = learn.model_of(it, it.drive, data), reference(it, it.drive)
    scenario = scenario_of(it, exact)
    known: dict[tuple[str, ...], dict[str, Any]] = {}
    table = {}
    for row in learn.ROWS:
        corrected = learned[row].on(model)
        names = tuple(e.name for e in learned[row].elements)
        if names and names not in known:
            cvodes = simulate_corrected(sh.build(corrected), scenario)
            with tempfile.TemporaryDirectory() as folder:
                spec, path = hosts.written(corrected, names, Path(folder))
                known[names] = {
                    host: {
                        coupling: _by_step(
                            it, host, coupling, (spec, path), steps, exact, (cvodes.q, cvodes.v)
                        )
                        for coupling in hosts.COUPLINGS
                    }
                    for host in hosts.HOSTS
                }
        table[row] = known.get(names, {})
    return table


def _by_step(
    it: Oscillator,
    host: str,
    coupling: str,
    made: tuple[Any, Path],
    steps: tuple[float, ...],
    exact: Run,
    cvodes: tuple[Array, Array],
) -> dict[str, Any]:
    table, t = {}, truth.times(SIMULATED)
    for h in steps:
        with hosts.law_of(*made, coupling) as law:
            q, v = hosts.oscillator_in(host, it, it.drive).run(law, t, h)
        table[f"{h:g}"] = {
            "error": error(q, v, exact),
            "coupling": error(q, v, cvodes),
            "lag": lags(it, (q, v), exact),
        }
    return table


def rounded(value: Any) -> Any:
    """Four digits, which is more than is reported; null for what is not finite."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [rounded(item) for item in value]
    if not isinstance(value, float):
        return value
    return float(f"{value:.4g}") if np.isfinite(value) else None


def text_of(reported: dict[str, Any]) -> str:
    """JSON with a line for every key."""
    lines = (f"{json.dumps(key)}: {json.dumps(rounded(item))}" for key, item in reported.items())
    return "{\n" + ",\n".join(lines) + "\n}\n"


def keep(seed: int, folder: Path) -> str:
    """Measure a set unless that was done; what happened, in words."""
    target = folder / f"{seed:03d}.json"
    if target.exists():
        return f"{seed}: there"
    reported = one(seed)
    part = target.with_suffix(".part")
    part.write_text(text_of(reported), encoding="utf-8")
    part.replace(target)
    return f"{seed}: {reported['learned']['sparse']['said']} ({reported['seconds']:.0f} s)"


def main() -> None:
    """Run some sets."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="80-99")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--results", type=Path, default=KEPT)
    options = parser.parse_args()
    options.results.mkdir(parents=True, exist_ok=True)
    first, _, last = options.seeds.partition("-")
    seeds = range(int(first), int(last or first) + 1)
    tasks = (delayed(keep)(seed, options.results) for seed in seeds)
    for line in Parallel(n_jobs=options.workers, return_as="generator")(tasks):
        print(line, flush=True)


if __name__ == "__main__":
    main()

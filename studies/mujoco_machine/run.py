"""What is named in machines that MuJoCo has and that it records.

python studies/mujoco_machine/run.py OUT [MACHINE…]    # a line a case

MuJoCo is the machine, but of loop-imported and tight-imported, which `symhyb import` reads.
"""

import sys
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage

from machines import MACHINES, imported_model, record, short_model

import symhyb as sh

CONCEALED = ("nothing", "friction", "damping")
SEEDS = {"train": 1, "unseen": 2}
LOOPS = ("loop-imported", "tight-imported")
COLUMNS = {"crank_torque": "drive"}  # the input of an imported loop, and the recorded motor


def seconds() -> float:
    """Of a processor so far, with all processes that were started and have ended."""
    used = [getrusage(who) for who in (RUSAGE_SELF, RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def main() -> None:
    """Record and diagnose every case."""
    for name in sys.argv[2:] or (*MACHINES, *LOOPS):
        machine, folder = MACHINES[name.partition("-")[0]], Path(sys.argv[1]) / name
        folder.mkdir(parents=True, exist_ok=True)
        model = (imported_model if name in LOOPS else short_model)(machine, folder)
        columns = COLUMNS if name in LOOPS else None
        for concealed in CONCEALED:
            train, unseen = (
                sh.Recording.from_frame(record(machine, concealed, seed), model, columns, name=part)
                for part, seed in SEEDS.items()
            )
            begin = seconds()
            found = sh.diagnose(model, train, unseen)
            corrected = sh.apply(model, found.found, found.parameters, found.measurement)
            verdict = sh.judge(model, corrected, on=unseen).to_frame()
            took = seconds() - begin
            print(f"{name}, {concealed}, {took:.0f} s: {found.sentence}")
            for row in verdict[verdict.score.str.endswith("_rmse")].itertuples():
                after = "" if row.after is None else f" -> {row.after:.3g}"
                print(f"  {row.score} of {row.of}: {row.before:.3g}{after} {row.unit}", flush=True)


if __name__ == "__main__":
    main()

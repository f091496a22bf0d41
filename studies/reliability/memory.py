"""Does a process that diagnoses again and again keep its memory?

    python studies/reliability/memory.py                # 2000 diagnoses, about two hours
    python studies/reliability/memory.py --count 200

Each diagnosis is that of the demonstration's oscillator on another stretch of its recording. The
memory that the process holds is noted after each; the mean over the last tenth of them is compared
with that over the tenth after the first tenth, in which caches fill. Exit status 1 if it grew by
more than 5 %.
"""

import argparse
import gc
import os
import sys
import time

import numpy as np
from readers import ROOT

import symhyb as sh

ROWS = 500  # of a stretch
MOST = 0.05  # by which memory may grow
FEWEST = 20


def main() -> int:
    """Diagnose, and say how much memory the process held on the way."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--count", type=int, default=2000, help=f"diagnoses, at least {FEWEST}")
    count = max(FEWEST, parser.parse_args().count)
    model = sh.read_model(ROOT / "models" / "oscillator.toml")
    whole = sh.read_recording(ROOT / "studies" / "oscillator" / "train.csv", model)
    starts = np.random.default_rng(0).integers(0, whole.t.size - ROWS, count)
    held, begin = np.zeros(count), time.perf_counter()
    for k, start in enumerate(starts):
        sh.diagnose(model, [whole.crop(whole.t[start], whole.t[start + ROWS - 1])])
        gc.collect()
        held[k] = resident()
        if (k + 1) % max(1, count // 20) == 0:
            took = time.perf_counter() - begin
            print(f"{k + 1} diagnoses, {took:.0f} s, {held[k] / 2**20:.1f} MiB", flush=True)
    tenth = count // 10
    early, late = held[tenth : 2 * tenth].mean(), held[-tenth:].mean()
    print(f"from {early / 2**20:.1f} to {late / 2**20:.1f} MiB: {late / early - 1:+.1%}")
    return int(late / early - 1 > MOST)


def resident() -> int:
    """The bytes of memory that this process holds."""
    with open("/proc/self/statm", encoding="ascii") as stream:
        return int(stream.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


if __name__ == "__main__":
    sys.exit(main())

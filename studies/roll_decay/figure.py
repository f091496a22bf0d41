"""The picture of README.md: how fast the roll decays against its amplitude, and what was found.

python studies/roll_decay/figure.py AT_REST AT_SPEED     # two folders that `symhyb run` has left

In windows of two periods the roll is fitted by A exp(-b t/2) cos(w t + a) + c, which knows nothing
of any law. To the laws found, per unit of inertia, belongs the loss of a period (energy balance):

    b(A) = d + 8/(3 pi) b2 w A + 4/pi F/(w A)        d damping, b2 drag, F dry friction

The drag beside an alternative is the one that meets the points best.
"""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from symhyb.data.datasets import fetch
from symhyb.study.expected import found_terms

HERE = Path(__file__).resolve().parent
PERIOD, OMEGA = 2.55, 2.461  # s, rad/s
RUNS = {
    "at_rest": {"model_test_21338.csv": (9.3, 89.0), "model_test_21337.csv": (25.5, 91.0)},
    "at_speed": {"model_test_21340.csv": (24.4, 69.0)},
}
Array = NDArray[np.float64]


def windows(file: str, span: tuple[float, float]) -> tuple[Array, Array]:
    """Amplitudes in rad and rates of decay b in 1/s, in windows of two periods."""
    data = np.genfromtxt(fetch("kvlcc2_rolldecay", file), delimiter=",", names=True)
    t, phi = data["time"], data["phi"]
    rows = []
    for begin in np.arange(span[0], span[1] - 2 * PERIOD, 2 * PERIOD):
        chosen = (t >= begin) & (t < begin + 2 * PERIOD)
        middle = t[chosen] - begin - PERIOD

        def decay(s: Array, a: float, c: float, b: float, w: float, zero: float) -> Array:
            return np.exp(-b * s / 2) * (a * np.cos(w * s) + c * np.sin(w * s)) + zero

        first = (np.max(phi[chosen]), 0.01, 0.03, OMEGA, 0.0)
        (a, c, b, _, _), _ = curve_fit(decay, middle, phi[chosen], first)
        rows.append((np.hypot(a, c), b))
    amplitude, rate = np.array(rows).T
    return amplitude, rate


def rate_of(laws: Mapping[str, float], amplitude: Array) -> Array:
    """The rate of decay b in 1/s of laws per unit of inertia."""
    speed = OMEGA * amplitude
    linear, dry = laws.get("phi.damping", 0.0), laws.get("phi.coulomb", 0.0)
    drag = laws.get("phi.drag", 0.0)
    return linear + 8 / (3 * np.pi) * drag * speed + 4 / np.pi * dry / speed


def beside(laws: Mapping[str, float], amplitude: Array, rate: Array) -> dict[str, float]:
    """The laws with the drag that meets the points best."""
    rest = rate - rate_of({**laws, "phi.drag": 0.0}, amplitude)
    drag = 8 / (3 * np.pi) * OMEGA * amplitude
    return {**laws, "phi.drag": float(drag @ rest / (drag @ drag))}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("at_rest", type=Path)
    parser.add_argument("at_speed", type=Path)
    given = parser.parse_args()
    figure, panels = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for axes, (name, runs) in zip(panels, RUNS.items(), strict=True):
        content = json.loads((getattr(given, name) / "diagnosis.json").read_text("utf-8"))
        points = [windows(file, span) for file, span in runs.items()]
        for (amplitude, rate), file, mark in zip(points, runs, "os", strict=False):
            axes.plot(1e3 * amplitude, rate, mark, ms=5, mfc="none", label=f"run {file[11:16]}")
        found = {key: number["value"] for key, number in found_terms(content).items()}
        rivals = {
            f"phi.{number['term']}": number["value"]
            for rival in content["alternatives"]
            if rival.get("place") == {"on": "phi"}
            for number in rival["parameters"].values()
        }
        along = np.linspace(0.04, 0.17, 200)
        for key in ("phi.coulomb", "phi.damping"):
            if key in rivals:
                laws = beside({**found, key: rivals[key]}, *points[0])
                said = "drag and dry friction" if key == "phi.coulomb" else "drag and damping"
                axes.plot(1e3 * along, rate_of(laws, along), lw=1.2, label=said)
        if "phi.damping" in found:
            axes.plot(1e3 * along, rate_of(found, along), lw=1.2, label="drag and damping")
        axes.set(xlabel="amplitude [mrad]", ylabel="rate of decay b [1/s]", ylim=(0, None))
        axes.set_title(name.replace("_", " "), fontsize=10)
        axes.legend(fontsize=8, frameon=False)
    figure.savefig(HERE / "decay.png", dpi=110)


if __name__ == "__main__":
    main()

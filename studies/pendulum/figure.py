"""The picture of README.md: what the single pendulum loses, and how far each law is off.

python studies/pendulum/figure.py OUT     # what `symhyb run` has left of single/study.toml

Left: between two turning points the energy falls by m g l (cos A2 - cos A1); over the way A1 + A2
that is a mean torque, which knows nothing of any law. The same mean of a law T(rate) in a swing of
amplitude A, whose rate is sqrt(2 w2 (cos phi - cos A)), is a curve. Right: one free run from 0 s.
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray
from reference import FIRST, LEARNED, NUMBERS, simulated, single, swing

from symhyb.study.expected import found_terms

HERE = Path(__file__).resolve().parent
WEIGHT = 0.1476 * 9.81 * 0.1478  # m g l, N·m
W2 = 64.05
PUBLISHED = 2.2394e-4  # N·m·s, viscous
Array = NDArray[np.float64]


def losses(zero: float) -> tuple[Array, Array]:
    """Amplitude in rad and mean torque in N·m of each swing from side to side."""
    t, phi = swing(1)
    phi = phi - zero
    back = np.flatnonzero(np.diff(np.sign(np.gradient(phi))) != 0)
    back = back[np.concatenate([[True], np.diff(back) > 100])]
    sizes = []
    for i in back[(back > 60) & (back < t.size - 60)]:
        near = slice(i - 50, i + 51)
        sizes.append(abs(np.polyval(np.polyfit(t[near] - t[i], phi[near], 4), 0.0)))
    a, b = np.array(sizes[:-1]), np.array(sizes[1:])
    return (a + b) / 2, WEIGHT * (np.cos(b) - np.cos(a)) / (a + b)


def mean_torque(law: Callable[[Array], Array], amplitude: Array) -> Array:
    """The mean over the way of a torque that depends on the rate."""
    part = np.sin(np.linspace(-np.pi / 2, np.pi / 2, 401))  # dense at the ends, where it is slow
    rows = []
    for size in amplitude:
        phi = size * part
        rate = np.sqrt(np.maximum(2 * W2 * (np.cos(phi) - np.cos(size)), 0.0))
        rows.append(np.trapezoid(law(rate), phi) / (2 * size))
    return np.array(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    content = json.loads((parser.parse_args().out / "diagnosis.json").read_text("utf-8"))
    found = {name: number["value"] for name, number in found_terms(content).items()}
    viscous, both = single(("c1",), LEARNED).numbers, single(("c0", "c2"), LEARNED).numbers
    falling = single(("c0", "cs", "vs", "c2")).numbers
    inertia = WEIGHT / falling["w2"]

    def falls(rate: Array) -> Array:
        dry = falling["c0"] + falling["cs"] * np.exp(-((rate / falling["vs"]) ** 2))
        return inertia * (dry + falling["c2"] * rate**2)

    laws = {
        "viscous, published": ("#d9812e", lambda rate: PUBLISHED * rate),
        "found: dry friction and drag": (
            "#b3261e",
            lambda rate: found["phi.coulomb"] + found["phi.drag"] * rate**2,
        ),
        "dry friction that falls with speed, and drag": ("#1f6fb2", falls),
    }
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.4, 3.7), layout="constrained")
    amplitude, torque = losses(found["encoder.offset"])
    left.plot(amplitude, 1e3 * torque, ".", color="#1f2933", ms=4, label="recorded")
    along = np.linspace(0.22, 1.65, 60)
    for name, (color, law) in laws.items():
        left.plot(along, 1e3 * mean_torque(law, along), color=color, lw=1.3, label=name)
    left.axvline(0.55, color="0.7", lw=0.8)
    left.set(xlabel="amplitude [rad]", ylabel="mean torque of the loss [mN·m]", ylim=(0, 2.0))
    left.legend(fontsize=8, frameon=False, loc="lower right")
    t, phi = swing()
    for color, name, numbers in (
        ("#d9812e", "viscous, fitted to 36.7 s", viscous),
        ("#b3261e", "dry friction and drag, fitted to 36.7 s", both),
        ("#1f6fb2", "falling dry friction and drag, to 55 s", falling),
    ):
        right.plot(t, error_of(numbers, t, phi), color=color, lw=0.8, label=name)
    right.axvline(LEARNED, color="0.7", lw=0.8)
    right.set(xlabel="time [s]", ylabel="free run less recording [mrad]", ylim=(-120, 120))
    right.legend(fontsize=8, frameon=False, loc="upper left")
    figure.savefig(HERE / "loss.png", dpi=100, metadata={"Software": None})


def error_of(numbers: dict[str, float], t: Array, phi: Array) -> Array:
    """What a free run of fitted numbers is off by, in mrad; they hold the initial state."""
    p = {**dict.fromkeys(NUMBERS, 0.0), "vs": FIRST["vs"], **numbers}
    return np.asarray(1e3 * (simulated(p, t)[0] - phi))


if __name__ == "__main__":
    main()

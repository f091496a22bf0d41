"""Three pictures of one parameter set, after figures 2, 3 and 6 of the paper.

python studies/force_level_paper/figure.py --seed 80
"""

import argparse
import tempfile
from pathlib import Path
from typing import Any

import hosts
import learn
import matplotlib
import numpy as np
import run
import truth
from truth import Array

import symhyb as sh
from symhyb.learning import lacking, measured_course, simulate_corrected, values_along

matplotlib.use("Agg")
import matplotlib.pyplot as plt

HERE = Path(__file__).resolve().parent
SHOWN = 10.0  # s
COLOURS = {"default": "#c9722b", "sparse": "#1b5e8c", "chosen": "#8d5fa8", "alone": "#b9c0c7"}
INK = "#1f2933"
NAMES = {
    "default": "default network",
    "sparse": "sparse (drag and friction)",
    "chosen": "chosen network",
}


def discrepancy(axes: Any, it: truth.Oscillator, data: truth.Data, learned: Any) -> None:
    """Δq'' and ΔF over speed: measured, and what was learned of them."""
    model = learn.model_of(it, it.drive, data)
    machine, no = sh.build(model), np.empty((data.t.size, 0))
    course = measured_course(machine, data.t, (data.q, data.v, data.a), no)
    order = np.argsort(data.v[:, 0])
    for ax, form, unit in zip(axes, ("rates", "force"), ("Δq'', m/s²", "ΔF, N"), strict=True):
        wanted = lacking(machine, course, form)[:, -1]
        for rows, colour, name in (
            (data.train, "#9aa5b1", "measured, trained on"),
            (~data.train, "#d5a6bd", "measured, kept back"),
        ):
            ax.plot(data.v[rows, 0], wanted[rows], ".", ms=2, color=colour, label=name)
        for row in ("default", "sparse"):
            if form == "rates":
                laws = learned[row].correction.laws
                made = np.sum([values_along(machine, course, law) for law in laws], axis=0)[:, -1]
            else:
                other = sh.build(learned[row].on(model))
                again = measured_course(other, data.t, (data.q, data.v, data.a), no)
                made = wanted - lacking(other, again, "force")[:, 0]
            style = {"ls": "", "marker": ".", "ms": 2.5} if row == "default" else {"lw": 1.4}
            name = "sparse (STLSQ)" if (row, form) == ("sparse", "rates") else NAMES[row]
            ax.plot(data.v[order, 0], made[order], color=COLOURS[row], label=name, **style)
        ax.set_xlabel("q', m/s")
        ax.set_ylabel(unit)
    axes[0].legend(markerscale=3, frameon=False, fontsize=8)
    axes[1].legend(markerscale=3, frameon=False, fontsize=8)


def simulated(axes: Any, it: truth.Oscillator, data: truth.Data, learned: Any) -> None:
    """Displacement and velocity in CVODES, and how far they are off."""
    exact = run.reference(it, it.drive)
    scenario = run.scenario_of(it, exact)
    model = learn.model_of(it, it.drive, data)
    alone = simulate_corrected(sh.build(model), scenario)
    lines = [("alone", "force", alone)]
    for row in ("default", "sparse"):
        corrected = sh.build(learned[row].on(model))
        lines.append((row, "force", simulate_corrected(corrected, scenario)))
        rates = simulate_corrected(sh.build(model), scenario, learned[row].correction)
        lines.append((row, "rates", rates))
    t = scenario.t
    for i, unit in enumerate(("q, m", "q', m/s")):
        top, off = axes[0][i], axes[1][i]
        top.plot(t, exact[i][:, 0], color=INK, lw=2.2, label="reference")
        for row, form, found in lines:
            line = (found.q, found.v)[i][:, 0]
            name = NAMES.get(row, "no correction")
            if row != "alone":
                if (row, form) == ("sparse", "rates"):
                    name = "sparse (STLSQ)"
                name += ", force" if form == "force" else ", continuous"
            style = "-" if form == "force" else "--"
            if form == "force":
                top.plot(t, line, color=COLOURS[row], lw=1.1, label=name)
            if row != "alone":
                away = np.abs(line - exact[i][:, 0])
                off.semilogy(t, np.maximum(away, 1e-6), style, color=COLOURS[row], lw=1, label=name)
        top.set_ylabel(unit)
        off.set_ylabel(f"|error| of {unit}")
        off.set_xlabel("t, s")
        off.axhline(run_noise(data, i), color="#9aa5b1", lw=0.8, ls=":")
    axes[0][0].legend(
        frameon=False, fontsize=7.5, ncols=2, loc="lower left", bbox_to_anchor=(0, 1.0)
    )
    axes[1][0].legend(
        frameon=False, fontsize=7.5, ncols=2, loc="lower left", bbox_to_anchor=(0, 1.0)
    )


def run_noise(data: truth.Data, i: int) -> float:
    return float(data.sd[i, 0])


def in_hosts(axes: Any, it: truth.Oscillator, data: truth.Data, learned: Any) -> None:
    """The sparse correction in both hosts: off the reference, and off CVODES."""
    exact = run.reference(it, it.drive)
    scenario = run.scenario_of(it, exact)
    model = learned["sparse"].on(learn.model_of(it, it.drive, data))
    names = tuple(e.name for e in learned["sparse"].elements)
    cvodes, t = simulate_corrected(sh.build(model), scenario), scenario.t
    styles = {"Exudyn": "-", "MuJoCo": (0, (2, 2))}
    colours = {("me", 1e-3): "#1b5e8c", ("cs", 1e-3): "#6a9a3b", ("cs", 1e-2): "#c9722b"}
    kinds = {"me": "model exchange", "cs": "co-simulation"}

    def away(ax: Any, line: Array, other: Array, **more: Any) -> None:
        ax.semilogy(t, np.maximum(np.abs(line - other)[:, 0], 1e-8), lw=1.1, **more)

    away(axes[0], cvodes.q, exact[0], color=INK, label="CVODES: learning error")
    with tempfile.TemporaryDirectory() as folder:
        made = hosts.written(model, names, Path(folder))
        for host in hosts.HOSTS:
            for (coupling, h), colour in colours.items():
                with hosts.law_of(*made, coupling) as law:
                    q, _ = hosts.oscillator_in(host, it, it.drive).run(law, t, h)
                label = f"{host}, {kinds[coupling]}, {1000 * h:g} ms"
                more = {"color": colour, "ls": styles[host], "label": label}
                away(axes[0], q, exact[0], **more)
                away(axes[1], q, cvodes.q, **more)
    axes[0].set_ylabel("off the reference, m")
    axes[1].set_ylabel("off CVODES, m: coupling error")
    for ax in axes:
        ax.set_xlabel("t, s")
    axes[0].set_ylim(1e-5, None)
    axes[0].legend(frameon=False, fontsize=7, ncols=2, loc="lower left", bbox_to_anchor=(0, 1.0))


def main() -> None:
    """Draw the pictures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seed", type=int, default=80)
    parser.add_argument("-o", "--output", type=Path, default=HERE)
    options = parser.parse_args()
    it = truth.draw(options.seed).machine
    data = truth.recorded(it, options.seed)
    learned = learn.learn(it, data, options.seed)
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    for name, shape, size, draw in (
        ("discrepancy", (1, 2), (9, 3.6), discrepancy),
        ("simulated", (2, 2), (9, 5.4), simulated),
        ("hosts", (1, 2), (9, 3.8), in_hosts),
    ):
        figure, axes = plt.subplots(*shape, figsize=size, layout="constrained")
        draw(axes, it, data, learned)
        figure.savefig(options.output / f"{name}.png", dpi=110)
        plt.close(figure)


if __name__ == "__main__":
    main()

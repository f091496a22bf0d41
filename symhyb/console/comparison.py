"""What a comparison of a recording with a model shows, printed and as plain values."""

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.markup import escape
from rich.table import Table

from symhyb.console.terminal import table_console
from symhyb.model.types import On
from symhyb.model.vocabulary import force_unit
from symhyb.report.contract import finite

if TYPE_CHECKING:  # a verb that only reads a file need not load the numerics
    from symhyb.discrepancy.checks.first_checks import FirstChecks
    from symhyb.discrepancy.checks.modes import Mode
    from symhyb.discrepancy.checks.response import Response
    from symhyb.discrepancy.recorded.residual import Discrepancy


def discrepancy_facts(gap: "Discrepancy") -> dict[str, Any]:
    """Give ΔF of one recording by coordinate, root mean squares in the unit of its force."""
    forces = {}
    sizes = [np.sqrt(np.mean(part**2, axis=0)) for part in (gap.force, gap.band, gap.applied)]
    for i, coordinate in enumerate(gap.model.coordinates):
        unit = force_unit(gap.model, On(coordinate.name))
        force, noise, applied = (finite(float(size[i]) / unit.factor) for size in sizes)
        forces[coordinate.name] = {
            "force": force,
            "noise": noise,
            "applied": applied,
            "unit": unit.text,
        }
    return {
        "recording": gap.recording,
        "rms": forces,
        "noise": dict(gap.noise),
        "notes": list(gap.notes),
        "summary": gap.summary(),
    }


def print_first_checks(checks: "FirstChecks") -> None:
    """Print what the first checks of a recording show, a check a row."""
    console = table_console()
    table = Table(box=None, show_header=False, pad_edge=True, padding=(0, 0, 0, 4))
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    before = ""
    for name, sentence in checks.said:
        table.add_row("" if name == before else name, escape(sentence))
        before = name
    with console.capture() as written:
        console.print(table)
    print("  first checks:", *(line.rstrip() for line in written.get().splitlines()), sep="\n")


def check_facts(checks: "FirstChecks") -> dict[str, Any]:
    """Give the first checks of one recording as plain values; null where one could not be had,
    for which ``skipped`` gives the reason. Frequency responses are [real, imaginary], SI."""
    timing, balance = checks.timing, checks.balance
    return {
        "sampling": {
            "rate": timing.rate,
            "jitter": timing.jitter,
            "held": timing.held,
            "missing": timing.missing,
        },
        "delays": [
            {**asdict(late), "sd": finite(late.sd), "sentence": late.sentence}
            for late in timing.late
        ],
        "rest": asdict(checks.standstill) if checks.standstill else None,
        "modes": [
            {**asdict(swing), "modes": [_mode_facts(mode) for mode in swing.modes]}
            for swing in checks.swings
        ],
        "response": [_response_facts(one) for one in checks.responses],
        "energy": {**asdict(balance), "sentence": balance.sentence} if balance else None,
        "skipped": dict(checks.skipped),
    }


def _mode_facts(mode: "Mode") -> dict[str, Any]:
    shape = {name: [part.real, part.imag] for name, part in mode.shape}
    return {
        "frequency": mode.frequency,
        "damping": mode.damping,
        "rate": mode.rate,
        "shape": shape,
    }


def _response_facts(one: "Response") -> dict[str, Any]:
    gains = {"measured": one.measured, **one.simulated}
    return {
        "sensor": one.sensor,
        "drives": list(one.drives),
        "frequency": one.frequency.tolist(),
        "coherence": one.coherence.tolist(),
        "gain": {
            name: {
                drive: [[float(h.real), float(h.imag)] for h in gain[:, i]]
                for i, drive in enumerate(one.drives)
            }
            for name, gain in gains.items()
        },
        "unexplained": one.unexplained,
        "apart": dict(one.apart),
        "split": asdict(one.split) if one.split else None,
        "sentence": one.sentence,
    }

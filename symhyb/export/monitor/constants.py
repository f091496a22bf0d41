"""The numbers that a monitor in C is made with: sizes, the reference, and what decides."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.recorded.ends import END_KNOTS
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.recorded.splines import DEGREE
from symhyb.discrepancy.recorded.watching import watching_model
from symhyb.discrepancy.recorded.windows import (
    GAP,
    SAMPLES_LEAST,
    SLOW_SHARE,
    STILL,
    SWUNG,
    rates_of,
)
from symhyb.judgement import ACCURACY, FEW, OUTSTANDING, SIGNIFICANT
from symhyb.model.vocabulary import KINDS
from symhyb.monitoring.begun import Begun
from symhyb.monitoring.changes import EXCEEDED, LENGTHS, TILTS
from symhyb.monitoring.gauge import Gauge, amounts_of, phrase_of
from symhyb.monitoring.watching import NAMED_BLOCKS, NAMED_S, RIVALS_SAID
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.between import FINER
from symhyb.numeric.runs.window_steps import PIECES_MOST

MIDDLE = (0.3, 0.7, 15)  # of the rows by which a spline's deviation is judged


@dataclass(frozen=True, slots=True, eq=False)
class Constants:
    """``sizes`` and ``numbers`` by the names that the C code has for them, ``integers`` and
    ``arrays`` (flat, (R,) each, SI); the ``steep`` elements and the sensors of ``motion`` by their
    index; of every cause its words (``causes``), of every number of a cause its name, unit and the
    factor to that unit (``amounts``)."""

    sizes: Mapping[str, int]
    numbers: Mapping[str, float]
    integers: Mapping[str, Sequence[int]]
    arrays: Mapping[str, Array]
    steep: tuple[int, ...]
    motion: tuple[int, ...]
    causes: tuple[str, ...]
    amounts: tuple[tuple[str, str, float], ...]


def constants_of(begun: Begun) -> Constants:
    """The numbers of a monitor that begins with a reference."""
    gauge, run = begun.gauge, begun.gauge.prepared.runs[0]
    windows, library, machine = (
        gauge.setting.windows,
        gauge.setting.library,
        gauge.setting.windows.machine,
    )
    forces, free = sum(map(len, library.columns)), len(windows.free)
    rows = begun.rows // gauge.thinning
    steep, sharp = _sharp(gauge, run)
    shown = watching_model(machine.model, run.recording)[0].sensors
    motion = tuple(i for i, one in enumerate(machine.model.sensors) if one in shown)
    inputs, sensors, n = machine.model.inputs, machine.model.sensors, machine.n
    x, pieces = windows.form.size, _pieces(run, rows)
    smooth = [int(item.between == "smooth") for item in inputs]
    pairs = [len(own) for own in gauge.causes.columns]
    step = float(np.median(np.diff(run.recording.t)))
    kept = LENGTHS[-1] + max(NAMED_BLOCKS, int(np.ceil(NAMED_S / (rows * step)))) + 2
    sizes = {
        "N": rows,
        "ROWS": begun.rows,
        "THINNING": gauge.thinning,
        "N_Q": n,
        "N_U": len(inputs),
        "N_S": len(sensors),
        "N_M": len(motion),
        "N_X": x,
        "N_Z": machine.inner_states,
        "N_ZL": library.machine.inner_states,
        "N_D": windows.form.drive,
        "N_C": forces,
        "N_F": free,
        "N_COLUMNS": forces + free,
        "N_B": pieces + DEGREE,
        "N_SHARP": len(sharp),
        "N_RATE": len(steep),
        "SMOOTH_ANY": int(any(smooth)),
        "FINER": FINER,
        "FEW": FEW,
        "STEPS": run.steps,
        "FINE": run.fine,
        "PIECES": PIECES_MOST,
        "SAMPLES_LEAST": SAMPLES_LEAST,
        "END_KNOTS": END_KNOTS,
        "N_CAUSES": len(gauge.hypotheses),
        "N_PAIRS": sum(size**2 for size in pairs),
        "K_MOST": max(pairs),
        "N_BOUNDS": len(EXCEEDED),
        "N_LENGTHS": len(LENGTHS),
        "N_TILTS": len(TILTS),
        "LONGEST": LENGTHS[-1],
        "BLOCKS": begun.reference.count,
        "KEPT": kept,
        "NAMED_BLOCKS": NAMED_BLOCKS,
        "RIVALS": RIVALS_SAID,
    }
    numbers = {
        "SPACING_S": run.motion.spacing_s,
        "LENGTH_S": gauge.stage.length_s,
        "SLOW": SLOW_SHARE,
        "STILL": STILL,
        "SWUNG": SWUNG,
        "GAP": GAP,
        "ACCURACY": ACCURACY,
        "OUTSTANDING": OUTSTANDING,
        "SIGNIFICANT": SIGNIFICANT,
        "NAMED_S": NAMED_S,
        "LEAST": begun.least,
        **_unit(begun),
    }
    first = [0, *np.cumsum(pairs).tolist()]
    where = [0, *np.cumsum(np.square(pairs)).tolist()]
    gains = _gains(gauge, forces)
    middle = np.unique(np.linspace(MIDDLE[0] * rows, MIDDLE[1] * rows, MIDDLE[2]).astype(int))
    integers = {
        **({"SMOOTH": smooth} if any(smooth) else {}),
        **({"SHARP": sharp, "MIDDLE": middle.tolist()} if sharp else {}),
        "MOTION": motion,
        "LENGTHS": LENGTHS,
        "GAINS": gains,
        "COLUMN": [c for own in gauge.causes.columns for c in own],
        "FIRST": first,
        "PAIR": where,
        "KNOWN": begun.reference.known.astype(int).tolist(),
    }
    sizes |= {"N_MIDDLE": middle.size, "N_GAINS": len(gains), "N_NUMBERS": first[-1]}
    start = np.array(machine.model.start()[0])
    arrays = {
        "P": machine.values,
        "P_TRIED": library.machine.values,
        "START": start,
        "SD": gauge.setting.sd,
        "CENTRAL": _central(),
        "PRICE": gauge.causes.price,
        **_reference(begun),
    }
    causes = tuple(map(phrase_of, gauge.hypotheses))
    return Constants(
        sizes, numbers, integers, arrays, steep, motion, causes, _amounts(gauge, gauge.hypotheses)
    )


def _pieces(run: Run, rows: int) -> int:
    """The most pieces that a spline along so many rows has, times that jitter included."""
    step = float(np.median(np.diff(run.recording.t)))
    return max(round((rows - 1) * step / run.motion.spacing_s), 1) + 2


def _sharp(gauge: Gauge, run: Run) -> tuple[tuple[int, ...], list[int]]:
    """The elements with steep laws at places that have a direction, and what turns over: their
    rates by their order, and, if others act at points, the speeds (−1 − i) of all coordinates."""
    machine = gauge.setting.windows.machine
    found = [i for i, e in enumerate(machine.model.elements) if KINDS[e.kind].steep]
    if not found:
        return (), []
    rates, _ = rates_of(machine, run.motion)
    known = tuple(i for i in found if not np.isnan(rates[:, i]).all())
    speeds = [] if len(known) == len(found) else [-1 - i for i in range(machine.n)]
    return known, [*range(len(known)), *speeds]


def _gains(gauge: Gauge, forces: int) -> list[int]:
    """The columns of gains of channels."""
    return [forces + i for i, one in enumerate(gauge.setting.parametric) if one.kind == "gain"]


def _central() -> Array:
    """The variance of the d-th difference of white noise, C(2d, d), for d up to 10."""
    from scipy.special import comb

    return np.array([comb(2 * d, d) for d in range(11)])


def _unit(begun: Begun) -> dict[str, float]:
    """What the explained squares are counted in."""
    known = begun.reference.known
    scatter = begun.reference.scatter[known]
    return {"UNIT": float(np.median(scatter)) if scatter.size else 1.0}


def _reference(begun: Begun) -> dict[str, Array]:
    """The reference as the tests of a block need it."""
    reference, causes = begun.reference, begun.gauge.causes
    whole = np.diag(reference.information)
    before, variance = [], []
    for own in causes.columns:
        c = list(own)
        inverse = np.linalg.pinv(reference.information[np.ix_(c, c)], hermitian=True)
        before.append(inverse @ reference.score[c])
        variance.append(np.diag(inverse))
    clustered = [one.clustered(length) for one in reference.bounded for length in LENGTHS]
    return {
        "THETA": reference.score / np.where(whole > 0, whole, 1.0),
        "SCATTER": reference.scatter,
        "LARGEST": np.concatenate([one.most for one in reference.bounded]),
        "CUMULANT": np.concatenate([one.cumulants.reshape(-1) for one in reference.bounded]),
        "CLUSTERED": np.concatenate(clustered),
        "TILT": TILTS,
        "BEFORE": np.concatenate(before),
        "REFERENCE_VARIANCE": np.concatenate(variance),
    }


def _amounts(gauge: Gauge, causes: Sequence[Hypothesis]) -> tuple[tuple[str, str, float], ...]:
    """Name, unit and factor to it of every number of every cause."""
    rows = []
    for i, own in enumerate(gauge.causes.columns):
        one = np.ones(len(own))
        rows += [(a.name, a.unit, a.value) for a in amounts_of(gauge, i, one, one)]
    return tuple(rows)

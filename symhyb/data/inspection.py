"""What is peculiar about a recording, in sentences: sampling, missing samples, clipping, steps.

Nothing is changed here. Signals are in SI; the sentences use the units of the model.
"""

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from symhyb.data.channels import own_step
from symhyb.data.faults import at_limit, faulty, saturated
from symhyb.data.rows import blocks
from symhyb.units import Unit

UNEVEN = 1e-3  # of the median step: above that, sampling is called uneven
GAP = 5.0  # median steps
FEWEST_STEPS = 4  # between levels: fewer lie on a lattice by chance
MOSTLY = 0.9  # part of the samples that lie on the lattice of a converter
DENSE = 0.05  # part of the places of a lattice that are taken, if values beside it are allowed


def sampling_notes(t: NDArray[np.float64]) -> Iterator[str]:
    """Say whether the steps of ``t`` (N,) in s are uneven and where time is missing."""
    steps = np.diff(t)
    median = float(np.median(steps))
    yield from _gap_notes(t, median)
    usual = steps[steps <= GAP * median]
    shortest, longest = float(usual.min()), float(usual.max())
    if longest - shortest > UNEVEN * median:
        yield (
            f"sampling is uneven: steps of {shortest:.4g} to {longest:.4g} s,"
            f" median {median:.4g} s; kept as it is"
        )


def _gap_notes(t: NDArray[np.float64], step: float) -> Iterator[str]:
    gaps = np.flatnonzero(np.diff(t) > GAP * step)
    if gaps.size:
        places = [f"{t[k]:.6g} … {t[k + 1]:.6g} s" for k in gaps]
        noun = "a gap" if gaps.size == 1 else f"{gaps.size} gaps"
        yield f"{noun} in time: t = {_listed(places)} (step otherwise {step:.4g} s)"


def input_notes(
    inputs: Mapping[str, NDArray[np.float64]], units: Mapping[str, Unit]
) -> Iterator[str]:
    """Say which inputs, (N,) each in SI, never change; ``units`` are those of the model."""
    for name, values in inputs.items():
        if np.ptp(values) == 0.0:
            yield f"input {name} is constant at {_quantity(values[0], units[name])}"


def sensor_notes(
    t: NDArray[np.float64],
    sensors: Mapping[str, NDArray[np.float64]],
    units: Mapping[str, Unit],
) -> Iterator[str]:
    """Say for every sensor what is missing, constant, clipped or coarse.

    ``sensors`` are (N,) each in SI, NaN where a sample is missing; ``t`` (N,) in s; the sentences
    are in ``units``.
    """
    for name, values in sensors.items():
        missing = np.isnan(values)
        step = own_step(values, t)
        if step is not None:
            yield _rate_note(name, step, t)
            for note in _gap_notes(t[~missing], step):
                yield f"sensor {name}: {note}"
        elif missing.any():
            yield _missing_note(name, missing, t)
        present = values[~missing]
        if np.ptp(present) == 0.0:
            yield f"sensor {name} is constant at {_quantity(present[0], units[name])}"
            continue
        yield from _clipping_notes(name, values, t, units[name])
        yield from _sample_notes(name, values, t)
        grain = lattice_step(present)
        if grain is not None:
            steps, noise = (_quantity(x, units[name]) for x in (grain, grain / np.sqrt(12.0)))
            yield f"sensor {name} is quantised in steps of {steps} (noise at least {noise})"


def _rate_note(name: str, step: float, t: NDArray[np.float64]) -> str:
    rows = 1 / np.median(np.diff(t))
    return f"sensor {name}: {1 / step:.4g} Hz beside rows at {rows:.4g} Hz; missing in between"


def _missing_note(name: str, missing: NDArray[np.bool_], t: NDArray[np.float64]) -> str:
    holes = blocks(missing)
    longest = max(holes, key=lambda hole: hole.size)
    text = f"sensor {name}: {missing.sum()} of {missing.size} samples are missing"
    if longest.size == 1:
        return f"{text}, one at a time, first at {longest.span(t)}"
    length = t[min(longest.last + 1, t.size - 1)] - t[longest.first]
    return f"{text}; the longest block lasts {length:.4g} s, {longest.span(t)}"


def _clipping_notes(
    name: str, values: NDArray[np.float64], t: NDArray[np.float64], unit: Unit
) -> Iterator[str]:
    """Say where a sensor stands still at its very extreme, as it does when it is saturated."""
    stuck = saturated(values)
    for upper, word in ((True, "maximum"), (False, "minimum")):
        limit = at_limit(values, upper)
        if not limit.any():
            continue
        runs = blocks(limit)
        extreme, longest = values[limit][0], max(runs, key=lambda run: run.size)
        why = "it is saturated there" if (stuck & limit).any() else "saturated or at rest there"
        yield (
            f"sensor {name} stands at its {word} of {_quantity(extreme, unit)} in"
            f" {100 * limit.sum() / values.size:.2g} % of the samples"
            f" (longest: {longest.span(t)}); {why}"
        )


def _sample_notes(name: str, values: NDArray[np.float64], t: NDArray[np.float64]) -> Iterator[str]:
    """Say which samples a sensor got wrong one by one."""
    for words, flags in faulty(values):
        if words != "is saturated":
            yield (
                f"sensor {name} {words}: {flags.sum()} of {flags.size} samples, first at "
                f"{blocks(flags)[0].span(t)}"
            )


def lattice_step(values: NDArray[np.float64]) -> float | None:
    """Return the step of the lattice on which nearly all ``values`` lie, None if there is none.

    ``values`` (N,) without NaN; the step is in their unit.

    A converter of b bits gives x = x_0 + i·step with whole i. Steps below 1e-6 of the range are
    not looked for: there the digits of the file itself are the lattice. A few values beside the
    lattice (samples that a logger filled in, say) do not hide it.
    """
    levels, counts = np.unique(values, return_counts=True)
    whole = _exact_step(levels)
    if whole is not None or counts.max() == 1:
        return whole
    # A level that is reached once may be a stray; those of the converter are met again and again.
    met = levels[counts > 1]
    step = _exact_step(met)
    if step is None or counts[counts > 1].sum() < MOSTLY * values.size:
        return None
    return step if met.size >= DENSE * (met[-1] - met[0]) / step else None


def _exact_step(levels: NDArray[np.float64]) -> float | None:
    """Return the step of the lattice on which all sorted ``levels`` lie, None if there is none."""
    if levels.size < 2:
        return None
    span = levels[-1] - levels[0]
    differences = np.diff(levels)
    differences = differences[differences > 1e-9 * span]
    if differences.size < FEWEST_STEPS or differences.min() < 1e-6 * span:
        return None
    counts = np.round(differences / differences.min())
    step = float(differences.sum() / counts.sum())
    off = np.abs(differences - np.round(differences / step) * step)
    return step if off.max() < 0.02 * step else None


def _quantity(value: float, unit: Unit) -> str:
    text = f"{value / unit.factor + 0.0:.4g}"  # + 0.0: minus zero is written as zero
    return text if unit.text == "1" else f"{text} {unit.text}"


def _listed(places: list[str], most: int = 3) -> str:
    more = f" and {len(places) - most} more" if len(places) > most else ""
    return ", ".join(places[:most]) + more

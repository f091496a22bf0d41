"""Maximum likelihood of the noise model: how much an unknown force acts, how the sensors rustle.

The size of the unknown force plays the part of a window's length: none is a free run, a large one
lets the state be measured anew all the time. Sizes: n coordinates, m sensors.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from symhyb.deadline import require_time
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import (
    Smoothed,
    Track,
    effective,
    log_likelihood,
    showing,
    smoothed,
    still,
)
from symhyb.numeric.kernels.buffers import Array

SMALLEST = 1e-6  # of its scale: a size below is none
MEMORY = (0.5, 2e3)  # bounds of a correlation time, in samples
ITERATIONS, ITERATIONS_ROUGH = 40, 6
FORGOTTEN = 1e-3  # of a sample: the memory of a force that has none
ROUNDS = 4  # of a few steps each, for the sizes of a force without a memory
GAIN_LEAST, GAIN_ROUGH = 0.01, 1.0  # of ln L: a step that gains less is the last


@dataclass(frozen=True, slots=True, eq=False)
class _Coding:
    """Which sizes of a noise model are free, and its numbers as logarithms."""

    base: NoiseModel
    forces: NDArray[np.bool_]
    colours: NDArray[np.bool_]
    timed: bool = True

    @property
    def times(self) -> tuple[bool, bool]:
        """Whether the correlation times of force and colour are free."""
        timed = self.timed
        return timed and bool(self.forces.any()), timed and bool(self.colours.any())

    def numbers(self) -> Array:
        """ln of the free sizes and times."""
        base, (by_force, by_colour) = self.base, self.times
        parts = [base.white, base.force[self.forces], base.colour[self.colours]]
        parts += [np.array([base.memory_s])] if by_force else []
        parts += [np.array([base.colour_s])] if by_colour else []
        return np.asarray(np.log(np.concatenate(parts)))

    def model(self, z: Array) -> NoiseModel:
        """The noise model of these numbers."""
        values = np.exp(z)
        m, f, c = self.base.white.size, int(self.forces.sum()), int(self.colours.sum())
        force, colour = np.zeros(self.forces.size), np.zeros(m)
        force[self.forces] = values[m : m + f]
        colour[self.colours] = values[m + f : m + f + c]
        rest, (by_force, by_colour) = list(values[m + f + c :]), self.times
        memory = rest.pop(0) if by_force else self.base.memory_s
        held = rest.pop(0) if by_colour else self.base.colour_s
        return NoiseModel(force, float(memory), values[:m], colour, float(held))


def total(tracks: Sequence[Track], noise: NoiseModel) -> float:
    """ln L of all tracks."""
    return sum(log_likelihood(one, noise) for one in tracks)


def maximised(
    tracks: Sequence[Track],
    begin: NoiseModel,
    floor: Array,
    *,
    force: bool = True,
    colour: bool = True,
    roughly: bool = False,
    within: float = 0.0,
) -> tuple[NoiseModel, float]:
    """The most likely noise model from ``begin`` on, and its ln L; sizes of ``begin`` that are 0
    stay 0, as do all of the unknown ``force`` or of the ``colour`` where these are not asked for.
    ``floor`` (m,) is the least white noise, SI. ``roughly``: a few steps of the sizes alone. A step
    that gains less than ``within``, in ln L, is the last."""
    acting = effective(tracks) & (begin.force > 0) & force
    tinted = (begin.colour > 0) & colour & showing(tracks)
    base = NoiseModel(
        np.where(acting, begin.force, 0.0),
        begin.memory_s,
        np.maximum(begin.white, floor),
        np.where(tinted, begin.colour, 0.0),
        begin.colour_s,
    )
    coding = _Coding(base, acting, tinted, timed=not roughly)
    z, bounds = coding.numbers(), _bounds(coding, tracks, floor)
    z = np.clip(z, *np.array(bounds).T)

    here = total(tracks, coding.model(z))
    if not np.isfinite(here):
        return base, -np.inf
    found = minimize(
        lambda z: _cost(coding, tracks, z),
        z,
        jac=True,
        method="L-BFGS-B",
        bounds=bounds,
        options={
            "maxiter": ITERATIONS_ROUGH if roughly else ITERATIONS,
            "ftol": max(within, GAIN_ROUGH if roughly else GAIN_LEAST) / max(abs(here), 1.0),
        },
    )
    best = coding.model(found.x)
    return (best, -float(found.fun)) if roughly else _pruned(tracks, best, -float(found.fun))


def memoryless(
    tracks: Sequence[Track], begin: NoiseModel, floor: Array, step_s: float
) -> tuple[NoiseModel, float]:
    """The most likely noise model with an unknown force that does not know its last sample, and
    its ln L: of the same power as ``begin`` at low frequencies at first. ``floor`` (m,) is the
    least white noise, SI. Samples lie ``step_s`` apart."""
    noise = replace(
        begin,
        force=begin.force * np.sqrt(max(2 * begin.memory_s / step_s, 1.0)),
        memory_s=FORGOTTEN * step_s,
    )
    logl = -np.inf
    for _ in range(ROUNDS):
        noise, logl = maximised(tracks, noise, floor, roughly=True)
    return noise, logl


def _cost(coding: _Coding, tracks: Sequence[Track], z: Array) -> tuple[float, Array]:
    """−ln L and its gradient by the logarithms."""
    require_time()
    noise = coding.model(z)
    parts = [smoothed(one, noise, still(one), wanted=False) for one in tracks]
    here = sum(part.logl for part in parts)
    if not np.isfinite(here):
        return 1e300, np.zeros_like(z)
    return -here, -_slopes(coding, noise, parts)


def _slopes(coding: _Coding, noise: NoiseModel, parts: Sequence[Smoothed]) -> Array:
    """∂ ln L by the logarithms of the free sizes and times."""
    white = sum(part.by_white for part in parts) * 2 * noise.white**2
    force = sum(part.by_force for part in parts) * 2 * noise.force**2
    colour = sum(part.by_colour for part in parts) * 2 * noise.colour**2
    times = np.sum([part.by_times for part in parts], axis=0)[list(coding.times)]
    return np.concatenate([white, force[coding.forces], colour[coding.colours], times])


def _bounds(coding: _Coding, tracks: Sequence[Track], floor: Array) -> list[tuple[float, float]]:
    """Bounds of the logarithms."""
    base = coding.base
    step = float(np.median(np.concatenate([one.step_s for one in tracks])))
    white = [(np.log(f), np.log(1e6 * max(w, f))) for w, f in zip(base.white, floor, strict=True)]
    sizes = [*base.force[coding.forces], *base.colour[coding.colours]]
    rows = white + [(np.log(SMALLEST * s), np.log(s / SMALLEST)) for s in sizes]
    times = (np.log(MEMORY[0] * step), np.log(MEMORY[1] * step))
    return rows + [times] * sum(coding.times)


def _pruned(tracks: Sequence[Track], best: NoiseModel, logl: float) -> tuple[NoiseModel, float]:
    """Without sizes that are not worth their price, ½ ln N each (Schwarz 1978): forces first, each
    by itself."""
    count = max(sum(one.count for one in tracks), 2)
    for kind in ("force", "colour"):
        for i in np.flatnonzero(getattr(best, kind)):
            sizes = getattr(best, kind).copy()
            sizes[i] = 0.0
            values = {"force": best.force, "colour": best.colour, kind: sizes}
            trial = NoiseModel(
                values["force"], best.memory_s, best.white, values["colour"], best.colour_s
            )
            there = total(tracks, trial)
            if there > logl - 0.5 * (best.numbers - trial.numbers) * np.log(count):
                best, logl = trial, there
    return best, logl

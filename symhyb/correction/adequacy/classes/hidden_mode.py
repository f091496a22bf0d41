"""A mass on a spring and a damper at a place, in the coordinates of no one."""

from dataclasses import replace

import numpy as np
from scipy.signal import cont2discrete, lfilter, ss2tf

from symhyb.correction.adequacy.classes.columns import motions, pushing, without_span
from symhyb.correction.adequacy.classes.worth import Around, best_of, worths_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Generic
from symhyb.numeric.kernels.buffers import Array

MODES = 40  # frequencies that are tried
FINER = 7  # and then between the neighbours of the best
IN_BAND = 0.999  # of the power of an acceleration
DAMPINGS = (0.02, 0.2)
HALVES = np.array([0.5, 1.0, 2.0])  # of the better damping, that are tried then
NEIGHBOURS = np.array([0.94, 1.0, 1.06])  # of the frequency: what it is off by


def hidden_mode(start: Around, which: int) -> Generic:
    """What the likeliest mode presses and drags with: the best of many frequencies and dampings,
    sought once more between the neighbours of the best, with those beside it, and a spring and a
    damper; at rest or in motion when a stretch begins. On a motion of almost one frequency a mode
    does what these do, and only what it does besides shows it."""
    recorded = start.recorded
    low, high = band(recorded, which)
    lines, ratio = np.geomspace(low, high, MODES), (high / low) ** (1 / (MODES - 1))
    _, line, damping = max(_likeliest(start, which, lines, one) for one in DAMPINGS)
    near, nearly = line * np.geomspace(1 / ratio, ratio, FINER), damping * HALVES
    _, line, damping = max(_likeliest(start, which, near, one) for one in nearly)
    forces = _forces(recorded, which, line * NEIGHBOURS, damping)
    free = _free(recorded, which, line, damping)
    moving = [np.concatenate(pair, axis=2) for pair in zip(forces, free, strict=True)]
    place = recorded.library.places[which]
    options = [pushing(recorded, "hidden mode", place, one, line) for one in (forces, moving)]
    likeliest = best_of(start, options)
    tried = lines.size * len(DAMPINGS) + near.size * nearly.size
    return replace(likeliest, tried=tried * likeliest.tried)


def _likeliest(
    start: Around, which: int, lines: Array, damping: float
) -> tuple[float, float, float]:
    """What the best mode of some frequencies (Hz) is worth, its frequency, and the damping."""
    groups = [[0, 1, 2 + 2 * i, 3 + 2 * i] for i in range(lines.size)]
    forces = _forces(start.recorded, which, lines, damping)
    gains = worths_of(start, pushing(start.recorded, "hidden mode", "", forces), groups)
    i = int(np.argmax(gains))
    return float(gains[i]), float(lines[i]), damping


def band(recorded: Recorded, which: int) -> tuple[float, float]:
    """The frequencies, Hz, between which a mode could show at a place: up to an octave above where
    almost all power of its acceleration lies. A mode above only adds stiffness and mass."""
    low, high = 0.3 / recorded.period_s, 0.4 / recorded.step_s
    ends = []
    for item, (s, _, _) in zip(recorded.items, motions(recorded), strict=True):
        t = item.block.t[0]
        push = np.gradient(np.gradient(s[:, which], t), t) * np.hanning(t.size)
        power = np.cumsum(np.abs(np.fft.rfft(push)) ** 2)
        line = np.searchsorted(power, IN_BAND * power[-1])
        ends.append(2 * float(line / (t.size * recorded.step_s)))
    return low, min(max([*ends, 2 * low]), high)


def _forces(recorded: Recorded, which: int, lines: Array, damping: float) -> list[Array]:
    """Columns (N, n, 2 + 2L): of a spring and a damper, and two for each frequency (Hz), what a
    mode that the acceleration of the place drives presses and drags with besides."""
    simple, toward = [], []
    for s, r, directions in motions(recorded):
        simple.append(np.stack([s[:, which] - s[:, which].mean(), r[:, which]], axis=1))
        toward.append(directions[:, :, which, None])
    modes = swings(recorded, which, lines, damping)
    parts = zip(toward, simple, without_span(modes, simple), strict=True)
    return [d * np.concatenate([a, b], axis=1)[:, None] for d, a, b in parts]


def swings(recorded: Recorded, which: int, lines: Array, damping: float) -> list[Array]:
    """Of a mass that rides on a place, from rest and for each frequency (Hz), ω² e and ω e′ of its
    elongation e, side by side (N, 2L), SI: e″ + 2ζω e′ + ω² e = s″."""
    found = []
    for item, (s, _, _) in zip(recorded.items, motions(recorded), strict=True):
        t, stretch = item.block.t[0], s[:, which] - s[:, which].mean()
        drive = np.gradient(np.gradient(stretch, t), t)
        columns = []
        for line in lines:
            w = 2 * np.pi * line
            A = np.array([[0.0, 1.0], [-(w**2), -2 * damping * w]])
            state = _driven(A, np.array([[0.0], [1.0]]), drive, recorded.step_s)
            columns += [w**2 * state[:, 0], w * state[:, 1]]
        found.append(np.stack(columns, axis=1))
    return found


def _free(recorded: Recorded, which: int, line: float, damping: float) -> list[Array]:
    """Columns (N, n, 2S): what a mode of a frequency (Hz) does that was in motion when a stretch
    began, two for each of the S stretches."""
    found, w = [], 2 * np.pi * line
    parts = list(zip(recorded.items, motions(recorded), strict=True))
    for i, (item, (_, _, directions)) in enumerate(parts):
        since = item.block.t[0] - item.block.t[0, 0]
        columns = np.zeros((since.size, 2 * len(parts)))
        swing = np.exp((-damping + 1j * np.sqrt(1 - damping**2)) * w * since)
        columns[:, 2 * i], columns[:, 2 * i + 1] = swing.real, swing.imag
        found.append(directions[:, :, which, None] * columns[:, None])
    return found


def _driven(A: Array, B: Array, drive: Array, step: float) -> Array:
    """States (N, 2) of x' = A x + B u from rest, the drive (N,) straight between samples."""
    discrete = cont2discrete((A, B, np.eye(2), np.zeros((2, 1))), step, "foh")[:4]
    rows, denominator = ss2tf(*discrete)
    return np.stack([lfilter(row, denominator, drive) for row in rows], axis=1)

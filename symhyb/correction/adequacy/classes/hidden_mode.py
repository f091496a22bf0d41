"""A mass on a spring and a damper at a place, in the coordinates of no one."""

from dataclasses import replace

import numpy as np
from scipy.signal import cont2discrete, lfilter, ss2tf

from symhyb.correction.adequacy.classes.columns import motions, pushing, without_span
from symhyb.correction.adequacy.classes.worth import Around, worths_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Generic
from symhyb.numeric.kernels.buffers import Array

MODES = 40  # frequencies that are tried
IN_BAND = 0.999  # of the power of an acceleration
DAMPINGS = (0.02, 0.2)


def hidden_mode(start: Around, which: int) -> Generic:
    """What the likeliest mode presses and drags with: the best of many frequencies, with its
    neighbours, beside a spring and a damper. On a motion of almost one frequency a mode does what
    these do, and only what it does besides shows it."""
    recorded = start.recorded
    lines = np.geomspace(*_band(recorded, which), MODES)
    groups = [[0, 1, 2 + 2 * i, 3 + 2 * i] for i in range(MODES)]
    found = []
    for damping in DAMPINGS:
        tried = pushing(recorded, "hidden mode", "", _forces(recorded, which, lines, damping))
        gains = worths_of(start, tried, groups)
        i = int(np.argmax(gains))
        found.append((float(gains[i]), float(lines[i]), damping))
    _, line, damping = max(found, key=lambda one: one[0])
    forces = _forces(recorded, which, line * np.array([0.94, 1.0, 1.06]), damping)
    made = pushing(recorded, "hidden mode", recorded.library.places[which], forces, line)
    return replace(made, tried=MODES * len(DAMPINGS))


def _band(recorded: Recorded, which: int) -> tuple[float, float]:
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
    simple, modes, toward = [], [], []
    for item, (s, r, directions) in zip(recorded.items, motions(recorded), strict=True):
        t, stretch = item.block.t[0], s[:, which] - s[:, which].mean()
        drive = np.gradient(np.gradient(stretch, t), t)
        columns = []
        for line in lines:
            w = 2 * np.pi * line
            A = np.array([[0.0, 1.0], [-(w**2), -2 * damping * w]])
            state = _driven(A, np.array([[0.0], [1.0]]), drive, recorded.step_s)
            columns += [w**2 * state[:, 0], w * state[:, 1]]
        simple.append(np.stack([stretch, r[:, which]], axis=1))
        modes.append(np.stack(columns, axis=1))
        toward.append(directions[:, :, which, None])
    parts = zip(toward, simple, without_span(modes, simple), strict=True)
    return [d * np.concatenate([a, b], axis=1)[:, None] for d, a, b in parts]


def _driven(A: Array, B: Array, drive: Array, step: float) -> Array:
    """States (N, 2) of x' = A x + B u from rest, the drive (N,) straight between samples."""
    discrete = cont2discrete((A, B, np.eye(2), np.zeros((2, 1))), step, "foh")[:4]
    rows, denominator = ss2tf(*discrete)
    return np.stack([lfilter(row, denominator, drive) for row in rows], axis=1)

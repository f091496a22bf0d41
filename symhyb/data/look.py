"""What is in a recording: rates, ranges, noise, rest and frequencies of every channel.

Nothing is changed and nothing is decided here. Sizes: N samples.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.data.channels import own_step
from symhyb.data.inspection import GAP, UNEVEN, lattice_step
from symhyb.data.recording import Recording
from symhyb.data.rows import blocks

Array = NDArray[np.float64]

FEWEST = 32  # samples that show noise or frequencies
REST_SAMPLES = 10  # that a rest lasts at least
REST_SHARE = 0.01  # of the recording, that a rest lasts at least
REST_ROOM = 1.0  # deviations of the noise, beyond the range of as many Gaussian samples
PEAKS = 3  # frequencies that are named
ABOVE = 10.0  # times what is around it: a peak
NEIGHBOURS = 12  # lines of a spectrum that are around a peak, to either side
AVERAGED = 6  # stretches over which a spectrum is averaged
DEVIATION = 1.4826  # of a Gaussian, over the median of its absolute value
CUBIC = np.sqrt(35 / 18)  # deviation of a sample from the cubic through its neighbours, over noise


@dataclass(frozen=True, slots=True)
class Peak:
    """A line of a spectrum: its ``frequency`` in Hz and its ``share`` of the variance."""

    frequency: float
    share: float


@dataclass(frozen=True, slots=True, eq=False)
class Signal:
    """One channel in its unit: ``values`` (N,), NaN where there is none; from ``low`` to ``high``
    with ``mean`` and ``deviation``; ``rate`` in Hz.

    ``noise`` is one standard deviation of what is different from sample to sample: white noise,
    and motion that the rate hardly resolves, so that it is a bound; None where that is unknown.
    ``grain`` is the step of its converter, None if there is none; ``rest`` the spans in s in which
    it does not move.
    """

    name: str
    unit: str
    values: Array
    low: float
    high: float
    mean: float
    deviation: float
    missing: int
    rate: float
    noise: float | None
    grain: float | None
    rest: tuple[tuple[float, float], ...]
    peaks: tuple[Peak, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """A recording as it is: ``t`` (N,) in s, the usual ``step`` in s, by how much steps differ from
    it (``jitter``, one deviation as a share of it), and ``gaps`` in s."""

    name: str
    t: Array
    step: float
    jitter: float
    gaps: tuple[tuple[float, float], ...]
    signals: tuple[Signal, ...]
    notes: tuple[str, ...]

    @property
    def even(self) -> bool:
        """Whether all steps but those over gaps are the same."""
        return self.jitter <= UNEVEN


def look_at(recording: Recording, units: Mapping[str, str | None]) -> Look:
    """Say what is in a recording whose channels are in ``units``, by name."""
    t = recording.t
    steps = np.diff(t)
    step = float(np.median(steps))
    over = np.flatnonzero(steps > GAP * step)
    usual = steps[steps <= GAP * step]
    channels = {**recording.inputs, **recording.sensors}
    return Look(
        recording.name,
        t,
        step,
        float(np.std(usual)) / step,
        tuple((float(t[k]), float(t[k + 1])) for k in over),
        tuple(signal_of(name, units.get(name) or "", t, y) for name, y in channels.items()),
        recording.notes,
    )


def signal_of(name: str, unit: str, t: Array, values: Array) -> Signal:
    """What one channel (N,), in its unit, shows at the times ``t`` (N,) in s."""
    known = np.isfinite(values)
    own, at = values[known], t[known]
    step = own_step(values, t) or float(np.median(np.diff(at if at.size > 1 else t)))
    noise = noise_of(own) if own.size >= FEWEST else None
    constant = float(np.ptp(own)) == 0.0
    return Signal(
        name,
        unit,
        values,
        float(own.min()),
        float(own.max()),
        float(own.mean()),
        float(own.std()),
        0 if own_step(values, t) else int((~known).sum()),
        1 / step,
        noise,
        lattice_step(own) if not constant else None,
        tuple(rests(at, own, noise)) if noise is not None and not constant else (),
        peaks_of(at, own, step) if own.size >= FEWEST and not constant else (),
    )


def noise_of(values: Array) -> float:
    """One standard deviation, in the unit of ``values`` (N,), of the white noise on a smooth signal
    from what deviates from the cubic through its neighbours,

    e_i = y_i − (−y_{i−2} + 4 y_{i−1} + 4 y_{i+1} − y_{i+2})/6,

    whose variance is (1 + 34/36) σ². Its median is that of the larger part of the samples, so that
    jumps do not count."""
    y = values
    e = y[2:-2] - (-y[:-4] + 4 * y[1:-3] + 4 * y[3:-1] - y[4:]) / 6
    return float(DEVIATION * np.median(np.abs(e)) / CUBIC)


def rests(t: Array, values: Array, noise: float) -> Iterator[tuple[float, float]]:
    """Spans in s in which a channel (N,), in its unit, stays within its ``noise``, for longer than
    it takes to turn round when it moves; ``t`` (N,) s."""
    size = max(REST_SAMPLES, int(REST_SHARE * values.size), int(_half_period(values)))
    if values.size < 2 * size:
        return
    reach = (2 * np.sqrt(2 * np.log(size)) + REST_ROOM) * noise + 1e-9 * float(np.ptp(values))
    hop = max(size // 4, 1)
    windows = np.lib.stride_tricks.sliding_window_view(values, size)[::hop]
    calm = np.ptp(windows, axis=1) <= reach
    for run in blocks(calm):
        yield float(t[run.first * hop]), float(t[run.last * hop + size - 1])


def _half_period(values: Array) -> float:
    """Samples between two crossings of the mean by half a deviation, on the average."""
    away = values - values.mean()
    sides = away[np.abs(away) > away.std() / 2] > 0
    return values.size / (1 + np.count_nonzero(sides[1:] != sides[:-1]))


def spectrum_of(t: Array, values: Array, step: float) -> tuple[Array, Array]:
    """Frequencies (M,) in Hz and the power (M,), in the square of the unit per line, of a channel
    (N,) at ``t`` (N,) in s, put on even times ``step`` apart; averaged over half-overlapping
    stretches under Hann windows."""
    even = np.arange(t[0], t[-1] + step / 2, step)
    y = np.interp(even, t, values)
    size = max(int(2 * y.size / (AVERAGED + 1)), min(y.size, FEWEST))
    window = np.hanning(size + 1)[:-1]
    starts = range(0, y.size - size + 1, max(size // 2, 1))
    power = np.zeros(size // 2 + 1)
    for start in starts:
        part = y[start : start + size]
        power += np.abs(np.fft.rfft(window * (part - part.mean()))) ** 2
    power[1 : (size + 1) // 2] *= 2  # both signs of a frequency
    frequency = np.asarray(np.fft.rfftfreq(size, step), np.float64)
    return frequency, power / len(starts) / (size * np.sum(window**2))


def peaks_of(t: Array, values: Array, step: float) -> tuple[Peak, ...]:
    """The lines that stand out of the spectrum of a channel (N,) at ``t`` (N,) in s, strongest
    first."""
    frequency, power = spectrum_of(t, values, step)
    total = float(power.sum())
    if frequency.size < 8 or total <= 0:
        return ()
    found = []
    inner = np.arange(1, power.size - 1)
    tops = inner[(power[inner] > power[inner - 1]) & (power[inner] >= power[inner + 1])]
    for k in tops:
        around = np.r_[power[max(k - NEIGHBOURS, 1) : max(k - 2, 1)], power[k + 3 : k + NEIGHBOURS]]
        if around.size and power[k] > ABOVE * np.median(around):
            share = float(power[max(k - 2, 0) : k + 3].sum()) / total
            found.append(Peak(float(frequency[k]), share))
    strong = sorted(found, key=lambda one: -one.share)[:PEAKS]
    return tuple(one for one in strong if one.share > 0.01)

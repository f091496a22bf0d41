"""Frequency responses of a recording beside those of a simulation, and how far they are linear.

The same estimator is applied to what was measured and what was simulated under the same inputs, so
leakage and window are the same in both. One periodic drive: its own lines over the settled periods.
Any other excitation: H = S_uu⁻¹ s_uy over Hann windows that
overlap by half (Welch), all inputs together, with the multiple coherence γ². Sources: Bendat and
Piersol, Random Data, ch. 7; for the split :mod:`symhyb.discrepancy.checks.split`.
Sizes: N samples, k inputs, F frequencies.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.checks.split import Split, excited_lines, period_of, settled_lines, split_of
from symhyb.discrepancy.words.wording import joined, number_text, percent_text, small_text
from symhyb.judgement import EXCITED, NEGLIGIBLE, NOTABLE, SAMPLES_TELL
from symhyb.numeric.kernels.buffers import Array

Complex = NDArray[np.complex128]
SEGMENTS = 8  # lengths of a window in a recording: 15 windows that overlap by half


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """Responses of one ``sensor`` to the ``drives`` at ``frequency`` (F,) in Hz, where these excite
    the machine: ``measured`` (F, k) complex, SI, the same of every simulated run in ``simulated``
    by its name (``model``, ``corrected``), ``coherence`` (F,) 0 … 1; ``unexplained`` is the share
    of the sensor's power there that is no linear function of the drives, ``apart`` by run the
    power of what the simulated response differs by, over that of the measured one;
    ``split`` where the drive is periodic."""

    sensor: str
    drives: tuple[str, ...]
    frequency: Array
    measured: Complex
    simulated: Mapping[str, Complex]
    coherence: Array
    unexplained: float
    apart: Mapping[str, float]
    unit: str
    split: Split | None = None

    @property
    def sentence(self) -> str:
        """What the responses say in words."""
        ends = [number_text(float(self.frequency[i]), digits=3) for i in (0, -1)]
        band = " … ".join(dict.fromkeys(ends))
        said = (
            f"{self.sensor} from {joined(self.drives)}, {band} Hz: median coherence "
            f"{number_text(float(np.median(self.coherence)), digits=2)}, "
            f"{percent_text(self.unexplained)} of its power is no linear response"
        )
        missed = [f"{name} {percent_text(share)}" for name, share in self.apart.items()]
        said += f"; error of the simulated response: {joined(missed)}" if missed else ""
        if self.split is None:
            return f"{said}; the drive is not periodic, so noise and nonlinearity stay together"
        return f"{said}; {self._parts(self.split)}"

    def _parts(self, split: Split) -> str:
        """The split in words, RMS in the sensor's unit."""
        named = {
            "linear": split.linear,
            "noise": split.noise,
            "nonlinear": split.nonlinear,
            "transient": split.transient,
        }
        parts = [
            f"{name} {small_text(value, self.unit, digits=2)}" for name, value in named.items()
        ]
        if split.even is not None and split.odd is not None and split.nonlinear > 0:
            parts[2] += f" ({'even' if split.even > split.odd else 'odd'} orders lead)"
        return f"over {split.periods} periods (RMS) {joined(parts)}"


@dataclass(frozen=True, slots=True, eq=False)
class Driven:
    """What drives a machine on an even grid: ``t`` (N,) s, ``u`` (N, k) SI by ``names``."""

    t: Array
    u: Array
    names: tuple[str, ...]
    step: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "step", float(self.t[1] - self.t[0]))


def driven(t: Array, drives: Mapping[str, Array]) -> Driven | str:
    """The recorded drives (N,), SI, at times (N,), s, on an even grid, without those
    that do not change; or why there are no frequency responses."""
    moving = {name: u for name, u in drives.items() if float(np.ptp(u)) > 0}
    if not moving:
        return "nothing that changes drives the machine in this recording"
    if t.size < SAMPLES_TELL * SEGMENTS / 2:
        return f"{t.size} samples are too few for windows of a frequency response"
    even = np.linspace(t[0], t[-1], t.size)
    columns = np.column_stack([np.interp(even, t, u) for u in moving.values()])
    return Driven(even, columns, tuple(moving))


def response_of(
    by: Driven,
    t: Array,
    sensor: tuple[str, Array, str, float],
    simulated: Mapping[str, Array],
) -> Response | str:
    """The frequency response of one ``sensor`` (name, samples (N,) at ``t`` in SI, unit and its
    factor), and of simulated runs of it (N,) by name; or why there is none."""
    name, values, unit, factor = sensor
    seen = np.isfinite(values)
    if np.mean(~seen) > NOTABLE:
        return f"{percent_text(float(np.mean(~seen)))} of the samples of {name} are missing"
    y = np.interp(by.t, t[seen], values[seen])
    runs = {
        run: np.interp(by.t, t, one) for run, one in simulated.items() if np.isfinite(one).all()
    }
    outputs = (y, *runs.values())
    period = period_of(by.u)
    split = None if period is None else split_of(by.u, y / factor, period)
    lines = by.u.shape[1] == 1 and period is not None
    spectra = _periodic(by, outputs, period) if lines and period else _spectra(by, outputs)
    if spectra is None:
        return f"{joined(by.names)} follow from each other: their effects cannot be parted"
    if not spectra.frequency.size:
        return "nothing in the drive swings"
    measured, others = spectra.gains[0], dict(zip(runs, spectra.gains[1:], strict=True))
    size = max(spectra.weight(measured), 1e-300)
    return Response(
        name,
        by.names,
        spectra.frequency,
        measured,
        others,
        spectra.coherence,
        spectra.unexplained,
        {run: spectra.weight(one - measured) / size for run, one in others.items()},
        unit,
        split,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Spectra:
    """Frequencies (F,), responses ``gains`` of all outputs, each (F, k), powers of the ``inputs``
    (F, k, k), and of the first output the coherence (F,) and the share that is not linear."""

    frequency: Array
    gains: list[Complex]
    inputs: Complex
    coherence: Array
    unexplained: float

    def weight(self, gain: Complex) -> float:
        """The power of an output that has this response (F, k)."""
        return float(np.einsum("fi,fij,fj->", gain.conj(), self.inputs, gain).real)


def _periodic(by: Driven, outputs: Sequence[Array], period: int) -> _Spectra:
    """Responses at the lines that one periodic drive excites, over its settled periods."""
    u = settled_lines(by.u[:, 0], period)
    drive = u.mean(axis=0)
    excited = excited_lines(drive)
    frequency = np.arange(drive.size) / (period * by.step)
    gains = [settled_lines(y, period).mean(axis=0)[excited] / drive[excited] for y in outputs]
    first = settled_lines(outputs[0], period)[:, 1:]
    power = np.abs(first.mean(axis=0)) ** 2
    noise = np.var(first, axis=0, ddof=1)
    whole = np.maximum(power + noise, 1e-300)
    linear = float(np.sum(power[excited[1:]]))
    return _Spectra(
        frequency[excited],
        [gain[:, None] for gain in gains],
        (np.abs(drive[excited]) ** 2 + 0j)[:, None, None],
        (power / whole)[excited[1:]],
        1 - linear / float(np.sum(whole)),
    )


def _spectra(by: Driven, outputs: Sequence[Array]) -> _Spectra | None:
    """Responses where the drives excite the machine, by Welch's method; None where one drive
    follows from the others."""
    from scipy.signal import csd, welch

    k, length = by.u.shape[1], max(by.u.shape[0] // SEGMENTS, 8)
    options = {"fs": 1 / by.step, "nperseg": length, "detrend": "constant"}
    frequency, whole = welch(outputs[0], **options)
    inputs = np.empty((frequency.size, k, k), dtype=complex)
    for i in range(k):
        for j in range(k):
            inputs[:, i, j] = csd(by.u[:, i], by.u[:, j], **options)[1]
    powers = np.einsum("fii->fi", inputs).real
    scale = np.sqrt(powers.max(axis=0))
    excited = (powers / powers.max(axis=0) > EXCITED).any(axis=1) & (frequency > 0)
    scaled = (inputs / np.outer(scale, scale))[excited]
    if k > 1 and scaled.size and np.median(_least_root(scaled)) < NEGLIGIBLE**2:
        return None
    gains: list[Complex] = []
    explained = np.zeros(0)
    for y in outputs:
        crossed = [csd(by.u[:, i], y, **options)[1][excited] / scale[i] for i in range(k)]
        cross = np.stack(crossed, axis=1)
        gain = np.linalg.solve(scaled, cross[..., None])[..., 0]
        if not gains:
            explained = np.sum(cross.conj() * gain, axis=1).real
        gains.append(gain / scale)
    power = np.maximum(whole[excited], 1e-300)
    coherence = np.clip(explained / power, 0.0, 1.0)
    share = 1 - float(np.sum(coherence * power) / np.sum(power)) if power.size else 1.0
    return _Spectra(frequency[excited], gains, inputs[excited], coherence, share)


def _least_root(matrices: Complex) -> Array:
    """The smallest eigenvalue of each matrix over its largest, (F,)."""
    roots = np.linalg.eigvalsh(matrices)
    return np.asarray(roots[:, 0] / np.maximum(roots[:, -1], 1e-300))

"""Which laws are tried at which place, in what shapes: the vocabulary scaled by the motion.

A law that is nonlinear in a key (a clearance, a frequency, a relaxation time) is tried at a few
values spread over what the recordings move through; the value is refined by simulation afterwards.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.places.hypotheses import Hypothesis, natural_length
from symhyb.model.types import Between, Model, Place
from symhyb.numeric.kernels.buffers import Array

TRANSITION_SHARE = 1e-3  # of the largest rate; narrower, sticking makes the cost too rugged to fit
TRANSITION_LEAST = 1e-4
TRANSITION_NOISE = 0.3  # of the relative noise: the transition share
STRIBECK_SHARES = (0.05, 0.2)  # of the largest rate
CLEARANCE_SHARES = (0.4, 0.65, 0.85)  # of the stretches of one sign: quantiles
YIELD_SHARES = (0.05, 0.2, 0.6)  # of the amplitude: where hysteresis saturates
PRESLIDING_SHARES = (0.01, 0.05)  # of the amplitude
RELAXATION_SHARES = (0.15, 1.0, 6.0)  # of 1/ω of the motion
PEAKS = 2  # frequencies and periods that are tried at a place
PEAK_LEAST = 12.0  # power of a peak over the median around it
LINES = 400  # frequencies of a periodogram in position


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """What a place moves through, SI: ``stretch`` and ``rate`` (N,) of all recordings, and the
    ``force`` (N,) that the model lacks there, at times ``t`` (N,)."""

    stretch: Array
    rate: Array
    force: Array
    t: Array

    @property
    def speed(self) -> float:
        """Largest rate (99 % of the samples are slower)."""
        return float(np.quantile(np.abs(self.rate), 0.99)) if self.rate.size else 0.0

    @property
    def amplitude(self) -> float:
        """Half of the travel."""
        return float(np.ptp(self.stretch)) / 2 if self.stretch.size else 0.0


def force_hypotheses(
    model: Model, reaches: Mapping[Place, Reach], narrow: float = TRANSITION_SHARE
) -> tuple[Hypothesis, ...]:
    """Every law at every place, scaled by what the place moves through; ``narrow`` is the friction
    transition over the largest rate.

    Negative damping, drag and friction are not offered: a passive machine only loses energy.
    """
    return tuple(
        h for place, reach in reaches.items() for h in _at_place(model, place, reach, narrow)
    )


def transition_share(noise: float) -> float:
    """The friction transition over the largest rate for a relative ``noise`` of the best sensor:
    its error stays below the noise, and it is wide enough for sticking to be fitted."""
    return float(np.clip(TRANSITION_NOISE * noise, TRANSITION_LEAST, TRANSITION_SHARE))


def _at_place(model: Model, place: Place, reach: Reach, narrow: float) -> Iterator[Hypothesis]:
    yield Hypothesis("constant", place, ("constant",), (False,))
    length = (("length", natural_length(model, place)),) if isinstance(place, Between) else ()
    for term in ("stiffness", "quadratic", "cubic"):
        yield Hypothesis("spring", place, (term,), (False,), length)
    if reach.speed <= 0:
        return
    transition = (("transition", narrow * reach.speed),)
    yield Hypothesis("damper", place, ("damping",), (True,))
    yield Hypothesis("drag", place, ("drag",), (True,))
    yield Hypothesis("friction", place, ("coulomb",), (True,), transition)
    for share in STRIBECK_SHARES:
        shape = (("stribeck", share * reach.speed), *transition)
        yield Hypothesis(
            "friction", place, ("coulomb", "static"), (True, True), shape, ("stribeck",)
        )
    yield Hypothesis("damper", place, ("damping", "skew"), (True, False))
    yield Hypothesis("added_mass", place, ("mass",), (True,))
    yield from _stops(place, reach, length)
    yield from _remembering(place, reach)
    yield from _periodic(place, reach)


def _stops(
    place: Place, reach: Reach, length: tuple[tuple[str, float], ...]
) -> Iterator[Hypothesis]:
    s = reach.stretch - (dict(length).get("length", 0.0))
    both = np.abs(s)
    for side, travel in (("both", both), ("upper", s[s > 0]), ("lower", -s[s < 0])):
        if travel.size < 20 or (side == "both" and not (s.min() < 0 < s.max())):
            continue
        for clearance in np.quantile(travel, CLEARANCE_SHARES):
            if clearance > 0:
                yield Hypothesis(
                    "gap",
                    place,
                    ("stiffness",),
                    (True,),
                    (("clearance", float(clearance)), *length),
                    ("clearance",),
                    options=(("side", side),),
                )


def _remembering(place: Place, reach: Reach) -> Iterator[Hypothesis]:
    if reach.amplitude <= 0:
        return
    for share in YIELD_SHARES:
        half = 0.5 / (share * reach.amplitude)
        yield Hypothesis(
            "hysteresis",
            place,
            ("stiffness",),
            (True,),
            (("beta", half), ("gamma", half)),
            ("beta", "gamma"),
        )
    for share in PRESLIDING_SHARES:
        shape = (("stiffness", 1 / (share * reach.amplitude)),)
        yield Hypothesis(
            "friction_dynamic",
            place,
            ("coulomb",),
            (True,),
            shape,
            ("stiffness",),
            tied=("stiffness",),
        )
    pace = float(np.sqrt(np.mean(reach.rate**2))) / max(float(np.std(reach.stretch)), 1e-300)
    for share in RELAXATION_SHARES:
        yield Hypothesis(
            "relaxation",
            place,
            ("stiffness",),
            (True,),
            (("damping", share / pace),),
            ("damping",),
            tied=("damping",),
        )


def _periodic(place: Place, reach: Reach) -> Iterator[Hypothesis]:
    terms, free = ("sine", "cosine"), (False, False)
    rest = _unexplained(reach)
    for frequency in time_peaks(reach.t, rest):
        shape = (("frequency", frequency),)
        # the clock of every recording starts anew, so that its phase is its own
        yield Hypothesis("harmonic", place, terms, free, shape, ("frequency",), own=("phase",))
    for period in place_peaks(reach.stretch, rest):
        yield Hypothesis("ripple", place, terms, free, (("period", period),), ("period",))


def _unexplained(reach: Reach) -> Array:
    """The lacking force without what smooth simple laws of stretch and rate would take of it."""
    s, r = (x / (np.std(x) or 1.0) for x in (reach.stretch - reach.stretch.mean(), reach.rate))
    columns = np.stack([np.ones_like(s), s, s**2, s**3, r, np.abs(r) * r, np.sign(r)], axis=1)
    values, *_ = np.linalg.lstsq(columns, reach.force, rcond=None)
    return np.asarray(reach.force - columns @ values)


def time_peaks(t: Array, force: Array) -> tuple[float, ...]:
    """The frequencies (Hz) of lines in a force (N,), SI, over ``t`` (N,), s, strongest first."""
    step = float(np.median(np.diff(t))) if t.size > 64 else 0.0
    whole = np.flatnonzero(np.abs(np.diff(t) - step) > 0.5 * step)
    last = int(whole[0]) + 1 if whole.size else t.size
    if step <= 0 or last < 64:
        return ()
    window = np.hanning(last)
    padded = 4 * last
    spectrum = np.fft.rfft(force[:last] * window, padded)
    power = np.square(spectrum.real) + np.square(spectrum.imag)
    lines: Array = np.arange(power.size) / (padded * step)
    low = int(np.searchsorted(lines, 2 / (last * step)))
    return _peaks(lines[low:], power[low:], width=8)


def place_peaks(stretch: Array, force: Array) -> tuple[float, ...]:
    """The periods (in the unit of ``stretch``) of lines in a force along the travel (N,)."""
    travel = float(np.ptp(stretch))
    if travel <= 0 or stretch.size < 64:
        return ()
    rows = np.unique(np.linspace(0, stretch.size - 1, 6000).astype(int))
    s, f = stretch[rows], force[rows] - np.mean(force[rows])
    lines = np.linspace(1.0, min(60.0, stretch.size / 20), LINES) / travel
    turn = 2 * np.pi * np.outer(s, lines)
    power = np.asarray(np.abs(f @ np.exp(-1j * turn)) ** 2, dtype=float)
    return tuple(1 / line for line in _peaks(lines, power, width=4))


def _peaks(lines: Array, power: Array, width: int) -> tuple[float, ...]:
    """Local maxima that stand out of the median, at most ``PEAKS``."""
    if power.size < 8:
        return ()
    floor = float(np.median(power))
    inner = np.arange(1, power.size - 1)
    top = inner[(power[inner] > power[inner - 1]) & (power[inner] >= power[inner + 1])]
    chosen: list[int] = []
    for i in sorted(top, key=lambda i: -power[i]):
        if power[i] < PEAK_LEAST * floor or len(chosen) == PEAKS:
            break
        if all(abs(i - other) > width for other in chosen):
            chosen.append(int(i))
    return tuple(float(lines[i]) for i in chosen)


def lacking(forces: Array, directions: Array, index: int) -> Array:
    """The part of a lacking generalized force (N, n) that acts at a place, as its own force (N,):
    (dᵀΔF)/(dᵀd) with the direction d of that place in ``directions`` (N, n, places). SI."""
    d = directions[:, :, index]
    size = np.maximum(np.sum(d**2, axis=1), 1e-300)
    return np.asarray(np.sum(d * forces, axis=1) / size)


def joined(parts: Sequence[Reach]) -> Reach:
    """Reaches of several recordings as one."""
    return Reach(
        *(
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("stretch", "rate", "force", "t")
        )
    )

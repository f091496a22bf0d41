"""What a diagnosis says beside its causes: where and when something is missing, how large it is
over the motion, which causes recordings distinguish, and what to record next.

Values are in the unit that each carries beside it; arrays are in coherent SI with time on axis 0.
Sizes: N samples, C causes, W windows, K lines of a spectrum.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from symhyb.model.types import Place

SignalName = Literal["sine", "sweep", "multisine", "steps", "triangle", "release"]


@dataclass(frozen=True, slots=True)
class Activity:
    """Where and when an effect acts: ranges of stretch and rate (SI), stretches of time (s)."""

    stretch: tuple[float, float]
    rate: tuple[float, float]
    time: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Change:
    """A mismatch that begins or ends within a recording, at ``time_s`` known to ``width_s``."""

    recording: str
    time_s: float
    width_s: float
    kind: Literal["begins", "ends"]


@dataclass(frozen=True, slots=True, eq=False)
class Occurrence:
    """When and how a mismatch acts at a place, along the first recording (a change: along any).

    ``band_hz`` holds the middle four fifths of its power, ``beyond`` (SI) is the size of the
    stretch below which it is absent. ``t`` (W,), ``before`` and ``after`` (W,): χ² per sample of
    windows, uncorrected and with the best force of the place's own motion; ``lines`` (K,) in Hz and
    ``power`` (K,) in units of its largest. ``sentence`` is empty if nothing sets it apart.
    """

    change: Change | None
    band_hz: tuple[float, float] | None
    beyond: float | None
    t: NDArray[np.float64]
    before: NDArray[np.float64]
    after: NDArray[np.float64]
    lines: NDArray[np.float64]
    power: NDArray[np.float64]
    sentence: str = ""


@dataclass(frozen=True, slots=True)
class PlaceShare:
    """How much of the mismatch any smooth function of this place's own motion explains, unseen, and
    when and how it acts there where that is much."""

    place: Place
    explained: float | None
    active: Activity | None = None
    occurrence: Occurrence | None = None


@dataclass(frozen=True, slots=True)
class Memory:
    """Whether the missing force is a function of positions, speeds and inputs: the share of the
    mismatch that such a function explains, unseen (``state``), the share with laws that remember
    added (``past``), and what that means."""

    state: float
    past: float
    sentence: str


@dataclass(frozen=True, slots=True)
class Budget:
    """The time that a diagnosis was allowed, and the comparisons, in words, that were not made for
    want of it and without which nothing may be claimed."""

    seconds: float
    not_compared: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Cloud:
    """ΔF of one place over its motion: what the found laws are drawn through.

    ``stretch``, ``rate``, ``force`` (ΔF projected on the place, before correction) and ``band``
    (one sd): (N,) in SI; ``law`` the force of the found elements at this place, zero if none, and
    ``law_sd`` (N,) one standard deviation of it, None where that is not known.
    """

    place: Place
    recording: str
    t: NDArray[np.float64]
    stretch: NDArray[np.float64]
    rate: NDArray[np.float64]
    force: NDArray[np.float64]
    band: NDArray[np.float64]
    law: NDArray[np.float64]
    law_sd: NDArray[np.float64] | None = None


@dataclass(frozen=True, slots=True)
class Isolability:
    """How well the recordings at hand distinguish causes.

    ``evidence`` (C, C + 1), dimensionless: ln of the odds that are expected against the cause of
    the column where the cause of the row acts, at the size found; the last column is "nothing
    there". NaN on the diagonal. ``causes`` are words, ``found`` says which of them the
    diagnosis claims.
    """

    causes: tuple[str, ...]
    found: tuple[bool, ...]
    evidence: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class RivalRun:
    """Another structure that fits about as well as the chosen one, and how the two differ along a
    training ``recording``.

    ``causes`` are words, in the place of ``instead_of`` in the chosen structure; ``evidence`` is
    the difference of the score (0: as good), ``probability`` the posterior one among the structures
    that share it, None of one that does not or that convention alone ranks. ``apart`` by sensor
    (N,), SI: what it simulates less what the chosen structure does, over windows of ``window_s``
    seconds, each from the initial state that was fitted for that structure; NaN outside of them.
    ``noise`` by sensor, SI: one standard deviation.
    """

    causes: str
    instead_of: str
    evidence: float
    probability: float | None
    recording: str
    window_s: float
    t: NDArray[np.float64]
    apart: Mapping[str, NDArray[np.float64]]
    noise: Mapping[str, float]

    @property
    def largest(self) -> tuple[str, float, float]:
        """The sensor by which the two differ most, the time in s at which they do, and by how many
        standard deviations of its noise, with the sign."""
        peaks = []
        for sensor, values in self.apart.items():
            if np.isfinite(values).any():
                i = int(np.nanargmax(np.abs(values)))
                peaks.append((sensor, float(self.t[i]), float(values[i]) / self.noise[sensor]))
        return max(peaks, key=lambda peak: abs(peak[2]))

    @property
    def typical(self) -> Mapping[str, float]:
        """The root mean square of the difference by sensor, in standard deviations of its noise."""
        return {
            sensor: float(np.sqrt(np.nanmean(values**2))) / self.noise[sensor]
            for sensor, values in self.apart.items()
            if np.isfinite(values).any()
        }


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """What to record next, for a program; ``sentence`` says the same for a person.

    ``channel`` is the input to drive, or the coordinate to release from ``amplitude``.
    ``amplitude`` (the peak) and ``offset`` are in ``unit``, ``frequency`` (lo, hi) in Hz, None for
    a release; ``duration`` and ``sampling`` (the time between two samples) in s. ``between`` are
    the causes that it distinguishes, with an ``evidence`` (ln of the odds) of at least so much;
    ``beyond`` is True where it goes beyond what was recorded. docs/output.md states the signals.
    """

    channel: str
    signal: SignalName
    amplitude: float
    unit: str
    duration: float
    sampling: float
    frequency: tuple[float, float] | None = None
    offset: float = 0.0
    between: tuple[str, ...] = ()
    evidence: float = 0.0
    beyond: bool = False
    sentence: str = ""


ClassName = Literal[
    "law",
    "coupling",
    "input",
    "lag",
    "hidden mode",
    "time-varying",
    "sensor",
    "unmeasured force",
]


@dataclass(frozen=True, slots=True)
class ClassFound:
    """A class of effects that no law by name stands for: its ``kind``, its posterior
    ``probability``, what describes it (``figure``: the frequency of a mode or of a pulsation in Hz,
    the time of a lag in s), and where it acts: at a ``place``, in a ``channel`` or in a
    ``parameter``. Where not even that class ``leaves_noise``, it may be none of those that were
    tried, whatever its probability among them is."""

    kind: ClassName
    probability: float
    sentence: str
    figure: float | None = None
    place: Place | None = None
    channel: str | None = None
    parameter: str | None = None
    leaves_noise: bool = True


CourseName = Literal["step", "drift", "period", "free"]


@dataclass(frozen=True, slots=True)
class CourseNumber:
    """One number of a course with one standard deviation, in its unit."""

    name: str
    value: float
    sd: float
    unit: str


@dataclass(frozen=True, slots=True)
class CourseFound:
    """How a number of the model (``parameter``), or the factor of an input (``channel``), runs over
    the time of the ``recordings``, or with an input that moves nothing (``over``), as a
    temperature.

    ``numbers`` describe the ``shape``: ``before`` and ``after`` of a step, its ``time`` and the
    ``duration`` that it takes, ``begin`` and ``end`` of a drift, ``level``, ``amplitude``,
    ``frequency`` and ``phase`` (at t = 0) of a period. Of a broken line, as which steps and drifts
    count, ``points`` are times in s, or what ``over`` shows in ``over_unit``, with value and one
    deviation in ``unit``; it holds its end values. ``span`` is the first and the last of these in
    the recordings, ``was`` what the model said.
    ``rivals`` are shapes that are as likely, to 100 to 1.
    ``factors`` are the values over ``was`` by which the corrected model states the course: those at
    the points, of a period level, amplitude, frequency in Hz and phase in rad.
    """

    shape: CourseName
    unit: str
    was: float
    numbers: tuple[CourseNumber, ...]
    points: tuple[tuple[float, float, float], ...]
    factors: tuple[float, ...]
    recordings: tuple[str, ...]
    span: tuple[float, float]
    sentence: str
    parameter: str | None = None
    channel: str | None = None
    rivals: tuple[CourseName, ...] = ()
    over: str | None = None
    over_unit: str = "s"

    @property
    def path(self) -> str:
        """The parameter or the input."""
        return self.parameter or self.channel or ""

    def number(self, name: str) -> CourseNumber:
        """One of the numbers by its name.

        Raises:
            KeyError: the shape has no number of this name.
        """
        return {one.name: one for one in self.numbers}[name]

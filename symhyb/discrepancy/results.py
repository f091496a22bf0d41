"""What a diagnosis says: small frozen values that reports, scripts and files are made from.

Values are in the unit that each carries beside it; arrays are in coherent SI with time on axis 0.
Sizes: N samples, n coordinates, m sensors.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from symhyb.model.types import ChannelKind, Element, Place

VerdictName = Literal[
    "missing physics", "parameters", "measurement", "nothing missing", "undecided"
]

SignalName = Literal["sine", "sweep", "multisine", "steps", "triangle", "release"]


@dataclass(frozen=True, slots=True)
class Estimate:
    """One fitted number: ``term`` is the vocabulary's key (``coulomb``), ``sd`` one deviation."""

    name: str
    value: float
    sd: float
    unit: str
    term: str


@dataclass(frozen=True, slots=True)
class Activity:
    """Where and when an effect acts: ranges of stretch and rate (SI), stretches of time (s)."""

    stretch: tuple[float, float]
    rate: tuple[float, float]
    time: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Found:
    """A named effect, ready to be appended to the model file as ``element``.

    ``law`` is the force law with the kind's keys (``coulomb*tanh(s'/transition)``); ``share`` the
    increase of the unseen squared window error when this element is removed and the rest refitted,
    over the error before any correction. ``stability`` is the share of resampled windows in which
    its causes stay chosen; None where there are too few windows. ``probability`` is the posterior
    one; None of what only whole recordings added. ``own`` are the values that are each recording's
    own, by the name of the recording; ``element`` and ``estimates`` hold those of the first.
    """

    element: Element
    law: str
    estimates: tuple[Estimate, ...]
    share: float | None
    sentence: str
    active: Activity | None = None
    stability: float | None = None
    probability: float | None = None
    own: tuple[tuple[str, tuple[Estimate, ...]], ...] = ()


@dataclass(frozen=True, slots=True)
class Reestimated:
    """A parameter of the model that the recordings contradict; ``own`` has (recording, value, sd)
    where every recording has its own, ``value`` that of the first."""

    name: str
    was: float
    value: float
    sd: float
    unit: str
    own: tuple[tuple[str, float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Misfit:
    """A recording that does not fit the others: the ``quantity`` (in words) in which it differs
    most, its ``value`` and that of the ``others``, one sd each, and how often a recording that
    belongs to them would differ as much by ``chance``."""

    recording: str
    quantity: str
    value: float
    sd: float
    others: float
    others_sd: float
    unit: str
    chance: float
    sentence: str


@dataclass(frozen=True, slots=True)
class Repeats:
    """Recordings of one manoeuvre: by sensor and in its unit the ``noise`` within a run and the
    spread ``between`` runs beyond it; the larger of the two is the smallest effect claimed."""

    recordings: tuple[str, ...]
    noise: Mapping[str, float]
    between: Mapping[str, float]
    sentence: str


@dataclass(frozen=True, slots=True)
class Measurement:
    """A fault of a channel: its gain, offset or delay."""

    channel: str
    kind: ChannelKind
    value: float
    sd: float
    unit: str


@dataclass(frozen=True, slots=True)
class RecordingFault:
    """A channel recorded wrongly by more than a gain: a wrong ``unit`` or ``sign``, two columns
    exchanged (``swap``), a ``time`` column in another unit, a ``clock`` that runs fast.

    What is recorded is ``factor`` times what the model means; ``word`` is the unit it is in.
    ``claimed``: the evidence was decisive and the diagnosis went on with the repaired recordings;
    else it is a suspicion. ``rivals`` would show in the same way.
    """

    kind: Literal["unit", "sign", "swap", "time", "clock"]
    channels: tuple[str, ...]
    factor: float = 1.0
    word: str = ""
    claimed: bool = False
    sentence: str = ""
    rivals: "tuple[RecordingFault, ...]" = ()


@dataclass(frozen=True, slots=True)
class Alternative:
    """What the data cannot rule out; exactly one of ``place``, ``channel``, ``parameter`` is set.

    ``evidence`` is the difference of the score to the best structure (0: as good; larger:
    worse); ``options`` are words of an element, the side of a gap. Alternatives with the same
    number ``together``, above 0, are one: each holds only beside the others.
    """

    instead_of: str | None
    kind: str
    estimates: tuple[Estimate, ...]
    evidence: float
    place: Place | None = None
    channel: str | None = None
    parameter: str | None = None
    options: tuple[tuple[str, str], ...] = ()
    together: int = 0


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
class Score:
    """How well one model meets one set of recordings.

    ``force_nrmse`` by coordinate: RMS of ΔF over the range of ΔF before correction.
    ``force_residual`` by coordinate: ‖ΔF‖ / ‖applied force k_e‖, both through the same low-pass.
    ``window_nrmse``, ``free_run_nrmse`` by sensor: RMSE / (max − min) of the measurement.
    ``window_rmse``, ``free_run_rmse`` by sensor: the same in the sensor's unit.
    None: not computable.
    """

    force_nrmse: Mapping[str, float | None]
    force_residual: Mapping[str, float | None]
    window_nrmse: Mapping[str, float | None]
    window_rmse: Mapping[str, float | None]
    free_run_nrmse: Mapping[str, float | None]
    free_run_rmse: Mapping[str, float | None]


@dataclass(frozen=True, slots=True)
class Comparison:
    """One score before and one after the correction."""

    before: Score
    after: Score


@dataclass(frozen=True, slots=True)
class Trace:
    """Measured and simulated signals of one recording (free run, initial states fitted).

    ``measured``, ``before``, ``after`` by sensor: (N,) in SI, NaN where missing; ``after`` equals
    ``before`` where nothing was corrected. ``failures`` are sentences of simulations that stopped.
    """

    recording: str
    role: Literal["train", "holdout"]
    t: NDArray[np.float64]
    measured: Mapping[str, NDArray[np.float64]]
    before: Mapping[str, NDArray[np.float64]]
    after: Mapping[str, NDArray[np.float64]]
    failures: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Verdict:
    """Scores before and after, how they were made, and which of them decides."""

    window_s: float
    initial_states: str
    force_band_hz: float | None
    train: Comparison
    holdout: Comparison | None
    carries: str
    traces: tuple[Trace, ...] = ()

    def __str__(self) -> str:
        return self.carries


@dataclass(frozen=True, slots=True)
class Cloud:
    """ΔF of one place over its motion: what the found laws are drawn through.

    ``stretch``, ``rate``, ``force`` (ΔF projected on the place, before correction) and ``band``
    (one sd): (N,) in SI; ``law`` the force of the found elements at this place, zero if none.
    """

    place: Place
    recording: str
    t: NDArray[np.float64]
    stretch: NDArray[np.float64]
    rate: NDArray[np.float64]
    force: NDArray[np.float64]
    band: NDArray[np.float64]
    law: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Isolability:
    """How well the recordings at hand tell causes apart.

    ``evidence`` (C, C + 1), dimensionless: ln of the odds that are expected against the cause of
    the column where the cause of the row acts, at the size found; the last column is "nothing
    there". NaN on the diagonal. ``causes`` are words, ``found`` says which of them the
    diagnosis claims.
    """

    causes: tuple[str, ...]
    found: tuple[bool, ...]
    evidence: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """What to record next, for a program; ``sentence`` says the same for a person.

    ``channel`` is the input to drive, or the coordinate to release from ``amplitude``.
    ``amplitude`` (the peak) and ``offset`` are in ``unit``, ``frequency`` (lo, hi) in Hz, None for
    a release; ``duration`` and ``sampling`` (the time between two samples) in s. ``between`` are
    the causes that it tells apart, with an ``evidence`` (ln of the odds) of at least so much;
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
    ``parameter``."""

    kind: ClassName
    probability: float
    sentence: str
    figure: float | None = None
    place: Place | None = None
    channel: str | None = None
    parameter: str | None = None


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """The answer: a verdict with its sentence, what was found, and what cannot be distinguished.

    ``noise`` by sensor in the sensor's unit; ``log`` the story of the decision, one sentence a
    step; ``notes`` what was handled in the recordings. ``manoeuvre`` is ``record_next`` for a
    program, where it is one.
    """

    verdict: VerdictName
    sentence: str
    found: tuple[Found, ...] = ()
    parameters: tuple[Reestimated, ...] = ()
    measurement: tuple[Measurement, ...] = ()
    alternatives: tuple[Alternative, ...] = ()
    record_next: str | None = None
    remainder: float | None = None
    remainder_notes: tuple[str, ...] = ()
    noise: Mapping[str, float] = field(default_factory=dict)
    places: tuple[PlaceShare, ...] = ()
    clouds: tuple[Cloud, ...] = ()
    log: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    faults: tuple[RecordingFault, ...] = ()
    misfits: tuple[Misfit, ...] = ()
    repeats: tuple[Repeats, ...] = ()
    isolability: Isolability | None = None
    manoeuvre: Manoeuvre | None = None
    memory: Memory | None = None
    classes: tuple[ClassFound, ...] = ()

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
    over the error before any correction.
    """

    element: Element
    law: str
    estimates: tuple[Estimate, ...]
    share: float | None
    sentence: str
    active: Activity | None = None


@dataclass(frozen=True, slots=True)
class Reestimated:
    """A parameter of the model that the recordings contradict."""

    name: str
    was: float
    value: float
    sd: float
    unit: str


@dataclass(frozen=True, slots=True)
class Measurement:
    """A fault of a channel: its gain, offset or delay."""

    channel: str
    kind: ChannelKind
    value: float
    sd: float
    unit: str


@dataclass(frozen=True, slots=True)
class Alternative:
    """What the data cannot rule out; exactly one of ``place``, ``channel``, ``parameter`` is set.

    ``evidence`` is the difference of the criterion to the winner (0: as good; larger: worse);
    ``options`` are words of an element, the side of a gap.
    """

    instead_of: str | None
    kind: str
    estimates: tuple[Estimate, ...]
    evidence: float
    place: Place | None = None
    channel: str | None = None
    parameter: str | None = None
    options: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class PlaceShare:
    """How much of the mismatch any smooth function of this place's own motion explains, unseen."""

    place: Place
    explained: float | None
    active: Activity | None = None


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
    """Scores before and after, how they were made, and which of them carries the verdict."""

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
class Diagnosis:
    """The answer: a verdict with its sentence, what was found, and what cannot be told apart.

    ``noise`` by sensor in the sensor's unit; ``log`` the story of the decision, one sentence a
    step; ``notes`` what was handled in the recordings.
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
    memory: Memory | None = None

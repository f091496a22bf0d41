"""What a diagnosis says: small frozen values that reports, scripts and files are made from.

Values are in the unit that each carries beside it; arrays are in coherent SI with time on axis 0.
Sizes: N samples, n coordinates, m sensors.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from symhyb.by_name import ByName, Items, name_items
from symhyb.discrepancy.aside import (
    Activity,
    Budget,
    Change,
    ClassFound,
    ClassName,
    Cloud,
    CourseFound,
    CourseName,
    CourseNumber,
    Isolability,
    Manoeuvre,
    Memory,
    Occurrence,
    PlaceShare,
    RivalRun,
    SignalName,
)
from symhyb.discrepancy.evidence import Correlations, Worth
from symhyb.discrepancy.owned import values_of
from symhyb.discrepancy.posterior import CHAINS, DRAWS, Posterior
from symhyb.discrepancy.scored import Comparison, Score, Trace, Verdict
from symhyb.drawn import drawn
from symhyb.errors import InputError, Problem, UnknownNameError
from symhyb.model.actuators import ChannelKind
from symhyb.model.types import Element, Model, Place, place_text
from symhyb.shown import card, counted

if TYPE_CHECKING:
    import pandas as pd

    from symhyb.data.recording import Recording

__all__ = [
    "Activity",
    "Alternative",
    "Budget",
    "Change",
    "ClassFound",
    "ClassName",
    "Cloud",
    "Comparison",
    "CourseFound",
    "CourseName",
    "CourseNumber",
    "Diagnosis",
    "Estimate",
    "Found",
    "Isolability",
    "Manoeuvre",
    "Measurement",
    "Memory",
    "Misfit",
    "Occurrence",
    "PlaceShare",
    "Posterior",
    "RecordingFault",
    "Reestimated",
    "Repeats",
    "RivalRun",
    "Score",
    "SignalName",
    "Trace",
    "Verdict",
    "VerdictName",
]

VerdictName = Literal[
    "missing physics", "parameters", "measurement", "nothing missing", "undecided"
]


@dataclass(frozen=True, slots=True)
class Estimate:
    """One fitted number: ``term`` is the vocabulary's key (``coulomb``), ``sd`` one deviation; of a
    value of a curve ``at`` says where it holds, in ``at_unit``."""

    name: str
    value: float
    sd: float
    unit: str
    term: str
    at: float | None = None
    at_unit: str = ""

    @property
    def called(self) -> tuple[str, ...]:
        """The names by which it is found among others (its term, its name in the model file)."""
        return (self.term, self.name)


@dataclass(frozen=True, slots=True, repr=False)
class Found:
    """A named effect, ready to be appended to the model file as ``element``.

    ``law`` is the force law with the kind's keys (``coulomb*tanh(s'/transition)``); ``share`` the
    increase of the unseen squared window error when this element is removed and the rest refitted,
    over the error before any correction. ``stability`` is the share of resampled windows in which
    its causes stay chosen; None where there are too few windows. ``probability`` is the posterior
    one; None of what only whole recordings added. ``own`` are the values that are each recording's
    own, by the name of the recording; ``element`` and ``estimates`` hold those of the first.
    ``groups`` are the values that recordings of a group share, by the name of the grouping and of
    the group; ``element`` and ``estimates`` hold their mean, with the deviation that a group which
    was not recorded has from it.
    ``worth`` is what it amounts to along the training recordings.

    An estimate is an attribute by its term or name: ``found.coulomb.value``.
    """

    element: Element
    law: str
    estimates: ByName[Estimate]
    share: float | None
    sentence: str
    active: Activity | None = None
    stability: float | None = None
    probability: float | None = None
    own: tuple[tuple[str, tuple[Estimate, ...]], ...] = ()
    groups: tuple[tuple[str, str, tuple[Estimate, ...]], ...] = ()
    worth: Worth | None = None

    def __post_init__(self) -> None:
        name_items(self, "estimates")

    @property
    def called(self) -> tuple[str, ...]:
        """The names by which it is found among others (its element, its kind)."""
        return (self.element.name, self.element.kind)

    def __getattr__(self, name: str) -> Estimate:
        if name.startswith("_") or name in type(self).__slots__:  # a value that is being made
            raise AttributeError(name)
        try:
            return self.estimates[name]
        except UnknownNameError as error:
            raise AttributeError(f"{self.element.name}: {error}") from None

    def __repr__(self) -> str:
        numbers = ", ".join(f"{one.term} = {_amount(one)}" for one in self.estimates)
        place = place_text(self.element.place)
        return f"<Found {self.element.name}: {self.element.kind} {place}, {numbers or self.law}>"

    def __dir__(self) -> list[str]:
        return sorted({*object.__dir__(self), *(name for e in self.estimates for name in e.called)})


@dataclass(frozen=True, slots=True)
class Reestimated:
    """A parameter of the model that the recordings contradict; ``own`` has (recording, value, sd)
    where every recording has its own, ``value`` that of the first; ``groups`` (grouping, group,
    value, sd) where groups of recordings do, ``value`` their mean and ``sd`` the deviation that a
    group which was not recorded has from it."""

    name: str
    was: float
    value: float
    sd: float
    unit: str
    own: tuple[tuple[str, float, float], ...] = ()
    groups: tuple[tuple[str, str, float, float], ...] = ()


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
    """A fault of a channel: its gain, offset or delay, what its actuator does to an input, or the
    time constant of a sensor that lags. Faults with the same number ``together``, above 0, are one
    fault with one number, which these channels share."""

    channel: str
    kind: ChannelKind
    value: float
    sd: float
    unit: str
    together: int = 0

    @property
    def called(self) -> tuple[str, ...]:
        """The names by which it is found among others (``laser.gain``, its channel)."""
        return (f"{self.channel}.{self.kind}", self.channel)


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


@dataclass(frozen=True, slots=True, repr=False)
class Diagnosis:
    """The answer: verdict, sentence, what was found, and what cannot be distinguished.

    ``noise`` by sensor in the sensor's unit; ``log`` the decision, one sentence a step; ``notes``
    what was handled in the recordings. ``manoeuvre`` is ``record_next`` for a program, where it is
    one. ``found``, ``parameters`` and ``measurement`` are tuples that take a name, too:
    ``found["friction"]``, by kind where that is one alone, else by element. ``model`` is the given
    one, ``posterior`` all claimed numbers together, ``budget`` the time that was allowed.
    ``courses`` are numbers that change along the recordings. ``rivals`` say where the most probable
    other structures differ from the chosen one.
    """

    verdict: VerdictName
    sentence: str
    found: Items[Found] = Items()
    parameters: Items[Reestimated] = Items()
    measurement: Items[Measurement] = Items()
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
    courses: tuple[CourseFound, ...] = ()
    rivals: tuple[RivalRun, ...] = field(default=(), compare=False)
    model: Model | None = field(default=None, compare=False)
    posterior: Posterior | None = field(default=None, compare=False)
    budget: Budget | None = None

    def __post_init__(self) -> None:
        name_items(self, "found", "parameters", "measurement")

    def __repr__(self) -> str:
        parts = [
            self.verdict,
            counted("element", self.found.names()) + " found",
            counted("parameter", self.parameters.names()),
            counted("channel", self.measurement.names()),
        ]
        return f"<Diagnosis: {'; '.join(part for part in parts if not part.startswith('no '))}>"

    def __str__(self) -> str:
        return self.sentence

    def _repr_html_(self) -> str:
        head = ("what", "kind", "where", "number", "value", "share", "probability")
        rows = [(*r[:4], _number(*r[4:7]), _part(r[8]), _part(r[9])) for r in self._rows()]
        title = self.verdict if self.model is None else f"{self.model.title}: {self.verdict}"
        more = [] if self.record_next is None else [f"What to record next: {self.record_next}"]
        return card(title, self.sentence, head, rows, (*more, *self.notes))

    def to_frame(self) -> "pd.DataFrame":
        """All that is claimed, a row a number: elements with their terms, parameters of the model,
        faults of channels. Values and ``sd`` are in the ``unit`` of their row."""
        import pandas as pd

        return pd.DataFrame(list(self._rows()), columns=_COLUMNS)

    def plot(self, *causes: str, ax: Any = None) -> Any:
        """Draw ΔF over rate and over time with the laws that were found, at the places of
        ``causes`` (elements or kinds), by default of all: returns the axes of matplotlib, two a
        place; what is given as ``ax`` is drawn on (:mod:`symhyb.report.axes`)."""
        return drawn("diagnosis", self, ax, causes=causes)

    def values_of(self, recording: "Recording") -> dict[str, float]:
        """What a ``recording`` does not share with all others, by path in the corrected model and
        in its units: its own values and those of its groups. Of a group that is not known there is
        none, and the model has the mean."""
        return values_of(self.found, self.parameters, recording)

    @property
    def correlations(self) -> Correlations | None:
        """How the claimed numbers trade off; None of fewer than two."""
        known = self.posterior
        return known.correlations if known is not None and known.mean.size > 1 else None

    def to_arviz(self, draws: int = DRAWS, chains: int = CHAINS, seed: int = 0) -> Any:
        """The joint posterior as ArviZ takes it (:meth:`Posterior.to_arviz`).

        Raises:
            InputError: no number is claimed, or arviz-base is not installed.
        """
        if self.posterior is None:
            text = f"there is no posterior: no number is claimed ({self.verdict})"
            raise InputError(Problem(text))
        return self.posterior.to_arviz(draws, chains, seed)

    def _rows(self) -> Iterator[tuple[Any, ...]]:
        for found in self.found:
            where = place_text(found.element.place)
            for e in found.estimates:
                own = (e.term, e.value, e.sd, e.unit, None, found.share, found.probability)
                yield (found.element.name, found.element.kind, where, *own)
        for p in self.parameters:
            yield (p.name, "parameter", "", p.name, p.value, p.sd, p.unit, p.was, None, None)
        for m in self.measurement:
            yield (m.channel, m.kind, m.channel, m.kind, m.value, m.sd, m.unit, None, None, None)
        for c in self.courses:
            for n in c.numbers:
                yield (c.path, c.shape, "", n.name, n.value, n.sd, n.unit, c.was, None, None)


_COLUMNS = (
    "what",
    "kind",
    "where",
    "term",
    "value",
    "sd",
    "unit",
    "was",
    "share",
    "probability",
)


def _amount(one: Estimate) -> str:
    return _number(one.value, one.sd, one.unit)


def _number(value: float, sd: float, unit: str) -> str:
    """A number with its deviation and unit, short."""
    spread = f" ± {sd:.2g}" if np.isfinite(sd) and sd > 0 else ""
    return f"{value:.4g}{spread} {unit}".removesuffix(" 1")


def _part(share: float | None) -> str:
    return "" if share is None else f"{100 * share:.3g} %"

"""What ``diagnosis.json`` holds, as types: the output contract.

``diagnosis.schema.json`` is made from these (``python -m symhyb.report.schema``) and the
mappings that :mod:`symhyb.report.contract` makes are checked against them. Keys are stable; they
are added to, never taken away. Keys that are not required may be missing in files of others.
"""

from dataclasses import dataclass
from typing import Annotated, Any, Literal, NotRequired

from typing_extensions import TypedDict

from symhyb.discrepancy.results import ClassName
from symhyb.model.actuators import ChannelKind
from symhyb.report.budget_entry import BudgetEntry
from symhyb.report.course_entries import CourseEntry


@dataclass(frozen=True, slots=True)
class Says:
    """What a JSON schema says of a value beyond its type, by the words of JSON Schema."""

    words: tuple[tuple[str, Any], ...]

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        return {**handler(core), **dict(self.words)}


Share = Annotated[float, Says((("minimum", 0), ("maximum", 1)))]
Pair = Annotated[list[float], Says((("minItems", 2), ("maxItems", 2)))]
Names = Annotated[list[str], Says((("minItems", 1),))]
Numbers = dict[str, float | None]


class PlaceForm(TypedDict, total=False):
    """A place: ``on`` a coordinate, ``between`` two points, ``at`` one, or a ``pair`` of
    coordinates that act on each other."""

    on: str
    at: str
    pair: Annotated[list[str], Says((("minItems", 2), ("maxItems", 2)))]
    between: Annotated[list[str], Says((("minItems", 2), ("maxItems", 2)))]


PlaceEntry = Annotated[
    PlaceForm,
    Says((("minProperties", 1), ("maxProperties", 1), ("additionalProperties", False))),
]
"""Exactly one of them."""


_SOMEWHERE = Says((("oneOf", [{"required": [key]} for key in ("place", "channel", "parameter")]),))
"""Exactly one of place, channel and parameter."""


class EstimateEntry(TypedDict):
    """A fitted number with one standard deviation in ``unit``; ``term`` is the key of its kind. A
    value of a curve is that ``at`` a stretch or rate, in ``at_unit``."""

    value: float
    sd: float
    unit: str
    term: str
    at: NotRequired[float]
    at_unit: NotRequired[str]


Estimates = dict[str, EstimateEntry]
"""By symbol."""


class ActivityEntry(TypedDict, total=False):
    """Where and when a force acts: ranges of stretch and rate (SI), spans of time in s."""

    stretch: Pair
    rate: Pair
    time: list[Pair]


class WorthEntry(TypedDict):
    """What an effect amounts to along the training recordings, as shares."""

    energy: Share | None
    force: Share | None


class FoundEntry(TypedDict):
    """An element that the model lacks."""

    name: str
    kind: str
    place: PlaceEntry
    law: str
    parameters: Estimates
    share: float | None
    sentence: str
    active: NotRequired[ActivityEntry]
    stability: NotRequired[Share | None]
    probability: NotRequired[Share | None]
    worth: NotRequired[WorthEntry | None]
    own: NotRequired[dict[str, Estimates]]
    groups: NotRequired[dict[str, dict[str, Estimates]]]
    options: NotRequired[dict[str, str]]


class ValueEntry(TypedDict):
    """A number with one standard deviation."""

    value: float
    sd: float


class ParameterEntry(TypedDict):
    """A parameter of the model that is off; ``own`` by recording, ``groups`` by grouping and
    group."""

    name: str
    was: float
    value: float
    sd: float
    unit: str
    own: NotRequired[dict[str, ValueEntry]]
    groups: NotRequired[dict[str, dict[str, ValueEntry]]]


class MeasurementEntry(TypedDict):
    """A gain, offset or delay of a channel, a number of the actuator of an input, or the time
    constant of a sensor that lags. Those with the same number ``together``, above 0, are one
    number, which these channels share."""

    channel: str
    kind: ChannelKind
    value: float
    sd: float
    unit: str
    together: NotRequired[int]


FaultKind = Literal["unit", "sign", "swap", "time", "clock"]


class FaultRival(TypedDict):
    """A fault of a recording that would show in the same way."""

    kind: FaultKind
    channels: Names


class FaultEntry(TypedDict):
    """A fault of a recording: what is recorded is ``factor`` times what the model means."""

    kind: FaultKind
    channels: Names
    factor: float
    unit: str | None
    claimed: bool
    sentence: str
    rivals: list[FaultRival]


class Somewhere(TypedDict, total=False):
    """Where something acts: exactly one of these."""

    place: PlaceEntry
    channel: str
    parameter: str


class AlternativeForm(Somewhere):
    """What the recordings cannot rule out; ``evidence`` is the difference of the score."""

    instead_of: NotRequired[str | None]
    kind: str
    options: NotRequired[dict[str, str]]
    together: NotRequired[int]
    parameters: Estimates
    evidence: float


AlternativeEntry = Annotated[AlternativeForm, _SOMEWHERE]


class RemainderEntry(TypedDict):
    """The ``share`` of the squared mismatch that nothing explains."""

    share: float | None
    notes: NotRequired[list[str]]


class ScoreEntry(TypedDict):
    """Errors by sensor, of forces by coordinate; NRMSE over the range of the channel."""

    force_nrmse: Numbers
    window_nrmse: Numbers
    free_run_nrmse: Numbers
    force_residual: NotRequired[Numbers]
    window_rmse: NotRequired[Numbers]
    free_run_rmse: NotRequired[Numbers]


class ComparisonEntry(TypedDict):
    """The model as given and corrected."""

    before: ScoreEntry
    after: ScoreEntry


class ScoresForm(TypedDict):
    """Scores on training and unseen recordings."""

    initial_states: str
    train: ComparisonEntry
    holdout: ComparisonEntry | None
    force_band_hz: NotRequired[float | None]
    carries: NotRequired[str]


class ScoresEntry(ScoresForm):
    """Scores of a diagnosis; windows of ``window_s`` seconds."""

    window_s: float


class LearnedScoresEntry(ScoresForm):
    """Scores of what was learned; ``window_s`` is null where none is over windows."""

    window_s: float | None


class ChangeEntry(TypedDict):
    """When a mismatch begins or ends."""

    recording: str
    kind: Literal["begins", "ends"]
    time_s: float
    width_s: float


class OccurrenceKeys(TypedDict, total=False):
    """When and how a mismatch acts, as far as that is known."""

    change: ChangeEntry | None
    band_hz: Pair | None
    beyond: float | None
    sentence: str


class PlaceShareEntry(OccurrenceKeys):
    """The share of ΔF that a force at one place could take."""

    place: PlaceEntry
    explained: float | None
    active: NotRequired[ActivityEntry]


class MisfitEntry(TypedDict):
    """A recording that does not fit the others."""

    recording: str
    quantity: str
    value: float
    sd: float
    others: float
    others_sd: float
    unit: str
    chance: Share
    sentence: str


class RepeatsEntry(TypedDict):
    """Recordings of one manoeuvre: noise within them, and what they differ by."""

    recordings: list[str]
    noise: Numbers
    between: Numbers
    sentence: str


class IsolabilityEntry(TypedDict):
    """Which causes these recordings distinguish: evidence of each (row) against each."""

    causes: list[str]
    found: list[bool]
    evidence: list[list[float | None]]


class RivalEntry(TypedDict):
    """Where another structure would differ most from the chosen one: at ``time_s`` of ``recording``
    by so many ``deviations`` of the noise of ``sensor``; ``rms`` by sensor over its windows."""

    causes: str
    instead_of: str
    evidence: float
    probability: Share | None
    recording: str
    window_s: float
    sensor: str
    time_s: float
    deviations: float
    rms: Numbers


class ManoeuvreEntry(TypedDict):
    """What to record next."""

    channel: str
    signal: Literal["sine", "sweep", "multisine", "steps", "triangle", "release"]
    amplitude: float
    unit: str
    offset: float
    frequency_hz: Pair | None
    duration_s: float
    sampling_s: float
    between: list[str]
    evidence: float
    beyond: bool


class MemoryEntry(TypedDict):
    """How much of ΔF its state, and its past, explain."""

    state: float | None
    past: float | None
    sentence: str


class CorrelationsEntry(TypedDict):
    """How fitted numbers trade off: a row and a column for each name."""

    names: list[str]
    matrix: list[list[float]]


class CorrelatedEntry(TypedDict):
    """A correlation over several lags: the one that stands out most, and whether noise has such."""

    largest: float
    noise: bool


class WhitenessEntry(TypedDict):
    """Whether what is left of a sensor, over windows, is noise: by itself and with each input."""

    recording: str
    sensor: str
    itself: CorrelatedEntry
    inputs: dict[str, CorrelatedEntry]


class WithoutEntry(TypedDict):
    """What free runs of the corrected model err less one element, in the unit of each sensor."""

    element: str
    free_run_rmse: Numbers


class ClassForm(Somewhere):
    """A generic class with its probability."""

    kind: ClassName
    probability: Share
    figure: float | None
    leaves_noise: NotRequired[bool]
    sentence: str


ClassEntry = Annotated[ClassForm, _SOMEWHERE]


class DiagnosisDocument(TypedDict):
    """The whole of ``diagnosis.json``, format 1."""

    format: NotRequired[Literal[1]]
    verdict: Literal["missing physics", "parameters", "measurement", "nothing missing", "undecided"]
    sentence: str
    found: list[FoundEntry]
    parameters: list[ParameterEntry]
    measurement: list[MeasurementEntry]
    channels: NotRequired[list[FaultEntry]]
    alternatives: list[AlternativeEntry]
    record_next: str | None
    manoeuvre: NotRequired[ManoeuvreEntry | None]
    isolability: NotRequired[IsolabilityEntry | None]
    rivals: NotRequired[list[RivalEntry]]
    remainder: RemainderEntry
    scores: ScoresEntry
    noise: dict[str, float]
    places: list[PlaceShareEntry]
    misfits: NotRequired[list[MisfitEntry]]
    repeats: NotRequired[list[RepeatsEntry]]
    memory: NotRequired[MemoryEntry | None]
    classes: NotRequired[list[ClassEntry]]
    courses: NotRequired[list[CourseEntry]]
    correlations: NotRequired[CorrelationsEntry | None]
    whiteness: NotRequired[list[WhitenessEntry]]
    without: NotRequired[list[WithoutEntry]]
    log: NotRequired[list[str]]
    notes: NotRequired[list[str]]
    budget: NotRequired[BudgetEntry | None]

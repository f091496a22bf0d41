"""What ``learned.json`` holds, as types; ``learned.schema.json`` is made from these."""

from typing import Annotated, Any, Literal

from typing_extensions import TypedDict

from symhyb.report.document import LearnedScoresEntry, Pair, Says

CLOSED = Says((("additionalProperties", False),))
Text = Annotated[str, Says((("minLength", 1),))]
Count = Annotated[int, Says((("minimum", 1),))]


class CoordinateForm(TypedDict):
    """A coordinate."""

    on: str


class TermForm(TypedDict):
    """A learned term: its ``value`` after the fit by simulation, ``regressed`` before."""

    place: Annotated[CoordinateForm, CLOSED]
    term: str
    words: str
    formula: str
    value: float | None
    sd: float | None
    unit: str
    regressed: float | None
    element: str | None


class NetworkForm(TypedDict):
    """A learned network; ``weights`` where it stands in no corrected model."""

    place: Annotated[CoordinateForm, CLOSED]
    inputs: list[str]
    hidden: Count
    trust: list[Pair]
    element: str | None
    sentence: str
    weights: dict[str, Any] | None


class HeldEntry(TypedDict):
    """Errors on windows held out of the fit, of nothing and of what was learned."""

    nothing: float | None
    learned: float | None
    better: bool


class BesideFound(TypedDict):
    """An element that a diagnosis of the same recordings found."""

    name: str
    kind: str
    sentence: str


class BesideEntry(TypedDict):
    """The answer of a diagnosis of the same recordings."""

    verdict: str
    sentence: str
    found: list[BesideFound]
    scores: LearnedScoresEntry


TermEntry = Annotated[TermForm, CLOSED]
NetworkEntry = Annotated[NetworkForm, CLOSED]


class LearnedForm(TypedDict):
    """The whole of ``learned.json``, format 1."""

    format: Literal[1]
    by: Literal["sparse", "network"]
    formulation: Literal["force", "rates"]
    learned: bool
    sentence: Text
    file: Literal["corrected.toml"] | None
    terms: list[TermEntry]
    networks: list[NetworkEntry]
    held: HeldEntry | None
    scores: LearnedScoresEntry
    settings: dict[str, Any]
    notes: list[str]
    beside: BesideEntry | None
    manifest: dict[str, Any]


LearnedDocument = Annotated[LearnedForm, CLOSED]

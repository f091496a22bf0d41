"""The watch: a reference first, then block after block, and what has changed since."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from symhyb.data.recording import Recording
from symhyb.discrepancy.words.amounts import percent_text, quantity_text
from symhyb.discrepancy.words.wording import joined
from symhyb.errors import InputError
from symhyb.model.types import Model
from symhyb.monitoring.begun import REFERENCE_BLOCKS, begun
from symhyb.monitoring.changes import (
    LENGTHS,
    Block,
    Change,
    Reference,
    changed,
    level,
    named,
    reference_of,
)
from symhyb.monitoring.events import Event
from symhyb.monitoring.feed import Feed
from symhyb.monitoring.gauge import (
    Gauge,
    amounts_of,
    block_of,
    change_phrase,
    phrase_of,
    values_of,
)

STEPS_SEEN = 40  # rows from which the rate is known
NAMED_S = 4.0  # after which a change is named, s
NAMED_BLOCKS = 4  # ... or after so many blocks, if that is longer
VALUES_S = 60.0  # from one report of the values to the next
SILENT = 50  # times that a source had nothing in a row
REFUSED_MOST = 10  # pieces in a row that cannot be read
RIVALS_SAID = 3


@dataclass(frozen=True, slots=True)
class Watch:
    """How a machine is watched: ``reference_s`` of the source, s, are the machine as it is;
    ``false_alarms`` a day are allowed; ``columns`` maps channels to columns."""

    model: Model
    reference_s: float = 60.0
    false_alarms: float = 1.0
    columns: Mapping[str, str] | None = None
    name: str = "source"


@dataclass(slots=True)
class _State:
    """Where a watch has come to."""

    feed: Feed
    rows: int = 0  # of a reference, then of a block
    gauge: Gauge | None = None
    reference: Reference | None = None
    least: float = 0.0
    blocks: list[Block] = field(default_factory=list)
    change: Change | None = None
    refused: int = 0
    silent: int = 0
    last_s: float = -np.inf
    said_s: float = -np.inf


def watch(settings: Watch, lines: Iterable[str | None]) -> Iterator[Event]:
    """What happens to a machine whose recording comes line by line (None: nothing for a moment).

    Raises:
        InputError: rows that cannot be read, ten pieces in a row, or a reference that does not show
            the motion.
    """
    state = _State(Feed(settings.model, settings.columns, settings.name))
    for line in lines:
        if line is None:
            state.silent += 1
            if state.silent == SILENT:
                yield Event("silent", "The source has nothing more to say.", _now(state))
            continue
        state.silent = 0
        state.feed.take(line)
        if not state.rows and len(state.feed.rows) >= STEPS_SEEN:
            state.rows = max(
                round(settings.reference_s / state.feed.step_s(STEPS_SEEN)), STEPS_SEEN
            )
        if state.rows and len(state.feed.rows) >= state.rows:
            yield from _taken(settings, state)
    yield Event("ended", "The source has ended.", _now(state))


def _now(state: _State) -> float:
    return state.last_s if np.isfinite(state.last_s) else 0.0


def _taken(settings: Watch, state: _State) -> Iterator[Event]:
    """Take the rows that are there: a reference, or a block."""
    try:
        piece = state.feed.piece(state.rows)
    except InputError as refused:
        state.refused += 1
        if state.gauge is None or state.refused >= REFUSED_MOST:
            raise
        yield Event("unreadable", f"A block cannot be read: {refused.problems[0]}.", _now(state))
        return
    state.refused = 0
    if piece.t[0] <= state.last_s:
        said = f"The time goes back from {state.last_s:g} to {piece.t[0]:g} s."
        yield Event("back", said, float(piece.t[0]))
        state.blocks, state.change = [], None
    state.last_s = float(piece.t[-1])
    if state.gauge is None:
        yield _referred(settings, state, piece)
        return
    block = block_of(state.gauge, piece)
    if block is None:
        yield Event("unreadable", "A block has gaps, and holds no whole window.", state.last_s)
        return
    yield from _judged(settings, state, state.gauge, block)


def _referred(settings: Watch, state: _State, piece: Recording) -> Event:
    """Make the reference from the first piece."""
    found = begun(settings.model, piece, settings.false_alarms, settings.name)
    state.gauge, state.rows = found.gauge, found.rows
    state.reference, state.least = found.reference, found.least
    state.said_s = state.last_s
    said = (
        f"The first {piece.duration:.4g} s are the reference. Every {found.gauge.block_s:.3g} s "
        f"{len(found.gauge.hypotheses)} causes are held against it."
    )
    return Event("ready", said, state.last_s)


def _refer(settings: Watch, state: _State, gauge: Gauge) -> None:
    """Take the blocks so far for the reference."""
    state.reference = reference_of(state.blocks)
    state.least = level(settings.false_alarms, gauge.block_s, state.reference)
    state.blocks, state.change = [], None


def _judged(settings: Watch, state: _State, gauge: Gauge, block: Block) -> Iterator[Event]:
    """Hold a block against the reference, or gather a new one after a change."""
    state.blocks.append(block)
    if state.reference is None:
        if len(state.blocks) >= REFERENCE_BLOCKS and _lasting(state) >= settings.reference_s / 2:
            _refer(settings, state, gauge)
            said = "The machine as it is now is the reference from here on."
            yield Event("ready", said, block.end_s)
        return
    if state.change is None:
        yield from _tested(state, gauge, block)
        return
    since = state.change.since
    waited = block.end_s - state.blocks[since].start_s
    if waited >= NAMED_S and len(state.blocks) - since >= NAMED_BLOCKS:
        best = named(state.reference, state.blocks, since, state.change.chance, gauge.causes)
        yield _event("named", gauge, best, state.blocks, block.end_s)
        state.blocks, state.reference = state.blocks[since + 1 :], None


def _tested(state: _State, gauge: Gauge, block: Block) -> Iterator[Event]:
    assert state.reference is not None
    found = changed(state.reference, state.blocks, state.least, gauge.causes)
    if found is None:
        if block.end_s - state.said_s >= VALUES_S:
            state.said_s = block.end_s
            amounts = values_of(gauge, state.reference, state.blocks)
            if amounts:
                said = joined(
                    [f"{a.name} is {quantity_text(a.value, a.unit, a.sd)}" for a in amounts]
                )
                yield Event("values", f"Nothing has changed: {said}.", block.end_s, amounts=amounts)
            state.blocks = state.blocks[-LENGTHS[-1] :]
        return
    state.change = found
    yield _event("changed", gauge, found, state.blocks, block.end_s)


def _lasting(state: _State) -> float:
    return state.blocks[-1].end_s - state.blocks[0].start_s


def _event(
    kind: Literal["changed", "named"],
    gauge: Gauge,
    change: Change,
    blocks: list[Block],
    now_s: float,
) -> Event:
    """A change in words."""
    since = blocks[change.since].start_s
    amounts = amounts_of(gauge, change.cause, change.size, change.sd)
    what = change_phrase(gauge, change.cause, amounts)
    rivals = tuple(phrase_of(gauge.hypotheses[i]) for i in change.rivals[:RIVALS_SAID])
    likely = f"{percent_text(change.probability)} likely"
    open_ = f"; or {joined(rivals, 'or')}" if rivals else ""
    lead = "Something has changed" if kind == "changed" else "What has changed"
    said = f"{lead} since {since:.4g} s: {what} ({likely}{open_})."
    return Event(
        kind,
        said,
        now_s,
        since,
        phrase_of(gauge.hypotheses[change.cause]),
        amounts,
        change.probability,
        change.chance,
        rivals,
    )

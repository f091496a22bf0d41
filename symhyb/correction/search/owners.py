"""Whose a number is: that of all recordings, of a group of them, or one recording's own.

Numbers are counted so that those of the first recording come first, then those that each later
recording is the first to have. Sizes: F numbers or columns before they are shared out.
"""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.vocabulary import KINDS


@dataclass(frozen=True, slots=True)
class Layout:
    """Where the numbers of each recording stand among those of all: ``rows`` has for each recording
    the place of each of its F numbers; ``source`` the number that each of all is one of, ``first``
    the first recording that has it."""

    rows: tuple[tuple[int, ...], ...]
    source: tuple[int, ...]
    first: tuple[int, ...]

    @property
    def apart(self) -> bool:
        """Whether any number is not that of all recordings."""
        return len(self.source) > len(self.rows[0])

    def widened(self, columns: Sequence[int]) -> tuple[int, ...]:
        """The places of ``columns`` of the first recording, then those of the others."""
        later = range(len(self.rows[0]), len(self.source))
        return (*columns, *(i for i in later if self.source[i] in columns))


def own_terms(cause: Hypothesis) -> tuple[tuple[int, str], ...]:
    """The terms of a cause of which not all recordings share the value, by their place, each with
    the grouping of those that do: those of own keys; all of them where keys are not terms."""
    if not cause.own:
        return ()
    law = KINDS.get(cause.kind)
    made = law is not None and bool(law.terms.keys)
    if {*cause.own} <= {*cause.terms} and not made:
        return tuple(
            (i, cause.grouping(key)) for i, key in enumerate(cause.terms) if key in cause.own
        )
    groupings = {cause.grouping(key) for key in cause.own}
    by = groupings.pop() if len(groupings) == 1 else ""
    return tuple((i, by) for i in range(len(cause.terms)))


def layout(own: Mapping[int, str], size: int, recordings: Sequence[Recording]) -> Layout:
    """Where ``size`` numbers stand of which some are each recording's ``own``: by their place, each
    with the grouping of the recordings that share it, empty for none."""
    known: dict[tuple[int, Hashable], int] = {}
    source, first = list(range(size)), [0] * size
    rows = []
    for which, recording in enumerate(recordings):
        row = list(range(size))
        for i, by in own.items():
            owner = (i, recording.groups[by] if by else which)
            if owner not in known:
                known[owner] = len(source) if which else i
                if which:
                    source.append(i)
                    first.append(which)
            row[i] = known[owner]
        rows.append(tuple(row))
    return Layout(tuple(rows), tuple(source), tuple(first))

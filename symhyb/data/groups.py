"""Groups of recordings that share a number which others have another value of, as those of a mount.

A grouping (``mount``) has a label for each recording. What is each recording's own is shared within
no group; its grouping is the empty text here, and ``recording`` where people write it.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from symhyb.errors import InputError, Problem, did_you_mean

if TYPE_CHECKING:
    from symhyb.data.recording import Recording

Own = Mapping[str, str]
"""By the name of a number the grouping of the recordings that share it, empty for none."""

EACH = "recording"
"""The grouping of numbers that each recording has for itself."""


def by_name(own: Sequence[str] | Own) -> dict[str, str]:
    """What is not shared by all recordings, as people write it: a list of what each recording has
    its own value of, or a mapping to groupings."""
    if isinstance(own, Mapping):
        return {name: "" if by == EACH else by for name, by in own.items()}
    return dict.fromkeys(own, "")


def groups_in(given: Mapping[str, object] | None, name: str) -> dict[str, str]:
    """The groups of the recording ``name``, by grouping, with no space around their labels.

    Raises:
        InputError: labels that are no text or are empty, or a grouping that is called
            ``recording``.
    """
    found, problems = {}, []
    for by, label in (given or {}).items():
        place = f"groups.{by}"
        if by == EACH or not by:
            text = f"a grouping cannot be called '{by}'; choose another name"
            problems.append(Problem(text, place, name))
        elif not isinstance(label, str) or not label.strip():
            text = f"must be the name of a group, as text, not {label!r}"
            problems.append(Problem(text, place, name))
        else:
            found[by] = label.strip()
    if problems:
        raise InputError(problems)
    return found


def require_groups(
    recordings: Sequence["Recording"], unseen: Sequence["Recording"], own: Own
) -> None:
    """See that each training recording is of a group where a number is shared within groups, and
    that there are several of them. An ``unseen`` recording may be of a group that is not known.

    Raises:
        InputError: a grouping that no recording states, a recording that states none, a grouping of
            one group, or two groups whose names differ in case and spaces alone.
    """
    problems: dict[Problem, None] = {}
    stated = dict.fromkeys(by for one in (*recordings, *unseen) for by in one.groups)
    for name, by in own.items():
        if by and by not in stated:
            near = did_you_mean(by, list(stated)) if stated else ""
            text = f"is shared within groups of '{by}', but no recording states its '{by}'{near}"
            problems[Problem(text, f"own.{name}")] = None
    for by in dict.fromkeys(by for by in own.values() if by in stated):
        for one in recordings:
            if by not in one.groups:
                text = "is not stated here, but for other recordings; state it for all of them"
                problems[Problem(text, f"groups.{by}", one.name)] = None
        labels = dict.fromkeys(one.groups[by] for one in recordings if by in one.groups)
        if len(labels) == 1 and all(by in one.groups for one in recordings):
            text = (
                f"all recordings are of the group '{next(iter(labels))}', so that they share every "
                f"number; leave '{by}' out of own"
            )
            problems[Problem(text, f"groups.{by}")] = None
        every = dict.fromkeys([*labels, *(u.groups[by] for u in unseen if by in u.groups)])
        for first, second in _alike(list(every)):
            text = f"'{first}' and '{second}' differ in case and spaces alone; write one of both"
            problems[Problem(text, f"groups.{by}")] = None
    if problems:
        raise InputError(problems)


def _alike(labels: Sequence[str]) -> list[tuple[str, str]]:
    """Pairs of labels that are one but for case and spaces."""
    seen: dict[str, str] = {}
    found = []
    for label in labels:
        plain = "".join(label.split()).casefold()
        if plain in seen:
            found.append((seen[plain], label))
        seen.setdefault(plain, label)
    return found


def group_note(groups: Mapping[str, str]) -> str:
    """Say of which groups a recording is."""
    return f"of the group {', '.join(f'{by} = {label}' for by, label in groups.items())}"

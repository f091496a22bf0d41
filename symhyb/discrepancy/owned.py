"""The values of a correction that not all recordings share, for one of them."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from symhyb.data.recording import Recording
    from symhyb.discrepancy.results import Found, Reestimated


def values_of(
    found: Iterable["Found"], parameters: Iterable["Reestimated"], recording: "Recording"
) -> dict[str, float]:
    """By path in the corrected model, in its units, what a recording has of its own and what its
    groups have; nothing of a group that is not known."""
    values: dict[str, float] = {}
    for effect in found:
        mine = [*(one for name, one in effect.own if name == recording.name)]
        mine += [one for by, name, one in effect.groups if recording.groups.get(by) == name]
        values |= {f"{effect.element.name}.{one.name}": one.value for row in mine for one in row}
    for item in parameters:
        mine_too = [value for name, value, _ in item.own if name == recording.name]
        mine_too += [v for by, name, v, _ in item.groups if recording.groups.get(by) == name]
        values |= dict.fromkeys((item.name,), mine_too[0]) if mine_too else {}
    return values

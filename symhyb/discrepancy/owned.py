"""The values of a correction that not all recordings share, for one of them."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Protocol

from symhyb.model.types import Element

if TYPE_CHECKING:
    from symhyb.data.recording import Recording


class _Number(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> float: ...


class _Effect(Protocol):
    @property
    def element(self) -> Element: ...
    @property
    def own(self) -> Sequence[tuple[str, Sequence[_Number]]]: ...
    @property
    def groups(self) -> Sequence[tuple[str, str, Sequence[_Number]]]: ...


class _Parameter(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def own(self) -> Sequence[tuple[str, float, float]]: ...
    @property
    def groups(self) -> Sequence[tuple[str, str, float, float]]: ...


def values_of(
    found: Iterable[_Effect], parameters: Iterable[_Parameter], recording: "Recording"
) -> dict[str, float]:
    """By path in the corrected model, in its units, what a recording has of its own and what its
    groups have; nothing of a group that is not known."""
    values: dict[str, float] = {}
    for effect in found:
        mine = [one for name, one in effect.own if name == recording.name]
        mine += [one for by, name, one in effect.groups if recording.groups.get(by) == name]
        values |= {f"{effect.element.name}.{one.name}": one.value for row in mine for one in row}
    for item in parameters:
        known = [value for name, value, _ in item.own if name == recording.name]
        known += [x for by, name, x, _ in item.groups if recording.groups.get(by) == name]
        if known:
            values[item.name] = known[0]
    return values

"""Tuples whose items are found by name too: ``model.parameters["k"]``."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Generic, SupportsIndex, TypeVar, overload

from symhyb.errors import UnknownNameError, did_you_mean

T = TypeVar("T")
LISTED = 20  # names that a message lists


class ByName(tuple[T, ...]):
    """A tuple that takes the name of an item where it takes its number.

    An item is called by its ``name``, or by each of ``called`` where it has that: the first of them
    goes before the second, and a name that several items share is refused.
    """

    __slots__ = ()

    @overload
    def __getitem__(self, key: str) -> T: ...
    @overload
    def __getitem__(self, key: SupportsIndex) -> T: ...
    @overload
    def __getitem__(self, key: slice) -> tuple[T, ...]: ...
    def __getitem__(self, key: str | SupportsIndex | slice) -> T | tuple[T, ...]:
        if not isinstance(key, str):
            return super().__getitem__(key)
        hits = self._hits(key)
        if len(hits) == 1:
            return hits[0]
        if hits:
            raise UnknownNameError(
                f"{len(hits)} are called '{key}': ask for one of "
                + ", ".join(f"'{_called(item)[0]}'" for item in hits)
            )
        raise UnknownNameError(f"there is no '{key}'{self._hint(key)}")

    def __contains__(self, key: object) -> bool:
        return bool(self._hits(key)) if isinstance(key, str) else super().__contains__(key)

    def names(self) -> tuple[str, ...]:
        """The names of all items, in their order."""
        return tuple(_called(item)[0] for item in self)

    def _hits(self, key: str) -> list[T]:
        """The items that a name means."""
        for rank in range(max((len(_called(item)) for item in self), default=0)):
            hits = [item for item in self if _called(item)[rank : rank + 1] == (key,)]
            if hits:
                return hits
        return []

    def _hint(self, key: str) -> str:
        if not self:
            return ": there is nothing here"
        known = list(dict.fromkeys(name for item in self for name in _called(item)))
        near = did_you_mean(key, known)
        near = near if "mean" in near else ""
        return f"{near}; there are: {', '.join(_listed(self))}"


if TYPE_CHECKING:

    class Items(Generic[T]):
        """A field that is given as any tuple and read as a :class:`ByName` one, for type checkers;
        :func:`name_items` makes it so."""

        @overload
        def __get__(self, instance: None, owner: Any) -> "Items[T]": ...
        @overload
        def __get__(self, instance: object, owner: Any) -> ByName[T]: ...
        def __get__(self, instance: Any, owner: Any) -> Any: ...
        def __set__(self, instance: Any, value: tuple[T, ...]) -> None: ...
else:
    Items = ByName


def name_items(value: object, *fields: str) -> None:
    """Turn fields of a frozen value that are plain tuples into :class:`ByName` ones."""
    for field in fields:
        items = getattr(value, field)
        if type(items) is not ByName:
            object.__setattr__(value, field, ByName(items))


def _called(item: Any) -> tuple[str, ...]:
    called = getattr(item, "called", None)
    return (item.name,) if called is None else called


def _listed(items: tuple[Any, ...]) -> Iterator[str]:
    for item in items[:LISTED]:
        first, *others = _called(item)
        more = [name for name in others if name != first]
        yield f"{first} ({', '.join(more)})" if more else first
    if len(items) > LISTED:
        yield f"and {len(items) - LISTED} more"

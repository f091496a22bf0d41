"""Variants of a law that was found: the same law with one key more, or another that it imitates.

They stand in no linear screen, so the list of candidates does not grow: a variant begins at the
values of the plain law and at a few values of the added key, spread over what the place moves
through.
"""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field

from symhyb.laws.reach import Candidate, Shape

Row = Mapping[str, float]
"""Values of the keys of a law, SI."""


@dataclass(frozen=True, slots=True)
class Pace:
    """How a place moves, SI: RMS and largest rate, and the time that the stretch (RMS about its
    mean) takes at the RMS rate, s; what presses there (see :class:`Load`), the speed within
    which dry friction turns over there, 0 where none is tried, and the mean stretch, its
    ``middle``."""

    rate: float
    fastest: float
    time: float
    loads: tuple["Load", ...] = ()
    turning: float = 0.0
    middle: float = 0.0


@dataclass(frozen=True, slots=True)
class Load:
    """What presses at a place: an expression of the model file, in SI, and its RMS ``size``, N."""

    text: str
    size: float


@dataclass(frozen=True, slots=True)
class Variant:
    """A law that is tried in place of a fitted one, from the values ``first`` of its keys, SI.

    ``added`` are the keys that make it a variant, ``tied`` those of them that grow with the first
    coefficient; a key that the plain law has too is tried about the value in ``tried``;
    ``options`` are words, or expressions, that it has beside those of the plain law, ``shape`` keys
    that are set and not fitted, ``bounds`` (key, lower, upper) those of added keys. One that names
    a ``product``, written with ``{s}`` for the coordinate, says with the plain law what the two say
    together, and is tried where that product would be. A variant of
    another ``law`` than the fitted one is one of its ``candidate``.
    """

    first: Row
    added: tuple[str, ...] = ()
    tied: tuple[str, ...] = ()
    tried: Row = field(default_factory=dict)
    options: tuple[tuple[str, str], ...] = ()
    shape: Shape = ()
    bounds: tuple[tuple[str, float, float], ...] = ()
    product: str = ""
    law: str = ""
    candidate: Candidate | None = None


Variants = Callable[[Row, Pace, Collection[str]], Iterable[Variant]]
"""What yields the variants of a law, from its fitted values, how its place moves, and the keys that
were added already."""


def no_variants(_: Row, __: Pace, ___: Collection[str]) -> Iterable[Variant]:
    """The variants of a law that has none."""
    return ()

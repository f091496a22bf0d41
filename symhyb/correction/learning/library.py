"""Candidate terms of a sparse regression: functions of stretch and rate at coordinates, in words.

    laws          1, s, s², s³, s', |s'|s', tanh(s'/w), and products of what moves
    polynomial    every monomial of positions and speeds

Up to a stated degree. With more than ``COUPLED`` coordinates a row sees curved terms of its own
coordinate only, and linear ones of all: the number of products would outgrow any recording.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Literal, get_args

from symhyb.errors import InputError, Problem, did_you_mean

LibraryName = Literal["laws", "polynomial"]
LIBRARIES: tuple[str, ...] = get_args(LibraryName)
DEGREE = 3  # of terms, unless another is asked for
DEGREE_MOST = 7  # beyond, monomials of one motion can no longer be distinguished
COUPLED = 3  # coordinates of which products are tried


@dataclass(frozen=True, slots=True)
class Candidate:
    """A term as an expression, in which ``{w}`` stands for the speed ``width`` (SI) over which a
    step is smoothed. Where it is a law of the vocabulary on coordinate ``of``, ``kind`` and ``key``
    say which; ``words`` name it for people."""

    template: str
    words: str
    of: str = ""
    kind: str = "law"
    key: str = ""
    width: float = 0.0

    @property
    def text(self) -> str:
        """The expression with all numbers in SI."""
        return self.template.format(w=repr(self.width))


def candidates(
    names: Sequence[str],
    row: str,
    widths: Mapping[str, float],
    library: LibraryName = "laws",
    degree: int = DEGREE,
) -> tuple[Candidate, ...]:
    """The terms that may act on the coordinate ``row`` of a model with coordinates ``names``;
    ``widths`` are the speeds (SI) over which dry friction on each is smoothed.

    Raises:
        InputError: an unknown library, or a degree that is none.
    """
    if library not in LIBRARIES:
        hint = did_you_mean(library, LIBRARIES)
        raise InputError(Problem(f"there is no library '{library}'{hint}"))
    if not 1 <= degree <= DEGREE_MOST:
        raise InputError(Problem(f"a degree of {degree} is none; give 1 to {DEGREE_MOST}"))
    near = tuple(names) if len(names) <= COUPLED else (row,)
    plain = (*_monomials(near, degree), *_monomials([n for n in names if n not in near], 1))
    if library == "polynomial":
        return (_constant(row), *plain)
    return (_constant(row), *_laws(plain, near, widths, degree))


def _constant(row: str) -> Candidate:
    return Candidate("1", "a constant", row, "constant", "constant")


def _laws(
    plain: Sequence[Candidate], near: Sequence[str], widths: Mapping[str, float], degree: int
) -> Iterator[Candidate]:
    """Springs, losses, and products of two different things that move."""
    for one in plain:
        squeezed = any(one.template == f"{x}**2*{x}'" for x in near)  # van der Pol
        if one.kind != "law" or one.template.count("*") == 1 or squeezed:
            yield one
    for x in near:
        if degree >= 2:
            words = f"drag quadratic in the speed of {x}"
            yield Candidate(f"abs({x}')*{x}'", words, x, "drag", "drag")
        words = f"dry (Coulomb) friction, by the sign of {x}'"
        if widths[x] > 0:
            yield Candidate(f"tanh({x}'/{{w}})", words, x, "friction", "coulomb", widths[x])


def _monomials(names: Sequence[str], degree: int) -> Iterator[Candidate]:
    """Monomials of positions and speeds up to a degree, low degrees first."""
    moving = [x for name in names for x in (name, f"{name}'")]
    for order in range(1, degree + 1):
        for factors in combinations_with_replacement(moving, order):
            powers = {x: factors.count(x) for x in dict.fromkeys(factors)}
            text = "*".join(x if n == 1 else f"{x}**{n}" for x, n in powers.items())
            yield _named(text, powers)


def _named(text: str, powers: Mapping[str, int]) -> Candidate:
    (first, order), *more = powers.items()
    if more:
        return Candidate(text, f"a product of {' and '.join(powers)}")
    name = first.removesuffix("'")
    if first == name and order <= 3:
        key = ("stiffness", "quadratic", "cubic")[order - 1]
        words = "linear stiffness" if order == 1 else f"{key} stiffness"
        return Candidate(text, f"{words} of {name}", name, "spring", key)
    if first != name and order == 1:
        return Candidate(text, f"viscous damping of {name}", name, "damper", "damping")
    return Candidate(text, f"a power of {first}", name)


def described(library: LibraryName, degree: int) -> str:
    """A library in words."""
    if library == "polynomial":
        return f"monomials of positions and speeds up to degree {degree}"
    return f"laws of stretch and rate and products of what moves, up to degree {degree}"

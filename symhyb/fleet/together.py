"""Numbers that one cause scales together, compared as one factor.

Numbers of a fit trade off: of friction in a fast recording a damper may take the share of dry
friction, so that each varies widely among peers and their sum hardly at all. Where one cause
changes them all by one factor f, that factor is what units are compared by. The numbers y of a
recording, with covariance S, are

    y = b + A x + e,    e ~ N(0, S),    x = (Aᵀ S⁻¹ A)⁻¹ Aᵀ S⁻¹ (y − b)

with b the medians of its peers. A has a column of the identity for each number that stays by
itself, and for each cause a column with b at the places of its numbers, so that x is f − 1 there.
It is the fit in which these numbers have the ratios that they have among peers, to first order of
the numbers (linear constraints on an estimate: Rao, Linear Statistical Inference, 1973, section
4a.9). Sizes: K numbers of a fit, L that are left.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.fleet.members import Member
from symhyb.fleet.population import Array
from symhyb.tasks.fitting import Fitted

Together = Mapping[str, Sequence[str]]
"""For each cause, by its name, the names of the numbers that it scales."""


def scaled_together(members: Sequence[Member], together: Together) -> tuple[Member, ...]:
    """The units with one factor, 1 for what is usual among peers, in place of the numbers of each
    cause.

    Raises:
        InputError: a cause without two numbers or with the name of one that stays, numbers that
            were not fitted, or one of two causes.
    """
    if not together:
        return tuple(members)
    names = members[0].fits[0].names
    problems = list(_wrong(names, together))
    if problems:
        raise InputError(problems)
    usual = _usual(members)
    return tuple(
        replace(
            one,
            fits=tuple(
                _scaled(fit, usual[row.tobytes()], together)
                for fit, row in zip(one.fits, one.peers, strict=True)
            ),
        )
        for one in members
    )


def _wrong(names: Sequence[str], together: Together) -> Iterable[Problem]:
    every = [number for numbers in together.values() for number in numbers]
    for cause, numbers in together.items():
        place = f"--together {cause}"
        if len(set(numbers)) < 2:
            yield Problem(f"needs two numbers or more, but has {len(set(numbers))}", place)
        if cause in set(names) - set(every):
            yield Problem(f"'{cause}' is the name of a number that stays by itself", place)
        for number in dict.fromkeys(numbers):
            if number not in names:
                yield Problem(f"'{number}' was not fitted{did_you_mean(number, names)}", place)
            elif every.count(number) > 1:
                yield Problem(f"'{number}' is named twice", place)


def _usual(members: Sequence[Member]) -> dict[bytes, Array]:
    """The median of each number (K,) of each group of peers, in its unit."""
    groups: dict[bytes, list[Array]] = {}
    for one in members:
        for fit, row in zip(one.fits, one.peers, strict=True):
            groups.setdefault(row.tobytes(), []).append(fit.values)
    return {key: np.median(values, axis=0) for key, values in groups.items()}


def _scaled(fit: Fitted, usual: Array, together: Together) -> Fitted:
    """A fit with factors behind the numbers that stay."""
    scaled = {number for numbers in together.values() for number in numbers}
    stay = [k for k, name in enumerate(fit.names) if name not in scaled]
    columns = [np.eye(usual.size)[k] for k in stay]
    for numbers in together.values():
        columns.append(np.where(np.isin(fit.names, list(numbers)), usual, 0.0))
    a, inverse = np.array(columns).T, _information(fit.covariance)
    information = a.T @ inverse @ a
    shown = np.diag(information) > 0
    covariance = np.diag(np.where(shown, 0.0, np.inf))
    covariance[np.ix_(shown, shown)] = _inverse(information[np.ix_(shown, shown)])
    moved = np.zeros(shown.size)
    right = a.T @ inverse @ (fit.values - usual)
    moved[shown] = covariance[np.ix_(shown, shown)] @ right[shown]
    values = moved + np.array([*(usual[k] for k in stay), *(1.0 for _ in together)])
    return replace(
        fit,
        names=(*(fit.names[k] for k in stay), *together),
        units=(*(fit.units[k] for k in stay), *("1" for _ in together)),
        values=values,
        covariance=covariance,
    )


def _information(covariance: Array) -> Array:
    """The inverse (K, K) of a covariance, 0 of numbers that are not determined."""
    known = np.isfinite(np.diag(covariance))
    found = np.zeros_like(covariance)
    found[np.ix_(known, known)] = _inverse(covariance[np.ix_(known, known)])
    return found


def _inverse(matrix: Array) -> Array:
    """The inverse of a positive matrix, balanced; numbers have units of their own."""
    size = np.sqrt(np.diag(matrix))
    balanced = np.linalg.pinv(matrix / np.outer(size, size), hermitian=True)
    return np.asarray(balanced / np.outer(size, size))

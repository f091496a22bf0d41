"""Which uncertain parameters the recordings determine, and which only together.

Columns of parameters that are not independent along a motion have no values of their own, only
values of combinations: the base parameters of robotics. They come from QR with column pivoting,
here of the information G (χ² by the parameters, everything else projected out), scaled by what was
known before, so that a column counts by how much it narrows its parameter. A parameter whose
column, given those of the pivots before it, says less than its prior is determined together with
these alone:

    θ_i + Σ_j β_ij (sd_i / sd_j) θ_j          i determined, j not

Sizes: P parameters, D determined, T determined together.

Source: Gautier, Numerical calculation of the base inertial parameters of robots, Journal of Robotic
Systems 8, 1991.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.correction.advice.isolability import Along, computable
from symhyb.correction.search.score import unit_of
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.fitting.normal import shortest_solution
from symhyb.discrepancy.words.amounts import joined, number_text
from symhyb.judgement import SMALL
from symhyb.numeric.kernels.buffers import Array

DIGITS = 3  # of a factor in a combination


@dataclass(frozen=True, slots=True)
class Base:
    """The parameters (numbers in the order given) that are ``determined``, those that ``nothing``
    shows, and of all others, which are known ``together``, by how much they change each determined
    one: ``factors`` (D, T), dimensionless."""

    determined: tuple[int, ...]
    nothing: tuple[int, ...]
    together: tuple[int, ...]
    factors: Array


def base_of(information: Array) -> Base:
    """The base parameters of an ``information`` matrix (P, P), in units of the priors: 1 is as much
    as was known before."""
    rest = np.array(information, dtype=float)
    size = len(rest)
    nothing = tuple(int(i) for i in np.flatnonzero(~(np.diag(rest) > 1)))
    order: list[int] = []
    while len(order) < size:
        told = np.where(np.isin(np.arange(size), order), -np.inf, np.diag(rest))
        best = int(np.argmax(told))
        if not told[best] > 1:
            break
        order.append(best)
        rest = rest - np.outer(rest[best], rest[best]) / rest[best, best]
    pivots = tuple(sorted(order))
    others = tuple(i for i in range(size) if i not in order and i not in nothing)
    inner = information[np.ix_(pivots, pivots)]
    factors = np.zeros((len(pivots), len(others)))
    for j, other in enumerate(others):
        factors[:, j] = np.linalg.solve(inner, information[list(pivots), other])
    return Base(pivots, nothing, others, factors)


def combined(setting: Setting, selected: Refined, along: Along) -> tuple[str, ...]:
    """What the recordings do not determine of the parameters that state an sd, as sentences; none
    where each is determined, or where fewer than two are uncertain."""
    declared = {item.path: item for item in setting.windows.machine.model.all_parameters()}
    paths = [
        cause.path
        for cause in setting.parametric
        if cause.kind == "parameter" and declared[cause.path].sd is not None
    ]
    if len(paths) < 2:
        return ()
    problem = along()
    where = {cause.path: i for i, cause in enumerate(problem.hypotheses) if cause.place is None}
    columns = [problem.columns[where[path]] for path in paths]
    if any(len(own) != 1 for own in columns):  # each recording has its own
        return ()
    mine = [own[0] for own in columns]
    others = [c for c in problem.always if c not in mine]
    gram = computable((problem.gram + problem.held)[:-1, :-1])
    spread = np.array([declared[path].si_sd for path in paths], dtype=float)
    information = _alone(gram, mine, others) * np.outer(spread, spread) / unit_of(selected)
    stated = np.array([declared[path].sd for path in paths], dtype=float)
    return tuple(_said(base_of(information), paths, stated))


def _alone(gram: Array, mine: Sequence[int], others: Sequence[int]) -> Array:
    """The Gram matrix (P, P) of some columns, of which the others' part is taken out."""
    own, cross = gram[np.ix_(mine, mine)], gram[np.ix_(others, mine)]
    if not others:
        return own
    inner = gram[np.ix_(others, others)]
    taken = np.column_stack([shortest_solution(inner, column) for column in cross.T])
    left = own - cross.T @ taken
    return np.asarray((left + left.T) / 2)


def _said(base: Base, names: Sequence[str], sd: Array) -> list[str]:
    """The sentences; ``sd`` (P,) in the units of the parameters."""
    found = []
    if base.nothing:
        quiet = joined([names[i] for i in base.nothing])
        found.append(f"These recordings say no more about {quiet} than the model states.")
    sums = []
    for row, i in zip(base.factors, base.determined, strict=True):
        parts = [
            _term(float(factor * sd[i] / sd[j]), names[j])
            for factor, j in zip(row, base.together, strict=True)
            if abs(factor) > SMALL
        ]
        if parts:
            sums.append(f"{names[i]} {' '.join(parts)}")
    if base.together:
        alone = joined([names[i] for i in base.together])
        sentence = f"These recordings do not determine {alone} separately"
        sums_said = f", only in {joined(sums)} (numbers in the units of the model file)"
        found.append(sentence + (sums_said if sums else "") + ".")
    return found


def _term(factor: float, name: str) -> str:
    return f"{'-' if factor < 0 else '+'} {number_text(abs(factor), digits=DIGITS)} {name}"

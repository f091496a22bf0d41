"""A fleet: what its units have in common, the own values of each, and those that deviate, named.

Sizes: N units, K numbers, C conditions without the constant one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.special import ndtr

from symhyb.errors import InputError, Problem
from symhyb.fleet.deviations import Judged, Shifted, judged, shifted
from symhyb.fleet.means import Array, Unit
from symhyb.fleet.members import Member, members_of
from symhyb.fleet.population import Population
from symhyb.fleet.rungs import Weighed, with_structure
from symhyb.fleet.scales import factors_of, units_in
from symhyb.fleet.trends import OwnTrend, own_trends
from symhyb.judgement import FEWEST, SMALL
from symhyb.tasks.outcome import FAILED, NOT_RUN, Outcomes


@dataclass(frozen=True, slots=True)
class Slope:
    """By how much a number changes with one unit of a ``condition``, ± ``sd``, in its unit, or as
    a part of itself where it varies by factors; ``probability`` of as much if it does not."""

    condition: str
    value: float
    sd: float
    probability: float


@dataclass(frozen=True, slots=True)
class Common:
    """One number of all units: ``mean`` ± ``sd`` at mean conditions and the standard deviation
    ``spread`` ± ``spread_sd`` between units, in ``unit``; with ``factors`` the mean is the
    geometric one, and spreads and slopes are parts of it. ``within`` is the spread between
    recordings of one unit, None where none has several."""

    name: str
    unit: str
    factors: bool
    mean: float
    sd: float
    spread: float
    spread_sd: float
    within: float | None
    slopes: tuple[Slope, ...]


@dataclass(frozen=True, slots=True)
class Off:
    """A number of a unit that deviates: ``by`` ± ``sd`` from what the others have under the same
    conditions, in its unit, and as a ``part`` of that (None where it is near 0)."""

    name: str
    unit: str
    by: float
    sd: float
    part: float | None


@dataclass(frozen=True, slots=True)
class Trend:
    """A number of a unit that changes with a ``condition`` by more than that of the others does:
    ``by`` ± ``sd`` over the range of its own recordings, in its ``unit``, or as a part of itself
    where it varies by factors."""

    name: str
    unit: str
    condition: str
    by: float
    sd: float
    factors: bool


@dataclass(frozen=True, slots=True)
class Reason:
    """Why a unit is named. ``structure``: its fit leaves ``times`` the noise that the fits of the
    others leave, and its numbers say nothing; ``numbers``: these are off, and ``rivals`` are sets
    that explain it nearly as well; ``trend``: it changes otherwise, as its ``trends`` say, which
    may come on top of numbers that are off. ``probability`` is that of as much by chance, corrected
    for the number of units."""

    kind: Literal["structure", "numbers", "trend"]
    probability: float
    off: tuple[Off, ...] = ()
    rivals: tuple[tuple[str, ...], ...] = ()
    times: float = 1.0
    trends: tuple[Trend, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The numbers that deviate or change otherwise."""
        off = [one.name for one in self.off]
        return tuple(dict.fromkeys([*off, *(one.name for one in self.trends)]))


@dataclass(frozen=True, slots=True, eq=False)
class Own:
    """A unit: the estimates of its recordings alone, ``values`` ± ``sd`` (K,), and those with what
    the population says of it, ``shrunken`` ± ``shrunken_sd`` (K,), under its own ``conditions``
    (C,), all in the units of the model file. ``left`` is the noise multiple of its fits;
    ``information`` how much its recordings say of the best of the numbers, as a part of what those
    of a median unit do. ``reason`` is None where it is one of the others."""

    name: str
    tasks: tuple[str, ...]
    conditions: Array
    values: Array
    sd: Array
    shrunken: Array
    shrunken_sd: Array
    left: float
    information: float
    reason: Reason | None
    bounds: tuple[str, ...] = ()

    @property
    def adds_nothing(self) -> bool:
        """Whether its recordings say next to nothing of any number that those of others show."""
        return self.information < SMALL


@dataclass(frozen=True, slots=True, eq=False)
class Fleet:
    """All units of a study: ``numbers`` (K) of the population, the ``units`` (N), the names of the
    ``conditions`` (C) and their ``centre`` (C,); how many tasks ``failed`` or were ``not_run``;
    ``tested`` is whether there are enough units to say which of them deviate. Where tasks compared
    ``structures`` the numbers are those of one ``structure``; units are compared with those that
    have the same values of the groupings ``among``. Of groups of peers of which no more than half
    are alike nobody is named: their units are ``disputed``."""

    title: str
    numbers: tuple[Common, ...]
    units: tuple[Own, ...]
    conditions: tuple[str, ...]
    centre: Array
    failed: int
    not_run: int
    tested: bool
    structures: tuple[Weighed, ...] = ()
    structure: str = ""
    among: tuple[str, ...] = ()
    disputed: tuple[str, ...] = ()

    @property
    def deviating(self) -> tuple[Own, ...]:
        """The units that are named, most improbable first."""
        named = [one for one in self.units if one.reason is not None]
        return tuple(sorted(named, key=lambda one: one.reason.probability if one.reason else 1.0))


def fleet_of(
    outcomes: Outcomes,
    unit: str = "",
    conditions: Sequence[str] = (),
    among: Sequence[str] = (),
    structure: str = "",
) -> Fleet:
    """The fleet of a study whose tasks fit, by the grouping ``unit`` or a unit a task, and how its
    numbers depend on ``conditions``: groupings with numbers, or known parameters. Each unit is
    compared with those that share the groupings ``among``, which have a mean of their own. Where
    tasks compared structures, the numbers are those of one of them, the likeliest unless one is
    named.

    Raises:
        InputError: tasks that diagnose, that vary more than the recordings, or that fitted other
            numbers; groupings or conditions that recordings do not state, or that are no numbers;
            no structure of that name; fewer than three units, or conditions that do not vary or
            follow from each other or from the groupings.
    """
    structures, name, outcomes = with_structure(outcomes, structure)
    members = members_of(outcomes, unit, conditions, among)
    centre = _centre(members, conditions)
    size = members[0].fits[0].values.size
    left = np.array([min(max(one.left, 1e-30), 1e30) for one in members])
    freedom = np.array([one.freedom for one in members])
    units = units_in(members, [False] * size, centre)
    found = judged(units, left, freedom)
    factors = factors_of(members, centre, found.kept.tolist())
    if any(factors):
        units = units_in(members, factors, centre)
        found = judged(units, left, freedom)
    own = own_trends(units, found.population)
    states = [one.state for one in outcomes.tasks]
    information = _information(units)
    return Fleet(
        outcomes.title,
        tuple(_common(found.population, members[0], factors, conditions, k) for k in range(size)),
        tuple(
            _own(
                member,
                units[i],
                found,
                i,
                factors,
                float(information[i]),
                left,
                _trends(member, own[i], conditions, factors),
            )
            for i, member in enumerate(members)
        ),
        tuple(conditions),
        centre,
        states.count(FAILED),
        states.count(NOT_RUN),
        found.tested,
        structures,
        name,
        tuple(among),
        tuple(one.name for one, is_so in zip(members, found.disputed, strict=True) if is_so),
    )


def _centre(members: Sequence[Member], conditions: Sequence[str]) -> Array:
    """The mean conditions (C,), those of every unit counting once.

    Raises:
        InputError: fewer than three units, or conditions that do not vary, or together.
    """
    if len(members) < FEWEST:
        text = f"{len(members)} units are no fleet; at least {FEWEST} must have been fitted"
        raise InputError(Problem(text))
    rows = np.concatenate([one.conditions for one in members])
    centre = np.array([one.conditions.mean(axis=0) for one in members]).mean(axis=0)
    spread = rows.std(axis=0)
    still = [name for name, width in zip(conditions, spread, strict=True) if not width > 0]
    if still:
        raise InputError(Problem("is the same in all recordings", f"condition {n}") for n in still)
    peers = np.concatenate([one.peers for one in members])
    scaled, several = np.column_stack([(rows - centre) / spread, peers]), peers.shape[1] > 1
    if np.linalg.matrix_rank(scaled) < scaled.shape[1]:
        text = "these conditions follow from each other, so that none has a slope of its own"
        if several:
            text = "these conditions do not vary within the groups of peers, or follow from another"
        raise InputError(Problem(text, f"conditions {', '.join(conditions)}"))
    if len(members) <= scaled.shape[1]:
        groups = f" and {peers.shape[1]} groups of peers" if several else ""
        text = f"{len(members)} units are too few for {len(conditions)} conditions{groups}"
        raise InputError(Problem(text))
    return np.asarray(centre)


def _information(units: Sequence[Unit]) -> Array:
    """What the recordings of each unit say of the best of its numbers (N,), as a part of what those
    of a median unit say of that number."""
    said = np.array([np.sum(1 / np.diagonal(one.s, axis1=1, axis2=2), axis=0) for one in units])
    return np.asarray(np.max(said / np.median(said, axis=0), axis=1))


def _common(
    found: Population, member: Member, factors: Sequence[bool], conditions: Sequence[str], k: int
) -> Common:
    size = found.between.shape[0]
    sd = np.sqrt(np.diag(found.covariance)).reshape(-1, size)[:, k]
    mean, one = float(found.beta[0, k]), member.fits[0]
    slopes = []
    for name, value, error in zip(conditions, found.beta[1:, k], sd[1:], strict=True):
        chance = float(2 * ndtr(-abs(value) / error)) if error > 0 else 1.0
        slopes.append(Slope(name, float(value), float(error), chance))
    within = float(np.sqrt(found.within[k, k])) if found.within.any() else None
    spread, spread_sd = float(np.sqrt(found.between[k, k])), float(found.spread_sd[k])
    by_factor = factors[k]
    return Common(
        one.names[k],
        one.units[k],
        by_factor,
        float(np.exp(mean)) if by_factor else mean,
        float(np.exp(mean) * sd[0]) if by_factor else float(sd[0]),
        spread,
        spread_sd,
        within,
        tuple(slopes),
    )


def _own(
    member: Member,
    unit: Unit,
    found: Judged,
    at: int,
    factors: Sequence[bool],
    information: float,
    left: Array,
    trend: tuple[tuple[Trend, ...], float],
) -> Own:
    size = unit.y.shape[1]
    z = np.tile(np.eye(size), (len(unit.y), 1))
    population = found.population
    rest, error = population.rest(unit)
    expected = (unit.y - rest.reshape(unit.y.shape)).mean(axis=0)
    of_expected = z.T @ error @ z / len(unit.y) ** 2
    inside = population.variance(unit) - np.kron(
        np.ones((len(unit.y), len(unit.y))), population.between
    )
    inverse = z.T @ np.linalg.solve(inside, z)
    alone = np.linalg.inv(inverse)
    value = expected + alone @ (z.T @ np.linalg.solve(inside, rest))
    gain = population.between @ z.T @ np.linalg.inv(population.variance(unit))
    shrunken = expected + gain @ rest
    kept = np.eye(size) - gain @ z
    spread = kept @ population.between
    spread = spread + kept @ of_expected @ kept.T
    by_factor = np.array(factors, dtype=bool)

    def back(y: Array) -> Array:
        return np.where(by_factor, np.exp(np.where(by_factor, y, 0.0)), y)

    def sd_back(y: Array, covariance: Array) -> Array:
        sd = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        return np.where(by_factor, back(y) * sd, sd)

    return Own(
        member.name,
        member.tasks,
        member.conditions.mean(axis=0),
        back(value),
        sd_back(value, alone),
        back(shrunken),
        sd_back(shrunken, spread),
        float(np.sqrt(left[at])),
        information,
        _reason(member, found, at, back(expected), by_factor.tolist(), left, trend),
        member.bounds,
    )


def _reason(
    member: Member,
    found: Judged,
    at: int,
    expected: Array,
    factors: Sequence[bool],
    left: Array,
    trend: tuple[tuple[Trend, ...], float],
) -> Reason | None:
    """Why a unit is named, None if it is one of the others."""
    if found.structure(at):
        times = float(np.sqrt(left[at] / found.usual[at]))
        return Reason("structure", float(found.by_rest[at]), times=times)
    trends, chance = trend
    if not found.deviates(at):
        return Reason("trend", chance, trends=trends) if trends else None
    one = shifted(found.deviations[at])
    names = member.fits[0].names

    def named(places: Sequence[int]) -> tuple[str, ...]:
        return tuple(names[k] for k in places)

    off = _offs(member, one, expected, factors)
    rivals, likely = tuple(map(named, one.rivals)), float(found.by_numbers[at])
    return Reason("numbers", likely, off, rivals, trends=trends)


def _trends(
    member: Member, own: OwnTrend | None, conditions: Sequence[str], factors: Sequence[bool]
) -> tuple[tuple[Trend, ...], float]:
    """What a unit has of its own slopes, and how probable that is by chance."""
    if own is None:
        return (), 1.0
    fit, range_ = member.fits[0], np.ptp(member.conditions, axis=0)
    found = [
        Trend(
            fit.names[one.number],
            fit.units[one.number],
            conditions[one.at],
            one.value * float(range_[one.at]),
            one.sd * float(range_[one.at]),
            factors[one.number],
        )
        for one in own.slopes
    ]
    return tuple(found), own.probability


def _offs(
    member: Member, one: Shifted, expected: Array, factors: Sequence[bool]
) -> tuple[Off, ...]:
    fit, found = member.fits[0], []
    for k, by, sd in zip(one.numbers, one.by, one.sd, strict=True):
        mean = float(expected[k])
        if factors[k]:
            by, sd = mean * float(np.expm1(by)), mean * float(np.exp(by) * sd)
        part = float(by) / mean if abs(mean) > float(sd) else None
        found.append(Off(fit.names[k], fit.units[k], float(by), float(sd), part))
    return tuple(found)

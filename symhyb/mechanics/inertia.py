r"""The rows of M, k_c and gravity: what bodies, added masses and declared energies give.

Every body, and every element that carries mass along, has kinetic energy of the form Σ mass·w'²/2
in positions (or angles) w(q,t), so that

    M_ij = Σ mass·(∂w/∂q_i)(∂w/∂q_j)
    k_c,i = Σ (∂w/∂q_i)·(mass·w''|_{q''=0} + mass'·w') − (∂mass/∂q_i)·w'²/2

which are Lagrange's equations term by term. mass' is by places alone: what leaves in time takes its
momentum along. What declared energies add follows from p = ∂T/∂v.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import sympy as sp

from symhyb.mechanics.equations import Couple, Equations, Mutual, Term, Turning, Vectorial
from symhyb.mechanics.rows import ONE, Named, Row, Short, Slopes, product
from symhyb.mechanics.spinning import length, length_inertia
from symhyb.mechanics.symbols import to_sympy
from symhyb.mechanics.tidy import along, exact, terms
from symhyb.model.types import Model

Tidy = Callable[[sp.Expr], sp.Expr]


@dataclass(frozen=True, slots=True)
class Moving:
    """The kinetic energy mass·w'²/2 of ``source`` by its ``path`` w(q, t), called ``axis``."""

    source: str
    axis: str
    mass: sp.Expr
    path: sp.Expr

    @property
    def owner(self) -> str:
        """The body by its name, an element with its section."""
        return self.source.removeprefix("bodies.").removeprefix("length of ")


def moving_parts(equations: Equations) -> tuple[Moving, ...]:
    """All that has mass, in the order of the model file."""
    return tuple(_moving(equations))


def _moving(equations: Equations) -> Iterator[Moving]:
    for body in equations.masses:
        source = f"bodies.{body.body}"
        for axis, path in zip("xyz", body.centre, strict=False):
            yield Moving(source, axis, body.mass, path)
        if body.inertia != 0:
            yield Moving(source, "angle", body.inertia, body.angle)
        if body.quaternion is not None:
            path = length(body.quaternion[0])
            yield Moving(f"length of {body.body}", "n", length_inertia(body.tensor), path)
    for term in equations.terms:
        if isinstance(term, Couple | Mutual):
            continue
        if term.law is not None and term.law.mass != 0:
            for axis, path in _paths(term):
                yield Moving(f"elements.{term.element}", axis, term.law.mass, path)


def _paths(term: Term | Turning | Vectorial) -> Iterable[tuple[str, sp.Expr]]:
    """In what the mass of an element moves, each with its name; none of one that turns in space."""
    match term:
        case Term():
            return (("s", term.path),)
        case Vectorial():
            return zip("xyz", term.position, strict=False)
        case Turning():
            return () if term.omega else (("angle", term.angle),)


def effort(parts: tuple[Moving, ...], slopes: Slopes) -> int:
    """How many terms M and k_c would have when multiplied out."""
    total = 0
    for part in parts:
        counts = [terms(slope) for by in slopes.by if (slope := by(part.path)) != 0]
        bias = slopes.bias(part.path)
        total += sum(counts) * (sum(counts) + (terms(bias) if bias != 0 else 0))
    return total


def named_motion(model: Model, parts: tuple[Moving, ...], slopes: Slopes) -> tuple[Named, ...]:
    """Names for the derivatives of the positions of a large model: ∂w/∂q, and w'' in two parts."""
    found: dict[sp.Expr, Named] = {}
    for part in parts:
        axis, owner = part.axis, part.owner
        entries = [
            (by(part.path), f"{axis}({owner})_{coordinate.name}", "slope", coordinate.name)
            for by, coordinate in zip(slopes.by, model.coordinates, strict=True)
        ]
        entries.append((slopes.pull(part.path), f"{axis}({owner})''_M", "pull", ""))
        entries.append((slopes.bias(part.path), f"{axis}({owner})''_c", "bias", ""))
        for value, name, kind, coordinate in entries:
            if sp.count_ops(value) > 1:  # else no name is shorter
                owners = (axis, owner, coordinate) if coordinate else (axis, owner)
                item = Named(sp.Symbol(name, real=True), value, kind, owners)
                found.setdefault(value, item)
    return tuple(found.values())


def kinetic_rows(
    parts: tuple[Moving, ...], slopes: Slopes, tidy: Tidy, short: Short, matrices: bool
) -> Iterator[Row]:
    """What bodies and added masses give to M (for ``matrices`` on and above its diagonal) and k_c.

    Derivatives that have a name in ``short`` are written by it, and then M q'' is not written entry
    by entry but by the accelerations w''.
    """
    compact = any(item.name.endswith("''_M") for item in short.values() if item.is_Symbol)

    def called(value: sp.Expr) -> sp.Expr:
        return short[value] if value in short else value.xreplace(short)

    for source in dict.fromkeys(part.source for part in parts):
        own = [part for part in parts if part.source == source]
        masses = [part.mass for part in own]
        lean = [[called(by(part.path)) for part in own] for by in slopes.by]  # (n, parts) ∂w/∂q
        pulls = [called(slopes.pull(part.path)) for part in own]
        biases = [
            part.mass * called(slopes.bias(part.path))
            + slopes.moved(part.mass) * called(slopes.rate(part.path))
            for part in own
        ]
        swings = [called(slopes.rate(part.path)) ** 2 / 2 for part in own]
        for i, row in enumerate(lean):
            if matrices:
                for j in range(i, len(lean)):
                    yield Row("M", (i, j), source, product(masses, row, lean[j]))
            elif compact:
                yield Row("M", (i,), source, product(masses, row, pulls))
            else:
                entries = [tidy(product(masses, row, other)) for other in lean]
                yield Row("M", (i,), source, product(entries, slopes.symbols.a))
            swelling = map(slopes.by[i], masses)
            force = product(row, biases) - product(swelling, swings)
            yield Row("k_c", (i,), source, tidy(force))


def declared_rows(
    model: Model, equations: Equations, slopes: Slopes, tidy: Tidy, matrices: bool
) -> Iterator[Row]:
    """p = ∂T/∂v, M = ∂p/∂v, k_c = (∂p/∂q) v + ∂p/∂t − ∂T/∂q, and −∂V/∂q of declared energies."""
    s, kinetic = equations.symbols, equations.kinetic
    speed = [along({v: ONE}) for v in s.v]
    for i, (by_speed, by) in enumerate(zip(speed, slopes.by, strict=True)):
        momentum = by_speed(kinetic)
        entries = [tidy(other(momentum)) for other in speed]
        if matrices:
            for j in range(i, len(entries)):
                yield Row("M", (i, j), "energy.kinetic", entries[j])
        else:
            yield Row("M", (i,), "energy.kinetic", product(entries, s.a))
        yield Row("k_c", (i,), "energy.kinetic", tidy(slopes.rate(momentum) - by(kinetic)))
        if model.energy.potential is not None:
            force = -by(exact(to_sympy(model.energy.potential, s.scope)))
            yield Row("k_e", (i,), "energy.potential", tidy(force))


def gravity_rows(equations: Equations, slopes: Slopes, tidy: Tidy, short: Short) -> Iterator[Row]:
    """The weight of each body on each coordinate."""
    for body in equations.masses:
        for i, by in enumerate(slopes.by):
            leans = [short.get(value, value) for value in map(by, body.centre)]
            weight = product(equations.gravity, leans)
            yield Row("k_e", (i,), f"gravity on {body.body}", tidy(body.mass * weight))

r"""The rows of M and k_c that the turning of bodies in space gives, and what keeps quaternions.

The energy ½ ωᵀJω by the angular velocity ω(q, q', t) in the axes of the body gives

    M_i q'' = (∂ω/∂q_i')·J ω'|_M
    k_c,i = (∂ω/∂q_i')·(J ω'|_{q''=0} + J' ω + ω × J ω) − ½ ωᵀ(∂J/∂q_i)ω

which are Lagrange's equations written with ω (Kane's equations of a rigid body); J' is by places
alone, and 0 unless J depends on one.

Source: T. R. Kane, D. A. Levinson, Dynamics: Theory and Applications, McGraw-Hill 1985, ch. 6.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import sympy as sp

from symhyb.mechanics.attitude import Vector, crossed, dotted, spun
from symhyb.mechanics.equations import Equations, Turning
from symhyb.mechanics.rows import ONE, Named, Row, Slopes
from symhyb.mechanics.tidy import along, terms
from symhyb.model.types import Model

Tidy = Callable[[sp.Expr], sp.Expr]
GUIDED, GUIDED_LEAST = sp.Integer(3), ONE  # as in symhyb.numeric.lowered.translate


@dataclass(frozen=True, slots=True)
class Spinning:
    """What turns with a ``body`` in space, the ``source`` of its rows: the tensor J (6,), its rate
    by places (``swelling``, 6) and its slopes by each of them (``by``, n, 6), and of ω (3,) in its
    axes the ``slopes`` by each q' (n, 3), the part of ω' that goes with q'' (``pull``) and the rest
    (``bias``)."""

    source: str
    body: str
    tensor: Vector
    swelling: Vector
    by: tuple[Vector, ...]
    omega: Vector
    slopes: tuple[Vector, ...]
    pull: Vector
    bias: Vector


def spinning_bodies(equations: Equations, slopes: Slopes) -> tuple[Spinning, ...]:
    """All that turns in space, bodies before elements, in the order of the model file."""
    symbols = equations.symbols
    by_rate = [along({v: ONE}) for v in symbols.v]
    with_pull = along(dict(zip(symbols.v, symbols.a, strict=True)))
    found = []
    for source, body, tensor, turned in _turning(equations):
        rates = {symbol: slopes.rate(angle) for symbol, angle in _rates(equations, body)}
        omega = tuple(part.xreplace(rates) for part in turned)
        found.append(
            Spinning(
                source,
                body,
                tensor,
                tuple(map(slopes.moved, tensor)),
                tuple(tuple(map(by, tensor)) for by in slopes.by),
                omega,
                tuple(tuple(map(by, omega)) for by in by_rate),
                tuple(map(with_pull, omega)),
                tuple(map(slopes.rate, omega)),
            )
        )
    return tuple(found)


def _turning(equations: Equations) -> Iterator[tuple[str, str, Vector, Vector]]:
    """Source, body, tensor (6,) and ω (3,) of all that turns in space."""
    for mass in equations.masses:
        if any(mass.tensor):
            yield f"bodies.{mass.body}", mass.body, mass.tensor, mass.omega
    for term in equations.terms:
        if isinstance(term, Turning) and term.omega:
            tensor = (*(term.law.mass,) * 3, *(sp.Integer(0),) * 3)
            yield f"elements.{term.element}", term.body, tensor, term.omega


def _rates(equations: Equations, body: str) -> tuple[tuple[sp.Symbol, sp.Expr], ...]:
    return equations.places.attitude(body).rates


def spin_effort(bodies: tuple[Spinning, ...]) -> int:
    """How many terms these rows of M and k_c would have when multiplied out."""
    total = 0
    for body in bodies:
        lean = sum(terms(part) for slope in body.slopes for part in slope if part != 0)
        rest = sum(terms(part) for part in (*body.pull, *body.bias) if part != 0)
        turn = sum(terms(part) for part in body.omega if part != 0)
        total += lean * (rest + turn**2)
    return total


def named_turning(model: Model, bodies: tuple[Spinning, ...]) -> tuple[Named, ...]:
    """Names for ω and its derivatives, of a large model."""
    found: dict[sp.Expr, Named] = {}
    for body in bodies:
        entries: list[tuple[Vector, str, str, str]] = [
            (slope, f"_{coordinate.name}'", "turn slope", coordinate.name)
            for slope, coordinate in zip(body.slopes, model.coordinates, strict=True)
        ]
        entries += [(body.omega, "", "turn", ""), (body.pull, "'_M", "turn pull", "")]
        entries.append((body.bias, "'_c", "turn bias", ""))
        for values, mark, kind, coordinate in entries:
            for axis, value in zip("xyz", values, strict=True):
                if sp.count_ops(value) > 1:
                    symbol = sp.Symbol(f"omega_{axis}({body.body}){mark}", real=True)
                    owners = (axis, body.body, coordinate) if coordinate else (axis, body.body)
                    found.setdefault(value, Named(symbol, value, kind, owners))
    return tuple(found.values())


def spin_rows(
    bodies: tuple[Spinning, ...],
    symbols_a: tuple[sp.Symbol, ...],
    tidy: Tidy,
    short: dict[sp.Basic, sp.Expr],
    matrices: bool,
) -> Iterator[Row]:
    """What turning in space gives to M (for ``matrices`` on and above its diagonal) and k_c."""
    for body in bodies:

        def called(vector: Vector) -> Vector:
            return tuple(short.get(value, value) for value in vector)

        omega, lean = called(body.omega), [called(slope) for slope in body.slopes]
        gyroscopic = crossed(omega, spun(body.tensor, omega))
        bias = spun(body.tensor, called(body.bias))
        swelling = spun(body.swelling, omega)
        force = tuple(map(sp.Add, bias, gyroscopic, swelling))
        compact = spun(body.tensor, called(body.pull)) if short else None
        for i, row in enumerate(lean):
            entries = [dotted(row, spun(body.tensor, other)) for other in lean]
            if matrices:
                for j in range(i, len(lean)):
                    yield Row("M", (i, j), body.source, entries[j])
            elif compact is not None:
                yield Row("M", (i,), body.source, dotted(row, compact))
            else:
                yield Row("M", (i,), body.source, dotted([tidy(x) for x in entries], symbols_a))
            lost = dotted(omega, spun(body.by[i], omega)) / 2
            yield Row("k_c", (i,), body.source, tidy(dotted(row, force) - lost))


def couple_force(torque: Vector, omega: Vector, slopes: Slopes) -> Iterator[sp.Expr]:
    """(∂ω/∂q')ᵀ torque of a torque on a body, for each coordinate."""
    for v in slopes.symbols.v:
        by = along({v: ONE})
        yield dotted(torque, tuple(map(by, omega)))


def length_rows(equations: Equations, slopes: Slopes) -> Iterator[Row]:
    """What lets the length e^n of a quaternion return to 1: −I (2 g n' + g² n) ∂n/∂q."""
    for mass in equations.masses:
        if mass.quaternion is None:
            continue
        parts, rates = mass.quaternion
        size = sp.Add(*(part**2 for part in parts))
        rate = dotted(parts, rates) / size
        turned = 4 * (sp.Add(*(v**2 for v in rates)) / size - rate**2)
        quick = GUIDED**2 * turned + GUIDED_LEAST**2
        pull = -length_inertia(mass.tensor) * (2 * sp.sqrt(quick) * rate + quick * length(parts))
        for i, by in enumerate(slopes.by):
            yield Row("k_e", (i,), f"length of {mass.body}", pull * by(length(parts)))


def length(parts: Vector) -> sp.Expr:
    """n of a quaternion of the length e^n."""
    return sp.log(sp.Add(*(part**2 for part in parts))) / 2


def length_inertia(tensor: Vector) -> sp.Expr:
    """The inertia I of that length: four times the mean of the moments of inertia, kg·m²."""
    return sp.Rational(4, 3) * sp.Add(*tensor[:3])

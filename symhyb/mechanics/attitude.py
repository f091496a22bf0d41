r"""How bodies in space are turned: the axes of a frame, and its angular velocity.

    R = R_parent · E₁(a₁) · E₂(a₂) …          columns: the axes of the body in the inertial ones
    ω = (… E₂ᵀ(E₁ᵀ ω_parent + e₁ a₁') + e₂ a₂' …)     in the axes of the body

           e₂ ^                       each step turns about an axis of the body as the steps
              |  a₂                   before have turned it; ω gathers their rates on the way
              o----> e₁, a₁

A quaternion (w, x) counts by its direction alone, with N = w² + |x|²:

    R = [(w² − |x|²) 1 + 2 x xᵀ + 2 w [x]×] / N,    ω = 2 (w x' − w' x − x × x') / N

which are R and ω of the quaternion divided by its length: no force and no energy depends on it.
The rate of an angle is a plain symbol here; :mod:`symhyb.numeric.lowered.translate` differentiates.

Source: J. Diebel, Representing Attitude: Euler Angles, Unit Quaternions, and Rotation Vectors,
Stanford University, 2006 (his matrices are those of the inverse rotation).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from symhyb.mechanics.symbols import Symbols, to_sympy
from symhyb.model.turned import Quaternion, Rotations
from symhyb.model.types import Body

Vector = tuple[sp.Expr, ...]
Matrix = tuple[Vector, ...]
ZERO, ONE = sp.Integer(0), sp.Integer(1)
STILL: Vector = (ZERO, ZERO, ZERO)
UPRIGHT: Matrix = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))


@dataclass(frozen=True, slots=True)
class Attitude:
    """``axes`` (3, 3) of a frame as columns in the inertial axes, its angular velocity ``omega``
    (3,) in its own axes, rad/s, and the ``rates``: symbols in omega that stand for the rates of
    angles."""

    axes: Matrix = UPRIGHT
    omega: Vector = STILL
    rates: tuple[tuple[sp.Symbol, sp.Expr], ...] = ()


@dataclass(frozen=True, slots=True)
class Turn:
    """One step by which a body is turned: its ``axes`` (3, 3) as columns in those before, what it
    adds to ω, ``spin`` (3,) in the axes after it, and the ``rates`` that this names by symbols."""

    axes: Matrix
    spin: Vector
    rates: tuple[tuple[sp.Symbol, sp.Expr], ...] = ()


def turned(body: Body, before: Attitude, symbols: Symbols) -> Attitude:
    """The attitude of a body that hangs on a frame (the ground for one that stands free)."""
    for turn in turns_of(body, symbols):
        carried = across(turn.axes, before.omega)
        omega = tuple(sp.Add(*two) for two in zip(carried, turn.spin, strict=True))
        before = Attitude(product(before.axes, turn.axes), omega, before.rates + turn.rates)
    return before


def turns_of(body: Body, symbols: Symbols) -> tuple[Turn, ...]:
    """The steps by which a body in space is turned, in their order."""
    match body.turned:
        case Rotations(steps):
            return tuple(
                _about("xyz".index(axis), to_sympy(angle, symbols.scope), symbols)
                for axis, angle in steps
            )
        case Quaternion(parts):
            w, *x = (symbols.scope[name, 0] for name in parts)
            rate, *slope = (symbols.scope[name, 1] for name in parts)
            spin = quaternion_spin(w, tuple(x), rate, tuple(slope))
            return (Turn(quaternion_axes(w, tuple(x)), spin),)
    return ()


def _about(axis: int, angle: sp.Expr, symbols: Symbols) -> Turn:
    """A turn by ``angle`` about the axis of that index."""
    c, s = sp.cos(angle), sp.sin(angle)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rows = [[ONE if m == n else ZERO for n in range(3)] for m in range(3)]
    rows[j][j], rows[j][k], rows[k][j], rows[k][k] = c, -s, s, c
    rate, named = _rate(angle, symbols)
    spin = tuple(rate if m == axis else ZERO for m in range(3))
    return Turn(tuple(map(tuple, rows)), spin, named)


def _rate(
    angle: sp.Expr, symbols: Symbols
) -> tuple[sp.Expr, tuple[tuple[sp.Symbol, sp.Expr], ...]]:
    """The rate of an angle: q' of a coordinate, 0 of what stands, else a symbol for it."""
    if angle in symbols.q:
        return symbols.v[symbols.q.index(angle)], ()
    if not angle.free_symbols & {*symbols.q, symbols.t}:
        return ZERO, ()
    symbol = sp.Symbol(f"({angle})'", real=True)
    return symbol, ((symbol, angle),)


def quaternion_axes(w: sp.Expr, x: Vector) -> Matrix:
    """R (3, 3) of a quaternion of any length but 0."""
    size = w**2 + sum(part**2 for part in x)
    cross = ((ZERO, -x[2], x[1]), (x[2], ZERO, -x[0]), (-x[1], x[0], ZERO))
    rows = []
    for m in range(3):
        others = [x[n] ** 2 for n in range(3) if n != m]
        row = [2 * (x[m] * x[n] + w * cross[m][n]) / size for n in range(3)]
        row[m] = (w**2 + x[m] ** 2 - others[0] - others[1]) / size
        rows.append(tuple(row))
    return tuple(rows)


def quaternion_spin(w: sp.Expr, x: Vector, rate: sp.Expr, slope: Vector) -> Vector:
    """ω (3,) in the axes of the body of a quaternion (w, x) with the rates (rate, slope)."""
    size = w**2 + sum(part**2 for part in x)
    turn = crossed(x, slope)
    return tuple(2 * (w * slope[m] - rate * x[m] - turn[m]) / size for m in range(3))


def product(left: Matrix, right: Matrix) -> Matrix:
    """The product of two matrices (3, 3)."""
    columns = tuple(zip(*right, strict=True))
    return tuple(tuple(dotted(row, column) for column in columns) for row in left)


def along(axes: Matrix, vector: Sequence[sp.Expr]) -> Vector:
    """R v: a vector (3,) given in the axes of a frame, in the inertial ones."""
    return tuple(dotted(row, vector) for row in axes)


def across(axes: Matrix, vector: Sequence[sp.Expr]) -> Vector:
    """Rᵀ v: a vector (3,) given in the inertial axes, in those of a frame."""
    return tuple(dotted(column, vector) for column in zip(*axes, strict=True))


def dotted(left: Sequence[sp.Expr], right: Sequence[sp.Expr]) -> sp.Expr:
    """Σ left·right."""
    return sp.Add(*(a * b for a, b in zip(left, right, strict=True)))


def crossed(left: Sequence[sp.Expr], right: Sequence[sp.Expr]) -> Vector:
    """left × right (3,)."""
    return (
        left[1] * right[2] - left[2] * right[1],
        left[2] * right[0] - left[0] * right[2],
        left[0] * right[1] - left[1] * right[0],
    )


def tensor_of(body: Body, symbols: Symbols) -> Vector:
    """Jxx, Jyy, Jzz, Jxy, Jxz, Jyz (6,) of a body in space, kg·m²; empty without inertia."""
    if body.inertia is not None:
        same = to_sympy(body.inertia, symbols.scope)
        return (same, same, same, ZERO, ZERO, ZERO)
    values = tuple(to_sympy(part, symbols.scope) for part in body.tensor)
    return (*values, ZERO, ZERO, ZERO) if len(values) == 3 else values


def matrix_of(tensor: Vector) -> Matrix:
    """J (3, 3) of a tensor (6,)."""
    xx, yy, zz, xy, xz, yz = tensor
    return ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))


def spun(tensor: Vector, omega: Sequence[sp.Expr]) -> Vector:
    """J ω (3,) of a tensor (6,)."""
    return tuple(dotted(row, omega) for row in matrix_of(tensor))

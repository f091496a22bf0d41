"""The one seam between SymPy and CasADi: expressions become CasADi SX, each node once.

SymPy shares and hashes subexpressions, so a dictionary from node to SX yields a graph without a
separate common-subexpression pass (measured 14–60 times faster than ``lambdify``).
"""

from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain

import casadi as ca
import sympy as sp

from symhyb.mechanics.attitude import Vector, matrix_of
from symhyb.mechanics.equations import (
    Acting,
    Couple,
    Equations,
    Mass,
    Mutual,
    Term,
    Turning,
    Vectorial,
)
from symhyb.mechanics.symbols import reading_symbol
from symhyb.mechanics.tabulated import MappedBase, TabulatedBase
from symhyb.numeric.lowered import links
from symhyb.numeric.lowered.instruments import shown_by
from symhyb.numeric.lowered.tables import fold, on_surface, picked

SUMS_KEPT = 16  # enough for the few sums that a link of a chain adds
STILL = 1e-9  # m/s: below, the direction of a point's velocity fades
GUIDED = 3.0  # of the rate of turning: how fast the length of a quaternion returns to 1
GUIDED_LEAST = 1.0  # 1/s: and at rest
Fill = Callable[[ca.SX], ca.SX]
"""What fills the hole of a network: the force (SI) from its inputs."""

_UNARY: Mapping[type[sp.Basic], Callable[[ca.SX], ca.SX]] = {
    sp.sin: ca.sin,
    sp.cos: ca.cos,
    sp.tan: ca.tan,
    sp.asin: ca.asin,
    sp.acos: ca.acos,
    sp.atan: ca.atan,
    sp.sinh: ca.sinh,
    sp.cosh: ca.cosh,
    sp.tanh: ca.tanh,
    sp.exp: ca.exp,
    sp.log: ca.log,
    sp.Abs: ca.fabs,
    sp.sign: ca.sign,
    sp.Heaviside: lambda x: x > 0,
}


class Lowering:
    """A memoised printer from SymPy to CasADi SX for one set of symbols."""

    def __init__(self, symbols: Mapping[sp.Symbol, ca.SX]):
        self._done: dict[sp.Basic, ca.SX] = dict(symbols)
        self._sums: deque[tuple[frozenset[sp.Basic], ca.SX]] = deque(maxlen=SUMS_KEPT)

    def __call__(self, expression: sp.Expr) -> ca.SX:
        """Return the SX of ``expression``.

        Raises:
            TypeError: a SymPy function without a CasADi counterpart.
        """
        done = self._done.get(expression)
        if done is None:
            done = self._lower(expression)
            self._done[expression] = done
        return done

    def define(self, symbol: sp.Symbol, value: ca.SX) -> None:
        """Let a symbol stand for ``value`` from now on."""
        self._done[symbol] = value

    def _lower(self, expression: sp.Expr) -> ca.SX:
        if expression in (sp.zoo, sp.I):  # divides by zero, or has no real value, wherever it is
            return ca.SX(float("nan"))  # checked where it is used
        if expression.is_Number or expression.is_NumberSymbol:
            return ca.SX(float(expression))
        if expression.is_Add:
            return self._sum(expression)
        parts = [self(argument) for argument in expression.args]
        if expression.is_Mul:
            return fold(parts, lambda x, y: x * y)
        if expression.is_Pow:
            return _power(parts[0], expression.args[1], parts[1])
        if isinstance(expression, sp.Max):
            return fold(parts, ca.fmax)
        if isinstance(expression, sp.Min):
            return fold(parts, ca.fmin)
        if isinstance(expression, sp.atan2):
            return ca.atan2(parts[0], parts[1])
        if isinstance(expression, TabulatedBase):
            return picked(expression.characteristic, parts[0])
        if isinstance(expression, MappedBase):
            return on_surface(expression.surface, *parts)
        function = _UNARY.get(expression.func)
        if function is None:
            raise TypeError(f"no CasADi counterpart for {expression.func}")
        return function(parts[0])

    def _sum(self, expression: sp.Expr) -> ca.SX:
        """A sum, begun with the largest one of late whose terms it repeats: SymPy flattens sums,
        and a chain of n links would otherwise be lowered as n²/2 additions."""
        terms = frozenset(expression.args)
        known, start = frozenset[sp.Basic](), None
        for earlier, value in self._sums:
            if len(earlier) > len(known) and earlier < terms:
                known, start = earlier, value
        parts = [self(argument) for argument in expression.args if argument not in known]
        total = fold(parts if start is None else [start, *parts], lambda x, y: x + y)
        self._sums.append((terms, total))
        return total


def _power(base: ca.SX, exponent: sp.Expr, lowered: ca.SX) -> ca.SX:
    if exponent == -1:
        return 1 / base
    if exponent == sp.Rational(1, 2):
        return ca.sqrt(base)
    if exponent == sp.Rational(-1, 2):
        return 1 / ca.sqrt(base)
    if exponent.is_Integer and 2 <= abs(int(exponent)) <= 8:
        product = base
        for _ in range(abs(int(exponent)) - 1):
            product = product * base
        return product if int(exponent) > 0 else 1 / product
    return base**lowered


class Lowered:
    """The equations of a model as SX.

    Symbols q, v, a (n), z (declared states, then inner states), u (k), p (P), t; on them T, V,
    ``gravity`` (m/s²), and a row an element: generalized forces (each (n, 1)), stored energies,
    pathways (stretch, rate, direction; None at points and of pairs), scalar forces F (by name; of
    those with a pathway), and of z (nz, 1) the rates z' (``inner``) and the values at ``rest``, of
    declared states those at the start. ``guidance`` (n, 1) keeps quaternions at length 1. In T the
    masses are those at the time ``when``: mass that leaves takes its momentum along, so that T is
    not differentiated by it.
    """

    def __init__(self, equations: Equations, networks: Mapping[str, Fill] | None = None):
        s = equations.symbols
        self.q, self.v, self.a = (ca.SX.sym(name, len(s.q)) for name in ("q", "v", "a"))
        self.z = ca.SX.sym("z", len(s.remembered))
        self.u, self.p = ca.SX.sym("u", len(s.u)), ca.SX.sym("p", len(s.p))
        self.t, self.when = ca.SX.sym("t"), ca.SX.sym("when")
        pairs: dict[sp.Symbol, ca.SX] = {s.t: self.t}
        rows = (
            (s.q, self.q),
            (s.v, self.v),
            (s.a, self.a),
            (s.remembered, self.z),
            (s.u, self.u),
            (s.p, self.p),
        )
        for names, column in rows:
            pairs.update({name: column[i] for i, name in enumerate(names)})
        self._lower, self._weigh = Lowering(pairs), Lowering({**pairs, s.t: self.when})
        self._equations, self.places = equations, equations.places
        self.gravity = self._column_of(equations.gravity)
        self.kinetic = self._lower(equations.kinetic)
        self.potential = self._lower(equations.potential)
        self.guidance = ca.SX(len(s.q), 1)
        self._rates = self._rates_of(equations)
        for symbol, angle in _turns(equations):
            self._lower.define(symbol, self._rates[angle])
        self._velocities = links.velocities(equations.masses, self._column_of, self._rate)
        for body in equations.masses:
            self._add_mass(body)
        self.forces: list[ca.SX] = []
        self.carried: list[ca.SX] = []
        self.stored: list[ca.SX] = []
        self.pathways: list[tuple[ca.SX, ca.SX, ca.SX] | None] = []
        self.strengths: dict[str, ca.SX] = {}
        inner: list[ca.SX] = []
        rest: list[ca.SX] = []
        for term in equations.terms:
            if isinstance(term, Vectorial):
                self._add_vector(term)
            elif isinstance(term, Couple):
                self._add_couple(term)
            elif isinstance(term, Mutual):
                self._add_mutual(term)
            elif isinstance(term, Turning):
                self._add_turning(term)
            else:
                self._add_term(term, (networks or {}).get(term.element))
                inner += map(self._lower, term.law.inner)  # in the order of the elements, as z is
                rest += map(self._lower, term.law.rest)
        rates, starts = (map(self._lower, part) for part in (equations.rates, equations.starts))
        self.inner, self.rest = _column([*rates, *inner]), _column([*starts, *rest])

    def inputs(self) -> tuple[ca.SX, ...]:
        """What acts of every input: gain and offset applied."""
        scope, recorded = self._equations.symbols.scope, self._equations.symbols.u
        return tuple(self._lower(scope[symbol.name, 0]) for symbol in recorded)

    def rate(self, expression: ca.SX) -> ca.SX:
        """d/dt of a position: (∂x/∂q) q' + ∂x/∂t."""
        return ca.jtimes(expression, ca.vertcat(self.q, self.t), ca.vertcat(self.v, 1))

    def _rates_of(self, equations: Equations) -> dict[sp.Expr, ca.SX]:
        """The rates of all that moves, differentiated together: the speed of a link then builds on
        that of the link before, as the positions do."""
        moving: list[sp.Expr] = []
        for body in equations.masses:
            moving += [] if body.link else [*body.centre, body.angle]
        moving += chain.from_iterable(links.moving(equations.masses))
        moving += [angle for _, angle in _turns(equations)]
        for term in equations.terms:
            moving += _moved_by(term)
        moving = list(dict.fromkeys(moving))
        if not moving:
            return {}
        rates = ca.vertsplit(self.rate(self._column_of(moving)))
        return dict(zip(moving, rates, strict=True))

    def _rate(self, positions: Iterable[sp.Expr]) -> ca.SX:
        return ca.vertcat(*(self._rates[position] for position in positions))

    def column(self, expressions: Iterable[sp.Expr]) -> ca.SX:
        """Expressions in the symbols of the model as a column."""
        return self._column_of(expressions)

    def _column_of(self, expressions: Iterable[sp.Expr]) -> ca.SX:
        return ca.vertcat(*(self._lower(expression) for expression in expressions))

    def _weighed(self, expressions: Iterable[sp.Expr]) -> ca.SX:
        """Inertia as a column, at the time ``when``."""
        return ca.vertcat(*map(self._weigh, expressions))

    def outputs(self, reaction: ca.SX, coordinates: Sequence[str]) -> ca.SX:
        """What the sensors read (m, 1); ``reaction`` (n, 1) drives the ``coordinates``."""
        for reading in self._equations.readings:
            value = shown_by(self, reading, reaction, coordinates)
            self._lower.define(reading_symbol(reading), value)
        return _column([self._lower(output) for output in self._equations.outputs])

    def _add_mass(self, body: Mass) -> None:
        mass, centre = self._weigh(body.mass), self._column_of(body.centre)
        self.potential -= self._lower(body.mass) * ca.dot(self.gravity, centre)
        if body.link is None:
            self.kinetic += mass * ca.sumsqr(self._rate(body.centre)) / 2
            if body.inertia != 0:
                self.kinetic += self._weigh(body.inertia) * self._rate([body.angle]) ** 2 / 2
            return
        velocity, omega = self._velocities[body.body]
        self.kinetic += mass * ca.sumsqr(velocity) / 2
        if body.tensor:
            tensor = ca.sparsify(ca.horzcat(*map(self._weighed, matrix_of(body.tensor))))
            self.kinetic += ca.dot(omega, ca.mtimes(tensor, omega)) / 2
        if body.quaternion is not None:
            self._guide(body, *body.quaternion)

    def _guide(self, body: Mass, parts: Vector, rates: Vector) -> None:
        """The length of a quaternion, e^n: nothing else depends on it, so it gets an inertia I like
        that of the body, and the force that lets it return to 1 while the body turns by |ω|:

            T += I n'²/2,    n'' + 2 g n' + g² n = 0,    g² = GUIDED²·|ω|² + GUIDED_LEAST²
        """
        q, v = self._column_of(parts), self._column_of(rates)
        size = ca.sumsqr(q)
        n, rate = ca.log(size) / 2, ca.dot(q, v) / size
        inertia = 4 * sum((self._weigh(part) for part in body.tensor[:3]), ca.SX(0)) / 3
        self.kinetic += inertia * rate**2 / 2
        quick = GUIDED**2 * 4 * (ca.sumsqr(v) / size - rate**2) + GUIDED_LEAST**2
        pull = -inertia * (2 * ca.sqrt(quick) * rate + quick * n)
        self.guidance += pull * ca.gradient(n, self.q)

    def _add_term(self, term: Term, fill: Fill | None) -> None:
        stretch = self._lower(term.path)
        rate, direction = self._rate([term.path]), ca.gradient(stretch, self.q)
        self._lower.define(term.s, stretch)
        self._lower.define(term.r, rate)
        if term.hole is not None:
            inputs = [self._lower(item) for item in self._equations.networks[term.element]]
            self._lower.define(term.hole, ca.SX(0) if fill is None else fill(ca.vertcat(*inputs)))
        force, mass = self._lower(term.law.force), self._lower(term.law.mass)
        self.forces.append(term.sign * direction * force)
        self._carry(mass * rate**2 / 2)
        self._store(term.law.stored)
        self.pathways.append((stretch, rate, direction))
        pull = ca.jtimes(rate, self.v, self.a) + ca.jtimes(rate, self.q, self.v)
        self.strengths[term.element] = force + mass * pull

    def _add_vector(self, term: Vectorial) -> None:
        position, velocity = self._column_of(term.position), self._rate(term.position)
        speed = ca.sqrt(ca.sumsqr(velocity) + STILL**2)
        self._lower.define(term.r, speed)
        for symbol, part in zip(term.along, ca.vertsplit(velocity), strict=True):
            self._lower.define(symbol, part / speed)
        force = ca.vertcat(*(self._lower(part) for part in term.force))
        self.forces.append(ca.jtimes(position, self.q, force, True))
        self._store(term.stored)
        self.pathways.append(None)
        mass = ca.SX(0) if term.law is None else self._lower(term.law.mass)
        self._carry(mass * ca.sumsqr(velocity) / 2)

    def _store(self, energy: sp.Expr) -> None:
        """What an element stores; nothing is counted where an input changes it, and does work."""
        stored = self._lower(energy)
        moved = bool(self.u.numel()) and ca.depends_on(stored, self.u)
        self.stored.append(ca.SX(0) if moved else stored)

    def _add_couple(self, term: Couple) -> None:
        """A torque does the work torque·ω."""
        omega, torque = self._column_of(term.omega), self._column_of(term.torque)
        self.forces.append(ca.jtimes(omega, self.v, torque, True))
        self.stored.append(ca.SX(0))
        self.pathways.append(None)
        self._carry(ca.SX(0))

    def _add_turning(self, term: Turning) -> None:
        """An inertia exerts nothing but by its acceleration."""
        self.forces.append(ca.SX(len(self._equations.symbols.q), 1))
        self.stored.append(ca.SX(0))
        self.pathways.append(None)
        omega = self._column_of(term.omega) if term.omega else self._rate([term.angle])
        self._carry(self._lower(term.law.mass) * ca.sumsqr(omega) / 2)

    def _add_mutual(self, term: Mutual) -> None:
        """Two stretches that act on each other: Q = (∂a/∂q)ᵀ·push_a + (∂b/∂q)ᵀ·push_b."""
        paths, rates = self._column_of(term.paths), self._rate(term.paths)
        for i in range(2):
            self._lower.define(term.s[i], paths[i])
            self._lower.define(term.r[i], rates[i])
        push = self._column_of(term.law.push)
        self.forces.append(ca.jtimes(paths, self.q, push, True))
        self._store(term.law.stored)
        self.pathways.append(None)
        self._carry(ca.SX(0))

    def _carry(self, energy: ca.SX) -> None:
        """Kinetic energy of the mass that an element adds."""
        self.carried.append(energy)
        self.kinetic += energy


def _moved_by(term: Acting) -> tuple[sp.Expr, ...]:
    """The positions whose rates an element needs."""
    match term:
        case Term():
            return (term.path,)
        case Vectorial():
            return tuple(term.position)
        case Mutual():
            return term.paths
        case Turning():
            return () if term.omega else (term.angle,)
        case Couple():
            return ()


def _turns(equations: Equations) -> tuple[tuple[sp.Symbol, sp.Expr], ...]:
    """The symbols that stand for rates of angles in space, and these angles, each once."""
    frames = equations.places.frames
    found = (pair for name in frames for pair in equations.places.attitude(name).rates)
    return tuple(dict.fromkeys(found))


def _column(parts: list[ca.SX]) -> ca.SX:
    return ca.vertcat(*parts) if parts else ca.SX(0, 1)

"""A machine whose dry friction and stops are switched from outside, as CasADi functions.

With a = a0 + A λ the accelerations under the forces λ of frictions, s' = J v the rates of their
places and s'' = J a + c, places that hold have s'' = 0:

    G λ = b,   G = −J A (F, F),   b = J a0 + c (F,)          G = J M⁻¹ Jᵀ, symmetric

What the model file writes as a jump at g = 0 is on a side of it, +1 or −1. Where both sides lead
back to the jump, the motion stays on it, with the side between them that gives g' = 0 (Filippov,
Differential Equations with Discontinuous Righthand Sides, 1988, section 4; the equivalent control
of Utkin, IEEE Trans. Automatic Control 22, 1977):

    g' = g'₀ + D·side,   side = −D⁻¹ g'₀ of those that stay      only where no input acts on g

Sizes: F frictions, S sides of stops, J jumps, X states, n coordinates, m sensors. The state x and
the drive d are those of :mod:`symhyb.numeric.lowered.dynamics`. What switches is one vector
``mode`` (2F + 2S + J,): the directions sigma (F), fixed forces (F) in N, whether a stop presses (S)
and whether it is entered without pressing (S), and sides (J). What is solved for, ``held``, are the
indices of frictions that hold, and behind them, from F on, those of jumps on which the motion
stays.
"""

from dataclasses import dataclass

import casadi as ca

from symhyb.model.jumps import Jump, jumps
from symhyb.model.switching import Stop, frictions, stops
from symhyb.model.types import On, Place
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.lowered.constrained import solve_symmetric
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.lowered.machine import functions_of, structure_of

Held = tuple[int, ...]
TINY = 1e-30  # SI: how far from 0 what decides a jump counts as on it, if it was there to the bit


@dataclass(frozen=True, slots=True, eq=False)
class Switched:
    """The functions of a machine in which frictions, stops and jumps are automata, SI."""

    form: StateForm
    frictions: tuple[int, ...]
    stops: tuple[Stop, ...]
    jumps: tuple[Jump, ...]
    structure: str

    def names(self) -> tuple[str, ...]:
        """What switches, for people: frictions, then stops with their sides, then jumps, numbered
        where a place has several."""
        elements = self.form.machine.model.elements
        sides = {stop.element: 0 for stop in self.stops}
        for stop in self.stops:
            sides[stop.element] += 1
        places = [jump.name for jump in self.jumps]
        return (
            *(elements[i].name for i in self.frictions),
            *(
                elements[s.element].name + (f".{s.side}" if sides[s.element] > 1 else "")
                for s in self.stops
            ),
            *(
                f"{name}.jump"
                + (str(places[: i + 1].count(name)) if places.count(name) > 1 else "")
                for i, name in enumerate(places)
            ),
        )

    def holding(self, held: Held) -> Held:
        """Those of ``held`` that are frictions."""
        return tuple(i for i in held if i < len(self.frictions))

    def curved(self, held: Held) -> bool:
        """Whether any friction of ``held`` acts elsewhere than on a coordinate, where holding may
        be no straight line of the coordinates."""
        elements = self.form.machine.model.elements
        which = self.holding(held)
        return any(_coordinate(elements[self.frictions[i]].place) is None for i in which)

    def on_columns(self, which: Held) -> tuple[int, ...]:
        """Where in the free coordinates the frictions ``which`` act directly on one of them."""
        model, found = self.form.machine.model, []
        names = [model.coordinates[i].name for i in self.form.free]
        for i in which:
            name = _coordinate(model.elements[self.frictions[i]].place)
            if name is not None:
                found.append(names.index(name))
        return tuple(found)

    def rates(self, held: Held) -> ca.Function:
        """(x, d, t, p, mode) -> (X + F,) x' while ``held`` hold, and the forces of frictions that
        do."""
        return self._kept("rates", held)

    def slopes(self, held: Held) -> ca.Function:
        """(x, d, t, p, mode) -> (X + F, X) the derivatives of ``rates`` by x."""

        def make() -> ca.Function:
            rates = self.rates(held)
            given = [rates.sx_in(i) for i in range(rates.n_in())]
            slopes = ca.densify(ca.jacobian(rates(*given), given[0]))
            return ca.Function("slopes", given, [slopes], {"cse": True})

        return kept(("switched slopes", self.structure, held), make)

    def watch(self, held: Held) -> ca.Function:
        """(x, d, t, p, mode) -> (2F + 2S + 2J,), positive until something switches: reversal or
        upper and lower reserve of each friction; contact or release, and pressing, of stops; the
        distance from a jump, or what is left to each side of one on which the motion stays."""
        return self._kept("watch", held)

    def outputs(self, held: Held) -> ca.Function:
        """(x, d, t, p, mode) -> (m,) what the sensors record, (n,) accelerations."""
        return self._kept("outputs", held)

    def contact(self) -> ca.Function:
        """(x, d, t, p, mode) -> s (F,), s' (F,), b (F,), G (F, F), A (n, F), breakaway levels
        (2F,) forwards and backwards in turn, depths and forces (2S,) of stops in turn."""
        return self._kept("contact", ())

    def leaning(self, held: Held) -> ca.Function:
        """(x, d, t, p, mode) -> g (J,) of jumps, and g' (J, 2) with each on its side + and −, the
        others as they are; NaN where an input acts on g or g' is not linear in the side."""
        return self._kept("leaning", held)

    def _kept(self, name: str, held: Held) -> ca.Function:
        return kept(("switched", self.structure, held), lambda: self._make(held))[name]

    def _make(self, held: Held) -> dict[str, ca.Function]:
        x, d, t, p, _ = self.form.symbols()
        total, sides = len(self.frictions), len(self.stops)
        mode = ca.SX.sym("mode", 2 * total + 2 * sides + len(self.jumps))
        at = _Place(self, x, d, t, p, mode)
        a, force = at.accelerations(self.holding(held))
        inner = at.functions["inner"](at.q, at.v, at.z, at.inputs(force), t, p)
        free, count = list(self.form.free), len(self.form.free)
        slope = ca.vertcat(x[count : 2 * count, 0], a[free], inner)
        arguments = [x, d, t, p, mode]
        seen = at.seen(a, force)
        m = len(self.form.machine.model.sensors)
        decides = seen[m + 2 * total + 2 * sides :, 0]
        lapse = ca.jtimes(decides, x, slope) + ca.jacobian(decides, t)
        stays = [i - total for i in held if i >= total]
        side = at.sides
        if stays:
            side = _between(at.sides, stays, lapse)
            parts = [slope, a, force, seen, decides, lapse]
            parts = ca.substitute(parts, [at.sides], [side])
            slope, a, force, seen, decides, lapse = parts
        levels, depths = seen[m : m + 2 * total], seen[m + 2 * total : m + 2 * (total + sides)]
        watched = at.watched(self.holding(held), force, levels, depths)
        watched += [
            row for j in range(len(self.jumps)) for row in _reserve(j, side, decides, stays)
        ]

        def function(name: str, *results: ca.SX) -> ca.Function:
            dense = [ca.densify(result) for result in results]
            return ca.Function(name, arguments, dense, {"cse": True})

        made = {
            "rates": function("rates", ca.vertcat(slope, _only(force, self.holding(held)))),
            "watch": function("watch", ca.vertcat(ca.SX(0, 1), *watched)),
            "outputs": function("outputs", seen[:m], a),
            "leaning": function("leaning", decides, _leaning(at.sides, lapse, decides, d, stays)),
        }
        if not held:
            made["contact"] = function(
                "contact", at.stretch, at.rate, at.b, at.G, at.A, levels, depths
            )
        return made


class _Place:
    """What the functions of a switched machine are made of, at one symbolic state."""

    def __init__(self, owner: Switched, x: ca.SX, d: ca.SX, t: ca.SX, p: ca.SX, mode: ca.SX):
        self.functions = functions_of(owner.form.machine.model, opening="switched")
        self.q, self.v, self.z, self.u, self.given = owner.form.unpack(x, d, p)
        self._t, self._p = t, p
        self._elements, self._owner = list(owner.frictions), owner
        total, sides = len(owner.frictions), len(owner.stops)
        self.sigma, self.fixed = mode[:total, 0], mode[total : 2 * total, 0]
        self.on = mode[2 * total : 2 * total + sides, 0]
        self.entered = mode[2 * total + sides : 2 * (total + sides), 0]
        self.sides = mode[2 * (total + sides) :, 0]
        force = ca.SX.sym("force", total)
        a = self._acceleration(force)
        still = ca.SX.zeros(total)
        self.A = ca.jacobian(a, force)
        self._free = ca.substitute(a, force, still)
        self.stretch, self.rate, self.J, c = self._paths()
        self.b = ca.mtimes(self.J, self._free) + c
        self._c, self.G = c, -ca.mtimes(self.J, self.A)

    def inputs(self, force: ca.SX) -> ca.SX:
        """Inputs of the model and what switches."""
        return ca.vertcat(self.u, self.sigma, force, self.on, self.sides)

    def _acceleration(self, force: ca.SX) -> ca.SX:
        w = ca.SX.zeros(self._owner.form.machine.n)
        return self.functions["acceleration"](
            self.q, self.v, self.z, self.inputs(force), self._t, self._p, w, self.given
        )

    def _paths(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """s, s', J = ∂s/∂q and c = s'' − J q'' of the frictions."""
        stretch, rate, direction = self.functions["pathways"](self.q, self.v, self._t, self._p)
        n = self._owner.form.machine.n
        if not self._elements:
            return ca.SX(0, 1), ca.SX(0, 1), ca.SX(0, n), ca.SX(0, 1)
        q, v, t = ca.SX.sym("q", n), ca.SX.sym("v", n), ca.SX.sym("t")
        lapse = self.functions["pathways"](q, v, t, self._p)[1][self._elements]
        turned = ca.jtimes(lapse, q, v) + ca.jacobian(lapse, t)
        c = ca.substitute(turned, ca.vertcat(q, v, t), ca.vertcat(self.q, self.v, self._t))
        which = self._elements
        return stretch[which], rate[which], direction[:, which].T, c

    def accelerations(self, held: Held) -> tuple[ca.SX, ca.SX]:
        """a (n,) and the forces (F,) that are not those of sliding."""
        force, h = ca.SX(self.fixed), list(held)
        if not held:
            return self._free + ca.mtimes(self.A, force), force
        force[h] = 0
        rest = ca.mtimes(self.J, self._free + ca.mtimes(self.A, force)) + self._c
        force[h] = solve_symmetric(self.G[h, h], rest[h])
        a = self._free + ca.mtimes(self.A, force)
        model = self._owner.form.machine.model
        names = [coordinate.name for coordinate in model.coordinates]
        for i in held:
            name = _coordinate(model.elements[self._elements[i]].place)
            if name is not None:  # rest without rounding
                a[names.index(name)] = 0
        return a, force

    def seen(self, a: ca.SX, force: ca.SX) -> ca.SX:
        """Sensors, and what is watched behind them."""
        w = ca.SX.zeros(self._owner.form.machine.n)
        u = self.inputs(force)
        return self.functions["sensed"](self.q, self.v, a, self.z, u, self._t, self._p, w)

    def watched(self, held: Held, force: ca.SX, levels: ca.SX, depths: ca.SX) -> list[ca.SX]:
        """What is positive until a friction or a stop switches."""
        rows = list[ca.SX]()
        for i in range(len(self._elements)):
            forwards, backwards = levels[2 * i], levels[2 * i + 1]
            if i in held:
                rows += [forwards - force[i], force[i] + backwards]
            else:
                s = self.sigma[i]
                rows += [s * self.rate[i] + (1 - s**2), ca.SX(1)]
        for i in range(len(self._owner.stops)):
            depth, press = depths[2 * i], depths[2 * i + 1]
            on, entered = self.on[i], self.entered[i]
            rows += [
                on * press + (1 - on) * (entered * depth - (1 - entered) * depth),
                1 - entered - entered * press,
            ]
        return rows


def _reserve(j: int, side: ca.SX, decides: ca.SX, stays: list[int]) -> list[ca.SX]:
    """What is positive until jump ``j`` switches; one whose argument is 0 to the bit is on it."""
    if j in stays:
        return [1 - side[j], 1 + side[j]]
    on = 1 - side[j] ** 2
    return [side[j] * decides[j] + on * (TINY - ca.fabs(decides[j])), ca.SX(1)]


def _between(side: ca.SX, stays: list[int], lapse: ca.SX) -> ca.SX:
    """The sides (J,) with those of jumps that ``stay`` such that the motion does not leave them."""
    own = side[stays]
    slope = ca.jacobian(lapse[stays], own)
    rest = ca.substitute(lapse[stays], own, ca.SX.zeros(len(stays)))
    solved = ca.SX(side)
    solved[stays] = -ca.solve(slope, rest)
    return solved


def _leaning(side: ca.SX, lapse: ca.SX, decides: ca.SX, drive: ca.SX, stays: list[int]) -> ca.SX:
    """g' (J, 2) with each jump on its side + and −, NaN where it stays, or that is not known."""
    rows = []
    for j in range(lapse.numel()):
        slope = ca.SX(0) if j in stays else ca.jacobian(lapse[j], side[j])
        if j in stays or ca.depends_on(decides[j], drive) or ca.depends_on(slope, side[j]):
            rows.append(ca.SX.nan(1, 2))
        else:
            base = ca.substitute(lapse[j], side[j], ca.SX(0))
            rows.append(ca.horzcat(base + slope, base - slope))
    return ca.vertcat(ca.SX(0, 2), *rows)


def _coordinate(place: Place) -> str | None:
    """The one coordinate that holds where a friction at a place does, if it is one."""
    return place.coordinate if isinstance(place, On) and place.plain else None


def _only(force: ca.SX, held: Held) -> ca.SX:
    return ca.vertcat(*(force[i] if i in held else ca.SX(0) for i in range(force.numel())))


def switched(form: StateForm) -> Switched:
    """The machine of a form with its frictions, stops and jumps as automata."""
    model = form.machine.model
    return Switched(form, frictions(model), stops(model), jumps(model), structure_of(model))

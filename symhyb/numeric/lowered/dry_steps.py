"""The integration step of windows, in which dry friction holds, lets go and turns over.

A linearly implicit step knows the slope of friction where it begins. A place that slides has none
there: within a step that carries it over its reversal every stage finds another sign, and what is
light beside its friction is thrown about by far more than it moves. So friction is
set-valued, but for the transition w of its law, along a line:

A friction that needs longer than a step to turn over is left as its law has it. Of all others

1. along a step the friction of a place that slides as it begins resists that way, whatever becomes
   of the rate r. A place that rests (|r| below three transitions) is held by what its acceleration
   takes there, or by as much of it as friction holds (Gauss's principle);
2. at its end friction takes back an impulse λ of what it exerted,

       y1 = y − N⁻¹ Σ B_i λ_i,    low_i ≤ λ_i ≤ high_i,    r_i = w_i F_i/g_i between these bounds,

   N the matrix of a linearly implicit Euler step, B_i what the force of friction i does to the
   rates of y = (v, z). The bounds leave the whole force F within its levels, along the whole step
   where the place rests; where it slid and its rate has turned round, in the ``share`` of the step
   from the reversal on; elsewhere both are 0.

So a place that comes to rest rests to the end of the step, one that is pulled by more lets go, or
slides back, within it. The path follows from a force that is constant in that time. Both conditions
are solved by projected Gauss–Seidel sweeps, from where all places are held.

Sources: Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988; Stewart &
Trinkle, Int. J. Numer. Meth. Engng. 39, 1996; Jourdan, Alart & Jean, Comput. Methods Appl. Mech.
Engrg. 155, 1998 (Gauss–Seidel).

Sizes: X states, F frictions, f free coordinates, n coordinates, E elements.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from symhyb.model.switching import frictions
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.lowered.steps import (
    Acting,
    Given,
    Stepped,
    arguments,
    factored,
    implicit,
    solved,
    step_and_middle,
    stepped,
)

TURNED = 3.0  # transitions: friction is at 99.5 % of its level there
SWEEPS = 8  # of bounded impulses, where not all places are held; two that are coupled by 0.9 are
# then within 3 % of each other
FEW = 3  # coordinates, as of machines that a few causes explain
TINY = 1e-100  # SI: a step of no length, and friction of no level, change nothing

Matrix = Sequence[Sequence[ca.SX]]
Regime = Sequence[tuple[ca.SX, ca.SX]]
"""Which way each friction slides, ±1, or 0 where it rests, and the force that holds it there, N."""


@dataclass(frozen=True, slots=True)
class Rub:
    """One friction where a step begins, SI: the ``element`` that it is and its ``place`` among the
    levels, the rate there, its levels ``forwards`` and ``backwards`` (N), the rate (m/s) above
    which it slides (``edge``), the ``direction`` ∂r/∂v (1, f) of the free coordinates, what a
    force does to the rates of y (``pull``), and whether it turns over within a step (``quick``)."""

    element: int
    place: int
    rate: ca.SX
    forwards: ca.SX
    backwards: ca.SX
    edge: ca.SX
    direction: ca.SX
    pull: ca.SX
    quick: ca.SX


def step_of(form: StateForm) -> ca.Function:
    """The step of windows: set-valued friction where more coordinates are free than ``FEW``. Others
    take many smoothed steps near reversals; on one of them (EMPS) set-valued ones gave another
    answer, for a reason that is not known."""
    return window_step(form) if len(form.free) > FEW else step_and_middle(form)


def window_step(form: StateForm) -> ca.Function:
    """Return (x, d0, d1, t, h, p) -> x after h seconds and x in the middle of the step, (X,), SI;
    the drive runs linearly from d0 to d1."""
    given = arguments(form)
    rubs = _rubs(form, given)
    if not rubs:
        return step_and_middle(form)
    known = _regime(form, given, rubs)
    step = stepped(form, given, _kept_up(form, given, rubs, known))
    return ca.Function("step", [*given], [*_turned(form, given, step, rubs, known)], {"cse": True})


def _rubs(form: StateForm, given: Given) -> list[Rub]:
    """The frictions of what is free, where a step begins."""
    x, d0, _, t, h, p = given
    if form.machine.levels is None:
        return []
    w, free = ca.SX.sym("w", form.machine.n), list(form.free)
    by_w = ca.substitute(ca.jacobian(form.rates()(x, d0, t, p, w), w), w, 0 * w)
    rates, ways = _places(form, x, d0, t, p)
    levels, found = _levels(form, x, d0, t, p), []
    for place, i in enumerate(frictions(form.machine.model)):
        direction = ca.sparsify(ways[free, i]).T
        if direction.nnz():
            forwards, backwards, width = ca.vertsplit(levels[place])
            pull, edge = ca.mtimes(by_w, ways[:, i]), TURNED * width
            change = h * ca.mtimes(direction, pull[: len(free), 0]) * (forwards + backwards)
            quick = change > 2 * width
            found.append(Rub(i, place, rates[i], forwards, backwards, edge, direction, pull, quick))
    return found


def _places(form: StateForm, x: ca.SX, d: ca.SX, t: ca.SX, p: ca.SX) -> tuple[ca.SX, ca.SX]:
    """The rates (E,) of the places of all elements, m/s, and their directions (n, E)."""
    q, v, *_ = form.unpack(x, d, p)
    _, rates, ways = form.machine.pathways(q, v, t, p)
    return rates, ways


def _forces(form: StateForm, x: ca.SX, d: ca.SX, t: ca.SX, p: ca.SX) -> ca.SX:
    """The generalized forces (n, E) of all elements, N."""
    q, v, z, u, _ = form.unpack(x, d, p)
    return form.machine.elements(q, v, z, u, t, p)


def _levels(form: StateForm, x: ca.SX, d: ca.SX, t: ca.SX, p: ca.SX) -> list[ca.SX]:
    """The levels forwards and backwards of every friction, N, and its transition, m/s: (3,)."""
    assert form.machine.levels is not None  # there is at least one friction
    q, v, z, u, _ = form.unpack(x, d, p)
    return list(ca.vertsplit(form.machine.levels(q, v, z, u, t, p), 3))


def _regime(form: StateForm, given: Given, rubs: Sequence[Rub]) -> Regime:
    """What slides along a step, and which force holds what rests."""
    x, d0, d1, t, h, p = given
    f, still = len(form.free), ca.SX.zeros(form.machine.n)
    rates, ways = _places(form, x, d0, t, p)
    forces, change = _forces(form, x, d0, t, p), form.rates()(x, d0, t, p, still)
    slides = [(rub.rate > rub.edge) - (rub.rate < -rub.edge) for rub in rubs]
    rests = [(way == 0) * rub.quick for rub, way in zip(rubs, slides, strict=True)]
    for rub, rest in zip(rubs, rests, strict=True):  # what rests is held by nothing, at first
        along = ways[:, rub.element]
        force = -ca.dot(along, forces[:, rub.element]) / ca.dot(along, along)
        change = change + rub.pull * ca.if_else(rest, force, 0.0)
    onwards = ca.vertcat(x[f : 2 * f, 0], change), (d1 - d0) / ca.fmax(h, TINY), 1
    pulled = ca.jtimes(rates, ca.vertcat(x, d0, t), ca.vertcat(*onwards))
    shown = [[ca.mtimes(rub.direction, one.pull[:f, 0]) for one in rubs] for rub in rubs]
    low = [ca.if_else(rest, -rub.backwards, 0.0) for rub, rest in zip(rubs, rests, strict=True)]
    high = [ca.if_else(rest, rub.forwards, 0.0) for rub, rest in zip(rubs, rests, strict=True)]
    held = _within([pulled[rub.element] for rub in rubs], shown, low, high)
    return list(zip(slides, held, strict=True))


def _kept_up(form: StateForm, given: Given, rubs: Sequence[Rub], known: Regime) -> Acting:
    """The force (n,) that makes friction along a step what it is by its regime."""
    p = given[-1]

    def acting(x: ca.SX, d: ca.SX, t: ca.SX) -> ca.SX:
        forces, levels = _forces(form, x, d, t, p), _levels(form, x, d, t, p)
        ways, more = _places(form, x, d, t, p)[1], ca.SX(form.machine.n, 1)
        for rub, (way, held) in zip(rubs, known, strict=True):
            level = ca.if_else(way > 0, levels[rub.place][0], -levels[rub.place][1])
            kept = ca.if_else(way == 0, held, level)
            change = forces[:, rub.element] + kept * ways[:, rub.element]
            more -= ca.if_else(rub.quick, change, 0.0)
        return more

    return acting


def _turned(
    form: StateForm, given: Given, step: Stepped, rubs: Sequence[Rub], known: Regime
) -> tuple[ca.SX, ca.SX]:
    """x after a step and in its middle, with what rests, lets go or turns over within it."""
    _, _, d1, t, h, p = given
    f = len(form.free)
    rows = factored(implicit(step.by_q, step.by_y, h))
    pulls = [solved(rows, rub.pull) for rub in rubs]
    shown = [[ca.mtimes(rub.direction, pull[:f, 0]) for pull in pulls] for rub in rubs]
    rates = _places(form, step.after, d1, t + h, p)[0]
    begin, shares, low, high = [], [], [], []
    for i, (rub, (way, held)) in enumerate(zip(rubs, known, strict=True)):
        end, both = rates[rub.element], rub.forwards + rub.backwards
        past = ca.if_else(way * end < 0, end / (end - rub.rate), 0.0)
        share = rub.quick * ca.if_else(way == 0, 1.0, past)
        down = ca.if_else(way == 0, rub.backwards + held, ca.if_else(way > 0, both, 0.0))
        up = ca.if_else(way == 0, rub.forwards - held, ca.if_else(way < 0, both, 0.0))
        exerted = ca.if_else(way == 0, held, ca.if_else(way > 0, rub.forwards, -rub.backwards))
        soft = 2 * rub.edge / TURNED / ca.fmax(both, TINY)
        begin.append(end - soft * exerted)
        shown[i][i] += soft / ca.fmax(share * h, TINY)
        shares.append(share)
        low.append(-share * h * down)
        high.append(share * h * up)
    after, middle = step.after, step.middle
    for pull, one, share in zip(pulls, _within(begin, shown, low, high), shares, strict=True):
        late = ca.fmax(share - 0.5, 0.0) / ca.fmax(share, 0.5)  # of that time, in the middle
        whole = ca.vertcat(share * h / 2 * pull[:f, 0], pull)
        half = ca.vertcat(share * h / 2 * late**2 * pull[:f, 0], late * pull)
        after, middle = after - whole * one, middle - half * one
    return after, middle


def _within(
    begin: Sequence[ca.SX], shown: Matrix, low: Sequence[ca.SX], high: Sequence[ca.SX]
) -> list[ca.SX]:
    """What makes rates that ``begin`` without it none, or is at one of its bounds where it cannot:
    ``shown`` is what each of them takes from each rate, for one of its unit."""
    free = [some > least for least, some in zip(low, high, strict=True)]
    matrix = ca.vertcat(*(ca.horzcat(*row) for row in shown))
    some = ca.vertcat(*free)
    matrix = ca.if_else(ca.mtimes(some, some.T), matrix, 0.0) + ca.diag(1 - some)
    found = ca.vertsplit(solved(factored(matrix), some * ca.vertcat(*begin)))
    found = [
        ca.fmin(ca.fmax(one, least), most)
        for one, least, most in zip(found, low, high, strict=True)
    ]
    for _ in range(0 if len(found) == 1 else SWEEPS):
        for i, own in enumerate(shown):
            full = found[i] + _left(begin[i], own, found) / own[i]
            found[i] = ca.if_else(free[i], ca.fmin(ca.fmax(full, low[i]), high[i]), 0.0)
    return found


def _left(begin: ca.SX, shown: Sequence[ca.SX], taken: Sequence[ca.SX]) -> ca.SX:
    """What is left of a rate."""
    for by, one in zip(shown, taken, strict=True):
        begin = begin - by * one
    return begin

"""Which frictions hold and which slide, and what a located event changes.

Places at rest hold where that takes no more than their levels. With G and b of
:mod:`symhyb.exact.switched` the forces λ of all that rest solve

    min ½ λᵀ G λ − bᵀ λ,   −backwards ≤ λ ≤ forwards

whose slope is −s'': a place moves only where its force is at a level, and then against it (Gauss's
principle of least constraint; as a linear complementarity problem: Pfeiffer and Glocker, Multibody
Dynamics with Unilateral Contacts, 1996, ch. 5). G is positive semidefinite, so that an answer
exists for any number of frictions, several on one place included.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.exact.switched import Switched
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.runs.scenario import Event

FREE, PRESSING, ENTERED = 0, 1, 2  # of a stop; entered: inside, but its damper pulls back
AT_REST = 1e-12  # SI: a start this slow is a start at rest
MOVES = 1e-9  # of the accelerations that forces would give: what is less is rounding
RETURNED, RETURNS_MOST = 1e-15, 4  # drift that is left of a place that holds, and corrections
DEPENDENT = 1e-10  # of a place's own G: what is left of it when others hold

Integers = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Modes:
    """Directions ``sigma`` (F,) of frictions, 0 at rest; the forces ``fixed`` (F,), N, of those
    that rest because others hold; the indices of those that are ``held``; the states of ``stops``
    (S,); the ``sides`` (J,) of jumps, 0 on one, and the indices of those on which the motion
    ``stays``."""

    sigma: tuple[int, ...]
    fixed: tuple[float, ...]
    held: tuple[int, ...]
    stops: tuple[int, ...]
    sides: tuple[int, ...] = ()
    stays: tuple[int, ...] = ()

    @property
    def solved(self) -> tuple[int, ...]:
        """What the functions of :class:`Switched` solve for: indices of frictions that hold, and
        from F on of jumps on which the motion stays."""
        return (*self.held, *(len(self.sigma) + j for j in self.stays))

    def vector(self) -> Array:
        """What the functions of :class:`Switched` take as ``mode`` (2F + 2S + J,), SI."""
        pressing = [float(stop == PRESSING) for stop in self.stops]
        entered = [float(stop == ENTERED) for stop in self.stops]
        return np.array([*self.sigma, *self.fixed, *pressing, *entered, *self.sides])


@dataclass(frozen=True, slots=True)
class Instant:
    """A machine at one instant: state ``x`` (X,), drive ``d``, time in s, parameters, all SI."""

    machine: Switched
    x: Array
    d: Array
    t: float
    p: Array

    def contact(self, modes: Modes) -> tuple[Array, ...]:
        """s, s', b (F,), G (F, F), A (F, n), levels (F, 2), and stops (S, 2)."""
        found = call(self.machine.contact(), (self.x, self.d, self.t, self.p, modes.vector()))
        s, rate, b, G, A, levels, depths = found
        return s[0], rate[0], b[0], G, A, levels.reshape(-1, 2), depths.reshape(-1, 2)

    def leaning(self, modes: Modes) -> tuple[Array, Array]:
        """What decides jumps (J,), SI, and its slopes by time (J, 2) on either side."""
        function = self.machine.leaning(modes.solved)
        decides, slopes = call(function, (self.x, self.d, self.t, self.p, modes.vector()))
        return decides.reshape(-1), slopes.T.reshape(-1, 2)


def first_modes(at: Instant) -> tuple[Array, Modes]:
    """The state (X,), SI, and the modes that a run begins with.

    Raises:
        ValueError: a friction at a place that no coordinate moves.
    """
    total, sides = len(at.machine.frictions), len(at.machine.stops)
    jumps = (0,) * len(at.machine.jumps)
    modes = _begun_sides(at, Modes((0,) * total, (0.0,) * total, (), (FREE,) * sides, jumps))
    _, rate, _, G, _, _, depths = at.contact(modes)
    for i in range(total):
        if not G[i, i] > 0:
            name = at.machine.names()[i]
            raise ValueError(f"elements.{name}: no coordinate moves its place at the start")
    sigma = tuple(0 if abs(r) <= AT_REST else int(np.sign(r)) for r in rate)
    touching = tuple(
        FREE if depth <= 0 else PRESSING if press > 0 else ENTERED for depth, press in depths
    )
    modes = replace(modes, sigma=sigma, stops=touching)
    x, modes = settled(at, modes, [i for i in range(total) if sigma[i] == 0])
    return _leaned(replace(at, x=x), modes, [j for j, s in enumerate(modes.sides) if s == 0])


def _begun_sides(at: Instant, modes: Modes) -> Modes:
    """The modes with every jump on the side on which what decides it is."""
    for _ in modes.sides:  # one may decide another
        sides = tuple(int(s) for s in np.sign(at.leaning(modes)[0]))
        if sides == modes.sides:
            break
        modes = replace(modes, sides=sides)
    return modes


def _leaned(at: Instant, modes: Modes, which: list[int]) -> tuple[Array, Modes]:
    """The state (X,), SI, and the modes with the jumps ``which``, whose arguments are 0, on the
    side to which the motion leads, or on the jump where both sides lead back to it."""
    x = at.x
    for j in which:
        ahead, behind = at.leaning(modes)[1][j]
        if ahead < 0 < behind:
            modes = replace(modes, stays=(*modes.stays, j), sides=_put(modes.sides, j, 0))
        elif ahead > 0 or behind < 0:
            modes = replace(modes, sides=_put(modes.sides, j, 1 if ahead > 0 else -1))
        resting = [i for i, s in enumerate(modes.sigma) if s == 0]
        x, modes = settled(replace(at, x=x), modes, resting)
    return x, modes


def _put(sides: tuple[int, ...], j: int, side: int) -> tuple[int, ...]:
    return (*sides[:j], side, *sides[j + 1 :])


def _beyond(at: Instant, modes: Modes, j: int, second: int) -> tuple[Array, Modes]:
    """The state (X,), SI, and the modes after jump ``j`` was crossed or left; ``second``: below."""
    sides, resting = modes.sides, [i for i, s in enumerate(modes.sigma) if s == 0]
    if j in modes.stays:
        others = tuple(k for k in modes.stays if k != j)
        left = replace(modes, stays=others, sides=_put(sides, j, -1 if second else 1))
        return settled(at, left, resting)
    decides = at.leaning(modes)[0][j]
    if sides[j] == 0 and decides != 0:
        return settled(at, replace(modes, sides=_put(sides, j, int(np.sign(decides)))), resting)
    over = 0 if decides == 0 else -sides[j]
    x, modes = settled(at, replace(modes, sides=_put(sides, j, over)), resting)
    return _leaned(replace(at, x=x), modes, [j])


def after(at: Instant, modes: Modes, fired: list[int]) -> tuple[Array, Modes]:
    """The state (X,), SI, and the modes after ``fired`` (rows of ``watch``) fell through zero."""
    total = len(modes.sigma)
    first = 2 * (total + len(modes.stops))
    crossed, fired = [row - first for row in fired if row >= first], [r for r in fired if r < first]
    if not fired:
        x = at.x
        for row in crossed:
            x, modes = _beyond(replace(at, x=x), modes, row // 2, row % 2)
        return x, modes
    if any(s == 0 and i not in modes.held for i, s in enumerate(modes.sigma)):
        x, shared = _settled_again(at, modes)  # others may carry what one of them cannot
        if _has_reserve(replace(at, x=x), shared, fired):
            return x, shared
    sigma, touching = list(modes.sigma), list(modes.stops)
    for row in fired:
        which, second = divmod(row, 2)
        if which >= total:
            stop = which - total
            touching[stop] = _next(touching[stop], second, at.machine.stops[stop].damped)
        elif which in modes.held:
            sigma[which] = -1 if second else 1
        else:
            sigma[which] = 0
    resting = [i for i in range(total) if sigma[i] == 0]
    changed = replace(modes, sigma=tuple(sigma), held=(), stops=tuple(touching))
    return settled(at, changed, resting)


def _settled_again(at: Instant, modes: Modes) -> tuple[Array, Modes]:
    return settled(at, modes, [i for i, s in enumerate(modes.sigma) if s == 0])


def resampled(before: Instant, at: Instant, modes: Modes) -> tuple[Array, Modes]:
    """The state (X,), SI, and the modes after states were sampled: what rests may be pushed by
    another force, and what decides a jump may be another value."""
    was, now = before.leaning(modes)[0], at.leaning(modes)[0]
    moved = [j for j in range(len(modes.sides)) if was[j] != now[j]]
    stays = tuple(j for j in modes.stays if j not in moved)
    sides = tuple(
        int(np.sign(now[j])) if j in moved else side for j, side in enumerate(modes.sides)
    )
    modes = replace(modes, sides=sides, stays=stays)
    return _settled_again(at, modes)


def _has_reserve(at: Instant, modes: Modes, fired: list[int]) -> bool:
    """Whether all that fired holds, and nothing that holds is at its level."""
    if not all(row // 2 < len(modes.sigma) and modes.sigma[row // 2] == 0 for row in fired):
        return False
    watch = at.machine.watch(modes.solved)
    (seen,) = call(watch, (at.x, at.d, at.t, at.p, modes.vector()))
    levels = at.contact(modes)[5]
    pairs = seen[0][: levels.size].reshape(-1, 2)
    return all(pairs[i].min() > MOVES * levels[i].max() for i in modes.held)


def _next(stop: int, second: int, damped: bool) -> int:
    if stop == FREE:
        return PRESSING
    if stop == PRESSING:
        return ENTERED if damped else FREE
    return PRESSING if second else FREE


def settled(at: Instant, modes: Modes, resting: list[int]) -> tuple[Array, Modes]:
    """Let those of ``resting`` hold that can; in the state (X,), SI, their places rest exactly.

    What breaks away loses its breakaway level, which may let more break away."""
    total = len(modes.sigma)
    sigma, fixed = list(modes.sigma), [0.0] * total
    for i in resting:
        sigma[i] = 0
    x = _rested(at, modes, resting)
    at = replace(at, x=x)
    while resting:
        trial = replace(modes, sigma=tuple(sigma), fixed=(0.0,) * total, held=())
        _, _, b, G, _, levels, _ = at.contact(trial)
        force, moves = _least(G[np.ix_(resting, resting)], b[resting], levels[resting])
        if not moves.any():
            held = _independent(G, resting, force, levels)
            for i, value in zip(resting, force, strict=True):
                fixed[i] = 0.0 if i in held else float(value)
            return x, replace(modes, sigma=tuple(sigma), fixed=tuple(fixed), held=held)
        for i, way in zip(resting, moves, strict=True):
            sigma[i] = int(way)
        resting = [i for i, way in zip(resting, moves, strict=True) if way == 0]
    return x, replace(modes, sigma=tuple(sigma), fixed=(0.0,) * total, held=())


def _rested(at: Instant, modes: Modes, resting: list[int]) -> Array:
    """The state with the rates of ``resting`` at zero, by the least change of kinetic energy."""
    x, form = at.x.copy(), at.machine.form
    if not resting:
        return x
    _, rate, _, G, A, _, _ = at.contact(replace(modes, held=()))
    push = np.linalg.lstsq(G[np.ix_(resting, resting)], rate[resting], rcond=DEPENDENT)[0]
    n = len(form.free)
    x[n : 2 * n] += (A[resting].T @ push)[list(form.free)]
    for column in at.machine.on_columns(tuple(resting)):
        x[n + column] = 0.0
    return x


def returned(at: Instant, modes: Modes, stretch: Array) -> Array:
    """The state (X,) with the places of the frictions that hold where they held first, ``stretch``
    (F,) in m or rad, and their rates at zero: integrated along a curve they drift, SI."""
    held, x, form = list(modes.held), at.x.copy(), at.machine.form
    free, n = list(form.free), len(form.free)
    for _ in range(RETURNS_MOST):
        s, _, _, G, A, _, _ = replace(at, x=x).contact(modes)
        away = (s - stretch)[held]
        if np.all(np.abs(away) <= RETURNED * (1 + np.abs(s[held]))):
            break
        x[:n] += (A[held].T @ np.linalg.solve(G[np.ix_(held, held)], away))[free]
    return _rested(replace(at, x=x), modes, held)


def _least(G: Array, b: Array, levels: Array) -> tuple[Array, Integers]:
    """Forces (R,) of places at rest, N, and which way (R,) each begins to move, 0: it holds."""
    low, high = -levels[:, 1], levels[:, 0]
    if b.size == 1:
        force = np.clip(b / G[0], low, high)
    else:
        from scipy.optimize import lsq_linear

        size, axes = np.linalg.eigh(G)
        kept = size > DEPENDENT * size[-1]
        root = np.sqrt(size[kept])
        wide = high > low
        force = np.where(wide, 0.0, low)
        if wide.any():
            matrix = root[:, None] * axes[:, kept].T
            right = (axes[:, kept].T @ b) / root - matrix @ force
            bounds = (low[wide], high[wide])
            found = lsq_linear(matrix[:, wide], right, bounds, method="bvls", tol=1e-15)
            force[wide] = np.clip(found.x, *bounds)
    pull = b - G @ force
    rounding = MOVES * (np.abs(b) + np.abs(G) @ np.abs(levels).max(axis=1))
    up = (force >= high - 1e-12 * np.abs(high)) & (pull > rounding)
    down = (force <= low + 1e-12 * np.abs(low)) & (pull < -rounding)
    return force, up.astype(int) - down.astype(int)


def _independent(G: Array, resting: list[int], force: Array, levels: Array) -> tuple[int, ...]:
    """Those whose forces are solved for: as many as are independent, those with most reserve."""
    reserve = [
        min(levels[i, 0] - f, f + levels[i, 1]) / (levels[i].sum() or 1.0)
        for i, f in zip(resting, force, strict=True)
    ]
    chosen: list[int] = []
    for k in np.argsort(-np.array(reserve), kind="stable"):
        i = resting[int(k)]
        own = G[i, i]
        if chosen:
            inner = G[np.ix_(chosen, chosen)]
            own = own - G[i, chosen] @ np.linalg.solve(inner, G[chosen, i])
        if own > DEPENDENT * G[i, i]:
            chosen.append(i)
    return tuple(sorted(chosen))


def transitions(names: tuple[str, ...], t: float, before: Modes, now: Modes) -> list[Event]:
    """What changed between two modes, as events at ``t`` in s."""
    words = {0: "sticks", 1: "slides +", -1: "slides -"}
    pairs = list(zip(before.sigma, now.sigma, strict=True))
    found = [Event(t, names[i], words[b]) for i, (a, b) in enumerate(pairs) if a != b]
    total = len(pairs)
    for i, (a, b) in enumerate(zip(before.stops, now.stops, strict=True)):
        if a != b:
            again = "presses again" if a == ENTERED else "touches"
            word = {FREE: "leaves", PRESSING: again, ENTERED: "lets go"}[b]
            found.append(Event(t, names[total + i], word))
    total += len(before.stops)
    words = {0: "stays on it", 1: "switches +", -1: "switches -"}
    for i, (a, b) in enumerate(zip(before.sides, now.sides, strict=True)):
        if a != b:
            found.append(Event(t, names[total + i], words[b]))
    return found

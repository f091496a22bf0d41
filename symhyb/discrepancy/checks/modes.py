"""Where a model comes to rest, and how it swings about that place: linearised modes.

Dry friction is left out of both: linearised at rest it is a damper that nothing moves, and it may
hold a machine anywhere within its level. Sizes: n coordinates, k inputs, X states.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.discrepancy.words.wording import joined, number_text
from symhyb.judgement import NOTABLE
from symhyb.model.types import Model
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.lowered.dynamics import StateForm, state_form
from symhyb.numeric.lowered.lengths import length_directions
from symhyb.numeric.lowered.linear import Linearised, free_basis, linearised
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.manifold import free_part, gaps_of

BALANCED = 1e-8  # of the forces at work: what may be left at a place of rest
FREE = 1e-6  # of the fastest root: a root this slow moves freely
ROUNDED = 1e-9  # damping ratio: what rounding leaves to a machine without damping
LENGTH = 0.999  # of a shape: the rest is rounding of a double root
MOMENTS = (0.0, 0.137, 0.291, 0.618, 0.877)  # of a recording, at which slopes must agree


@dataclass(frozen=True, slots=True)
class Mode:
    """One root of the linearised machine. ``frequency`` |λ|/2π in Hz and ``damping`` −Re λ/|λ| of
    an oscillation; ``frequency`` 0 for a root that does not swing, which decays with the ``rate``
    −Re λ in 1/s (negative: it grows). ``shape`` by coordinate, SI, complex, the largest is 1."""

    frequency: float
    damping: float
    rate: float
    shape: tuple[tuple[str, complex], ...]

    @property
    def sentence(self) -> str:
        """The mode in words: ``1.59 Hz, damping ratio 0.0204, x 1``."""
        if self.frequency:
            said = f"{number_text(self.frequency)} Hz, damping ratio {number_text(self.damping)}"
            said += " (grows)" if self.damping < 0 else ""
        elif self.rate == 0.0:
            said = "moves freely, neither stiffness nor damping acts there"
        else:
            verb = "decays" if self.rate > 0 else "grows"
            said = f"no swing, {verb} within {number_text(1 / abs(self.rate))} s"
        return f"{said}: {joined([_component(*part) for part in self.shape])}"


def without_dry_friction(machine: Machine) -> tuple[Machine, tuple[str, ...]]:
    """The machine without its dry friction, and the names of what was left out."""
    dry = tuple(element.name for element in machine.model.elements if KINDS[element.kind].dry)
    if not dry:
        return machine, ()
    kept = tuple(element for element in machine.model.elements if element.name not in dry)
    return build(replace(machine.model, elements=kept), keep=False), dry


def rest_position(machine: Machine, q: Array, u: Array, t: float = 0.0) -> Array | None:
    """The place (n,) where a machine stands still under constant inputs ``u`` (k,), sought from
    ``q`` (n,), SI; imposed coordinates stay. None where forces push it on for ever."""
    from scipy.optimize import root

    free = list(machine.free)

    def forces(places: Array) -> Array:
        at = q.copy()
        at[free] = places
        return still_force(machine, at, u, t)[free] + scale * _held_open(machine, at, t)[free]

    scale = _at_work(machine, q, u, t)
    begin = forces(q[free])
    if np.all(np.abs(begin) <= BALANCED * scale):
        return q.copy()
    with np.errstate(all="ignore"):
        found = root(forces, q[free], method="hybr", options={"xtol": 1e-12})
        left = np.abs(forces(found.x))
    place = q.copy()
    place[free] = found.x
    limit = BALANCED * max(scale, _at_work(machine, place, u, t))
    return place if np.isfinite(left).all() and np.all(left <= limit) else None


def slopes_at(machine: Machine, q: Array, u: Array, t: float = 0.0) -> Linearised:
    """The machine linearised at a place (n,) where it stands still under inputs (k,), SI."""
    form = state_form(machine)
    x, d = _resting(form, q, u, t)
    return linearised(form, x, d, t, machine.values)


def modes_at(machine: Machine, q: Array, u: Array, t: float = 0.0) -> tuple[Mode, ...]:
    """The modes about a place (n,) of rest under inputs (k,), SI; the slowest first."""
    slopes = slopes_at(machine, q, u, t)
    if not np.isfinite(slopes.A).all():
        return ()
    form = state_form(machine)
    basis = free_basis(form, *_resting(form, q, u, t), t, machine.values)
    if basis is None:
        roots, vectors = np.linalg.eig(slopes.A)
    else:  # constraints leave these directions; in the others nothing swings
        roots, few = np.linalg.eig(np.linalg.pinv(basis) @ slopes.A @ basis)
        vectors = basis @ few
    scale = max(float(np.abs(roots).max(initial=0.0)), 1e-300)
    free = list(machine.free)
    names = [machine.model.coordinates[i].name for i in free]
    lengths = length_directions(machine.model, q)[:, free]
    found = []
    for value, vector in sorted(zip(roots, vectors.T, strict=True), key=lambda pair: abs(pair[0])):
        if value.imag < -FREE * scale:  # the partner of a pair says the same
            continue
        places = vector[: len(free)]
        if lengths.size and np.linalg.norm(lengths @ places) > LENGTH * np.linalg.norm(places) > 0:
            continue  # the length of a quaternion is no motion
        found.append(_mode(value, vector, names, scale))
    return tuple(dict.fromkeys(found))  # what moves freely has two roots, and is one mode


def steady_slopes(machine: Machine, q: Array, u: Array, times: Array) -> bool:
    """Whether the slopes at a place (n,) under inputs (k,), SI, are the same over the span of
    ``times`` (N,), s: forces may depend on time
    itself, stiffness, damping and masses may not."""
    first = slopes_at(machine, q, u, float(times[0])).A
    scale = float(np.abs(first).max(initial=0.0))
    places = times[0] + np.array(MOMENTS) * (times[-1] - times[0])
    return all(
        float(np.abs(slopes_at(machine, q, u, float(t)).A - first).max(initial=0.0)) <= 1e-9 * scale
        for t in places
    )


def start_of(model: Model) -> Array:
    """Where a model file says that simulations start, (n,) SI."""
    return np.array(model.start()[0])


def _mode(value: complex, vector: Array, names: Sequence[str], scale: float) -> Mode:
    size = abs(value)
    places = vector[: len(names)]
    if not np.abs(places).max(initial=0.0) > 0:
        shape: tuple[tuple[str, complex], ...] = ()
    else:
        largest = places[int(np.argmax(np.abs(places)))]
        relative = places / largest
        shape = tuple(
            (name, complex(np.round(part, 9)))
            for name, part in zip(names, relative, strict=True)
            if abs(part) >= NOTABLE
        )
    if value.imag > FREE * scale:
        ratio, rate = float(-value.real / size), float(-value.real)
        undamped = abs(ratio) < ROUNDED
        damped = (0.0, 0.0) if undamped else (ratio, rate)
        return Mode(float(size / (2 * np.pi)), *damped, shape)
    rate = 0.0 if size <= FREE * scale else float(-value.real)
    return Mode(0.0, 0.0, rate, shape)


def _component(name: str, part: complex) -> str:
    """One component of a shape: a number, with its angle where it is neither in phase nor
    against it."""
    if abs(part.imag) <= NOTABLE * abs(part):
        return f"{name} {number_text(part.real, digits=3)}"
    angle = number_text(float(np.degrees(np.angle(part))), digits=3)
    return f"{name} {number_text(abs(part), digits=3)} at {angle}°"


def _resting(form: StateForm, q: Array, u: Array, t: float) -> tuple[Array, Array]:
    still = np.zeros_like(q)
    (z,) = call(form.machine.inner_rest, (q, still, t, form.machine.values))
    return form.state(q, still, z.reshape(-1)), form.driven(u, q, still, still)


def still_force(machine: Machine, q: Array, u: Array, t: float) -> Array:
    """k_e − k_c (n,) of a machine that stands still at q (n,) under inputs u (k,), SI: what would
    set it in motion, the reactions of constraints taken off."""
    p, v = machine.values, np.zeros_like(q)
    (z,) = call(machine.inner_rest, (q, v, t, p))
    (pulls,) = call(machine.k_e, (q, v, z, u, t, p))
    (turns,) = call(machine.k_c, (q, v, t, p))
    return free_part(machine, q[None], np.array([t]), p, pulls - turns).reshape(-1)


def _held_open(machine: Machine, q: Array, t: float) -> Array:
    """Jᵀc (n,) at q (n,), SI: zero only where the constraints hold, and never opposite to a force
    in a free direction, so that the sum of both is zero where both are."""
    if not machine.constraints:
        return np.zeros_like(q)
    still = np.zeros((1, q.size))
    now = gaps_of(machine, q[None], still, still, np.array([t]), machine.values)
    return np.asarray(now.slope[0].T @ now.gap[0])


def _at_work(machine: Machine, q: Array, u: Array, t: float) -> float:
    """The size of the largest force at work at q, SI: the scale of a balance."""
    p, v = machine.values, np.zeros_like(q)
    (z,) = call(machine.inner_rest, (q, v, t, p))
    (parts,) = call(machine.elements, (q, v, z, u, t, p))
    total = still_force(machine, q, u, t)
    return float(max(np.abs(parts).max(initial=0.0), np.abs(total).max(initial=0.0)))

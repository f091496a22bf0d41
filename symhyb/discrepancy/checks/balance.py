"""The energy of a recording: what was put in, stored, dissipated by which element, and the rest.

    work of inputs + work of the rig + work unaccounted = change of stored energy + dissipated

Works are integrals of a force times speed along the smoothed motion, stored energies those of its
first and last sample. What an element takes and does not store, it dissipates. ``unaccounted``
closes the balance, which needs no acceleration: it is ∫ ΔF·q' dt, negative where the machine loses
more than the model says. Sizes: N samples, n coordinates, E elements.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.recorded.ends import between_ends
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.words.wording import joined, percent_text, quantity_text
from symhyb.judgement import NEGLIGIBLE, OUTSTANDING
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.linear import energy_depends_on_time
from symhyb.numeric.lowered.machine import Machine

STANDING = 1e-9  # of the kinetic energy: what rounding may leave to a machine that stands


@dataclass(frozen=True, slots=True)
class Balance:
    """Energies of one recording over ``span`` in s, in ``unit``. ``put_in`` by active element,
    ``rig`` by imposed coordinate (``measured`` where the reaction was, else as the model has it),
    ``dissipated`` by element, ``stored`` the change of kinetic and potential energy,
    ``unaccounted`` with one ``sd``; it is 0 where no coordinate is free and the reaction was not
    measured."""

    unit: str
    span: tuple[float, float]
    put_in: Mapping[str, float]
    rig: Mapping[str, float]
    measured: bool
    dissipated: Mapping[str, float]
    stored: float
    unaccounted: float
    sd: float

    @property
    def turnover(self) -> float:
        """The larger of all that came in and all that went out."""
        parts = (*self.put_in.values(), *self.rig.values(), self.unaccounted, -self.stored)
        flows = (*parts, *(-one for one in self.dissipated.values()))
        return max(sum(x for x in flows if x > 0), -sum(x for x in flows if x < 0))

    @property
    def sentence(self) -> str:
        """The balance in words."""
        listed = [f"{self._amount(value)} by {name}" for name, value in self.put_in.items()]
        by = "measured" if self.measured else "as the model has it"
        listed += [f"{self._amount(v)} by the rig on {k} ({by})" for k, v in self.rig.items()]
        lost = [
            f"{self._amount(value)} by {name}"
            for name, value in sorted(self.dissipated.items(), key=lambda item: -item[1])
            if abs(value) > NEGLIGIBLE * self.turnover
        ]
        came, went = joined(listed) or "nothing", joined(lost) or "nothing"
        return (
            f"{self.span[0]:.4g} … {self.span[1]:.4g} s: put in {came}; stored energy changes by "
            f"{self._amount(self.stored)}; dissipated {went}; {self._rest()}"
        )

    def _rest(self) -> str:
        share = percent_text(abs(self.unaccounted) / self.turnover) if self.turnover > 0 else ""
        amount = quantity_text(abs(self.unaccounted), self.unit, self.sd)
        if abs(self.unaccounted) <= OUTSTANDING * self.sd:
            return f"unaccounted {amount}: no more than its noise"
        way = "lost" if self.unaccounted < 0 else "gained"
        return f"{way} beyond what the model knows: {amount} ({share} of what went around)"

    def _amount(self, value: float) -> str:
        return quantity_text(value, self.unit, digits=3)


def balance_of(machine: Machine, motion: Motion, course: Course) -> Balance | str:
    """The energy balance along a course without its ends, where the smoothed motion is wilder; or
    why there is none."""
    if energy_depends_on_time(machine):
        return "masses, positions or energies of the model depend on time itself"
    if motion.blind:
        return f"no sensor shows the place of {joined(motion.blind)}"
    c = course.at(np.flatnonzero(between_ends(motion, course.t)))
    energies, standing = _energies(machine, c), _energies(machine, replace(c, v=0 * c.v))
    if np.abs(standing[0]).max() > STANDING * np.abs(energies[0]).max():
        return "bodies move while every coordinate stands still: positions depend on time itself"
    forces, model = _forces(machine, c), machine.model
    put_in, dissipated, lossy = dict[str, float](), dict[str, float](), np.zeros_like(c.v)
    for e, element in enumerate(model.elements):
        kind, taken = KINDS[element.kind].energy, -_work(c.t, forces[:, e], c.v)
        if kind == "active":
            put_in[element.name] = -taken
        elif kind == "dissipative":
            dissipated[element.name] = taken - float(energies[2][-1, e] - energies[2][0, e])
        if kind != "conservative":
            lossy = lossy + forces[:, e]
    rig, measured = _rig(machine, c)
    total = energies[0][:, 0] + energies[1][:, 0] + energies[2].sum(axis=1)
    stored, unit = float(total[-1] - total[0]), model.energy_unit.factor
    closes = stored + sum(dissipated.values()) - sum(put_in.values()) - sum(rig.values())
    if not machine.free and not measured:  # what the model asks of the rig is all there is
        rig = {name: work + closes / len(rig) for name, work in rig.items()}
        closes = 0.0
    pulls = lossy + np.where(np.isfinite(c.reaction), c.reaction, 0.0)
    return Balance(
        model.energy_unit.text,
        (float(c.t[0]), float(c.t[-1])),
        {name: work / unit for name, work in put_in.items()},
        {name: work / unit for name, work in rig.items()},
        measured,
        {name: work / unit for name, work in dissipated.items()},
        stored / unit,
        closes / unit,
        _sd(machine, c, motion, pulls) / unit,
    )


def _forces(machine: Machine, c: Course) -> Array:
    """The generalized force of every element (N, E, n), SI."""
    given = c.q, c.v, c.z, c.u, c.t, c.values(machine)
    (parts,) = along(machine.elements, given, (5,), c.t.size)
    return parts.reshape(c.t.size, len(machine.model.elements), machine.n)


def _energies(machine: Machine, c: Course) -> tuple[Array, Array, Array]:
    """Kinetic and potential energy (N, 1) and what the elements store (N, E), SI."""
    given = c.q, c.v, c.z, c.t, c.values(machine)
    kinetic, potential, kept = along(machine.energy, given, (4,), c.t.size)
    return kinetic, potential, kept.reshape(c.t.size, len(machine.model.elements))


def _sd(machine: Machine, c: Course, motion: Motion, pulls: Array) -> float:
    """One deviation of the balance, SI: that of the energies at both ends, and of the works of
    ``pulls`` (N, n) by the error of the speed, which is alike between two knots."""
    step = float(np.median(np.diff(c.t)))
    together = max(motion.spacing_s / step, 1.0)
    variance = together * float(np.sum((pulls * motion.v_sd * step) ** 2))
    ends = c.at([0, -1])
    base = sum(part.sum(axis=1) for part in _energies(machine, ends))
    for name, spread in (("q", motion.q_sd), ("v", motion.v_sd)):
        for j in range(machine.n):
            moved = getattr(ends, name).copy()
            moved[:, j] += spread[j]
            other = _energies(machine, replace(ends, **{name: moved}))
            variance += float(np.sum((sum(part.sum(axis=1) for part in other) - base) ** 2))
    return float(np.sqrt(variance))


def _rig(machine: Machine, c: Course) -> tuple[dict[str, float], bool]:
    """Work of the forces that drive imposed coordinates, and whether all of them were measured."""
    work, known = {}, True
    for i in machine.imposed:
        reaction = c.reaction[:, i]
        if not np.isfinite(reaction).all():  # where it was not measured, the model must say it
            known = False
            given = c.q, c.v, c.a, c.z, c.u, c.t, c.values(machine)
            (said,) = along(machine.discrepancy, given, (6,), c.t.size)
            measured = np.isfinite(reaction)
            reaction = np.where(measured, reaction, said[:, i])
        name = machine.model.coordinates[i].name
        work[name] = _work(c.t, reaction[:, None], c.v[:, i : i + 1])
    return work, known


def _work(t: Array, force: Array, v: Array) -> float:
    """∫ F·v dt of forces (N, n) along speeds (N, n), by the trapezoidal rule."""
    return float(np.trapezoid((force * v).sum(axis=1), t))

r"""The energy of a recording: what was put in, stored, dissipated by which element, and the rest.

    work of inputs + work of the rig + work unaccounted = change of stored energy + dissipated

All are integrals of force times speed along the smoothed motion. That of an element that stores
energy is −ΔV; what else it takes, it dissipates. ``unaccounted`` is ∫ ΔF·q' dt: negative where the
machine loses more than the model says. Sizes: N samples, n coordinates, E elements.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.course import Course
from symhyb.discrepancy.motion import Motion
from symhyb.discrepancy.residual import discrepancy, force_band
from symhyb.discrepancy.wording import joined, percent_text, quantity_text
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.buffers import Array
from symhyb.numeric.linear import energy_depends_on_time
from symhyb.numeric.machine import Machine
from symhyb.numeric.vector import along

SURE = 3.0  # standard deviations, from which work unaccounted is told as such
STANDING = 1e-9  # of the kinetic energy: what rounding may leave to a machine that stands
SMALL = 1e-3  # of the energy that went around: an element that took less is not listed


@dataclass(frozen=True, slots=True)
class Balance:
    """Energies of one recording in ``unit``. ``put_in`` by active element, ``rig`` by imposed
    coordinate (``measured`` where the reaction was, else as the model has it), ``dissipated`` by
    element, ``stored`` the change of kinetic and potential energy, ``unaccounted`` with one
    ``sd``, ``left`` what the integrals miss."""

    unit: str
    put_in: Mapping[str, float]
    rig: Mapping[str, float]
    measured: bool
    dissipated: Mapping[str, float]
    stored: float
    unaccounted: float
    sd: float
    left: float

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
            if abs(value) > SMALL * self.turnover
        ]
        return (
            f"put in {joined(listed) or 'nothing'}; stored energy changes by "
            f"{self._amount(self.stored)}; dissipated {joined(lost) or 'nothing'}; {self._rest()}"
        )

    def _rest(self) -> str:
        share = percent_text(abs(self.unaccounted) / self.turnover) if self.turnover > 0 else ""
        amount = quantity_text(abs(self.unaccounted), self.unit, self.sd)
        if abs(self.unaccounted) <= SURE * self.sd:
            return f"unaccounted {amount}: no more than its noise"
        way = "lost" if self.unaccounted < 0 else "gained"
        return f"{way} beyond what the model knows: {amount} ({share} of what went around)"

    def _amount(self, value: float) -> str:
        return quantity_text(value, self.unit, digits=3)


def balance_of(machine: Machine, motion: Motion, course: Course) -> Balance | str:
    """The energy balance along a course, or why there is none."""
    if energy_depends_on_time(machine):
        return "masses, positions or energies of the model depend on time itself"
    if motion.blind:
        return f"no sensor shows the place of {joined(motion.blind)}"
    model, p, c = machine.model, machine.values, course
    (parts,) = along(machine.elements, (c.q, c.v, c.z, c.u, c.t, p), (5,), c.t.size)
    forces = parts.reshape(c.t.size, len(model.elements), machine.n)
    taken = [-_work(c.t, forces[:, e], c.v) for e in range(len(model.elements))]
    kinetic, potential, kept = along(machine.energy, (c.q, c.v, c.z, c.t, p), (4,), c.t.size)
    kept = kept.reshape(c.t.size, len(model.elements))
    resting, *_ = along(machine.energy, (c.q, 0 * c.v, c.z, c.t, p), (4,), c.t.size)
    if np.abs(resting).max() > STANDING * np.abs(kinetic).max():
        return "bodies move while every coordinate stands still: positions depend on time itself"
    put_in, dissipated = {}, {}
    for e, element in enumerate(model.elements):
        if KINDS[element.kind].energy == "active":
            put_in[element.name] = -taken[e]
        elif KINDS[element.kind].energy == "dissipative":
            dissipated[element.name] = taken[e] - float(kept[-1, e] - kept[0, e])
    total = kinetic[:, 0] + potential[:, 0] + kept.sum(axis=1)
    lacking = discrepancy(machine, c, p)
    rig, known = _rig(machine, c)
    spread = force_band(machine, motion, c) * np.where(np.isfinite(c.reaction), 1.0, 0.0)
    step = float(np.median(np.diff(c.t)))
    together = max(motion.spacing_s / step, 1.0)  # the error of a spline is alike between knots
    sd = float(np.sqrt(together * np.sum((spread * c.v * step) ** 2)))
    unit = model.energy_unit.factor
    stored, unaccounted = float(total[-1] - total[0]), _work(c.t, lacking, c.v)
    came = sum(put_in.values()) + sum(rig.values()) + unaccounted
    left = came - stored - sum(dissipated.values())
    return Balance(
        model.energy_unit.text,
        {name: work / unit for name, work in put_in.items()},
        {name: work / unit for name, work in rig.items()},
        known,
        {name: work / unit for name, work in dissipated.items()},
        stored / unit, unaccounted / unit, sd / unit, left / unit,
    )  # fmt: skip


def _rig(machine: Machine, c: Course) -> tuple[dict[str, float], bool]:
    """Work of the forces that drive imposed coordinates, and whether all of them were measured."""
    work, known = {}, True
    for i in machine.imposed:
        reaction = c.reaction[:, i]
        if not np.isfinite(reaction).all():  # where it was not measured, the model must say it
            known = False
            given = c.q, c.v, c.a, c.z, c.u, c.t, machine.values
            (said,) = along(machine.discrepancy, given, (6,), c.t.size)
            measured = np.isfinite(reaction)
            reaction = np.where(measured, reaction, said[:, i])
        name = machine.model.coordinates[i].name
        work[name] = _work(c.t, reaction[:, None], c.v[:, i : i + 1])
    return work, known


def _work(t: Array, force: Array, v: Array) -> float:
    """∫ F·v dt of forces (N, n) along speeds (N, n), by the trapezoidal rule."""
    return float(np.trapezoid((force * v).sum(axis=1), t))

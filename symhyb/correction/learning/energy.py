"""Does a trained force feed energy in? Along the recordings, and on closed orbits of its place.

A passive force takes energy out on every closed orbit. One that feeds energy in may drive the
simulation into a motion that the machine never has. Nothing is forbidden here: it is said.
"""

from dataclasses import dataclass

import numpy as np

from symhyb.correction.learning.seen import Seen
from symhyb.discrepancy.words.wording import quantity_text
from symhyb.judgement import NEGLIGIBLE
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.network import Weights, evaluated

SIZES = (0.1, 0.25, 0.5, 0.75, 1.0)  # of the trust box: sizes of the orbits
POINTS = 400  # of an orbit


@dataclass(frozen=True, slots=True, eq=False)
class Energy:
    """Work of a force, J: net over each recording in ``net``, positive if it feeds energy in;
    ``orbits`` on closed orbits of growing size, empty where the force does not depend on position
    and speed of its place alone; ``turnover`` is the work back and forth over all recordings."""

    net: tuple[tuple[str, float], ...]
    orbits: tuple[float, ...]
    turnover: float

    @property
    def feeds(self) -> bool:
        """Whether it feeds energy in, over a whole recording or on an orbit."""
        least = NEGLIGIBLE * self.turnover
        return any(work > least for _, work in self.net) or any(w > least for w in self.orbits)

    @property
    def sentence(self) -> str:
        """The same in words."""
        total = sum(work for _, work in self.net)
        done = "puts in" if total > 0 else "takes out"
        said = f"Along the recordings its force {done} {quantity_text(abs(total), 'J')}"
        if not self.orbits:
            return f"{said}; it sees more than position and speed, so orbits say nothing."
        if max(self.orbits) <= NEGLIGIBLE * self.turnover:
            return f"{said}, and on no closed orbit in its trust box does it feed energy in."
        size = SIZES[int(np.argmax(self.orbits))]
        return (
            f"{said}, but on a closed orbit of {size:.0%} of its trust box it feeds in "
            f"{quantity_text(max(self.orbits), 'J')} a cycle: it is not passive."
        )


def energy_of(weights: Weights, seen: Seen) -> Energy:
    """The work of a network along what it was trained on and on ellipses in its trust box."""
    power = evaluated(weights, seen.x) * seen.v
    net, turnover = [], 0.0
    for run, name in enumerate(seen.names):
        rows = np.flatnonzero(seen.run == run)
        rows = rows[np.argsort(seen.t[rows], kind="stable")]
        steps = np.diff(seen.t[rows])
        near = steps < 3 * np.median(steps)  # not across windows that were left out
        parts = (steps * (power[rows][1:] + power[rows][:-1]) / 2)[near]
        net.append((name, float(parts.sum())))
        turnover += float(np.abs(parts).sum())
    return Energy(tuple(net), _on_orbits(weights, seen), turnover)


def _on_orbits(weights: Weights, seen: Seen) -> tuple[float, ...]:
    """Work per cycle of s = s_0 + A sin φ, s' = B cos φ with A, B growing to the box; s' is taken
    as centred, for an orbit closes only so."""
    if set(seen.inputs) - {seen.on, f"{seen.on}'"}:
        return ()
    phase = 2 * np.pi * np.arange(POINTS) / POINTS
    half = (float(seen.q.max()) - float(seen.q.min())) / 2
    middle = (float(seen.q.max()) + float(seen.q.min())) / 2
    fastest = min(float(seen.v.max()), -float(seen.v.min()))
    works = []
    for size in SIZES if fastest > 0 else ():
        ds = size * half * np.cos(phase) * 2 * np.pi / POINTS
        columns: dict[str, Array] = {
            seen.on: middle + size * half * np.sin(phase),
            f"{seen.on}'": size * fastest * np.cos(phase),
        }
        x = np.column_stack([columns[name] for name in seen.inputs])
        works.append(float(evaluated(weights, x) @ ds))
    return tuple(works)

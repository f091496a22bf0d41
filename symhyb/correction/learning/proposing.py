"""Terms that the weak form proposes, coordinate by coordinate, and those it cannot distinguish from
them.

Sizes: T candidate terms.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.correction.learning.choosing import choose_terms, coefficients_of, exchanges
from symhyb.correction.learning.corrected import Formulation
from symhyb.correction.learning.library import DEGREE, Candidate, LibraryName, candidates
from symhyb.correction.learning.sparse import OptimizerName
from symhyb.correction.learning.weak import WeakForm, weak_form
from symhyb.correction.learning.written import Chosen
from symhyb.correction.search.preparing import Prepared
from symhyb.discrepancy.places.candidates import transition_share


@dataclass(frozen=True, slots=True)
class Sparse:
    """What a search asks for: candidate terms up to a ``degree``, and the optimiser of PySINDy."""

    library: LibraryName = "laws"
    degree: int = DEGREE
    optimizer: OptimizerName = "stlsq"


@dataclass(frozen=True, slots=True)
class Regression:
    """The weak ``form`` of all candidates, the ``lists`` of each coordinate, which row of the form
    a coordinate is, and the ``optimizer``."""

    form: WeakForm
    lists: Mapping[str, tuple[Candidate, ...]]
    rows: Mapping[str, int]
    optimizer: OptimizerName

    @property
    def tried(self) -> int:
        """How many candidates a coordinate has at most."""
        return max((len(own) for own in self.lists.values()), default=1)

    def chosen(self) -> tuple[Chosen, ...]:
        """The terms that are proposed, with the coefficients of the regression."""
        found: list[Chosen] = []
        for name in self.lists:
            kept = choose_terms(self.form, self.rows[name], self._allowed(name), self.optimizer)
            found += self._made(name, kept)
        return tuple(found)

    def exchanged(self, chosen: Sequence[Chosen]) -> tuple[tuple[Chosen, ...], ...]:
        """The same with some terms of a coordinate exchanged for one other that the weak form
        cannot distinguish from them, the fewest terms and the likeliest first."""
        others: list[tuple[Chosen, ...]] = []
        for name in self.lists:
            own = [one for one in chosen if one.on == name]
            kept = tuple(self.form.texts.index(one.term.text) for one in own)
            rest = tuple(one for one in chosen if one.on != name)
            for rival in exchanges(self.form, self.rows[name], self._allowed(name), kept):
                others.append((*rest, *self._made(name, rival)))
        return tuple(others)

    def _allowed(self, name: str) -> tuple[int, ...]:
        return tuple(self.form.texts.index(one.text) for one in self.lists[name])

    def _made(self, name: str, kept: Sequence[int]) -> list[Chosen]:
        at = {one.text: one for one in self.lists[name]}
        values, sds = coefficients_of(self.form, self.rows[name], kept)
        return [
            Chosen(name, at[self.form.texts[i]], float(value), float(sd), float(value))
            for i, value, sd in zip(kept, values, sds, strict=True)
        ]


def regression(
    prepared: Prepared, asked: Sparse, formulation: Formulation, on: Sequence[str]
) -> Regression:
    """The regression of what is lacking on some free coordinates.

    Raises:
        InputError: an unknown library, a degree that is none, or recordings without windows.
    """
    names = [c.name for c in prepared.model.coordinates]
    widths = _widths(prepared, names)
    free = [names[i] for i in prepared.machine.free]
    lists = {
        name: candidates(names, name, widths, asked.library, asked.degree)
        for name in free
        if name in on
    }
    texts = tuple(dict.fromkeys(one.text for own in lists.values() for one in own))
    rows = {name: row for row, name in enumerate(free)}
    return Regression(weak_form(prepared, texts, formulation), lists, rows, asked.optimizer)


def _widths(prepared: Prepared, names: Sequence[str]) -> dict[str, float]:
    """Speeds (SI) over which dry friction on each coordinate is smoothed."""
    fastest = np.max([np.abs(run.motion.v).max(axis=0) for run in prepared.runs], axis=0)
    share = transition_share(_relative_noise(prepared))
    return {name: float(f"{share * v:.3g}") for name, v in zip(names, fastest, strict=True)}


def _relative_noise(prepared: Prepared) -> float:
    """Noise over spread of the sensor that shows most."""
    ratios = [
        sd / float(np.nanstd(values))
        for run in prepared.runs
        for sensor, sd in zip(prepared.model.sensors, prepared.sd, strict=True)
        if (values := run.recording.sensors.get(sensor.name)) is not None and np.nanstd(values) > 0
    ]
    return min(ratios, default=0.0)

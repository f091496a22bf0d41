"""Sparse learning from recordings: terms chosen on the weak form, their values by simulation.

The optimisers of PySINDy propose sets of terms on the weak form of what is lacking, held windows
choose among them (:mod:`symhyb.correction.learning.choosing`), and the chosen ones are written as
elements, fitted by simulation error, exchanged one for one where the weak form cannot distinguish
two and the simulation can, and kept only where held windows are simulated better
(:mod:`symhyb.correction.learning.matched`). Nothing is read from PySINDy's printed equations: all
that is reported comes from coefficients.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.learning.corrected import Correction, Formulation, Terms
from symhyb.correction.learning.free_running import closer
from symhyb.correction.learning.matched import Signs, Worth, matched, price_of, weakest, worth
from symhyb.correction.learning.proposing import Regression, Sparse, regression
from symhyb.correction.learning.written import Chosen, Written, as_forces, as_rates
from symhyb.correction.search.preparing import Prepared, last_windows
from symhyb.discrepancy.fitting.task import Fit
from symhyb.errors import InputError, NumericsError, Problem
from symhyb.judgement import ACCURACY
from symhyb.mechanics.mass_text import mass_texts
from symhyb.model.types import Model
from symhyb.steps import Say

ROUNDS = 3  # of dropping terms and exchanging one

NO_FILE = (
    "The rates cannot be written as a model file: a file holds forces, and the mass matrix that "
    "turns rates into forces cannot be written as expressions here. The terms are in learned.json."
)


@dataclass(frozen=True, slots=True)
class LearntTerms:
    """What was learned: ``chosen`` terms, how they are ``written`` (None: not as a model file; the
    ``correction`` of rates then simulates them), and what held windows say of them (None: nothing
    was simulated); ``notes`` are sentences."""

    chosen: tuple[Chosen, ...]
    written: Written | None
    worth: Worth | None
    notes: tuple[str, ...] = ()
    correction: Correction | None = None


def learn_terms(
    model: Model,
    prepared: Prepared,
    formulation: Formulation,
    asked: Sparse,
    on: Sequence[str],
    say: Say,
) -> LearntTerms:
    """Learn terms of ΔF or of Δv' on some free coordinates of a ``model``.

    Raises:
        InputError: an unknown library or optimizer, candidates that depend on each other, or a
            model with constraints.
        NumericsError: the model cannot be simulated along the recordings.
    """
    _require_free(model, prepared)
    say("regressing on the weak form")
    proposals = regression(prepared, asked, formulation, on)
    chosen = proposals.chosen()
    mass = mass_texts(model) if formulation == "rates" and chosen else {}
    if mass is None:
        return _unwritten(prepared, chosen)
    say("fitting by simulation error")
    return _held_against(_Rig(model, prepared, formulation, mass), chosen, proposals)


def _unwritten(prepared: Prepared, chosen: tuple[Chosen, ...]) -> LearntTerms:
    """Terms of rates that no file holds, if held windows are better with them."""
    free = [prepared.model.coordinates[i].name for i in prepared.machine.free]
    coefficients = np.zeros((2 * len(free), len(chosen)))
    for i, one in enumerate(chosen):
        coefficients[len(free) + free.index(one.on), i] = one.value
    law = Terms(tuple(one.term.text for one in chosen), coefficients)
    if not closer(prepared, last_windows(prepared, spread=True), law):
        return LearntTerms((), as_forces(prepared.model, ()), None)
    return LearntTerms(chosen, None, None, (NO_FILE,), Correction("rates", (law,)))


@dataclass(frozen=True, slots=True)
class _Rig:
    """The model with what its terms are written and simulated with."""

    model: Model
    prepared: Prepared
    formulation: Formulation
    mass: dict[tuple[str, str], str]

    def written(self, chosen: Sequence[Chosen]) -> Written:
        if self.formulation == "force":
            return as_forces(self.model, chosen)
        return as_rates(self.model, chosen, self.mass)

    def fitted(
        self, chosen: Sequence[Chosen], everything: bool = False
    ) -> tuple[Written, Fit, bool]:
        """Terms as elements, the fit, and whether their values were free in it."""
        written = self.written(chosen)
        paths = [own for _, own in written.paths]
        free = all(len(own) == 1 for own in paths)
        signs = Signs((), ())
        if free:
            bound = self.formulation == "force"  # keys of passive kinds
            losing = ("damper", "drag", "friction")
            positive = tuple(bound and c.listed and c.term.kind in losing for c in chosen)
            signs = Signs(tuple(own[0] for own in paths), positive)
        return written, matched(self.prepared, written.elements, signs, everything), free

    def moved(self, chosen: Sequence[Chosen], found: Fit) -> tuple[Chosen, ...]:
        """The terms with fitted values."""
        sds = np.sqrt(np.diag(found.covariance))
        signs = [one.sign if self.formulation == "force" else 1 for one in chosen]
        return tuple(
            replace(one, value=float(sign * value), sd=float(np.hypot(sd, ACCURACY * value)))
            for one, sign, value, sd in zip(chosen, signs, found.values, sds, strict=True)
        )


def _held_against(rig: _Rig, chosen: tuple[Chosen, ...], proposals: Regression) -> LearntTerms:
    """The terms that simulations of held windows keep, with values from all windows."""
    nothing = matched(rig.prepared, (), Signs((), ()))
    if nothing.reason and not chosen:
        raise NumericsError(f"the model cannot be simulated: {nothing.reason}")
    for _ in range(ROUNDS):
        chosen, found, free = _pruned(rig, chosen, proposals.tried)
        other = _exchanged(rig, chosen, found, proposals) if free and not found.reason else None
        if other is None:
            break
        chosen = other
    judged = worth(rig.prepared, nothing, found)
    if found.reason:
        said = f"The terms that regression proposes were dropped: {found.reason}."
        return LearntTerms((), rig.written(()), judged, (said,))
    return _kept(rig, chosen, free, judged)


def _pruned(
    rig: _Rig, chosen: tuple[Chosen, ...], tried: int
) -> tuple[tuple[Chosen, ...], Fit, bool]:
    """The terms without those that the criterion would rather do without."""
    while True:
        _, found, free = rig.fitted(chosen)
        if not chosen or not free or found.reason:
            return chosen, found, free
        drop = weakest(found, tried)
        chosen = rig.moved(chosen, found)
        if drop is None:
            return chosen, found, free
        chosen = (*chosen[:drop], *chosen[drop + 1 :])


def _exchanged(
    rig: _Rig, chosen: tuple[Chosen, ...], found: Fit, proposals: Regression
) -> tuple[Chosen, ...] | None:
    """The terms with some exchanged for one other, where the criterion would rather have these on
    fitted windows."""
    unit, price = found.scale * found.correlation, price_of(found, proposals.tried)
    best, cost = None, found.train / unit + price * len(chosen)
    for rival in proposals.exchanged(chosen):
        _, other, free = rig.fitted(rival)
        if free and not other.reason and other.train / unit + price * len(rival) < cost:
            best, cost = rival, other.train / unit + price * len(rival)
    return best


def _kept(rig: _Rig, chosen: tuple[Chosen, ...], free: bool, judged: Worth) -> LearntTerms:
    if not chosen or not judged.better:
        return LearntTerms((), rig.written(()), judged)
    notes: tuple[str, ...] = ()
    if free:
        last = rig.fitted(chosen, everything=True)[1]
        chosen = chosen if last.reason else rig.moved(chosen, last)
    else:
        notes = (
            "The values are those of the regression: with a mass matrix that couples coordinates "
            "one rate acts as several forces, and simulation error did not refine them.",
        )
    return LearntTerms(chosen, rig.written(chosen), judged, notes)


def _require_free(model: Model, prepared: Prepared) -> None:
    if prepared.machine.constraints:
        text = "terms are not learned with constraints: the weak form holds their reactions"
        raise InputError(Problem(f"{text}; --by network does it", "constraints", model.file))
    if not prepared.machine.free:
        raise InputError(Problem("no coordinate is free, so that nothing can be learned"))

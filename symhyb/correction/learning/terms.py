"""Sparse learning from recordings: terms chosen on the weak form, their values by simulation.

The optimisers of PySINDy propose sets of terms on the weak form of what is lacking, held windows
choose among them (:mod:`symhyb.correction.learning.choosing`), and the chosen ones are written as
elements, fitted by simulation error, and kept only where held windows are simulated better
(:mod:`symhyb.correction.learning.matched`). Nothing is read from PySINDy's printed equations: all
that is told comes from coefficients.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.learning.choosing import choose_terms, coefficients_of
from symhyb.correction.learning.free_running import closer
from symhyb.correction.learning.library import DEGREE, Candidate, LibraryName, candidates
from symhyb.correction.learning.matched import Signs, Worth, matched, weakest, worth
from symhyb.correction.learning.sparse import OptimizerName
from symhyb.correction.learning.weak import WeakForm, weak_form
from symhyb.correction.learning.written import Chosen, Written, as_forces, as_rates
from symhyb.correction.search.preparing import ACCURACY, Prepared, last_windows
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.candidates import transition_share
from symhyb.errors import InputError, NumericsError, Problem
from symhyb.mechanics.mass_text import mass_texts
from symhyb.model.types import Model
from symhyb.numeric.runs.formulations import Correction, Formulation, Terms

Say = Callable[[str], None]
NO_FILE = (
    "The rates cannot be written as a model file: a file holds forces, and the mass matrix that "
    "turns rates into forces cannot be written as expressions here. The terms are in learned.json."
)


@dataclass(frozen=True, slots=True)
class Sparse:
    """What a search asks for: candidate terms up to a ``degree``, and the optimiser of PySINDy."""

    library: LibraryName = "laws"
    degree: int = DEGREE
    optimizer: OptimizerName = "stlsq"


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
    lists = {name: own for name, own in _candidates(prepared, asked).items() if name in on}
    say("regressing on the weak form")
    chosen = _regressed(prepared, lists, formulation, asked.optimizer)
    mass = mass_texts(model) if formulation == "rates" and chosen else {}
    if mass is None:
        return _unwritten(prepared, chosen)
    say("fitting by simulation error")
    return _held_against(_Rig(model, prepared, formulation, mass), chosen, lists)


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


def _held_against(
    rig: _Rig, chosen: tuple[Chosen, ...], lists: dict[str, tuple[Candidate, ...]]
) -> LearntTerms:
    """The terms that simulations of held windows keep, with values from all windows."""
    nothing = matched(rig.prepared, (), Signs((), ()))
    if nothing.reason and not chosen:
        raise NumericsError(f"the model cannot be simulated: {nothing.reason}")
    tried = max((len(own) for own in lists.values()), default=1)
    while chosen:
        _, found, free = rig.fitted(chosen)
        if found.reason:
            said = f"The terms that regression proposes were dropped: {found.reason}."
            judged = Worth(_held(nothing), float("nan"), False)
            return LearntTerms((), rig.written(()), judged, (said,))
        drop = weakest(found, tried) if free else None
        if drop is None:
            judged = worth(rig.prepared, nothing, found)
            return _kept(rig, chosen, found, free, judged)
        chosen = rig.moved(chosen, found)
        chosen = (*chosen[:drop], *chosen[drop + 1 :])
    none = _held(nothing)
    return LearntTerms((), rig.written(()), Worth(none, none, False))


def _kept(
    rig: _Rig, chosen: tuple[Chosen, ...], found: Fit, free: bool, judged: Worth
) -> LearntTerms:
    if not judged.better:
        return LearntTerms((), rig.written(()), judged)
    notes: tuple[str, ...] = ()
    if free:
        chosen = rig.moved(chosen, found)
        last = rig.fitted(chosen, everything=True)[1]
        chosen = chosen if last.reason else rig.moved(chosen, last)
    else:
        notes = (
            "The values are those of the regression: with a mass matrix that couples coordinates "
            "one rate acts as several forces, and simulation error did not refine them.",
        )
    return LearntTerms(chosen, rig.written(chosen), judged, notes)


def _held(found: Fit) -> float:
    return found.validation / max(float(found.count[found.held].sum()), 1.0)


def _regressed(
    prepared: Prepared,
    lists: dict[str, tuple[Candidate, ...]],
    formulation: Formulation,
    optimizer: OptimizerName,
) -> tuple[Chosen, ...]:
    """The terms that the weak form chooses, row by row, with the coefficients of the regression."""
    texts = tuple(dict.fromkeys(one.text for own in lists.values() for one in own))
    form: WeakForm = weak_form(prepared, texts, formulation)
    found: list[Chosen] = []
    for row, (name, own) in enumerate(lists.items()):
        at = {texts.index(one.text): one for one in own}
        kept = choose_terms(form, row, tuple(at), optimizer)
        values, sds = coefficients_of(form, row, kept)
        found += [
            Chosen(name, at[i], float(value), float(sd), float(value))
            for i, value, sd in zip(kept, values, sds, strict=True)
        ]
    return tuple(found)


def _candidates(prepared: Prepared, asked: Sparse) -> dict[str, tuple[Candidate, ...]]:
    """The candidate terms of every free coordinate, by name."""
    machine = prepared.machine
    names = [c.name for c in prepared.model.coordinates]
    fastest = np.max([np.abs(run.motion.v).max(axis=0) for run in prepared.runs], axis=0)
    share = transition_share(_relative_noise(prepared))
    widths = {name: float(f"{share * v:.3g}") for name, v in zip(names, fastest, strict=True)}
    return {
        names[i]: candidates(names, names[i], widths, asked.library, asked.degree)
        for i in machine.free
    }


def _relative_noise(prepared: Prepared) -> float:
    """Noise over spread of the sensor that shows most."""
    ratios = [
        sd / float(np.nanstd(values))
        for run in prepared.runs
        for sensor, sd in zip(prepared.model.sensors, prepared.sd, strict=True)
        if (values := run.recording.sensors.get(sensor.name)) is not None and np.nanstd(values) > 0
    ]
    return min(ratios, default=0.0)


def _require_free(model: Model, prepared: Prepared) -> None:
    if prepared.machine.constraints:
        text = "terms are not learned with constraints: the weak form holds their reactions"
        raise InputError(Problem(f"{text}; --by network does it", "constraints", model.file))
    if not prepared.machine.free:
        raise InputError(Problem("no coordinate is free, so that nothing can be learned"))

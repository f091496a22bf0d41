"""Learn what a model lacks, by sparse regression or by a network, at the level of forces or rates.

    force    M v' + k_c = k_e + ΔF        ΔF acts: a host adds it
    rates    x' = f(t, x, u) + Δx'        the older, continuous formulation

:func:`learn` goes one stated way from recordings to a corrected model, where
:func:`symhyb.diagnose` weighs all explanations against each other. The building blocks for scripts
that want their own way are offered here by the same names: what is lacking along a measured motion,
laws of it, and simulation with them. docs/learn.md has both.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from symhyb.asked import asked
from symhyb.correction.learning.corrected import (
    Correction,
    Formulation,
    Law,
    Networks,
    Terms,
    simulate_corrected,
)
from symhyb.correction.learning.formulations import (
    lacking,
    measured_course,
    network_law,
    sparse_law,
    values_along,
)
from symhyb.correction.learning.free_running import judge_rates
from symhyb.correction.learning.library import DEGREE, LibraryName, described
from symhyb.correction.learning.matched import Worth
from symhyb.correction.learning.network import MEMBERS, WIDTH, lowered
from symhyb.correction.learning.networks import (
    Asked,
    One,
    asked_coordinates,
    learn_networks,
    network_element,
)
from symhyb.correction.learning.proposing import Sparse
from symhyb.correction.learning.sparse import OptimizerName
from symhyb.correction.learning.terms import learn_terms
from symhyb.correction.learning.written import Chosen, Written, term_unit
from symhyb.correction.search.preparing import prepare
from symhyb.data.cleaning import cleaned, still
from symhyb.data.recording import Recording, several
from symhyb.discrepancy.checks.suspicion import repaired
from symhyb.discrepancy.fitting.judge import judge
from symhyb.discrepancy.recorded.course import Course, course_of
from symhyb.discrepancy.results import Estimate, Score, Verdict
from symhyb.discrepancy.words.wording import effect_phrase, joined, number_text, quantity_text
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.closed import require_open
from symhyb.model.types import Element, Model
from symhyb.model.write import append_elements
from symhyb.numeric.lowered.either import model_of
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.network import Weights
from symhyb.steps import Say, silent

__all__ = [
    "Chosen",
    "Correction",
    "Course",
    "Formulation",
    "Law",
    "Learned",
    "LearnedTerm",
    "Networks",
    "One",
    "Terms",
    "Weights",
    "Worth",
    "course_of",
    "lacking",
    "learn",
    "lowered",
    "measured_course",
    "network_element",
    "network_law",
    "simulate_corrected",
    "sparse_law",
    "values_along",
]

By = Literal["sparse", "network"]
FORMULATIONS: tuple[str, ...] = get_args(Formulation)
STILL = "no sensor changes in any of these recordings, so that nothing can be learned from them"
NOTHING = "Nothing was learned: {what} simulates held windows better than the model as it is."


@dataclass(frozen=True, slots=True)
class LearnedTerm:
    """A term of ΔF or Δx' on one coordinate: the expression ``term`` with its coefficient ``value``
    and ``sd`` (None: not known) in ``unit``, signed as ΔF acts, the value that the optimiser
    ``regressed``, both as a ``formula``, in ``words``, and the ``element`` (empty: in no file)."""

    coordinate: str
    term: str
    words: str
    formula: str
    value: float
    sd: float | None
    regressed: float
    unit: str
    element: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Learned:
    """What was learned for ``model``: the ``corrected`` one (the same where nothing was learned,
    None where it cannot be written as a model file; then ``correction`` simulates it), its
    ``terms`` or ``networks``, the ``verdict`` on training and unseen recordings, and what held
    windows of the training say of it (``worth``). ``settings`` are those that were used."""

    by: By
    formulation: Formulation
    model: Model
    corrected: Model | None
    terms: tuple[LearnedTerm, ...]
    networks: tuple[One, ...]
    worth: Worth | None
    verdict: Verdict
    sentence: str
    settings: tuple[tuple[str, object], ...]
    notes: tuple[str, ...] = ()
    correction: Correction | None = None

    @property
    def something(self) -> bool:
        """Whether anything was learned."""
        return bool(self.terms or self.networks)

    def __str__(self) -> str:
        return "\n".join((self.sentence, *self.notes, self.verdict.carries))


@asked
def learn(
    model: Model | Machine,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording] = (),
    *,
    by: By = "sparse",
    formulation: Formulation = "force",
    on: Sequence[str] = (),
    library: LibraryName = "laws",
    degree: int = DEGREE,
    optimizer: OptimizerName = "stlsq",
    inputs: Sequence[str] = (),
    width: int = WIDTH,
    members: int = MEMBERS,
    seed: int = 0,
    say: Say | None = None,
) -> Learned:
    """Learn ΔF or Δx' from recordings, and judge the corrected model.

    ``by`` "sparse": PySINDy's ``optimizer`` ("stlsq", "sr3", "ssr") on a ``library`` ("laws",
    "polynomial") up to a ``degree``; "network": networks with a trust region that see ``inputs``
    (default: position and speed where they act), ``members`` of ``width`` hidden units, begun from
    ``seed``. ``on`` are coordinates (default: all that are free). The parameters of the model are
    held. Windows of the training recordings that nothing is fitted to decide whether anything was
    learned; ``holdout`` only proves. ``say`` gets a short line at every step.

    Raises:
        InputError: an unknown way, name or coordinate, recordings that cannot be used, or an FMU.
        NumericsError: the model cannot be simulated along the recordings.
    """
    _require_ways(by, formulation)
    model = model_of(model)
    require_open(model)
    tell = say or silent
    train, unseen = several(recordings), several(holdout)
    coordinates = asked_coordinates(model, on)
    if still(train):
        raise InputError(Problem(STILL))
    tell("estimating motion and noise")
    prepared = prepare(model, train)
    if by == "sparse":
        asked = Sparse(library, degree, optimizer)
        terms = learn_terms(model, prepared, formulation, asked, coordinates, tell)
        found = _of_terms(model, terms.chosen, terms.written, formulation)
        correction = terms.correction
        settings: tuple[tuple[str, object], ...] = (
            ("on", list(coordinates)),
            ("library", library),
            ("degree", degree),
            ("optimizer", optimizer),
            ("candidates", described(library, degree)),
        )
        elements = terms.written.elements if terms.written else ()
        networks: tuple[One, ...] = ()
        held, notes = terms.worth, terms.notes
    else:
        wanted = Asked(coordinates, tuple(inputs), width, members, seed)
        learnt = learn_networks(model, prepared, train, formulation, wanted, tell)
        found, networks, held, notes = (), learnt.networks, learnt.worth, learnt.notes
        correction = learnt.correction
        elements = tuple(one.element for one in networks if one.element)
        settings = (
            ("on", list(coordinates)),
            ("inputs", list(inputs)),
            ("width", width),
            ("members", members),
            ("seed", seed),
        )
    tell("judging the correction")
    clean = [repaired(cleaned(group, model), prepared.faults) for group in (unseen, train)]
    if correction is not None:
        corrected = None
        verdict = judge_rates(model, correction, *clean)
    else:
        corrected = append_elements(model, elements) if elements else model
        verdict = judge(model, corrected, clean[0], train=clean[1])
        corrected = _with_source(model, elements, by, train, verdict)
    sentence = _sentence(by, formulation, found, networks, held)
    faults = tuple(fault.sentence for fault in prepared.faults if fault.sentence)
    return Learned(
        by,
        formulation,
        model,
        corrected,
        found,
        networks,
        held,
        verdict,
        sentence,
        settings,
        (*notes, *faults),
        correction,
    )


def _require_ways(by: str, formulation: str) -> None:
    problems = []
    for said, word, known in (("by", by, get_args(By)), ("formulation", formulation, FORMULATIONS)):
        if word not in known:
            near = did_you_mean(word, known)
            problems.append(Problem(f"'{word}' is none of {', '.join(known)}{near}", said))
    if problems:
        raise InputError(problems)


def _of_terms(
    model: Model, chosen: Sequence[Chosen], written: Written | None, formulation: Formulation
) -> tuple[LearnedTerm, ...]:
    """The terms in words and in the units of the model file."""
    found = []
    for i, one in enumerate(chosen):
        unit = term_unit(model, one.on, one.term.text, formulation)
        value, regressed = one.value / unit.factor, one.regressed / unit.factor
        sd = None if one.sd is None else one.sd / unit.factor
        letter = f"ΔF_{one.on}" if formulation == "force" else f"Δ{one.on}''"
        number = number_text(value, digits=6)
        formula = f"{letter} = {number}" + ("" if one.term.text == "1" else f"*{one.term.text}")
        element = written.paths[i][0] if written else ""
        found.append(
            LearnedTerm(
                one.on,
                one.term.text,
                _words(one, value, sd, unit.text, formulation),
                formula,
                value,
                sd,
                regressed,
                unit.text,
                element,
            )
        )
    return tuple(found)


def _words(one: Chosen, value: float, sd: float | None, unit: str, formulation: Formulation) -> str:
    """A term for people: the name of its law with its number, or what it is a function of."""
    spread = float("nan") if sd is None else sd
    if formulation == "force" and one.listed:
        number = Estimate(one.term.key, one.sign * value, spread, unit, one.term.key)
        return f"on {one.on}, {effect_phrase(one.term.kind, [number])}"
    noun = "force" if formulation == "force" else "acceleration"
    shown = "" if one.term.text == "1" else f" times {one.term.text}"
    return f"on {one.on}, {_article(noun)} of {quantity_text(value, unit, sd)}{shown}"


def _article(noun: str) -> str:
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


def _sentence(
    by: By,
    formulation: Formulation,
    terms: Sequence[LearnedTerm],
    networks: Sequence[One],
    held: Worth | None,
) -> str:
    """What was learned and what held windows say of it."""
    if not terms and not networks:
        return NOTHING.format(what="no set of terms" if by == "sparse" else "no network")
    what = "a force ΔF" if formulation == "force" else "a correction of rates Δx'"
    said = joined([one.words for one in terms]) if terms else ""
    if networks:
        units = networks[0].weights.layers[0].bias.size
        said = f"a network of {units} hidden units on {joined([one.on for one in networks])}"
    opening = f"Learned as {what}: {said}."
    if held is None:
        return f"{opening} Held windows are significantly closer to its rates."
    return (
        f"{opening} Held windows are simulated with a χ² per sample of {held.learned:.4g} instead "
        f"of {held.nothing:.4g}."
    )


def _with_source(
    model: Model,
    elements: Sequence[Element],
    by: By,
    train: Sequence[Recording],
    verdict: Verdict,
) -> Model:
    """The model with elements that say where they come from, and how much better it got."""
    if not elements:
        return model
    scores = verdict.holdout or verdict.train
    errors = _worst(scores.before), _worst(scores.after)
    found: tuple[tuple[str, object], ...] = (
        ("by", by),
        ("from", ", ".join(one.name for one in train)),
    )
    if np.isfinite(errors).all():
        found = (*found, ("nrmse", tuple(float(f"{error:.4g}") for error in errors)))
    return append_elements(model, [replace(element, found=found) for element in elements])


def _worst(score: Score) -> float:
    return max((x for x in score.window_nrmse.values() if x is not None), default=float("nan"))

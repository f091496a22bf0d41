"""Whether a decided structure is adequate: what acts beyond its causes, and which class it is of.

The structure is fitted once more by the innovations likelihood, which separates missing forces from
the noise of sensors, whatever its colour. Where a force acts that no cause explains, generic
classes (:mod:`~.classes`) are fitted beside the structure, in place of the causes at their place
and of all; where the structure has causes also around the model as it is. A class is an answer
where it is more probable and takes at least half of what acts beyond; a cause is withdrawn beside
it where a class that explains that does without.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.adequacy.agreement import Disputed, disputed, may_hold
from symhyb.correction.adequacy.beyond import NOTHING, Beyond, beyond
from symhyb.correction.adequacy.channel_noise import faulty_sensors, noisy_inputs
from symhyb.correction.adequacy.classes.catalogue import classes_of
from symhyb.correction.adequacy.classes.held_input import LONGEST, held_input
from symhyb.correction.adequacy.classes.worth import around, worth_of
from symhyb.correction.adequacy.clock_jitter import Jitter, jittering
from symhyb.correction.adequacy.contradicted import contradicted
from symhyb.correction.adequacy.explained import Decided, forces_left, may_take
from symhyb.correction.adequacy.explained import decided as left_by
from symhyb.correction.adequacy.followed import Along, fitted_on, followed, likeliest, scored
from symhyb.correction.adequacy.late import with_lags
from symhyb.correction.adequacy.own_strengths import by_recording, without_own
from symhyb.correction.adequacy.predictable import likeliest_with, with_whiteness
from symhyb.correction.adequacy.ranking import is_lag, ranked, weights
from symhyb.correction.adequacy.recorded import Recorded, recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, Likely, Row, fitted
from symhyb.correction.adequacy.sums import functions_instead
from symhyb.correction.adequacy.unnamed import (
    changing_themselves,
    parts_of_bent,
    parts_of_class,
    parts_of_unnamed,
)
from symhyb.correction.adequacy.ways import on_ways
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.selection import many
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.strength import changed_force, element_forces
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.results import ClassName
from symhyb.judgement import (
    CERTAIN,
    HOPELESS,
    LARGE,
    LIKELY,
    MOST,
    NEGLIGIBLE,
    OUTSTANDING,
    PROBABLE,
    SMALL,
)
from symhyb.model.delays import delayed_by
from symhyb.model.types import Place
from symhyb.numeric.kernels.buffers import Array

CLASSES_MOST = 3  # that are fitted, the best of the linear problem
HARMONICS = 5  # of the motion, below which dry friction, a square wave, has 93 % of its power
TOO_SHORT = "no part of the recordings without a gap is long enough"


@dataclass(frozen=True, slots=True, eq=False)
class Adequacy:
    """What acts ``beyond`` a structure, the generic ``classes`` that it may be with their posterior
    probabilities, the causes that are in ``doubt`` beside them, and those of them that are
    ``disputed``; the ``jitter`` of clocks; ``unjudged`` is empty, or why nothing of this is
    known; the ``structure`` as the innovations fitted it, and as it is ``by_class``: with the
    likeliest class, and the causes that are kept beside that."""

    beyond: Beyond
    classes: tuple[Likely, ...] = ()
    doubt: frozenset[Hypothesis] = frozenset()
    disputed: tuple[Disputed, ...] = ()
    unjudged: str = ""
    jitter: tuple[Jitter, ...] = ()
    structure: Fitted | None = None
    by_class: Fitted | None = None

    @property
    def adequate(self) -> bool:
        """Whether nothing acts that no cause explains, as far as is known."""
        return not (self.unjudged or self.beyond.acts or self.class_probability > LIKELY)

    @property
    def class_probability(self) -> float:
        """The posterior probability that one of the classes acts."""
        return sum(one.probability for one in self.classes)

    def certain(self, kind: ClassName) -> Place | None:
        """The place at which a class explains all that acts, for certain; None where that is not
        the answer."""
        best = self.classes[0] if self.classes else None
        if best is None or best.generic.kind != kind or isinstance(best.generic.where, str):
            return None
        return best.generic.where if best.whole and best.probability > PROBABLE else None


def adequacy(
    prepared: Prepared,
    setting: Setting,
    final: Refined,
    windows: Along,
    along: Fitted | None = None,
) -> Adequacy:
    """Judge a decided structure by the recordings that it was decided on, as it was fitted
    ``along`` them; if that is not known, beginning with the ``windows`` that it was fitted on."""
    ground = recorded(prepared, setting)
    if ground is None:
        return Adequacy(NOTHING, unjudged=TOO_SHORT)
    rows = grouped(final)
    base = along or followed(ground, final, windows)
    if base.fit.reason:
        return Adequacy(NOTHING, unjudged=base.fit.reason)
    left = here = beyond(ground, base)
    if left.alone is not None and left.evidence < 0:
        base = scored(ground, fitted(ground, final.causes, rows, left.alone, base.fit.states))
    decided = left_by(ground, base, left.acts)
    trials = [base, *_answers(ground, _staircases(ground, base, rows), decided)]
    raced: list[Fitted] = []
    if left.acts or base.fit.noise.coloured:
        raced = _raced(ground, base, rows, decided)
        smooth = [trial for trial in raced if _is_curve(trial.extra, base.causes)]
        raced = [trial for trial in raced if trial not in smooth]
        trials += _answers(ground, [*raced, *(_as_curve(one, base) for one in smooth)], decided)
        left = _shown_by(ground, raced, left, max(trial.evidence for trial in trials))
    if not left.acts:
        trials += _answers(ground, functions_instead(ground, base), decided)
    disputes: tuple[Disputed, ...] = ()
    if left.acts:
        likelier = [trial for trial in raced if trial.evidence > base.evidence + CERTAIN]
        better = [trial for trial in likelier if not contradicted(ground, trial, base)]
        asked = [one for one in better if not may_hold(one) or _answers(ground, [one], decided)]
        disputes = disputed(final, [base, *asked])
    doubt = frozenset(one.cause for one in disputes)
    stay = [i for i, cause in enumerate(base.causes) if by_recording(cause)]
    few = not many(base.causes)  # no class at one place stands for more
    if few and left.acts:
        trials += without_own(ground, base, rows)
    if few and len(stay) < len(base.causes) and not _explained_alone(ground, trials, decided):
        own = [rows[i] for i in stay]  # all other laws may only imitate a class
        bare = likeliest(ground, [base.causes[i] for i in stay], own)
        trials += [bare, *_answers(ground, _raced(ground, bare, own, decided), decided)]
    enough = [t for t in trials if t.extra and decided.explained_by(ground, t, SMALL)]
    classes = ranked(trials, {trial.extra.key for trial in enough if trial.extra})
    doubt |= _doubted(trials, enough, classes)
    drawn = any(cause.points for cause in base.causes)  # as exactly as few points can
    unasked = classes or drawn or left is not here
    noisy = () if unasked else noisy_inputs(ground, base, left)
    doubt |= _small(final, ground, left, noise=bool(noisy) and not few)
    if not classes:
        faults = (*faulty_sensors(ground, base), *noisy)
        jitter = () if left.acts or faults else jittering(ground, base)
        return Adequacy(left, faults, doubt, disputes, jitter=jitter, structure=base)
    found = on_ways(ground, with_whiteness(ground, classes, trials))
    by_class = likeliest_with(classes[0].generic, trials)
    return Adequacy(left, found, doubt, disputes, structure=base, by_class=by_class)


def _shown_by(ground: Recorded, raced: Sequence[Fitted], left: Beyond, reached: float) -> Beyond:
    """What acts beyond a structure. Sensors alone, in colour, may be likelier than an unknown force
    beside it and still be wrong: a structure with a class and an unknown force that is no answer,
    but likelier by 100 to 1 than all that explains (``reached``), shows that a force acts."""
    forced = [one for one in raced if forces_left(ground, one) > NEGLIGIBLE**2]
    best = max(forced, key=lambda one: one.evidence, default=None)
    if left.acts or best is None or best.evidence <= reached + CERTAIN:
        return left
    size = left if np.any(left.share > NEGLIGIBLE) else beyond(ground, best)
    return replace(size, evidence=best.evidence - reached)


def _small(
    final: Refined, ground: Recorded, left: Beyond, noise: bool = False
) -> frozenset[Hypothesis]:
    """The laws, and changes of parameters, whose force, at every coordinate, is small against what
    acts beyond (they may be a part of it); and the laws whose force is negligible against what
    moves the coordinate (the numerics err by as much). All causes where what acts beyond is a large
    part of what moves a coordinate. Of what is ``noise`` of inputs the part counts that lies where
    the machine moves, against the largest force too: what friction takes moves no inertia."""
    squares, counts = 0.0, 0
    for item in ground.items:
        forces = element_forces(final, *item.source)[0][item.rows[0]]
        squares = squares + np.sum(forces**2, axis=0)
        counts += len(forces)
    sizes = np.sqrt(squares / counts)  # (n, E), those of the causes last
    laws = [cause for cause in final.causes if cause.place is not None]
    own = sizes[:, sizes.shape[1] - len(laws) :]
    scale = ground.scale
    if noise:
        scale = np.maximum(scale, sizes.max(axis=1, initial=0.0))
        left = left.below(HARMONICS / ground.period_s, ground.step_s)
    least = NEGLIGIBLE * scale
    if left.acts:
        if np.any((left.force > LARGE * scale) & (scale > 0)):
            return frozenset(final.causes)
        least = np.maximum(least, LARGE * left.force)
    large = np.any((own > least[:, None]) & (own > 0), axis=0)
    small = {cause for cause, stands in zip(laws, large, strict=True) if not stands}
    if left.acts:
        small |= _small_changes(final, ground, LARGE * left.force)
    return frozenset(small)


def _small_changes(final: Refined, ground: Recorded, least: Array) -> set[Hypothesis]:
    """The parameters whose change exerts a force, but no more than ``least`` (n,) anywhere."""
    small: set[Hypothesis] = set()
    for cause in final.causes:
        if cause.place is not None:
            continue
        rows = [
            changed_force(final, cause.path, *item.source)[item.rows[0]] for item in ground.items
        ]
        size = np.sqrt(np.mean(np.concatenate(rows) ** 2, axis=0))
        if size.any() and np.all(size <= least):
            small.add(cause)
    return small


def _staircases(ground: Recorded, base: Fitted, rows: Sequence[Row]) -> list[Fitted]:
    """The structure with staircases in place of delays of inputs that are as long as one: an input
    that is held for a while arrives half of that late on average."""
    model = ground.windows.machine.model
    inputs = [item.name for item in model.recorded_inputs]
    longest = 0.5 * (LONGEST + 1) * ground.step_s
    late, held = [], set[int]()
    for i, cause in enumerate(base.causes):
        if cause.kind == "delay" and 0 < base.p[base.machine.column(cause.path)] < longest:
            which = {inputs.index(x) for x in delayed_by(model, cause.path) if x in inputs}
            late += [i] if which else []
            held |= which
    if not late:
        return []
    kept = [i for i in range(len(base.causes)) if i not in late]
    begin = [rows[i] for i in kept]
    start = likeliest(ground, [base.causes[i] for i in kept], begin)
    staircase = held_input(around(ground, start), sorted(held))
    return [_beside(ground, start, begin, staircase, range(len(kept)))]


def _raced(ground: Recorded, start: Fitted, rows: Sequence[Row], decided: Decided) -> list[Fitted]:
    """A structure with each of the best generic classes beside it, in place of the causes at its
    place and of all; with the best of these in place of each cause too. Those that may be better
    than what was ``decided``. Where a lag is what the linear problem favours most, what lags is
    fitted as it is, too, whatever that predicts."""
    classes, offered, curves = classes_of(ground), [], decided.structure.causes
    here, first = around(ground, start), (-np.inf, False)
    for one in classes:
        if not may_take(ground, start, one.pushes):
            continue
        generic = one.make(here)
        if _is_curve(generic, curves) and not _is_curve(generic, start.causes):
            continue
        gain = worth_of(here, generic) - np.log(len(classes) * generic.tried)
        first = max(first, (float(gain), is_lag(generic)))
        if start.evidence + gain > decided.structure.evidence - CERTAIN:
            offered.append((gain, generic))
    offered.sort(key=lambda pair: -pair[0])

    def tried(generic: Generic, kept: Sequence[int]) -> Fitted:
        return _beside(ground, start, rows, generic, kept)

    every = tuple(range(len(start.causes)))
    lags = with_lags(ground, here, start, curves) if first[1] else []
    found: list[Fitted] = []
    for gain, generic in offered[:CLASSES_MOST]:  # a promise that was not kept rules nothing out
        reached = max((trial.evidence for trial in found), default=-np.inf)
        if start.evidence + gain > reached - HOPELESS:
            found += [tried(generic, kept) for kept in _kept(start.causes, generic)]
    answers = _answers(ground, found, decided)
    best = max(answers, key=lambda trial: trial.evidence, default=None)
    found += lags
    if best is not None and _is_curve(best.extra, curves):
        return found
    if best is None or best.extra is None or len(every) < 2:
        return found
    enough = [trial for trial in answers if decided.explained_by(ground, trial, SMALL)]
    if _alone(enough, best.extra, best.evidence):
        return found
    return [*found, *(tried(best.extra, tuple(j for j in every if j != i)) for i in every)]


def _is_curve(generic: Generic | None, causes: Sequence[Hypothesis]) -> bool:
    """Whether a class is a force that a curve among the causes is: no rival of that."""
    if generic is None or generic.kind != "law":
        return False
    return any(cause.points and cause.place == generic.where for cause in causes)


def _as_curve(trial: Fitted, base: Fitted) -> Fitted:
    """A structure in which a class is a force that a curve of the ``base`` is, as one that has the
    curve: the same force, smoothly drawn. What few points cannot follow is no other cause."""
    assert trial.extra is not None
    curves = [one for one in base.causes if one.points and one.place == trial.extra.where]
    causes = tuple(dict.fromkeys((*trial.causes, *curves)))
    return replace(trial, causes=causes, extra=None)


def _beside(
    ground: Recorded, start: Fitted, rows: Sequence[Row], generic: Generic, kept: Sequence[int]
) -> Fitted:
    """A class fitted beside the ``kept`` causes of a structure, from where that ended."""
    causes, begin = [start.causes[i] for i in kept], [rows[i] for i in kept]
    return fitted_on(ground, start, causes, begin, generic)


def _answers(ground: Recorded, trials: Sequence[Fitted], decided: Decided) -> list[Fitted]:
    """The structures that take half of what acts beyond the decided one, and that no part of the
    recordings contradicts."""
    taken = [one for one in trials if decided.explained_by(ground, one, MOST)]
    return [one for one in taken if not contradicted(ground, one, decided.structure)]


def _kept(causes: Sequence[Hypothesis], generic: Generic) -> list[tuple[int, ...]]:
    """Which of the causes are kept beside a class: all, those elsewhere, none."""
    every = tuple(range(len(causes)))
    if _is_curve(generic, causes):
        others = tuple(i for i in every if not _is_curve(generic, causes[i : i + 1]))
        return [every, others]
    stay = tuple(i for i in every if by_recording(causes[i]))
    elsewhere = tuple(i for i in every if i in stay or causes[i].place not in (None, generic.where))
    return list(dict.fromkeys([every, elsewhere, stay]))


def _doubted(
    trials: Sequence[Fitted],
    enough: Sequence[Fitted],
    classes: Sequence[Likely],
) -> frozenset[Hypothesis]:
    """The causes of the structure, the first of the trials, that are not needed. A law is not where
    the likeliest class explains what acts (is ``enough``) without the laws at its place, nor where
    structures without it, beside a class that explains or an unknown force, have a part of the
    probability; a parameter that states an sd is free in all of them, named or not. Nor is what may
    be a part of a force without a name, nor a number that a class says to change."""
    doubt: set[Hypothesis] = set()
    spare: list[Fitted] = []
    if classes and classes[0].probability > LIKELY:
        spare = _alone(enough, classes[0].generic, max(trial.evidence for trial in trials))
    plain = [trial for trial in trials if trial.extra is None]
    for cause in trials[0].causes:
        having = [trial for trial in trials if cause in trial.causes]
        lacking = [trial for trial in enough if not _stands_in(cause, trial, trials[0])]
        lacking += [trial for trial in plain if cause not in trial.all_causes]
        chance = float(weights([*having, *lacking])[: len(having)].sum())
        if any(cause not in trial.causes for trial in spare) or chance < PROBABLE:
            doubt.add(cause)
    certain = any(one.probability > PROBABLE and one.whole for one in classes)
    changing = changing_themselves(trials[0].causes, [one.generic for one in classes])
    model, causes = trials[0].machine.model, trials[0].causes
    parts = parts_of_bent(model, causes) | parts_of_class(model, causes, classes)
    return frozenset(doubt | changing | parts | parts_of_unnamed(trials[0].causes, certain))


def _stands_in(cause: Hypothesis, trial: Fitted, base: Fitted) -> bool:
    """Whether a structure has a cause of the base: also a number that is free in it, named or not,
    and has there the value that it has in the base, within three deviations."""
    if cause in trial.causes or cause not in trial.all_causes or trial.owned or base.owned:
        return cause in trial.causes
    (value, sd), (other, spread) = (_number(one, cause.path) for one in (base, trial))
    return abs(value - other) <= OUTSTANDING * float(np.hypot(sd, spread))


def _number(trial: Fitted, path: str) -> tuple[float, float]:
    """The value of a number of the model or of a channel, SI, and its deviation."""
    i = trial.paths.index(path)
    return float(trial.fit.values[i]), float(np.sqrt(max(trial.fit.covariance[i, i], 0.0)))


def _alone(enough: Sequence[Fitted], generic: Generic, best: float) -> list[Fitted]:
    """The structures that explain by a class without the laws at its place, almost as well as the
    best: the prior sizes of its columns are guesses, which may cost 1 each."""
    return [
        trial
        for trial in enough
        if trial.extra
        and trial.extra.key == generic.key
        and all(cause.place not in (None, generic.where) for cause in trial.causes)
        and best - trial.evidence < trial.extra.spread.size
    ]


def _explained_alone(ground: Recorded, trials: Sequence[Fitted], decided: Decided) -> bool:
    """Whether the likeliest structure has a class that explains alone, without any cause."""
    best = max(trials, key=lambda trial: trial.evidence)
    bare = [t for t in trials[1:] if not t.causes and decided.explained_by(ground, t, SMALL)]
    return best.extra is not None and bool(_alone(bare, best.extra, best.evidence))

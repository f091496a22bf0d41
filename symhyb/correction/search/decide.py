"""Which causes are selected: one list, one score, one search.

1. Linear screens at growing window lengths, and sparse regression on the weak form, name the
   structures to begin with; where these do not explain it, those of every length with all
   parameters that state an sd.
2. Around the structure of the best score every exchange of causes is weighed on the Gram matrix
   along its simulation; the most promising, each cause left out, and what only a fitted law
   suggests (variants, further lines, products) are fitted at full nonlinearity.
3. That goes on until no structure that was fitted is better. Where it leaves more than is explained
   the search goes on by what may take most, and from what fits better though its causes do not pay
   for themselves yet: where three act, two may leave half of what one leaves, and three nothing.
"""

from collections.abc import Collection, Iterator, Sequence
from itertools import islice

from symhyb.correction.search.branches import branches_of
from symhyb.correction.search.conventions import (
    exchange,
    indistinguishable,
    precedence,
    with_twins,
)
from symhyb.correction.search.decision import CLOSE_MOST, Decision
from symhyb.correction.search.exchanges import distinct, exchanges
from symhyb.correction.search.first_structures import BEGUN, LARGEST, begun, begun_along
from symhyb.correction.search.force_screen import ForceScreen
from symhyb.correction.search.formulas import beside, candidates, instead
from symhyb.correction.search.lines import lines_of
from symhyb.correction.search.score import (
    believable,
    cost,
    left,
    piece_of,
    price,
    score,
    standing,
    weak_together,
)
from symhyb.correction.search.selection import Problem, Subset, best_subsets, many, without
from symhyb.correction.search.series import instead_of_series
from symhyb.correction.search.setting import Setting, along_motion
from symhyb.correction.search.so_far import fits_best, if_interrupted
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Row, Trials, first_guess
from symhyb.correction.search.twins import exact_twins
from symhyb.correction.search.variants import variants_of
from symhyb.correction.search.wholes import whole_of
from symhyb.deadline import OutOfTimeError, within
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import NEAR_NOISE, SIGNIFICANT, UNEXPLAINED
from symhyb.numeric.kernels.buffers import Array
from symhyb.steps import Say

ROUNDS = 12
OTHERS = "other causes, of which the search had not ended"


def decide(setting: Setting, forces: ForceScreen | None, say: Say) -> Decision:
    """Choose a structure; ``forces`` is the screen of the same force hypotheses at their level."""
    pool: set[tuple[int, ...]] = set()
    if forces is not None:
        problem = without(forces.problem(forces.begin()), set(setting.bent))
        pool |= _first_of(problem, best_subsets(problem, LARGEST))
    problems, twins = [], exact_twins(setting)
    for stage in setting.stages:
        say(f"screening {len(setting.hypotheses)} causes on windows of {stage.length_s:.3g} s")
        problem = along_motion(setting, stage)
        equals = with_twins(indistinguishable(problem), twins)
        problem = without(problem, {second for _, second in equals} | setting.bent)
        sizes = best_subsets(problem, LARGEST)
        pool |= _first_of(problem, sizes)
        problems.append((sizes[-1][0].chi2 / max(sizes[0][0].chi2, 1e-300), problem))
    # where the linear problem explains most, its promises are worth most
    problems.sort(key=lambda pair: pair[0])
    trials = Trials(setting, say, equals)
    with if_interrupted(lambda: _known(trials)):
        try:
            _begun_whole(trials, forces)
            return _decided(trials, [problem for _, problem in problems], pool)
        except OutOfTimeError:
            if not trials.done:
                raise
            return _so_far(trials)


def _so_far(trials: Trials) -> Decision:
    """The decision among what was fitted by the time that was allowed, and the model as it is."""
    with within(None):
        nothing = trials.refined(())
    best, done = _best(trials), tuple(trials.done.values())
    named = tuple((trials.known[a], trials.known[b]) for a, b in trials.equals)
    log = (f"{best.name}: best when the time was spent, of {len(done)} structures",)
    return Decision(best, nothing, done, named, log, trials.count, best, unmade=(OTHERS,))


def _first_of(problem: Problem, sizes: Sequence[Sequence[Subset]]) -> set[tuple[int, ...]]:
    """The first few subsets of each size that differ in more than the shapes of their laws."""
    return {s.causes for sized in sizes[1:] for s in distinct(problem, sized)[:BEGUN]}


def _begun_whole(trials: Trials, forces: ForceScreen | None) -> None:
    """Fit all that forces show at once, where a machine has more coordinates than a few causes
    explain: an arm whose every joint lacks friction does not follow with one of them."""
    whole = whole_of(trials.setting, forces, trials.doubles)
    if whole is not None:
        _tried(trials, whole.subset.causes, whole.rows)


def decide_among(setting: Setting, decision: Decision, say: Say) -> Decision:
    """A decision once more where the noise is another one: among the structures that were close,
    and these without causes. Nothing else is tried."""
    order = setting.hypotheses.index
    equals = [(order(first), order(second)) for first, second in decision.equals]
    trials = Trials(setting, say, equals)
    nothing = trials.refined(())
    near = [trial for trial in decision.near(SIGNIFICANT) if trial.causes]
    for trial in (decision.selected, *near[: CLOSE_MOST - 1]):
        _tried(trials, trials.causes(trial), grouped(trial), trial.fit.starts)
    return _parted(trials, nothing, decision)


def decide_with(
    setting: Setting,
    decision: Decision,
    causes: Sequence[Hypothesis],
    rows: Sequence[Row],
    say: Say,
) -> Decision:
    """A decision among what was close and one structure more, of these ``causes`` from values
    ``rows``, SI, and its parts."""
    order = setting.hypotheses.index
    equals = [(order(first), order(second)) for first, second in decision.equals]
    trials = Trials(setting, say, equals)
    nothing = trials.refined(())
    for trial in (decision.selected, *decision.near(SIGNIFICANT)[: CLOSE_MOST - 1]):
        trials.done[tuple(sorted(trials.causes(trial)))] = trial
    _tried(trials, [trials.index(cause) for cause in causes], rows)
    return _parted(trials, nothing, decision)


def _parted(trials: Trials, nothing: Refined, decision: Decision) -> Decision:
    """The decision that a search among parts of what was tried ends with."""
    best, log = _best(trials), []
    for _ in range(ROUNDS):
        _each_left_out(trials, best)
        better = _best(trials)
        log.append(_sentence(trials, better, best))
        if better is best:
            break
        best = better
    return Decision(
        best,
        nothing,
        tuple(trials.done.values()),
        decision.equals,
        (*decision.log, *log),
        trials.count,
        best,
    )


def _known(trials: Trials) -> str:
    return fits_best(_best(trials), len(trials.done)) if trials.done else ""


def _decided(trials: Trials, problems: Sequence[Problem], pool: set[tuple[int, ...]]) -> Decision:
    """The search: from the best ``pool`` of the linear problems, the first of which explains most,
    by one cause more, less or else."""
    setting, problem = trials.setting, problems[0]
    nothing = trials.refined(())
    best, log = _best(trials), []
    few = len(best.causes) <= LARGEST
    for subset in begun(trials, nothing, problem, pool) if few else ():
        if best.fit.scale > NEAR_NOISE or _cheaper(subset, best):
            _tried(trials, subset.causes, first_guess(problem, subset))
            best = _best(trials)
    for causes, rows in begun_along(trials, nothing, problems):
        if best.fit.scale <= UNEXPLAINED:
            break
        _tried(trials, causes, trials.carried(causes, rows))
        best = _best(trials)
    for _ in range(ROUNDS):
        _look_around(trials, best)
        better = _best(trials)
        few = not many(best.causes)  # no formula of one place stands for more
        if better is best and best.fit.scale > UNEXPLAINED:
            better = _further(trials, best)
        if better is best and best.fit.scale > NEAR_NOISE and few:
            _without_a_name(trials, best, nothing)
            better = _best(trials)
        if better is best and few:
            for shorter, values in instead_of_series(trials, best, problem):
                _tried(trials, shorter, values)
            for ladder, values in branches_of(trials, best):
                _tried(trials, ladder, values)
            better = _best(trials)
        log.append(_sentence(trials, better, best))
        if better is best:
            break
        best = better
    selected = _conventional(trials, best, problem)
    named = tuple((setting.hypotheses[a], setting.hypotheses[b]) for a, b in trials.equals)
    done = tuple(trials.done.values())
    return Decision(selected, nothing, done, named, tuple(log), trials.count, best)


def _cheaper(subset: Subset, best: Refined) -> bool:
    """Whether a subset has fewer causes or numbers than a structure, and more of neither."""
    theirs, mine = (len(best.causes), best.numbers), (len(subset.causes), subset.numbers)
    return mine != theirs and mine[0] <= theirs[0] and mine[1] <= theirs[1]


def _further(trials: Trials, best: Refined) -> Refined:
    """The best structure once exchanges were tried that pay only if they explain as much as the
    linear problem predicts, of the best one and of what fits significantly better, its price
    aside."""
    base = best
    for _ in range(ROUNDS):
        _exchanged(trials, base, as_predicted=True)
        better, closest = _best(trials), min(_admissible(trials), key=left, default=base)
        if better is not best:
            return better
        if not left(base) - left(closest) >= SIGNIFICANT * piece_of(closest):
            break
        base = closest
    return best


def _admissible(trials: Trials) -> list[Refined]:
    """The structures that may be claimed."""
    length_s = trials.setting.stages[-1].length_s
    return [
        trial
        for trial in trials.done.values()
        if not trial.fit.reason and (not trial.causes or believable(trial, length_s))
    ]


def _best(trials: Trials) -> Refined:
    """The structure of the best score among the admissible ones. What is left by the one
    that fits best, its numbers paid, is the unit in which all are compared."""
    done = _admissible(trials)
    if not done:
        return trials.refined(())
    unit = piece_of(min(done, key=lambda trial: left(trial) + piece_of(trial) * cost(trial)))
    return min(done, key=lambda trial: score(trial, unit, trials.count))


def _sentence(trials: Trials, better: Refined, before: Refined) -> str:
    if better is before:
        return f"{better.name}: nothing that was tried is better"
    unit = piece_of(better)
    gain = score(before, unit, trials.count) - score(better, unit, trials.count)
    return f"{better.name} instead of {before.name}: better by {gain:.3g}"


def _look_around(trials: Trials, base: Refined) -> None:
    """Fit what may be better than the best so far."""
    smaller = _each_left_out(trials, base)
    _exchanged(trials, base)
    if base.fit.scale < NEAR_NOISE or many(base.causes):
        return
    for causes, rows, starts in _suggested(trials, base, smaller):
        _tried(trials, causes, rows, starts)


def _exchanged(trials: Trials, base: Refined, as_predicted: bool = False) -> None:
    """Fit the most promising exchanges of a structure."""
    offers = exchanges(trials, base, as_predicted)
    if many(base.causes):  # the others are weighed again along what this one leaves
        offers = islice(offers, 1)
    for offer in offers:
        _tried(trials, offer.causes, offer.rows, base.fit.starts)


def _without_a_name(trials: Trials, best: Refined, nothing: Refined) -> None:
    """Fit formulas beside the best structure, or the variant of a law of it that says the same by
    name; and formulas in place of it."""
    book = candidates(trials.setting)
    for cause, row in beside(trials.setting, book, best):
        named = list(_varied(trials, best, best.causes, cause))
        for causes, rows, starts in named:
            _tried(trials, causes, rows, starts)
        if not named:
            causes = (*trials.causes(best), trials.index(cause))
            _tried(trials, causes, [*grouped(best), row], best.fit.starts)
    for cause, row in instead(trials.setting, book, nothing):
        _tried(trials, (trials.index(cause),), [row])


def _tried(
    trials: Trials,
    causes: Sequence[int],
    rows: Sequence[Row],
    starts: Sequence[Array] | None = None,
) -> None:
    """Fit a structure, and without what does not stand out in it: of a variant of a law what was
    added to it, else the cause."""
    trial = trials.refined(causes, rows, starts)
    gone = set() if trial.fit.reason else set(weak_together(trial))
    plainer = {i: law for i in gone if (law := _plain_law(trials, trial.causes[i])) is not None}
    if gone and (plainer or len(gone) < len(trial.causes)):
        if not plainer:
            rest = _without(trials, trial, gone)
            if many(rest.causes):  # what stands for a cause that left may be weak now
                _tried(trials, trials.causes(rest), grouped(rest), rest.fit.starts)
            return
        own, values = trials.causes(trial), grouped(trial)
        for i, law in plainer.items():
            own = (*own[:i], trials.index(law), *own[i + 1 :])
            values[i] = {key: values[i].get(key, 0.0) for key in law.keys}
        _tried(trials, *_but(own, values, gone - plainer.keys()), trial.fit.starts)


def _each_left_out(trials: Trials, base: Refined) -> list[Refined | None]:
    """A structure without each of its causes; None where it has many, and its own deviation says
    that leaving this one out costs more than it saves."""
    dear = price(base, trials.count) / max(len(base.causes), 1) + SIGNIFICANT
    few = not many(base.causes)
    return [
        _without(trials, base, {i}) if few or standing(base, i) < dear else None
        for i in range(len(base.causes))
    ]


def _without(trials: Trials, trial: Refined, gone: Collection[int]) -> Refined:
    """A structure without some of its causes. Where it is known already, but fits worse than the
    deviations of these causes say, it ended in a minimum of its own and is fitted from here."""
    rest = _but(trials.causes(trial), grouped(trial), gone)
    known = trials.refined(*rest, trial.fit.starts)
    unit, grows = piece_of(trial), sum(standing(trial, i) for i in gone)
    paid = price(trial, trials.count) - price(known, trials.count)
    if grows > paid + SIGNIFICANT or left(known) <= left(trial) + unit * (grows + SIGNIFICANT):
        return known
    return trials.again(*rest, trial.fit.starts)


def _plain_law(trials: Trials, cause: Hypothesis) -> Hypothesis | None:
    """The plain law of which a cause is a variant, None if it is none."""
    plain = (h for h in trials.setting.hypotheses if not h.variant and cause.extends(h))
    return next(plain, None) if cause.variant else None


def _but(
    own: Sequence[int], rows: Sequence[Row], gone: Collection[int]
) -> tuple[list[int], list[Row]]:
    """Causes and their values without some."""
    kept = [i for i in range(len(own)) if i not in gone]
    return [own[i] for i in kept], [rows[i] for i in kept]


def _suggested(
    trials: Trials, base: Refined, smaller: Sequence[Refined | None]
) -> Iterator[tuple[Sequence[int], Sequence[Row], Sequence[Array] | None]]:
    """What a fitted structure that leaves more than noise suggests: variants of its laws, also in
    place of two laws at a place (it is given without each of its causes: ``smaller``), further
    lines beside a line."""
    yield from _varied(trials, base, base.causes)
    for gone, trial in zip(base.causes, smaller, strict=True):
        if trial is not None and not trial.fit.reason and gone.place is not None:
            yield from _varied(trials, trial, [c for c in trial.causes if c.place == gone.place])
    own, rows = trials.causes(base), grouped(base)
    for lines, more in lines_of(trials.setting, base):
        yield (*own, *map(trials.index, lines)), [*rows, *more], base.fit.starts


def _varied(
    trials: Trials,
    base: Refined,
    which: Sequence[Hypothesis],
    product: Hypothesis | None = None,
) -> Iterator[tuple[Sequence[int], Sequence[Row], Sequence[Array] | None]]:
    """A structure with each of some causes replaced by a variant of its law; with a ``product``, by
    one that says it by name."""
    own, rows = trials.causes(base), grouped(base)
    for i, cause in enumerate(base.causes):
        if cause in which:
            for other, row in variants_of(trials.setting, cause, rows[i], product):
                causes = [*own[:i], trials.index(other), *own[i + 1 :]]
                yield causes, [*rows[:i], row, *rows[i + 1 :]], base.fit.starts


def _conventional(trials: Trials, best: Refined, problem: Problem) -> Refined:
    """Where convention names one of two causes that windows hardly distinguish, the one it names: a
    delay moves what the windows hold."""
    unit = piece_of(best)
    for trial in trials.done.values():
        change = exchange(trial.causes, best.causes)
        if change.pair is None or not change.conventional:
            continue
        first, second = (
            precedence(problem.hypotheses.index(cause), cause) for cause in change.pair
        )
        behind = score(trial, unit, trials.count) - score(best, unit, trials.count)
        if first < second and abs(behind) < SIGNIFICANT:
            return trial
    return best

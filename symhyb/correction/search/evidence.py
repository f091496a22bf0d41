"""When a larger structure is believed: significance for coloured residuals, and practical size."""

from collections.abc import Mapping, Sequence
from math import inf

import numpy as np
from scipy.special import ndtr, ndtri

from symhyb.correction.search.conventions import exchange
from symhyb.correction.search.trajectory import Refined, grouped, own_key
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.vocabulary import key_of
from symhyb.numeric.kernels.buffers import Array

SIGNIFICANT = 10.0  # Δχ²/c − k ln N on fitted windows, Δχ²/c on held ones (10: odds of 150 to 1)
HOPE = 0.5  # of the significance that it needs: the linear problem may promise too little
OUTSTANDING = 3.0  # standard deviations, of the strength of a cause
NEAR_NOISE = 1.1  # χ² per sample: nothing larger to climb to
PART_LEFT = 1 / 2  # of the mismatch that is left, which a cause must take
NOISE_SHARE = 0.02  # of the noise: less than this is never said to be left


def earns(larger: Refined, smaller: Refined, tried: int = 1) -> tuple[bool, str]:
    """Whether the larger structure earns its extra numbers, with the sentence that says why.

    It was chosen among ``tried`` causes, which costs 2 ln(tried) for each that is more (extended
    Bayesian information criterion: Chen & Chen, Biometrika 95, 2008).
    """
    unit, size = unit_of(larger), _fitted(larger)
    more = max(len(larger.causes) - len(smaller.causes), 0)
    fitted = (smaller.fit.train - larger.fit.train) / unit - price(larger, 0, more, tried)
    fitted -= cost(larger) - cost(smaller)
    fitted += smaller.fit.prior - larger.fit.prior
    held = (smaller.fit.validation - larger.fit.validation) / unit
    validation = bool(larger.fit.held.any())
    other = _another_law(larger, smaller)
    least = 0.0 if other else SIGNIFICANT
    part = part_taken(larger, smaller, everywhere=other)
    steps = max(len(larger.causes) - len(smaller.causes), 1)
    needed = 1 - (1 - PART_LEFT) ** steps
    failed = [
        text
        for wrong, text in (
            (bool(larger.fit.reason), larger.fit.reason),
            (not fitted > SIGNIFICANT, f"not significant on fitted windows ({fitted:.3g})"),
            (validation and not held > least, f"not on held windows ({held:.3g})"),
            (not part > needed, f"takes {_percent(part)} of what is left"),
        )
        if wrong
    ]
    spare = (smaller.fit.train - larger.fit.train) / size
    if not spare > larger.fit.floor:
        failed.append("smaller than what repeated runs differ by")
    names, against = named(larger.causes), named(smaller.causes)
    judged = (
        "rejected: " + ", ".join(failed)
        if failed
        else (f"accepted: takes {_percent(part)} of what is left")
    )
    return not failed, f"{names}, against {against}: {judged}"


def price(trial: Refined, numbers: int, causes: int, tried: int) -> float:
    """What Δχ²/c must pay for more numbers and for causes chosen among ``tried``."""
    return float(numbers * np.log(_fitted(trial)) + 2 * causes * np.log(max(tried, 1)))


def cost(trial: Refined) -> float:
    """k ln N of a structure; a number that every recording has of its own is known from the samples
    of that recording alone, and costs their logarithm (Schwarz, Annals of Statistics 6, 1978: N
    counts what a number is known from)."""
    size, recordings = _fitted(trial), len(trial.owned)
    if not recordings:
        return float(trial.numbers * np.log(size))
    shared = len(set.intersection(*map(set, trial.owned)))
    own = trial.numbers - shared
    return float(shared * np.log(size) + own * np.log(max(size / recordings, 2.0)))


def _fitted(trial: Refined) -> float:
    """Samples of the fitted windows."""
    return max(float(trial.fit.count[~trial.fit.held].sum()), 2.0)


def believable(trial: Refined, length_s: float = inf) -> bool:
    """Whether physics allows the fitted values, each strength stands out of its own deviation, and
    the fit allows a variant of a law: one that differs by direction is claimed only where it
    explains the recordings down to their noise.

    A memory that outlasts windows of ``length_s`` (s) cannot be told from their initial states.
    """
    if weak(trial):
        return False
    for cause, values in zip(trial.causes, grouped(trial), strict=True):
        if cause.kind == "relaxation" and values["damping"] > length_s * values["stiffness"]:
            return False
        if "skew" in cause.terms and not trial.fit.scale < NEAR_NOISE:
            return False
        if cause.kind == "friction" and values.get("static", inf) < values["coulomb"]:
            return False
    return True


def weak(trial: Refined) -> tuple[int, ...]:
    """The causes, by their place in the structure, whose strength or added key does not stand out
    of its own deviation."""
    first, found = 0, []
    spread = np.sqrt(np.diag(trial.fit.covariance))
    for i, (cause, values) in enumerate(zip(trial.causes, grouped(trial), strict=True)):
        stands = _strong(trial, i, first, spread)
        if not (stands and _added_stands(cause, values, spread[first : first + cause.numbers])):
            found.append(i)
        first += cause.numbers
    return tuple(found)


def _strong(trial: Refined, which: int, first: int, spread: Array) -> bool:
    """Whether the strength of a cause, whose numbers begin at ``first``, stands out of its own
    deviation (``spread`` of all numbers, SI); where every recording has its own, that of any one,
    as far out as the largest of so many may be by chance: not every machine need show the cause."""
    cause, values = trial.causes[which], grouped(trial)[which]
    key, strength = next(iter(values.items()))
    if key in cause.own and trial.owned:
        least = -ndtri(ndtr(-OUTSTANDING) / len(trial.owned))
        return any(
            abs(values[own_key(key, recording)]) > least * spread[columns[first]]
            for (recording, _), columns in zip(trial.each, trial.owned, strict=True)
        )
    if "static" in cause.terms:
        strength = values["static"] - values["coulomb"]
    return bool(abs(strength) > OUTSTANDING * spread[first])


def _added_stands(cause: Hypothesis, values: Mapping[str, float], spread: Array) -> bool:
    """Whether every key that was added to a plain law stands out of its own deviation (``spread``
    (k,), SI, in the order of ``values``): an exponent from 1, breakaway from sliding friction, and
    what may have either sign by the sign that the plain law has not."""
    for key, sd in zip(list(values)[: cause.numbers], spread, strict=True):
        declared = key_of(cause.kind, key) if key in cause.added else None
        plain = declared.plain(values) if declared else None
        if declared is None or plain is None:
            continue
        beyond = -values[key] if declared.either_sign else values[key] - plain
        if not beyond > OUTSTANDING * sd:
            return False
    return True


def _another_law(larger: Refined, smaller: Refined) -> bool:
    """Whether one law stands in place of another kind, where hardly more than noise is left: that
    something acts there is certain, so held windows need only agree, however few show it."""
    pair = exchange(larger.causes, smaller.causes).pair
    if pair is None or pair[0].kind == pair[1].kind:
        return False
    return pair[0].place == pair[1].place and smaller.fit.scale < NEAR_NOISE


def part_taken(larger: Refined, smaller: Refined, everywhere: bool = False) -> float:
    """The share of the mismatch left by ``smaller`` that ``larger`` takes, on held windows (on the
    fitted ones where none is held); the noise floor is taken off, and known to 2 % only. Of two
    laws that stand for each other, all windows are counted ``everywhere``, and how well the floor
    is known does not matter."""
    held = smaller.fit.held if smaller.fit.held.any() else ~smaller.fit.held
    if everywhere:
        held = np.ones_like(held)
    floor = float(smaller.fit.count[held].sum())
    before, after = float(smaller.fit.chi2[held].sum()), float(larger.fit.chi2[held].sum())
    if not np.isfinite(before):
        return 1.0
    least = 0.0 if everywhere else NOISE_SHARE * floor
    left = max(before - min(floor, after), least, 1e-12)
    return (before - after) / left


def unit_of(trial: Refined) -> float:
    """χ² of one independent sample: residual variance times its correlation."""
    return trial.fit.scale * trial.fit.correlation


def criterion(trial: Refined, reference: Refined) -> float:
    """χ²/c + k ln N of a structure, in the unit of a reference, and χ² of its values against what
    was known of them before; smaller is better."""
    return trial.fit.train / unit_of(reference) + cost(trial) + trial.fit.prior


def excess(chi2: float, trial: Refined) -> float:
    """What χ² of the fitted windows holds beyond the noise floor."""
    return max(chi2 - float(trial.fit.count[~trial.fit.held].sum()), 1e-12)


def _percent(part: float) -> str:
    return "nothing" if part <= 0 else f"{100 * part:.3g} %"


def named(causes: Sequence[Hypothesis]) -> str:
    """Name a structure in a log line."""
    return " + ".join(map(str, causes)) or "the model as it is"

"""Formulas without a name, where no law that has one explains the recordings: products of what
moves and what acts, the most promising of them by the linear problem."""

from collections.abc import Sequence

from symhyb.correction.search.score import unit_of
from symhyb.correction.search.screen import screen
from symhyb.correction.search.selection import Subset, solve
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined
from symhyb.correction.search.trials import Row
from symhyb.discrepancy.places.hypotheses import Hypothesis, Library
from symhyb.discrepancy.places.products import product_library, products
from symhyb.judgement import LARGE, SIGNIFICANT
from symhyb.model.types import On
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel

TRIALS = 3


def candidates(setting: Setting) -> Library:
    """All products on the coordinates of the model, lowered; friction is smoothed as it is in the
    first list."""
    transitions = {
        cause.place.coordinate: dict(cause.shape)["transition"]
        for cause in setting.hypotheses
        if cause.kind == "friction" and not cause.bent and isinstance(cause.place, On)
    }
    model = setting.windows.machine.model
    return product_library(model, products(model, transitions))


def beside(setting: Setting, book: Library, selected: Refined) -> list[tuple[Hypothesis, Row]]:
    """The products with the largest screening gain on what a fitted structure leaves, along its
    simulation."""
    columns = tuple(selected.machine.column(path) for path in selected.paths)
    model = WindowModel(selected.machine, columns)
    return _promised(setting, book, model, selected.p, selected, selected.fit.starts)


def instead(setting: Setting, book: Library, nothing: Refined) -> list[tuple[Hypothesis, Row]]:
    """The products with the largest screening gain on the whole mismatch, along the measured
    motion."""
    model = WindowModel(nothing.machine)
    return _promised(setting, book, model, nothing.p, nothing, None)


def _promised(
    setting: Setting,
    book: Library,
    model: WindowModel,
    p: Array,
    base: Refined,
    starts: Sequence[Array] | None,
) -> list[tuple[Hypothesis, Row]]:
    if not book.hypotheses:
        return []
    problem = screen(book, model, (), setting.stages[-1].cuts, p, setting.sd, starts)
    empty = solve(problem, ())
    if empty is None:
        return []
    subsets = [s for i in range(len(book.hypotheses)) if (s := solve(problem, (i,))) is not None]
    unit = unit_of(base) if starts is not None else empty.chi2 / max(base.fit.count.sum(), 1)
    return [
        (cause, cause.values(subset.values.tolist()))
        for subset in sorted(subsets, key=lambda s: s.chi2)[:TRIALS]
        if worth(empty, subset, base, unit)
        for cause in (book.hypotheses[subset.causes[0]],)
    ]


def worth(empty: Subset, subset: Subset, base: Refined, unit: float | None = None) -> bool:
    """Whether the gain of a linear problem is enough for a trial: a significant part of what a
    structure leaves; ``unit`` is χ² of one independent sample (default: that of the structure)."""
    gain = empty.chi2 - subset.chi2
    more = max(empty.chi2 - float(base.fit.count[~base.fit.held].sum()), 1e-12)
    return gain / (unit_of(base) if unit is None else unit) > SIGNIFICANT and gain > LARGE * more

"""Further lines at a place where one was found: overtones, and other lines of the spectrum."""

from dataclasses import replace
from itertools import combinations

from symhyb.correction.search.formulas import worth
from symhyb.correction.search.screen import screen
from symhyb.correction.search.selection import solve
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Row
from symhyb.discrepancy.places.hypotheses import Hypothesis, library
from symhyb.laws.lines import NARROW, WAVE
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.runs.windows import WindowModel

OVERTONES = (2.0, 3.0, 0.5)  # times the frequency that was found


def lines_of(setting: Setting, selected: Refined) -> list[tuple[tuple[Hypothesis, ...], list[Row]]]:
    """The best line more and the best two of them, with first guesses, where the linearisation
    along the selected structure's simulation takes a part of what is left."""
    offered = _lines(setting, selected)
    if not offered:
        return []
    book = library(setting.windows.machine.model, (), offered)
    columns = tuple(selected.machine.column(path) for path in selected.paths)
    problem = screen(
        book,
        WindowModel(selected.machine, columns),
        (),
        setting.stages[-1].cuts,
        selected.p,
        setting.sd,
        selected.fit.starts,
    )
    empty = solve(problem, ())
    found = []
    for many in (1, 2):
        subsets = [
            subset
            for chosen in combinations(range(len(offered)), many)
            if (subset := solve(problem, chosen)) is not None
        ]
        best = min(subsets, key=lambda s: s.chi2, default=None)
        if empty is None or best is None or not worth(empty, best, selected):
            continue
        rows = [
            offered[cause].values(best.values[2 * i : 2 * i + 2].tolist())
            for i, cause in enumerate(best.causes)
        ]
        found.append((tuple(offered[cause] for cause in best.causes), rows))
    return found


def _is_line(cause: Hypothesis) -> bool:
    return cause.kind in KINDS and KINDS[cause.kind].terms is WAVE


def _lines(setting: Setting, selected: Refined) -> tuple[Hypothesis, ...]:
    """Lines that are not in the selected structure, at the places of those that are."""
    offered: list[Hypothesis] = []
    for cause, row in zip(selected.causes, grouped(selected), strict=True):
        if not _is_line(cause):
            continue
        (key,) = cause.refined
        times = OVERTONES if key == "frequency" else tuple(1 / many for many in OVERTONES)
        offered += [replace(cause, shape=((key, many * row[key]),)) for many in times]
        offered += [h for h in setting.hypotheses if h.family == cause.family]
    known = [
        (cause.kind, cause.place, row[cause.refined[0]])
        for cause, row in zip(selected.causes, grouped(selected), strict=True)
        if _is_line(cause)
    ]
    fresh: list[Hypothesis] = []
    for line in offered:
        key, value = line.shape[0]
        near = [
            old
            for kind, place, old in known
            if (kind, place) == (line.kind, line.place) and max(old / value, value / old) < NARROW
        ]
        if not near:
            known.append((line.kind, line.place, value))
            fresh.append(line)
    return tuple(fresh)

"""What else is visible in what the found causes leave: named with its share, never claimed.

On real recordings every term is significant. What explains too little to be found is listed here:
laws of the vocabulary, and effects that format 1 writes as a ``law`` only.
"""

from dataclasses import replace

import numpy as np

from symhyb.correction.naming.findings import cause_phrase
from symhyb.correction.search.score import unit_of
from symhyb.correction.search.screen import screen
from symhyb.correction.search.selection import Problem, solve
from symhyb.correction.search.setting import Setting, around
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.places.hypotheses import Hypothesis, Library
from symhyb.discrepancy.words.formula import LAW
from symhyb.discrepancy.words.wording import capital, percent_text
from symhyb.judgement import NOTABLE, SIGNIFICANT
from symhyb.laws.reach import TRANSITION_SHARE
from symhyb.model.expression import parse_expression
from symhyb.model.types import Element, Model, On
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.windows import WindowModel

REPORTED = 5


def leftover(setting: Setting, selected: Refined) -> tuple[str, ...]:
    """Sentences on what would take a part of the remainder on held windows, largest first."""
    taken = {cause.family for cause in selected.causes}
    varied = [cause for cause in selected.causes if cause.added or cause.bent]
    parts: dict[str, float] = {}
    laws = _laws(setting)
    model = WindowModel(
        selected.machine, tuple(selected.machine.column(path) for path in selected.paths)
    )
    cuts = setting.stages[-1].cuts
    for problem in (
        around(setting, selected),
        screen(
            laws,
            model,
            (),
            cuts,
            selected.p,
            setting.sd,
            selected.fit.starts,
            each=[selected.of(item.source[0]) for item in cuts],
            own=selected.own_columns,
        ),
    ):
        for hypothesis, part in _promises(problem, selected):
            plain = any(cause.extends(hypothesis) for cause in varied)
            if hypothesis.family not in taken and not plain:
                said = _said(hypothesis)
                parts[said] = max(part, parts.get(said, 0.0))
    ranked = sorted(parts.items(), key=lambda item: -item[1])[:REPORTED]
    return tuple(
        f"{capital(name)} would explain a further {percent_text(part)} of what is left."
        for name, part in ranked
    )


def _said(hypothesis: Hypothesis) -> str:
    """A cause without its numbers; effects that are no law of the vocabulary bring their words."""
    probe = hypothesis.kind == LAW and hypothesis.place is None
    return hypothesis.path if probe else cause_phrase(hypothesis)


def _promises(problem: Problem, selected: Refined) -> list[tuple[Hypothesis, float]]:
    """Each cause that is significant on fitted and held windows, with the part it would take."""
    base = solve(problem, ())
    if base is None:
        return []
    floor = float(selected.fit.count[selected.fit.held].sum())
    result = []
    for index, hypothesis in enumerate(problem.hypotheses):
        subset = solve(problem, (index,))
        if subset is None:
            continue
        gains = base.chi2 - subset.chi2, base.held - subset.held
        part = gains[1] / max(base.held - min(floor, subset.held), 1e-12)
        if min(gains) / unit_of(selected) > SIGNIFICANT and part > NOTABLE:
            result.append((hypothesis, part))
    return result


def _laws(setting: Setting) -> Library:
    """Effects that vary with direction or place, one probe each on every coordinate."""
    model: Model = setting.windows.machine.model
    hypotheses: list[Hypothesis] = []
    elements: list[Element] = []
    for i, coordinate in enumerate(model.coordinates):
        x, motions = coordinate.name, [item.source[1] for item in setting.stages[0].cuts]
        states, rates = [m.q[:, i] for m in motions], [m.v[:, i] for m in motions]
        centre = float(np.mean([np.mean(s) for s in states]))
        speed = max(float(np.max(np.abs(rate))) for rate in rates) or 1.0
        slip = f"tanh({x}'/{TRANSITION_SHARE * speed!r})"
        for said, force in (
            (f"viscous damping on {x} that differs by direction", f"abs({x}')"),
            (f"viscous damping on {x} that varies with position", f"({x} - ({centre!r}))*{x}'"),
            (f"dry friction on {x} that varies with position", f"({x} - ({centre!r}))*{slip}"),
        ):
            name = f"law{len(elements)}"
            entry = ("force", parse_expression(force))
            elements.append(Element(name, "law", On(x), (entry,)))
            hypotheses.append(Hypothesis(LAW, None, ("force",), (False,), path=said))
    machine = build(replace(model, elements=(*model.elements, *elements)), keep=False)
    columns = tuple((i,) for i in range(len(elements)))
    return Library(machine, (), tuple(hypotheses), columns)

"""What a decision works on: hypotheses, windows at growing lengths, and the screens over them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.search.screen import screen
from symhyb.correction.search.selection import Problem
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.places.hypotheses import Hypothesis, Library
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.discrepancy.results import Change
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel


@dataclass(frozen=True, slots=True)
class Stage:
    """One window length in s and the windows of all recordings at it."""

    length_s: float
    cuts: tuple[Cut, ...]


def middle_of(stages: Sequence[Stage]) -> Stage:
    """The stage of windows that are neither the shortest nor long."""
    return stages[min(1, len(stages) - 1)]


@dataclass(frozen=True, slots=True)
class Setting:
    """What a decision works on: force hypotheses lowered, parametric causes, windows prepared for
    the model with all parametric causes free, stages from short to long, noise ``sd`` (m,) SI, and
    the smallest gain error that interpolation between samples cannot feign, and the relative
    ``accuracy`` of fitted values that the numerics allow. ``change``: the stages are those of the
    part in which the mismatch acts."""

    library: Library
    parametric: tuple[Hypothesis, ...]
    windows: WindowModel
    stages: tuple[Stage, ...]
    sd: Array
    gain_floor: float
    accuracy: float
    change: Change | None = None

    @property
    def middle(self) -> Stage:
        """The windows on which places are mapped."""
        return middle_of(self.stages)

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """All causes, in the order of the reduced problems."""
        return (*self.library.hypotheses, *self.parametric)

    @property
    def bent(self) -> frozenset[int]:
        """The causes whose laws take on shapes between those of simpler ones. Beside anything that
        is missing a power of the speed stands for friction and damping, so that they are not
        searched for."""
        return frozenset(i for i, cause in enumerate(self.hypotheses) if cause.bent)


def along_motion(setting: Setting, stage: Stage) -> Problem:
    """The reduced problem of one stage along the measured motion."""
    model = setting.windows
    p, floor = model.machine.values, setting.gain_floor
    return screen(
        setting.library, model, setting.parametric, stage.cuts, p, setting.sd, gain_floor=floor
    )


def around(setting: Setting, selected: Refined) -> Problem:
    """The reduced problem along the selected structure's simulation, its own numbers always in."""
    paths = [*(cause.path for cause in setting.parametric), *selected.paths]
    unique = list(dict.fromkeys(paths))
    model = WindowModel(selected.machine, tuple(selected.machine.column(path) for path in unique))
    cuts = setting.stages[-1].cuts
    starts, floor = selected.fit.starts, setting.gain_floor
    return screen(
        setting.library,
        model,
        setting.parametric,
        cuts,
        selected.p,
        setting.sd,
        starts,
        floor,
        each=[selected.of(item.source[0]) for item in cuts],
        own=selected.own_columns,
    )


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """What a cause of a fitted structure does in the problem along it: its ``columns``, and their
    coefficients (F,), SI, that make its effect."""

    columns: tuple[int, ...]
    effect: Array


def effects(setting: Setting, selected: Refined, problem: Problem) -> tuple[Part, ...]:
    """The part of each cause of a structure in the problem :func:`around` it."""
    first = len(problem.columns) - len(setting.parametric)
    of_path = {cause.path: problem.columns[first + i] for i, cause in enumerate(setting.parametric)}
    rest = [path for path in selected.paths if path not in of_path]
    places, cuts = problem.places, setting.stages[-1].cuts
    assert places is not None
    each = {
        path: places.widened((column,)) for path, column in zip(rest, problem.always, strict=False)
    }
    found, row = [], 0
    for cause in selected.causes:
        paths = selected.paths[row : row + cause.numbers]
        row += cause.numbers
        grows = {"value", "amplitude", *cause.terms, *cause.tied}
        keys = ("value",) if cause.place is None else cause.keys
        effect = np.zeros(len(problem.gram) - 1)
        columns: list[int] = []
        for path, key in zip(paths, keys, strict=True):
            column = selected.machine.column(path)
            base = selected.machine.values[column] if cause.place is None else 0.0
            mine = of_path.get(path) or each[path]
            columns += mine
            for target in mine:
                value = selected.of(cuts[places.first[target]].source[0])[column] - base
                effect[target] = value if key in grows else 0.0
        found.append(Part(tuple(columns), effect))
    return tuple(found)


def exchanged(problem: Problem, parts: Sequence[Part], out: Sequence[int]) -> Problem:
    """The problem in which the causes ``out`` of the structure along which it was made are gone,
    and those that stay may move."""
    effect = np.sum([parts[i].effect for i in out], axis=0) if out else np.zeros(len(problem.lower))
    gone = {column for i in out for column in parts[i].columns}
    stay = [c for i, part in enumerate(parts) if i not in out for c in part.columns]
    always = [column for column in problem.always if column not in gone]
    always += [column for column in stay if column not in always]
    mix = np.eye(len(problem.gram))
    mix[:-1, -1] = effect
    return replace(
        problem,
        gram=mix.T @ problem.gram @ mix,
        held=mix.T @ problem.held @ mix,
        always=tuple(always),
    )

"""What a decision works on: hypotheses, windows at growing lengths, and the screens over them."""

from dataclasses import dataclass

from symhyb.correction.search.screen import screen
from symhyb.correction.search.selection import Problem
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.places.hypotheses import Hypothesis, Library
from symhyb.discrepancy.recorded.windows import Laid
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel


@dataclass(frozen=True, slots=True)
class Stage:
    """One window length in s and the windows of all recordings at it."""

    length_s: float
    laid: tuple[Laid, ...]


@dataclass(frozen=True, slots=True)
class Setting:
    """What a decision works on: force hypotheses lowered, dull causes, windows prepared for the
    model with all dull causes free, stages from short to long, noise ``sd`` (m,) SI, and
    the smallest gain error that interpolation between samples cannot feign, and the relative
    ``accuracy`` of fitted values that the numerics allow."""

    library: Library
    dull: tuple[Hypothesis, ...]
    windows: WindowModel
    stages: tuple[Stage, ...]
    sd: Array
    gain_floor: float
    accuracy: float

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """All causes, in the order of the reduced problems."""
        return (*self.library.hypotheses, *self.dull)


def along_motion(setting: Setting, stage: Stage) -> Problem:
    """The reduced problem of one stage along the measured motion."""
    model = setting.windows
    p, floor = model.machine.values, setting.gain_floor
    return screen(setting.library, model, setting.dull, stage.laid, p, setting.sd, gain_floor=floor)


def around(setting: Setting, winner: Refined) -> Problem:
    """The reduced problem along the winner's simulation, its own numbers always in."""
    paths = [*(cause.path for cause in setting.dull), *winner.paths]
    unique = list(dict.fromkeys(paths))
    model = WindowModel(winner.machine, tuple(winner.machine.column(path) for path in unique))
    laid = setting.stages[-1].laid
    starts, floor = winner.fit.starts, setting.gain_floor
    return screen(
        setting.library,
        model,
        setting.dull,
        laid,
        winner.p,
        setting.sd,
        starts,
        floor,
        each=[winner.of(item.source[0]) for item in laid],
        own=winner.own_columns,
    )

"""Parameters fitted to recordings, and nothing else: no cause is sought and none is claimed.

Simulation error over windows with free initial states is minimised, as a diagnosis does. A stated
``sd`` is evidence about its parameter; the values of an earlier fit (``was``) are none.
Sizes: F fitted parameters, P parameters of the model.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.search.preparing import Prepared, last_windows, prepare
from symhyb.correction.search.so_far import if_interrupted
from symhyb.correction.search.trajectory import DELAY_REACH
from symhyb.data.cleaning import still
from symhyb.data.known import require_known
from symhyb.data.recording import Recording, several
from symhyb.discrepancy.evidence import correlation_of
from symhyb.discrepancy.fitting.matching import fit
from symhyb.discrepancy.fitting.task import Fit, Task
from symhyb.discrepancy.places.hypotheses import with_channels
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.discrepancy.results import RecordingFault, Reestimated
from symhyb.discrepancy.words.amounts import quantity_text
from symhyb.errors import InputError, NumericsError, Problem, did_you_mean
from symhyb.judgement import GAIN_REACH
from symhyb.model.actuators import ACTUATOR_KEYS
from symhyb.model.types import Model, Parameter
from symhyb.model.vocabulary import key_of
from symhyb.model.write import replace_parameters
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.threads import one_thread
from symhyb.numeric.runs.windows import WindowModel
from symhyb.steps import Say, silent

LEAST = 1e-6  # of a parameter that is positive: it stays so
FAR = 0.1  # of a value: windows that were laid for the old one are laid anew, once


@dataclass(frozen=True, slots=True, eq=False)
class Calibrated:
    """The ``model`` with fitted values in place, and these as ``parameters`` in the units of the
    file; ``prior`` are their deviations before (None: nothing was stated), ``correlation`` (F, F)
    is dimensionless, ``bounds`` are the names of those that end at a bound.

    ``before`` and ``after`` are χ² per sample of the windows: how much the recordings leave of the
    model as given and as fitted, 1 where that is noise alone. ``faults`` of the recordings were put
    right before, if ``claimed``, or are suspected. ``samples`` is how many measured values the
    windows hold less their initial states, ``correlation_time`` over how many of these what is
    left is correlated, 1 where it is white.
    """

    model: Model
    parameters: tuple[Reestimated, ...]
    prior: tuple[float | None, ...]
    correlation: Array
    bounds: tuple[str, ...]
    before: float
    after: float
    faults: tuple[RecordingFault, ...] = ()
    samples: int = 0
    correlation_time: float = 1.0

    def sentence(self) -> str:
        """The values in one line: ``k = 50.0 ± 0.2 N/m, d = ...``."""
        return ", ".join(
            f"{item.name} = {quantity_text(item.value, item.unit, item.sd)}"
            for item in self.parameters
        )

    def together(self, least: float) -> list[tuple[str, str, float]]:
        """Pairs of parameters whose correlation is at least that in size, strongest first."""
        names = [item.name for item in self.parameters]
        pairs = [
            (names[i], names[j], float(self.correlation[i, j]))
            for i in range(len(names))
            for j in range(i)
            if abs(self.correlation[i, j]) >= least
        ]
        return sorted(pairs, key=lambda pair: -abs(pair[2]))


def calibrated(
    model: Model,
    recordings: Recording | Sequence[Recording],
    free: Sequence[str] = (),
    *,
    stated: bool = True,
    say: Say | None = None,
) -> Calibrated:
    """Fit parameters of a model to recordings: those ``free`` by name, else all that state an sd.
    A ``stated`` sd is evidence about its parameter, else the recordings alone say the values.

    Names are those of parameters (``k``, ``spring.k``) and of channels (``laser.gain``).

    Raises:
        InputError: an unknown name, nothing to fit, one whose value recordings state as known, or
            recordings in which no sensor changes.
        NumericsError: the model cannot be simulated along them.
    """
    tell = say or silent
    items = chosen(model, free)
    if not stated:
        items = unstated(items)
    require_shown(model, recordings, [item.path for item in items])
    with one_thread():
        done = _fitted(model, model, items, recordings, tell)
        if not moved(done.parameters, model):
            return done
        with if_interrupted(done.sentence):
            return _fitted(done.model, model, items, recordings, tell)


def _fitted(
    start: Model,
    model: Model,
    items: Sequence[Parameter],
    recordings: Recording | Sequence[Recording],
    tell: Say,
) -> Calibrated:
    """The parameters of a model, fitted on windows that are made for the values of ``start``."""
    tell("estimating motion and noise" if start is model else "laying windows anew")
    prepared = prepare(start, recordings)
    tell(f"fitting {len(items)} parameter{'s' * (len(items) > 1)}")
    return _calibrated(model, items, prepared)


def chosen(model: Model, free: Sequence[str] = ()) -> tuple[Parameter, ...]:
    """The parameters of a model that are to be fitted.

    Raises:
        InputError: an unknown name, a name twice, or nothing to fit.
    """
    known = {item.path: item for item in with_channels(model).all_parameters()}
    problems = [
        Problem(f"there is no parameter '{name}'{did_you_mean(name, list(known))}", file=model.file)
        for name in free
        if name not in known
    ]
    problems += [
        Problem(f"'{name}' is named twice", file=model.file)
        for name in dict.fromkeys(free)
        if list(free).count(name) > 1
    ]
    if problems:
        raise InputError(problems)
    found = [known[name] for name in free] or [p for p in known.values() if p.sd is not None]
    if not found:
        text = "no parameter states an sd, so none is uncertain; say which are to be fitted"
        raise InputError(Problem(text, "parameters", model.file))
    return tuple(found)


def unstated(items: Sequence[Parameter]) -> tuple[Parameter, ...]:
    """The same parameters without what the model file says of their deviations."""
    return tuple(replace(item, sd=None) for item in items)


def require_shown(
    model: Model, recordings: Recording | Sequence[Recording], paths: Sequence[str]
) -> None:
    """Refuse recordings that state what is to be fitted as known, or in which nothing changes.

    Raises:
        InputError: they do.
    """
    require_known(model, several(recordings), paths)
    if still(several(recordings)):
        raise InputError(Problem("no sensor changes in any recording: nothing can be fitted"))


def _calibrated(model: Model, items: Sequence[Parameter], prepared: Prepared) -> Calibrated:
    cuts = all_windows(prepared)
    return on_windows(model, items, prepared, cuts, prepared.machine.values)[0]


def all_windows(prepared: Prepared) -> tuple[Cut, ...]:
    """The windows that values are fitted to.

    Raises:
        NumericsError: there are none that the model can foresee.
    """
    machine = prepared.machine
    cuts = tuple(item.suited(machine) for item in last_windows(prepared, spread=False))
    if not cuts:
        raise NumericsError("the motion in these recordings cannot be foreseen even for a moment")
    return cuts


def on_windows(
    model: Model, items: Sequence[Parameter], prepared: Prepared, cuts: tuple[Cut, ...], p: Array
) -> tuple[Calibrated, Fit]:
    """Parameters of a ``model`` fitted on windows, from ``p`` (P,) in SI, which holds the others.

    Raises:
        NumericsError: the model cannot be simulated along the windows.
    """
    machine = prepared.machine
    columns = tuple(machine.column(item.path) for item in items)
    step = float(np.median(np.diff(cuts[0].block.t, axis=1)))
    lower, upper = np.array([_bounds(model, item, step) for item in items]).T
    mean, spread = np.array([(item.si, _known(item)) for item in items]).T
    task = Task(cuts, prepared.sd, lower, upper, mean, spread, everything=True)
    fitted = fit(WindowModel(machine, columns), task, p)
    if fitted.reason:
        raise NumericsError(f"the model cannot be simulated: {fitted.reason}")
    given = p.copy()
    given[list(columns)] = [item.si for item in items]
    before = _misfit(WindowModel(machine), cuts, prepared.sd, given)
    numbers = _numbers(items, fitted)
    changed: dict[str, tuple[float, float | None]] = {n.name: (n.value, n.sd) for n in numbers}
    near = np.sqrt(np.diag(fitted.covariance)) * 1e-3
    at = (fitted.values <= lower + near) | (fitted.values >= upper - near)
    done = Calibrated(
        replace_parameters(model, changed),
        numbers,
        tuple(None if item.was is not None else item.sd for item in items),
        correlation_of(fitted.covariance),
        tuple(item.path for item, ends in zip(items, at, strict=True) if ends),
        before,
        fitted.scale,
        prepared.faults,
        int(fitted.count.sum()),
        fitted.correlation,
    )
    return done, fitted


def _misfit(model: WindowModel, cuts: tuple[Cut, ...], sd: Array, p: Array) -> float:
    """χ² per sample of the windows where nothing but initial states is fitted; inf if it is not
    bounded."""
    none = np.zeros(0)
    found = fit(model, Task(cuts, sd, none, none, none, none, everything=True), p)
    return float("inf") if found.reason else found.scale


def _numbers(items: Sequence[Parameter], fitted: Fit) -> tuple[Reestimated, ...]:
    """The fitted values in the units of the file."""
    sds = np.sqrt(np.diag(fitted.covariance))
    return tuple(
        Reestimated(
            item.path,
            item.value,
            float(value) / item.unit.factor,
            float(sd) / item.unit.factor,
            item.unit.text,
        )
        for item, value, sd in zip(items, fitted.values, sds, strict=True)
    )


def _known(item: Parameter) -> float:
    """What was known of a number before, as one deviation in SI."""
    return np.inf if item.was is not None or item.si_sd is None else item.si_sd


def _bounds(model: Model, item: Parameter, step: float) -> tuple[float, float]:
    """What physics allows of a number, SI; samples lie ``step`` seconds apart. What is positive
    stays so."""
    channels = {*(one.name for one in model.inputs), *(one.name for one in model.sensors)}
    if item.owner in channels and item.name in ACTUATOR_KEYS:
        return LEAST * item.si, np.inf
    if item.owner in channels:
        reach = {"gain": GAIN_REACH * abs(item.si), "delay": DELAY_REACH * step}
        most = reach.get(item.name, np.inf)
        return item.si - most, item.si + most
    lower, upper = LEAST * item.si if item.value > 0 else -np.inf, np.inf
    for element in model.elements:
        own = {parameter.name for parameter in element.parameters}
        if element.name != item.owner and (item.owner or item.name in own):
            continue
        for key, value in element.values:
            declared = key_of(element.kind, key) if value.text == item.name else None
            if declared is not None:
                lower, upper = max(lower, declared.lower), min(upper, declared.upper)
    return lower, upper


def moved(numbers: Sequence[Reestimated], start: Model) -> bool:
    """Whether a number lies far from where it stood when the windows were made."""
    stood = {item.path: item.value for item in with_channels(start).all_parameters()}
    return any(abs(one.value - stood[one.name]) > FAR * abs(stood[one.name]) for one in numbers)

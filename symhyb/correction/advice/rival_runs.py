"""Where the most probable rivals of the selected structure would differ from it.

Nothing is fitted: every structure is simulated once over the windows on which it was fitted, with
the values and initial states of that fit. Sizes: N samples, m sensors.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from symhyb.correction.naming.findings import cause_phrase, rivals_of
from symhyb.correction.naming.probability import shares
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined, delayed
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.discrepancy.results import RivalRun
from symhyb.discrepancy.words.wording import joined
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel

RIVALS_MOST = 3


class _Rival(NamedTuple):
    """A rival as :class:`RivalRun` has it, and its fit."""

    causes: str
    instead_of: str
    evidence: float
    probability: float | None
    trial: Refined


def rival_runs(setting: Setting, decision: Decision) -> tuple[RivalRun, ...]:
    """The most probable rivals within reach, the most probable first, each with the difference of
    its simulation from that of the selected structure; all along the training recording in which
    they differ most. Empty without rivals, or where none can be simulated."""
    ranked = sorted(rivals_of(decision), key=lambda rival: rival[1])
    parts = {id(trial): share for trial, share in (shares(decision) if ranked else ())}
    found: dict[str, _Rival] = {}
    for change, evidence, trial in ranked:
        causes, lost = (joined([*map(cause_phrase, s)]) for s in (change.fresh, change.lost))
        if causes == lost:
            causes += " of another shape"
        chance = None if change.conventional else parts.get(id(trial))
        found.setdefault(causes, _Rival(causes, lost, max(evidence, 0.0), chance, trial))
    rivals = [*found.values()][:RIVALS_MOST]
    best: tuple[float, Recording, list[Array]] | None = None
    stage = setting.stages[-1]
    for i, item in enumerate(stage.cuts if rivals else ()):
        own = simulated(decision.selected, i, item)
        with np.errstate(invalid="ignore", over="ignore"):  # a window may run away
            apart = [_apart(simulated(rival.trial, i, item), own) for rival in rivals]
            size = float(np.nansum([(one / setting.sd) ** 2 for one in apart]))
        if best is None or size > best[0]:
            best = size, item.source[0], apart
    if best is None:
        return ()
    _, recording, apart = best
    sensors = setting.windows.machine.model.sensors.names()
    noise = dict(zip(sensors, setting.sd.tolist(), strict=True))
    told = []
    for rival, values in zip(rivals, apart, strict=True):
        seen = _seen(dict(zip(sensors, values.T, strict=True)), recording)
        if seen:
            run = RivalRun(
                rival.causes,
                rival.instead_of,
                rival.evidence,
                rival.probability,
                recording.name,
                stage.length_s,
                recording.t,
                seen,
                {name: noise[name] for name in seen},
            )
            told.append(run)
    return tuple(told)


def simulated(trial: Refined, which: int, item: Cut) -> tuple[Array, NDArray[np.int64]]:
    """What a structure says of every sample of a recording, the ``which``-th of those that it was
    fitted to (N, m), SI, and in which window of ``item`` (N, m): each begins at its fitted initial
    state. NaN and −1 outside of the windows; not finite where one runs away."""
    recording = item.source[0]
    late = delayed(trial)
    model, p = WindowModel(trial.machine, late=late), trial.of(recording)
    item = item.suited(trial.machine).in_time(model, p)
    with np.errstate(all="ignore"):
        _, y = model.simulate(item.block, trial.fit.starts[which], p)
    step = float(np.median(np.diff(item.block.t, axis=1)))
    found = np.full((recording.t.size, y.shape[2]), np.nan)
    window = np.full(found.shape, -1)
    which_one = np.broadcast_to(np.arange(len(y))[:, None], item.rows.shape)
    for j in range(y.shape[2]):
        shift = round(item.block.late[j] / step) if item.block.late else 0
        then = item.rows + shift  # a late sensor shows it so many samples later
        there = (then >= 0) & (then < recording.t.size)
        found[then[there], j] = y[..., j][there]
        window[then[there], j] = which_one[there]
    return found, window


def _apart(rival: tuple[Array, NDArray[np.int64]], own: tuple[Array, NDArray[np.int64]]) -> Array:
    """The difference of two simulations (N, m), SI, where both are of the same window: where these
    meet, one of a late sensor is still in the window before."""
    difference = rival[0] - own[0]
    return np.where(np.isfinite(difference) & (rival[1] == own[1]), difference, np.nan)


def _seen(apart: Mapping[str, Array], recording: Recording) -> dict[str, Array]:
    """The differences (N,) of the sensors that recorded something, where there is any."""
    return {
        name: values
        for name, values in apart.items()
        if np.isfinite(values).any()
        and name in recording.sensors
        and np.isfinite(recording.sensors[name]).any()
    }

"""The noise of measured inputs, as the innovations measure it beside a decided structure.

Windows are simulated with the inputs as they were recorded, so that noise of an input goes through
the machine into what is left of every sensor: it is too large there, its neighbours in time belong
together, and small causes may imitate it. Where the innovations find the record of an input noisy
they say how noisy, and what is left of the sensors' own noise beside it.
"""

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.adequacy.classes.columns import CHANGE, pushes
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.recorded import Recorded, recorded
from symhyb.correction.adequacy.structure import NOISE_FLOOR, Fitted, tracks_of
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.selection import many
from symhyb.correction.search.setting import Setting
from symhyb.discrepancy.likelihood.horizon import memoryless
from symhyb.discrepancy.likelihood.input_noise import InputNoise, along_recording, by_input
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import Track
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.judgement import CERTAIN
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel


@dataclass(frozen=True, slots=True, eq=False)
class _Noisy:
    """Stretches linearised for errors of inputs, and the most likely white noise of these and of
    the sensors."""

    tracks: tuple[Track, ...]
    noise: NoiseModel


def with_input_noise(prepared: Prepared, setting: Setting, judged: Adequacy) -> Setting | None:
    """What a decision was made in (``setting``), with the noise of the inputs that were found to be
    noisy beside the structure that was ``judged``; None where there is none. Repeated runs show the
    noise already, and what forces show is not decided again among windows."""
    if judged.structure is None or many(judged.structure.causes):
        return None
    which = _which(setting, judged)
    ground = recorded(prepared, setting) if which and not prepared.repeats else None
    if ground is None:
        return None
    found = _measured(ground, judged.structure, which)
    if not np.any(found.noise.force > 0):
        return None
    known = _of_recordings(found, which)
    stages = tuple(
        replace(stage, cuts=tuple(_noisy(known, item) for item in stage.cuts))
        for stage in setting.stages
    )
    return replace(setting, stages=stages, sd=found.noise.white)


def stands(again: Adequacy, before: Adequacy) -> bool:
    """Whether what was decided again stands instead of what was decided before: noise explains away
    what was in doubt, and brings no cause. It names nothing that was not named before, all that was
    named without a doubt still is, and if it is less it is as likely along whole recordings, to
    100 to 1. Inputs that are put right along a wrong structure hide what that lacks."""
    if again.structure is None or before.structure is None:
        return False
    named, known = _families(again.structure.causes), _families(before.structure.causes)
    sure, kept = known - _families(before.doubt), named - _families(again.doubt)
    likely = again.structure.evidence > before.structure.evidence - CERTAIN
    return named <= known and sure <= kept and (likely or named == known)


def _families(causes: Iterable[Hypothesis]) -> set[Hashable]:
    return {cause.family for cause in causes}


def _which(setting: Setting, judged: Adequacy) -> tuple[int, ...]:
    """The numbers of the inputs that look noisy."""
    names = [one.name for one in setting.windows.machine.model.inputs]
    noisy = [one.generic for one in judged.classes if one.generic.does == "noisy"]
    return tuple(names.index(str(one.where)) for one in noisy)


def _measured(ground: Recorded, structure: Fitted, which: tuple[int, ...]) -> _Noisy:
    """How noisy inputs are beside a structure, and the sensors beside that."""
    each = [[push for _, push in pushes(ground, j)] for j in which]
    tracks = tuple(
        by_input(one, np.stack(units, axis=2), _shown(structure, one, which))
        for one, *units in zip(tracks_of(ground, structure), *each, strict=True)
    )
    before = structure.fit.noise
    sizes = [_size(before.force, np.concatenate(units)) for units in each]
    begin = replace(before, force=np.array(sizes)).without_colour()
    noise, _ = memoryless(tracks, begin, NOISE_FLOOR * ground.sd, ground.step_s)
    return _Noisy(tracks, noise)


def _size(force: Array, unit: Array) -> float:
    """The RMS of an input, of one ``unit`` of which the force is (N, n), that pushes as an unknown
    ``force`` (n,) of this RMS does where it pushes. SI."""
    power = np.mean(unit**2, axis=0)
    return float(np.sqrt(np.sum(force[power > 0] ** 2) / power.sum()))


def _shown(structure: Fitted, one: Track, which: tuple[int, ...]) -> Array:
    """What the sensors show at once (N, m, k) of one unit of each input, SI."""
    machine, item = structure.machine, one.item
    p, model = structure.of(item.source[0]), WindowModel(structure.machine)
    (here,) = model.along(item.block, one.x[None], p).output
    columns = []
    for j in which:
        name, moved = machine.model.inputs[j].name, p.copy()
        change = CHANGE * (float(np.std(item.source[0].inputs[name])) or 1.0)
        moved[machine.column(f"{name}.offset")] += change
        (there,) = model.along(item.block, one.x[None], moved).output
        columns.append((there - here) / change)
    return np.stack(columns, axis=2)


def _of_recordings(found: _Noisy, which: tuple[int, ...]) -> dict[int, InputNoise]:
    """The noise of the inputs along every recording, by the recording's identity."""
    tracks: dict[int, list[Track]] = {}
    for one in found.tracks:
        tracks.setdefault(id(one.item.source[0]), []).append(one)
    return {
        key: along_recording(mine, mine[0].item.source[0].t.size, found.noise, which)
        for key, mine in tracks.items()
    }


def _noisy(known: Mapping[int, InputNoise], item: Cut) -> Cut:
    """Windows that know of the noise of inputs."""
    noise = known.get(id(item.source[0]))
    return item if noise is None else noise.put_right(item)

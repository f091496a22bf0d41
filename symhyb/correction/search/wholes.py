"""All causes at once, where a machine has many joints, and windows as long and fine as they ask."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from symhyb.correction.search.coupled import coupled_places
from symhyb.correction.search.first_structures import LARGEST
from symhyb.correction.search.force_screen import BAND, ForceScreen, force_screen
from symhyb.correction.search.preparing import Prepared, foresees, settle, stages_of
from symhyb.correction.search.score import choice_of
from symhyb.correction.search.selection import Subset
from symhyb.correction.search.setting import Setting, Stage
from symhyb.correction.search.trajectory import with_causes
from symhyb.correction.search.trials import Row, first_guess
from symhyb.data.groups import Own
from symhyb.discrepancy.recorded.runs import Run, cut_within, fine_needed, has_many, stepped_for
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.lowered.machine import Machine, build


@dataclass(frozen=True, slots=True)
class Whole:
    """A ``subset`` of causes, and ``rows`` of values, by key, SI, at which their fit begins."""

    subset: Subset
    rows: tuple[Row, ...]


def at_level_of_forces(
    prepared: Prepared, setting: Setting, own: Sequence[str] | Own
) -> tuple[Prepared, Setting, ForceScreen | None]:
    """What the forces of all causes show, with places of two joints where these share a loss, and
    windows as long as that foresees and as fine as it asks for; ``own`` as in :func:`.settle`."""
    forces = _screened(prepared, setting)
    whole = whole_of(setting, forces)
    if forces is None or whole is None:
        return *_as_fine_as_needed(prepared, setting), forces
    band, cuts = BAND / prepared.shortest, _windows(prepared, setting)
    places = coupled_places(prepared, setting.library, cuts, band, forces, whole.subset)
    if places:
        setting = settle(prepared, own, places)
        forces = _screened(prepared, setting)
        whole = whole_of(setting, forces)
    if whole is None:
        return *_as_fine_as_needed(prepared, setting), forces
    causes = [setting.hypotheses[cause] for cause in whole.subset.causes]
    steady = build(with_causes(prepared.model, causes, whole.rows), keep=False)
    if not foresees(prepared):
        prepared = replace(prepared, steady=steady)
        setting = replace(setting, stages=stages_of(prepared))
    return *_as_fine_as_needed(prepared, setting, steady), forces


def _screened(prepared: Prepared, setting: Setting) -> ForceScreen | None:
    cuts, band = _windows(prepared, setting), BAND / prepared.shortest
    return force_screen(prepared.machine, setting.library, cuts, band)


def _windows(prepared: Prepared, setting: Setting) -> list[Cut]:
    """All windows of the middle length."""
    length = setting.middle.length_s
    cuts = [cut_within(run, prepared.machine, length) for run in prepared.runs]
    return [item for item in cuts if item is not None]


def whole_of(
    setting: Setting, forces: ForceScreen | None, doubles: frozenset[int] = frozenset()
) -> Whole | None:
    """All causes that pay at the level of forces, but the ``doubles`` of others and bent laws; None
    if a machine has no more free coordinates than a few causes explain, or no more causes pay."""
    if forces is None or not has_many(setting.windows.machine):
        return None
    families = {cause.family for cause in setting.hypotheses if not cause.bent}
    found = forces.whole(choice_of(len(families) - len(doubles)), doubles | setting.bent)
    if found is None or len(found.causes) <= LARGEST:
        return None
    return Whole(found, tuple(first_guess(forces.problem(forces.begin()), found)))


def _as_fine_as_needed(
    prepared: Prepared, setting: Setting, machine: Machine | None = None
) -> tuple[Prepared, Setting]:
    """Recordings and windows of a machine of more than a few coordinates with as many steps, and as
    fine ones near reversals, as a ``machine`` with a whole asks for, or whatever could act: without
    the masses that a whole has, friction turns light bodies over in no time."""
    if not has_many(prepared.machine):
        return prepared, setting
    runs, unseen = (_fine(prepared, setting, machine, x) for x in (prepared.runs, prepared.holdout))
    found = {id(run.recording): (run.steps, run.fine) for run in runs}

    def stepped(cut: Cut) -> Cut:
        steps, fine = found[id(cut.source[0])]
        return replace(cut, steps=steps, fine=fine)

    stages = [Stage(stage.length_s, tuple(map(stepped, stage.cuts))) for stage in setting.stages]
    return replace(prepared, runs=runs, holdout=unseen), replace(setting, stages=tuple(stages))


def _fine(
    prepared: Prepared, setting: Setting, machine: Machine | None, runs: Sequence[Run]
) -> tuple[Run, ...]:
    if machine is None:
        return tuple(replace(run, fine=fine_needed(prepared.machine, run)) for run in runs)
    length = setting.stages[-1].length_s
    return tuple(stepped_for(machine, run, length) for run in runs)

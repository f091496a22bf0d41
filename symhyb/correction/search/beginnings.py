"""An effect that begins or ends within a recording: its law is sought where it acts."""

from dataclasses import replace

import numpy as np

from symhyb.correction.search.score import unit_of
from symhyb.correction.search.setting import Setting, Stage
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.fitting.matching import fit
from symhyb.discrepancy.fitting.task import starts_only
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.discrepancy.results import Change, Diagnosis, PlaceShare
from symhyb.discrepancy.words.occurrence_words import change_words
from symhyb.judgement import SIGNIFICANT, WINDOWS_LEAST
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.windows import WindowModel


def changed(places: tuple[PlaceShare, ...]) -> Change | None:
    """The change at the place that explains most; one that explains less only mirrors it."""
    known = places[0].occurrence if places else None
    return None if known is None else known.change


def active_part(setting: Setting, change: Change | None) -> Setting:
    """The setting with those windows of the recording in which the effect acts, and all of the
    others; the longest windows are left out where too few of them remain."""
    if change is None:
        return setting
    stages: list[Stage] = []
    for stage in setting.stages:
        kept = tuple(item for one in stage.cuts if (item := _acting(one, change)) is not None)
        if not kept or (stages and sum(len(item.start) for item in kept) < WINDOWS_LEAST):
            break
        stages.append(Stage(stage.length_s, kept))
    return replace(setting, stages=tuple(stages), change=change) if stages else setting


def _acting(item: Cut, change: Change) -> Cut | None:
    """The windows that lie wholly where the effect acts; None if there are none."""
    if item.source[0].name != change.recording:
        return item
    if change.kind == "begins":
        rows = np.flatnonzero(item.block.t[:, 0] >= change.time_s)
    else:
        rows = np.flatnonzero(item.block.t[:, -1] <= change.time_s)
    return item.chosen(rows) if rows.size else None


def contradicted(whole: Setting, selected: Refined, change: Change) -> bool:
    """Whether what was found where the effect acts makes the rest of the recording worse: else it
    may act throughout, in a motion that does not show it there."""
    rest = replace(change, kind="ends" if change.kind == "begins" else "begins")
    items = [item for item in whole.stages[-1].cuts if item.source[0].name == change.recording]
    cuts = [part for item in items if (part := _acting(item, rest)) is not None]
    if not cuts:
        return True
    model = whole.windows.machine
    with_it, without_it = (
        sum(float(_followed(machine, p, item, whole.sd).sum()) for item in cuts)
        for machine, p in ((selected.machine, selected.p), (model, model.values))
    )
    return with_it - without_it > SIGNIFICANT * unit_of(selected)


def _followed(machine: Machine, p: Array, item: Cut, sd: Array) -> Array:
    """χ² (W,) of windows by a machine as it is, with parameters ``p`` (P,) in SI."""
    return fit(WindowModel(machine), starts_only(item.suited(machine), sd), p).chi2


def in_part(found: Diagnosis, change: Change | None) -> Diagnosis:
    """The diagnosis with the words that its laws hold for a part of the recording only."""
    if change is None or found.verdict == "nothing missing":
        return found
    rest = "before" if change.kind == "begins" else "after"
    said = (
        f"The mismatch {change_words(change)}: what is said of it holds for that part, and "
        f"{rest} it nothing of the kind acts."
    )
    return replace(
        found,
        sentence=f"{found.sentence} {said}",
        found=tuple(
            replace(one, sentence=f"{one.sentence} {_since(change)}") for one in found.found
        ),
        notes=(said, *found.notes),
    )


def _since(change: Change) -> str:
    words = "from" if change.kind == "begins" else "until"
    return f"In {change.recording} it acts {words} t = {change.time_s:.4g} s only."

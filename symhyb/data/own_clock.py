"""Recordings of which each sample stands at the time that it is stamped with."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.data.recording import Recording
from symhyb.data.refresh import Aged, refresh


def on_stamps(recordings: Sequence[Recording], sensors: Sequence[str]) -> tuple[Recording, ...]:
    """The recordings with the samples of ``sensors`` that are refreshed by clocks of their own as
    they were half a period before their time stamps, which is their mean age, with a note."""
    found = tuple(recordings)
    for name in sensors:
        which = [i for i, one in enumerate(found) if name in one.sensors]
        clock = refresh([(found[i].t, found[i].sensors[name]) for i in which])
        for i, aged in zip(which, clock.each if clock else (), strict=bool(clock)):
            if clock is not None and aged is not None:
                moved = _moved(found[i], name, aged, clock.period)
                found = (*found[:i], moved, *found[i + 1 :])
    return found


def _moved(recording: Recording, name: str, aged: Aged, period: float) -> Recording:
    """One recording with the samples of one sensor put right."""
    values = np.where(aged.wrong, np.nan, recording.sensors[name] + aged.further)
    before, after = np.sqrt([aged.before, aged.after])
    rest = f", {aged.wrong.sum()} that fit neither are left out" if aged.wrong.any() else ""
    note = (
        f"{recording.name}: sensor {name} is refreshed every {1e3 * period:.3g} ms by a clock of "
        f"its own and read at other times, which is {100 * (1 - after / before):.0f} % of what a "
        f"smooth motion leaves of its samples; they are moved to one age{rest}"
    )
    sensors = {**recording.sensors, name: values}
    return replace(recording, sensors=sensors, notes=(*recording.notes, note))

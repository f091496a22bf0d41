"""One small picture of a study: the missing force over the motion, and the unseen recording.

Left ΔF of one coordinate (what the model lacks) with the law that was found; right the first
sensor of the first unseen recording, measured and in free runs before and after.
"""

from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.results import Cloud, Trace
from symhyb.model.types import Model, On
from symhyb.study.run import StudyResult
from symhyb.units import parse_unit

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes

Array = NDArray[np.float64]
MEASURED, BEFORE, AFTER, LAW = "#1f2933", "#d9812e", "#1f6fb2", "#b3261e"
POINTS = 1500  # of a cloud; more make a blot and a large file
SMALL = 0.1  # of the measured range: below it the errors of a run are drawn, not the run
ROOM = 0.6  # of the measured range, that a free run may leave it in the picture
ODD = 8  # points of a cloud at either side that may be far off
TICKS = 5
BINS = 40  # of a cloud along one axis
SWINGS = 60  # through the middle; of a run with more, a part is drawn


def draw(result: StudyResult, path: Path) -> None:
    """Draw a result as PNG."""
    diagnosis, verdict = result.diagnosis, result.verdict
    traces = [one for one in verdict.traces if one.role == "holdout"] or list(verdict.traces)
    style = {"font.size": 7.5, "axes.spines.top": False, "axes.spines.right": False}
    with plt.rc_context(style):
        figure, (left, right) = plt.subplots(1, 2, figsize=(7.0, 2.5), layout="constrained")
        clouds = _clouds(diagnosis.clouds)
        if clouds:
            _force(left, clouds, result.model)
        else:
            left.set_axis_off()
        if traces:
            _run(right, traces[0], result.model, bool(diagnosis.found))
        figure.savefig(path, dpi=90, pil_kwargs={"optimize": True}, metadata={"Software": None})
        plt.close(figure)


def _clouds(clouds: Sequence[Cloud]) -> list[Cloud]:
    """The clouds of the coordinate on which the found laws act most, one a recording."""
    if not clouds:
        return []
    place = max(clouds, key=lambda one: float(np.nanstd(one.law))).place
    return [one for one in clouds if one.place == place]


def _force(axes: Axes, clouds: Sequence[Cloud], model: Model) -> None:
    """ΔF over the place or the speed, whichever says more of it, in SI."""
    over = _axis(clouds)
    name = clouds[0].place.coordinate if isinstance(clouds[0].place, On) else "q"
    each = max(POINTS // len(clouds), 50)
    for number, cloud in enumerate(clouds):
        step = max(cloud.t.size // each, 1)
        size = 1.8 if cloud.t.size > 300 else 4.0
        place, force, law = (x[::step] for x in (getattr(cloud, over), cloud.force, cloud.law))
        say = {"label": "ΔF"} if number == 0 else {}
        axes.plot(place, force, ".", ms=size, color=MEASURED, alpha=0.5, mew=0, **say)
        if np.any(law != 0):
            say = {"label": "found"} if number == 0 else {}
            axes.plot(place, law, ".", ms=size + 0.4, color=LAW, mew=0, **say)
    both = np.concatenate([one.force for one in clouds])
    rare = min(max(ODD / both.size, 0.005), 0.05)
    low, high = np.nanquantile(both, [rare, 1 - rare])  # the rest is noise of the acceleration
    axes.set_ylim(low - 0.2 * (high - low), high + 0.2 * (high - low))
    places = np.concatenate([getattr(one, over) for one in clouds])
    left, right = np.nanquantile(places, [rare / 5, 1 - rare / 5])  # a spline may swing at its ends
    axes.set_xlim(left - 0.1 * (right - left), right + 0.1 * (right - left))
    length, strength = _units(model, name)
    label = f"{name}  [{length}]" if over == "stretch" else f"{name}'  [{length}/s]"
    axes.set(xlabel=label, ylabel=f"ΔF  [{strength}]", title="what the model lacks")
    axes.legend(frameon=False, markerscale=4)


def _axis(clouds: Sequence[Cloud]) -> str:
    """Of ``stretch`` and ``rate`` the one whose bins leave least of the found law, or where nothing
    was found of ΔF."""
    forces = np.concatenate([one.law for one in clouds])
    if not np.any(forces != 0):
        forces = np.concatenate([one.force for one in clouds])

    def left(axis: str) -> float:
        places = np.concatenate([getattr(one, axis) for one in clouds])
        edges = np.nanquantile(places, np.linspace(0, 1, BINS + 1)[1:-1])
        rows = np.searchsorted(edges, places)
        parts = [forces[rows == i] for i in np.unique(rows)]
        return sum(float(np.nanvar(part)) * part.size for part in parts)

    return min(("rate", "stretch"), key=left)


def _units(model: Model, name: str) -> tuple[str, str]:
    """SI units of a coordinate and of the force on it."""
    unit = next(one.unit for one in model.coordinates if one.name == name)
    if unit.same_dimension(parse_unit("m")):
        return "m", "N"
    return ("rad", "N·m") if unit.is_angle else (str(unit), "SI")


def _run(axes: Axes, trace: Trace, model: Model, found: bool) -> None:
    """One sensor along one recording, or the errors of the runs where these are small."""
    sensor = next(one for one in model.sensors if np.isfinite(trace.measured[one.name]).any())
    measured, before, after = (
        signals[sensor.name] / sensor.unit.factor
        for signals in (trace.measured, trace.before, trace.after)
    )
    low, high = float(np.nanmin(measured)), float(np.nanmax(measured))
    far, t = np.abs(before - measured), trace.t
    title = "unseen recording, free run" if trace.role == "holdout" else "free run"
    if np.all(np.isfinite(far) | np.isnan(measured)) and np.nanmax(far) < SMALL * (high - low):
        measured, before, after = measured - measured, before - measured, after - measured
        title += ": error"
    else:
        axes.set_ylim(low - ROOM * (high - low), high + ROOM * (high - low))
        part = _part(measured)
        if part != slice(0, t.size):
            t, measured, before, after = (x[part] for x in (t, measured, before, after))
            title += ", a part"
    axes.plot(t, measured, color=MEASURED, lw=1.6, alpha=0.6, label="measured")
    axes.plot(t, before, color=BEFORE, lw=0.7, label="as given")
    if found:
        axes.plot(t, after, color=AFTER, lw=0.7, label="corrected")
    axes.locator_params(axis="x", nbins=TICKS)
    axes.set(xlabel="t  [s]", ylabel=f"{sensor.name}  [{sensor.unit}]", title=title)
    axes.legend(frameon=False, ncols=3, fontsize=6.5)


def _part(measured: Array) -> slice:
    """All samples of a run, or where it swings too often to be seen those around its largest
    deflection that hold a third of ``SWINGS``."""
    about = np.nan_to_num(measured - np.nanmean(measured))
    swings = int(np.sum(np.diff(np.sign(about)) != 0))
    if swings <= SWINGS:
        return slice(0, measured.size)
    width = max(measured.size * SWINGS // (3 * swings), 8)
    middle = int(np.argmax(np.abs(about)))
    first = min(max(middle - width // 2, 0), measured.size - width)
    return slice(first, first + width)

"""Values on axes of matplotlib, for scripts and notebooks: what ``.plot()`` of each draws.

Every function takes a value and ``ax``: None makes a figure with a panel a thing; axes, or as many
in a row as there are panels, are drawn on; on a single one what belongs to several panels is drawn
together. They return what they drew on: one axes, or an array of them. Nothing is shown and nothing
is saved; that is the caller's. Signals are in the units of the model file.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.residual import Discrepancy
from symhyb.discrepancy.results import Cloud, Diagnosis
from symhyb.discrepancy.scored import Trace, Verdict
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.framed import Signal
from symhyb.model.types import place_text
from symhyb.model.vocabulary import force_unit, stretch_unit
from symhyb.numeric.runs.integrate import Trajectory
from symhyb.report.canvas import AFTER, BEFORE, LAW, MEASURED, QUIET
from symhyb.units import parse_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Panels = NDArray[Any]  # of axes
OVER = ("time", "rate", "place")
HEIGHT, WIDTH = 1.9, 6.4  # inches of a panel
TIME = "time [s]"


def draw_recording(value: Recording, ax: Any, channels: Sequence[str] = ()) -> Any:
    """Draw channels of a recording over time, by default all."""
    signals = _chosen(list(value.signals()), channels, value.name)
    return _over_time(value.t, signals, ax, value.name)


def draw_trajectory(value: Trajectory, ax: Any, names: Sequence[str] = ()) -> Any:
    """Draw signals of a run over time, by default sensors and coordinates."""
    every = list(value.signals())
    usual = [signal for signal in every if "'" not in signal[0]]
    signals = _chosen(every, names, "the run") if names else usual
    return _over_time(value.t, signals, ax, value.model.title if value.model else "")


def draw_trace(value: Trace, ax: Any, sensors: Sequence[str] = ()) -> Any:
    """Draw measured signals, and the simulated ones before and after a correction, over time."""
    signals = {name: (values, unit) for name, values, unit in value.signals()}
    known = list(value.measured)
    _require(sensors, known, value.recording)
    wanted = list(sensors or known)
    panels = _panels(ax, len(wanted), value.recording, shared=True)
    for panel, sensor in zip(_each(panels, len(wanted)), wanted, strict=True):
        for moment, color, width in (
            ("measured", MEASURED, 1.6),
            ("before", BEFORE, 1.1),
            ("after", AFTER, 1.1),
        ):
            if f"{sensor}_{moment}" in signals:
                values = signals[f"{sensor}_{moment}"][0]
                panel.plot(value.t, values, color=color, lw=width, label=moment)
        _name(panel, TIME, f"{sensor}{_bracketed(signals[f'{sensor}_measured'][1])}")
        _legend(panel)
    return _returned(panels, outer=ax is None)


def draw_verdict(value: Verdict, ax: Any, sensors: Sequence[str] = ()) -> Any:
    """Draw the first unseen recording of a verdict, else the first of the training.

    Raises:
        InputError: the verdict rests on no recording.
    """
    trace = value.shown_trace()
    if trace is None:
        raise InputError(Problem("there is nothing to draw: no recording was given to judge on"))
    return draw_trace(trace, ax, sensors)


def draw_discrepancy(
    value: Discrepancy, ax: Any, coordinates: Sequence[str] = (), over: str = ""
) -> Any:
    """Draw ΔF on coordinates with its band over time, and as dots over the rate or the place.

    Raises:
        InputError: an unknown coordinate, or something else to draw over.
    """
    known = [item.name for item in value.model.coordinates]
    _require(coordinates, known, value.recording)
    if over and over not in OVER:
        raise InputError(Problem(f"'{over}' is none of {', '.join(OVER)}", "over"))
    wanted = list(coordinates or known)
    ways = (over,) if over else ("time", "rate") if _many(ax, 2 * len(wanted)) else ("time",)
    signals = {name: (values, unit) for name, values, unit in value.signals()}
    panels = _panels(ax, len(wanted) * len(ways), value.recording)
    pairs = [(name, way) for name in wanted for way in ways]
    for panel, (name, way) in zip(_each(panels, len(pairs)), pairs, strict=True):
        force, unit = signals[f"dF_{name}"]
        if way == "time":
            sd = signals[f"dF_{name}_sd"][0]
            _band(panel, value.motion.t, force, sd)
            panel.plot(value.motion.t, force, color=QUIET, lw=0.8, label=f"ΔF on {name}")
            label = TIME
        else:
            across = f"{name}'" if way == "rate" else name
            seen, its = signals[across]
            panel.plot(seen, force, ".", color=QUIET, ms=3, label=f"ΔF on {name}")
            label = f"{across}{_bracketed(its)}"
        _name(panel, label, f"ΔF on {name}{_bracketed(unit)}")
        _legend(panel)
    return _returned(panels)


def draw_diagnosis(value: Diagnosis, ax: Any, causes: Sequence[str] = ()) -> Any:
    """Draw ΔF over the rate and over time, with the law that was found, at the places of causes.

    Raises:
        InputError: nothing was found that acts at a place.
        KeyError: an unknown cause.
    """
    found = [value.found[name] for name in causes] if causes else list(value.found)
    places = list(dict.fromkeys(one.element.place for one in found))
    clouds = [one for place in places for one in value.clouds if one.place == place]
    if value.model is None or not clouds:
        text = "there is nothing to draw: no law was found at a place"
        raise InputError(Problem(f"{text} ({value.verdict})"))
    ways = ("rate", "time") if _many(ax, 2 * len(clouds)) else ("rate",)
    panels = _panels(ax, len(clouds) * len(ways), value.verdict)
    pairs = [(cloud, way) for cloud in clouds for way in ways]
    for panel, (cloud, way) in zip(_each(panels, len(pairs)), pairs, strict=True):
        _cloud(panel, cloud, way, value)
    return _returned(panels)


def _cloud(panel: "Axes", cloud: Cloud, way: str, value: Diagnosis) -> None:
    """ΔF at one place with the law that was found there."""
    assert value.model is not None
    unit, said = force_unit(value.model, cloud.place), place_text(cloud.place)
    force, law = cloud.force / unit.factor, cloud.law / unit.factor
    if way == "time":
        _band(panel, cloud.t, force, cloud.band / unit.factor)
        panel.plot(cloud.t, force, color=QUIET, lw=0.8, label="ΔF")
        panel.plot(cloud.t, law, color=LAW, lw=1.1, label="found law")
        label = TIME
    else:
        pace = stretch_unit(value.model, cloud.place) / parse_unit("s")
        rate = cloud.rate / pace.factor
        panel.plot(rate, force, ".", color=QUIET, ms=3, label="ΔF")
        panel.plot(rate, law, ".", color=LAW, ms=2, label="found law")
        label = f"rate{_bracketed(pace.text)}"
    _name(panel, label, f"ΔF {said}{_bracketed(unit.text)}")
    _legend(panel)


def _over_time(t: NDArray[np.float64], signals: Sequence[Signal], ax: Any, title: str) -> Any:
    """Signals over the time ``t`` (N,) in s, one a panel, or together on the one axes given."""
    panels = _panels(ax, len(signals), title, shared=True)
    together = panels.size < len(signals)
    for panel, (name, values, unit) in zip(_each(panels, len(signals)), signals, strict=True):
        label = f"{name}{_bracketed(unit)}"
        panel.plot(t, values, lw=1.1, label=_label(label), color=None if together else MEASURED)
        _name(panel, TIME, "" if together else label)
    if together:
        _legend(panels[0])
    return _returned(panels, outer=ax is None)


def _chosen(signals: list[Signal], names: Sequence[str], title: str) -> list[Signal]:
    """The signals of these names, by default all, in the order asked for."""
    known = {signal[0]: signal for signal in signals}
    _require(names, list(known), title)
    return [known[name] for name in names] if names else signals


def _require(names: Sequence[str], known: Sequence[str], title: str) -> None:
    problems = [
        Problem(f"there is no '{name}' to draw{did_you_mean(str(name), known)}", file=title)
        for name in names
        if name not in known
    ]
    if problems:
        raise InputError(problems)


def _many(ax: Any, panels: int) -> bool:
    """Whether so many panels are there, or can be made."""
    return ax is None or np.size(ax) >= panels


def _panels(ax: Any, count: int, title: str, shared: bool = False) -> Panels:
    """The axes to draw on (P,): those given, or those of a new figure, with a ``shared`` time.

    Raises:
        InputError: things that are no axes, or fewer of them than there are panels, but for one.
    """
    from matplotlib.axes import Axes

    if ax is None:
        return _new(count, title, shared)
    given = np.atleast_1d(np.asarray(ax, dtype=object)).ravel()
    strange = [type(one).__name__ for one in given if not isinstance(one, Axes)]
    if strange:
        raise InputError(Problem(f"must be axes of matplotlib, not {strange[0]}", "ax"))
    if given.size not in (1, count):
        text = f"{count} panels are to be drawn; give one axes or {count}, not {given.size}"
        raise InputError(Problem(text, "ax"))
    return given


def _new(count: int, title: str, shared: bool) -> Panels:
    """The axes (P,) of a new figure, which pyplot knows, so that a notebook shows it."""
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(
        max(count, 1),
        1,
        squeeze=False,
        sharex=shared,
        figsize=(WIDTH, 0.6 + HEIGHT * max(count, 1)),
        layout="constrained",
    )
    figure.suptitle(title, parse_math=False)
    found: Panels = panels[:, 0]
    return found


def _each(panels: Panels, count: int) -> list[Any]:
    """A panel for each of so many things; the same one for all where there is but one."""
    return list(panels) if panels.size == count else [panels[0]] * count


def _returned(panels: Panels, outer: bool = False) -> Any:
    """One axes or an array of them; ``outer``: with a shared time, which the last panel names."""
    for panel in panels if outer else ():
        panel.label_outer()
    return panels[0] if panels.size == 1 else panels


def _band(
    panel: "Axes", t: NDArray[np.float64], middle: NDArray[np.float64], sd: NDArray[np.float64]
) -> None:
    panel.fill_between(t, middle - sd, middle + sd, color="#dfe4e8", lw=0, label="± one sd")


def _name(panel: "Axes", x: str, y: str) -> None:
    """Name both axes; a name may hold a dollar sign, which is no formula."""
    panel.set_xlabel(x, parse_math=False)
    panel.set_ylabel(y, parse_math=False)


def _legend(panel: "Axes") -> None:
    for text in panel.legend(loc="upper right", fontsize="small").get_texts():
        text.set_parse_math(False)


def _label(text: str) -> str:
    return f" {text}" if text.startswith("_") else text  # matplotlib hides what begins with it


def _bracketed(unit: str) -> str:
    return f" [{unit}]" if unit else ""

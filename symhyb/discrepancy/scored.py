"""How well models meet recordings, before and after a correction: scores and the runs they rest on.

Arrays are in coherent SI with time on axis 0. Sizes: N samples.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.evidence import Whiteness, Without
from symhyb.drawn import drawn
from symhyb.framed import SI, Signal, frame_of
from symhyb.shown import card, counted
from symhyb.units import Unit

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True)
class Score:
    """How well one model meets one set of recordings.

    ``force_nrmse`` by coordinate: RMS of ΔF over the range of ΔF before correction.
    ``force_residual`` by coordinate: ‖ΔF‖ / ‖applied force k_e‖, both through the same low-pass.
    ``window_nrmse``, ``free_run_nrmse`` by sensor: RMSE / (max − min) of the measurement.
    ``window_rmse``, ``free_run_rmse`` by sensor: the same in the sensor's unit.
    None: not computable.
    """

    force_nrmse: Mapping[str, float | None]
    force_residual: Mapping[str, float | None]
    window_nrmse: Mapping[str, float | None]
    window_rmse: Mapping[str, float | None]
    free_run_nrmse: Mapping[str, float | None]
    free_run_rmse: Mapping[str, float | None]


@dataclass(frozen=True, slots=True)
class Comparison:
    """One score before and one after the correction."""

    before: Score
    after: Score


@dataclass(frozen=True, slots=True, repr=False)
class Trace:
    """Measured and simulated signals of one recording (free run, initial states fitted).

    ``measured``, ``before``, ``after`` by sensor: (N,) in SI, NaN where missing; ``after`` equals
    ``before`` where nothing was corrected. ``failures`` are sentences of simulations that stopped;
    ``units`` by sensor are those of the model file, which frames and pictures show. ``band`` by
    sensor, where it is known: one standard deviation (N,) of ``after``, SI, from what the corrected
    numbers are uncertain by. ``motion`` and ``motion_before`` by coordinate, where they are known:
    (N,) in SI, the smoothed measured motion and that of ``before``.
    """

    recording: str
    role: Literal["train", "holdout"]
    t: NDArray[np.float64]
    measured: Mapping[str, NDArray[np.float64]]
    before: Mapping[str, NDArray[np.float64]]
    after: Mapping[str, NDArray[np.float64]]
    failures: tuple[str, ...] = ()
    units: Mapping[str, Unit] = field(default_factory=dict, compare=False)
    band: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    motion: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    motion_before: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    def __repr__(self) -> str:
        span = f"{self.t[0]:g} … {self.t[-1]:g} s" if self.t.size else "no time"
        sensors = counted("sensor", list(self.measured))
        return f"<Trace '{self.recording}' ({self.role}): {self.t.size} samples, {span}, {sensors}>"

    def signals(self) -> Iterator[Signal]:
        """``<sensor>_measured``, ``_before`` and ``_after`` of every sensor with values (N,) in the
        unit of the model file, and that unit."""
        for sensor in self.measured:
            unit = self.units.get(sensor)
            factor, text = (unit.factor, unit.text) if unit else (1.0, SI)
            moments = (("measured", self.measured), ("before", self.before), ("after", self.after))
            for moment, group in moments:
                if sensor in group:
                    yield f"{sensor}_{moment}", group[sensor] / factor, text

    def to_frame(self) -> "pd.DataFrame":
        """Measured and simulated signals in the units of the model file, as columns over the index
        ``t`` in s; ``attrs["units"]`` says which units."""
        return frame_of(self.t, self.signals(), name=self.recording, role=self.role)

    def plot(self, *sensors: str, ax: Any = None) -> Any:
        """Draw what was measured, before and after, over time, of ``sensors`` or of all: returns
        the axes of matplotlib, one a sensor; what is given as ``ax`` is drawn on
        (:mod:`symhyb.report.axes`)."""
        return drawn("trace", self, ax, sensors=sensors)


@dataclass(frozen=True, slots=True, repr=False)
class Verdict:
    """Scores before and after, how they were made, and which of them decides; whether what is left
    is noise (``whiteness``), and what free runs err ``without`` each found element."""

    window_s: float
    initial_states: str
    force_band_hz: float | None
    train: Comparison
    holdout: Comparison | None
    carries: str
    traces: tuple[Trace, ...] = ()
    whiteness: tuple[Whiteness, ...] = ()
    without: tuple[Without, ...] = ()

    def __str__(self) -> str:
        return self.carries

    def __repr__(self) -> str:
        unseen = [one.recording for one in self.traces if one.role == "holdout"]
        return f"<Verdict: {self.carries} {counted('unseen recording', unseen)}>"

    def _repr_html_(self) -> str:
        head = ("recordings", "score", "of", "before", "after", "unit")
        rows = [(r[0], r[1], r[2], _digits(r[3]), _digits(r[4]), r[5]) for r in self._rows()]
        failed = tuple(f"{one.recording}: {text}" for one in self.traces for text in one.failures)
        return card("Before and after the correction", self.carries, head, rows, failed)

    def to_frame(self) -> "pd.DataFrame":
        """All scores before and after, a row a score and sensor or coordinate. Shares (``nrmse``,
        ``residual``) have the unit 1, the errors of sensors (``rmse``) theirs; NaN: not
        computable."""
        import pandas as pd

        columns = ("recordings", "score", "of", "before", "after", "unit")
        frame = pd.DataFrame(list(self._rows()), columns=columns)
        return frame.astype({"before": float, "after": float})

    def plot(self, *sensors: str, ax: Any = None) -> Any:
        """Draw what was measured, before and after on the first unseen recording (of the training,
        where none is unseen), of ``sensors`` or of all: returns the axes of matplotlib, one a
        sensor; what is given as ``ax`` is drawn on (:mod:`symhyb.report.axes`)."""
        return drawn("verdict", self, ax, sensors=sensors)

    def shown_trace(self) -> Trace | None:
        """The first unseen recording, else the first of the training; None without any."""
        unseen = [one for one in self.traces if one.role == "holdout"]
        return next(iter([*unseen, *self.traces]), None)

    def _rows(self) -> Iterator[tuple[Any, ...]]:
        units = {name: unit.text for one in self.traces for name, unit in one.units.items()}
        for role, comparison in (("train", self.train), ("holdout", self.holdout)):
            for score in fields(Score) if comparison is not None else ():
                before = getattr(comparison.before, score.name)  # type: ignore[union-attr]
                after = getattr(comparison.after, score.name)  # type: ignore[union-attr]
                absolute = score.name.endswith("_rmse")
                for name, value in before.items():
                    unit = units.get(name, "") if absolute else "1"
                    yield role, score.name, name, value, after.get(name), unit


def _digits(value: float | None) -> str:
    return "" if value is None else f"{value:.4g}"

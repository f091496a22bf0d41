"""How far free runs of a corrected model may be off, and how far without each found element."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from symhyb.discrepancy.evidence import Correlations, Without
from symhyb.discrepancy.fitting.scores import Errors, free_run, free_scenario
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.discrepancy.recorded.signals import measured
from symhyb.model.types import Element, Model
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.known import machine_with
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import WindowModel

SAMPLES_MOST = 400_000  # of all the runs that bands, or errors without an element, take
RUNS_MOST = 3  # recordings on which an element is left out
ELEMENTS_MOST = 6


def bands_of(
    machine: Machine, runs: Sequence[Run], found: Errors, known: Correlations | None
) -> tuple[Array | None, ...]:
    """One standard deviation (N, m), SI, of the free run of each recording, which was ``found``,
    from what the numbers of the correction are uncertain by, to first order; its initial state is
    held.

    None without ``known`` correlations, where a run fails, and beyond ``SAMPLES_MOST`` samples.
    """
    named = {} if known is None else dict(zip(known.names, range(len(known.names)), strict=True))
    moved = [
        (named[item.path], column, item.si_sd)
        for column, item in enumerate(machine.model.all_parameters())
        if item.path in named and item.si_sd
    ]
    if known is None or not moved:
        return (None,) * len(runs)
    rows = [row for row, _, _ in moved]
    chosen = Correlations(tuple(known.names[row] for row in rows), known.matrix[np.ix_(rows, rows)])
    bands: list[Array | None] = []
    left = SAMPLES_MOST
    for run, scenario, first in zip(runs, found.scenarios, found.trajectories, strict=True):
        left -= run.recording.t.size * len(moved)
        known_here = machine_with(machine, run.recording.parameters)
        possible = left >= 0 and not first.reason
        bands.append(_band(known_here, scenario, first, moved, chosen) if possible else None)
    return tuple(bands)


def _band(
    machine: Machine,
    scenario: Scenario,
    first: Trajectory,
    moved: Sequence[tuple[int, int, float]],
    known: Correlations,
) -> Array | None:
    moves = []
    for _, column, sd in moved:
        p = machine.values.copy()
        p[column] += sd
        other = simulate(machine, scenario, p)
        if other.reason:
            return None
        moves.append(other.y - first.y)
    return known.spread(np.array(moves))


def without_each(
    model: Model, corrected: Model, runs: Sequence[Run], scenarios: Sequence[Scenario]
) -> tuple[Without, ...]:
    """What free runs of the ``scenarios`` err without each element that ``corrected`` adds to
    ``model``, in the unit of each sensor; initial states and all other numbers stay. On the first
    recordings, as many as are quickly done."""
    given = {element.name for element in model.elements}
    added = [element for element in corrected.elements if element.name not in given]
    used = list(zip(runs, scenarios, strict=True))[:RUNS_MOST]
    samples = sum(run.recording.t.size for run, _ in used)
    if not added or samples * min(len(added), ELEMENTS_MOST) > SAMPLES_MOST:
        return ()
    whole = build(as_sampled(corrected, [run.recording for run, _ in used]))
    found = []
    for element in added[:ELEMENTS_MOST]:
        machine, gone = _less(whole, element), {item.path for item in element.parameters}
        window = WindowModel(machine)
        same = machine.inner_states == whole.inner_states
        left = [
            measured(run.recording, machine)
            - free_run(machine, run, begun if same else free_scenario(window, run)).y
            for run, begun in ((_not_knowing(run, gone), begun) for run, begun in used)
        ]
        found.append(Without(element.name, _rmse(machine, np.concatenate(left))))
    return tuple(found)


def _not_knowing(run: Run, gone: Collection[str]) -> Run:
    """A run of whose recording nothing is known of parameters that are ``gone``."""
    known = {path: x for path, x in run.recording.parameters.items() if path not in gone}
    return replace(run, recording=replace(run.recording, parameters=known))


def _less(machine: Machine, element: Element) -> Machine:
    """The machine without one of its elements: its strengths are 0, which takes no lowering, or it
    is left out where it remembers or its strengths are no numbers of its own."""
    law, own = KINDS[element.kind], {item.name for item in element.parameters}
    texts = [str(text) for key in law.strengths if (text := element.value(key)) is not None]
    if law.states or not texts or not {*texts} <= own:
        model = machine.model
        rest = tuple(one for one in model.elements if one.name != element.name)
        return build(replace(model, elements=rest), keep=False)
    values = machine.values.copy()
    values[[machine.column(f"{element.name}.{text}") for text in texts]] = 0.0
    return replace(machine, values=values)


def _rmse(machine: Machine, left: Array) -> dict[str, float | None]:
    """The root mean square of what is left (N, m), SI, by sensor in its unit; None where a run
    stopped, or a sensor recorded nothing."""
    table: dict[str, float | None] = {}
    for sensor, column in zip(machine.model.sensors, left.T, strict=True):
        with np.errstate(over="ignore", invalid="ignore"):
            size = float(np.sqrt(np.nanmean(column**2))) if np.isfinite(column).any() else np.nan
        table[sensor.name] = size / sensor.unit.factor if np.isfinite(size) else None
    return table

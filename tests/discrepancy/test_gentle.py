"""Where a fit of dry friction begins: gentle first, then as steep as it is."""

from functools import cache

import numpy as np
import pytest
from rewritings import Writing, chains, multisine

from symhyb.discrepancy.fitting.gentle import SHARE, gentle
from symhyb.discrepancy.fitting.matching import fit
from symhyb.discrepancy.fitting.task import Task
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.windows import Cut, lay, turning
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.windows import WindowModel

T = np.arange(0, 8, 0.01)
LEVEL, STEEP = 2.0, 1e-4  # N, m/s: both masses move all the time, and the link sticks
FINE = 16
NEAR = 0.005  # of the level; the deviation of most of these fits is 0.1 to 0.16 % of it
WAYS = chains()


@cache
def rubbing(which: int, level: float = 1.0, **more: float) -> tuple[Machine, Cut]:
    """A chain of two masses with friction in its link, in one way of writing it, with the windows
    of a recording in which the friction is of ``LEVEL``."""
    way: Writing = WAYS[which]
    true = WAYS[0].with_law("friction", "link", coulomb=LEVEL, transition=STEEP)
    run = true.simulated(T, [0.01, -0.02], [0.1, 0.0], multisine(T, 8.0)[:, None])
    record = WAYS[0].recorded(run, {"f": multisine(T, 8.0)}, noise=0.002, seed=5)
    law = way.with_law("friction", "link", coulomb=level, transition=STEEP, **more)
    machine = build(law.model)
    motion = motion_of(record, build(way.model))
    cut = lay(record, machine, motion, 1.0)
    assert cut is not None
    return machine, Cut(
        cut.block, cut.start, cut.states, cut.held, cut.rows, cut.source, steps=1, fine=FINE
    )


def path_of(machine: Machine, key: str) -> str:
    (path,) = (item.path for item in machine.model.all_parameters() if item.name == key)
    return path


def test_a_law_that_is_steep_is_made_gentle() -> None:
    machine, cut = rubbing(0)
    softer = gentle(machine, [cut], machine.values)
    assert softer is not None
    column = machine.column(path_of(machine, "transition"))
    changed = np.flatnonzero(softer.p != machine.values)
    assert changed.tolist() == [column]
    rates = cut.source[1].v
    assert softer.p[column] == pytest.approx(SHARE * np.abs(rates[:, 1] - rates[:, 0]).max())
    assert not softer.kept


def test_a_level_that_falls_with_speed_is_kept() -> None:
    machine, cut = rubbing(0, static=1.5, stribeck=0.02)
    softer = gentle(machine, [cut], machine.values)
    assert softer is not None
    assert {machine.column(path_of(machine, key)) for key in ("coulomb", "static")} <= softer.kept


def test_what_is_gentle_stays_as_it_is() -> None:
    machine, cut = rubbing(0)
    wide = machine.values.copy()
    wide[machine.column(path_of(machine, "transition"))] = 1.0
    assert gentle(machine, [cut], wide) is None
    bare = build(WAYS[0].model)
    assert gentle(bare, [cut], bare.values) is None


@pytest.mark.parametrize("which", range(len(WAYS)), ids=[way.name for way in WAYS])
def test_friction_in_a_link_is_fitted_however_it_is_written(which: int) -> None:
    """Every window down to the noise, from a third and from three times the level.

    The deviation of the fit is no measure here: slopes where dry friction turns over differ with
    the rounding of a processor, and with them it does, from 0.0003 to 0.0033.
    """
    for first in (LEVEL / 3, 3 * LEVEL):
        machine, cut = rubbing(which, first)
        item = cut.suited(machine)
        sd = item.source[1].sd
        unbounded = np.full(1, np.inf)
        task = Task((item,), sd, np.zeros(1), unbounded, np.zeros(1), unbounded)
        model = WindowModel(machine, (machine.column(path_of(machine, "coulomb")),))
        found = fit(model, task, machine.values)
        assert not found.reason
        assert found.values[0] == pytest.approx(LEVEL, rel=NEAR)
        assert (found.chi2 / found.count).max() < 1.6


def test_steps_are_finer_where_the_link_turns_over() -> None:
    """At the same instants in every way, and not where either mass turns over."""
    found = []
    for which in range(len(WAYS)):
        machine, cut = rubbing(which)
        near = turning(machine, cut.source[1])
        found.append(near)
        parts = cut.suited(machine).block.substeps
        assert np.array_equal(parts, np.where(near[cut.rows[:, :-1]], FINE, 1))
    assert 0.05 < np.mean(found[0]) < 0.95
    for near in found[1:]:
        assert np.mean(near != found[0]) < 0.01
    bare = build(WAYS[0].model)
    assert not turning(bare, rubbing(0)[1].source[1]).any()

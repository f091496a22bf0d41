"""Where rivals would differ: simulated once from their fits, window by window, nothing fitted."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.correction.advice.rival_runs import rival_runs, simulated
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined, refine
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from symhyb.numeric.runs.windows import WindowModel
from tests.rigs import spring_model, spring_recording

X = On("x")
DAMPER = Hypothesis("damper", X, ("damping",), (True,))
DRAG = Hypothesis("drag", X, ("drag",), (True,))
LATE = Hypothesis("delay", None, (), (False,), path="laser.delay")


@pytest.fixture(scope="module")
def setting() -> Setting:
    return settle(prepare(spring_model(), spring_recording(3, {"drag": 2.0}, duration=6.0)))


def fitted(setting: Setting, *causes: Hypothesis) -> Refined:
    rows = [dict.fromkeys(cause.keys, 0.5) if cause.place else {"value": 0.0} for cause in causes]
    model = setting.windows.machine.model
    return refine(model, causes, rows, setting.stages[-1].cuts, setting.sd)


def decided(selected: Refined, *rivals: tuple[Refined, float]) -> Decision:
    trials = (selected, *(trial for trial, _ in rivals))
    return Decision(selected, selected, trials, (), (), judged=((selected, 0.0), *rivals))


def test_a_rival_is_simulated_from_its_own_fit(setting: Setting) -> None:
    drag, damper = fitted(setting, DRAG), fitted(setting, DAMPER)
    (run,) = rival_runs(setting, decided(drag, (damper, 3.0)))
    assert (run.causes, run.instead_of) == (
        "viscous damping on x",
        "drag quadratic in speed on x",
    )
    assert (run.evidence, run.recording) == (3.0, "rig.csv")
    assert run.probability == pytest.approx(1 / (1 + np.exp(1.5)))
    (item,) = setting.stages[-1].cuts
    sides = []
    for trial in (damper, drag):
        suited = item.suited(trial.machine)
        _, y = WindowModel(trial.machine).simulate(suited.block, trial.fit.starts[0], trial.p)
        sides.append(y[..., 0])
    inside = item.rows[:, 1:-1]
    assert run.apart["laser"][inside] == pytest.approx((sides[0] - sides[1])[:, 1:-1])
    assert np.isnan(np.delete(run.apart["laser"], np.unique(item.rows))).all()
    assert run.noise == {"laser": pytest.approx(setting.sd[0])}


def test_where_two_differ_most_is_told_in_units_of_the_noise(setting: Setting) -> None:
    drag, damper = fitted(setting, DRAG), fitted(setting, DAMPER)
    (run,) = rival_runs(setting, decided(drag, (damper, 3.0)))
    sensor, time, deviations = run.largest
    peak = int(np.nanargmax(np.abs(run.apart["laser"])))
    assert (sensor, time) == ("laser", run.t[peak])
    assert deviations == pytest.approx(run.apart["laser"][peak] / setting.sd[0])
    assert 0 < run.typical["laser"] < abs(deviations)


def test_what_a_late_sensor_shows_is_held_against_the_same_sample(setting: Setting) -> None:
    """A delay of three samples is taken from windows that begin three samples later."""
    late = fitted(setting, LATE)
    column = late.machine.column("laser.delay")
    step = float(np.median(np.diff(setting.stages[-1].cuts[0].block.t, axis=1)))
    p, still = late.p.copy(), late.p.copy()
    p[column], still[column] = 3 * step, 0.0
    (item,) = setting.stages[-1].cuts
    moved, of = simulated(replace(late, p=p), 0, item)
    plain, _ = simulated(replace(late, p=still), 0, item)
    window = np.flatnonzero(of[:, 0] == 0)[1:-1]
    assert window[0] == item.rows[0, 1] + 3
    assert moved[window, 0] == pytest.approx(plain[window - 3, 0], abs=1e-9)


def test_rivals_out_of_reach_and_structures_alone_are_not_told(setting: Setting) -> None:
    drag, damper = fitted(setting, DRAG), fitted(setting, DAMPER)
    assert rival_runs(setting, decided(drag)) == ()
    assert rival_runs(setting, decided(drag, (damper, 50.0))) == ()


def test_three_rivals_at_most_the_most_probable_first(setting: Setting) -> None:
    """Other causes that fit as the damper does, for the sake of their names."""
    drag, damper = fitted(setting, DRAG), fitted(setting, DAMPER)
    named = [
        replace(damper, causes=(Hypothesis(kind, X, ("damping",), (True,)),))
        for kind in ("power", "friction", "spring", "constant")
    ]
    rivals = zip(named, (6.0, 2.0, 8.0, 4.0), strict=True)
    runs = rival_runs(setting, decided(drag, *rivals))
    assert [run.evidence for run in runs] == [2.0, 4.0, 6.0]
    chances = [run.probability for run in runs]
    assert chances == sorted(chances, reverse=True)


def test_the_same_law_in_another_shape_is_said_to_be_that(setting: Setting) -> None:
    damper = fitted(setting, DAMPER)
    other = replace(damper, causes=(replace(DAMPER, options=(("by", "direction"),)),))
    (run,) = rival_runs(setting, decided(damper, (other, 1.0)))
    assert run.causes == "viscous damping on x of another shape"
    assert np.nanmax(np.abs(run.apart["laser"])) == 0.0


def test_what_cannot_be_simulated_is_not_told(setting: Setting) -> None:
    drag, damper = fitted(setting, DRAG), fitted(setting, DAMPER)
    lost = replace(damper, fit=replace(damper.fit, starts=(damper.fit.starts[0] * np.nan,)))
    assert rival_runs(setting, decided(drag, (lost, 3.0))) == ()


def test_what_convention_alone_ranks_has_no_probability(setting: Setting) -> None:
    damper = fitted(setting, DAMPER)
    late, early = (
        replace(damper, causes=(Hypothesis("delay", None, ("value",), (False,), path=path),))
        for path in ("f.delay", "laser.delay")
    )
    (run,) = rival_runs(setting, decided(late, (early, -9.0)))
    assert (run.evidence, run.probability) == (0.0, None)

"""What to record next: the signals, what evidence is enough, and what a matrix says."""

from dataclasses import replace

import numpy as np
import pytest
from rigs import spring_model, spring_recording

import symhyb as sh
from symhyb.correction.advice.isolability import isolability
from symhyb.correction.advice.manoeuvre import Rivals, needed_evidence
from symhyb.correction.advice.offers import natural_frequencies, offers, rounded
from symhyb.correction.advice.playing import played
from symhyb.correction.advice.signals import signal_of
from symhyb.correction.search.force_screen import force_screen
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.trajectory import refine
from symhyb.discrepancy.results import Manoeuvre, SignalName

PLAN = Manoeuvre("f", "sine", 4.0, "N", 10.0, 0.01, (0.5, 4.0), offset=1.0)
T = np.arange(1001) / 100


@pytest.mark.parametrize("signal", ["sine", "sweep", "multisine", "steps", "triangle"])
def test_a_signal_keeps_to_its_peak_about_its_offset(signal: SignalName) -> None:
    wave = signal_of(replace(PLAN, signal=signal), T) - PLAN.offset
    assert np.abs(wave).max() == pytest.approx(4.0, rel=0.01)


def test_a_sweep_runs_from_its_first_to_its_last_frequency() -> None:
    wave = signal_of(replace(PLAN, signal="sweep", offset=0.0), T)
    crossings = T[1:][(wave[1:] >= 0) & (wave[:-1] < 0)]
    assert 1 / np.diff(crossings)[-1] == pytest.approx(4.0, rel=0.1)
    # turns of a sweep that is even in octaves: (f2 - f1) T / ln(f2/f1)
    assert crossings.size == pytest.approx(3.5 * 10 / np.log(8), abs=1)


def test_a_release_drives_nothing() -> None:
    assert not signal_of(replace(PLAN, signal="release", frequency=None), T).any()


def test_round_numbers_never_ask_for_more() -> None:
    assert rounded(0.0389) == 0.038
    assert rounded(-12.7) == -12.0


def test_what_was_recorded_bounds_what_is_asked_for() -> None:
    run = spring_recording(5, {"drag": 2.0}, duration=6.0)
    model = spring_model()
    prepared = prepare(model, run)
    (frequency,) = natural_frequencies(prepared, prepared.machine)
    assert frequency == pytest.approx(np.sqrt(200 / 1.3) / (2 * np.pi), rel=1e-6)
    plans = offers(prepared, prepared.machine)
    peak = np.abs(run.inputs["f"]).max()
    driven = [plan for plan in plans if plan.channel == "f"]
    assert {plan.signal for plan in driven} >= {"sine", "sweep", "multisine", "steps", "triangle"}
    assert all(plan.beyond == (plan.amplitude > peak) for plan in driven)
    assert all(plan.amplitude <= 3 * peak and plan.duration <= 18 for plan in driven)

    setting = settle(prepared)
    nothing = refine(prepared.model, (), (), setting.stages[0].cuts, setting.sd)
    release = Manoeuvre("x", "release", 0.01, "m", 3.0, 0.005)
    recording, motion = played(prepared, nothing, release)
    # m x'' + d x' + k x = 0 let go at 0.01 m
    decay, swing = 0.8 / 2.6, np.sqrt(200 / 1.3 - (0.8 / 2.6) ** 2)
    t = recording.t
    exact = np.cos(swing * t) + decay / swing * np.sin(swing * t)
    middle = np.median(prepared.runs[0].motion.q)
    begun = 0.01 + middle  # away from where it was on the whole
    assert motion.q[:, 0] == pytest.approx(begun * np.exp(-decay * t) * exact, abs=1e-4 * begun)

    pair = Rivals(nothing, nothing, ("a", "b"))
    least = needed_evidence(pair, 400)
    # two standard deviations below, the odds are still 100 to 1
    assert least - 2 * np.sqrt(2 * least) == pytest.approx(np.log(100))
    assert needed_evidence(pair, 8000) == pytest.approx(np.sqrt(4000))  # half the deviation of χ²


@pytest.mark.slow
def test_the_matrix_knows_twins_and_what_stands_out() -> None:
    from symhyb.correction.search.decide import decide
    from symhyb.correction.search.setting import around

    prepared = prepare(spring_model(), spring_recording(5, {"drag": 2.0}, duration=8.0))
    setting = settle(prepared)
    middle = setting.stages[min(1, len(setting.stages) - 1)]
    found = force_screen(prepared.machine, setting.library, middle.cuts, 5 / prepared.shortest)
    decision = decide(setting, found, lambda line: None)
    matrix = isolability(setting, decision, lambda: around(setting, decision.selected))
    assert matrix is not None
    assert matrix.causes[0] == "drag quadratic in speed on x"
    assert matrix.found[0]
    assert np.isnan(np.diag(matrix.evidence)).all()
    others = matrix.evidence[~np.eye(len(matrix.causes), matrix.evidence.shape[1], dtype=bool)]
    assert np.all(others >= 0)
    assert np.nanmin(matrix.evidence[0]) > np.log(100)  # a multisine of many speeds tells drag
    assert matrix.evidence[0, -1] == np.nanmax(matrix.evidence[0])  # nothing imitates it least


def test_a_recording_that_is_too_short_is_asked_for_longer() -> None:
    diagnosis = sh.diagnose(spring_model(), spring_recording(9, {}, duration=0.3))
    assert diagnosis.record_next is not None
    assert "ten periods of the slowest motion" in diagnosis.record_next
    assert diagnosis.manoeuvre is None

"""Whether a decided structure is judged rightly: what acts beyond it, of which class, what is left
of its claims."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.signal import cont2discrete, dlsim

import symhyb as sh
from symhyb.correction.adequacy import judge
from symhyb.correction.adequacy.agreement import Disputed
from symhyb.correction.adequacy.beyond import NOTHING
from symhyb.correction.adequacy.classes.law import law
from symhyb.correction.adequacy.classes.worth import around
from symhyb.correction.adequacy.followed import Along
from symhyb.correction.adequacy.judge import TOO_SHORT, Adequacy, Decided, adequacy
from symhyb.correction.adequacy.recorded import Recorded, recorded
from symhyb.correction.adequacy.structure import Fitted, Row, fitted
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined, refine
from symhyb.correction.verdict import decided as story
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.results import Change
from symhyb.judgement import CERTAIN, PROBABLE
from symhyb.model.types import On
from tests.builders import DRIVEN_MASS
from tests.pushed import (
    DAMPING,
    NOISE,
    STEP,
    STIFFNESS,
    markov,
    pushed,
    pushed_model,
    pushing,
    setting_of,
)

SAMPLES = 1000
DAMPER = Hypothesis("damper", On("x"), ("damping",), (True,))
DELAY = Hypothesis("delay", None, ("value",), (False,), path="f.delay")
TONE = (("frequency", 0.12),)
NUMBER = Hypothesis("parameter", None, ("value",), (False,), path="k")
GAIN = Hypothesis("gain", None, ("value",), (False,), path="f.gain")


def judged(recording: Recording, *decided: tuple[Hypothesis, Mapping[str, float]]) -> Adequacy:
    """The judgement of a structure that was decided on a recording."""
    prepared = prepare(pushed_model(), recording)
    setting = settle(prepared)
    causes, rows = [cause for cause, _ in decided], [row for _, row in decided]
    final = refine(prepared.model, causes, rows, setting.stages[-1].cuts, setting.sd)
    return adequacy(prepared, setting, final, (final, setting.stages[-1].cuts))


def saturated(seed: int) -> Recording:
    """The recorded push acts by 4 tanh(f/4)."""
    force = pushing(np.random.default_rng(seed), STEP * np.arange(SAMPLES))
    return pushed(seed, samples=SAMPLES, beside=4 * np.tanh(force / 4) - force)


@pytest.mark.parametrize("colour", [(0.0, 1.0), (5 * NOISE, 0.1)])
def test_a_model_that_is_right_is_adequate(colour: tuple[float, float]) -> None:
    found = judged(pushed(11, samples=SAMPLES, colour=colour))
    assert found.adequate
    assert not found.doubt


def test_what_could_not_be_judged_is_not_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    made = pushed(11, samples=SAMPLES)
    assert sh.diagnose(pushed_model(), made).verdict == "nothing missing"
    monkeypatch.setattr(judge, "recorded", lambda *_: None)
    assert not judged(made).adequate
    diagnosis = sh.diagnose(pushed_model(), made)
    assert diagnosis.verdict == "undecided"
    assert diagnosis.sentence.startswith("No cause that symhyb knows earned its place. Whether")
    assert TOO_SHORT in diagnosis.sentence


def test_what_is_disputed_is_an_alternative_and_not_reported_apart(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = pushed(12, samples=SAMPLES, damping=1.4)
    (found,) = sh.diagnose(pushed_model(), made).found

    def disputing(
        prepared: Prepared, setting: Setting, final: Refined, windows: Along, along: Fitted | None
    ) -> Adequacy:
        one = tuple(Disputed(cause, (0.8, 0.01), (2.0, 0.1), None) for cause in final.causes)
        judgement = adequacy(prepared, setting, final, windows, along)
        return replace(judgement, doubt=frozenset(final.causes), disputed=one)

    monkeypatch.setattr(story, "adequacy", disputing)
    diagnosis = sh.diagnose(pushed_model(), made)
    assert (diagnosis.verdict, diagnosis.found) == ("undecided", ())
    assert found.element.kind in {one.kind for one in diagnosis.alternatives}
    assert "beside an unknown force: it only stands in for something else" in diagnosis.sentence
    assert diagnosis.isolability is not None
    assert not any(diagnosis.isolability.found)


def test_a_law_that_is_right_is_adequate_and_stays() -> None:
    found = judged(pushed(12, samples=SAMPLES, damping=1.4), (DAMPER, {"damping": 0.5}))
    assert found.adequate
    assert not found.doubt


def test_an_unmeasured_force_acts_and_is_of_no_other_class() -> None:
    planted = markov(np.random.default_rng(13), SAMPLES, 0.8, 0.2)
    found = judged(pushed(13, samples=SAMPLES, beside=planted))
    assert found.beyond.acts
    assert not found.adequate
    assert found.class_probability < 0.5


@pytest.mark.slow
def test_an_input_that_saturates_is_its_class_and_takes_the_gain_with_it() -> None:
    alone = judged(saturated(14))
    assert alone.classes[0][0].kind == "input"
    assert alone.classes[0][1] > PROBABLE
    with_gain = judged(saturated(14), (GAIN, {"value": -0.2}))
    assert with_gain.classes[0][0].kind == "input"
    assert GAIN in with_gain.doubt


def test_a_law_that_only_imitates_a_class_is_in_doubt() -> None:
    """The damping falls with speed; a damper is the best of the list."""
    t = STEP * np.arange(SAMPLES)
    force = pushing(np.random.default_rng(15), t)
    x, v, positions = 0.0, 0.0, []
    fine = 40
    for i in range(SAMPLES):
        positions.append(x)
        following = force[min(i + 1, SAMPLES - 1)]
        for j in range(fine):
            push = force[i] + (following - force[i]) * j / fine
            v += STEP / fine * (push - 25.0 * x - 0.6 * v - 1.5 * np.tanh(v / 0.15))
            x += STEP / fine * v
    noise = NOISE * np.random.default_rng(16).standard_normal(SAMPLES)
    seen = Recording("made.csv", t, {"f": force}, {"laser": np.array(positions) + noise}, (), "")
    found = judged(seen, (DAMPER, {"damping": 1.0}))
    assert not found.adequate
    assert found.classes[0][0].kind == "law"
    assert DAMPER in found.doubt


def held(seed: int) -> Recording:
    """The machine sees each value of the recorded push until the next."""
    t = STEP * np.arange(SAMPLES)
    force = pushing(np.random.default_rng(seed), t)
    A, B = np.array([[0.0, 1.0], [-STIFFNESS, -DAMPING]]), np.array([[0.0], [1.0]])
    discrete = cont2discrete((A, B, np.array([[1.0, 0.0]]), np.zeros((1, 1))), STEP, "zoh")
    _, x, _ = dlsim((*discrete[:4], STEP), force[:, None])
    noise = 0.1 * NOISE * np.random.default_rng(seed + 1).standard_normal(SAMPLES)
    return Recording("made.csv", t, {"f": force}, {"laser": x[:, 0] + noise}, (), "")


def test_a_delay_of_half_a_sample_is_held_against_a_staircase() -> None:
    found = judged(held(18), (DELAY, {"value": 0.4 * STEP}))
    assert found.classes[0].generic.does == "holds"
    assert found.classes[0].probability > PROBABLE
    assert DELAY in found.doubt


def test_a_delay_that_is_one_stays() -> None:
    """A whole sample late: as late as a staircase of two samples is on average."""
    made = pushed(19, samples=SAMPLES)
    force = made.inputs["f"]
    late = replace(made, inputs={"f": np.append(force[1:], force[-1])})
    found = judged(late, (DELAY, {"value": 0.9 * STEP}))
    assert DELAY not in found.doubt


def test_a_law_without_which_an_unknown_force_is_likelier_is_in_doubt() -> None:
    """A push that nobody recorded, once: a harmonic force looks like it as long as it lasts."""
    t = STEP * np.arange(SAMPLES)
    bump = 3.0 * np.exp(-(((t - 10) / 1.5) ** 2))
    tone = Hypothesis("harmonic", On("x"), ("sine", "cosine"), (False, False), TONE, ("frequency",))
    made = pushed(20, samples=SAMPLES, beside=bump)
    found = judged(made, (tone, {"amplitude": 1.0, "frequency": 0.12, "phase": 0.0}))
    assert found.beyond.acts
    assert tone in found.doubt


@pytest.mark.parametrize("explains", [True, False])
def test_a_class_that_explains_too_little_speaks_against_no_law(
    explains: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It takes nine tenths of the damping, and all or nothing of what acts beyond."""

    def raced(
        ground: Recorded, start: Fitted, rows: Sequence[Row], decided: Decided
    ) -> list[Fitted]:
        if not start.causes:
            return []
        extra = law(around(ground, start), ground.library.places.index(On("x")))
        noise, values = start.fit.noise, start.fit.values
        part = 0.0 if explains else 1.0
        force, shown = part * noise.force, part * start.fit.force
        less = np.concatenate([0.1 * values[:1], values[1:], np.zeros(extra.spread.size)])
        wider = np.pad(start.fit.covariance, (0, extra.spread.size))
        noise = replace(noise, force=force)
        fit = replace(start.fit, values=less, covariance=wider, noise=noise, force=shown)
        return [replace(start, evidence=start.evidence + 50.0, fit=fit, extra=extra)]

    monkeypatch.setattr(judge, "_raced", raced)
    planted = markov(np.random.default_rng(23), SAMPLES, 0.3, 0.2)
    found = judged(
        pushed(23, samples=SAMPLES, damping=2.0, beside=planted), (DAMPER, {"damping": 1.0})
    )
    assert found.beyond.acts
    assert [one.cause for one in found.disputed] == ([DAMPER] if explains else [])


@pytest.mark.parametrize(("ahead", "force"), [(50.0, 1.0), (50.0, 0.0), (3.0, 1.0)])
def test_colour_of_a_sensor_hides_no_force_that_a_likelier_structure_shows(
    ahead: float, force: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A class that explains too little to be the answer is likelier than all that explains, by 50
    or 3 in ln, with an unknown force beside it or none."""

    def raced(
        ground: Recorded, start: Fitted, rows: Sequence[Row], decided: Decided
    ) -> list[Fitted]:
        extra = law(around(ground, start), ground.library.places.index(On("x")))
        noise, wider = start.fit.noise, np.pad(start.fit.covariance, (0, extra.spread.size))
        values = np.concatenate([start.fit.values, np.zeros(extra.spread.size)])
        noise = replace(noise, force=force * ground.scale, colour=100 * noise.colour)
        fit = replace(start.fit, values=values, covariance=wider, noise=noise)
        return [replace(start, evidence=start.evidence + ahead, fit=fit, extra=extra)]

    monkeypatch.setattr(judge, "_raced", raced)
    made = pushed(24, samples=SAMPLES, damping=1.2, colour=(2 * NOISE, 0.1))
    found = judged(made, (DAMPER, {"damping": 0.6}))
    shown = ahead > CERTAIN and force > 0
    assert found.beyond.acts == shown
    assert found.adequate == (not shown)
    assert not found.classes


def test_what_a_class_may_leave_depends_on_what_it_replaces() -> None:
    made = pushed(22, samples=SAMPLES, damping=1.2)
    ground = setting_of(pushed_model(), made)
    row = {"damping": 0.6}
    having = fitted(ground, (DAMPER,), (row,), ground.first_noise())
    lacking = fitted(ground, (), (), ground.first_noise())
    left = np.array([1e-2, 4e-3])
    quiet, loud = Decided(having, left, False), Decided(having, left, True)
    assert quiet.may_leave(having, 0.1) == pytest.approx(0.1 * left)  # beside, it takes something
    assert quiet.may_leave(lacking, 0.1) == pytest.approx(left)
    assert loud.may_leave(lacking, 0.1) == pytest.approx(0.1 * left)
    nothing = Decided(having, np.zeros(2), False)
    assert (nothing.may_leave(having, 0.1) > 0).all()  # nothing that is worth a word


def test_what_acts_in_a_part_is_judged_there() -> None:
    prepared = prepare(pushed_model(), pushed(21, samples=SAMPLES))
    setting = settle(prepared)
    whole = recorded(prepared, setting)
    assert whole is not None
    begun = replace(setting, change=Change("pushed.csv", 5.0, 0.1, "begins"))
    part = recorded(prepared, begun)
    assert part is not None
    (item,) = part.items
    assert item.block.t[0, 0] == pytest.approx(5.0, abs=STEP)
    assert item.block.t[0, -1] == whole.items[0].block.t[0, -1]
    assert np.array_equal(item.start, item.states[:, 0])
    ended = replace(setting, change=Change("pushed.csv", 5.0, 0.1, "ends"))
    other = recorded(prepared, ended)
    assert other is not None
    assert other.items[0].rows.size + item.rows.size == whole.items[0].rows.size
    elsewhere = replace(setting, change=Change("another.csv", 5.0, 0.1, "ends"))
    same = recorded(prepared, elsewhere)
    assert same is not None
    assert same.items[0].rows.size == whole.items[0].rows.size


@pytest.mark.slow
def test_a_law_that_is_small_against_what_acts_beyond_is_in_doubt() -> None:
    planted = markov(np.random.default_rng(17), SAMPLES, 3.0, 0.3)
    found = judged(
        pushed(17, samples=SAMPLES, damping=0.9, beside=planted), (DAMPER, {"damping": 0.3})
    )
    assert found.beyond.acts
    assert DAMPER in found.doubt


@pytest.mark.parametrize(("stiffness", "small"), [(25.6, True), (40.0, False)])
def test_so_is_a_parameter_whose_change_exerts_as_little(stiffness: float, small: bool) -> None:
    """0.2 and 5 N RMS, where 1.6 N act beyond."""
    planted = markov(np.random.default_rng(17), SAMPLES, 1.5, 0.3)
    made = pushed(17, samples=SAMPLES, stiffness=stiffness, beside=planted)
    prepared = prepare(pushed_model(DRIVEN_MASS.replace("sd = 0.5", "sd = 10.0")), made)
    setting = settle(prepared)
    cuts = setting.stages[-1].cuts
    final = refine(prepared.model, [NUMBER], [{"value": stiffness}], cuts, setting.sd)
    ground = recorded(prepared, setting)
    assert ground is not None
    left = adequacy(prepared, setting, final, (final, cuts)).beyond
    assert left.acts
    assert (NUMBER in judge._small(final, ground, left)) == small
    assert NUMBER not in judge._small(final, ground, NOTHING)


def test_an_empirical_law_is_no_parameter_whose_change_exerts_little() -> None:
    """Its path is a formula: it is held against what acts beyond as the other laws are."""
    planted = markov(np.random.default_rng(17), SAMPLES, 1.5, 0.3)
    made = pushed(17, samples=SAMPLES, damping=0.9, beside=planted)
    formula = Hypothesis("law", On("x"), ("coefficient",), (False,), path="x'")
    found = judged(made, (formula, {"coefficient": 0.3}))
    assert found.beyond.acts
    assert formula in found.doubt


def test_a_law_whose_force_is_an_error_of_the_numerics_is_in_doubt() -> None:
    """Of the damping there, a ten-thousandth is missing."""
    found = judged(pushed(11, samples=SAMPLES, damping=0.6 + 6e-5), (DAMPER, {"damping": 6e-5}))
    assert not found.beyond.acts
    assert DAMPER in found.doubt
    assert not judged(pushed(11, samples=SAMPLES, damping=0.7), (DAMPER, {"damping": 0.1})).doubt


def test_no_class_takes_the_place_of_a_strength_of_each_recording(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tried, first, others = [], judge.fitted, judge.fitted_on

    def fitted(ground: Recorded, causes: Sequence[Hypothesis], *rest: Any, **more: Any) -> Fitted:
        tried.append(set(causes))
        return first(ground, causes, *rest, **more)

    def fitted_on(
        ground: Recorded, start: Fitted, causes: Sequence[Hypothesis], *rest: Any
    ) -> Fitted:
        tried.append(set(causes))
        return others(ground, start, causes, *rest)

    recordings = [replace(saturated(seed), name=f"{seed}.csv") for seed in (21, 22)]
    prepared = prepare(pushed_model(), recordings, own=("damping",))
    setting = settle(prepared, ("damping",))
    damper = replace(DAMPER, own=("damping",))
    assert damper in setting.hypotheses
    cuts = setting.stages[-1].cuts
    final = refine(prepared.model, [damper], [{"damping": 0.1}], cuts, setting.sd)
    monkeypatch.setattr(judge, "fitted", fitted)
    monkeypatch.setattr(judge, "fitted_on", fitted_on)
    found = adequacy(prepared, setting, final, (final, cuts))
    assert [one.generic.kind for one in found.classes] == ["input"]
    assert tried
    assert all(damper in causes for causes in tried)

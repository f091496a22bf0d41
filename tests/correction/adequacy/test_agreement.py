"""A strength that is real is the same by every estimator; what stands in for another is not."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lsim

from symhyb.correction.adequacy.agreement import Disputed, disputed
from symhyb.correction.adequacy.classes.hidden_mode import hidden_mode
from symhyb.correction.adequacy.classes.law import law
from symhyb.correction.adequacy.classes.worth import around
from symhyb.correction.adequacy.structure import Fitted, fitted
from symhyb.correction.naming.dispute_words import dispute_sentence
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.trajectory import Refined, grouped, refine
from symhyb.data.recording import Recording, several
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
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
HALVES = {"first": (0.0, 0.5 * SAMPLES * STEP), "second": (0.5 * SAMPLES * STEP, SAMPLES * STEP)}
MASS = Hypothesis("added_mass", On("x"), ("mass",), (True,))
DAMPER = Hypothesis("damper", On("x"), ("damping",), (True,))


def with_hidden_mode() -> Recording:
    """A mass of 0.15 kg hangs on a spring, 2.5 Hz by itself."""
    mass, w, t = 0.15, 2 * np.pi * 2.5, STEP * np.arange(SAMPLES)
    k, d = mass * w**2, 0.1 * mass * w
    A = [
        [0, 1, 0, 0],
        [-STIFFNESS - k, -DAMPING - d, k, d],
        [0, 0, 0, 1],
        [k / mass, d / mass, -k / mass, -d / mass],
    ]
    random = np.random.default_rng(3)
    force = pushing(random, t)
    _, x, _ = lsim((A, [[0], [1], [0], [0]], [[1, 0, 0, 0]], [[0]]), force, t)
    seen = x + NOISE * random.standard_normal(SAMPLES)
    return Recording("made.csv", t, {"f": force}, {"laser": seen}, (), "")


def estimated(
    runs: Recording | Sequence[Recording],
    causes: Sequence[Hypothesis],
    rows: Sequence[Mapping[str, float]],
) -> tuple[Refined, list[Fitted]]:
    """A structure by windows; by innovations, and so with a hidden mode and a force of any law."""
    recordings = several(runs)
    prepared = prepare(pushed_model(), recordings)
    setting = settle(prepared)
    final = refine(prepared.model, causes, rows, setting.stages[-1].cuts, setting.sd)
    ground = setting_of(pushed_model(), *recordings)
    base = fitted(ground, causes, grouped(final), ground.first_noise())
    noise, start = ground.revived(base.fit.noise), around(ground, base)
    which = ground.library.places.index(On("x"))
    others = [
        fitted(ground, causes, grouped(final), noise, base.fit.states, extra=maker(start, which))
        for maker in (hidden_mode, law)
    ]
    return final, [base, *others]


@pytest.mark.slow
def test_an_added_mass_that_is_a_hidden_mode_is_disputed() -> None:
    final, (base, mode, force) = estimated(with_hidden_mode(), [MASS], [{"mass": 0.1}])
    (one,) = disputed(final, [base, mode, force])
    assert one.cause == MASS
    assert one.beside is mode.extra
    assert one.another[0] == mode.fit.values[0]
    assert abs(one.another[0] - one.claimed[0]) > 0.5 * abs(one.claimed[0])
    said = dispute_sentence(pushed_model(), one)
    assert said.startswith("Added mass on x would be ")
    assert "kg beside a hidden mode: it only stands in for something else" in said


@pytest.mark.slow
def test_a_mass_that_is_a_hidden_mode_is_disputed_though_each_recording_has_its_own() -> None:
    """What stands in for a mode does so in each recording."""
    own = replace(MASS, own=("mass",))
    whole = with_hidden_mode()
    runs = [replace(whole.crop(*span), name=name) for name, span in HALVES.items()]
    final, trials = estimated(runs, [own], [{"mass": 0.1}])
    assert len(final.owned) == 2
    (one,) = disputed(final, trials)
    assert one.cause == own
    assert one.recording in HALVES
    which = [*HALVES].index(one.recording)
    assert one.claimed[0] == final.fit.values[final.owned[which][0]]
    assert abs(one.another[0] - one.claimed[0]) > 0.5 * abs(one.claimed[0])
    assert f"on x in {one.recording} would be" in dispute_sentence(pushed_model(), one)


def test_of_own_strengths_each_is_compared_with_that_of_its_recording() -> None:
    own = replace(DAMPER, own=("damping",))
    runs = [pushed(5, damping=1.6), replace(pushed(6, damping=2.4), name="other")]
    final, (base, *_) = estimated(runs, [own], [{"damping": 0.8}])
    assert len({*final.fit.values}) == 2
    assert not disputed(final, [base])
    second = base.owned[1][0]

    def with_second(value: float) -> Fitted:
        values = base.fit.values.copy()
        values[second] = value
        return replace(base, fit=replace(base.fit, values=values))

    assert not disputed(final, [with_second(0.6 * base.fit.values[second])])
    (one,) = disputed(final, [with_second(0.1 * base.fit.values[second])])
    assert one.recording == "other"
    small = final.fit.values.copy()  # of a machine that hardly shows it a typical size counts
    small[final.owned[1][0]] = 0.01
    hardly = replace(final, fit=replace(final.fit, values=small))
    assert not disputed(hardly, [with_second(0.05)])


def test_the_name_of_a_parameter_stays_as_the_model_writes_it() -> None:
    cause = Hypothesis("parameter", None, ("value",), (False,), path="d")
    said = dispute_sentence(pushed_model(), Disputed(cause, (0.9, 0.01), (0.6, 0.01), None))
    assert said.startswith("Parameter d would be 0.900 ± 0.010 N·s/m, and 0.600 ± 0.010 N·s/m")
    assert "beside an unknown force" in said


def test_a_law_that_is_real_stays_beside_an_unmeasured_force() -> None:
    planted = markov(np.random.default_rng(13), SAMPLES, 0.5, 0.2)
    recording = pushed(13, samples=SAMPLES, damping=1.6, beside=planted)
    final, trials = estimated(recording, [DAMPER], [{"damping": 0.8}])
    assert final.fit.values[0] > 0.5
    assert not disputed(final, trials)


def test_a_class_that_may_hold_a_law_speaks_against_it_only_where_it_takes_of_it() -> None:
    final, (base, _, force) = estimated(pushed(5, damping=1.6), [DAMPER], [{"damping": 0.8}])
    value = base.fit.values[0]

    def at(share: float) -> Fitted:
        values = np.append(share * value, np.zeros(base.fit.values.size - 1))
        return replace(base, fit=replace(base.fit, values=values))

    (one,) = disputed(final, [at(0.1)])
    assert (one.cause, one.beside) == (DAMPER, None)
    (other,) = disputed(final, [replace(at(0.1), extra=force.extra)])
    assert (other.cause, other.beside) == (DAMPER, force.extra)
    assert "beside a smooth force of stretch and rate" in dispute_sentence(pushed_model(), other)
    assert disputed(final, [at(3.0)])
    assert not disputed(final, [replace(at(3.0), extra=force.extra)])
    assert not disputed(final, [replace(at(0.6), extra=force.extra)])  # more than half is left


def test_a_harmonic_force_is_disputed_by_its_amplitude_that_recordings_share() -> None:
    tone = Hypothesis(
        "harmonic",
        On("x"),
        ("sine", "cosine"),
        (False, False),
        (("frequency", 1.3),),
        ("frequency",),
        own=("phase",),
    )
    t = STEP * np.arange(600)
    made = pushed(6, beside=0.8 * np.sin(2 * np.pi * 1.3 * t))
    row = {"amplitude": 0.6, "frequency": 1.3, "phase": 0.1}
    final, (base, *_) = estimated(made, [tone], [row])
    assert not disputed(final, [base])
    less = replace(base.fit, values=np.append(0.1 * base.fit.values[0], base.fit.values[1:]))
    (one,) = disputed(final, [replace(base, fit=less)])
    assert one.claimed[0] == pytest.approx(0.8, rel=0.05)

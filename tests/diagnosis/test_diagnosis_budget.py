"""A diagnosis whose time is spent claims nothing that a comparison may withdraw which was not made,
and names these comparisons."""

import json
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from builders import damper, oscillator, push, recording, spring
from pushed import pushed_model, resisted
from test_diagnosis_held import held_recording
from typer.testing import CliRunner

import symhyb as sh
from symhyb.cli.app import app
from symhyb.correction.search import decide as search
from symhyb.correction.verdict import choice as choosing
from symhyb.correction.verdict import decided as deciding
from symhyb.deadline import Deadline
from symhyb.diagnosis import advised, conclude
from symhyb.discrepancy.results import Budget

INPUTS = {"f": {"unit": "N"}}
KNOWN = {"hold": spring("k"), "motor": push("f")}
MODEL = oscillator(KNOWN, {"k": (40.0, "N/m")}, inputs=INPUTS)
ALL_CAUSES = "all causes that may explain the recordings"


class Clock:
    """A clock that goes on by 1 s whenever somebody looks at it, and can be put forward."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        self.now += 1.0
        return self.now


@pytest.fixture(scope="module")
def damped() -> sh.Recording:
    """A mass on a spring that is damped, which the model does not say."""
    t = np.arange(0, 12, 0.02)
    true = oscillator(
        {**KNOWN, "rail": damper("d")},
        {"k": (40.0, "N/m"), "d": (3.0, "N*s/m")},
        inputs=INPUTS,
    )
    force = 5 * np.sin(3 * t) + 4 * np.sin(7.3 * t)
    run = sh.simulate(true, sh.Scenario(t, np.zeros(1), np.zeros(1), t, force[:, None]))
    noise = 1e-3 * np.random.default_rng(1).standard_normal(t.size)
    return recording(t, {"f": force}, place=run.y[:, 0] + noise)


def ended_at(
    step: str, recordings: sh.Recording | Sequence[sh.Recording], model: sh.Model = MODEL
) -> sh.Diagnosis:
    """The diagnosis that has no more time when this step is said."""
    clock = Clock()

    def say(line: str) -> None:
        if line.startswith(step):
            clock.now += 1e6

    deadline = Deadline(1e6, 0.0, clock)
    return advised(conclude(model, recordings, say=say, deadline=deadline), say, deadline)


def nothing_is_claimed(diagnosis: sh.Diagnosis) -> bool:
    claims = (diagnosis.found, diagnosis.parameters, diagnosis.measurement, diagnosis.courses)
    return diagnosis.verdict == "undecided" and not any(claims)


def test_nothing_is_compared_before_a_structure_was_fitted(damped: sh.Recording) -> None:
    for step in ("estimating motion", "pushing every", "mapping", "screening", "trying the model"):
        answer = ended_at(step, damped)
        assert nothing_is_claimed(answer)
        assert answer.budget == Budget(1e6, (ALL_CAUSES,)), step
        assert "before any structure was fitted: nothing was compared" in answer.sentence


@pytest.mark.parametrize(
    ("step", "unmade", "best"),
    [
        (
            "trying damper",
            (search.OTHERS, choosing.ALONG_WHOLE, deciding.BEYOND),
            "The model as it is fits best of the structure that was tried",
        ),
        (
            "estimating values",
            (deciding.BEYOND,),
            "Damper (damping) on x fits best of the 2 structures that were tried",
        ),
        (
            "looking for what acts beyond",
            (deciding.BEYOND,),
            "Damper (damping) on x fits best of the 2 structures that were tried",
        ),
    ],
)
def test_what_was_not_compared_is_named_and_nothing_claimed(
    damped: sh.Recording, step: str, unmade: tuple[str, ...], best: str
) -> None:
    answer = ended_at(step, damped)
    assert nothing_is_claimed(answer)
    assert answer.budget == Budget(1e6, unmade)
    assert f"Not compared: {'; '.join(unmade)}. {best}" in answer.sentence
    kinds = [one.kind for one in answer.alternatives]
    assert ("damper" in kinds) == best.startswith("Damper")
    assert answer.places  # where the mismatch is was known by then


def test_recordings_that_were_not_held_against_each_other_are_said(damped: sh.Recording) -> None:
    answer = ended_at("holding the recordings", [damped.crop(0, 6), damped.crop(6, 12)])
    assert nothing_is_claimed(answer)
    unmade = (choosing.EACH_OTHER, choosing.ALONG_WHOLE, deciding.BEYOND)
    assert answer.budget == Budget(1e6, unmade)


@pytest.mark.slow
def test_a_class_stands_and_no_cause_where_a_law_in_its_place_was_not_compared() -> None:
    run = resisted(2, lambda x, v: 3.0 * float(np.tanh(x / 0.2)))
    answer = ended_at("fitting a curve", run, pushed_model())
    assert nothing_is_claimed(answer)
    assert answer.budget == Budget(1e6, (deciding.INSTEAD,))
    (likeliest, *_) = answer.classes
    assert likeliest.kind == "law"
    assert likeliest.sentence in answer.sentence


@pytest.mark.slow
def test_nothing_is_claimed_where_held_inputs_were_not_compared() -> None:
    answer = ended_at("deciding again, with an input that", held_recording(), pushed_model())
    assert nothing_is_claimed(answer)
    assert answer.budget == Budget(1e6, (deciding.OTHERWISE,))


def test_the_value_that_fits_best_by_then_is_said(damped: sh.Recording) -> None:
    said = ended_at("estimating values", damped).sentence
    ((value, sd),) = re.findall(r"damping ([\d.]+) ± ([\d.]+) N·s/m; not judged yet", said)
    assert abs(float(value) - 3.0) < 4 * float(sd)


def test_claims_stand_once_all_that_guards_them_was_compared(damped: sh.Recording) -> None:
    answer = ended_at("holding the diagnosis", damped)
    assert answer.verdict == "missing physics"
    assert answer.budget == Budget(1e6)
    assert answer.found["damper"].share is None  # a fit for each, and no claim rests on it
    assert (
        "No table of which causes these recordings tell apart: the time that was allowed was"
        in (" ".join(answer.notes))
    )
    assert "No advice on what to record next: the time that was allowed was spent." in answer.notes


@pytest.mark.slow
def test_whenever_the_time_is_spent_the_answer_is_that_of_a_full_run_or_nothing_is_claimed(
    damped: sh.Recording,
) -> None:
    clock = Clock()
    full = conclude(MODEL, damped, deadline=Deadline(1e9, 0.0, clock)).diagnosis
    assert full.verdict == "missing physics"
    seen = set()
    for budget in range(1, int(clock.now) + 2, 4):  # a look at the clock is a second
        answer = conclude(MODEL, damped, deadline=Deadline(budget, 0.0, Clock())).diagnosis
        assert answer.budget is not None
        if answer.budget.not_compared:
            assert nothing_is_claimed(answer)
        else:
            assert answer.found["damper"].damping == full.found["damper"].damping
        seen.add(answer.verdict)
    assert seen == {"undecided", "missing physics"}


@pytest.mark.slow
def test_a_budget_that_suffices_changes_nothing_but_its_own_entry(damped: sh.Recording) -> None:
    free, bounded = sh.diagnose(MODEL, damped), sh.diagnose(MODEL, damped, budget="1h")
    assert free.budget is None
    assert bounded.budget == Budget(3600.0)
    assert (bounded.sentence, bounded.found, bounded.notes, bounded.log) == (
        free.sentence,
        free.found,
        free.notes,
        free.log,
    )


def test_the_command_line_takes_a_budget_and_leaves_all_files(
    damped: sh.Recording, tmp_path: Path
) -> None:
    sh.write_model(MODEL, tmp_path / "model.toml")
    rows = np.column_stack([damped.t, damped.inputs["f"], damped.sensors["place"]])
    np.savetxt(tmp_path / "run.csv", rows, delimiter=",", header="t,f,place", comments="")
    told = [str(tmp_path / name) for name in ("model.toml", "run.csv")]
    out = tmp_path / "out"
    done = CliRunner().invoke(app, ["diagnose", *told, "-o", str(out), "--budget", "0.05s"])
    assert done.exit_code == 1
    assert done.stdout.startswith("The time that was allowed (0.05 s) was spent before")
    document = json.loads((out / "diagnosis.json").read_text("utf-8"))
    assert document["verdict"] == "undecided"
    assert document["budget"] == {"seconds": 0.05, "not_compared": [ALL_CAUSES]}
    assert (out / "corrected.toml").read_text("utf-8") == (tmp_path / "model.toml").read_text(
        "utf-8"
    )
    page = (out / "report.html").read_text("utf-8")
    assert "was spent before any structure was fitted: nothing was compared." in page

    (tmp_path / "study.toml").write_text(
        'symhyb = 1\nmodel = "model.toml"\nbudget = "50 s"\n[[train]]\nfile = "run.csv"\n',
        encoding="utf-8",
    )
    from symhyb.study.file import read_study

    assert read_study(tmp_path / "study.toml").budget_s == 50.0
    (tmp_path / "study.toml").write_text(
        'symhyb = 1\nmodel = "model.toml"\nbudget = "soon"\n[[train]]\nfile = "run.csv"\n',
        encoding="utf-8",
    )
    with pytest.raises(sh.InputError, match=r"study.toml:3: budget: must be a time above 0"):
        read_study(tmp_path / "study.toml")

"""A machine that is an FMU, end to end: diagnosed, corrected, judged, exported, on the command line
as in Python."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import patch

import pytest
from command import Call
from rigs import spring_model, spring_recording

import symhyb as sh
from symhyb.correction.advice.advice import CLOSED as NO_ADVICE
from symhyb.correction.advice.advice import advise
from symhyb.model.closed import CLOSED
from symhyb.monitoring.gauge import gauge_of
from symhyb.study.file import Study
from symhyb.study.run import carry_out
from tests.fmu_rigs import as_fmu

HIDDEN = {"coulomb": 0.7}


@pytest.fixture(scope="module")
def closed(tmp_path_factory: pytest.TempPathFactory) -> sh.Model:
    """The mass on a spring as an FMU."""
    return as_fmu(spring_model(), tmp_path_factory.mktemp("closed"))


@pytest.mark.slow
def test_the_same_is_named_through_an_fmu_as_with_the_model(
    closed: sh.Model, tmp_path: Path
) -> None:
    train, test = (spring_recording(seed, HIDDEN, name=f"run{seed}.csv") for seed in (1, 2))
    diagnoses = [sh.diagnose(model, train, holdout=test) for model in (spring_model(), closed)]
    names = [[(f.element.kind, f.element.place) for f in one.found] for one in diagnoses]
    assert names[0] == names[1]
    assert [kind for kind, _ in names[1]] == ["friction"]
    values = [one.found[0].estimates[0] for one in diagnoses]
    assert values[1].value == pytest.approx(values[0].value, rel=1e-3)
    assert values[1].value == pytest.approx(HIDDEN["coulomb"], abs=3 * values[1].sd)
    corrected = sh.apply(closed, diagnoses[1].found)
    verdict = sh.judge(closed, corrected, on=test)
    assert verdict.holdout is not None
    before, after = verdict.holdout.before, verdict.holdout.after
    assert after.free_run_nrmse["laser"] < 0.5 * before.free_run_nrmse["laser"]  # type: ignore[operator]
    sh.write_model(corrected, tmp_path / "corrected.toml")
    assert (tmp_path / "machine.fmu").read_bytes() == closed.fmu.path(closed.file).read_bytes()  # type: ignore[union-attr]
    assert [e.kind for e in sh.read_model(tmp_path / "corrected.toml").elements] == ["friction"]


@pytest.mark.slow
def test_the_command_line_knows_what_an_fmu_can_do(
    closed: sh.Model, tmp_path: Path, symhyb: Call
) -> None:
    run = spring_recording(1, HIDDEN, duration=4.0)
    run.to_frame().to_csv(tmp_path / "run.csv")
    file, record = closed.file, str(tmp_path / "run.csv")
    assert symhyb("check", file).status == 0
    said = symhyb("compare", file, record)
    assert said.status == 0
    assert "5.1 % of what is applied" in said.out
    (facts,) = json.loads(symhyb("compare", file, record, "--json").out)["recordings"]
    assert "first_checks" not in facts
    for order in (("equations", file), ("simulate", file, "--end", "1", "-o", "x.csv")):
        refused = symhyb(*order)
        assert refused.status == 2
        assert CLOSED in refused.err


def test_a_found_law_is_exported_without_the_fmu(
    closed: sh.Model, tmp_path: Path, symhyb: Call
) -> None:
    law = '\n[elements.rub]\nkind = "drag"\non = "x"\ndrag = "b"\nfound = { by = "sparse" }\n'
    law += '[elements.rub.parameters]\nb = { value = 0.3, unit = "N*s^2/m^2" }\n'
    file = Path(closed.file).with_name("corrected.toml")
    file.write_text(closed.text + law)
    said = symhyb("export", str(file), "--to", "c", "-o", str(tmp_path / "c"))
    for line in ("inputs: v.x [m/s]", "outputs: dF.x [N]"):
        assert line in said.out
    refused = symhyb("export", str(file), "--to", "c", "--whole", "-o", str(tmp_path / "whole"))
    assert CLOSED in refused.err
    assert (said.status, refused.status) == (0, 2)


def test_no_manoeuvre_is_worked_out_where_the_equations_are_not_known() -> None:
    column = replace(spring_model().inputs[0], local=True)
    prepared = SimpleNamespace(model=SimpleNamespace(inputs=(column,)))
    with patch("symhyb.correction.advice.advice._pairs", return_value=[_pair()]):
        assert advise(prepared, None, None) == (NO_ADVICE, None)  # type: ignore[arg-type]


def _pair() -> object:
    few = SimpleNamespace(causes=())
    return SimpleNamespace(first=few, second=few)


@pytest.mark.slow
def test_parameters_of_an_fmu_are_fitted(closed: sh.Model, tmp_path: Path, symhyb: Call) -> None:
    text = closed.text.replace(
        'value = 200.0, unit = "N/m"', 'value = 190.0, sd = 20, unit = "N/m"'
    )
    file = Path(closed.file).with_name("softer.toml")
    file.write_text(text)
    spring_recording(1, {}, duration=5.0).to_frame().to_csv(tmp_path / "run.csv")
    out = Path(closed.file).with_name("fitted.toml")
    assert symhyb("fit", file, tmp_path / "run.csv", "-o", out).status in (0, 1)
    assert sh.read_model(out).parameters["k"].value == pytest.approx(200.0, rel=2e-3)


def test_what_cannot_work_along_recordings_alone_is_refused_first(closed: sh.Model) -> None:
    run = spring_recording(1, {}, duration=4.0)
    study = Study(Path(closed.file), (), (), remainder="x")
    for work in (
        lambda: sh.learn(closed, run),
        lambda: gauge_of(closed, run),
        lambda: carry_out(study),
    ):
        with pytest.raises(sh.InputError) as caught:
            work()
        assert caught.value.problems[0].text == CLOSED

"""An FMU that is asked along a motion: the same answers from every form of FMI, and one sentence
for every FMU that cannot answer."""

import re
from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pytest
from builders import DRIVEN_MASS

from symhyb.data.hosts import fmu_answers
from symhyb.data.hosts.answers import Answer, Question
from symhyb.data.hosts.fmu_answers import ask
from symhyb.errors import InputError
from symhyb.model.fmu import Fmu
from symhyb.model.read import parse_model, read_model
from symhyb.model.trees import Quantity
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from symhyb.units import ONE
from tests.fmu_rigs import as_fmu, misbehaving, redescribed

ARM = Path(__file__).parents[2] / "models" / "two_link_arm.toml"
MASS = parse_model(DRIVEN_MASS)


def asked(model: Model, samples: int = 5) -> Question:
    """A motion of all coordinates under a force on each input, with the model's parameters."""
    assert model.fmu is not None
    n, k = len(model.coordinates), len(model.fmu.inputs)
    t = np.linspace(0, 1, samples)
    ways = np.arange(2, n + 2) * t[:, None]
    values = [
        next(p.si for p in model.parameters if p.name == name) for name, _ in model.fmu.parameters
    ]
    u = 0.3 * np.cos(np.arange(1, k + 1) * t[:, None])
    steps = np.full(2 * n + k, 1e-4)
    moved = np.sin(ways), np.cos(ways), -np.sin(ways)
    return Question(t, *moved, u, steps, np.full(n, 1e-4), np.array([values]))


def answer(model: Model, question: Question | None = None) -> Answer:
    assert model.fmu is not None
    return ask(model.fmu, model.fmu.path(model.file), question or asked(model))


def refused(model: Model, fmu: Fmu | None = None) -> str:
    assert model.fmu is not None
    with pytest.raises(InputError) as caught:
        ask(fmu or model.fmu, model.fmu.path(model.file), asked(model))
    return str(caught.value)


@pytest.mark.parametrize(("fmi", "kind"), [(2, "me"), (3, "me"), (2, "cs"), (3, "cs")])
def test_every_form_of_fmi_says_what_the_model_says(fmi: int, kind: str, tmp_path: Path) -> None:
    model = read_model(ARM)
    machine, question = build(model), asked(as_fmu(model, tmp_path, fmi, (kind,)))
    found = answer(read_model(tmp_path / "machine.toml"), question)
    p, z = machine.values, np.zeros(0)
    for i, t in enumerate(question.t):
        q, v, u = question.q[i], question.v[i], question.u[i]
        (mass,), (applied,) = call(machine.M, (q, t, p)), call(machine.k_e, (q, v, z, u, t, p))
        (inertial,) = call(machine.k_c, (q, v, t, p))
        force = applied.reshape(-1) - inertial.reshape(-1)
        np.testing.assert_allclose(found.mass[0, i], mass, rtol=1e-9)
        np.testing.assert_allclose(found.force[0, i], force, rtol=1e-9)
        np.testing.assert_allclose(found.slopes[0, i, :, 4:], np.eye(2), atol=1e-8)
        by = [_lacking(machine, q + way, v, question.a[i], u, p) for way in 1e-4 * np.eye(2)]
        less = [_lacking(machine, q - way, v, question.a[i], u, p) for way in 1e-4 * np.eye(2)]
        slope = -(np.array(by) - np.array(less)).T / 2e-4
        np.testing.assert_allclose(found.slopes[0, i, :, :2], slope, rtol=1e-4, atol=1e-4)


def _lacking(machine, q, v, a, u, p) -> np.ndarray:  # type: ignore[no-untyped-def]
    return call(machine.discrepancy, (q, v, a, np.zeros(0), u, 0.0, p))[0].reshape(-1)


def test_parameters_are_set_before_the_fmu_answers(tmp_path: Path) -> None:
    model = as_fmu(MASS, tmp_path)
    question = asked(model)
    names = [name for name, _ in model.fmu.parameters]  # type: ignore[union-attr]
    heavier = question.values.copy()
    heavier[0, names.index("m")] = 4.0
    found = answer(model, replace(question, values=np.concatenate([question.values, heavier])))
    np.testing.assert_allclose(found.mass[:, :, 0, 0], [[1.0] * 5, [4.0] * 5])


def test_without_an_input_of_force_the_mass_is_stated(tmp_path: Path) -> None:
    model = as_fmu(MASS, tmp_path)
    assert model.fmu is not None
    (place,) = model.fmu.places
    named = answer(model)
    stated = replace(place, force="", mass=Quantity(float(named.mass[0, 0, 0, 0]), ONE))
    for found, expected in zip(
        astuple(answer(replace(model, fmu=replace(model.fmu, places=(stated,))))),
        astuple(named),
        strict=True,
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("*(volatile int *)0 = 1;", "the FMU ended by signal SIGSEGV: it crashed"),
        ("return fmi2Error;", "the FMU cannot be used: fmi2SetTime failed with status 3"),
        ("exit(7);", "the FMU ended with exit status 7: it crashed"),
        ("for (;;) {}", "s that it gets for this recording; shorten the recording"),
    ],
    ids=["crashes", "fails", "exits", "hangs"],
)
def test_an_fmu_that_misbehaves_is_one_sentence(
    what: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fmu_answers, "FMU_SECONDS", 1)
    model = as_fmu(MASS, tmp_path)
    misbehaving(tmp_path / "machine.fmu", 'SELF(EVENT | CONTINUOUS, "fmi2SetTime");', what)
    assert said in refused(model)


def test_what_an_fmu_prints_is_not_taken_for_its_answer(tmp_path: Path) -> None:
    model = as_fmu(MASS, tmp_path)
    before = answer(model)
    where = 'SELF(EVENT | CONTINUOUS, "fmi2SetTime");'
    misbehaving(tmp_path / "machine.fmu", where, 'printf("hello\\n");')
    np.testing.assert_array_equal(answer(model).force, before.force)


def test_variables_that_are_not_there_are_all_named(tmp_path: Path) -> None:
    model = as_fmu(MASS, tmp_path)
    assert model.fmu is not None
    (place,) = model.fmu.places
    wrong = replace(place, position="q.y", force="u.pus_x")
    fmu = replace(model.fmu, places=(wrong,), parameters=(("k", "p.kk"),))
    said = refused(model, fmu)
    assert "has no state 'q.y'" in said
    assert "has no input 'u.pus_x'; did you mean 'u.push_x'?" in said
    assert "has no parameter 'p.kk'" in said


def test_a_position_and_a_rate_that_do_not_belong_together_are_refused(tmp_path: Path) -> None:
    model = as_fmu(MASS, tmp_path)
    assert model.fmu is not None
    (place,) = model.fmu.places
    swapped = replace(place, position=place.rate, rate=place.position)
    said = refused(model, replace(model.fmu, places=(swapped,)))
    assert "the derivative of a position is not the rate that is named beside it" in said


def test_forces_that_do_not_act_along_their_coordinates_are_refused(tmp_path: Path) -> None:
    model = as_fmu(read_model(ARM), tmp_path)
    assert model.fmu is not None
    first, second = model.fmu.places
    swapped = replace(first, force=second.force), replace(second, force=first.force)
    said = refused(model, replace(model.fmu, places=swapped))
    assert "the forces of [fmu.coordinates] do not act along their coordinates" in said


def test_states_beside_those_of_the_coordinates_are_refused(tmp_path: Path) -> None:
    memory = '\n[elements.rest]\nkind = "relaxation"\non = "x"\nstiffness = "k"\ndamping = "d"\n'
    model = as_fmu(parse_model(DRIVEN_MASS + memory), tmp_path)
    assert "has states that are no position and no rate of a coordinate: z.rest" in refused(model)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_derivative_is_known_by_its_name_where_the_fmu_does_not_say_whose_it_is(
    fmi: int, tmp_path: Path
) -> None:
    """As FMUs of rumoca, which leave the attribute out."""
    model = as_fmu(read_model(ARM), tmp_path, fmi)
    question, file = asked(model), tmp_path / "machine.fmu"
    expected = answer(model, question)
    redescribed(file, lambda text: re.sub(r' derivative="[0-9]+"', "", text))
    for found, other in zip(astuple(answer(model, question)), astuple(expected), strict=True):
        assert np.array_equal(found, other)
    redescribed(file, lambda text: re.sub(r'"der\((.*?)\)"', r'"rate of \1"', text))
    said = refused(model)
    assert said.count("does not say of which state 'rate of ") == 4


def test_an_fmu_that_begins_elsewhere_than_told_is_refused(tmp_path: Path) -> None:
    """As co-simulation by qfmu, whose states begin where parameters of it say."""
    model = as_fmu(MASS, tmp_path, 2, ("cs",))
    where = 'SELF(INITIAL, "fmi2ExitInitializationMode");'
    misbehaving(tmp_path / "machine.fmu", where, "self->m.v[4] = 0;")
    assert "does not begin at the positions and rates that are set" in refused(model)


def test_what_is_no_fmu_is_refused(tmp_path: Path) -> None:
    model = as_fmu(MASS, tmp_path)
    (tmp_path / "machine.fmu").write_bytes(b"no archive")
    assert "is no FMU: it is no ZIP archive" in refused(model)
    (tmp_path / "machine.fmu").unlink()
    assert "there is no such file" in refused(model)


def test_nothing_runs_before_somebody_said_that_it_may(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = as_fmu(parse_model(DRIVEN_MASS, "m.toml"), tmp_path)
    monkeypatch.delenv(fmu_answers.TRUST)
    assert refused(model).endswith("if you trust its maker, set SYMHYB_TRUST_FMU=1")

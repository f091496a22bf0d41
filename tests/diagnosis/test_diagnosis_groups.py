"""Numbers that are shared within groups of recordings, in a diagnosis."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.console.results import print_result
from symhyb.report import to_json
from symhyb.report.tables import fleet_table
from symhyb.study.file import Study
from symhyb.study.run import carry_out, leave_files
from symhyb.study.sources import Source
from tests.rigs import DAMPING, MASS, STIFFNESS, spring_model

SCHEMA = Path(sh.__file__).parent / "report" / "diagnosis.schema.json"
DRAGS = {"light": 1.0, "heavy": 3.0}  # N·s²/m²


def pushed(seed: int, drag: float, name: str, mount: str) -> sh.Recording:
    """Position under a multisine of 8 N, with drag that the model lacks."""
    random = np.random.default_rng(seed)
    t, lines = np.arange(0, 4.0, 0.005), np.linspace(0.3, 5, 14)
    phases = random.uniform(0, 2 * np.pi, 14)

    def force(time: float) -> float:
        return float(8 * np.sqrt(2 / 14) * np.sin(2 * np.pi * lines * time + phases).sum())

    def rate(time: float, state: np.ndarray) -> list[float]:
        x, v = state
        acting = force(time) - STIFFNESS * x - DAMPING * v - drag * abs(v) * v
        return [v, acting / MASS]

    x = solve_ivp(rate, (0, 4), [0, 0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=0.005).y[0]
    seen = x + 0.01 * x.std() * random.standard_normal(t.size)
    groups = {"mount": mount}
    return sh.Recording(name, t, {"f": np.array([*map(force, t)])}, {"laser": seen}, groups=groups)


@pytest.fixture(scope="module")
def runs() -> list[sh.Recording]:
    rows = [("a", "light"), ("b", "heavy"), ("c", "light")]
    return [pushed(i, DRAGS[mount], name, mount) for i, (name, mount) in enumerate(rows)]


@pytest.fixture(scope="module")
def diagnosis(runs) -> sh.Diagnosis:
    unseen = pushed(9, DRAGS["heavy"], "unseen", "heavy")
    return sh.diagnose(spring_model(), runs, unseen, own={"drag": "mount"})


def test_each_group_has_its_value_and_the_element_the_mean(diagnosis):
    assert diagnosis.verdict == "missing physics"
    (found,) = diagnosis.found
    assert found.element.kind == "drag"
    assert found.own == ()
    values = {(by, label): one for by, label, (one,) in found.groups}
    assert {*values} == {("mount", "light"), ("mount", "heavy")}
    for (_, label), one in values.items():
        assert one.value == pytest.approx(DRAGS[label], rel=0.05)
        assert abs(one.value - DRAGS[label]) < 4 * one.sd
    each = [one.value for one in values.values()]
    (estimate,) = found.estimates
    assert estimate.value == pytest.approx(np.mean(each))
    assert estimate.sd == pytest.approx(np.std(each, ddof=1) * np.sqrt(1.5))
    (written,) = found.element.parameters
    assert (written.value, written.sd) == (estimate.value, estimate.sd)
    assert written.about == "mean of 2 groups (mount), with the sd of one more"
    assert "Each mount has its own" in found.sentence
    assert "For a group that was not recorded" in found.sentence
    assert found.share is not None
    assert found.share > 0.9  # of the unseen recording, whose mount is known


def test_values_of_a_recording_are_those_of_its_group(diagnosis, runs):
    (found,) = diagnosis.found
    (number,) = found.estimates
    path = f"{found.element.name}.{number.name}"
    assert diagnosis.values_of(runs[1])[path] == pytest.approx(DRAGS["heavy"], rel=0.05)
    assert diagnosis.values_of(runs[0]) == diagnosis.values_of(runs[2])
    assert diagnosis.values_of(pushed(1, 2.0, "other", "other")) == {}
    corrected = sh.apply(spring_model(), diagnosis.found)
    left = {}
    for name, values in (("mean", {}), ("group", diagnosis.values_of(runs[1]))):
        run = sh.simulate(corrected, runs[1], parameters=values)
        left[name] = np.sqrt(np.mean((run.y[:, 0] - runs[1]["laser"]) ** 2))
    assert left["group"] < 0.5 * left["mean"]


def test_the_file_has_the_groups_and_keeps_its_contract(diagnosis, runs):
    corrected = sh.apply(spring_model(), diagnosis.found)
    own = {one.name: diagnosis.values_of(one) for one in runs}
    verdicts = [sh.judge(spring_model(), corrected, train=runs, own=x) for x in (None, own)]
    document = to_json(diagnosis, verdicts[1])
    Draft202012Validator(json.loads(SCHEMA.read_text("utf-8"))).validate(document)
    (found,) = document["found"]
    assert {*found["groups"]["mount"]} == {"light", "heavy"}
    (row,) = found["groups"]["mount"]["heavy"].values()
    assert row["term"] == "drag"
    assert row["value"] == pytest.approx(DRAGS["heavy"], rel=0.05)
    mean, group = (one.train.after.free_run_rmse["laser"] for one in verdicts)
    assert group < 0.5 * mean  # with the mean of the groups no recording is met


def test_the_page_and_the_terminal_show_each_group(diagnosis):
    table = fleet_table(diagnosis)
    assert [row[0] for row in table.rows] == ["mount light", "mount heavy"]
    assert all("N·s²/m²" in row[2] for row in table.rows)


@pytest.mark.slow
def test_the_command_line_takes_a_study_with_groups(tmp_path, runs, capsys):
    model = tmp_path / "spring.toml"
    sh.write_model(spring_model(), model)
    rows, files = ["recording,mount"], []
    for run in runs:
        file = tmp_path / f"{run.name}.csv"
        frame = np.column_stack([run.t, run["f"], run["laser"]])
        np.savetxt(file, frame, delimiter=",", header="t,f,laser", comments="")
        rows.append(f"{file.name},{run.groups['mount']}")
        files.append(file)
    (tmp_path / "mounts.csv").write_text("\n".join(rows), encoding="utf-8")
    sources = tuple(map(Source, files))
    study = Study(model, sources, own={"drag": "mount"}, groups=tmp_path / "mounts.csv")
    result = carry_out(study)
    (tmp_path / "out").mkdir()
    leave_files(result, tmp_path / "out")
    document = json.loads((tmp_path / "out" / "diagnosis.json").read_text("utf-8"))
    assert document["found"][0]["groups"]["mount"]["light"]
    assert "mount heavy" in (tmp_path / "out" / "report.html").read_text("utf-8")
    said = result.diagnosis.sentence
    noted = replace(result.diagnosis, notes=(*result.diagnosis.notes, said, "Another note."))
    print_result(replace(result, diagnosis=noted), tmp_path / "out")
    printed = capsys.readouterr().out
    assert "group mount = heavy" in printed
    assert printed.count(said) == printed.count("Another note.") == 1  # no note says it again


PENDULUM = """
symhyb = 1
gravity = ["0", "-g"]

[coordinates]
q = { unit = "rad", start = -1.5 }

[parameters]
g = { value = 9.81, unit = "m/s^2" }
m = { value = 0.8, unit = "kg" }
l = { value = 0.125, unit = "m" }

[points]
weight = ["l*sin(q)", "-l*cos(q)"]

[bodies.weight]
mass = "m"
at = "weight"

[sensors]
encoder = { measures = "q", unit = "rad" }
"""
INERTIA, LOADED = 0.0095, 0.25  # kg·m², 1
MOUNTS = {  # weight kg, length m; damping N·m·s/rad, dry friction N·m
    "a": (0.535, 0.10, 0.010, 0.02),
    "b": (0.741, 0.15, 0.030, 0.04),
    "c": (1.168, 0.10, 0.020, 0.08),
}


def fallen(model: sh.Model, mount: str, start: float, seed: int) -> sh.Recording:
    """A fall of a pendulum with rotor inertia and all three frictions."""
    m, l, c, dry = MOUNTS[mount]  # noqa: E741
    t = np.arange(0, 3, 0.01)

    def rate(_: float, state: np.ndarray) -> list[float]:
        q, v = state
        pull = m * l * 9.81 * np.sin(q)
        lost = c * v + (dry + LOADED * abs(pull)) * np.tanh(v / 1e-4)
        return [v, (-pull - lost) / (m * l**2 + INERTIA)]

    run = solve_ivp(rate, (0, 3), [start, 0], method="Radau", t_eval=t, rtol=1e-8, atol=1e-10)
    noise = 1e-3 * np.random.default_rng(seed).standard_normal(t.size)
    return sh.Recording.from_frame(
        {"t": t, "encoder": run.y[0] + noise},
        model,
        name=f"{mount}{seed}",
        parameters={"m": m, "l": l},
        groups={"mount": mount},
    )


@pytest.mark.slow
def test_all_frictions_of_pendulums_are_named_with_the_numbers_of_each_mount() -> None:
    model = sh.parse_model(PENDULUM)
    falls = [
        fallen(model, mount, start, 10 * i + j)
        for i, mount in enumerate(MOUNTS)
        for j, start in enumerate((-1.5, -1.35))
    ]
    diagnosis = sh.diagnose(model, falls, own={"damping": "mount", "coulomb": "mount"})
    assert diagnosis.verdict == "missing physics"
    found = {one.element.kind: one for one in diagnosis.found}
    assert {*found} == {"added_mass", "damper", "friction"}
    assert found["added_mass"].mass.value == pytest.approx(INERTIA, rel=0.02)
    assert found["friction"].load_coefficient.value == pytest.approx(LOADED, rel=0.02)
    for kind, which in (("damper", 2), ("friction", 3)):
        assert len(found[kind].groups) == len(MOUNTS)
        for _, label, (one,) in found[kind].groups:
            assert one.value == pytest.approx(MOUNTS[label][which], rel=0.05)

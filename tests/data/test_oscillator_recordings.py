"""The recordings of the demonstration: made as stated, exact friction, noise and seal as said."""

import base64
import hashlib
import importlib.util
import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from symhyb.data.recording import read_recording
from symhyb.model.read import read_model

ROOT = Path(__file__).parents[2]
STUDIES = ROOT / "studies"
FILES = [(study, file) for study in ("oscillator", "null") for file in ("train", "holdout")]


@pytest.fixture(scope="module")
def generate():
    """The script as a module, without leaving compiled files in the study."""
    spec = importlib.util.spec_from_file_location("generate", STUDIES / "oscillator/generate.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    keep, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    spec.loader.exec_module(module)
    sys.dont_write_bytecode = keep
    yield module
    del sys.modules[spec.name]


@pytest.fixture(scope="module")
def solved(generate):
    """Law, run, times and noise-free motion of every recording."""
    laws = {"oscillator": generate.Oscillator(), "null": generate.Oscillator(drag=0, coulomb=0)}
    runs = {"oscillator": generate.CONCEALED, "null": generate.NULL}
    result = {}
    for study, file in FILES:
        run = next(run for run in runs[study] if run.file == f"{file}.csv")
        t = np.arange(round(run.duration * 100) + 1) / 100
        result[study, file] = laws[study], run, t, generate.simulate(laws[study], run, t)
    return result


def columns(study, file):
    return np.loadtxt(STUDIES / study / f"{file}.csv", delimiter=",", skiprows=1, unpack=True)


def unsealed(study):
    sealed = json.loads((STUDIES / study / "sealed.json").read_text(encoding="ascii"))
    return {key: json.loads(base64.b64decode(value)) for key, value in sealed.items()}


@pytest.mark.parametrize(("study", "file"), FILES)
def test_the_script_makes_the_shipped_file(generate, solved, study, file):
    law, run, _, _ = solved[study, file]
    np.testing.assert_allclose(
        columns(study, file), generate.record(law, run).T, rtol=1e-6, atol=1e-8
    )


@pytest.mark.parametrize(("study", "file"), FILES)
def test_noise_is_one_and_a_half_percent_and_the_force_exact(solved, study, file):
    _, run, t, clean = solved[study, file]
    shipped = columns(study, file)
    np.testing.assert_allclose(shipped[0], t, atol=1e-9)
    np.testing.assert_allclose(shipped[1], run.force(t), atol=1e-7)
    noise = (shipped[2:] - clean) / np.abs(clean).max(axis=1, keepdims=True)
    np.testing.assert_allclose(noise.std(axis=1), 0.015, rtol=0.06)
    assert np.abs(noise.mean(axis=1)).max() < 0.0015
    assert abs(np.corrcoef(noise)[0, 1]) < 0.06


def test_dry_friction_is_exact(solved):
    """Compare with time steps in which the friction cone itself is solved (first order)."""
    law, run, t, exact = solved["oscillator", "holdout"]
    substeps, q, v = 100, 0.0, 0.0
    h = 0.01 / substeps
    force = run.force(np.arange((t.size - 1) * substeps + 1) * h)
    found = np.zeros((2, t.size))
    for k in range((t.size - 1) * substeps):
        free = v + h * (force[k] - law.cubic * q**3 - law.drag * abs(v) * v) / law.mass
        v = float(np.sign(free)) * max(abs(free) - h * law.coulomb / law.mass, 0.0)
        q += h * v
        if (k + 1) % substeps == 0:
            found[:, (k + 1) // substeps] = q, v
    assert np.abs(found - exact).max(axis=1) == pytest.approx([0, 0], abs=1e-3)


def test_it_sticks_until_the_force_exceeds_the_friction(solved):
    law, run, t, (q, _) = solved["oscillator", "train"]
    release = np.arcsin(law.coulomb / run.amplitude) / (2 * np.pi * run.frequency)
    assert np.all(q[t <= release] == 0)
    assert np.all(q[(t > release) & (t < 1)] > 0)


def test_without_anything_concealed_energy_is_kept_after_the_burst(solved):
    for file in ("train", "holdout"):
        law, run, t, (q, v) = solved["null", file]
        energy = 0.5 * law.mass * v**2 + 0.25 * law.cubic * q**4
        after = energy[t > run.burst]
        assert np.ptp(after) < 1e-7 * after[0]
        assert after[0] > 0.5  # J: it swings on


def test_the_seals():
    assert unsealed("oscillator")["verdict"] == "missing physics"
    assert unsealed("oscillator")["found"] == {"q.coulomb": 0.4905, "q.drag": 0.8}
    assert unsealed("null")["verdict"] == "nothing missing"
    assert unsealed("null")["found"] == {}


@pytest.mark.parametrize("study", ["oscillator", "null"])
def test_the_seal_is_the_one_the_page_states_and_the_script_writes(generate, solved, study):
    content = (STUDIES / study / "sealed.json").read_bytes()
    page = (STUDIES / study / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"\b[0-9a-f]{64}\b", page) == [hashlib.sha256(content).hexdigest()]
    law = solved[study, "train"][0]
    assert generate.seal(generate.answer(law)).encode() == content


@pytest.mark.parametrize("study", ["oscillator", "null"])
def test_nobody_reads_the_answer_by_chance(study):
    text = (STUDIES / study / "sealed.json").read_text(encoding="ascii")
    for word in ("coulomb", "drag", "friction", "missing", "0.49", "0.8"):
        assert word not in text


@pytest.mark.parametrize(("study", "file"), FILES)
def test_the_model_of_the_demonstration_reads_them_without_a_note(study, file):
    path = STUDIES / study / f"{file}.csv"
    assert path.stat().st_size < 300_000
    recording = read_recording(path, read_model(ROOT / "models" / "oscillator.toml"))
    assert set(recording.inputs) == {"f"}
    assert set(recording.sensors) == {"position", "speed"}
    assert recording.notes == ()


def test_the_script_needs_nothing_of_symhyb():
    text = (STUDIES / "oscillator" / "generate.py").read_text(encoding="utf-8")
    imported = set(re.findall(r"^(?:import|from) (\w+)", text, re.M))
    assert imported - set(sys.stdlib_module_names) == {"numpy", "scipy"}


@pytest.mark.slow
def test_the_command_line_writes_both_folders(generate, tmp_path, monkeypatch, capsys):
    for arguments, study in ((["-o"], "oscillator"), (["--null", "-o"], "null")):
        monkeypatch.setattr("sys.argv", ["generate.py", *arguments, str(tmp_path / study)])
        generate.main()
        for name in ("train.csv", "holdout.csv", "sealed.json"):
            assert (tmp_path / study / name).is_file()
        seal = (tmp_path / study / "sealed.json").read_bytes()
        assert seal == (STUDIES / study / "sealed.json").read_bytes()
        assert hashlib.sha256(seal).hexdigest() in capsys.readouterr().out

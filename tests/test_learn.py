"""Learning by sparse regression and by networks, of forces and of rates, up to the files it leaves.

A mass of 2 kg on a spring with a damper; what its model lacks is a cubic spring and drag.
"""

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from builders import DRIVEN_MASS, cart_and_pole

import symhyb as sh
from symhyb.cli.app import main
from symhyb.learning import Learned, simulate_corrected
from symhyb.model.read import parse_model
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.report.learned import learned_json

MASS, CUBIC, DRAG = 2.0, 120.0, 0.8
NOISE = 1e-3  # m, of an amplitude of some 0.3 m
TEXT = DRIVEN_MASS.replace("m = { value = 1.0", f"m = {{ value = {MASS}").replace(", sd = 0.5", "")
MORE = f"""[elements.more]
kind = "spring"
on = "x"
cubic = "c"
[elements.more.parameters]
c = {{ value = {CUBIC}, unit = "N/m^3" }}
[elements.wind]
kind = "drag"
on = "x"
drag = "b"
[elements.wind.parameters]
b = {{ value = {DRAG}, unit = "N*s^2/m^2" }}
"""
SCHEMA = json.loads(
    (Path(sh.__file__).parent / "report" / "learned.schema.json").read_text("utf-8")
)
TERMS = {"x**3": -CUBIC, "abs(x')*x'": -DRAG}  # of ΔF


def recorded(truth: str, seed: int, size: float = 15.0) -> sh.Recording:
    """A multisine of 20 s, with noise."""
    t = np.arange(0, 20, 0.03)
    rng = np.random.default_rng(seed)
    phases, lines = rng.uniform(0, 2 * np.pi, 12), np.linspace(0.2, 1.6, 12)
    f = size * np.mean(np.sin(2 * np.pi * lines * t[:, None] + phases), axis=1)
    run = simulate(
        sh.build(parse_model(truth)), Scenario(t, np.zeros(1), np.zeros(1), t, f[:, None])
    )
    x = run.q[:, 0] + NOISE * rng.standard_normal(t.size)
    return sh.Recording(f"run{seed}", t, {"f": f}, {"laser": x}, (), str(seed))


@pytest.fixture(scope="module")
def model() -> sh.Model:
    return parse_model(TEXT)


@pytest.fixture(scope="module")
def train() -> sh.Recording:
    return recorded(TEXT + MORE, 1)


@pytest.fixture(scope="module")
def unseen() -> sh.Recording:
    return recorded(TEXT + MORE, 2, size=12.0)


@pytest.fixture(scope="module")
def nothing() -> sh.Recording:
    return recorded(TEXT, 3)


@pytest.fixture(scope="module")
def sparse(model: sh.Model, train: sh.Recording, unseen: sh.Recording) -> Learned:
    return sh.learn(model, train, unseen)


@pytest.fixture(scope="module")
def network(model: sh.Model, train: sh.Recording, unseen: sh.Recording) -> Learned:
    return sh.learn(model, train, unseen, by="network")


def window_error(learned: Learned, moment: str) -> float:
    """NRMSE over windows of the unseen recording."""
    holdout = learned.verdict.holdout
    assert holdout is not None
    error = getattr(holdout, moment).window_nrmse["laser"]
    assert error is not None
    return float(error)


def require_truth(learned: Learned, truth: dict[str, float], factor: float = 1.0) -> None:
    """All terms and no others, within three deviations or 2 %."""
    found = {one.term: one for one in learned.terms}
    assert set(found) == set(truth)
    for term, value in truth.items():
        sd = found[term].sd
        assert sd is not None
        assert 0 < sd < 0.05 * abs(value * factor)
        off = abs(found[term].value - value * factor)
        assert off < max(3 * sd, 0.02 * abs(value * factor)), found[term]


def run_of(model: sh.Model, recording: sh.Recording) -> np.ndarray:
    f = recording.inputs["f"][:, None]
    scenario = Scenario(recording.t, np.zeros(1), np.zeros(1), recording.t, f)
    return simulate(sh.build(model), scenario).q


# --- sparse regression ----------------------------------------------------------------------------


def test_a_planted_cubic_and_drag_are_recovered_from_noise(sparse: Learned) -> None:
    require_truth(sparse, TERMS)
    assert [one.element for one in sparse.terms] == ["learned_spring", "learned_drag"]
    assert window_error(sparse, "after") < 0.2 * window_error(sparse, "before")
    assert sparse.worth is not None
    assert sparse.worth.learned == pytest.approx(1, abs=0.3)
    assert "cubic stiffness of" in sparse.sentence
    assert "drag quadratic in speed" in sparse.sentence


@pytest.mark.parametrize("optimizer", ["sr3", "ssr"])
def test_other_optimisers_come_to_the_same(
    model: sh.Model, train: sh.Recording, optimizer: str
) -> None:
    require_truth(sh.learn(model, train, optimizer=optimizer), TERMS)


def test_what_is_unseen_never_chooses(
    model: sh.Model, train: sh.Recording, unseen: sh.Recording, sparse: Learned
) -> None:
    noise = {"laser": np.random.default_rng(0).standard_normal(unseen.t.size)}
    other = sh.learn(model, train, replace(unseen, sensors=noise))
    assert other.terms == sparse.terms


def test_the_original_is_a_prefix_and_the_file_simulates_the_same(
    model: sh.Model, sparse: Learned, unseen: sh.Recording, tmp_path: Path
) -> None:
    assert sparse.corrected is not None
    sh.write_model(sparse.corrected, tmp_path / "corrected.toml")
    assert (tmp_path / "corrected.toml").read_bytes().startswith(TEXT.encode())
    again = sh.read_model(tmp_path / "corrected.toml")
    assert np.array_equal(run_of(again, unseen), run_of(sparse.corrected, unseen))
    apart = np.abs(run_of(again, unseen) - run_of(parse_model(TEXT + MORE), unseen)).max()
    assert apart < 0.05 * np.abs(run_of(again, unseen) - run_of(model, unseen)).max()
    found = dict(again.elements[-1].found)
    assert found["by"] == "sparse"
    assert found["nrmse"] == (
        pytest.approx(window_error(sparse, "before"), rel=1e-3),
        pytest.approx(window_error(sparse, "after"), rel=1e-3),
    )


def test_the_unit_of_a_coordinate_changes_nothing(train: sh.Recording, sparse: Learned) -> None:
    text = TEXT.replace('x = { unit = "m" }', 'x = { unit = "mm" }')
    learned = sh.learn(parse_model(text), train)
    for one, other in zip(learned.terms, sparse.terms, strict=True):
        assert one.unit == other.unit
        assert one.value == pytest.approx(other.value, rel=1e-6)


def test_where_nothing_is_missing_nothing_is_learned(
    model: sh.Model, nothing: sh.Recording
) -> None:
    learned = sh.learn(model, nothing)
    assert not learned.something
    assert learned.terms == ()
    assert learned.corrected == model
    assert learned.sentence.startswith("Nothing was learned")
    assert learned.verdict.train.before == learned.verdict.train.after


def test_a_force_that_feeds_energy_in_is_a_law_and_no_damper(model: sh.Model) -> None:
    drives = '[elements.motor]\nkind = "law"\non = "x"\nforce = "g*x\'"\n'
    drives += '[elements.motor.parameters]\ng = { value = 0.35, unit = "N*s/m" }\n'
    learned = sh.learn(model, recorded(TEXT + drives, 4))
    (term,) = learned.terms
    assert (term.term, term.element) == ("x'", "learned_law")
    assert term.value == pytest.approx(0.35, abs=0.02)


# --- rates ----------------------------------------------------------------------------------------


def test_rates_are_forces_over_the_mass(
    model: sh.Model, train: sh.Recording, unseen: sh.Recording, sparse: Learned
) -> None:
    learned = sh.learn(model, train, unseen, formulation="rates")
    require_truth(learned, TERMS, 1 / MASS)
    assert [one.unit for one in learned.terms] == ["1/m^2/s^2", "1/m"]
    assert learned.corrected is not None
    assert sparse.corrected is not None
    assert np.allclose(
        run_of(learned.corrected, unseen), run_of(sparse.corrected, unseen), atol=1e-4
    )


def swung(seed: int, start: tuple[float, float]) -> tuple[sh.Model, sh.Recording]:
    """A model of a cart and a pole that does not know that the joint rubs, and a recording."""
    sensors = '[sensors]\nangle = { measures = "phi", unit = "rad" }\n'
    model, truth = (
        parse_model(cart_and_pole(rubs).text.replace("[sensors]\n", sensors))
        for rubs in (False, True)
    )
    t, rng = np.arange(0, 12, 0.01), np.random.default_rng(seed)
    scenario = Scenario(t, np.array(start), np.zeros(2), t, np.empty((t.size, 0)))
    run = simulate(sh.build(truth), scenario)
    noise = {"x": 5e-4, "angle": 5e-4, "pull": 1e-2}
    names = [sensor.name for sensor in truth.sensors]
    signals = {
        name: run.y[:, names.index(name)] + sd * rng.standard_normal(t.size)
        for name, sd in noise.items()
    }
    return model, sh.Recording(f"swung{seed}", t, {}, signals, (), f"swung{seed}")


@pytest.fixture(scope="module")
def pole() -> tuple[sh.Model, sh.Recording]:
    return swung(1, (0.1, 1.2))


@pytest.mark.slow
def test_a_force_is_a_simple_law_where_its_rates_are_none(
    pole: tuple[sh.Model, sh.Recording],
) -> None:
    """M depends on the angle: one damper is several rates, of both coordinates."""
    force, rates = (sh.learn(*pole, formulation=level) for level in ("force", "rates"))
    (damper,) = force.terms
    assert (damper.coordinate, damper.term) == ("phi", "phi'")
    assert damper.value == pytest.approx(-0.02, rel=0.02)
    assert len(rates.terms) > 1
    assert {one.coordinate for one in rates.terms} == {"x", "phi"}
    assert rates.corrected is not None
    texts = [element.values[0][1].text for element in rates.corrected.elements[-2:]]
    assert all("l*m*cos(phi)" in text for text in texts)


def test_networks_of_coupled_rates_are_simulated_but_not_written(
    pole: tuple[sh.Model, sh.Recording],
) -> None:
    model, train = pole
    learned = sh.learn(model, train, swung(2, (-0.05, 0.9))[1], by="network", formulation="rates")
    assert learned.corrected is None
    assert learned.correction is not None
    assert any("cannot be written as a model file" in note for note in learned.notes)
    holdout = learned.verdict.holdout
    assert holdout is not None
    before, after = holdout.before.free_run_nrmse["angle"], holdout.after.free_run_nrmse["angle"]
    assert before is not None
    assert after is not None
    assert after < 0.3 * before
    content = learned_json(learned)
    jsonschema.validate(content, SCHEMA)
    assert content["file"] is None
    assert content["scores"]["window_s"] is None
    assert all(one["weights"]["symhyb-network"] == 1 for one in content["networks"])
    t = np.arange(0, 1, 0.01)
    scenario = Scenario(t, np.array([0.1, 1.2]), np.zeros(2), t, np.empty((t.size, 0)))
    run = simulate_corrected(sh.build(model), scenario, learned.correction)
    assert run.complete


def test_terms_of_rates_that_no_file_can_hold_are_simulated(
    pole: tuple[sh.Model, sh.Recording], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("symhyb.correction.learning.terms.mass_texts", lambda model: None)
    learned = sh.learn(*pole, formulation="rates")
    assert learned.corrected is None
    assert learned.terms
    assert all(one.element == "" for one in learned.terms)
    train = learned.verdict.train
    before, after = train.before.free_run_nrmse["angle"], train.after.free_run_nrmse["angle"]
    assert before is not None
    assert after is not None
    assert after < 0.2 * before
    jsonschema.validate(learned_json(learned), SCHEMA)


# --- networks -------------------------------------------------------------------------------------


def test_a_network_halves_the_error_on_an_unseen_recording(network: Learned) -> None:
    assert window_error(network, "after") < 0.5 * window_error(network, "before")
    (one,) = network.networks
    assert one.inputs == ("x", "x'")
    assert one.element is not None
    assert all(low < 0 < high for low, high in one.trust)


@pytest.mark.slow
def test_networks_are_the_same_from_the_same_seed(
    model: sh.Model, train: sh.Recording, network: Learned
) -> None:
    again, other = (sh.learn(model, train, by="network", seed=seed) for seed in (0, 7))
    digests = [
        one.networks[0].element.network.sha256  # type: ignore[union-attr]
        for one in (network, again, other)
    ]
    assert digests[0] == digests[1] != digests[2]


def test_a_network_of_rates_with_one_mass_is_written_as_a_force(
    model: sh.Model, train: sh.Recording, unseen: sh.Recording
) -> None:
    learned = sh.learn(model, train, unseen, by="network", formulation="rates")
    (one,) = learned.networks
    assert one.element is not None
    assert learned.corrected is not None
    assert window_error(learned, "after") < 0.5 * window_error(learned, "before")


def test_no_network_where_nothing_is_missing(model: sh.Model, nothing: sh.Recording) -> None:
    learned = sh.learn(model, nothing, by="network")
    assert not learned.something
    assert learned.corrected == model


# --- misuse ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"by": "sparce"}, "did you mean 'sparse'?"),
        ({"formulation": "forces"}, "did you mean 'force'?"),
        ({"library": "law"}, "did you mean 'laws'?"),
        ({"optimizer": "stlqs"}, "did you mean 'stlsq'?"),
        ({"degree": 0}, "a degree of 0"),
        ({"on": ["y"]}, "'y' is no free coordinate; known: x"),
        ({"by": "network", "inputs": ["g"]}, "not 'g'"),
    ],
)
def test_misuse_is_said_in_a_sentence(
    model: sh.Model, train: sh.Recording, options: dict[str, object], said: str
) -> None:
    with pytest.raises(sh.InputError, match=said.replace("?", r"\?")):
        sh.learn(model, train, **options)


def test_a_machine_that_stands_still_teaches_nothing(model: sh.Model) -> None:
    t = np.arange(0, 5, 0.01)
    run = sh.Recording("still", t, {"f": 0 * t}, {"laser": 0 * t}, (), "")
    with pytest.raises(sh.InputError, match="no sensor changes"):
        sh.learn(model, run)


# --- the verb -------------------------------------------------------------------------------------

FILES = {"corrected.toml", "learned.json", "report.html", "simulation.csv"}
Call = Callable[..., tuple[int, str, str]]


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Run ``symhyb learn`` in this process: its status and what it printed."""

    def learn(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["symhyb", "learn", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            main()
        out, err = capsys.readouterr()
        return int(stop.value.code or 0), out, err

    return learn


@pytest.fixture(scope="module")
def files(
    tmp_path_factory: pytest.TempPathFactory,
    train: sh.Recording,
    unseen: sh.Recording,
    nothing: sh.Recording,
) -> Path:
    """A folder with the model and the recordings as files."""
    folder = tmp_path_factory.mktemp("files")
    (folder / "model.toml").write_text(TEXT, encoding="utf-8")
    for name, one in {"train": train, "unseen": unseen, "nothing": nothing}.items():
        table = np.column_stack([one.t, one.inputs["f"], one.sensors["laser"]])
        np.savetxt(folder / f"{name}.csv", table, delimiter=",", header="t,f,x", comments="")
    return folder


def test_the_verb_leaves_valid_files(call: Call, files: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    recordings = (files / "train.csv", "--holdout", files / "unseen.csv", "--map", "laser=x")
    status, said, _ = call(files / "model.toml", *recordings, "--by", "sparse", "-o", out)
    assert status == 0
    assert "ΔF_x = −" in said
    assert {file.name for file in out.iterdir()} == FILES
    assert (out / "corrected.toml").read_bytes().startswith((files / "model.toml").read_bytes())
    content = json.loads((out / "learned.json").read_text("utf-8"))
    jsonschema.validate(content, SCHEMA)
    assert (content["by"], content["formulation"], content["learned"]) == ("sparse", "force", True)
    assert {one["term"]: one["element"] for one in content["terms"]} == {
        "x**3": "learned_spring",
        "abs(x')*x'": "learned_drag",
    }
    assert all(one["place"] == {"on": "x"} for one in content["terms"])
    corrected = sh.read_model(out / "corrected.toml")
    keys = {p.path: p.value for p in corrected.all_parameters()}
    for one in content["terms"]:  # passive kinds resist: their keys carry the other sign
        (own,) = (value for path, value in keys.items() if path.startswith(one["element"]))
        assert own == pytest.approx(-one["value"])
    scores = content["scores"]["holdout"]
    assert scores["after"]["window_nrmse"]["laser"] < scores["before"]["window_nrmse"]["laser"]
    assert set(content["manifest"]) == {
        "model",
        "recordings",
        "map",
        "versions",
        "seeds",
        "seconds",
    }
    page = (out / "report.html").read_text("utf-8")
    assert "learned_drag" in page
    assert "default-src &#39;none&#39;" in page  # nothing is fetched
    header = (out / "simulation.csv").read_text("utf-8").splitlines()[0]
    assert "laser_after [m]" in header


def test_the_verb_ends_with_1_where_nothing_is_learned(
    call: Call, files: Path, tmp_path: Path
) -> None:
    arguments = (files / "model.toml", files / "nothing.csv", "--map", "laser=x")
    status, said, _ = call(*arguments, "--by", "sparse", "--json", "-o", tmp_path / "out")
    assert status == 1
    assert json.loads(said)["terms"] == []
    text = (tmp_path / "out" / "corrected.toml").read_text("utf-8")
    assert text == (files / "model.toml").read_text("utf-8")


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--by", "magic"), "'magic'"),
        ((), "Missing option"),
        (("--by", "sparse", "--on", "y"), "'y' is no free coordinate; known: x"),
        (("--by", "sparse", "--degree", "12"), "a degree of 12 is none"),
    ],
)
def test_misuse_ends_with_status_2(
    call: Call, files: Path, tmp_path: Path, more: tuple[str, ...], said: str
) -> None:
    arguments = (files / "model.toml", files / "train.csv", "--map", "laser=x")
    status, out, err = call(*arguments, *more, "-o", tmp_path / "out")
    assert (status, out) == (2, "")
    assert said in err
    assert not (tmp_path / "out").exists()


def test_an_interrupted_run_leaves_nothing(
    call: Call, files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("symhyb.learned_run.learn", interrupted)
    arguments = (files / "model.toml", files / "train.csv", "--map", "laser=x")
    status, _, err = call(*arguments, "--by", "sparse", "-o", tmp_path / "out")
    assert status == 130
    assert "interrupted" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_diagnosis_beside_it_names_the_same(call: Call, files: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    arguments = (files / "model.toml", files / "train.csv", "--map", "laser=x")
    status, said, _ = call(*arguments, "--by", "network", "--beside", "-o", out)
    assert status == 0
    assert "A diagnosis says:" in said
    content = json.loads((out / "learned.json").read_text("utf-8"))
    jsonschema.validate(content, SCHEMA)
    assert {one["kind"] for one in content["beside"]["found"]} == {"spring", "drag"}
    names = {file.name for file in out.iterdir()}
    assert {*FILES, "diagnosed.toml", "diagnosis.json"} < names
    assert sum(name.startswith("network-") for name in names) == 1
    sh.read_model(out / "corrected.toml")

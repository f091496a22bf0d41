"""A trained network on top of named laws: exact, reproducible, beside them, and worth something."""

import hashlib
import json
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from builders import DRIVEN_MASS, value
from sklearn.neural_network import MLPRegressor

from symhyb.correction.learning.energy import energy_of
from symhyb.correction.learning.network import Trained, _trained, lowered, train_network
from symhyb.correction.learning.orthogonal import beside
from symhyb.correction.learning.refining import Fitting, features, joined
from symhyb.correction.learning.seen import Seen, see
from symhyb.correction.search.preparing import last_windows, prepare
from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.judge import judge
from symhyb.errors import InputError
from symhyb.model.read import parse_model, read_model
from symhyb.model.types import Model
from symhyb.model.write import write_model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.network import Layer, Weights, evaluated, force_of, parsed, stored
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario

NOISE = 1e-3  # m, of an amplitude of some 0.3 m
TEXT = DRIVEN_MASS
# a bump that no polynomial of low degree follows; a part of it is a change of k
MORE = """[elements.more]
kind = "law"
on = "x"
force = "-(a*x' + b*x)*exp(-(x/w)**2)"
[elements.more.parameters]
a = { value = 2.0, unit = "N*s/m" }
b = { value = 0.2, unit = "N/m" }
w = { value = 0.1, unit = "m" }
"""


def recorded(truth: str, seed: int, size: float = 6.0) -> Recording:
    t = np.arange(0, 20, 0.03)
    rng = np.random.default_rng(seed)
    phases, lines = rng.uniform(0, 2 * np.pi, 12), np.linspace(0.2, 1.8, 12)
    f = size * np.mean(np.sin(2 * np.pi * lines * t[:, None] + phases), axis=1)
    run = simulate(build(parse_model(truth)), Scenario(t, np.zeros(1), np.zeros(1), t, f[:, None]))
    x = run.q[:, 0] + NOISE * rng.standard_normal(t.size)
    return Recording(f"run{seed}", t, {"f": f}, {"laser": x}, (), str(seed))


@pytest.fixture(scope="module")
def model() -> Model:
    return parse_model(TEXT)


@pytest.fixture(scope="module")
def recording() -> Recording:
    return recorded(TEXT + MORE, 1)


@pytest.fixture(scope="module")
def seen(model: Model, recording: Recording) -> Seen:
    prepared = prepare(model, recording)
    return see(prepared, last_windows(prepared, spread=True), None, ())


@pytest.fixture(scope="module")
def trained(model: Model, recording: Recording) -> Trained:
    found = train_network(model, recording)
    assert found is not None
    return found


@pytest.mark.parametrize("activation", ["tanh", "relu", "logistic", "identity"])
def test_a_regressor_is_lowered_exactly(activation: str) -> None:
    """Values against its own prediction, slopes against the chain rule in NumPy."""
    rng = np.random.default_rng(3)
    mean, scale, gain, offset = np.array([0.3, -2.0]), np.array([0.05, 4.0]), 7.0, -1.5
    x = mean + scale * rng.standard_normal((200, 2))
    standard = (x - mean) / scale
    mlp = MLPRegressor(
        hidden_layer_sizes=(7, 5),
        activation=activation,
        max_iter=20,
        tol=10,
        n_iter_no_change=5,
        random_state=1,
    )
    mlp.fit(standard, np.sin(standard[:, 0]) * standard[:, 1])
    weights = parsed(stored(lowered(mlp, mean, scale, gain, offset)), "file")
    wanted = gain * mlp.predict(standard) + offset
    assert np.abs(evaluated(weights, x) - wanted).max() < 1e-12
    symbol = ca.SX.sym("x", 2)
    trust = tuple((low, high) for low, high in zip(x.min(axis=0), x.max(axis=0), strict=True))
    force = force_of(weights, trust, symbol)
    function = ca.Function("f", [symbol], [force, ca.jacobian(force, symbol)])
    for row, value_, z in zip(x, wanted, standard, strict=True):
        found, slope = (np.array(part).ravel() for part in function(row))
        assert found == pytest.approx([value_], abs=1e-12)
        assert slope == pytest.approx(gain * slopes(mlp, activation, z) / scale, abs=1e-12)


def slopes(mlp: MLPRegressor, activation: str, z: np.ndarray) -> np.ndarray:
    """∂/∂z (2,) of the prediction of a regressor."""
    h, total = z, np.eye(2)
    for i, (weights, bias) in enumerate(zip(mlp.coefs_, mlp.intercepts_, strict=True)):
        before = h @ weights + bias
        last = i == len(mlp.coefs_) - 1
        h, steep = {
            "identity": (before, np.ones_like(before)),
            "tanh": (np.tanh(before), 1 - np.tanh(before) ** 2),
            "relu": (np.maximum(before, 0), (before > 0).astype(float)),
            "logistic": (1 / (1 + np.exp(-before)), np.exp(-before) / (1 + np.exp(-before)) ** 2),
        }["identity" if last else activation]
        total = total @ (weights * steep)
    return total[:, 0]


def test_within_what_was_seen_an_unseen_run_is_met_to_the_noise(
    model: Model, trained: Trained
) -> None:
    verdict = judge(model, trained.model, recorded(TEXT + MORE, 2, size=4.0))
    assert verdict.holdout is not None
    before, after = verdict.holdout.before, verdict.holdout.after
    for first, second in (
        (before.free_run_rmse["laser"], after.free_run_rmse["laser"]),
        (before.window_rmse["laser"], after.window_rmse["laser"]),
    ):
        assert first is not None
        assert second is not None
        assert first > 3 * NOISE
        assert second < 1.5 * NOISE


def test_refining_on_the_simulation_error_lowers_that_of_held_windows(trained: Trained) -> None:
    nothing, first, refined = trained.held
    assert refined < first < nothing
    assert trained.refined
    assert f"to {refined:.4g} ({first:.4g} before it was refined" in trained.sentence


def test_the_named_laws_stay_as_they_are(model: Model, trained: Trained) -> None:
    assert trained.model.text.startswith(model.text)
    named = {item.path: item.value for item in trained.model.all_parameters()}
    assert named == {item.path: item.value for item in model.all_parameters()}


def test_it_does_nothing_that_a_change_of_a_named_value_would_do(
    recording: Recording, trained: Trained, seen: Seen
) -> None:
    force, laws = evaluated(trained.weights, seen.x[seen.fitted]), seen.laws[seen.fitted]
    assert cosines(force, laws) == pytest.approx([0.0], abs=1e-6)  # k, which states an sd
    # the same where a named value would take most of what is lacking: the damping
    text = TEXT.replace('unit = "N*s/m" }', 'unit = "N*s/m", sd = 0.1 }')
    prepared = prepare(parse_model(text), recording)
    other = see(prepared, last_windows(prepared, spread=True), None, ())
    rows = other.fitted
    assert cosines(other.force[rows], other.laws[rows])[1] > 0.3
    members = _trained(other, 6, 2, 0)
    r = Fitting.of(prepared, other, members).r
    force = features(joined(members), other.x[rows]) @ r
    assert cosines(force, other.laws[rows]) == pytest.approx([0.0, 0.0], abs=1e-6)
    assert np.linalg.norm(force) > 0.1 * np.linalg.norm(other.force[rows])


def cosines(force: np.ndarray, laws: np.ndarray) -> np.ndarray:
    return np.abs(force @ laws) / np.linalg.norm(force) / np.linalg.norm(laws, axis=0)


def test_the_directions_beside_laws_are_all_that_are_orthogonal_to_them() -> None:
    rng = np.random.default_rng(0)
    forces, laws = rng.standard_normal((50, 6)), rng.standard_normal((50, 2))
    basis = beside(forces, np.column_stack([laws, laws[:, 0] + laws[:, 1], np.zeros(50)]))
    assert basis.shape == (6, 4)
    assert np.linalg.matrix_rank(basis) == 4
    assert np.abs(laws.T @ forces @ basis).max() < 1e-10


def test_the_same_seed_trains_the_same_network(
    model: Model, recording: Recording, trained: Trained
) -> None:
    again = train_network(model, recording)
    assert again is not None
    assert again.element == trained.element  # and with it the hash of the weights
    other = train_network(model, recording, seed=7)
    assert other is not None
    assert other.element != trained.element


def test_held_windows_have_no_part_in_the_training(
    model: Model, recording: Recording, seen: Seen
) -> None:
    """Neither do they choose when to stop: their samples are no part of any fold."""
    other = seen.force.copy()
    other[~seen.fitted] = 1e6
    first = _trained(seen, 4, 1, 0)
    changed = Seen(
        seen.on,
        seen.inputs,
        seen.x,
        other,
        seen.laws,
        seen.q,
        seen.v,
        seen.t,
        seen.run,
        seen.fitted,
        seen.names,
    )
    assert stored(_trained(changed, 4, 1, 0)[0]) == stored(first[0])
    assert 0.2 < np.mean(~seen.fitted) < 0.5


def test_the_weights_are_written_beside_the_model(trained: Trained, tmp_path: Path) -> None:
    target = tmp_path / "out" / "corrected.toml"
    target.parent.mkdir()
    write_model(trained.model, target)
    network = trained.element.network
    assert network is not None
    data = (target.parent / network.weights).read_bytes()
    assert hashlib.sha256(data).hexdigest() == network.sha256
    json.loads(data)
    again = build(read_model(target))
    here = build(trained.model)
    for x, v in ((0.1, 0.2), (-0.2, 0.4)):
        given = [x], [v], [], [0.0], 0
        assert value(again.k_e, *given, again.values) == value(here.k_e, *given, here.values)
    moved = tmp_path / "moved.toml"
    write_model(read_model(target), moved)
    assert (tmp_path / network.weights).read_bytes() == data


def test_other_weights_of_the_same_name_are_not_overwritten(
    trained: Trained, tmp_path: Path
) -> None:
    assert trained.element.network is not None
    other = tmp_path / trained.element.network.weights
    other.write_text("of somebody else")
    with pytest.raises(InputError, match="holds the weights of another network"):
        write_model(trained.model, tmp_path / "corrected.toml")
    assert other.read_text() == "of somebody else"
    assert not (tmp_path / "corrected.toml").exists()


def test_outside_of_what_was_seen_its_force_fades(trained: Trained, seen: Seen) -> None:
    machine = build(trained.model)
    assert trained.element.network is not None
    assert trained.element.network.trust == seen.box
    low, high = seen.box[0]
    far = high + 0.2 * (high - low)
    linear = build(parse_model(TEXT))
    for x, alike in ((far, True), (0.5 * high, False)):
        given = [x], [0.1], [], [0.0], 0
        difference = value(machine.k_e, *given, machine.values) - value(
            linear.k_e, *given, linear.values
        )
        assert (abs(difference[0]) < 1e-12) == alike


def test_where_nothing_is_left_there_is_none(model: Model) -> None:
    assert train_network(model, recorded(TEXT, 3)) is None


def test_the_members_give_a_band_that_is_wide_where_they_saw_nothing(trained: Trained) -> None:
    low, high = trained.element.network.trust[0]  # type: ignore[union-attr]
    inside = np.column_stack([np.linspace(low, high, 50) / 2, np.zeros(50)])
    outside = inside + np.array([2 * (high - low), 0.0])
    assert len(trained.members) == 3
    assert trained.band(inside).shape == (50,)
    assert np.median(trained.band(outside)) > 3 * np.median(trained.band(inside))
    assert 0 < trained.spread < 0.5


def damping(d: float) -> Weights:
    """A network of one linear layer: F = −d x'."""
    layer = Layer(np.array([[0.0, -d]]), np.zeros(1), "identity")
    return Weights(np.zeros(2), np.ones(2), (layer,), 1.0, 0.0)


def test_a_force_that_feeds_energy_in_is_said(seen: Seen) -> None:
    passive, active = energy_of(damping(0.4), seen), energy_of(damping(-0.4), seen)
    assert not passive.feeds
    assert "on no closed orbit" in passive.sentence
    assert active.feeds
    assert "it is not passive" in active.sentence
    assert active.net[0][1] == pytest.approx(-passive.net[0][1])
    half = (seen.q.max() - seen.q.min()) / 2
    fastest = min(seen.v.max(), -seen.v.min())
    assert active.orbits[-1] == pytest.approx(0.4 * np.pi * half * fastest)  # ∮ d v ds


def test_a_spring_does_no_work_on_closed_orbits(seen: Seen) -> None:
    layer = Layer(np.array([[-3.0, 0.0]]), np.zeros(1), "identity")
    energy = energy_of(Weights(np.zeros(2), np.ones(2), (layer,), 1.0, 0.0), seen)
    assert max(abs(work) for work in energy.orbits) < 1e-12
    assert energy.turnover > 0


def test_it_sees_what_it_is_reported_to_see(model: Model, recording: Recording) -> None:
    prepared = prepare(model, recording)
    cuts = last_windows(prepared, spread=True)
    found = see(prepared, cuts, "x", ("f", "t", "x'"))
    rows = np.searchsorted(recording.t, found.t)
    assert found.x[:, 0] == pytest.approx(recording.inputs["f"][rows])
    assert found.x[:, 1] == pytest.approx(found.t)
    assert found.x[:, 2] == pytest.approx(found.v)
    layer = Layer(np.array([[0.0, 0.0, 1.0]]), np.zeros(1), "identity")
    energy = energy_of(Weights(np.zeros(3), np.ones(3), (layer,), 1.0, 0.0), found)
    assert energy.orbits == ()
    assert "orbits say nothing" in energy.sentence


def test_what_cannot_be_is_refused(model: Model, trained: Trained) -> None:
    run = recorded(TEXT, 3)
    with pytest.raises(InputError, match="'y' is no free coordinate; there are: x"):
        train_network(model, run, on="y")
    with pytest.raises(InputError, match="has a trained network already"):
        train_network(trained.model, run)
    with pytest.raises(InputError, match="a network can see x, x', f, t, not 'g'"):
        train_network(model, run, inputs=["x", "g"])
    with pytest.raises(InputError, match="sees each of x, x once"):
        train_network(model, run, inputs=["x", "x"])
    with pytest.raises(InputError, match="at least one member"):
        train_network(model, run, members=0)
    still = Recording("still", run.t, {"f": 0 * run.t + 1}, run.sensors, (), "still")
    with pytest.raises(InputError, match="'f' never changes"):
        train_network(model, still, inputs=["x", "f"])

"""A trained force in the place of a law: filled, faded outside its training, refused if damaged."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from builders import value

from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.lowered import network
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.network import read_weights

HIDDEN = [[0.8, -0.3], [0.2, 0.9], [-1.1, 0.4]]
BIAS = [0.1, -0.2, 0.3]
OUT = [[1.2, -0.7, 0.5]]
WEIGHTS: Mapping[str, object] = {
    "symhyb-network": 1,
    "mean": [0.1, -0.2],
    "scale": [0.5, 2.0],
    "gain": 3.0,
    "offset": 0.4,
    "layers": [
        {"weights": HIDDEN, "bias": BIAS, "activation": "tanh"},
        {"weights": OUT, "bias": [0.05], "activation": "identity"},
    ],
}
MODEL = """
symhyb = 1
[coordinates]
x = {{ unit = "m" }}
y = {{ unit = "m" }}
[parameters]
m = {{ value = 1.2, unit = "kg" }}
l = {{ value = 1.0, unit = "m" }}
w = {{ value = 1.0, unit = "m/s" }}
[points]
a = ["l + x", "0"]
b = ["0", "l + y"]
[bodies.one]
mass = "m"
at = "a"
[bodies.two]
mass = "m"
at = "b"
[elements.learnt]
kind = "network"
{place}
weights = "learnt.json"
sha256 = "{digest}"
inputs = ["x", "y' + x'"]
trust = [[-1.0, 1.0], [-4.0, 4.0]]
"""


def by_hand(x: float, rate: float) -> float:
    """The network of ``WEIGHTS`` in NumPy."""
    h = (np.array([x, rate]) - [0.1, -0.2]) / [0.5, 2.0]
    h = np.tanh(np.array(HIDDEN) @ h + BIAS)
    return float(3.0 * (np.array(OUT) @ h + 0.05)[0] + 0.4)


def written(folder: Path, document: object = WEIGHTS, place: str = 'on = "x"') -> Model:
    """The model with a file of weights beside it."""
    text = document if isinstance(document, str) else json.dumps(document)
    (folder / "learnt.json").write_text(text, encoding="utf-8")
    digest = hashlib.sha256(text.encode()).hexdigest()
    return parse_model(MODEL.format(place=place, digest=digest), str(folder / "model.toml"))


def force(model: Model, x: float, v: tuple[float, float], y: float = 0.0) -> np.ndarray:
    machine = build(model)
    return value(machine.elements, [x, y], v, [], [], 0, machine.values)


def test_a_network_fills_the_hole_of_its_element(tmp_path: Path) -> None:
    model = written(tmp_path)
    for x, rate in ((0.0, 0.0), (0.4, -1.3), (-0.9, 3.5)):
        assert force(model, x, (0.3, rate - 0.3)) == pytest.approx([by_hand(x, rate), 0])


def test_a_network_between_points_is_a_tension(tmp_path: Path) -> None:
    model = written(tmp_path, place='between = ["a", "b"]')
    tension, direction = by_hand(0.0, 0.5), np.array([1, 1]) / np.sqrt(2)
    assert force(model, 0.0, (0.2, 0.3)) == pytest.approx(-tension * direction)


def test_a_network_is_part_of_k_e_and_of_its_slopes(tmp_path: Path) -> None:
    machine = build(written(tmp_path))
    k_e = value(machine.k_e, [0.2, 0.0], [0.1, 0.4], [], [], 0, machine.values)
    assert k_e == pytest.approx([by_hand(0.2, 0.5), 0])


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("side", [1, -1])
def test_outside_its_trust_the_force_fades_to_zero(tmp_path: Path, axis: int, side: int) -> None:
    """Over a tenth of the width of the box, without a step: half way out half the force."""
    model = written(tmp_path)
    edge, margin = ((1.0, 0.2), (4.0, 0.8))[axis]

    def at(distance: float) -> tuple[float, float]:
        point = [0.2, 0.5]
        point[axis] = side * (edge + distance)
        (first, _) = force(model, point[0], (0.0, point[1]))
        return float(first), by_hand(*point)

    for share, kept in ((0.0, 1.0), (0.25, 27 / 32), (0.5, 0.5), (1.0, 0.0), (30.0, 0.0)):
        found, full = at(share * margin)
        assert abs(full) > 0.05
        assert found == pytest.approx(kept * full, abs=1e-12)


@pytest.mark.parametrize("name", ["identity", "tanh", "relu", "logistic"])
def test_activations(tmp_path: Path, name: str) -> None:
    curves = {
        "identity": lambda x: x,
        "tanh": np.tanh,
        "relu": lambda x: np.maximum(x, 0),
        "logistic": lambda x: 1 / (1 + np.exp(-x)),
    }
    layers = [{"weights": [[2.0, 0.0]], "bias": [0.1], "activation": name}]
    plain = {"mean": [0, 0], "scale": [1, 1], "gain": 1, "offset": 0}
    model = written(tmp_path, {**WEIGHTS, **plain, "layers": layers})
    for x in (-0.6, 0.3):
        assert force(model, x, (0, 0))[0] == pytest.approx(curves[name](2 * x + 0.1))


def refused(model: Model) -> str:
    with pytest.raises(InputError) as caught:
        build(model)
    (problem,) = caught.value.problems
    assert "learnt.json" in str(problem)
    return str(problem)


def test_weights_of_another_hash_are_refused(tmp_path: Path) -> None:
    model = written(tmp_path)
    path = tmp_path / "learnt.json"
    path.write_text(path.read_text().replace("0.8", "0.9"))
    changed_to = hashlib.sha256(path.read_bytes()).hexdigest()
    assert f"the file has SHA-256 {changed_to}, the model asks for " in refused(model)


def test_weights_that_are_missing_are_refused(tmp_path: Path) -> None:
    model = written(tmp_path)
    (tmp_path / "learnt.json").unlink()
    assert "weights of a network: there is no such file" in refused(model)


def test_a_file_that_is_too_large_is_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(network, "WEIGHTS_BYTES", 100)
    assert "weights of a network: is larger than" in refused(written(tmp_path))


def changed(**entries: object) -> Mapping[str, object]:
    return {**WEIGHTS, **entries}


LAYER = {"weights": OUT, "bias": [0.05], "activation": "identity"}
DAMAGED = {
    "no json": '{"symhyb-network": 1, "mean": [',
    "not a table": "[1, 2]",
    "another format": changed(**{"symhyb-network": 2}),
    "no layers": {key: entry for key, entry in WEIGHTS.items() if key != "layers"},
    "layers that do not follow": changed(layers=[LAYER]),
    "a bias that is a table": changed(layers=[{**LAYER, "bias": [[0.05]]}]),
    "two outputs": changed(layers=[{**LAYER, "weights": [[1, 2], [3, 4]], "bias": [0, 0]}]),
    "an unknown activation": changed(
        layers=[{"weights": [[1, 2]], "bias": [0], "activation": "__import__"}]
    ),
    "a scale of zero": changed(scale=[0.5, 0.0]),
    "one scale too few": changed(scale=[0.5]),
    "a mean that is text": changed(mean=["a", "b"]),
    "rows of different length": changed(
        layers=[{"weights": [[1, 2], [3]], "bias": [0, 0], "activation": "tanh"}]
    ),
    "weights that are not finite": changed(
        layers=[{"weights": [[1, float("nan")]], "bias": [0], "activation": "tanh"}]
    ),
    "an infinite gain": changed(gain=float("inf")),
    "deep": "[" * 100_000,
}


@pytest.mark.parametrize("document", DAMAGED.values(), ids=DAMAGED)
def test_damaged_weights_are_refused(tmp_path: Path, document: object) -> None:
    assert f"is no network of format {network.FORMAT}" in refused(written(tmp_path, document))


def test_a_network_of_another_size_is_refused(tmp_path: Path) -> None:
    layers = [{"weights": [[1.0]], "bias": [0.0], "activation": "tanh"}]
    document = changed(mean=[0.0], scale=[1.0], layers=layers)
    assert "the network has 1 inputs, the element gives it 2" in refused(
        written(tmp_path, document)
    )


def test_weights_are_read_as_they_were_written(tmp_path: Path) -> None:
    model = written(tmp_path)
    declared = model.elements[0].network
    assert declared is not None
    weights = read_weights(tmp_path / "learnt.json", declared.sha256)
    assert [layer.activation for layer in weights.layers] == ["tanh", "identity"]
    assert weights.layers[0].weights.tolist() == HIDDEN
    assert (weights.gain, weights.offset) == (3.0, 0.4)

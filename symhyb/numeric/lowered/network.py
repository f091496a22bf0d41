"""A trained force law from its file: read without running anything, checked, lowered to CasADi.

The file is JSON: for a network with I inputs

    {"symhyb-network": 1, "mean": [I], "scale": [I], "gain": number, "offset": number,
     "layers": [{"weights": [[...]], "bias": [...], "activation": "tanh"}, ...]}

    h = (x − mean)/scale;  h = activation(weights h + bias) layer by layer;  F = gain·h + offset

Everything is SI. Outside of the ``trust`` box of the training inputs the force fades to zero over a
tenth of the width of the box.
"""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import casadi as ca
import numpy as np

from symhyb.errors import InputError, Problem
from symhyb.limits import WEIGHTS_BYTES, content_of
from symhyb.model.types import Network
from symhyb.model.weights import kept
from symhyb.numeric.kernels.buffers import Array

FORMAT = 1
FADE = 0.1  # of the width of the trust box
ACTIVATIONS: Mapping[str, Callable[[ca.SX], ca.SX]] = {
    "identity": lambda x: x,
    "tanh": ca.tanh,
    "relu": lambda x: ca.fmax(x, 0),
    "logistic": lambda x: 1 / (1 + ca.exp(-x)),
}
CURVES: Mapping[str, Callable[[Array], Array]] = {
    "identity": lambda x: x,
    "tanh": np.tanh,
    "relu": lambda x: np.maximum(x, 0.0),
    "logistic": lambda x: 1 / (1 + np.exp(-x)),
}


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """activation(weights h + bias), ``weights`` (O, I) and ``bias`` (O,) for I inputs and O
    outputs, dimensionless."""

    weights: Array
    bias: Array
    activation: str


@dataclass(frozen=True, slots=True, eq=False)
class Weights:
    """A network with I inputs and one output, SI: ``mean`` and ``scale`` (I,) of its inputs,
    ``layers``, ``gain`` and ``offset`` of its output."""

    mean: Array
    scale: Array
    layers: tuple[Layer, ...]
    gain: float
    offset: float


def fill_of(network: Network, model_file: str) -> Callable[[ca.SX], ca.SX]:
    """What fills the hole of a network element: the force (SI) from its inputs (I, 1). Weights that
    no file beside the model file holds may be those of a network that was just trained.

    Raises:
        InputError: weights that are missing, damaged, of another hash or of another size.
    """
    path = Path(model_file).parent / network.weights
    trained = None if path.exists() else kept(network.sha256)
    weights = read_weights(path, network.sha256) if trained is None else parsed(trained, str(path))
    if weights.mean.size != len(network.inputs):
        text = (
            f"the network has {weights.mean.size} inputs, the element gives it "
            f"{len(network.inputs)}"
        )
        raise InputError(Problem(text, file=str(path)))
    return lambda inputs: force_of(weights, network.trust, inputs)


def force_of(weights: Weights, trust: tuple[tuple[float, float], ...], inputs: ca.SX) -> ca.SX:
    """The network as an expression, SI, faded outside of its ``trust`` box."""
    h = (inputs - weights.mean) / weights.scale
    for layer in weights.layers:
        h = ACTIVATIONS[layer.activation](ca.mtimes(ca.DM(layer.weights), h) + layer.bias)
    force = weights.gain * h + weights.offset
    for i, (low, high) in enumerate(trust):
        margin = FADE * (high - low)
        beyond = ca.fmax(ca.fmax(low - inputs[i], inputs[i] - high), 0) / margin
        inside = 1 - ca.fmin(beyond, 1)
        force = force * inside**2 * (3 - 2 * inside)
    return force


def read_weights(path: Path, sha256: str) -> Weights:
    """Read and check a file of weights.

    Raises:
        InputError: a file that is missing, too large, of another hash, or no network.
    """
    data = content_of(path, WEIGHTS_BYTES, "weights of a network")
    found = hashlib.sha256(data).hexdigest()
    if found != sha256:
        text = f"the file has SHA-256 {found}, the model asks for {sha256}; it was changed"
        raise InputError(Problem(text, file=str(path)))
    return parsed(data, str(path))


def parsed(data: bytes, file: str) -> Weights:
    """The network that the content of a file of weights states.

    Raises:
        InputError: it is no network.
    """
    try:
        return _weights(json.loads(data))
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
        text = f"is no network of format {FORMAT}: {type(error).__name__} {error}"
        raise InputError(Problem(text, file=file)) from None


def stored(weights: Weights) -> bytes:
    """The content of a file of weights, every number with all its digits."""
    document = {
        "symhyb-network": FORMAT,
        "mean": weights.mean.tolist(),
        "scale": weights.scale.tolist(),
        "gain": weights.gain,
        "offset": weights.offset,
        "layers": [
            {
                "weights": layer.weights.tolist(),
                "bias": layer.bias.tolist(),
                "activation": layer.activation,
            }
            for layer in weights.layers
        ],
    }
    return (json.dumps(document, allow_nan=False) + "\n").encode()


def evaluated(weights: Weights, inputs: Array) -> Array:
    """The force (N,), SI, of a network for its inputs (N, I), inside of its trust box."""
    h = (inputs - weights.mean) / weights.scale
    for layer in weights.layers:
        h = CURVES[layer.activation](h @ layer.weights.T + layer.bias)
    return np.asarray(weights.gain * h[:, 0] + weights.offset)


def _weights(document: object) -> Weights:
    if not isinstance(document, dict) or document.get("symhyb-network") != FORMAT:
        raise ValueError("it does not begin with its format")
    mean, scale = (np.array(document[key], float).reshape(-1) for key in ("mean", "scale"))
    layers = []
    width = mean.size
    for item in document["layers"]:
        weights, bias = np.array(item["weights"], float), np.array(item["bias"], float)
        if bias.ndim != 1 or weights.shape != (bias.size, width):
            raise ValueError(f"a layer of shape {weights.shape} does not follow {width} values")
        if item["activation"] not in ACTIVATIONS:
            raise ValueError(f"activation {item['activation']!r} is not known")
        layers.append(Layer(weights, bias, item["activation"]))
        width = bias.size
    result = Weights(mean, scale, tuple(layers), float(document["gain"]), float(document["offset"]))
    numbers = [mean, scale, *(x for layer in layers for x in (layer.weights, layer.bias))]
    finite = all(np.isfinite(x).all() for x in numbers)
    if width != 1 or scale.size != mean.size or not finite or not (scale > 0).all():
        raise ValueError("its sizes or numbers do not fit together")
    if not np.isfinite([result.gain, result.offset]).all():
        raise ValueError("its gain or offset is not finite")
    return result

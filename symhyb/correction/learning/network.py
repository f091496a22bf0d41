"""A trained network on top of the named laws: what no polynomial and no law takes, and no physics.

    F = Σ r_j tanh(w_j x + b_j) + r_0        x: positions, speeds, inputs, time, standardised

Several networks are trained on the force discrepancy ΔF along the recordings, each from another
seed and stopped early on other blocks of time, and their mean is one wider network. Its output
weights r are then refined by simulation error over windows, initial states projected out. The named
values stay, and r is held to the directions whose force is orthogonal, along the recordings, to
what a change of a named value would make. Held windows say whether it is worth anything: they have
no part in the training, and choose between nothing, the trained and the refined network.
Sizes: N samples, I inputs, U hidden units of all members, T = U + 1, D directions, K named values.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from symhyb.asked import asked
from symhyb.correction.learning.energy import Energy, energy_of
from symhyb.correction.learning.refining import Fitting, joined, with_output
from symhyb.correction.learning.seen import Seen, see
from symhyb.correction.search.preparing import last_windows, prepare
from symhyb.data.recording import Recording
from symhyb.discrepancy.words.wording import percent_text
from symhyb.errors import InputError, Problem
from symhyb.model.expression import parse_expression
from symhyb.model.types import Element, Model, Network, On
from symhyb.model.weights import keep
from symhyb.model.write import append_elements
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.threads import one_thread
from symhyb.numeric.lowered.network import Layer, Weights, evaluated, stored

if TYPE_CHECKING:
    from sklearn.neural_network import MLPRegressor

NAME = "network"
WIDTH = 10  # hidden units of a member
MEMBERS = 3
FOLDS = 5  # of the training: a member stops early on one of them
BLOCKS_A_FOLD = 2  # blocks of time of a fold
CHUNK = 25  # iterations of L-BFGS between two looks at the fold
CHUNKS = 40  # at most
PATIENCE = 5  # chunks without a better fold: stop
ROWS_MOST = 6000  # samples that a network is trained on, evenly spread
NO_NETWORK = "No network: none is better on held windows than none at all."
ABOUT = "trained on what the named laws leave: measured, but no physics known by name"


@dataclass(frozen=True, slots=True, eq=False)
class Trained:
    """A trained network: the ``model`` with it, its ``element`` and ``weights``, and those of its
    ``members`` before they were joined. ``held`` is χ² per sample of the held windows with nothing,
    with the trained and with the refined network (NaN if it cannot be simulated), ``refined``
    whether that is the one in the model; ``spread`` how far the members differ, RMS over that of
    their mean; ``energy`` whether its force feeds energy in."""

    model: Model
    element: Element
    weights: Weights
    members: tuple[Weights, ...]
    held: tuple[float, float, float]
    refined: bool
    spread: float
    energy: Energy

    @property
    def sentence(self) -> str:
        """What was measured, in words."""
        seen = ", ".join(item.text for item in self.element.network.inputs)  # type: ignore[union-attr]
        nothing, trained, refined = self.held
        said = f"to {trained:.4g}"
        if self.refined:
            said = f"to {refined:.4g} ({trained:.4g} before it was refined on the simulation error)"
        return (
            f"A network of {self.weights.layers[0].bias.size} hidden units that sees {seen} takes "
            f"the χ² per sample of held windows from {nothing:.4g} {said}. Its "
            f"{len(self.members)} members differ by {percent_text(self.spread)} of their force. "
            f"{self.energy.sentence} It is what the named laws leave, not a law."
        )

    def band(self, inputs: Array) -> Array:
        """One standard deviation (N,), SI, of the members' forces for ``inputs`` (N, I), SI."""
        return np.asarray(np.std([evaluated(one, inputs) for one in self.members], axis=0))


@asked
def train_network(
    model: Model,
    recordings: Recording | Sequence[Recording],
    on: str | None = None,
    *,
    inputs: Sequence[str] = (),
    width: int = WIDTH,
    members: int = MEMBERS,
    seed: int = 0,
    name: str = NAME,
) -> Trained | None:
    """Train a network for what a corrected ``model`` leaves of its training recordings.

    ``on`` names the coordinate where it acts (default: the only one that is free), ``inputs`` what
    it sees: coordinates ``x``, speeds ``x'``, inputs of the model and ``t`` (default: position and
    speed there). ``members`` networks of ``width`` hidden units are trained; ``name`` is that of
    the element. Returns None where none is better on held windows than nothing at all. The weights
    stay in memory until ``write_model`` writes them beside the model file.

    Raises:
        InputError: unusable recordings, a coordinate or an input that does not exist, an input
            that never changes, or a model that has a network of this name already.
        NumericsError: the model cannot be simulated along the recordings.
    """
    if width < 1 or members < 1:
        raise InputError(Problem("a network has at least one member and one hidden unit"))
    if name in [element.name for element in model.elements]:
        raise InputError(Problem("the model has a trained network already", f"elements.{name}"))
    prepared = prepare(model, recordings)
    chosen = last_windows(prepared, spread=True)
    seen = see(prepared, chosen, on, inputs)
    trained = _trained(seen, width, members, seed)
    fitting = Fitting.of(prepared, seen, trained)
    cuts = [item.suited(fitting.model.machine) for item in chosen]
    r, held, refined = fitting.chosen(cuts)
    if r is None:
        return None
    weights = with_output(joined(trained), r)
    data = stored(weights)
    digest = keep(data)
    expressions = tuple(parse_expression(name) for name in seen.inputs)
    network = Network(f"{name}-{digest[:12]}.json", digest, expressions, seen.box)
    element = Element(name, "network", On(seen.on), (), about=ABOUT, network=network)
    mean = np.mean([evaluated(one, seen.x) for one in trained], axis=0)
    apart = np.std([evaluated(one, seen.x) for one in trained], axis=0)
    spread = float(np.sqrt(np.mean(apart**2) / max(np.mean(mean**2), 1e-300)))
    return Trained(
        append_elements(model, [element]),
        element,
        weights,
        trained,
        held,
        refined,
        spread,
        energy_of(weights, seen),
    )


def lowered(mlp: "MLPRegressor", mean: Array, scale: Array, gain: float, offset: float) -> Weights:
    """A fitted regressor of (F − offset)/gain on (x − mean)/scale as a network of F, SI; ``mean``
    and ``scale`` are (I,)."""
    count = len(mlp.coefs_)
    curves = [mlp.activation] * (count - 1) + ["identity"]
    layers = tuple(
        Layer(coefficients.T.copy(), bias.copy(), curve)
        for coefficients, bias, curve in zip(mlp.coefs_, mlp.intercepts_, curves, strict=True)
    )
    return Weights(mean, scale, layers, gain, offset)


def _trained(seen: Seen, width: int, members: int, seed: int) -> tuple[Weights, ...]:
    """The members, trained on what of ΔF is orthogonal to the named laws."""
    rows = np.flatnonzero(seen.fitted)
    rows = rows[:: -(-rows.size // ROWS_MOST)]
    x, force, laws = seen.x[rows], seen.force[rows], seen.laws[rows]
    size = np.linalg.norm(laws, axis=0)
    unit = laws[:, size > 0] / size[size > 0]
    force = force - unit @ np.linalg.lstsq(unit, force, rcond=None)[0]
    return members_of(x, force, width, members, seed, of=seen.x[seen.fitted])


def members_of(
    x: Array, target: Array, width: int, members: int, seed: int, of: Array | None = None
) -> tuple[Weights, ...]:
    """Networks of ``target`` (N,) by inputs ``x`` (N, I), SI, in the order of time; each stops
    early on other blocks of time. Inputs are standardised as ``of`` (default x) is spread."""
    spread = x if of is None else of
    mean, scale = spread.mean(axis=0), spread.std(axis=0)
    offset, gain = float(target.mean()), float(target.std()) or 1.0
    standard, scaled = (x - mean) / scale, (target - offset) / gain
    blocks = np.arange(len(x)) * FOLDS * BLOCKS_A_FOLD // len(x)
    with one_thread():
        return tuple(
            lowered(
                _fitted(standard, scaled, blocks % FOLDS == k % FOLDS, width, seed + k),
                mean,
                scale,
                gain,
                offset,
            )
            for k in range(members)
        )


def _fitted(
    x: Array, target: Array, fold: NDArray[np.bool_], width: int, seed: int
) -> "MLPRegressor":
    """A regressor fitted to the samples outside of ``fold`` (N,), as it was when it met those of
    the fold best: neighbouring samples are alike, so that single ones would stop nothing."""
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.neural_network import MLPRegressor

    mlp = MLPRegressor(
        hidden_layer_sizes=(width,),
        activation="tanh",
        solver="lbfgs",
        max_iter=CHUNK,
        warm_start=True,
        random_state=seed,
    )
    best, since = np.inf, 0
    state: tuple[list[Array], list[Array]] = ([], [])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # after a chunk it has not converged
        for _ in range(CHUNKS):
            mlp.fit(x[~fold], target[~fold])
            error = float(np.mean((mlp.predict(x[fold]) - target[fold]) ** 2))
            since += 1
            if error < best:
                best, since = error, 0
                state = ([c.copy() for c in mlp.coefs_], [b.copy() for b in mlp.intercepts_])
            if since >= PATIENCE or mlp.n_iter_ == 0:
                break
    mlp.coefs_, mlp.intercepts_ = state
    return mlp

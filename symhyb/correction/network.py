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
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from symhyb.correction.energy import Energy, energy_of
from symhyb.correction.evidence import SIGNIFICANT
from symhyb.correction.orthogonal import Linear, beside, linear, on_held, solved
from symhyb.correction.preparing import Prepared, last_windows, prepare
from symhyb.correction.seen import Seen, see
from symhyb.data.recording import Recording
from symhyb.discrepancy.windows import Laid
from symhyb.discrepancy.wording import percent_text
from symhyb.errors import InputError, NumericsError, Problem
from symhyb.model.expression import parse_expression
from symhyb.model.types import Element, Model, Network, On, Parameter
from symhyb.model.weights import keep
from symhyb.model.write import append_elements
from symhyb.numeric.buffers import Array
from symhyb.numeric.machine import build
from symhyb.numeric.network import Layer, Weights, evaluated, stored
from symhyb.numeric.windows import WindowModel
from symhyb.units import parse_unit

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
ROUNDS = 2  # Gauss–Newton steps of the refinement: the output weights act almost linearly
RIDGES = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0)  # of a refinement; held windows choose
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


def train_network(
    model: Model,
    recordings: Recording | Sequence[Recording],
    on: str | None = None,
    *,
    inputs: Sequence[str] = (),
    width: int = WIDTH,
    members: int = MEMBERS,
    seed: int = 0,
) -> Trained | None:
    """Train a network for what a corrected ``model`` leaves of its training recordings.

    ``on`` names the coordinate where it acts (default: the only one that is free), ``inputs`` what
    it sees: coordinates ``x``, speeds ``x'``, inputs of the model and ``t`` (default: position and
    speed there). ``members`` networks of ``width`` hidden units are trained. Returns None where
    none is better on held windows than nothing at all. The weights stay in memory until
    ``write_model`` writes them beside the model file.

    Raises:
        InputError: unusable recordings, a coordinate or an input that does not exist, an input
            that never changes, or a model that has a network of this name already.
        NumericsError: the model cannot be simulated along the recordings.
    """
    if width < 1 or members < 1:
        raise InputError(Problem("a network has at least one member and one hidden unit"))
    if NAME in [element.name for element in model.elements]:
        raise InputError(Problem("the model has a trained network already", f"elements.{NAME}"))
    prepared = prepare(model, recordings)
    chosen = last_windows(prepared, spread=True)
    seen = see(prepared, chosen, on, inputs)
    with threadpool_limits(1):  # several threads wait for each other on such small matrices
        trained = _trained(seen, width, members, seed)
    fitting = _Fitting.of(prepared, seen, trained)
    laid = [item.suited(fitting.model.machine) for item in chosen]
    r, held, refined = fitting.chosen(laid)
    if r is None:
        return None
    weights = _with_output(_joined(trained), r)
    data = stored(weights)
    digest = keep(data)
    expressions = tuple(parse_expression(name) for name in seen.inputs)
    network = Network(f"{NAME}-{digest[:12]}.json", digest, expressions, seen.box)
    element = Element(NAME, "network", On(seen.on), (), about=ABOUT, network=network)
    mean = np.mean([evaluated(one, seen.x) for one in trained], axis=0)
    apart = np.std([evaluated(one, seen.x) for one in trained], axis=0)
    spread = float(np.sqrt(np.mean(apart**2) / max(np.mean(mean**2), 1e-300)))
    return Trained(
        append_elements(model, [element]), element, weights, trained, held, refined, spread,
        energy_of(weights, seen),
    )  # fmt: skip


def lowered(mlp: "MLPRegressor", mean: Array, scale: Array, gain: float, offset: float) -> Weights:
    """A fitted regressor of (F − offset)/gain on (x − mean)/scale as a network of F, SI."""
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
    mean, scale = seen.x[seen.fitted].mean(axis=0), seen.x[seen.fitted].std(axis=0)
    offset, gain = float(force.mean()), float(force.std()) or 1.0
    standard, target = (x - mean) / scale, (force - offset) / gain
    blocks = np.arange(rows.size) * FOLDS * BLOCKS_A_FOLD // rows.size
    return tuple(
        lowered(
            _fitted(standard, target, blocks % FOLDS == k % FOLDS, width, seed + k),
            mean, scale, gain, offset,
        )
        for k in range(members)
    )  # fmt: skip


def _fitted(
    x: Array, target: Array, fold: NDArray[np.bool_], width: int, seed: int
) -> "MLPRegressor":
    """A regressor fitted to the samples outside of ``fold`` (N,), as it was when it met those of
    the fold best: neighbouring samples are alike, so that single ones would stop nothing."""
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.neural_network import MLPRegressor

    mlp = MLPRegressor(
        hidden_layer_sizes=(width,), activation="tanh", solver="lbfgs", max_iter=CHUNK,
        warm_start=True, random_state=seed,
    )  # fmt: skip
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


def _joined(members: Sequence[Weights]) -> Weights:
    """The mean of networks with one hidden layer, as one wider network."""
    first = members[0]
    hidden = Layer(
        np.concatenate([one.layers[0].weights for one in members]),
        np.concatenate([one.layers[0].bias for one in members]),
        first.layers[0].activation,
    )
    out = np.concatenate([one.layers[1].weights for one in members], axis=1) / len(members)
    bias = np.mean([one.layers[1].bias for one in members], axis=0)
    layers = (hidden, Layer(out, bias, "identity"))
    return Weights(first.mean, first.scale, layers, first.gain, first.offset)


def _output(weights: Weights) -> Array:
    """The output weights r (T,), SI, the constant last."""
    out = weights.layers[1]
    constant = weights.gain * float(out.bias[0]) + weights.offset
    return np.append(weights.gain * out.weights[0], constant)


def _with_output(weights: Weights, r: Array) -> Weights:
    """The network with other output weights r (T,), SI."""
    out = Layer(r[None, :-1] / weights.gain, np.zeros(1), "identity")
    return replace(weights, layers=(weights.layers[0], out), offset=float(r[-1]))


def _features(weights: Weights, x: Array) -> Array:
    """What the output weights act on (N, T) for inputs x (N, I), SI."""
    hidden = weights.layers[0]
    h = np.tanh((x - weights.mean) / weights.scale @ hidden.weights.T + hidden.bias)
    return np.column_stack([h, np.ones(len(h))])


@dataclass(frozen=True, slots=True, eq=False)
class _Fitting:
    """The problem of the output weights: the ``model`` with them free, its values ``p`` (P,), noise
    ``sd`` (m,), allowed directions ``basis`` (T, D), all SI, and the trained values ``r`` (T,),
    as near as those directions come."""

    model: WindowModel
    p: Array
    sd: Array
    basis: Array
    r: Array

    @classmethod
    def of(cls, prepared: Prepared, seen: Seen, members: Sequence[Weights]) -> "_Fitting":
        """The network of all members on the prepared model."""
        joined = _joined(members)
        phi, wanted = _features(joined, seen.x[seen.fitted]), _output(joined)
        basis = beside(phi, seen.laws[seen.fitted])
        r = basis @ np.linalg.lstsq(phi @ basis, phi @ wanted, rcond=None)[0]
        laws = _as_laws(joined, seen, len(members))
        whole = replace(prepared.model, elements=(*prepared.model.elements, *laws))
        machine = build(whole, keep=False)
        owned = [p for law in laws for p in law.parameters]
        paths = [p.path for p in owned if p.name.lstrip("n").startswith("r")]
        free = tuple(machine.column(path) for path in (*paths[1:], paths[0]))
        return cls(WindowModel(machine, free), machine.values.copy(), prepared.sd, basis, r)

    def with_output(self, r: Array) -> Array:
        """The values (P,) of the machine with output weights r (T,)."""
        p = self.p.copy()
        p[list(self.model.free)] = r
        return p

    def at(self, laid: Sequence[Laid], r: Array) -> Linear | None:
        """The reply of the windows around r (T,); None if the simulation runs away."""
        with np.errstate(over="ignore", invalid="ignore"):
            try:
                step = linear(self.model, laid, self.with_output(r), self.sd)
            except np.linalg.LinAlgError:
                return None
        return step if np.isfinite(step.gram).all() and np.isfinite(step.held).all() else None

    def chosen(self, laid: Sequence[Laid]) -> tuple[Array | None, tuple[float, float, float], bool]:
        """The output weights (T,) that held windows choose (None for no network at all), χ² per
        sample of these for nothing, trained and refined, and whether it is the refined one."""
        nothing = self.at(laid, np.zeros_like(self.r))
        if nothing is None:
            raise NumericsError("the corrected model cannot be simulated along the recordings")
        trained = self.at(laid, self.r)
        helps = trained is not None and _better(trained, nothing)
        r, step = (self.r, trained) if helps and trained else (np.zeros_like(self.r), nothing)
        finer, refined = r, step
        for _ in range(ROUNDS):
            ridge = min(RIDGES, key=lambda size: on_held(refined, self.basis, size))
            moved = finer + solved(refined.gram, self.basis, ridge)
            after = self.at(laid, moved)
            if after is None or on_held(after, None) >= on_held(refined, None):
                break
            finer, refined = moved, after
        takes = _better(refined, step)
        held = tuple(
            np.nan if one is None else on_held(one, None) / one.samples
            for one in (nothing, trained, refined)
        )
        best = finer if takes else r if helps else None
        return best, (held[0], held[1], held[2]), takes


def _better(one: Linear, other: Linear) -> bool:
    """Whether held windows are significantly better with the first, by what that leaves."""
    return (on_held(other, None) - on_held(one, None)) / one.unit > SIGNIFICANT


def _as_laws(weights: Weights, seen: Seen, members: int) -> tuple[Element, ...]:
    """The network as laws with its output weights as parameters, one law a member: what windows are
    differentiated by. Only to compute with, so the numbers are plain ones in SI."""
    unit, prefix = parse_unit("1"), "n"
    while any(text.startswith(prefix) for text in seen.inputs):
        prefix += "n"  # own parameters hide the names of the model
    hidden = weights.layers[0]
    inner = hidden.weights / weights.scale
    shift = hidden.bias - inner @ weights.mean
    laws = []
    for k, units in enumerate(np.array_split(np.arange(hidden.bias.size), members)):
        name = f"{NAME}_{k}"
        values = {f"{prefix}r": 0.0} if k == 0 else {}
        parts = list(values)
        for j in units.tolist():
            into = {f"{prefix}w{j}_{i}": float(value) for i, value in enumerate(inner[j])}
            terms = [f"{key}*{text}" for key, text in zip(into, seen.inputs, strict=True)]
            parts.append(f"{prefix}r{j}*tanh({' + '.join([*terms, f'{prefix}b{j}'])})")
            values |= {f"{prefix}r{j}": 0.0, f"{prefix}b{j}": float(shift[j])} | into
        own = tuple(Parameter(key, value, unit, owner=name) for key, value in values.items())
        entries = (("force", parse_expression(" + ".join(parts))),)
        laws.append(Element(name, "law", On(seen.on), entries, own))
    return tuple(laws)

"""The output weights of a trained network: held beside the named laws, refined, judged.

Its hidden units stay as they were trained; what they are multiplied by acts linearly, so that the
windows of the recordings say by simulation error what it ought to be, as for a polynomial.
Sizes: N samples, I inputs, U hidden units of all members, T = U + 1, D directions.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.learning.orthogonal import Linear, beside, linear, on_held, solved
from symhyb.correction.learning.seen import Seen
from symhyb.correction.search.preparing import Prepared
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.errors import NumericsError
from symhyb.judgement import SIGNIFICANT
from symhyb.model.expression import parse_expression
from symhyb.model.types import Element, On, Parameter
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.network import Layer, Weights
from symhyb.numeric.runs.windows import WindowModel
from symhyb.units import parse_unit

ROUNDS = 2  # Gauss–Newton steps of the refinement: the output weights act almost linearly
RIDGES = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0)  # of a refinement; held windows choose


def joined(members: Sequence[Weights]) -> Weights:
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


def with_output(weights: Weights, r: Array) -> Weights:
    """The network with other output weights r (T,), SI."""
    out = Layer(r[None, :-1] / weights.gain, np.zeros(1), "identity")
    return replace(weights, layers=(weights.layers[0], out), offset=float(r[-1]))


def features(weights: Weights, x: Array) -> Array:
    """What the output weights act on (N, T) for inputs x (N, I), SI."""
    hidden = weights.layers[0]
    h = np.tanh((x - weights.mean) / weights.scale @ hidden.weights.T + hidden.bias)
    return np.column_stack([h, np.ones(len(h))])


@dataclass(frozen=True, slots=True, eq=False)
class Fitting:
    """The problem of the output weights: the ``model`` with them free, its values ``p`` (P,), noise
    ``sd`` (m,), allowed directions ``basis`` (T, D), all SI, and the trained values ``r`` (T,),
    as near as those directions come."""

    model: WindowModel
    p: Array
    sd: Array
    basis: Array
    r: Array

    @classmethod
    def of(cls, prepared: Prepared, seen: Seen, members: Sequence[Weights]) -> "Fitting":
        """The network of all members on the prepared model."""
        wide = joined(members)
        phi, wanted = features(wide, seen.x[seen.fitted]), _output(wide)
        basis = beside(phi, seen.laws[seen.fitted])
        r = basis @ np.linalg.lstsq(phi @ basis, phi @ wanted, rcond=None)[0]
        laws = _as_laws(wide, seen, len(members))
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

    def at(self, cuts: Sequence[Cut], r: Array) -> Linear | None:
        """The reply of the windows around r (T,); None if the simulation runs away."""
        with np.errstate(over="ignore", invalid="ignore"):
            try:
                step = linear(self.model, cuts, self.with_output(r), self.sd)
            except np.linalg.LinAlgError:
                return None
        return step if np.isfinite(step.gram).all() and np.isfinite(step.held).all() else None

    def chosen(self, cuts: Sequence[Cut]) -> tuple[Array | None, tuple[float, float, float], bool]:
        """The output weights (T,) that held windows choose (None for no network at all), χ² per
        sample of these for nothing, trained and refined, and whether it is the refined one."""
        nothing = self.at(cuts, np.zeros_like(self.r))
        if nothing is None:
            raise NumericsError("the corrected model cannot be simulated along the recordings")
        trained = self.at(cuts, self.r)
        helps = trained is not None and _better(trained, nothing)
        r, step = (self.r, trained) if helps and trained else (np.zeros_like(self.r), nothing)
        finer, refined = r, step
        for _ in range(ROUNDS):
            ridge = min(RIDGES, key=lambda size: on_held(refined, self.basis, size))
            moved = finer + solved(refined.gram, self.basis, ridge)
            after = self.at(cuts, moved)
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
        name = f"member_{k}"
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

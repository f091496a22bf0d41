"""The screen at the level of forces: what is lacking, by least squares in the forces of all causes.

The equations of motion are multiplied by windowed complex exponentials and integrated by parts,

    ∫ φ (p' − ∂T/∂q − k_e) dt = −∫ φ' p dt − ∫ φ (∂T/∂q + k_e) dt = Σ θ_j ∫ φ F_j dt,

so no second derivative of noisy data is formed and both sides pass the same band (modulating
functions: Shinbrot 1957; weak SINDy: Messenger & Bortz, MMS 19, 2021). A plain bump longer than the
oscillation filters it out; the modulation keeps the band.

A force is linear in every coefficient here, also in a mass that is missing, however light the
machine is without it; along windows that mass divides all forces. Coordinates are weighted by what
is left on them, and that again, as arms are identified (weighted least squares: Gautier & Poignet,
Control Engineering Practice 9, 2001). The result is a proposal, not a decision.
Sizes: W windows, R rows of a window, C columns, f free coordinates, L samples.
"""

from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.correction.search.selection import Problem, Subset, growing, neighbours, without
from symhyb.discrepancy.places.hypotheses import Hypothesis, Library
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine

SMOOTHNESS = 4  # of the window (1 − τ²)^4
HARMONICS_MOST = 12
BAND = 5.0  # of the highest modulation, per shortest period
BLOCK = 2**20  # numbers of rows at a time
GROWING = 4  # subsets of each size that grow further
WEIGHINGS = 3  # how often coordinates are weighted anew


@dataclass(frozen=True, slots=True)
class ForceScreen:
    """Gram matrices of the columns of the ``hypotheses``, per SI unit of each coefficient, and of
    what is lacking, last, by coordinate: of the fitted windows ``grams`` (f, C + 1, C + 1) and of
    the ``held`` ones, in squares of the modulated force (N·s, N·m·s); a coordinate has as many as
    ``count`` independent rows."""

    hypotheses: tuple[Hypothesis, ...]
    columns: tuple[tuple[int, ...], ...]
    grams: Array
    held: Array
    count: float

    @property
    def rows(self) -> float:
        """How many independent rows there are, over all coordinates."""
        return len(self.grams) * self.count

    @property
    def total(self) -> Array:
        """The Gram matrices (f, C + 1, C + 1) of all windows."""
        return np.asarray(self.grams + self.held)

    def plus(self, other: "ForceScreen") -> "ForceScreen":
        """The screen over the windows of both."""
        count = self.count + other.count
        return replace(
            self, grams=self.grams + other.grams, held=self.held + other.held, count=count
        )

    def problem(self, weights: Array) -> Problem:
        """The linear problem of these ``weights`` (f,) of the squares of coordinates."""
        lower = np.array([0.0 if s else -np.inf for h in self.hypotheses for s in h.positive])
        none = np.zeros(lower.size)
        return Problem(
            gram=np.tensordot(weights, self.grams, 1),
            held=np.tensordot(weights, self.held, 1),
            hypotheses=self.hypotheses,
            columns=self.columns,
            always=(),
            prior=none,
            lower=lower,
            upper=np.full(lower.size, np.inf),
            least=none,
        )

    def begin(self) -> Array:
        """Weights (f,) by which what is lacking counts alike on every coordinate."""
        return self._per_row(self.total[:, -1, -1])

    def left(self, subset: Subset) -> Array:
        """The squares (f,) that a subset leaves on each coordinate, in all windows."""
        mix = np.zeros(self.grams.shape[1])
        mix[[c for cause in subset.causes for c in self.columns[cause]]] = -subset.values
        mix[-1] = 1.0
        squares = mix @ self.total @ mix
        return np.asarray(np.maximum(squares, 0.0))

    def whole(self, choice: float, dropped: Set[int]) -> Subset | None:
        """As many causes as pay for their numbers and for a ``choice`` each, on held windows too,
        with coordinates weighted by what these causes leave; None if none does. Variants of laws
        and ``dropped`` causes are left out."""
        left_out = {i for i, h in enumerate(self.hypotheses) if h.variant or i in dropped}
        weights, found = self.begin(), None
        for _ in range(WEIGHINGS):
            found = self._grown(without(self.problem(weights), left_out), choice)
            if found is None:
                return None
            weights = self._per_row(self.left(found))
        return found

    def _grown(self, problem: Problem, choice: float) -> Subset | None:
        """The subset at which growing stops to pay, in units of what it leaves, and none with a
        cause less or another one is better."""
        best: Subset | None = None
        for sized in growing(problem, GROWING):
            found = min(sized, key=lambda subset: subset.left)
            if best is not None and not self._cheaper(found, best, choice):
                break
            best = found
        while best is not None and best.causes:
            size = best
            found = min(neighbours(problem, best), key=lambda one: self._score(one, size, choice))
            if not self._cheaper(found, best, choice):
                return best
            best = found
        return None

    def _cheaper(self, one: Subset, other: Subset, choice: float) -> bool:
        """Whether a subset has the better score, in units of what the larger one leaves, and is no
        worse on held windows for causes more."""
        if len(one.causes) > len(other.causes) and one.held >= other.held:
            return False
        most = max(one, other, key=lambda subset: len(subset.causes))
        return self._score(one, most, choice) < self._score(other, most, choice)

    def _score(self, subset: Subset, best: Subset, choice: float) -> float:
        """The score of a subset in units of what the ``best`` leaves."""
        price = subset.numbers * np.log(self.rows) + len(subset.causes) * choice
        return float(subset.left / max(best.left / self.rows, 1e-300) + price)

    def _per_row(self, squares: Array) -> Array:
        """Weights (f,) that make squares (f,) one a row; 0 where a coordinate shows none."""
        return np.divide(self.count, squares, out=np.zeros(squares.size), where=squares > 0)


def force_screen(
    machine: Machine, library: Library, cuts: Sequence[Cut], band_hz: float
) -> ForceScreen | None:
    """The screen of the force hypotheses over windows with smoothed motion; ``band_hz`` is the
    highest modulation. None with constraints, whose reactions nothing here knows, where all motion
    is imposed, and where a row is not finite."""
    if machine.constraints or not machine.free:
        return None
    free, size = len(machine.free), sum(map(len, library.columns)) + 1
    grams, count = np.zeros((2, free, size, size)), 0.0
    for item in cuts:
        count += len(item.start) * independent(modulated(item.block.t[:1], band_hz)[0][0])
        for held, rows in weak_rows(machine, library, item, band_hz):
            if not np.isfinite(rows).all():
                return None
            each = rows.transpose(2, 0, 1, 3).reshape(free, -1, size)
            for part, which in ((0, ~held), (1, held)):
                mine = each.reshape(free, *rows.shape[:2], size)[:, which].reshape(free, -1, size)
                grams[part] += mine.transpose(0, 2, 1) @ mine
    return ForceScreen(library.hypotheses, library.columns, grams[0], grams[1], count)


def weak_rows(
    machine: Machine, library: Library, item: Cut, band_hz: float
) -> Iterator[tuple[NDArray[np.bool_], Array]]:
    """The weak form over windows, some at a time: which are held (W,), and rows (W, R, f, C + 1),
    the columns per SI unit of each coefficient and, last, what is lacking, in N·s or N·m·s."""
    c, where, free = item.course(machine), item.rows, list(machine.free)
    given = c.q, c.v, c.z, c.u, c.t, c.values(machine)
    momentum, rest = along(machine.weak, given, (5,), c.t.size)
    forces = library.forces(item.course(library.machine))
    test, slope = modulated(item.block.t, band_hz)
    right = -(slope @ momentum[where] + test @ rest[where])[..., free]
    windows, harmonics, columns = len(where), test.shape[1], forces.shape[2]
    most = max(BLOCK // (harmonics * max(len(free) * columns, 1)), 1)
    for first in range(0, windows, most):
        some = slice(first, first + most)
        acting = forces[where[some]][:, :, free]
        rows = test[some] @ acting.reshape(*acting.shape[:2], -1)
        rows = rows.reshape(*rows.shape[:2], len(free), columns)
        yield item.held[some], np.concatenate([rows, right[some][..., None]], axis=3)


def modulated(t: Array, band_hz: float) -> tuple[Array, Array]:
    """Test functions (W, R, L) times quadrature weights, s, and their derivatives, dimensionless,
    for windows at times ``t`` (W, L), s: a smooth window times cosines and sines of its harmonics
    up to the band."""
    span = t[:, -1:] - t[:, :1]
    tau = 2 * (t - t[:, :1]) / span - 1
    window = (1 - tau**2) ** SMOOTHNESS
    fall = -2 * tau * SMOOTHNESS * (1 - tau**2) ** (SMOOTHNESS - 1) * 2 / span
    weight = np.gradient(t, axis=1)
    tests, slopes = [window * weight], [fall * weight]
    harmonics = min(int(band_hz * float(np.median(span))), HARMONICS_MOST)
    for k in range(1, harmonics + 1):
        omega = 2 * np.pi * k / span
        phase = omega * (t - t[:, :1])
        for wave, rise in ((np.cos(phase), -np.sin(phase)), (np.sin(phase), np.cos(phase))):
            tests.append(window * wave * weight)
            slopes.append((fall * wave + window * omega * rise) * weight)
    return np.stack(tests, axis=1), np.stack(slopes, axis=1)


def independent(test: Array) -> float:
    """How many of test functions (R, L), in s, are independent under white noise: neighbouring
    harmonics overlap."""
    shared = test @ test.T
    return float(np.trace(shared) ** 2 / np.sum(shared**2))

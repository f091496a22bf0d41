"""The learners as estimators of scikit-learn: forces as functions of a table of what is seen.

    gap = sh.compare(model, recording).to_frame()
    law = SparseForce(degree=3).fit(gap[["x", "x'"]], gap["dF_x"])
    print(law.formula(), law.score(gap[["x", "x'"]], gap["dF_x"]))

They take part in pipelines, grids and cross-validation; :func:`symhyb.learn` is the way from
recordings to a corrected model, which weighs forces by simulation. Rows of a recording are
neighbours in time: validate on blocks of it (``KFold`` without shuffling) or on other recordings.
Sizes: N rows, I features, T terms. Values are in whatever units the table has.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils import check_random_state
from sklearn.utils.validation import check_is_fitted, validate_data

from symhyb.correction.learning.network import BLOCKS_A_FOLD, FOLDS, MEMBERS, WIDTH, members_of
from symhyb.correction.learning.refining import joined
from symhyb.correction.learning.regression import Candidates, regress
from symhyb.correction.learning.sparse import thresholded
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.network import FADE, evaluated

FEWEST = 2  # rows that a sparse law is fitted to
APART = 1e-6  # of a column: what others leave of it, if it says something of its own

Powers = tuple[int, ...]  # the features that a term multiplies, by number


class SparseForce(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """A sparse polynomial of the features by PySINDy's STLSQ, on columns of unit length.

    Args:
        degree: of the polynomial, the constant included.
        threshold: a term whose share of the target is below it goes; dimensionless.

    Attributes:
        coef_: (T,) in the unit of the target over that of the term, 0 where the term went.
        terms_: the T terms as texts; those that depend on others in the given rows are not there.

    ``n_features_in_`` and ``feature_names_in_`` are as everywhere in scikit-learn.
    """

    def __init__(self, degree: int = 2, threshold: float = 0.05) -> None:
        self.degree = degree
        self.threshold = threshold

    def fit(self, X: Any, y: Any) -> "SparseForce":
        """Fit the target ``y`` (N,) by the features ``X`` (N, I), in any units.

        Raises:
            ValueError: values that are not finite, or fewer than two rows.
        """
        X, y = validate_data(
            self, X, y, y_numeric=True, dtype=np.float64, ensure_min_samples=FEWEST
        )
        scale = np.abs(X).max(axis=0)
        self._scale = np.where(scale > 0, scale, 1.0)
        every = list(_powers(X.shape[1], self.degree))
        columns = _columns(X / self._scale, every)
        kept = _independent(columns)
        self._powers, size = [every[i] for i in kept], float(np.linalg.norm(y))
        self.terms_ = tuple(_said(term, self._names()) for term in self._powers)
        shares = np.zeros(len(kept))
        if size > 0 and kept:
            length = np.linalg.norm(columns[:, kept], axis=0)
            table = np.column_stack([columns[:, kept] / length, y / size])
            found = Candidates(lambda part: table[part], len(table), (*self.terms_, "target"))
            shares = regress(found, thresholded(self.threshold))[0] * size / length
        self._shares = shares
        self.coef_ = shares / np.array([np.prod(self._scale[list(p)]) for p in self._powers])
        return self

    def predict(self, X: Any) -> Array:
        """The target (N,) that the features ``X`` (N, I) give, in the unit of the target.

        Raises:
            NotFittedError: before ``fit``.
            ValueError: other features than in ``fit``.
        """
        check_is_fitted(self)
        X = validate_data(self, X, reset=False, dtype=np.float64)
        return np.asarray(_columns(X / self._scale, self._powers) @ self._shares)

    def formula(self) -> str:
        """The law that was found as text, as a ``law`` element of a model file takes it."""
        check_is_fitted(self)
        parts = [
            f"{value:.6g}" + (f"*{text}" if text != "1" else "")
            for value, text in zip(self.coef_.tolist(), self.terms_, strict=True)
            if value
        ]
        return " + ".join(parts).replace("+ -", "- ") or "0"

    def _names(self) -> Sequence[str]:
        given = getattr(self, "feature_names_in_", None)
        return [f"x{i}" for i in range(self.n_features_in_)] if given is None else list(given)


class NetworkForce(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """The mean of small networks that are stopped early on blocks of rows, as symhyb trains them
    for what named laws leave; outside of the features that were seen it fades to zero.

    Args:
        width: hidden units of a member.
        members: how many networks.
        fade: whether the force fades outside of the box of the features that were seen.
        random_state: an int, a ``RandomState`` or None.

    Attributes:
        weights_: the network (:class:`symhyb.numeric.lowered.network.Weights`), which
            ``symhyb.learning`` simulates.
        trust_: (I, 2) smallest and largest of every feature, in its unit.

    ``n_features_in_`` and ``feature_names_in_`` are as everywhere in scikit-learn.
    """

    def __init__(
        self,
        width: int = WIDTH,
        members: int = MEMBERS,
        fade: bool = True,
        random_state: Any = 0,
    ) -> None:
        self.width = width
        self.members = members
        self.fade = fade
        self.random_state = random_state

    def fit(self, X: Any, y: Any) -> "NetworkForce":
        """Train on the target ``y`` (N,) by the features ``X`` (N, I), in any units, in the order
        of time.

        Raises:
            ValueError: values that are not finite, or fewer rows than there are blocks.
        """
        least = FOLDS * BLOCKS_A_FOLD
        X, y = validate_data(self, X, y, y_numeric=True, dtype=np.float64, ensure_min_samples=least)
        self.trust_ = np.column_stack([X.min(axis=0), X.max(axis=0)])
        self._moving = np.flatnonzero(self.trust_[:, 1] > self.trust_[:, 0])
        self.weights_ = None
        self._mean = float(y.mean())
        if self._moving.size and np.ptp(y) > 0:
            seed = self.random_state
            if not isinstance(seed, int):
                seed = int(check_random_state(seed).randint(2**31 - 1 - self.members))
            trained = members_of(X[:, self._moving], y, self.width, self.members, seed)
            self.weights_ = joined(trained)
        return self

    def predict(self, X: Any) -> Array:
        """The target (N,) that the features ``X`` (N, I) give, in the unit of the target.

        Raises:
            NotFittedError: before ``fit``.
            ValueError: other features than in ``fit``.
        """
        check_is_fitted(self)
        X = validate_data(self, X, reset=False, dtype=np.float64)
        if self.weights_ is None:
            return np.full(len(X), self._mean)
        force = evaluated(self.weights_, X[:, self._moving])
        return force * self._trusted(X) if self.fade else force

    def _trusted(self, X: Array) -> Array:
        """1 (N,) inside of what was seen, falling to 0 a tenth of its width further, dimensionless:
        as in a model file."""
        low, high = self.trust_[self._moving].T
        beyond = np.maximum(np.maximum(low - X[:, self._moving], X[:, self._moving] - high), 0.0)
        inside = 1 - np.minimum(beyond / (FADE * (high - low)), 1.0)
        return np.asarray((inside**2 * (3 - 2 * inside)).prod(axis=1))


def _powers(features: int, degree: int) -> Iterator[Powers]:
    """Every term up to a degree, the lower ones first."""
    for size in range(degree + 1):
        yield from combinations_with_replacement(range(features), size)


def _columns(X: Array, powers: Sequence[Powers]) -> Array:
    """The terms (N, T) of features (N, I)."""
    return np.column_stack([np.empty((len(X), 0)), *(X[:, list(p)].prod(axis=1) for p in powers)])


def _independent(columns: Array) -> list[int]:
    """The columns (N, T) that those before them do not give, at most one less than there are
    rows."""
    basis = np.empty((len(columns), 0))
    kept: list[int] = []
    for i, column in enumerate(columns.T):
        size = float(np.linalg.norm(column))
        if size == 0 or len(kept) == len(columns) - 1:
            continue
        rest = column / size
        for _ in range(2):  # once is not exact
            rest = rest - basis @ (basis.T @ rest)
        left = float(np.linalg.norm(rest))
        if left > APART:
            basis = np.column_stack([basis, rest / left])
            kept.append(i)
    return kept


def _said(term: Powers, names: Sequence[str]) -> str:
    """A term as an expression: ``x*x'**2``, ``1``."""
    parts = [
        names[i] + (f"**{term.count(i)}" if term.count(i) > 1 else "") for i in dict.fromkeys(term)
    ]
    return "*".join(parts) or "1"

"""The joint posterior of what a diagnosis claims: Gaussian, as the last fit says it.

Sizes: K numbers.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.evidence import Correlations, correlation_of
from symhyb.errors import InputError, Problem

CHAINS, DRAWS = 4, 1000


@dataclass(frozen=True, slots=True, eq=False)
class Posterior:
    """Numbers that were fitted together: ``names`` (``found_friction.coulomb``, ``k``,
    ``laser.gain``), their ``mean`` (K,), ``covariance`` (K, K) and ``units``, those of the model
    file, in which their ``paths`` are the names (``found_friction.F_c``). The deviations are those
    that the diagnosis states, the correlations those of its last fit: Laplace's approximation,
    which knows no bounds."""

    names: tuple[str, ...]
    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]
    units: tuple[str, ...]
    paths: tuple[str, ...]

    @property
    def sd(self) -> NDArray[np.float64]:
        """One standard deviation of each number (K,), in its unit."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def correlation(self) -> NDArray[np.float64]:
        """How the errors of two numbers go together (K, K), dimensionless, −1 to 1."""
        return correlation_of(self.covariance)

    @property
    def correlations(self) -> Correlations:
        """The same by the names of the corrected model file."""
        return Correlations(self.paths, self.correlation)

    def __repr__(self) -> str:
        return f"<Posterior of {', '.join(self.names)}>"

    def sample(self, size: int, seed: int = 0) -> NDArray[np.float64]:
        """Draws (size, K) of all numbers together, each in its unit."""
        scaled = np.random.default_rng(seed).multivariate_normal(
            np.zeros(self.mean.size), self.correlation, size, method="eigh"
        )
        return np.asarray(self.mean + scaled * self.sd)

    def to_arviz(self, draws: int = DRAWS, chains: int = CHAINS, seed: int = 0) -> Any:
        """Independent draws as ArviZ takes them: a DataTree with a group ``posterior``, a variable
        a number, and its unit in ``attrs["units"]``.

        Raises:
            InputError: arviz-base is not installed.
        """
        try:
            from arviz_base import from_dict
        except ImportError as error:
            text = f'needs the package arviz-base ({error}); run: pip install "symhyb[arviz]"'
            raise InputError(Problem(text)) from error
        drawn = self.sample(chains * draws, seed).reshape(chains, draws, -1)
        tree = from_dict({"posterior": {name: drawn[..., i] for i, name in enumerate(self.names)}})
        for name, unit in zip(self.names, self.units, strict=True):
            tree["posterior"][name].attrs["units"] = unit
        return tree

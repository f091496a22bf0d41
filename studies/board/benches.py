"""The two benches with one face: a module with ``BUILD`` (folder of the cases), ``SEEDS`` (between
which fresh ones are drawn), ``drawn(seeds, kinds, build)`` and ``line(case, result, sealed)``.

Their scripts lie in folders of their own and share names, so one process has one bench.
"""

import sys
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import ModuleType

STUDIES = Path(__file__).resolve().parents[1]
NAMES = ("concealed", "outside")
sys.path.append(str(STUDIES / "concealed"))  # what both benches and the peers share lies there

from bars import bound  # noqa: E402
from plans import seeds_of  # noqa: E402
from seal import unseal  # noqa: E402

__all__ = ["NAMES", "STUDIES", "Drawn", "bench_of", "bound", "seeds_of", "unseal"]


@dataclass(frozen=True, slots=True)
class Drawn:
    """A drawn case and its folder, which holds the seal."""

    name: str
    folder: Path


def bench_of(name: str) -> ModuleType:
    """The module of a bench, whose folder goes to the beginning of the path."""
    sys.path.insert(0, str(STUDIES / name))
    return import_module(f"bench_{name}")

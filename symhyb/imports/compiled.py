"""What MuJoCo compiled of an MJCF, with a name for everything."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from symhyb.data.files.table import Table
from symhyb.data.hosts.mjcf_file import ROOT, shown
from symhyb.imports.robot import Array


@dataclass(frozen=True, slots=True)
class Compiled:
    """MuJoCo's arrays by name ((N,) or (N, k), of N bodies or joints, SI), with the names of
    bodies, joints and sites, none of which is empty or twice among its kind, and those of
    ``equalities`` as they are."""

    arrays: Mapping[str, Array]
    name: str
    bodies: list[str]
    joints: list[str]
    sites: list[str]
    equalities: list[str]
    left_out: tuple[str, ...]

    @staticmethod
    def of(table: Table) -> "Compiled":
        """What a table of columns, and of names in JSON as its note, holds."""
        words: dict[str, Any] = json.loads(table.notes[0])
        arrays = {column.header: column.values for column in table.columns}
        bodies = [
            ROOT if not k else shown(name) or f"body_{k}" for k, name in enumerate(words["bodies"])
        ]
        joints = [shown(name) or f"joint_{k}" for k, name in enumerate(words["joints"])]
        sites = [shown(name) or f"site_{k}" for k, name in enumerate(words["sites"])]
        return Compiled(
            arrays,
            shown(words["name"]),
            _apart(bodies),
            _apart(joints),
            _apart(sites),
            [shown(name) for name in words["equalities"]],
            tuple(words["left_out"]),
        )

    def index(self, name: str, row: int) -> int:
        """A whole number out of an array."""
        return int(self.arrays[name][row])


def _apart(names: list[str]) -> list[str]:
    """The names, with a number behind those that were there."""
    taken: set[str] = set()
    return [unused(name, taken) for name in names]


def unused(name: str, taken: set[str]) -> str:
    """A name that is not taken, and then is."""
    one, count = name, 1
    while one in taken:
        count += 1
        one = f"{name}_{count}"
    taken.add(one)
    return one

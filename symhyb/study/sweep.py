"""The sweep of a study file: of what one study many diagnoses are made.

[sweep]
models = ["stiff.toml", "soft.toml"]     # each of these instead of the model
each   = "recording"                     # each training recording by itself; or each = "mount":
                                         # those of each group of a grouping
[sweep.values]                           # of parameters of the model, in its units: a grid
m = [0.5, 0.6]
[sweep.subsets]                          # count random subsets of size training recordings
size  = 3
count = 10
seed  = 1
[sweep.noise]                            # added to the sensors of the training recordings
levels = [0.0, 0.01]                     # as a part of the standard deviation of each sensor
seeds  = [1, 2]
[[sweep.options]]                        # what the study says of map, own, score and finish
name = "own drag"
own  = ["drag"]
[[sweep.structures]]                     # of tasks that fit: what each fits beside the others
name = "dry"
fit  = ["F"]

Every combination is one diagnosis, or one fit of all structures.
"""

from dataclasses import dataclass
from pathlib import Path

from symhyb.model.tables import Table, describe
from symhyb.study.folders import Folders
from symhyb.study.options import KEYS, Options, read_options
from symhyb.study.sources import file_named

AXES = ("models", "each", "values", "subsets", "noise", "options", "structures")
FEWEST_STRUCTURES = 2  # that can be compared


@dataclass(frozen=True, slots=True)
class Noise:
    """White noise that is added to every sensor: ``level`` as a part of the standard deviation of
    what the sensor shows, ``seed`` of its random numbers."""

    level: float
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Subsets:
    """``count`` different random subsets of ``size`` training recordings."""

    size: int
    count: int
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Structure:
    """One of several structures of a model that are fitted and compared: ``fit`` are its numbers
    beside those that the study fits in all of them, ``values`` are where numbers stand in it, by
    path and in the units of the model: at the begin of the fit, or throughout."""

    name: str
    fit: tuple[str, ...] = ()
    values: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Sweep:
    """What is varied: an axis that is empty varies nothing. ``values`` are by the path of a
    parameter, in the units of the model; ``each`` is ``recording``, or a grouping."""

    models: tuple[Path, ...] = ()
    each: str = ""
    values: tuple[tuple[str, tuple[float, ...]], ...] = ()
    subsets: Subsets | None = None
    noise: tuple[Noise, ...] = ()
    options: tuple[tuple[str, Options], ...] = ()
    structures: tuple[Structure, ...] = ()


def read_sweep(root: Table, folders: Folders) -> Sweep | None:
    """The sweep of a study, None without one; what is wrong becomes a fault of ``root``."""
    table = root.table("sweep")
    if table is None:
        return None
    table = table.checked(AXES)
    if not table.entries:
        table.fault("varies nothing; name at least one of " + ", ".join(AXES))
    if "each" in table.entries and "subsets" in table.entries:
        table.fault("state each or subsets, not both: both choose the training recordings")
    return Sweep(
        models=_models(table, folders),
        each=table.text("each") or "",
        values=_grid(table),
        subsets=_subsets(table),
        noise=_noise(table),
        options=_options(table),
        structures=_structures(table),
    )


def read_values(root: Table) -> tuple[tuple[str, float], ...]:
    """The values of parameters that a study sets, by path, in the units of the model."""
    table = root.table("values")
    found = [(path, table.number(path)) for path in table.entries] if table else []
    return tuple((path, value) for path, value in found if value is not None)


def read_noise(root: Table) -> Noise | None:
    """The noise that a study adds, None without."""
    table = root.table("noise")
    if table is None:
        return None
    table = table.checked(("level", "seed"))
    level, seed = table.number("level", required=True), _whole(table, "seed", 0, 0)
    return None if level is None else Noise(_level(table, level, "level"), seed)


def _models(table: Table, folders: Folders) -> tuple[Path, ...]:
    names = _listed(table, "models", str, "model files")
    found = (file_named(table, "models", name, folders) for name in names)
    return tuple(dict.fromkeys(path for path in found if path is not None))


def _grid(table: Table) -> tuple[tuple[str, tuple[float, ...]], ...]:
    grid = table.table("values")
    return tuple((path, _numbers(grid, path)) for path in grid.entries) if grid else ()


def _subsets(table: Table) -> Subsets | None:
    stated = table.table("subsets")
    if stated is None:
        return None
    stated = stated.checked(("size", "count", "seed"))
    for key in ("size", "count"):
        if stated.lacks(key):
            stated.fault(f"'{key}' is missing", key)
    size, count = _whole(stated, "size", 1, 1), _whole(stated, "count", 1, 1)
    return Subsets(size, count, _whole(stated, "seed", 0, 0))


def _noise(table: Table) -> tuple[Noise, ...]:
    """Every level with every seed; a level of 0 needs none and stands once."""
    stated = table.table("noise")
    if stated is None:
        return ()
    stated = stated.checked(("levels", "seeds"))
    levels = [_level(stated, level, "levels") for level in _numbers(stated, "levels")]
    seeds = [0]
    if "seeds" in stated.entries:
        seeds = _listed(stated, "seeds", int, "whole numbers")
        if any(seed < 0 for seed in seeds):
            stated.fault("must be whole numbers from 0 on", "seeds")
    pairs = (Noise(level, seed if level else 0) for level in levels for seed in seeds)
    return tuple(dict.fromkeys(pairs))


def _options(table: Table) -> tuple[tuple[str, Options], ...]:
    """Sets of options, each with its name."""
    read = _named(table, "options", "set", KEYS)
    return tuple((name, read_options(one)) for name, one in read.items())


def _structures(table: Table) -> tuple[Structure, ...]:
    """The structures that every task fits and compares."""
    read = _named(table, "structures", "structure", ("fit", "values"))
    found = []
    for name, one in read.items():
        fit = tuple(_listed(one, "fit", str, 'names, like ["F"]')) if "fit" in one.entries else ()
        found.append(Structure(name, fit, read_values(one)))
    if found and len(found) < FEWEST_STRUCTURES:
        text = f"one structure is compared with nothing; state {FEWEST_STRUCTURES} or more"
        table.fault(text, "structures")
    return tuple(found)


def _named(table: Table, key: str, what: str, keys: tuple[str, ...]) -> dict[str, Table]:
    """The tables of a list, by their names."""
    listed = table.entries.get(key, [])
    if not isinstance(listed, list) or not all(isinstance(entry, dict) for entry in listed):
        text = f"write each {what} as a table [[sweep.{key}]], not {describe(listed)}"
        table.fault(text, key)
        return {}
    found: dict[str, Table] = {}
    for number, entries in enumerate(listed, 1):
        one = Table((*table.path, f"{key}[{number}]"), entries, table.faults)
        one = one.checked(("name", *keys))
        name = one.text("name", required=True)
        if name is None:
            if one.lacks("name"):
                one.fault("'name' is missing: what the results call it")
        elif name in found:
            one.fault(f"'{name}' is the name of another {what} already", "name")
        found[name or ""] = one
    return found


def _listed(table: Table, key: str, kind: type, what: str) -> list:  # type: ignore[type-arg]
    """The items of a list that are of one type, each once."""
    value = table.entries.get(key, [])
    good = isinstance(value, list) and all(type(item) is kind for item in value)
    if not good or (key in table.entries and not value):
        table.fault(f"must be a list of {what}, not {describe(value)}", key)
        return []
    assert isinstance(value, list)
    if len(set(value)) < len(value):
        table.fault("holds an entry twice", key)
    return value


def _numbers(table: Table, key: str) -> tuple[float, ...]:
    value = table.entries.get(key)
    if not isinstance(value, list) or not value:
        table.fault(f"must be a list of numbers, like [0.5, 0.6], not {describe(value)}", key)
        return ()
    found = tuple(x for item in value if (x := table.as_number(item, key)) is not None)
    if len(set(found)) < len(found):
        table.fault("holds a number twice", key)
    return found


def _whole(table: Table, key: str, least: int, unset: int) -> int:
    value = table.entries.get(key, unset)
    if type(value) is not int or value < least:
        table.fault(f"must be a whole number from {least} on, not {describe(value)}", key)
        return unset
    return value


def _level(table: Table, level: float, key: str) -> float:
    if level < 0:
        table.fault(f"must not be negative, not {level:g}", key)
    return level

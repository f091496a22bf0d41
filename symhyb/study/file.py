"""Read a study file (TOML, format 1): which model meets which recordings, or every problem at once.

symhyb = 1
title  = "Linear ball-screw drive"       # of the report; without it the title of the model
about  = "what the study shows"
model  = "../../models/emps.toml"        # paths are relative to the study file

fit = ["k"]                              # the tasks of a sweep fit these, and diagnose nothing
budget = "10min"                         # after which the diagnosis ends; without it, no end
own    = ["m", "drag"]                   # of which every recording has its own value: parameters
                                         # of the model, keys of laws; all else is shared
[map]                                    # what --map says on the command line
force = "gtau*vir"                       # for all recordings; each may have its own entries

[[train]]                                # once or more: recordings to learn from
data = "emps/DATA_EMPS.mat"              # a file of a known public recording
span = [0.0, 20.0]                       # s; the rest is dropped
parameters = { m = 0.535 }               # known values in this recording, in the model's units

[[holdout]]                              # unseen recordings, for the proof alone
file = "pulses.csv"                      # a file beside the study
map  = { force = "F [kN]" }              # instead of, and besides, the entries above

[score]
window_s      = 0.25                     # without it, chosen from the recordings
force_band_hz = 60

How many recordings are named at once stands in :mod:`symhyb.study.sources`, how many diagnoses are
made of one study in :mod:`symhyb.study.sweep`.
"""

import os
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from symhyb.data.groups import EACH, Own
from symhyb.deadline import WANTED, seconds_of
from symhyb.errors import InputError, Problem
from symhyb.limits import text_of
from symhyb.model.source import scan
from symhyb.model.tables import Fault, Table, describe
from symhyb.study.folders import Folders, folders_of
from symhyb.study.options import read_options
from symhyb.study.sources import Source, file_named, read_sources
from symhyb.study.sweep import Noise, Structure, Sweep, read_noise, read_sweep, read_values

FORMAT = 1
"""The version of the study file that is read."""

SECTIONS = (
    "symhyb",
    "title",
    "about",
    "model",
    "map",
    "own",
    "budget",
    "train",
    "holdout",
    "score",
    "finish",
    "fit",
    "values",
    "noise",
    "sweep",
)


OF_DIAGNOSES = ("own", "budget", "holdout", "score", "finish")
"""Keys that a study whose tasks only fit has no use for."""


@dataclass(frozen=True, slots=True)
class Study:
    """What is to be diagnosed: paths as the working directory sees them, ``columns`` as in
    :func:`symhyb.read_recording`, for all recordings; ``file`` is None for a study that no
    file states. ``last_values``: whether every uncertain number of the corrected model is fitted
    once more to all training recordings; ``remainder`` the coordinate that then gets a smooth
    remainder, ``network`` the one that gets a trained network, None for none. ``own`` has for each
    name of what not all recordings share the grouping of those that do, empty for none. ``known``
    is a table of known values of parameters in each recording, ``groups`` one of their groups.
    ``budget_s`` is the time in s after which the diagnosis ends, None for no end.
    ``fit`` are the names of the numbers of the model that the tasks of a sweep fit, where they
    diagnose nothing; empty for all that state an sd, None for diagnoses; where a task compares
    ``structures``, those of all of them. ``values`` are set in the model, by the path of a
    parameter and in its units; ``noise`` is added to the training recordings; of a ``sweep`` many
    studies are made, in each of which it is
    None."""

    model: Path
    train: tuple[Source, ...]
    holdout: tuple[Source, ...] = ()
    columns: Mapping[str, str] | None = None
    title: str = ""
    about: str = ""
    window_s: float | None = None
    force_band_hz: float | None = None
    file: Path | None = None
    own: Own = field(default_factory=dict)
    last_values: bool = False
    remainder: str | None = None
    network: str | None = None
    known: Path | None = None
    groups: Path | None = None
    budget_s: float | None = None
    values: tuple[tuple[str, float], ...] = ()
    noise: Noise | None = None
    fit: tuple[str, ...] | None = None
    structures: tuple[Structure, ...] = ()
    sweep: Sweep | None = None

    def columns_of(self, source: Source) -> Mapping[str, str]:
        """The map of one recording: its own entries before those of all recordings."""
        return {**(self.columns or {}), **dict(source.columns)}

    @property
    def stated_own(self) -> list[str] | dict[str, str]:
        """What not all recordings share, as a study file says it."""
        if not any(self.own.values()):
            return list(self.own)
        return {name: by or EACH for name, by in self.own.items()}


def read_study(
    path: str | os.PathLike[str], within: Sequence[str | os.PathLike[str]] = ()
) -> Study:
    """Read and check a study file; model and recordings are looked for, but not read yet. They may
    lie in the folder of the study, in its project, and in the folders ``within``.

    Raises:
        InputError: every problem of the file, each with file, line and dotted name.
    """
    file = Path(path)
    text = text_of(file)
    try:
        document = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(Problem(f"is not valid TOML: {error}", file=str(file))) from None
    faults: list[Fault] = []
    root = Table((), document, faults).checked(SECTIONS)
    _check_format(root)
    study = _study(root, file, folders_of(file, within))
    if faults:
        raise InputError(sorted(_problems(faults, text, file), key=lambda problem: problem.line))
    return study


def _check_format(root: Table) -> None:
    version = root.entries.get("symhyb")
    if version is None and root.lacks("symhyb"):
        root.fault(f"the file does not state its format; begin it with: symhyb = {FORMAT}")
    elif version is not None and (version != FORMAT or isinstance(version, bool)):
        root.fault(f"must be the number {FORMAT}, not {describe(version)}", "symhyb")


def _study(root: Table, file: Path, folders: Folders) -> Study:
    sweep = read_sweep(root, folders)
    name = root.text("model", required=sweep is None or not sweep.models)
    if name is not None and sweep is not None and sweep.models:
        root.fault("the sweep states models; leave out one of both", "model")
    if not root.entries.get("train") and root.lacks("train"):
        root.fault("[[train]] is missing: name at least one recording to learn from")
    return Study(
        model=file_named(root, "model", name, folders) or Path(),
        train=read_sources(root, "train", folders),
        holdout=read_sources(root, "holdout", folders),
        title=root.text("title") or "",
        about=root.about(),
        file=file,
        budget_s=_budget(root),
        values=read_values(root),
        noise=read_noise(root),
        fit=_fit(root, sweep),
        sweep=sweep,
        **read_options(root),
    )


def _budget(root: Table) -> float | None:
    """The time after which the diagnosis ends, s; None where none is stated."""
    text = root.text("budget")
    seconds = None if text is None else seconds_of(text)
    if text is not None and seconds is None:
        root.fault(f"must be {WANTED}, not '{text}'", "budget")
    return seconds


def _fit(root: Table, sweep: Sweep | None) -> tuple[str, ...] | None:
    """What the tasks of a sweep fit, None where they diagnose."""
    structures = () if sweep is None else sweep.structures
    if structures and not root.entries.get("fit"):
        text = 'structures are compared by fits; name what all of them fit, as fit = ["k"]'
        root.fault(text, "sweep", "structures")
    if "fit" not in root.entries:
        return None
    names = root.entries["fit"]
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        root.fault(
            f'must be a list of names, like ["k", "laser.gain"], not {describe(names)}', "fit"
        )
        return None
    if sweep is None:
        root.fault("is for the tasks of a [sweep]; symhyb fit fits one model once", "fit")
    options = () if sweep is None else sweep.options
    stated = [key for key in OF_DIAGNOSES if key in root.entries]
    stated += [f"sweep.options.{name}" for name, fields in options if set(fields) - {"columns"}]
    for key in stated:
        root.fault(
            f"'{key}' says how to diagnose, but tasks only fit; leave out one of both", "fit"
        )
    return tuple(names)


def _problems(faults: list[Fault], text: str, file: Path) -> Iterator[Problem]:
    source = scan(text)
    for path, sentence in faults:
        yield Problem(sentence, ".".join(path), str(file), source.line(*path))

"""The tasks of a study: every combination of what its sweep varies, each a study of its own."""

import math
import os
import random
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from itertools import product
from pathlib import Path

from symhyb.data.groups import EACH
from symhyb.data.known import unusable
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.limits import STUDY_TASKS
from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.model.write import set_parameters
from symhyb.study.file import Study
from symhyb.study.options import Options
from symhyb.study.sources import Source
from symhyb.study.sweep import Noise, Subsets, Sweep
from symhyb.tasks.keys import Digests, key_of

WHOLE = "study"
"""The name of the one task of a study without a sweep."""
LISTED = 5  # names in a sentence

Settings = tuple[tuple[str, str], ...]
Choice = tuple[Settings, Options]


@dataclass(frozen=True, slots=True)
class Task:
    """One diagnosis: ``settings`` are what the sweep chose, by axis; ``study`` has no sweep.
    ``key`` is the same for tasks into which the same goes."""

    settings: Settings
    study: Study
    key: str

    @property
    def name(self) -> str:
        """The settings in one line."""
        return ", ".join(f"{axis}={value}" for axis, value in self.settings) or WHOLE

    def fits(self, pattern: str) -> bool:
        """Whether a pattern with ``*`` and ``?`` fits the name, one of the settings, or the key."""
        said = (self.name, self.key, *(f"{axis}={value}" for axis, value in self.settings))
        return any(fnmatchcase(one, pattern) for one in said)


def tasks_of(study: Study) -> tuple[Task, ...]:
    """The tasks of a study in the order of its file; no recording is interpreted yet.

    Raises:
        InputError: names of parameters or groups that are not there, recordings that are both, more
            subsets than there are, or too many tasks: all problems at once; or models that are
            wrong.
    """
    sweep = study.sweep or Sweep()
    models = {path: read_model(path) for path in sweep.models or (study.model,)}
    _require_sound(study, sweep, models)
    axes = [
        _models(study, sweep),
        _values(study, sweep),
        _recordings(study, sweep),
        _noise(sweep.noise),
        _options(sweep),
    ]
    count = math.prod(map(len, axes))
    if count > STUDY_TASKS:
        text = f"{count} combinations are more than {STUDY_TASKS} tasks"
        raise InputError(Problem(text, "sweep", str(study.file or "")))
    digests, tasks = Digests(), []
    for chosen in product(*axes):
        settings = tuple(one for part, _ in chosen for one in part)
        fields = {key: value for _, part in chosen for key, value in part.items()}
        one = replace(study, sweep=None, structures=sweep.structures, **fields)
        tasks.append(Task(settings, one, key_of(one, models[one.model], digests)))
    return tuple(tasks)


def chosen(tasks: Sequence[Task], patterns: Sequence[str]) -> tuple[Task, ...]:
    """The tasks that one of the patterns fits, all without patterns.

    Raises:
        InputError: patterns that fit no task.
    """
    known = list(dict.fromkeys(f"{axis}={value}" for one in tasks for axis, value in one.settings))
    problems = [
        Problem(f"fits no task{did_you_mean(one, known)}", f"--only {one}")
        for one in patterns
        if not any(task.fits(one) for task in tasks)
    ]
    if problems:
        raise InputError(problems)
    return tuple(t for t in tasks if not patterns or any(t.fits(one) for one in patterns))


def _models(study: Study, sweep: Sweep) -> list[Choice]:
    return [
        ((("model", _as_seen_from(study.file, path)),), {"model": path}) for path in sweep.models
    ] or [((), {})]


def _values(study: Study, sweep: Sweep) -> list[Choice]:
    """A grid: each value of a parameter with each of all others."""
    paths = [path for path, _ in sweep.values]
    found: list[Choice] = []
    for combination in product(*(values for _, values in sweep.values)):
        pairs = tuple(zip(paths, combination, strict=True))
        stated = tuple({**dict(study.values), **dict(pairs)}.items())
        settings = tuple((f"values.{path}", repr(value)) for path, value in pairs)
        found.append((settings, {"values": stated}))
    return found


def _recordings(study: Study, sweep: Sweep) -> list[Choice]:
    """Which training recordings a task has."""
    if sweep.subsets is not None:
        subsets = enumerate(_subsets(study.train, sweep.subsets), 1)
        return [((("recordings", f"subset {n}"),), {"train": part}) for n, part in subsets]
    if sweep.each == EACH:
        return [
            ((("recordings", label),), {"train": (one,)})
            for label, one in zip(_labels(study, study.train), study.train, strict=True)
        ]
    if sweep.each:
        groups: dict[str, list[Source]] = {}
        for one in study.train:
            groups.setdefault(dict(one.groups)[sweep.each], []).append(one)
        return [((("recordings", by),), {"train": tuple(part)}) for by, part in groups.items()]
    return [((), {})]


def _subsets(sources: Sequence[Source], wanted: Subsets) -> Iterator[tuple[Source, ...]]:
    """Different random subsets, the recordings of each in their order."""
    chance, seen = random.Random(wanted.seed), set[tuple[int, ...]]()
    while len(seen) < wanted.count:
        picked = tuple(sorted(chance.sample(range(len(sources)), wanted.size)))
        if picked not in seen:
            seen.add(picked)
            yield tuple(sources[i] for i in picked)


def _noise(wanted: Sequence[Noise]) -> list[Choice]:
    found: list[Choice] = []
    seeds = len({one.seed for one in wanted if one.level}) > 1
    for one in wanted:
        settings: Settings = (("noise", repr(one.level)),)
        if seeds:
            settings = (*settings, ("seed", str(one.seed) if one.level else ""))
        found.append((settings, {"noise": one if one.level else None}))
    return found or [((), {})]


def _options(sweep: Sweep) -> list[Choice]:
    return [((("options", name),), fields) for name, fields in sweep.options] or [((), {})]


def _labels(study: Study, sources: Sequence[Source]) -> list[str]:
    """A name for each recording that no other has: with its span where a file stands twice."""
    names = [s.data if s.file is None else _as_seen_from(study.file, s.file) for s in sources]
    found, times = [], Counter(names)
    for name, source in zip(names, sources, strict=True):
        if times[name] > 1:
            start, end = ("" if bound is None else f"{bound:g}" for bound in source.span)
            name = f"{name} {start}-{end} s"
        found.append(name)
    alike = Counter(found)
    return [f"{name} #{i}" if alike[name] > 1 else name for i, name in enumerate(found, 1)]


def _as_seen_from(study: Path | None, path: Path) -> str:
    """The name of a file as a study would write it, with ``/`` between folders."""
    home = Path() if study is None else study.parent
    return Path(os.path.relpath(path, home)).as_posix()


def _require_sound(study: Study, sweep: Sweep, models: Mapping[Path, Model]) -> None:
    """See that what a study names is there, before anything runs."""
    problems = [
        *_unknown_values(study, sweep, models.values()),
        *_unknown_parameters(study, models.values()),
        *_groups_missing(study, sweep),
        *_both(study),
        *_unknown_fitted(study, sweep, models.values()),
    ]
    if sweep.subsets is not None:
        total, wanted = len(study.train), sweep.subsets
        if math.comb(total, wanted.size) < wanted.count:
            text = (
                f"{wanted.count} different subsets of {wanted.size} are wanted, but "
                f"{total} training recordings have {math.comb(total, wanted.size)}"
            )
            problems.append(Problem(text, "sweep.subsets", str(study.file or "")))
    if problems:
        raise InputError(dict.fromkeys(problems))


def _unknown_values(study: Study, sweep: Sweep, models: Iterable[Model]) -> Iterator[Problem]:
    swept = {path: values[0] for path, values in sweep.values if values}
    for model in models:
        try:
            set_parameters(model, {**dict(study.values), **swept})
        except InputError as error:
            yield from error.problems


def _unknown_fitted(study: Study, sweep: Sweep, models: Iterable[Model]) -> Iterator[Problem]:
    """Numbers that are to be fitted and that are not there, or known in some recording."""
    if study.fit is None:
        return
    from symhyb.correction.calibration import chosen as numbers_of  # loads the numerics

    known = {path for source in study.train for path, _ in source.parameters}
    file = str(study.file or "")
    for model in models:
        for place, names, values in _fitted(study, sweep):
            try:
                set_parameters(model, dict(values))
                numbers = numbers_of(model, names)
            except InputError as error:
                wrong = error.problems
                yield from wrong if place == "fit" else (replace(one, place=place) for one in wrong)
                continue
            for path in dict.fromkeys([*(item.path for item in numbers), *dict(values)]):
                if path in known:
                    what = "to be fitted" if path not in dict(values) else "set by a structure"
                    text = f"'{path}' is {what}, but recordings state it as known"
                    yield Problem(text, place, file)


def _fitted(
    study: Study, sweep: Sweep
) -> Iterator[tuple[str, tuple[str, ...], tuple[tuple[str, float], ...]]]:
    """What a task fits: where that is stated, the names, and the values that are set for it."""
    if not sweep.structures:
        yield "fit", study.fit or (), ()
    for one in sweep.structures:
        yield f"sweep.structures.{one.name}", (*(study.fit or ()), *one.fit), one.values


def _unknown_parameters(study: Study, models: Iterable[Model]) -> Iterator[Problem]:
    """Known values of recordings that are of no parameter, and those that only some state."""
    stated: dict[str, set[Source]] = {}
    everything = (*study.train, *study.holdout)
    for source in everything:
        for path, _ in source.parameters:
            stated.setdefault(path, set()).add(source)
    for path, sources in stated.items():
        place = f"parameters.{path}"
        for model in models:
            wrong = unusable(path, {item.path: item for item in model.all_parameters()})
            if wrong:
                yield Problem(f"{wrong} (of {len(sources)} recordings)", place, model.file)
        without = [one.name for one in everything if one not in sources]
        if without:
            text = f"is stated of other recordings, but not of {_names(without)}"
            yield Problem(text, place, str(study.file or ""))


def _groups_missing(study: Study, sweep: Sweep) -> Iterator[Problem]:
    """Groupings that a study names and training recordings do not state."""
    named = {f"own.{name}": by for name, by in study.own.items() if by}
    for name, fields in sweep.options:
        stated: Mapping[str, str] = fields.get("own", {})
        named |= {f"sweep.options.{name}.own.{key}": by for key, by in stated.items() if by}
    if sweep.each and sweep.each != EACH:
        named["sweep.each"] = sweep.each
    known = list(dict.fromkeys(by for one in study.train for by, _ in one.groups))
    for place, by in named.items():
        without = [one.name for one in study.train if by not in dict(one.groups)]
        if without and by not in known:
            near = did_you_mean(by, known)
            yield Problem(f"no recording states its '{by}'{near}", place, str(study.file or ""))
        elif without:
            yield Problem(f"'{by}' is not stated of {_names(without)}", place, str(study.file))


def _both(study: Study) -> Iterator[Problem]:
    """Unseen recordings that are training recordings too."""
    seen = {(one.file, one.data, one.span) for one in study.train}
    for one in study.holdout:
        if (one.file, one.data, one.span) in seen:
            text = "is a training recording too; what is learned from cannot prove anything"
            yield Problem(text, "holdout", one.name)


def _names(names: Sequence[str]) -> str:
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return ", ".join(f"'{name}'" for name in names[:LISTED]) + more

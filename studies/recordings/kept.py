"""What a study of a real recording gave, as a small file: the page needs neither the recording nor
the hour that all studies take."""

import hashlib
import json
import platform
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from symhyb.report.contract import to_json
from symhyb.study.expected import Expected, read_expected
from symhyb.study.file import Study, read_study
from symhyb.study.run import StudyResult, manifest

STUDIES = Path(__file__).resolve().parents[1]
RESULTS = Path(__file__).resolve().parent / "results"
DIGITS = 6  # that are kept of a number
SAID = ("verdict", "sentence", "parameters", "measurement", "alternatives", "remainder", "scores")
OF_EFFECT = ("name", "kind", "place", "options", "law", "parameters", "share", "sentence", "own")


@dataclass(frozen=True, slots=True)
class Case:
    """A study of a real recording: its ``name`` (folder, or folder and file), what it states and
    expects, and what it gave (``kept``; None: it was not run)."""

    name: str
    study: Study
    expected: Expected
    kept: Mapping[str, Any] | None

    @property
    def file(self) -> Path:
        """The study file."""
        assert self.study.file is not None
        return self.study.file

    @property
    def figures(self) -> Mapping[str, Any] | None:
        """Scores that the study makes by a script of its own: ``scores.json`` beside it."""
        beside = self.file.with_name("scores.json")
        return json.loads(beside.read_text(encoding="utf-8")) if beside.is_file() else None

    @property
    def stale(self) -> bool:
        """Whether the study file or the model has changed since it was run."""
        if self.kept is None:
            return False
        files = {"study": self.file, "model": self.study.model}
        return any(self.kept[role]["sha256"] != sha256(file) for role, file in files.items())


def cases(studies: Path = STUDIES, results: Path = RESULTS) -> tuple[Case, ...]:
    """Every study whose recordings are public ones, in the order of their names.

    Raises:
        InputError: a study file or an ``expected.json`` is wrong.
    """
    found = []
    for file in sorted(studies.glob("**/study*.toml")):
        study = read_study(file)
        if not any(source.data for source in (*study.train, *study.holdout)):
            continue
        name = "-".join(file.parent.relative_to(studies).parts) + file.stem.removeprefix("study")
        beside = file.with_name("expected.json")
        expected = read_expected(beside) if beside.is_file() else Expected()
        path = results / f"{name}.json"
        kept = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None
        found.append(Case(name, study, expected, kept))
    return tuple(found)


def content(result: StudyResult, cpu: float, load: float) -> dict[str, Any]:
    """What is kept of a result; ``cpu`` is the time in s that all processors worked on it, ``load``
    how many other processes wanted one when it began (None: not known)."""
    said = to_json(result.diagnosis, result.verdict)
    made = manifest(result)
    whole = {
        **{role: made[role] for role in ("study", "model", "recordings", "versions", "seconds")},
        "cpu_seconds": round(cpu, 1),
        "load": round(load, 1),
        "machine": f"{platform.system()} {platform.machine()}",
        "verdict": said["verdict"],
        "sentence": said["sentence"],
        "found": [{key: one[key] for key in OF_EFFECT if key in one} for one in said["found"]],
        **{key: said[key] for key in SAID[2:]},
        "checks": made["checks"],
    }
    return dict(shorter(whole))


def keep(name: str, result: StudyResult, cpu: float, load: float, results: Path = RESULTS) -> Path:
    """Write what is kept of a result and return the file."""
    path = results / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(content(result, cpu, load), indent=1, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")
    return path


def shorter(value: Any) -> Any:
    """The same with every number rounded to ``DIGITS`` digits."""
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, Mapping):
        return {key: shorter(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [shorter(one) for one in value]
    return value


def sha256(file: Path) -> str:
    """The SHA-256 of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()

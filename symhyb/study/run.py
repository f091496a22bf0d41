"""The whole chain: model and recordings in, a judged diagnosis and its files out.

``diagnose`` on the command line and ``run`` are the same chain; a study that a file states also
leaves ``manifest.json`` (what went in, with which versions) and is held against ``expected.json``.
"""

import json
import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from symhyb.asked import asked
from symhyb.correction.apply import apply
from symhyb.correction.finish import finished
from symhyb.correction.learning.network import NO_NETWORK, train_network
from symhyb.correction.learning.remainder import NO_REMAINDER, remainder
from symhyb.correction.search.so_far import if_interrupted
from symhyb.data.cleaning import cleaned, still
from symhyb.data.datasets import fetch
from symhyb.data.group_table import read_groups
from symhyb.data.groups import require_groups
from symhyb.data.known import require_known
from symhyb.data.known_table import table_of_known
from symhyb.data.noisy import noisier
from symhyb.data.recording import Recording, read_recording
from symhyb.deadline import deadline_of
from symhyb.diagnosis import advised, conclude
from symhyb.discrepancy.checks.first_checks import FirstChecks, first_checks
from symhyb.discrepancy.checks.suspicion import repaired
from symhyb.discrepancy.fitting.judge import judge
from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.errors import InputError, Problem
from symhyb.model.closed import require_open
from symhyb.model.diff import diff
from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.model.write import set_parameters, write_model
from symhyb.numeric.kernels.memory import seldom_collected
from symhyb.numeric.lowered.machine import build
from symhyb.report.contract import exit_status, to_json
from symhyb.report.files import write_diagnosis, write_report, write_simulation
from symhyb.steps import Say, silent
from symhyb.study.expected import Check, Expected, check, read_expected
from symhyb.study.file import Study, read_study
from symhyb.study.provenance import entry_of, sha256_of, table_hashes, versions
from symhyb.study.sources import Source
from symhyb.study.unseen import require_unseen
from symhyb.writing import require_folder, staged

COMPLETE = "the diagnosis, which is written; only what to record next is not worked out"


Leave = Callable[["StudyResult"], None]


@dataclass(frozen=True, slots=True)
class StudyResult:
    """What came out of a study, ``seconds`` the time it took; ``checks`` are empty where nothing
    is expected, ``first`` the first checks of the first training recording."""

    study: Study
    model: Model
    corrected: Model
    train: tuple[Recording, ...]
    holdout: tuple[Recording, ...]
    diagnosis: Diagnosis
    verdict: Verdict
    checks: tuple[Check, ...]
    seconds: float
    first: FirstChecks | None = None

    @property
    def passed(self) -> bool:
        """Whether everything that was expected came out."""
        return all(check.passed for check in self.checks)

    @property
    def exit_status(self) -> int:
        """0 if nothing is missing and the expectation is met, else 1."""
        return exit_status(self.diagnosis) if self.passed else 1


@asked
def run_study(
    path: str | os.PathLike[str],
    directory: str | os.PathLike[str],
    say: Say | None = None,
    within: Sequence[str | os.PathLike[str]] = (),
    keep: Leave | None = None,
) -> StudyResult:
    """Run the study that a file states, and leave its files in ``directory``. Model and recordings
    may lie in the folder of the study, in its project, and in the folders ``within``. ``keep`` gets
    every result whose files are left.

    Raises:
        InputError: the study, its model or a recording is wrong, or nothing can be written.
        NumericsError: the numerics failed; nothing is written.
    """
    return run_read(read_study(path, within), directory, say, keep)


def run_read(
    study: Study,
    directory: str | os.PathLike[str],
    say: Say | None = None,
    keep: Leave | None = None,
) -> StudyResult:
    """:func:`run_study` of a study that was read from its file.

    Raises:
        InputError: it states a sweep, its model or a recording is wrong, or nothing can be written.
        NumericsError: the numerics failed; nothing is written.
    """
    if study.sweep is not None:
        text = "states many diagnoses, which symhyb run performs; leave it out for a single one"
        raise InputError(Problem(text, "sweep", str(study.file or "")))
    beside = None if study.file is None else study.file.with_name("expected.json")
    expected = read_expected(beside) if beside and beside.is_file() else Expected()
    require_folder(directory)

    def checked(result: StudyResult) -> StudyResult:
        return replace(result, checks=check(expected, to_json(result.diagnosis, result.verdict)))

    def leave(result: StudyResult) -> None:
        leave_files(checked(result), directory)
        if keep is not None:
            keep(checked(result))

    return checked(carry_out(study, say, leave))


@seldom_collected()
def carry_out(study: Study, say: Say | None = None, leave: Leave | None = None) -> StudyResult:
    """Diagnose, correct the model and judge the correction.

    ``leave`` gets the result to write it down: before advice on what to record next is sought,
    so that nothing that happens then costs the diagnosis, and once more if there is advice.

    Raises:
        InputError: the model or a recording is wrong: all problems of all recordings at once; or a
            remainder or a network is wanted of an FMU.
        NumericsError: the numerics failed.
    """
    say = say or silent
    begin, deadline = time.perf_counter(), deadline_of(study.budget_s)
    say("reading the model and the recordings")
    model = set_parameters(read_model(study.model), dict(study.values))
    if study.remainder or study.network:
        require_open(model)
    train, holdout = read_all(study, model)
    concluded = conclude(model, train, holdout, own=study.own, say=say, deadline=deadline)
    diagnosis = concluded.diagnosis
    corrected = apply(
        model,
        diagnosis.found,
        diagnosis.parameters,
        diagnosis.measurement,
        diagnosis.courses,
    )
    seen = repaired(cleaned(train, model), diagnosis.faults)
    corrected, reported = _finish(study, corrected, corrected != model, seen, say)
    diagnosis = replace(diagnosis, remainder_notes=(*diagnosis.remainder_notes, *reported))
    say("judging the correction")
    verdict = judge(  # on what the diagnosis put right: exchanged columns, times, wrong samples
        model,
        corrected,
        repaired(cleaned(holdout, model), diagnosis.faults),
        train=seen,
        window_s=study.window_s,
        force_band_hz=study.force_band_hz,
        correlations=diagnosis.correlations,
        own={one.name: diagnosis.values_of(one) for one in (*train, *holdout)},
    )
    say("first checks")
    first = _first_checks(model, corrected, seen, verdict)
    seconds = time.perf_counter() - begin
    result = StudyResult(
        study, model, corrected, train, holdout, diagnosis, verdict, (), seconds, first
    )
    write = _writing(leave, say)
    write(result)
    with if_interrupted(lambda: COMPLETE if leave is not None else ""):
        final = advised(replace(concluded, diagnosis=diagnosis), say, deadline)
    if final is diagnosis:
        return result
    result = replace(result, diagnosis=final, seconds=time.perf_counter() - begin)
    write(result)
    return result


def _writing(leave: Leave | None, say: Say) -> Leave:
    """``leave`` with a line that says so, nothing where it is None."""

    def write(result: StudyResult) -> None:
        if leave is not None:
            say("writing the report")
            leave(result)

    return write


def _finish(
    study: Study, corrected: Model, changed: bool, seen: Sequence[Recording], say: Say
) -> tuple[Model, tuple[str, ...]]:
    """The corrected model with last values (if it was ``changed`` at all), a smooth remainder and a
    network, where the study asks for them, and what is to be said of it. Nothing is named by it."""
    reported: list[str] = []
    if study.last_values and changed:
        say("fitting the last values")
        last = finished(corrected, seen)
        corrected = last.model
        reported.append(last.sentence)
    if study.remainder:
        say("fitting a smooth remainder")
        smooth = remainder(corrected, seen, study.remainder)
        corrected = smooth.model if smooth else corrected
        reported.append(smooth.sentence if smooth else NO_REMAINDER)
    if study.network:
        say("training a network")
        trained = train_network(corrected, seen, study.network)
        corrected = trained.model if trained else corrected
        reported.append(trained.sentence if trained else NO_NETWORK)
    return corrected, tuple(reported)


def _first_checks(
    model: Model, corrected: Model, seen: Sequence[Recording], verdict: Verdict
) -> FirstChecks | None:
    """First checks of the first training recording, beside the free runs of the verdict; none
    where no sensor changes, and of a machine that another program
    runs, which states no energies and no place of rest."""
    recording = seen[0]
    if still([recording]) or model.engine is not None:
        return None
    changed = corrected != model
    runs = [
        {"model": trace.before, **({"corrected": trace.after} if changed else {})}
        for trace in verdict.traces
        if trace.recording == recording.name
        and trace.role == "train"
        and trace.t.size == recording.t.size
    ]
    machine = build(model)
    return first_checks(
        machine, recording, corrected=build(corrected), simulated=runs[0] if runs else None
    )


def leave_files(result: StudyResult, directory: str | os.PathLike[str]) -> None:
    """Write ``corrected.toml`` with the weights of its networks, ``diagnosis.json``,
    ``simulation.csv``, ``report.html`` and, for a study that a file states, ``manifest.json``: all
    of them or none.

    Raises:
        InputError: the files cannot be written.
        NumericsError: a fitted value is not finite.
    """
    name = result.study.model.name
    with staged(directory) as part:
        write_model(result.corrected, part / "corrected.toml")
        write_diagnosis(part / "diagnosis.json", result.diagnosis, result.verdict)
        write_simulation(part / "simulation.csv", result.verdict.traces, result.model)
        write_report(
            part / "report.html",
            result.diagnosis,
            result.verdict,
            result.model,
            title=result.study.title or None,
            difference=diff(
                replace(result.model, file=name), replace(result.corrected, file="corrected.toml")
            ),
            provenance=_provenance(result),
            first=result.first,
        )
        if result.study.file is not None:
            text = json.dumps(manifest(result), indent=2, ensure_ascii=False) + "\n"
            (part / "manifest.json").write_text(text, encoding="utf-8", newline="")


def manifest(result: StudyResult) -> dict[str, Any]:
    """Give what a study was made from: hashes, versions, duration and checks, but no paths."""
    study = result.study
    files = {"study": study.file, "model": study.model}
    return {
        **{
            role: {"file": file.name, "sha256": sha256_of(file)}
            for role, file in files.items()
            if file is not None
        },
        **table_hashes(result.model),
        "recordings": [
            entry_of(role, recording, source) for role, recording, source in _runs(result)
        ],
        "map": dict(study.columns or {}),
        **({"own": study.stated_own} if study.own else {}),
        **({"budget_s": study.budget_s} if study.budget_s else {}),
        **({"values": dict(study.values)} if study.values else {}),
        **({"noise": asdict(study.noise)} if study.noise else {}),
        "finish": {
            "values": study.last_values,
            "remainder": study.remainder,
            "network": study.network,
        },
        "versions": versions(),
        "seeds": {"figures": 0, "network": 0},  # which points of a dense cloud are drawn; the
        # first weights of a network; the rest has no chance
        "seconds": round(result.seconds, 1),
        "checks": [
            {"subject": one.subject, "wanted": one.wanted, "got": one.got, "passed": one.passed}
            for one in result.checks
        ],
    }


def read_all(study: Study, model: Model) -> tuple[tuple[Recording, ...], tuple[Recording, ...]]:
    """Read all recordings of a study; the unseen ones must be unseen.

    Raises:
        InputError: recordings that cannot be read, or that are both: all problems at once.
    """
    problems: list[Problem] = []
    read: dict[Source, Recording] = {}
    table = table_of_known(study.known, model)
    grouped = read_groups(study.groups) if study.groups else None
    for source in (*study.train, *study.holdout):
        try:
            path = source.file or fetch(*source.data.split("/", 1))
            known = dict(source.parameters) if table is None else table.of(path)
            read[source] = read_recording(
                path,
                model,
                study.columns_of(source),
                span=source.span,
                parameters=known,
                groups=dict(source.groups) if grouped is None else grouped.of(path),
            )
        except InputError as error:
            problems.extend(error.problems)
    if problems:
        raise InputError(dict.fromkeys(problems))
    train = tuple(read[source] for source in study.train)
    holdout = tuple(read[source] for source in study.holdout)
    require_known(model, (*train, *holdout), tuple(study.own))
    require_groups(train, holdout, study.own)
    require_unseen(train, holdout)
    if study.noise is not None:
        train = noisier(train, study.noise.level, study.noise.seed)
    return train, holdout


def _runs(result: StudyResult) -> Iterator[tuple[str, Recording, Source]]:
    """Role, recording and where it came from, of everything that was read."""
    for role, recordings, sources in (
        ("train", result.train, result.study.train),
        ("holdout", result.holdout, result.study.holdout),
    ):
        for recording, source in zip(recordings, sources, strict=True):
            yield role, recording, source


def _provenance(result: StudyResult) -> dict[str, str]:
    """Say in the report what it was made from."""
    said = {"model": f"{result.study.model.name}, SHA-256 {sha256_of(result.study.model)}"}
    for number, (role, recording, _) in enumerate(_runs(result), 1):
        kind = "training" if role == "train" else "unseen"
        said[f"recording {number} ({kind})"] = f"{recording.name}, SHA-256 {recording.sha256}"
    said["versions"] = ", ".join(f"{name} {version}" for name, version in versions().items())
    return said

"""The verb ``learn`` from files to files: recordings read, a correction learned and left behind."""

import json
import os
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.learning import Learned, learn
from symhyb.model.diff import diff
from symhyb.model.read import read_model
from symhyb.model.write import write_model
from symhyb.report.files import write_diagnosis, write_simulation
from symhyb.report.learned import learned_json, render_learned
from symhyb.report.learned_document import LearnedDocument
from symhyb.steps import Say, silent
from symhyb.study.file import Study
from symhyb.study.provenance import sha256_of, table_hashes, versions
from symhyb.study.run import StudyResult, carry_out, read_all
from symhyb.writing import staged


@dataclass(frozen=True, slots=True)
class Order:
    """What to learn: the ``study`` states model and recordings, ``options`` are those of
    :func:`symhyb.learning.learn` by name, ``beside`` asks for a diagnosis, too."""

    study: Study
    options: Mapping[str, Any] = field(default_factory=dict)
    beside: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What came of an order, with the diagnosis ``beside`` it, in ``seconds``."""

    order: Order
    learned: Learned
    beside: StudyResult | None
    recordings: tuple[tuple[str, str, str], ...]
    seconds: float

    @property
    def diagnosed(self) -> tuple[Diagnosis, Verdict] | None:
        """The diagnosis and its verdict, if one was asked for."""
        return None if self.beside is None else (self.beside.diagnosis, self.beside.verdict)

    def content(self) -> LearnedDocument:
        """What ``learned.json`` holds."""
        return learned_json(self.learned, _manifest(self), self.diagnosed)


def carry_out_order(order: Order, say: Say | None = None) -> Outcome:
    """Read, learn, and diagnose beside it where asked; writes nothing.

    Raises:
        InputError: the model, a recording or an option is wrong.
        NumericsError: the numerics failed.
    """
    tell = say or silent
    begin = time.perf_counter()
    tell("reading the model and the recordings")
    model = read_model(order.study.model)
    train, holdout = read_all(order.study, model)
    learned = learn(model, train, holdout, say=tell, **order.options)
    beside = None
    if order.beside:
        tell("diagnosing beside it")
        beside = carry_out(order.study, tell)
    recordings = tuple(
        (role, one.name, one.sha256)
        for role, group in (("train", train), ("holdout", holdout))
        for one in group
    )
    return Outcome(order, learned, beside, recordings, time.perf_counter() - begin)


def leave_learned(outcome: Outcome, directory: str | os.PathLike[str]) -> None:
    """Write ``corrected.toml`` with its weights (unless no model file can hold what was learned),
    ``learned.json``, ``simulation.csv`` and ``report.html``; with a diagnosis beside it also
    ``diagnosed.toml`` and ``diagnosis.json``: all of them or none.

    Raises:
        InputError: the files cannot be written.
        NumericsError: a number that came out is not finite.
    """
    learned, name = outcome.learned, outcome.order.study.model.name
    with staged(directory) as part:
        text = json.dumps(outcome.content(), indent=2, ensure_ascii=False, allow_nan=False)
        _write(part / "learned.json", text + "\n")
        write_simulation(part / "simulation.csv", learned.verdict.traces, learned.model)
        difference = ""
        if learned.corrected is not None:
            write_model(learned.corrected, part / "corrected.toml")
            difference = diff(
                replace(learned.model, file=name),
                replace(learned.corrected, file="corrected.toml"),
            )
        title = learned.model.title
        page = render_learned(title, learned, difference, _made_from(outcome), outcome.diagnosed)
        _write(part / "report.html", page)
        if outcome.beside is not None:
            write_model(outcome.beside.corrected, part / "diagnosed.toml")
            write_diagnosis(
                part / "diagnosis.json", outcome.beside.diagnosis, outcome.beside.verdict
            )


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="")


def _manifest(outcome: Outcome) -> dict[str, Any]:
    """What it was made from: hashes, versions, seeds and duration, but no paths."""
    model = outcome.order.study.model
    settings = dict(outcome.learned.settings)
    return {
        "model": {"file": model.name, "sha256": sha256_of(model)},
        **table_hashes(outcome.learned.model),
        "recordings": [
            {"role": role, "file": name, "sha256": digest}
            for role, name, digest in outcome.recordings
        ],
        "map": dict(outcome.order.study.columns or {}),
        "versions": versions(),
        "seeds": {"network": settings["seed"]} if "seed" in settings else {},
        "seconds": round(outcome.seconds, 1),
    }


def _made_from(outcome: Outcome) -> dict[str, str]:
    model = outcome.order.study.model
    said = {"model": f"{model.name}, SHA-256 {sha256_of(model)}"}
    for number, (role, name, digest) in enumerate(outcome.recordings, 1):
        kind = "training" if role == "train" else "unseen"
        said[f"recording {number} ({kind})"] = f"{name}, SHA-256 {digest}"
    said["versions"] = ", ".join(f"{name} {version}" for name, version in versions().items())
    return said

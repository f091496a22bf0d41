"""The key of a task: a hash of all that decides what comes out of it."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from symhyb import __version__
from symhyb.data.datasets import fetch
from symhyb.data.files.bag_file import files_of_bag
from symhyb.data.files.formats import files_of
from symhyb.errors import InputError, Problem
from symhyb.model.types import Model
from symhyb.model.write import text_of
from symhyb.study.file import Study
from symhyb.study.provenance import table_hashes
from symhyb.study.sources import Source

FORMAT = 1
"""Of what is hashed."""


class Digests:
    """The SHA-256 of files, each read once, and the texts of models, each written once."""

    def __init__(self) -> None:
        self._known: dict[Path, str] = {}
        self._texts: dict[Path, str] = {}

    def text(self, path: Path, model: Model) -> str:
        """The text of a model of this file."""
        if path not in self._texts:
            self._texts[path] = text_of(model)
        return self._texts[path]

    def of(self, path: Path) -> str:
        """The digest of a file, or of the files of a folder.

        Raises:
            InputError: it cannot be read.
        """
        if path not in self._known:
            try:
                self._known[path] = _digest(path)
            except OSError as error:
                text = f"cannot be read: {error.strerror or error}"
                raise InputError(Problem(text, file=str(path))) from None
        return self._known[path]


def key_of(study: Study, model: Model, digests: Digests) -> str:
    """The SHA-256 of what goes into a study without a sweep: the content of its ``model`` and of
    its recordings, how these are read, its options, and the version of symhyb. Neither the folders
    of files nor titles are part of it.

    Raises:
        InputError: a file cannot be read.
    """
    engine = model.engine
    content: dict[str, Any] = {
        "format": FORMAT,
        "symhyb": __version__,
        "model": digests.text(study.model, model),
        "tables": table_hashes(model),
        "engine": None if engine is None else digests.of(engine.path(model.file)),
        "train": _recordings(study, study.train, digests),
        "holdout": _recordings(study, study.holdout, digests),
        "own": dict(study.own),
        "finish": [study.last_values, study.remainder, study.network],
        "score": [study.window_s, study.force_band_hz],
        "budget": study.budget_s,
        "values": dict(study.values),
        "noise": None if study.noise is None else asdict(study.noise),
    }
    if study.fit is not None:
        content["fit"] = list(study.fit)
    if study.structures:
        content["structures"] = [asdict(one) for one in study.structures]
    text = json.dumps(content, sort_keys=True, ensure_ascii=True, allow_nan=False)
    return hashlib.sha256(text.encode("ascii")).hexdigest()


def _recordings(study: Study, sources: Sequence[Source], digests: Digests) -> list[Any]:
    found = []
    for source in sources:
        path = source.file or fetch(*source.data.split("/", 1))
        found.append(
            {
                "name": path.name,
                "sha256": [digests.of(file) for file in files_of(path)],
                "span": list(source.span),
                "map": dict(study.columns_of(source)),
                "parameters": dict(source.parameters),
                "groups": dict(source.groups),
            }
        )
    return found


def _digest(path: Path) -> str:
    inside = files_of_bag(path) if path.is_dir() else ()
    if inside:
        return hashlib.sha256("".join(map(_digest, inside)).encode()).hexdigest()
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()

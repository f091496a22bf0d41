"""Models as FMUs, and FMUs that misbehave."""

import zipfile
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from symhyb.export.build import shared_library
from symhyb.model.read import read_model
from symhyb.model.types import Model
from tests.scripts import scripts


def as_fmu(model: Model, folder: Path, fmi: int = 2, kinds: tuple[str, ...] = ("me",)) -> Model:
    """The model as an FMU in ``folder``, and the model file that names its variables."""
    for name, data in _made(model, fmi, kinds).items():
        (folder / name).write_bytes(data)
    return read_model(folder / "machine.toml")


@cache
def _made(model: Model, fmi: int, kinds: tuple[str, ...]) -> dict[str, bytes]:
    with scripts("fmu", ("as_fmu",)) as found, TemporaryDirectory() as folder:
        found["as_fmu"].as_fmu(model, Path(folder), fmi, kinds)
        return {file.name: file.read_bytes() for file in Path(folder).iterdir()}


def misbehaving(path: Path, where: str, what: str) -> None:
    """Let the FMU at ``path`` (FMI 2, with sources) do ``what``, a line of C, whenever the line
    ``where`` of its sources is reached."""
    source = "sources/machine.c"
    with zipfile.ZipFile(path) as packed:
        code = packed.read(source).decode()
    assert code.count(where) == 1
    code = code.replace(where, f"{where} {what}")
    _replace(path, {"binaries/linux64/machine.so": shared_library(code, "machine", "linux64")})


def redescribed(path: Path, change: Callable[[str], str]) -> None:
    """Change the description of the FMU at ``path``."""
    name = "modelDescription.xml"
    with zipfile.ZipFile(path) as packed:
        before = packed.read(name).decode()
    assert change(before) != before
    _replace(path, {name: change(before).encode()})


def _replace(path: Path, news: Mapping[str, bytes]) -> None:
    with zipfile.ZipFile(path) as packed:
        parts = {name: packed.read(name) for name in packed.namelist()}
    with zipfile.ZipFile(path, "w") as packed:
        for name, data in {**parts, **news}.items():
            packed.writestr(name, data)

"""Known public recordings by name, wherever they are.

Nothing of them is shipped. A file is looked for in the folder that ``SYMHYB_DATA`` names, then in
the cache of the user, then fetched from its public source; its SHA-256 must be the one that
:mod:`symhyb.data.catalogue` states.
"""

import hashlib
import os
import sys
from functools import partial
from pathlib import Path

from symhyb.data.catalogue import DATASETS, DataFile, Dataset, named, unknown
from symhyb.data.files.table import PART
from symhyb.errors import InputError, Problem, did_you_mean

FOLDER = "SYMHYB_DATA"


def fetch(dataset: str | Dataset, file: str | None = None, *, progress: bool = False) -> Path:
    """Return the path of a file of a known recording, fetching it if it is nowhere here.

    ``file`` may be left out if the recording has only one, and may name a part, which is then at
    the end of the path as well (``Ball_drops_data.xls#Golf Ball#2``). With ``progress`` the
    percentage is written to the standard error.

    Raises:
        InputError: an unknown name, a file with another SHA-256, or no network.
    """
    known = _dataset(dataset)
    if file is not None and PART in file:
        name, _, part = file.partition(PART)
        whole = fetch(known, name, progress=progress)
        return whole.with_name(f"{whole.name}{PART}{part}")
    wanted = _file(known, file)
    here = _provided(known, wanted)
    if here is not None:
        wrong = _difference(here, wanted)
        if wrong:
            cure = f"remove it, and it is fetched from {wanted.address}"
            raise InputError(Problem(f"is not the known file: {wrong}; {cure}", file=str(here)))
        return here
    return _retrieve(known, wanted, progress)


def listing() -> str:
    """Return what is known, a paragraph a recording, and which files are already here."""
    return "\n\n".join(_paragraph(dataset) for dataset in DATASETS)


def _dataset(dataset: str | Dataset) -> Dataset:
    if isinstance(dataset, Dataset):
        return dataset
    known = named(dataset)
    if known is None:
        raise InputError(Problem(unknown(dataset)))
    return known


def _file(dataset: Dataset, name: str | None) -> DataFile:
    if name is None and len(dataset.files) == 1:
        return dataset.files[0]
    for file in dataset.files:
        if file.name == name:
            return file
    names = [file.name for file in dataset.files]
    if name is None:
        raise InputError(Problem(f"{dataset.name} has several files; name one: {', '.join(names)}"))
    raise InputError(Problem(f"{dataset.name} has no file '{name}'{did_you_mean(name, names)}"))


def _provided(dataset: Dataset, file: DataFile) -> Path | None:
    """Return the file in the folder that SYMHYB_DATA names, None if it is not there."""
    root = os.environ.get(FOLDER)
    path = Path(root or ".") / dataset.folder / file.name
    return path if root and path.is_file() else None


def _difference(path: Path, file: DataFile) -> str:
    """Say how a file differs from the known one; empty if it is the same.

    Raises:
        InputError: it cannot be read.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(Problem(f"cannot be read: {error.strerror}", file=str(path))) from error
    found = hashlib.sha256(content).hexdigest()
    if found == file.sha256:
        return ""
    if len(content) < file.size:
        return f"it holds {len(content)} of {file.size} bytes, so it seems to be cut off"
    return f"its SHA-256 is {found}, not {file.sha256}"


def _cache(dataset: Dataset) -> Path:
    import pooch

    return Path(pooch.os_cache("symhyb")) / dataset.folder


def _retrieve(dataset: Dataset, file: DataFile, progress: bool) -> Path:
    """Return the file in the cache, fetching it if need be."""
    import pooch

    pooch.get_logger().setLevel("WARNING")  # it would announce every file on the standard error
    cache = _cache(dataset)
    try:
        path = pooch.retrieve(
            file.address,
            known_hash=f"sha256:{file.sha256}",
            fname=file.name,
            path=cache,
            downloader=partial(_download, progress=progress),
        )
    except ValueError as error:  # pooch found another hash, and deleted what it had fetched
        text = f"what {file.address} holds is not the known file (SHA-256 {file.sha256}): refused"
        raise InputError(Problem(text)) from error
    except OSError as error:
        there = (cache / file.name).is_file()  # and with another hash, or it would have been taken
        missing = f"in {cache} is damaged" if there else "is not on this computer"
        text = (
            f"{dataset.folder}/{file.name} {missing} and cannot be fetched"
            f" ({type(error).__name__}); get it from {file.address} and put it into"
            f" {_places(dataset)}"
        )
        raise InputError(Problem(text)) from error
    return Path(path)


def _places(dataset: Dataset) -> str:
    """Say where a file of a recording is looked for."""
    root = os.environ.get(FOLDER)
    if root:
        return f"{Path(root) / dataset.folder} ({FOLDER} is {root}) or {_cache(dataset)}"
    return f"{_cache(dataset)}, or into {dataset.folder} of a folder that {FOLDER} names"


def _download(address: str, target: str, _pooch: object, *, progress: bool) -> None:
    """Write what ``address`` holds to the path ``target``; pooch calls this and checks the hash.

    Unlike pooch's own downloader it closes the connection when the server refuses, and shows the
    percentage without a further library.
    """
    import requests

    name, done = address.rpartition("/")[2], 0
    with requests.get(address, stream=True, timeout=30) as response, open(target, "wb") as file:
        response.raise_for_status()
        total = int(response.headers.get("content-length", 0))
        for chunk in response.iter_content(chunk_size=1 << 16):
            done += file.write(chunk)
            if progress and total:
                share = min(100, 100 * done // total)  # a compressed reply states fewer bytes
                print(f"\r{name} {share:3d} %", end="", file=sys.stderr, flush=True)
    if progress:
        print(file=sys.stderr)


def _paragraph(dataset: Dataset) -> str:
    lines = [f"{dataset.name}: {dataset.title}", f"  {dataset.about}"]
    lines += [f"  {_line(dataset, file)}" for file in dataset.files]
    lines += [f"  licence: {dataset.licence}", f"  cite: {dataset.citation}"]
    return "\n".join(lines)


def _line(dataset: Dataset, file: DataFile) -> str:
    state, kept = "not here yet", _cache(dataset) / file.name
    here = _provided(dataset, file)
    if here or kept.is_file():
        state = f"in {FOLDER}" if here else "in the cache"
        held = (here or kept).stat().st_size
        if held != file.size:  # reading all files for their hashes would make a list slow
            state += f", but not the known file: {held} bytes instead of {file.size}"
    size = f"{file.size / 1e6:.1f} MB" if file.size > 1e5 else f"{file.size / 1e3:.1f} kB"
    return f"{file.name} ({size}, {state})"

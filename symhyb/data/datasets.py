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

from symhyb.data.catalogue import DATASETS, DataFile, Dataset
from symhyb.data.table import PART
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
        found = hashlib.sha256(here.read_bytes()).hexdigest()
        if found != wanted.sha256:
            text = f"is not the known file: its SHA-256 is {found}, not {wanted.sha256}"
            raise InputError(Problem(text, file=str(here)))
        return here
    return _retrieve(known, wanted, progress)


def listing() -> str:
    """Return what is known, a paragraph a recording, and which files are already here."""
    return "\n\n".join(_paragraph(dataset) for dataset in DATASETS)


def _dataset(dataset: str | Dataset) -> Dataset:
    if isinstance(dataset, Dataset):
        return dataset
    for known in DATASETS:
        if known.name == dataset:
            return known
    hint = did_you_mean(dataset, [known.name for known in DATASETS])
    raise InputError(Problem(f"no recording is known by the name '{dataset}'{hint}"))


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
        text = (
            f"{dataset.folder}/{file.name} is not on this computer and cannot be fetched"
            f" ({type(error).__name__}); get it from {file.address} and put it into {cache}, or"
            f" into {dataset.folder} of a folder that {FOLDER} names"
        )
        raise InputError(Problem(text)) from error
    return Path(path)


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
    lines += [f"  licence: {dataset.licence}", f"  {dataset.citation}"]
    return "\n".join(lines)


def _line(dataset: Dataset, file: DataFile) -> str:
    state = "not here yet"
    if _provided(dataset, file):
        state = f"in {FOLDER}"
    elif (_cache(dataset) / file.name).is_file():
        state = "in the cache"
    size = f"{file.size / 1e6:.1f} MB" if file.size > 1e5 else f"{file.size / 1e3:.1f} kB"
    return f"{file.name} ({size}, {state})"

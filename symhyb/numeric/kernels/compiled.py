"""C code as machine code where a C compiler is found, kept in a cache.

Code is compiled once and kept in the user's cache folder under the hash of the code, the compiler,
its flags and the processor, with a digest of the result beside it, so that a damaged file is never
loaded and none is taken for another. ``SYMHYB_CC`` names another compiler; set to nothing, it
switches compilation off.
"""

import ctypes
import hashlib
import os
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import lru_cache
from pathlib import Path
from stat import S_ISDIR

FILES_MOST = 300  # kept in a cache folder
LOCK = "lock"
# Special values occur, and products and sums are not fused: what cancels by one way to evaluate a
# function cancels by all others. Without the last one GCC leaves the upper halves of vector
# registers in use at -O1, and each call of exp or pow then takes ten times as long.
FLAGS = (
    "-fno-math-errno",
    "-fno-trapping-math",
    "-ffp-contract=off",
    "-fexpensive-optimizations",
)

LOADING = threading.Lock()
"""Held while a library is loaded, and while those that are loaded are listed. Both lock the list
of the operating system, which calls Python for each library that it lists: a thread that waits for
that list and lets no other thread run Python would wait for ever."""


@lru_cache(maxsize=1)
def find_compiler() -> tuple[str, str] | None:
    """Path and version of the C compiler, None if there is none."""
    wanted = os.environ.get("SYMHYB_CC")
    names = ("cc", "gcc", "clang") if wanted is None else (wanted,)
    path = next((found for name in names if name and (found := shutil.which(name))), None)
    if path is None:
        return None
    try:
        answer = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
    except OSError:
        return None
    return (path, answer.stdout) if answer.returncode == 0 else None


@lru_cache(maxsize=1)
def processor() -> str:
    """What *native* means on this machine; empty where it cannot be known."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    traits = [
        line for line in lines if line.startswith(("model name", "flags", "Features", "CPU "))
    ]
    return hashlib.sha256("\n".join(sorted(set(traits))).encode()).hexdigest() if traits else ""


def library_of(code: str, level: str = "-O2") -> ctypes.CDLL | None:
    """The compiled ``code``, loaded; None where that is impossible. ``level`` is how far to
    optimise."""
    file = file_of(code, level)
    return None if file is None else loaded(file)


def loaded(file: Path) -> ctypes.CDLL | None:
    """A compiled file as a library of this process; None where nothing may be run from there."""
    try:
        with LOADING:
            return ctypes.CDLL(str(file))
    except OSError:
        return None


def file_of(code: str, level: str = "-O2", ready: bool = False) -> Path | None:
    """The file with the compiled ``code``: from the cache, compiled first if need be unless only
    what is ``ready`` is wanted; None where that is impossible."""
    compiler, folder = find_compiler(), cache_folder("compiled")
    if compiler is None or folder is None:
        return None
    about = processor()
    flags = (level, *FLAGS, "-march=native") if about else (level, *FLAGS)
    what = "\0".join((code, compiler[1], *flags, about))
    library = folder / f"{hashlib.sha256(what.encode()).hexdigest()}.so"
    try:
        there = _intact(library) or (not ready and _built(library, code, compiler[0], flags))
    except OSError:  # a full disk, or a folder that went away
        return None
    return library if there else None


def _built(library: Path, code: str, compiler: str, flags: Sequence[str]) -> bool:
    """Build the library, unless another process does: then wait for that one."""
    with _alone(library):
        return _intact(library) or _build(library, code, compiler, flags)


@contextmanager
def _alone(library: Path) -> Iterator[None]:
    """Held by one process at a time for each library, and let go when it ends, however that is. It
    only saves work, for files are replaced in one go: where there are no such locks, as on
    Windows, two processes build the same."""
    try:
        import fcntl
    except ImportError:
        yield
        return
    byte = int(library.stem[:7], 16)  # one file for all libraries, of which each has a byte
    with open(library.with_name(LOCK), "a", encoding="ascii") as stream:
        with suppress(OSError):  # a file system without locks
            fcntl.lockf(stream, fcntl.LOCK_EX, 1, byte)
        yield


def _build(library: Path, code: str, compiler: str, flags: Sequence[str]) -> bool:
    with tempfile.TemporaryDirectory(dir=library.parent) as work:
        source, built = Path(work) / "code.c", Path(work) / "code.so"
        source.write_text(code, encoding="utf-8")
        command = [compiler, *flags, "-fPIC", "-shared", str(source), "-o", str(built), "-lm"]
        if subprocess.run(command, capture_output=True, check=False).returncode != 0:
            return False
        digest = Path(work) / "digest"
        digest.write_text(hashlib.sha256(built.read_bytes()).hexdigest(), encoding="ascii")
        # Two programs may build at once: each file is replaced in one go, and a digest of the
        # other's library only means that it is built again.
        built.replace(library)
        digest.replace(library.with_suffix(".sum"))
    forget(library.parent, "*.so")
    return True


def _intact(library: Path) -> bool:
    """Whether the library is there and is what was built; loading half a file ends the process. A
    link is none: where it leads to, others may write."""
    try:
        if library.is_symlink():
            return False
        digest = library.with_suffix(".sum").read_text(encoding="ascii")
        return hashlib.sha256(library.read_bytes()).hexdigest() == digest
    except (OSError, UnicodeDecodeError):
        return False


@lru_cache(maxsize=8)
def cache_folder(kind: str) -> Path | None:
    """The folder ``kind`` of the user's cache, which only this user may write to, or None."""
    from platformdirs import user_cache_path

    folder = user_cache_path("symhyb") / kind
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        return folder if _private(folder) and os.access(folder, os.W_OK) else None
    except OSError:
        return None


def _private(folder: Path) -> bool:
    """Whether this is a folder, and no link to one, into which nobody else can put files that would
    be run as this user."""
    if not hasattr(os, "getuid"):
        return not folder.is_symlink()
    state = folder.lstat()
    return S_ISDIR(state.st_mode) and state.st_uid == os.getuid() and state.st_mode & 0o022 == 0


def forget(folder: Path, pattern: str, most: int = FILES_MOST) -> None:
    """Keep the newest ``most`` files of this pattern, and what belongs to them."""
    dated = []
    for file in folder.glob(pattern):
        try:
            dated.append((file.stat().st_mtime, file))
        except OSError:  # another program was quicker
            continue
    for _, file in sorted(dated, reverse=True)[most:]:
        for one in (file, file.with_suffix(".sum")):
            one.unlink(missing_ok=True)

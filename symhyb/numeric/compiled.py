"""CasADi functions as machine code, where a C compiler is found; without one they stay as they are.

The generated C is compiled once and cached in the user's cache folder under the hash of the code,
the compiler and its flags, so a damaged or foreign file is never taken for another function.
``SYMHYB_CC`` names another compiler; set to nothing, it switches compilation off.
"""

import hashlib
import os
import shutil
import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path

import casadi as ca

FLAGS = ("-O1", "-fPIC", "-shared")
INSTRUCTIONS_LEAST = 2500  # below, the virtual machine is quick enough
INSTRUCTIONS_MOST = 60_000  # above, compiling takes longer than it saves
FILES_MOST = 300  # kept in the cache


def compiled(functions: dict[str, ca.Function]) -> dict[str, ca.Function]:
    """The same functions, compiled together; unchanged where that is impossible or not worth it."""
    sizes = [function.n_instructions() for function in functions.values()]
    compiler = _compiler()
    if compiler is None or not INSTRUCTIONS_LEAST <= max(sizes) <= INSTRUCTIONS_MOST:
        return functions
    generator = ca.CodeGenerator("symhyb.c")
    for function in functions.values():
        generator.add(function)
    code = generator.dump()
    library = _library(code, *compiler)
    if library is None:
        return functions
    return {
        name: ca.external(function.name(), str(library)) for name, function in functions.items()
    }


@lru_cache(maxsize=1)
def _compiler() -> tuple[str, str] | None:
    """Path and version of the C compiler, None if there is none."""
    wanted = os.environ.get("SYMHYB_CC")
    names = ("cc", "gcc", "clang") if wanted is None else (wanted,)
    path = next((found for name in names if name and (found := shutil.which(name))), None)
    if path is None:
        return None
    answer = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
    return (path, answer.stdout) if answer.returncode == 0 else None


def _library(code: str, compiler: str, version: str) -> Path | None:
    """The compiled code from the cache, compiled first if need be; None if that fails."""
    key = hashlib.sha256("\0".join((code, version, *FLAGS)).encode()).hexdigest()
    folder = _folder()
    if folder is None:
        return None
    library = folder / f"{key}.so"
    if library.exists():
        return library
    with tempfile.TemporaryDirectory(dir=folder) as work:
        source, built = Path(work) / "code.c", Path(work) / "code.so"
        source.write_text(code, encoding="utf-8")
        command = [compiler, *FLAGS, str(source), "-o", str(built), "-lm"]
        done = subprocess.run(command, capture_output=True, check=False)
        if done.returncode != 0:
            return None
        built.replace(library)
    _forget(folder)
    return library


@lru_cache(maxsize=1)
def _folder() -> Path | None:
    """A cache folder that only this user can write to, None if there is none."""
    from platformdirs import user_cache_path

    folder = user_cache_path("symhyb") / "compiled"
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        owned = not hasattr(os, "getuid") or folder.stat().st_uid == os.getuid()
        return folder if owned and os.access(folder, os.W_OK) else None
    except OSError:
        return None


def _forget(folder: Path) -> None:
    """Keep the newest files only."""
    files = sorted(folder.glob("*.so"), key=lambda file: file.stat().st_mtime, reverse=True)
    for file in files[FILES_MOST:]:
        file.unlink(missing_ok=True)

"""C made into shared libraries for the platforms of FMI, by the compilers that are there.

Looked for, in this order: the C compiler of the system (``SYMHYB_CC`` names another), mingw-w64 for
Windows, and the ``ziglang`` package, which compiles for both (extra ``zig``).
"""

import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from symhyb.errors import InputError, Problem
from symhyb.numeric.kernels.compiled import find_compiler

LARGE = 300_000  # bytes of C, from which on the compiler optimises less, or it takes minutes
# contract: no multiplication fused with an addition, so that results are those of symhyb bit by bit
FLAGS = (
    "-std=c99",
    "-ffp-contract=off",
    "-fvisibility=hidden",
    "-DDISABLE_PREFIX",
    "-shared",
    "-s",
)


@dataclass(frozen=True, slots=True)
class Platform:
    """A platform as FMI 2 names it, FMI 3 names it, and zig names it."""

    fmi2: str
    fmi3: str
    zig: str
    suffix: str
    flags: tuple[str, ...]


PLATFORMS: Mapping[str, Platform] = {
    "linux64": Platform(
        "linux64", "x86_64-linux", "x86_64-linux-gnu.2.17", ".so", ("-fPIC", "-Wl,--build-id=none")
    ),
    # Windows libraries carry the time of linking unless the linker is told otherwise
    "win64": Platform(
        "win64",
        "x86_64-windows",
        "x86_64-windows-gnu",
        ".dll",
        ("-static-libgcc", "-Wl,--no-insert-timestamp"),
    ),
}


def headers() -> Path:
    """The folder with the header files of FMI, which the ``fmpy`` package brings.

    Raises:
        InputError: fmpy is not installed.
    """
    if find_spec("fmpy") is None:
        text = "an FMU needs the header files of FMI, which fmpy brings: pip install 'symhyb[fmi]'"
        raise InputError(Problem(text))
    return Path(str(files("fmpy") / "c-code"))


def available() -> tuple[str, ...]:
    """The platforms that can be compiled for here."""
    return tuple(name for name in PLATFORMS if _command(name))


def require_platforms(wanted: Sequence[str]) -> tuple[str, ...]:
    """``wanted`` platforms, or all that can be compiled for here.

    Raises:
        InputError: a platform that is not known, or no compiler for one.
    """
    unknown = [name for name in wanted if name not in PLATFORMS]
    if unknown:
        known = ", ".join(PLATFORMS)
        raise InputError([Problem(f"'{name}' is no platform; known: {known}") for name in unknown])
    there = available()
    missing = [name for name in wanted if name not in there]
    if missing or not (wanted or there):
        text = (
            f"no C compiler for {' and '.join(missing or PLATFORMS)} is here; install gcc (Linux) "
            "or gcc-mingw-w64-x86-64 (for Windows), or both at once: pip install 'symhyb[zig]'; C "
            "sources need none: --to c"
        )
        raise InputError(Problem(text))
    return tuple(wanted) or there


def shared_library(code: str, name: str, target: str) -> bytes:
    """The library of ``code`` for a platform, as bytes; ``name`` is that of the C file.

    Raises:
        InputError: the compiler refuses, with the first line of what it says.
    """
    chosen, command = PLATFORMS[target], _command(target)
    if command is None:
        require_platforms([target])
        raise InputError(Problem(f"no C compiler for {target} is here"))
    level = "-O1" if len(code) > LARGE else "-O2"
    with tempfile.TemporaryDirectory(prefix="symhyb-") as work:
        Path(work, f"{name}.c").write_text(code, encoding="utf-8")
        library = Path(work, f"{name}{chosen.suffix}")
        done = subprocess.run(
            [
                *command,
                level,
                *FLAGS,
                *chosen.flags,
                f"-I{headers()}",
                f"{name}.c",
                "-o",
                library.name,
                "-lm",
            ],
            cwd=work,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode != 0 or not library.exists():
            said = next((line for line in done.stderr.splitlines() if "error" in line), "no reason")
            text = f"the C compiler for {target} ({command[0]}) failed: {said.strip()}"
            raise InputError(Problem(text))
        return library.read_bytes()


def _command(target: str) -> tuple[str, ...] | None:
    """What compiles for a platform."""
    machine = platform.machine().lower() in ("x86_64", "amd64")
    if target == "linux64" and sys.platform == "linux" and machine:
        compiler = find_compiler()
        if compiler is not None:
            return (compiler[0],)
    if target == "win64":
        mingw = shutil.which("x86_64-w64-mingw32-gcc")
        if mingw is not None:
            return (mingw,)
    if find_spec("ziglang") is not None:
        return (sys.executable, "-m", "ziglang", "cc", "-target", PLATFORMS[target].zig)
    return None

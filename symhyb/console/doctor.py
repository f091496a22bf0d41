"""Whether this installation works, and what it lacks: versions, compiler, extras, cache, a run."""

import ctypes
import os
import platform
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import metadata, util
from pathlib import Path
from typing import Any

from symhyb import __version__
from symhyb.discrepancy.words.amounts import number_text
from symhyb.errors import visible

LIBRARIES = (
    *("casadi", "jinja2", "joblib", "matplotlib", "numba", "numpy", "pandas", "pint", "pysindy"),
    *("rich", "scikit-learn", "scipy", "sympy", "typer"),
)
EXTRAS: dict[str, tuple[str, tuple[str, ...]]] = {
    "mat73": ("MAT files of version 7.3", ("h5py",)),
    "parquet": ("Parquet files", ("pyarrow",)),
    "excel": ("Excel files", ("openpyxl", "xlrd")),
    "mdf": ("MDF files", ("asammdf",)),
    "rosbag": ("bags of ROS", ("rosbags",)),
    "ulog": ("ULog files of PX4", ("pyulog",)),
    "tdms": ("TDMS files", ("nptdms",)),
    "fmi": ("FMUs of corrections and models", ("fmpy",)),
    "urdf": ("models from URDF files", ("defusedxml",)),
    "mjcf": ("models from MJCF files", ("defusedxml", "mujoco")),
    "xarray": ("recordings from and to xarray", ("xarray",)),
    "dask": ("sweeps of studies on a cluster", ("distributed",)),
    "arviz": ("the posterior for ArviZ", ("arviz_base",)),
    "docs": ("this documentation as a site", ("sphinx", "myst_parser", "furo")),
    "zig": ("FMUs for other systems than this one", ("ziglang",)),
}
"""What an extra is for, and the modules that it brings."""

SWITCH = "SYMHYB_CC"
SLOWER = "diagnoses take several times as long, and no FMU can be built"


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at: ``good`` True, False, or None where something is lacking that
    is not needed; ``cure`` says what to do about it."""

    name: str
    text: str
    good: bool | None = True
    cure: str = ""


def findings() -> Iterator[Finding]:
    """Look at one thing after the other; the last is a short run."""
    yield Finding("symhyb", f"{__version__}, Python {platform.python_version()}, {_system()}")
    yield _libraries()
    yield _compiler()
    yield from map(_extra, EXTRAS)
    yield _cache()
    yield Finding("processors", _processors())
    yield tried(self_test)


def doctor_facts(found: list[Finding]) -> dict[str, Any]:
    """Give what was found as plain values."""
    return {
        "ok": healthy(found),
        "findings": [
            {"name": one.name, "text": one.text, "good": one.good, "cure": one.cure or None}
            for one in found
        ],
    }


def healthy(found: list[Finding]) -> bool:
    """Whether nothing that is needed is broken."""
    return all(one.good is not False for one in found)


def print_finding(one: Finding) -> None:
    """Print one finding, and its cure below it."""
    mark = {True: "ok", False: "BROKEN", None: "-"}[one.good]
    print(f"  {mark:<6}  {one.name:<10}  {one.text}")
    if one.cure:
        print(f"{'':22}{one.cure}")


def tried(test: Callable[[], str]) -> Finding:
    """Whether a test passes, what it says, and how long it took."""
    began = time.perf_counter()
    try:
        said = test()
    except Exception as error:
        cause = visible(" ".join(str(error).split()))[:200]
        return Finding("self-test", f"failed: {type(error).__name__}: {cause}", False, REINSTALL)
    return Finding("self-test", f"{said} ({time.perf_counter() - began:.1f} s)")


REINSTALL = (
    "install symhyb anew into an environment of its own: pip install --force-reinstall symhyb"
)
TEST_MODEL = """symhyb = 1
[coordinates]
x = { unit = "m", start = 0.1 }
[parameters]
m = { value = 2.0, unit = "kg" }
k = { value = 60.0, unit = "N/m", sd = 20.0 }
[bodies.mass]
mass = "m"
at = ["x", "0"]
[elements.spring]
kind = "spring"
on = "x"
stiffness = "k"
[sensors]
place = { measures = "x", unit = "m", sd = 1e-4 }
"""
TEST_STIFFNESS, TEST_MASS, TEST_START = 50.0, 2.0, 0.1


def self_test() -> str:
    """Simulate a mass on a spring and fit the spring to x = x0 cos ωt, both known exactly.

    Raises:
        ArithmeticError: what comes out is wrong.
    """
    import numpy as np

    from symhyb.correction.calibration import calibrated
    from symhyb.data.recording import Recording
    from symhyb.model.read import parse_model
    from symhyb.simulation import run_model

    model = parse_model(TEST_MODEL)
    t = np.arange(0.0, 6.0, 0.01)
    run = run_model(model, None, float(t[-1]), 0.01)[2]
    omega = np.sqrt(60.0 / TEST_MASS)
    error = float(np.abs(run.q[:, 0] - TEST_START * np.cos(omega * run.t)).max()) / TEST_START
    if not error < 1e-5:
        raise ArithmeticError(f"a simulation is off by {error:.1e} of its motion")
    true = TEST_START * np.cos(np.sqrt(TEST_STIFFNESS / TEST_MASS) * t)
    noisy = true + 1e-4 * np.random.default_rng(0).standard_normal(t.size)
    found = calibrated(model, Recording("test", t, {}, {"place": noisy}, (), "")).parameters[0]
    if not abs(found.value - TEST_STIFFNESS) < max(5 * found.sd, 1e-3 * TEST_STIFFNESS):
        raise ArithmeticError(f"a stiffness of {TEST_STIFFNESS} N/m was fitted as {found.value}")
    back = number_text(found.value, found.sd)
    return f"a run is exact to {error:.0e}, a stiffness of 50 N/m comes back as {back}"


def _system() -> str:
    return f"{platform.system()} {platform.machine()}"


def _libraries() -> Finding:
    known = {name: _version(name) for name in LIBRARIES}
    missing = [name for name, version in known.items() if version is None]
    said = ", ".join(f"{name} {version}" for name, version in known.items() if version)
    if missing:
        return Finding("libraries", f"missing: {', '.join(missing)}", False, REINSTALL)
    return Finding("libraries", said)


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _compiler() -> Finding:
    """The C compiler, and whether what it makes can be loaded."""
    from symhyb.numeric.kernels.compiled import find_compiler

    compiler = find_compiler()
    if compiler is None:
        if os.environ.get(SWITCH) == "":
            text, cure = f"switched off by an empty {SWITCH}: {SLOWER}", f"unset {SWITCH}"
        elif SWITCH in os.environ:
            text = f"{SWITCH} names '{os.environ[SWITCH]}', which is none that runs: {SLOWER}"
            cure = f"unset {SWITCH}, or name a C compiler"
        else:
            text = f"none found (cc, gcc, clang): {SLOWER}"
            cure = f"install gcc or clang, or name one in {SWITCH}"
        return Finding("compiler", text, None, cure)
    path, version = compiler
    line = version.strip().splitlines()[0] if version.strip() else "of unknown version"
    if not _compiles(path):
        cure = "try it by hand on a small program, or name another in SYMHYB_CC"
        return Finding("compiler", f"{path} makes no library that loads: {SLOWER}", None, cure)
    return Finding("compiler", f"{path}: {line}")


def _compiles(compiler: str) -> bool:
    """Whether a small library can be compiled and loaded, and says what it should."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        source, library = Path(folder) / "twice.c", Path(folder) / "twice.so"
        source.write_text("double twice(double x) { return 2.0 * x; }\n", encoding="utf-8")
        command = [compiler, "-fPIC", "-shared", str(source), "-o", str(library)]
        try:
            subprocess.run(command, capture_output=True, check=True, timeout=60)
            twice = ctypes.CDLL(str(library)).twice
        except (OSError, AttributeError, subprocess.SubprocessError):
            return False
        twice.restype, twice.argtypes = ctypes.c_double, [ctypes.c_double]
        return bool(twice(21.0) == 42.0)


def _extra(name: str) -> Finding:
    purpose, modules = EXTRAS[name]
    missing = [module for module in modules if util.find_spec(module) is None]
    if not missing:
        return Finding(name, purpose)
    cure = f'pip install "symhyb[{name}]"'
    return Finding(name, f"not installed ({', '.join(missing)}): no {purpose}", None, cure)


def _cache() -> Finding:
    """Where lowered and compiled machines are kept, and how much that is."""
    from platformdirs import user_cache_path

    from symhyb.numeric.kernels.compiled import cache_folder

    home = Path(user_cache_path("symhyb"))
    if cache_folder("compiled") is None:
        cure = "make it a folder that belongs to you and that nobody else may write to"
        text = f"{home} may not be written to: all is lowered and compiled anew each time"
        return Finding("cache", text, None, cure)
    sizes = [_size(file) for file in home.rglob("*")]
    text = f"{home}: {len([s for s in sizes if s])} files, {sum(sizes) / 1e6:.1f} MB"
    return Finding("cache", f"{text}; it may be deleted at any time")


def _size(file: Path) -> int:
    try:
        return file.stat().st_size if file.is_file() else 0
    except OSError:
        return 0


def _processors() -> str:
    count = os.cpu_count() or 1
    mine = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else count
    return f"{mine}" if mine == count else f"{mine} of {count} may be used"

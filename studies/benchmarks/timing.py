"""How the benchmarks measure: contenders in turns, the median of their times, one row a bar."""

import gc
import os
import platform
import statistics
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

LIBRARIES = ("casadi", "numpy", "scipy", "sympy", "numba")


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table: ``value`` is the ratio that the sentence ``what`` names, ``bar`` what
    it has to reach (None: for information), ``least`` whether the bar is a lower one."""

    part: str
    what: str
    value: float
    bar: float | None = None
    least: bool = False
    unit: str = ""
    note: str = ""

    @property
    def met(self) -> bool | None:
        """Whether the bar is reached; None without one."""
        if self.bar is None:
            return None
        return self.value >= self.bar if self.least else self.value <= self.bar

    @property
    def verdict(self) -> str:
        """In words: met, or by how much it is missed."""
        if self.met is None or self.bar is None:
            return ""
        factor = self.bar / self.value if self.least else self.value / self.bar
        return "met" if self.met else f"missed by a factor of {factor:.2f}"

    @property
    def wanted(self) -> str:
        """The bar in words."""
        if self.bar is None:
            return ""
        return f"{'≥' if self.least else '≤'} {self.bar:.3g}{self.unit}"

    @property
    def measured(self) -> str:
        """The value in words."""
        return (
            f"{self.value:.0f}{self.unit}" if self.value >= 100 else f"{self.value:.3g}{self.unit}"
        )


Work = Callable[[], object]


def in_turns(
    contenders: Mapping[str, Work], repeats: int, before: Work = lambda: None
) -> dict[str, list[float]]:
    """Times in s of each contender, who run one after the other ``repeats`` times over, so that a
    neighbour's load hits all of them alike; ``before`` is done before each, beside the clock."""
    times: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(repeats):
        for name, work in contenders.items():
            before()
            gc.collect()  # nobody cleans up after another
            start = time.perf_counter()
            work()
            times[name].append(time.perf_counter() - start)
    return times


def middle(times: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """The median of each."""
    return {name: statistics.median(row) for name, row in times.items()}


def milliseconds(seconds: float) -> str:
    """A time as text, in the unit that suits it."""
    return f"{seconds:.3g} s" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"


def machine() -> dict[str, str]:
    """What the numbers were measured on, without names."""
    return {
        "processor": f"{_processor()}, {os.cpu_count()} cores",
        "system": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
        "compiler": _compiler(),
        **{name: _version(name) for name in LIBRARIES},
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown processor"
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def _compiler() -> str:
    try:
        done = subprocess.run(["cc", "--version"], capture_output=True, text=True, check=False)
    except OSError:
        return "none"
    return done.stdout.splitlines()[0] if done.returncode == 0 else "none"


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed"

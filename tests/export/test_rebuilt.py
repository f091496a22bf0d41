"""An FMU built anew: from its own sources, and for Windows."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmus import doubles, element, get, loaded, places, put, started, written

from symhyb.export.build import PLATFORMS, headers, shared_library
from symhyb.export.c_code import fmu_code, samples
from symhyb.export.pack import archive
from symhyb.export.spec import Spec


def differs(path: Path, spec: Spec, fmi: int, points: int) -> float:
    """The largest difference to symhyb over random points."""
    at, (t, x, u), worst = places(spec), samples(spec, points, seed=11), 0.0
    with loaded(path, fmi, "me") as instance:
        started(instance, fmi)
        for i in range(points):
            instance.setTime(t[i])
            put(instance, fmi, at.input, list(u[i]))
            instance.setContinuousStates(doubles(x[i]), x.shape[1])
            reported = np.concatenate(spec.exported.evaluate(t[i], x[i], u[i], spec.exported.p))
            worst = max(
                worst, float(np.abs(get(instance, fmi, at.rate + at.output) - reported).max())
            )
    return worst


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
def test_its_own_sources_make_it_again(fmi: int, tmp_path: Path) -> None:
    path = written(tmp_path, element(), fmi)
    with zipfile.ZipFile(path) as packed:
        files = {name: packed.read(name) for name in packed.namelist()}
    path.write_bytes(archive({k: v for k, v in files.items() if not k.startswith("binaries/")}))
    # FMPy compiles FMI 3 with the prefix that only code to be linked statically should have.
    flags = {"CFLAGS": "-DDISABLE_PREFIX -ffp-contract=off"}
    beside = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"  # cmake is there
    done = subprocess.run(
        [sys.executable, "-m", "fmpy", "compile", str(path)],
        cwd=tmp_path,
        env={**os.environ, **flags, "PATH": beside},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(path) as packed:
        assert any(name.startswith("binaries/") for name in packed.namelist())
    assert differs(path, element(), fmi, 500) <= 1e-13


@pytest.mark.windows
def test_the_library_for_windows_needs_nothing_but_windows_and_is_the_same_every_time() -> None:
    code = fmu_code(element(), 2, "{it}")
    first, second = (shared_library(code, "it", "win64") for _ in range(2))
    assert first == second
    assert PLATFORMS["win64"].suffix == ".dll"
    named = {part.split(b"\0")[0].lower() for part in first.split(b"\0") if b".dll" in part.lower()}
    foreign = {
        n for n in named if not n.startswith((b"kernel32", b"msvcrt", b"api-ms-win", b"it."))
    }
    assert not foreign


WINDOWS = r"""
#include <stdio.h>
#include <windows.h>
#include "fmi2Functions.h"
static void logger(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c,
                   fmi2String text, ...) { (void)e; (void)n; (void)s; (void)c; puts(text); }
int main(void) {
  HMODULE it = LoadLibraryA("it.dll");
  fmi2CallbackFunctions calls = {logger, 0, 0, 0, 0};
  fmi2InstantiateTYPE *make = (fmi2InstantiateTYPE *)GetProcAddress(it, "fmi2Instantiate");
  fmi2SetRealTYPE *set = (fmi2SetRealTYPE *)GetProcAddress(it, "fmi2SetReal");
  fmi2GetRealTYPE *get = (fmi2GetRealTYPE *)GetProcAddress(it, "fmi2GetReal");
  fmi2EnterInitializationModeTYPE *enter =
      (fmi2EnterInitializationModeTYPE *)GetProcAddress(it, "fmi2EnterInitializationMode");
  fmi2Component c = make("it", fmi2CoSimulation, "{it}", "", &calls, 0, 0);
  fmi2ValueReference u[2] = {1, 2}, y[1] = {3};
  double in[2], out;
  enter(c);
  while (scanf("%lf %lf", in, in + 1) == 2) {
    if (set(c, u, 2, in) || get(c, y, 1, &out)) return 1;
    printf("%.17g\n", out);
  }
  return 0;
}
"""


@pytest.mark.windows
def test_wine_computes_the_same_force(tmp_path: Path) -> None:
    """Other rounding of tanh on Windows: 1e-14 of the largest force."""
    spec = element()
    wine = shutil.which("wine64") or shutil.which("wine") or "/usr/lib/wine/wine64"
    (tmp_path / "it.dll").write_bytes(shared_library(fmu_code(spec, 2, "{it}"), "it", "win64"))
    (tmp_path / "driver.c").write_text(WINDOWS, encoding="utf-8")
    subprocess.run(
        ["x86_64-w64-mingw32-gcc", "driver.c", f"-I{headers()}", "-o", "driver.exe"],
        cwd=tmp_path,
        check=True,
    )
    t, _, u = samples(spec, 2000, seed=13)
    reported = "".join(f"{a:.17g} {b:.17g}\n" for a, b in u)
    run = subprocess.run(
        [wine, "driver.exe"],
        cwd=tmp_path,
        input=reported,
        capture_output=True,
        text=True,
        check=True,
    )
    made = np.array(run.stdout.split(), float)
    e = spec.exported
    exact = np.array(  # while it is initialised, the inner state rests at the given place
        [e.evaluate(0.0, u[i, :1], u[i], e.p)[1][0] for i in range(len(t))]
    )
    assert np.abs(made - exact).max() <= 1e-14 * np.abs(exact).max()

"""Plain C and Adams source compile without warnings and give what symhyb gives."""

import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fmus import element, machine, whole

from symhyb.errors import InputError
from symhyb.export.adams import adams_files
from symhyb.export.c_code import SAMPLES, c_files, samples
from symhyb.export.spec import Spec, spec_of

WARNINGS = ("-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter", "-pedantic", "-std=c99")

# What a user's own Adams would bring, so far as the source asks for it: a mass 3 mm off, 50 mm/s.
ADAMS = """
#include <stdio.h>
#include <stdlib.h>
struct sAdamsSforce { int ID; int NPAR; const double *PAR; };
typedef void adams_c_Sfosub(const struct sAdamsSforce *, double, int, int, double *);
static void c_sysfnc(const char *what, const int *markers, int n, double *value, int *failed) {
  *failed = n != 3 || markers[0] != 11 || markers[1] != 12;
  *value = what[0] == 'D' ? 3.0 : 50.0;
}
static void c_errmes(int failed, const char *text, int id, const char *stop) {
  if (failed) { puts(text); exit(1); }
}
"""
DRIVER = """
#include "law_adams.c"
int main(void) {
  double par[3] = {11, 12, 1}, value;
  struct sAdamsSforce force = {1, 3, par};
  Sfosub(&force, 0.0, 0, 0, &value);
  printf("%.17g\\n", value);
  return 0;
}
"""


def compiled(folder: Path, *sources: str, given: Path | None = None) -> str:
    """Compile and run with what is ``given`` as input; what the program prints."""
    done = subprocess.run(
        ["cc", *WARNINGS, "-ffp-contract=off", *sources, "-o", "program", "-lm"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    run = subprocess.run(
        ["./program"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        input=given.read_text(encoding="utf-8") if given else "",
    )
    return f"{run.returncode} {run.stdout}"


def put(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")


@pytest.mark.parametrize("made", [element, whole])
def test_the_program_that_comes_with_it_finds_no_difference(made, tmp_path: Path) -> None:
    spec: Spec = made()
    put(tmp_path, c_files(spec))
    reported = compiled(tmp_path, f"{spec.identifier}.c", f"{spec.identifier}_check.c")
    assert reported == f"0 {spec.identifier}: {SAMPLES} samples, largest relative difference 0\n"


def test_a_number_that_was_changed_is_found(tmp_path: Path) -> None:
    files = c_files(element())
    code = files["correction.c"]
    first = "const double correction_p[5] = {\n  "
    changed = code.replace(f"{first}0.5,", f"{first}0.6,")
    assert changed != code
    put(tmp_path, {**files, "correction.c": changed})
    assert compiled(tmp_path, "correction.c", "correction_check.c").startswith("1 ")


def test_the_header_says_names_units_and_sign() -> None:
    text = c_files(element())["correction.h"]
    for said in ("q.x [m]", "v.x [m/s]", "dF.x [N]", "p.b [N*s^2/m^2]", "a host adds +dF"):
        assert said in text
    assert "host adds" not in c_files(whole())["machine.h"]


def texts(count: int) -> list[str]:
    """Titles of strangers: what C could take for something else, among any letters of Unicode."""
    random = np.random.default_rng(7)
    parts = ["*", "/", "*/", "/*", "\\", "?", "??/", "\n", "\r", '"', "int evil;", "#if 0", "\x00"]
    found = [
        "a */ int evil; /* b \\",
        "x *\\ int evil; \\* ",
        '*??/\n/ __asm__(".incbin ??/"s??/""); /*',
    ]
    for _ in range(count):
        letters = [chr(int(c)) for c in random.integers(1, 0x2FFF, 4)]
        found.append("".join(random.choice([*parts, *letters], 12)))
    return found


def test_text_of_a_model_cannot_leave_its_comment() -> None:
    """A title or an about that a stranger wrote is not code: its comment has as many
    lines as it had and no backslashes or trigraphs, and the code behind it is the same."""
    base = element()
    plain, code = c_files(base)["correction.h"].split("*/", 1)
    for text in texts(300):
        odd = replace(
            base, title=text, variables=tuple(replace(v, about=text) for v in base.variables)
        )
        header = c_files(odd)["correction.h"]
        comment, rest = header.split("*/", 1)
        assert comment.startswith("/*")
        assert not any(bad in comment for bad in ("\\", "??"))
        assert len(comment.splitlines()) == len(plain.splitlines())
        assert rest == code


def test_code_with_the_text_of_a_stranger_compiles_to_the_same(tmp_path: Path) -> None:
    for i, text in enumerate(texts(5)):
        folder = tmp_path / str(i)
        folder.mkdir()
        put(folder, c_files(replace(element(), title=text)))
        reported = compiled(folder, "correction.c", "correction_check.c")
        assert "evil" not in reported
        assert b"evil" not in (folder / "program").read_bytes()


def test_adams_source_scales_and_keeps_the_sign(tmp_path: Path) -> None:
    spec = spec_of(machine(), "law", ("drag", "rub"))
    put(tmp_path, adams_files(spec) | {"slv_c_utils.h": ADAMS, "driver.c": DRIVER})
    reported = compiled(tmp_path, "law.c", "driver.c")
    e = spec.exported
    u = np.array([0.05])  # 50 mm/s
    assert float(reported.split()[1]) == e.evaluate(0.0, e.x, u, e.p)[1][0]
    assert e.evaluate(0.0, e.x, u, e.p)[1][0] < 0  # what resists acts against the motion


@pytest.mark.parametrize(("made", "text"), [(element, "inner state"), (whole, "whole model")])
def test_adams_source_refuses_what_it_cannot_hold(made, text: str) -> None:
    with pytest.raises(InputError, match=text):
        adams_files(made())


def test_samples_are_the_same_every_time() -> None:
    first, second = (samples(element(), 5) for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))

"""The C of an FMU under every check that a compiler has: all calls in turn, right and wrong."""

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from fmus import element, events_alone, events_whole, whole

from symhyb.export.build import headers
from symhyb.export.c_code import fmu_code
from symhyb.export.spec import Spec

HERE = Path(__file__).parent
MADE = (element, whole, events_alone, events_whole)


def checked(code: str, folder: Path, checks: str = "address,undefined") -> tuple[int, str]:
    """Compile a program with all checks and run it: what it returns and says. Memory that is not
    freed is an error, too."""
    (folder / "driver.c").write_text(code, encoding="utf-8")
    done = subprocess.run(
        [
            "cc",
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-Wno-unused-parameter",
            "-Werror",
            "-g",
            f"-fsanitize={checks}",
            "-fno-sanitize-recover",
            "-DDISABLE_PREFIX",
            f"-I{headers()}",
            "driver.c",
            "-o",
            "driver",
            "-lm",
            "-lpthread",
        ],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    run = subprocess.run(
        ["./driver"],
        cwd=folder,
        env={"ASAN_OPTIONS": "detect_leaks=1"},
        capture_output=True,
        text=True,
        check=False,
    )
    return run.returncode, run.stdout + run.stderr


def driver(fmi: int) -> str:
    return (HERE / f"driver{fmi}.c").read_text(encoding="utf-8")


@pytest.mark.thorough
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("made", MADE)
def test_no_check_of_the_compiler_finds_anything(
    made: Callable[[], Spec], fmi: int, tmp_path: Path
) -> None:
    code = fmu_code(made(), fmi, "{it}") + driver(fmi)
    number, said = checked(code, tmp_path)
    assert (number, said) == (0, "all as it should be\n"), said


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        (
            "void fmi3FreeInstance(fmi3Instance instance) { free(instance); }",
            "void fmi3FreeInstance(fmi3Instance instance) { (void)instance; }",
            "memory leaks",
        ),
        (
            "  if (n) memcpy(d, self->m.v + V_D, n * sizeof *d);",
            "  if (n) memcpy(d, self->m.v + V_D, (n + 8) * sizeof *d);",
            "stack-buffer-overflow",
        ),
        ("self->m.phase = self->exchange ? EVENT : STEP;", "self->m.phase = STEP;", "line "),
        ("  *state = 0;\n", "", "double-free"),
    ],
)
def test_what_is_wrong_is_found(right: str, wrong: str, said: str, tmp_path: Path) -> None:
    code = fmu_code(element(), 3, "{it}")
    assert code.count(right) == 1
    number, text = checked(code.replace(right, wrong) + driver(3), tmp_path)
    assert number != 0
    assert said in text


@pytest.mark.thorough
@pytest.mark.parametrize("checks", ["address,undefined", "thread"])
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("made", MADE)
def test_a_storm_of_calls_ends_in_a_status(
    made: Callable[[], Spec], fmi: int, checks: str, tmp_path: Path
) -> None:
    parts = (HERE / name for name in ("storm_draw.c", f"storm{fmi}.c", "storm.c"))
    code = "\n".join(part.read_text(encoding="utf-8") for part in parts)
    number, said = checked(fmu_code(made(), fmi, "{it}") + code, tmp_path, checks)
    assert number == 0, said
    done, refused = (int(word) for word in said.split() if word.isdigit())
    assert min(done, refused) > 2000  # of 10 000 calls a thread

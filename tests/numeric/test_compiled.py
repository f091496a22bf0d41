"""Libraries are found by what they depend on, and the absence of a compiler is silent."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from symhyb.numeric.kernels import compiled as module

needs_compiler = pytest.mark.skipif(module.find_compiler() is None, reason="no C compiler")


def processor_flags() -> list[str]:
    """What this processor has; nothing where that cannot be known."""
    file = Path("/proc/cpuinfo")
    return file.read_text(encoding="utf-8").split() if file.exists() else []


CODE = "int answer(void) { return 42; }"


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(module, "cache_folder", lambda kind: tmp_path)
    return tmp_path


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache of its own for this test, found the way that a user's is."""
    import platformdirs

    monkeypatch.setattr(platformdirs, "user_cache_path", lambda name: tmp_path / name)
    module.cache_folder.cache_clear()
    yield tmp_path
    module.cache_folder.cache_clear()


def test_without_a_compiler_there_is_no_library(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "find_compiler", lambda: None)
    assert module.library_of(CODE) is None
    assert not list(cache.iterdir())


def test_a_compiler_that_fails_leaves_nothing_behind(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "find_compiler", lambda: ("false", "broken"))
    assert module.library_of(CODE) is None
    assert [file.name for file in cache.iterdir()] == [module.LOCK]


def test_a_compiler_that_is_no_program_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    for named in ("", "no-such-compiler", "false"):
        monkeypatch.setenv("SYMHYB_CC", named)
        assert module.find_compiler.__wrapped__() is None


def file_of(cache: Path, code: str = CODE, level: str = "-O1") -> Path:
    """The one file that this code adds to the cache."""
    before = set(cache.glob("*.so"))
    library = module.library_of(code, level)
    assert library is not None
    assert library.answer() == 42
    (new,) = set(cache.glob("*.so")) - before
    content = new.read_bytes()
    new.unlink()  # what is loaded stays whole, whatever a test does to the file
    new.write_bytes(content)
    return new


@needs_compiler
def test_what_the_code_depends_on_is_in_its_name(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file_of(cache)
    file_of(cache, CODE + " ")
    file_of(cache, level="-O2")
    assert module.library_of(CODE, "-O1") is not None
    assert len(list(cache.glob("*.so"))) == 3
    monkeypatch.setattr(module, "processor", lambda: "another")
    file_of(cache)


@needs_compiler
def test_what_is_not_ready_is_not_built(cache: Path) -> None:
    assert module.file_of(CODE, ready=True) is None
    assert not list(cache.iterdir())
    assert module.library_of(CODE) is not None
    assert module.file_of(CODE, ready=True) is not None


@needs_compiler
def test_a_library_that_cannot_be_loaded_is_none(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(path: str) -> None:
        raise OSError(f"{path}: failed to map segment")  # a folder that is mounted noexec

    monkeypatch.setattr(module.ctypes, "CDLL", refused)
    assert module.library_of(CODE) is None
    assert len(list(cache.glob("*.so"))) == 1


@needs_compiler
@pytest.mark.parametrize("damage", ["half", "flip", "digest", "no digest"])
def test_a_damaged_library_is_built_again(cache: Path, damage: str) -> None:
    library = file_of(cache)
    whole, digest = library.read_bytes(), library.with_suffix(".sum")
    if damage == "half":
        library.write_bytes(whole[: len(whole) // 2])
    elif damage == "flip":
        library.write_bytes(whole[:5000] + bytes([whole[5000] ^ 1]) + whole[5001:])
    elif damage == "digest":
        digest.write_bytes(b"\xff")
    else:
        digest.unlink()
    assert module.library_of(CODE, "-O1") is not None
    assert library.read_bytes() == whole


def test_the_newest_files_are_kept(tmp_path: Path) -> None:
    for i in range(5):
        for suffix in (".so", ".sum"):
            (tmp_path / f"{i}{suffix}").touch()
        os.utime(tmp_path / f"{i}.so", (i, i))
    module.forget(tmp_path, "*.so", 2)
    assert sorted(f.name for f in tmp_path.iterdir()) == ["3.so", "3.sum", "4.so", "4.sum"]


def test_the_folder_is_the_users_alone(home: Path) -> None:
    folder = module.cache_folder("compiled")
    assert folder == home / "symhyb" / "compiled"
    assert folder.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("mode", [0o777, 0o770])
def test_a_folder_that_others_may_write_to_is_not_used(home: Path, mode: int) -> None:
    folder = home / "symhyb" / "compiled"
    folder.mkdir(parents=True)
    folder.chmod(mode)
    assert module.cache_folder("compiled") is None


def test_a_link_in_place_of_the_folder_is_not_followed(home: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir(mode=0o700)
    (home / "symhyb").mkdir(parents=True)
    (home / "symhyb" / "compiled").symlink_to(elsewhere)
    assert module.cache_folder("compiled") is None


@needs_compiler
def test_a_link_in_place_of_a_library_is_built_anew(cache: Path, tmp_path: Path) -> None:
    library = file_of(cache)
    planted = tmp_path / "planted.so"
    planted.write_bytes(library.read_bytes())
    library.unlink()
    library.symlink_to(planted)
    assert module.library_of(CODE, "-O1") is not None
    assert not library.is_symlink()


@needs_compiler
def test_processes_that_want_one_library_compile_it_once(tmp_path: Path) -> None:
    """A compiler that takes half a second, and writes a line whenever it compiles."""
    path, calls = module.find_compiler()[0], tmp_path / "calls"
    slow = tmp_path / "slow-cc"
    slow.write_text(
        f'#!/bin/sh\ncase "$1" in --version) echo slow; exit 0;; esac\n'
        f'echo "$$" >> "{calls}"\nsleep 0.5\nexec "{path}" "$@"\n'
    )
    slow.chmod(0o755)
    code = (
        "from symhyb.numeric.kernels.compiled import library_of\n"
        f"assert library_of({CODE!r}).answer() == 42"
    )
    seen = {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), "SYMHYB_CC": str(slow)}
    both = [subprocess.Popen([sys.executable, "-c", code], env=seen) for _ in range(3)]
    assert [one.wait(timeout=60) for one in both] == [0, 0, 0]
    assert len(calls.read_text().splitlines()) == 1


def test_a_file_in_place_of_the_folder_is_no_error(home: Path) -> None:
    (home / "symhyb").write_text("")
    assert module.cache_folder("compiled") is None


@needs_compiler
@pytest.mark.skipif("avx" not in processor_flags(), reason="has no wide vector registers")
def test_functions_are_called_with_the_upper_halves_of_registers_cleared(cache: Path) -> None:
    """Else each call of a function of the mathematical library takes ten times as long."""
    code = """
    #include <math.h>
    typedef double vec __attribute__((vector_size(32), may_alias));
    int answer(void) { return 42; }
    void run(vec *x) { vec y = *x + 1.0; for (int l = 0; l < 4; l++) y[l] = exp(y[l]); *x = y; }
    """
    assert b"\xc5\xf8\x77" in file_of(cache, code).read_bytes()  # vzeroupper

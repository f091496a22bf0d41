"""Libraries are found by what they depend on, and the absence of a compiler is silent."""

import ctypes
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from symhyb.numeric.kernels import compiled as module

needs_compiler = pytest.mark.skipif(module.find_compiler() is None, reason="no C compiler")

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
    assert module.shared_library(CODE, ()) is None
    assert not list(cache.iterdir())


def test_a_compiler_that_fails_leaves_nothing_behind(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "find_compiler", lambda: ("false", "broken"))
    assert module.shared_library(CODE, ()) is None
    assert not list(cache.iterdir())


def test_a_compiler_that_is_no_program_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    for named in ("", "no-such-compiler", "false"):
        monkeypatch.setenv("SYMHYB_CC", named)
        assert module.find_compiler.__wrapped__() is None


@needs_compiler
def test_what_the_code_depends_on_is_in_its_name(cache: Path) -> None:
    first = module.shared_library(CODE, ("-O1",))
    others = [
        module.shared_library(CODE + " ", ("-O1",)),
        module.shared_library(CODE, ("-O2",)),
        module.shared_library(CODE, ("-O1",), ()),
        module.shared_library(CODE, ("-O1",), about="another processor"),
    ]
    assert first is not None
    assert module.shared_library(CODE, ("-O1",)) == first
    assert len({first, *others}) == 5
    assert ctypes.CDLL(str(first)).answer() == 42


@needs_compiler
@pytest.mark.parametrize("damage", ["half", "flip", "digest", "no digest"])
def test_a_damaged_library_is_built_again(cache: Path, damage: str) -> None:
    library = module.shared_library(CODE, ())
    assert library is not None
    whole, digest = library.read_bytes(), library.with_suffix(".sum")
    if damage == "half":
        library.write_bytes(whole[: len(whole) // 2])
    elif damage == "flip":
        library.write_bytes(whole[:5000] + bytes([whole[5000] ^ 1]) + whole[5001:])
    elif damage == "digest":
        digest.write_bytes(b"\xff")
    else:
        digest.unlink()
    assert module.shared_library(CODE, ()) == library
    assert library.read_bytes() == whole
    assert ctypes.CDLL(str(library)).answer() == 42


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
    library = module.shared_library(CODE, ["-O1"])
    assert library is not None
    planted = tmp_path / "planted.so"
    planted.write_bytes(library.read_bytes())
    library.unlink()
    library.symlink_to(planted)
    assert module.shared_library(CODE, ["-O1"]) == library
    assert not library.is_symlink()


def test_a_file_in_place_of_the_folder_is_no_error(home: Path) -> None:
    (home / "symhyb").write_text("")
    assert module.cache_folder("compiled") is None

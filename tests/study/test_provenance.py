"""What a result was made from."""

import hashlib
import platform
from importlib import metadata
from pathlib import Path

import pytest

from symhyb import __version__
from symhyb.errors import InputError
from symhyb.study.provenance import LIBRARIES, sha256_of, versions


def test_versions_are_those_that_are_installed() -> None:
    found = versions()
    assert found["python"] == platform.python_version()
    assert found["symhyb"] == __version__
    assert {name: found[name] for name in LIBRARIES} == {
        name: metadata.version(name) for name in LIBRARIES
    }


def test_a_hash_is_that_of_the_bytes(tmp_path: Path) -> None:
    file = tmp_path / "model.toml"
    file.write_bytes(b"symhyb = 1\r\n")
    assert sha256_of(file) == hashlib.sha256(b"symhyb = 1\r\n").hexdigest()


def test_a_file_that_is_gone_has_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"gone\.toml"):
        sha256_of(tmp_path / "gone.toml")

"""Files that are read within limits, and the page that lists these."""

import os
import re
from pathlib import Path

import pytest

from symhyb import limits
from symhyb.errors import InputError
from symhyb.limits import content_of, text_of

DOCS = Path(__file__).parents[1] / "docs" / "reliability.md"


def complaint(path: str | Path, most: int = 10) -> str:
    with pytest.raises(InputError) as caught:
        content_of(path, most)
    return str(caught.value).removeprefix(f"{path}: ")


def test_a_file_within_its_limit_is_read(tmp_path: Path) -> None:
    file = tmp_path / "a.txt"
    file.write_bytes(b"0123456789")
    assert content_of(file, 10) == b"0123456789"


def test_what_cannot_be_read_is_a_sentence(tmp_path: Path) -> None:
    large, pipe = tmp_path / "large", tmp_path / "pipe"
    large.write_bytes(bytes(11))
    os.mkfifo(pipe)
    assert complaint(large) == "is larger than 1e-05 MB"
    assert complaint(pipe) == "is no plain file"  # and is not waited for
    assert complaint("/dev/zero") == "is no plain file"
    assert complaint(tmp_path) == "is a folder, not a file"
    assert complaint(tmp_path / "none") == "there is no such file"
    assert complaint(tmp_path / ("a" * 300)) == "cannot be read: File name too long"
    assert complaint("a\0").startswith("a\\u0000: ")


def test_a_text_is_unicode_and_not_empty(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    for content, said in ((b"a\nb\xff", ":2: is not UTF-8"), (b"\xef\xbb\xbf \n", "file is empty")):
        file.write_bytes(content)
        with pytest.raises(InputError, match=said):
            text_of(file)
    file.write_bytes(b"\xef\xbb\xbfa = 1")
    assert text_of(file) == "a = 1"
    assert text_of(file, "utf-8") == "\ufeffa = 1"


def test_the_page_lists_every_limit_with_its_value() -> None:
    rows = dict(re.findall(r"^\| `(\w+)` \| ([^|]+?) \|", DOCS.read_text(encoding="utf-8"), re.M))
    values = {
        name: value
        for name, value in vars(limits).items()
        if name.isupper() and isinstance(value, int | float)
    }
    assert {name: float(text.replace(" ", "")) for name, text in rows.items()} == values

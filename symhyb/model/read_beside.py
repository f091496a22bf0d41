"""What curves and maps are read with: the text of a file beside the model file, words, faults."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from math import isfinite
from pathlib import Path
from typing import TypeVar

from symhyb.errors import InputError, did_you_mean
from symhyb.limits import CURVE_BYTES, content_of
from symhyb.model.beside import inside, named_file
from symhyb.model.tables import Table, describe, shorten

T = TypeVar("T")

ENDINGS = (".csv", ".tsv", ".txt", ".dat")
RESULT = "simulation.csv"  # what a diagnosis leaves beside the corrected model and its files
FAULTS_MOST = 10  # of numbers, that are reported one by one


def text_beside(table: Table, home: Path | None) -> tuple[str, str] | None:
    """The name of the ``file`` of numbers in the folder ``home`` of the model file, and its text;
    None if it cannot be read."""
    file = named_file(table, "file")
    if file is not None and (not file.lower().endswith(ENDINGS) or file.lower() == RESULT):
        kinds = f"must end in {', '.join(ENDINGS)}; '{RESULT}' is a result of symhyb"
        table.fault(f"'{shorten(file)}' is no name of a file of points: it {kinds}", "file")
        return None
    content = None if file is None else _content(table, file, home)
    return None if file is None or content is None else (file, content)


def _content(table: Table, file: str, home: Path | None) -> str | None:
    """The text of a file in the folder of the model file, None if it cannot be read."""
    if home is None:
        table.fault(f"'{shorten(file)}' lies beside a model file, and this text is none", "file")
        return None
    path = home / file
    try:
        if not inside(path, home):
            sentence = f"'{shorten(file)}' leads out of the folder of the model file"
            table.fault(f"{sentence}; put the file itself there", "file")
            return None
        return content_of(path, CURVE_BYTES).decode()
    except UnicodeDecodeError:
        table.fault(f"'{shorten(file)}' is not UTF-8 text; save the file as UTF-8", "file")
    except InputError as error:
        table.fault(f"'{shorten(file)}' {error.problems[0].text}", "file")
    except (OSError, ValueError):
        table.fault(f"'{shorten(file)}' cannot be a file", "file")
    return None


def by_name(
    table: Table, key: str, word: str, known: Mapping[str, T | None], keys: Sequence[str] = ()
) -> T | None:
    """One of the ``known`` curves or maps of the model (``word``), whose name stands under a key;
    None (one that could not be read) with a fault if there is none, or if ``keys`` of its own stand
    beside the name."""
    name, own = table.text(key), [one for one in keys if one in table.entries]
    for one in own:
        table.fault(f"'{one}' belongs to the {word}, which [{word}s] states by '{key}'", one)
    if name is None or own:
        return None
    if name not in known:
        cure = did_you_mean(name, list(known)) or f"; state it under [{word}s]"
        table.fault(f"'{shorten(name)}' is not a known {word}{cure}", key)
    return known.get(name)


def word_of(table: Table, key: str, words: Sequence[str]) -> int:
    """The place of the word under a key, 0 where it is unset or none of them."""
    word = table.text(key)
    if word is None or word in words:
        return 0 if word is None else words.index(word)
    cure = did_you_mean(word, words)
    table.fault(f"must be {' or '.join(words)}, not '{shorten(word)}'{cure}", key)
    return 0


def wrong_number(value: object) -> str:
    """What keeps a value of the file from being a finite number; empty of one."""
    wrong = f"{describe(value)}, not a finite number"
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return wrong
    try:
        return "" if isfinite(float(value)) else wrong
    except OverflowError:
        return wrong


def disorder(name: str, numbers: Sequence[float], places: Sequence[str]) -> Iterator[str]:
    """What keeps the numbers of this name from increasing from place to place."""
    for (before, x), place in zip(pairwise(numbers), places[1:], strict=True):
        if x == before:
            yield f"{place} {name} = {x:g} is stated twice"
        elif x < before:
            yield f"{place} {name} = {x:g} comes after {before:g}; {name} must increase"


def report(table: Table, key: str, faults: Sequence[str]) -> None:
    """Note faults of a key, the first of them one by one."""
    for fault in faults[:FAULTS_MOST]:
        table.fault(fault, key)
    if len(faults) > FAULTS_MOST:
        table.fault(f"and {len(faults) - FAULTS_MOST} more like these", key)

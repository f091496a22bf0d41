"""A delimited text piece by piece: each piece is read as a file of its own, under the same lines
above the first row."""

from collections.abc import Iterator
from dataclasses import replace

from symhyb.data.files.csv_file import read_csv
from symhyb.data.files.table import Table, refusal
from symhyb.errors import InputError, Problem

LINE_MOST = 1_000_000  # bytes
BEGIN = 1_000_000  # bytes that show what stands above the first row, and how long a row is


def csv_pieces(path: str, file: str, rows: int) -> Iterator[Table]:
    """Read the columns (N,) of a delimited text, about so many ``rows`` at a time.

    Raises:
        InputError: as :func:`read_csv`; a line that is longer than any row.
    """
    with open(path, "rb") as stream:
        begin = stream.read(BEGIN)
        if begin[:2] in (b"\xff\xfe", b"\xfe\xff"):
            raise refusal(file, "is UTF-16 text; save it as UTF-8 to read it in pieces")
        whole = begin[: begin.rfind(b"\n") + 1] if len(begin) == BEGIN else begin
        table = read_csv(whole, file)
        assert table.lines is not None
        lines = whole.splitlines(keepends=True)
        above = b"".join(lines[: int(table.lines[0]) - 1])
        size = rows * max(len(whole) // len(lines), 1)
        stream.seek(len(above))
        passed, first = 0, 0  # lines and rows
        while body := _lines(stream.read(size), stream.readline(LINE_MOST), file):
            try:
                table = read_csv(above + body, file)
            except InputError as error:
                raise InputError([_later(one, passed) for one in error.problems]) from None
            assert table.lines is not None
            columns = [
                one if one.problem is None else replace(one, problem=_later(one.problem, passed))
                for one in table.columns
            ]
            yield replace(table, columns=tuple(columns), lines=table.lines + passed, first=first)
            passed += body.count(b"\n")
            first += table.lines.size


def _later(problem: Problem, lines: int) -> Problem:
    """A problem of a piece at its line of the file."""
    return replace(problem, line=problem.line + lines) if problem.line else problem


def _lines(body: bytes, rest: bytes, file: str) -> bytes:
    if len(rest) == LINE_MOST:
        raise refusal(file, f"has a line of more than {LINE_MOST} bytes")
    return body + rest

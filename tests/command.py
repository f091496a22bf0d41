"""The command line in this process, as a person calls it."""

import sys
from collections.abc import Callable
from dataclasses import dataclass

import pytest

from symhyb.cli.app import main


@dataclass(frozen=True, slots=True)
class Done:
    """How a call of the command line ended."""

    status: int
    out: str
    err: str


Call = Callable[..., Done]


def caller(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """``symhyb(*arguments)``, which runs the command line in this process."""

    def call(*arguments: object) -> Done:
        monkeypatch.setattr(sys, "argv", ["symhyb", *map(str, arguments)])
        capsys.readouterr()
        with pytest.raises(SystemExit) as stop:
            main()
        out, err = capsys.readouterr()
        assert "Traceback" not in out
        return Done(int(stop.value.code or 0), out, err)

    return call

"""A signal to end is known as such, whatever error it comes out as."""

import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from symhyb.interruption import is_interruption, listen


@pytest.fixture(autouse=True)
def _handlers() -> Iterator[None]:
    kept = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    listen()
    yield
    listen()
    for number, handler in kept.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_raises_and_is_remembered(number: signal.Signals) -> None:
    other = SystemError("a kernel returned a result with an exception set")
    assert not is_interruption(other)
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(number)
    assert is_interruption(other)
    listen()
    assert not is_interruption(other)


def test_a_program_that_runs_as_a_module_ends_with_the_status_that_it_asks_for(
    tmp_path: Path,
) -> None:
    (tmp_path / "ended.py").write_text("""
import sys
from symhyb.interruption import listen
listen()
try:
    exec("import signal; signal.raise_signal(signal.SIGINT)")
except KeyboardInterrupt:
    sys.exit(130)
""")
    ended = subprocess.run([sys.executable, "-m", "ended"], cwd=tmp_path, check=False)
    assert ended.returncode == 130


def test_an_interruption_that_another_program_raised_is_one() -> None:
    assert is_interruption(KeyboardInterrupt())


def test_a_signal_that_is_ignored_stays_so() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    listen()
    signal.raise_signal(signal.SIGINT)
    assert not is_interruption(ValueError())

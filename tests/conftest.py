"""What all tests share: public recordings, if they are on this machine, the command, a browser."""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from command import Call, caller

from symhyb.data.datasets import FOLDER, fetch
from symhyb.data.hosts.fmu_answers import TRUST
from tests.absent import absent


@pytest.fixture(scope="session", autouse=True)
def trusted_fmus() -> Iterator[None]:
    """FMUs of the tests may run, in processes that they start too."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(TRUST, "1")
        yield


@pytest.fixture(scope="session")
def public_file() -> Callable[..., Path]:
    """Return ``public_file(dataset, file)``: the path of a known public recording, hash checked.

    Without the folder the test is skipped; on a build server (CI=true) it fails, because there the
    recordings are part of the evidence.
    """
    if FOLDER in os.environ:
        return fetch
    text = (
        f"set {FOLDER} to a folder with the public recordings;"
        " `symhyb data` lists them with their addresses"
    )
    absent(text)


@pytest.fixture
def symhyb(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Return ``symhyb(*arguments)``, which runs the command line in this process."""
    return caller(monkeypatch, capsys)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """A Chromium without a window."""
    from playwright import sync_api

    names = ("chromium", "chromium-browser", "chrome")
    program = next(filter(None, map(shutil.which, names)), None)
    if program is None:
        pytest.fail("needs a Chromium on the PATH, such as Debian's")
    with sync_api.sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield running
        running.close()

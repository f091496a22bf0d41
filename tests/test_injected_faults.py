"""Faults put in wherever a verb reads or writes: what is there is the old or the new, never half.

An audit hook sees every file that is opened and every file or folder that is moved or made in the
folder of the test, and lets the reading or the writing with a given number fail. What failed is
tried again without a fault, which must work.
"""

import io
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from errno import EACCES, EIO, ENOENT, ENOSPC, EROFS
from pathlib import Path

import pytest
from fakes import Fake, fake_diagnosis, friction

from symhyb.errors import InputError
from symhyb.writing import PREFIX, STALE, staged, write_file

ROOT = Path(__file__).parent.parent
OSCILLATOR = str(ROOT / "models" / "oscillator.toml")
STUDY = ROOT / "studies" / "oscillator"
WRITES = ("open", "os.rename", "os.mkdir")
MOST = 60  # places of a verb
WHOLE = {"corrected.toml", "diagnosis.json", "report.html", "simulation.csv"}


class Faults:
    """What the audit hook does: count events in a folder, let one of them fail."""

    folder, events, kind, at, seen = "", WRITES, 0, -1, 0

    def __call__(self, event: str, arguments: tuple[object, ...]) -> None:
        if not self.folder or event not in self.events:
            return
        if event == "open" and _writes(arguments) != (self.events == WRITES):
            return
        if event == "os.mkdir" and os.path.isdir(str(arguments[0])):
            return  # that it is there already is no fault
        if not any(str(one).startswith(self.folder) for one in arguments):
            return
        self.seen += 1
        if self.seen == self.at + 1:
            if self.kind == signal.SIGINT:
                raise KeyboardInterrupt
            raise OSError(self.kind, os.strerror(self.kind))


def _writes(arguments: tuple[object, ...]) -> bool:
    mode, flags = arguments[1], arguments[2]
    return any(letter in str(mode or "") for letter in "wax+") or bool(
        isinstance(flags, int) and flags & (os.O_WRONLY | os.O_RDWR)
    )


FAULTS = Faults()
sys.addaudithook(FAULTS)


@contextmanager
def fault(folder: Path, kind: int, at: int, events: tuple[str, ...] = WRITES) -> Iterator[None]:
    """Let write or read number ``at`` in ``folder`` fail."""
    FAULTS.events, FAULTS.kind, FAULTS.at, FAULTS.seen = events, kind, at, 0
    FAULTS.folder = str(folder)
    try:
        yield
    finally:
        FAULTS.folder = ""


def called(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    """The exit status of the command line in this process."""
    from symhyb.cli.app import main

    monkeypatch.setattr(sys, "argv", ["symhyb", *map(str, arguments)])
    before = signal.getsignal(signal.SIGTERM)
    try:
        with pytest.raises(SystemExit) as ended:
            main()
    finally:
        signal.signal(signal.SIGTERM, before)
    assert isinstance(ended.value.code, int)
    return ended.value.code


def held(folder: Path) -> dict[str, bytes]:
    """Every file below a folder."""
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> Fake:
    return fake_diagnosis(monkeypatch)


VERBS = {
    "diagnose": ["diagnose", OSCILLATOR, STUDY / "train.csv", "-o"],
    "run": ["run", STUDY / "study.toml", "-o"],
    "export": ["export", OSCILLATOR, "--whole", "--to", "c", "--name", "osc", "-o"],
    "simulate": ["simulate", OSCILLATOR, "--end", "0.1", "-o"],
}


QUICK = ("simulate", "export", "check", "compare")


def marked(verbs: Iterable[str]) -> list[object]:
    """The verbs, of which those that diagnose take long."""
    return [
        pytest.param(verb, marks=() if verb in QUICK else pytest.mark.thorough) for verb in verbs
    ]


@pytest.mark.parametrize("there", [False, True])
@pytest.mark.parametrize("kind", [ENOSPC, EACCES, EROFS, EIO, signal.SIGINT])
@pytest.mark.parametrize("verb", marked(VERBS))
def test_outputs_are_old_or_new(
    fake: Fake,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    verb: str,
    there: bool,
    kind: int,
) -> None:
    fake(friction())
    out = tmp_path / "out"
    command = [*VERBS[verb], out / "run.csv" if verb == "simulate" else out]
    if there:
        called(monkeypatch, *command)
        for file in out.iterdir():
            file.write_text("old")
        (out / "mine.txt").write_text("mine")
    old = held(tmp_path)
    tried = 0
    for at in range(MOST):
        with fault(tmp_path, kind, at):
            status = called(monkeypatch, *command)
            if FAULTS.seen <= at:  # no write has this number: the verb went through
                break
        tried += 1
        assert status == (130 if kind == signal.SIGINT else 2), at
        assert held(tmp_path) == old, at
    assert 2 <= tried < MOST
    assert status in (0, 1)
    new = held(tmp_path)
    assert set(old) < set(new) or there
    assert b"old" not in new.values()
    assert ("out/mine.txt" in new) == there


READERS = {  # @: the folder of the test
    "check": "check @/given/model.toml",
    "compare": "compare @/given/model.toml @/given/train.csv",
    "diagnose": "diagnose @/given/model.toml @/given/train.csv -o @/out",
    "export": "export @/given/model.toml --whole --to c --name osc -o @/out",
    "run": "run @/given/study.toml -o @/out",
    "simulate": "simulate @/given/model.toml --end 0.1 -o @/out/run.csv",
}


class Breaking(io.FileIO):
    """A file that opens, and breaks off in its middle if it is the one that shall fail."""

    def read(self, size: int | None = -1) -> bytes:
        half = os.fstat(self.fileno()).st_size // 2
        data = super().read(half)
        assert data
        FAULTS("read", (self.name,))
        return data + super().read(size)


def breaking(file: Path, mode: str) -> Breaking:
    """In the place of ``open`` where every file is read that a person gives."""
    assert mode == "rb"
    return Breaking(str(file))


@pytest.mark.parametrize("event", ["open", "read"])
@pytest.mark.parametrize("kind", [ENOENT, EACCES, EIO, signal.SIGINT])
@pytest.mark.parametrize("verb", marked(READERS))
def test_a_file_that_cannot_be_read_is_a_sentence(
    fake: Fake,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    verb: str,
    kind: int,
    event: str,
) -> None:
    """The file vanishes, or its disk fails, when it is opened for the first, second, … time, or
    in its middle."""
    fake(friction())
    if event == "read":
        monkeypatch.setattr("symhyb.limits.open", breaking, raising=False)
    given = tmp_path / "given"
    shutil.copytree(STUDY, given)
    shutil.copy(OSCILLATOR, given / "model.toml")
    study = (given / "study.toml").read_text(encoding="utf-8")
    assert "../../models/oscillator.toml" in study
    study = study.replace("../../models/oscillator.toml", "model.toml")
    (given / "study.toml").write_text(study, encoding="utf-8")
    command = READERS[verb].replace("@", str(tmp_path)).split()
    old = held(tmp_path)
    tried = 0
    for at in range(MOST):
        with fault(given, kind, at, (event,)):
            status = called(monkeypatch, *command)
            if FAULTS.seen <= at:  # nothing is read a time more: the verb went through
                break
        tried += 1
        said = "".join(capsys.readouterr())
        assert status == (130 if kind == signal.SIGINT else 2), (at, said)
        assert "Traceback" not in said, at
        if kind != signal.SIGINT:
            assert any(Path(name).name in said for name in old), (at, said)  # which file it was
        assert held(tmp_path) == old, at
    assert 1 <= tried < MOST
    assert status in (0, 1)


def test_what_was_replaced_goes_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The third of three files cannot be moved: the first two are the old ones again."""
    (tmp_path / "out").mkdir()
    for name in "ab":
        (tmp_path / "out" / name).write_text(f"old {name}")
    whole = os.replace

    def failing(source: Path, target: Path) -> None:
        if Path(target).name == "c":
            raise OSError(ENOSPC, "No space left on device")
        whole(source, target)

    monkeypatch.setattr(os, "replace", failing)
    with pytest.raises(InputError, match="No space left"), staged(tmp_path / "out") as part:
        _ = [(part / name).write_text("new") for name in "abc"]
    assert held(tmp_path) == {"out/a": b"old a", "out/b": b"old b"}


def test_a_disk_without_second_names_keeps_copies(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(source: Path, target: Path) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", failing)
    for text in ("old", "new"):
        with staged(tmp_path / "out") as part:
            (part / "a").write_text(text)
    assert held(tmp_path) == {"out/a": b"new"}


def test_a_folder_that_is_there_needs_no_room_beside_it(tmp_path: Path) -> None:
    target = tmp_path / "out"
    with staged(target) as part:
        assert not part.is_relative_to(target)
    with staged(target) as part:
        assert part.is_relative_to(target)
        (part / "a").write_text("a")
    assert held(tmp_path) == {"out/a": b"a"}
    assert [one.name for one in target.iterdir()] == ["a"]


def test_what_a_killed_process_left_is_removed_after_a_day(tmp_path: Path) -> None:
    old, young = tmp_path / f"{PREFIX}old", tmp_path / f"{PREFIX}young"
    for folder in (old, young):
        (folder / "new").mkdir(parents=True)
    os.utime(old, (time.time() - 2 * STALE,) * 2)
    with staged(tmp_path / "out") as part:
        (part / "a").write_text("a")
    assert not old.exists()
    assert young.exists()


def test_a_file_is_never_half_written(tmp_path: Path) -> None:
    write_file(tmp_path / "deep" / "a.txt", "old")
    with fault(tmp_path, ENOSPC, 0), pytest.raises(InputError, match="No space left"):
        write_file(tmp_path / "deep" / "a.txt", "new")
    assert held(tmp_path) == {"deep/a.txt": b"old"}
    with pytest.raises(InputError, match="is a folder; name a file in it"):
        write_file(tmp_path / "deep", "new")


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_diagnosis_that_is_ended_leaves_nothing_half(tmp_path: Path, ending: int) -> None:
    out = tmp_path / "out"
    command = [sys.executable, "-m", "symhyb", *map(str, VERBS["diagnose"]), str(out)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    time.sleep(3)
    process.send_signal(ending)
    _, said = process.communicate(timeout=60)
    left = {name.removeprefix("out/") for name in held(tmp_path)}
    assert left in (set(), WHOLE)  # all files are there before advice is sought
    done = process.returncode == 1 and left == WHOLE  # a fast machine was not ended in time
    assert done or process.returncode in (130, -ending)  # the latter before symhyb was imported
    if process.returncode == 130:
        assert said.splitlines()[-1] == "interrupted; nothing more was written"
        assert "Traceback" not in said

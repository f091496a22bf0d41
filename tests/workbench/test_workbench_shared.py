"""What the tabs of a browser share: results, addresses of reports, the one diagnosis."""

from collections.abc import Callable
from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.workbench import shared as room
from symhyb.workbench.bench import Bench, with_elements
from symhyb.workbench.job import Progress, Request
from symhyb.workbench.shared import Shared, new_folder

Write = Callable[..., Path]


class FakeJob:
    """A diagnosis that is in some state."""

    def __init__(self, request: Request) -> None:
        self.request, self.state = request, "running"

    def progress(self) -> Progress:
        return Progress(self.request.output, self.state)

    def stop(self) -> None:
        self.state = "stopped"


@pytest.fixture
def shared(bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shared:
    """A bench whose diagnoses are fakes."""
    monkeypatch.setattr(room, "Job", FakeJob)
    return Shared(bench, (), tmp_path / "out")


def test_reports_are_found_by_their_address_alone(write_result: Write, tmp_path: Path) -> None:
    folder = write_result("one")
    shared = Shared(None, [folder], tmp_path)
    address = shared.address(folder)
    assert shared.report(address) is None  # not written
    (folder / "report.html").write_text("<p>", encoding="utf-8")
    assert shared.report(address) == folder / "report.html"
    key = shared.key
    for wrong in (
        f"/{key}/1/report.html",
        f"/{key}/0/diagnosis.json",
        f"/{key}/0/../0/report.html",
        f"/{key}/-1/report.html",
        f"/{key}/{'9' * 400}/report.html",
        f"/{key}",
    ):
        assert shared.report(wrong) is None


def test_a_diagnosis_is_of_what_is_set(shared: Shared, bench: Bench) -> None:
    shared.start(bench, ())
    assert isinstance(shared.job, FakeJob)
    assert shared.job.request.model == bench.file
    assert shared.job.request.output.name == "1"
    with pytest.raises(InputError, match="running already"):
        shared.start(bench, ())
    shared.stop()
    shared.start(with_elements(bench, ["spring", "shaker"]), ())
    assert isinstance(shared.job, FakeJob)
    text = shared.job.request.model.read_text(encoding="utf-8")
    assert "elements.spring" in text
    assert "elements.damper" not in text


def test_something_must_be_left_to_learn_from(shared: Shared, bench: Bench) -> None:
    with pytest.raises(InputError, match="to learn from"):
        shared.start(bench, (0,))
    assert shared.progress() is None


def test_a_result_is_collected_once(shared: Shared, bench: Bench, write_result: Write) -> None:
    shared.output = write_result("made").parent / "made"
    shared.start(bench, ())
    assert isinstance(shared.job, FakeJob)
    assert shared.collected() is None
    done = write_result("made/1")
    shared.job.state = "done"
    result = shared.collected()
    assert result is not None
    assert result.folder == done
    assert shared.collected() is result
    assert shared.results == [result]
    assert new_folder(shared.output).name == "2"

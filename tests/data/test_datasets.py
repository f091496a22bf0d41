"""Known public recordings: found where they are said to be, refused when they are others."""

import functools
import hashlib
import http.server
import re
import threading
from dataclasses import replace

import pooch
import pytest

from symhyb.data.catalogue import DATASETS, DataFile, Dataset, named
from symhyb.data.datasets import fetch, listing
from symhyb.errors import InputError

CONTENT = b"t,x\n0,1\n"
SHA256 = hashlib.sha256(CONTENT).hexdigest()


@pytest.fixture(autouse=True)
def own_cache(request, tmp_path, monkeypatch):
    """Keep the folder and the cache of the person who runs the tests out of it."""
    if "public_file" not in request.fixturenames:
        monkeypatch.delenv("SYMHYB_DATA", raising=False)
    monkeypatch.setattr("pooch.os_cache", lambda name: tmp_path / "cache" / name)
    for name in ("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    return tmp_path / "cache" / "symhyb"


def dataset(address: str = "http://127.0.0.1:9/run.csv") -> Dataset:
    file = DataFile("run.csv", len(CONTENT), SHA256, address)
    return Dataset("bench", "bench_folder", "A bench", (file,), "MIT", "somebody", "t [s]")


@pytest.fixture
def server(tmp_path):
    """A web server on this machine with one file; gives its address and the paths asked for."""
    (tmp_path / "web").mkdir()
    (tmp_path / "web" / "run.csv").write_bytes(CONTENT)
    asked = []

    class Handler(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *arguments):
            asked.append(self.path)

    handler = functools.partial(Handler, directory=tmp_path / "web")
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as running:
        thread = threading.Thread(target=running.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{running.server_address[1]}/run.csv", asked
        running.shutdown()
        thread.join()


def test_the_catalogue_is_consistent():
    names = [known.name for known in DATASETS]
    assert names == ["emps", "silverbox", "kvlcc2_rolldecay", "pendulum", "balldrops", "brfd"]
    files = [file for known in DATASETS for file in known.files]
    assert len({file.sha256 for file in files}) == len(files)
    for file in files:
        assert re.fullmatch(r"[0-9a-f]{64}", file.sha256)
        assert re.fullmatch(
            r"https://raw\.githubusercontent\.com/[\w.-]+/[\w.-]+/[0-9a-f]{40}/[\w.%/-]+",
            file.address,
        )
        assert file.address.endswith("/" + file.name)
        assert file.size > 0


@pytest.mark.parametrize(
    ("name", "file"), [(known.name, file.name) for known in DATASETS for file in known.files]
)
def test_the_public_files_have_the_stated_size_and_hash(public_file, name, file):
    known = next(known for known in DATASETS if known.name == name)
    size = next(entry.size for entry in known.files if entry.name == file)
    assert public_file(name, file).stat().st_size == size


def test_the_folder_of_the_environment_comes_first(tmp_path, monkeypatch):
    path = tmp_path / "data" / "bench_folder" / "run.csv"
    path.parent.mkdir(parents=True)
    path.write_bytes(CONTENT)
    monkeypatch.setenv("SYMHYB_DATA", str(tmp_path / "data"))
    assert fetch(dataset(), "run.csv") == path
    assert fetch(dataset()) == path


def test_another_file_in_that_folder_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "data" / "bench_folder" / "run.csv"
    path.parent.mkdir(parents=True)
    path.write_bytes(CONTENT + b"1,2\n")
    monkeypatch.setenv("SYMHYB_DATA", str(tmp_path / "data"))
    with pytest.raises(InputError, match=rf"is not the known file: .*, not {SHA256}; remove it"):
        fetch(dataset())


def test_half_a_file_in_that_folder_is_refused_and_listed_as_such(tmp_path, monkeypatch):
    known = next(known for known in DATASETS if known.name == "balldrops")
    path = tmp_path / known.folder / "balls.txt"
    path.parent.mkdir(parents=True)
    path.write_bytes(b"half")
    monkeypatch.setenv("SYMHYB_DATA", str(tmp_path))
    with pytest.raises(InputError) as caught:
        fetch("balldrops", "balls.txt")
    assert "it holds 4 of 443 bytes, so it seems to be cut off; remove it" in str(caught.value)
    assert known.files[1].address in str(caught.value)
    assert "in SYMHYB_DATA, but not the known file: 4 bytes instead of 443)" in listing()


@pytest.mark.parametrize("known", DATASETS, ids=lambda known: known.name)
def test_a_recording_is_known_by_its_name_and_by_its_folder(known):
    assert named(known.name) is known
    assert named(known.folder) is known


def test_a_file_is_fetched_once_and_kept(server, own_cache, tmp_path, monkeypatch, caplog, capsys):
    address, asked = server
    pooch.get_logger().setLevel("INFO")
    monkeypatch.setattr(pooch.get_logger(), "handlers", [caplog.handler])
    monkeypatch.setenv("SYMHYB_DATA", str(tmp_path / "empty"))
    path = fetch(dataset(address))
    assert path == own_cache / "bench_folder" / "run.csv"
    assert path.read_bytes() == CONTENT
    assert fetch(dataset(address)) == path
    assert len(asked) == 1
    printed = capsys.readouterr()
    assert (printed.out, printed.err, caplog.records) == ("", "", [])


def test_progress_is_shown_when_asked_for(server, capsys):
    fetch(dataset(server[0]), progress=True)
    assert capsys.readouterr().err.endswith("run.csv 100 %\n")


def test_a_damaged_file_in_the_cache_is_fetched_again(server, own_cache):
    path = fetch(dataset(server[0]))
    path.write_bytes(b"damaged")
    assert fetch(dataset(server[0])).read_bytes() == CONTENT


def test_a_damaged_file_in_the_cache_without_a_network_is_called_damaged(own_cache):
    path = own_cache / "bench_folder" / "run.csv"
    path.parent.mkdir(parents=True)
    path.write_bytes(b"damaged")
    with pytest.raises(InputError, match=r"run\.csv in .*bench_folder is damaged and cannot be f"):
        fetch(dataset())


def test_where_to_put_a_file_is_the_folder_of_the_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("SYMHYB_DATA", str(tmp_path / "data"))
    with pytest.raises(InputError) as caught:
        fetch(dataset())
    assert f"put it into {tmp_path / 'data' / 'bench_folder'} (SYMHYB_DATA is" in str(caught.value)


def test_something_else_at_the_address_is_refused_and_not_kept(server, own_cache):
    known = dataset(server[0])
    wrong = replace(known, files=(replace(known.files[0], sha256="0" * 64),))
    with pytest.raises(InputError, match=r"holds is not the known file .*: refused"):
        fetch(wrong)
    assert not (own_cache / "bench_folder" / "run.csv").exists()


@pytest.mark.parametrize("path", ["nothing.csv", ""])
def test_without_the_file_or_the_network_one_sentence_says_what_to_do(server, own_cache, path):
    address = f"{server[0].removesuffix('run.csv')}{path}" if path else dataset().files[0].address
    with pytest.raises(InputError) as caught:
        fetch(dataset(address))
    said = str(caught.value)
    assert "bench_folder/run.csv is not on this computer and cannot be fetched" in said
    assert f"get it from {address} and put it into {own_cache / 'bench_folder'}" in said
    assert "SYMHYB_DATA" in said
    assert "\n" not in said


def test_names_that_are_not_known():
    with pytest.raises(InputError, match="by the name 'silverbx'; did you mean 'silverbox'"):
        fetch("silverbx")
    with pytest.raises(InputError, match=r"emps has no file 'DATA_EMPS'; did you mean"):
        fetch("emps", "DATA_EMPS")
    with pytest.raises(InputError, match=r"emps has several files; name one: DATA_EMPS\.mat, "):
        fetch("emps")


def test_the_listing_names_everything_and_where_it_is(tmp_path, monkeypatch):
    text = listing()
    for known in DATASETS:
        assert all(part in text for part in (known.name, known.title, known.licence))
        assert all(file.name in text for file in known.files)
    assert text.count("not here yet") == sum(len(known.files) for known in DATASETS)
    path = tmp_path / "data" / "emps" / "DATA_EMPS.mat"
    path.parent.mkdir(parents=True)
    path.write_bytes(bytes(626039))
    monkeypatch.setenv("SYMHYB_DATA", str(tmp_path / "data"))
    assert "DATA_EMPS.mat (0.6 MB, in SYMHYB_DATA)" in listing()

"""Functions come back from disk as they were, and nothing else ever does."""

import hashlib
import multiprocessing
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.kernels.instructions import BINARY, UNARY
from symhyb.numeric.lowered import cache


def machine() -> dict[str, ca.Function]:
    """A few functions as a machine has them: dense, sparse, empty, constant, unused arguments."""
    q, v, u, p = (ca.SX.sym(name, rows) for name, rows in (("q", 2), ("v", 2), ("u", 0), ("p", 3)))
    mass = p[0] * (1 + ca.cos(q[1]) ** 2)
    force = -p[1] * ca.tanh(v / 1e-3) + ca.if_else(q[0] > p[2], ca.sin(q[0]), 0.1)
    return {
        "M": ca.Function("M", [q, p], [ca.diag(ca.vertcat(mass, p[0]))], ["q", "p"], ["M"]),
        "k_e": ca.Function("k_e", [q, v, u, p], [force, ca.SX(2, 0)]),
        "still": ca.Function("still", [q], [ca.SX(2, 2), ca.SX(float("nan")), q[1]]),
    }


def signature(function: ca.Function) -> tuple[object, ...]:
    into = [(function.name_in(i), function.sparsity_in(i)) for i in range(function.n_in())]
    out = [(function.name_out(i), function.sparsity_out(i)) for i in range(function.n_out())]
    return function.name(), into, out


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(cache, "cache_folder", lambda kind: tmp_path)
    return tmp_path


def test_functions_come_back_as_they_were(folder: Path) -> None:
    key, before = cache.key("model"), machine()
    assert cache.load(key) is None
    assert cache.store(key, before)
    after = cache.load(key)
    assert after is not None
    assert list(after) == list(before)
    draw = np.random.default_rng(3)
    for name, function in before.items():
        assert signature(after[name]) == signature(function)
        given = [draw.normal(size=function.size_in(i)) for i in range(function.n_in())]
        for old, new in zip(function.call(given), after[name].call(given), strict=True):
            np.testing.assert_array_equal(np.array(new), np.array(old))
    assert len(list(folder.iterdir())) == 1


def test_every_operation_comes_back(folder: Path) -> None:
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    results = [ca.SX.unary(operation, x) for operation in sorted(UNARY)]
    results += [ca.SX.binary(operation, x, y) for operation in sorted(BINARY)]
    before = ca.Function("all", [x, y], [ca.vertcat(*results)])
    assert cache.store("all", {"all": before})
    after = (cache.load("all") or {})["all"]
    for given in ((0.3, 0.7), (-2.5, 1.5), (0.0, -1.0)):
        np.testing.assert_array_equal(np.array(after(*given)), np.array(before(*given)))


def test_functions_that_are_kept_can_be_differentiated(folder: Path) -> None:
    x = ca.SX.sym("x", 2)
    cache.store("f", {"f": ca.Function("f", [x], [x[0] ** 2 * x[1]])})
    loaded = (cache.load("f") or {})["f"]
    slope = ca.Function("slope", [x], [ca.jacobian(loaded(x), x)])
    assert np.allclose(np.array(slope([3.0, 5.0])), [[30.0, 9.0]])


@pytest.mark.parametrize("cut", [0, 1, 60, 90, 200, -1])
def test_a_truncated_file_is_removed(folder: Path, cut: int) -> None:
    cache.store("a", machine())
    (file,) = folder.iterdir()
    file.write_bytes(file.read_bytes()[:cut])
    assert cache.load("a") is None
    assert not list(folder.iterdir())
    assert cache.store("a", machine())
    assert cache.load("a") is not None


def test_a_flipped_byte_anywhere_is_seen(folder: Path) -> None:
    cache.store("a", machine())
    (file,) = folder.iterdir()
    data = file.read_bytes()
    for place in range(0, len(data), 37):
        file.write_bytes(data[:place] + bytes([data[place] ^ 4]) + data[place + 1 :])
        assert cache.load("a") is None, place


def test_another_format_is_not_read(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache.store("a", machine())
    monkeypatch.setattr(cache, "_MARK", b"symhyb functions 2 ")
    assert cache.load("a") is None


def forged(data: bytes, old: bytes, new: bytes) -> bytes:
    """The file with a change and a digest that fits it."""
    start = len(cache._MARK) + 65
    rest = data[start:].replace(old, new)
    assert rest != data[start:]
    return cache._MARK + hashlib.sha256(rest).hexdigest().encode() + b"\n" + rest


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b'"key": "M"', b'"kez": "M"'),
        (b'"size"', b'"siez"'),
        (b'"M"', b'"!"'),
        (np.array([ca.OP_COS], "<i4").tobytes(), np.array([ca.OP_CALL], "<i4").tobytes()),
        (np.array([ca.OP_COS], "<i4").tobytes(), np.array([-9], "<i4").tobytes()),
        (np.array([ca.OP_COS], "<i4").tobytes(), np.array([2**30], "<i4").tobytes()),
    ],
)
def test_a_forged_file_with_nonsense_is_refused(folder: Path, old: bytes, new: bytes) -> None:
    cache.store("a", {"M": machine()["M"]})
    (file,) = folder.iterdir()
    file.write_bytes(forged(file.read_bytes(), old, new))
    assert cache.load("a") is None


def test_a_stream_of_casadi_is_never_read(folder: Path) -> None:
    # CasADi would load the shared library that such a stream names.
    text = machine()["M"].serialize().encode()
    (folder / "a.functions").write_bytes(text)
    assert cache.load("a") is None
    digest = hashlib.sha256(text).hexdigest().encode()
    (folder / "a.functions").write_bytes(cache._MARK + digest + b"\n" + text)
    assert cache.load("a") is None


def test_the_key_tells_all_that_matters(monkeypatch: pytest.MonkeyPatch) -> None:
    keys = {cache.key(), cache.key("a"), cache.key("ab"), cache.key("a", "b"), cache.key("b", "a")}
    keys |= {cache.key("a", ""), cache.key("")}
    assert cache.key("a") == cache.key(b"a")
    monkeypatch.setattr(cache.ca.CasadiMeta, "version", lambda: "0")
    keys.add(cache.key("a"))
    monkeypatch.setattr(cache, "_lowering", lambda: "another code")
    keys.add(cache.key("a"))
    monkeypatch.setattr(cache, "FORMAT", 0)
    keys.add(cache.key("a"))
    assert len(keys) == 10


def test_all_code_between_a_model_and_its_functions_is_in_the_key() -> None:
    package = Path(cache.__file__).parents[2]
    code = {file.relative_to(package).as_posix() for file in cache.lowering_code()}
    assert "units.py" in code
    for layer in ("laws", "model", "mechanics", "numeric"):
        files = {file.relative_to(package).as_posix() for file in (package / layer).rglob("*.py")}
        assert files
        assert files <= code
    assert "numeric/lowered/translate.py" in code


def test_what_is_not_made_of_scalars_is_not_kept(folder: Path) -> None:
    x = ca.MX.sym("x", 2)
    assert not cache.store("a", {**machine(), "mx": ca.Function("mx", [x], [ca.norm_2(x)])})
    assert not list(folder.iterdir())


def test_without_a_folder_nothing_happens(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "cache_folder", lambda kind: None)
    assert not cache.store("a", machine())
    assert cache.load("a") is None


def test_a_folder_that_goes_away_is_no_error(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "cache_folder", lambda kind: folder / "gone")
    assert not cache.store("a", machine())
    assert cache.load("a") is None


def test_the_number_of_files_is_bounded(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "FILES_MOST", 3)
    for i in range(6):
        cache.store(f"{i}", machine())
    assert len(list(folder.iterdir())) == 3
    assert cache.load("5") is not None


def _busy(folder: str) -> int:
    """Store and load many times; how often something came back that was not whole."""
    cache.cache_folder = lambda kind: Path(folder)  # type: ignore[assignment]
    wrong = 0
    for _ in range(40):
        cache.store("a", machine())
        after = cache.load("a")
        if after is not None:
            (mass,) = call(after["M"], (np.zeros(2), np.ones(3)))[:1]
            wrong += mass[0, 0] != 2.0
        wrong += after is None
    return wrong


def test_two_processes_do_not_disturb_each_other(tmp_path: Path) -> None:
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.map(_busy, [str(tmp_path)] * 2) == [0, 0]
    assert len(list(tmp_path.iterdir())) == 1

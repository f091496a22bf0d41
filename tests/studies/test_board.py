"""The board: entries of strangers, hostile ones among them, on cases whose seals stay closed."""

import json
import re
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from tests.scripts import STUDIES, scripts

NAMES = ("apart", "answers", "methods", "benches", "lines", "board")
README = STUDIES / "board" / "README.md"
SEALED: dict[str, Any] = {
    "kind": "magnet",
    "machine": "mass",
    "classes": ["law"],
    "accepted": [],
    "place": "x",
    "facts": {},
    "law": None,
    "values": {"k": 240.0, "d": 1.9},
}
CLAIM = {
    "verdict": "missing physics",
    "found": [{"kind": "law", "place": {"on": "x"}, "probability": 0.9}],
}
Study = Mapping[str, ModuleType]

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="limits of processes are POSIX")


@pytest.fixture(scope="module")
def study() -> Iterator[Study]:
    """The scripts of the board with the bench outside the vocabulary."""
    with scripts("board", NAMES) as found:
        yield {**found, "bench": found["benches"].bench_of("outside")}


@pytest.fixture
def case(study: Study, tmp_path: Path) -> Path:
    """A drawn case of seed 0, a magnet."""
    from draw import folder_of
    from kinds import KINDS
    from shared import seal

    folder: Path = folder_of(KINDS["magnet"], 0, tmp_path / "cases")
    folder.mkdir(parents=True)
    (folder / "model.toml").write_text((STUDIES / "outside/models/mass.toml").read_text())
    rows = "\n".join(f"{i / 100},0,{i % 7}" for i in range(50))
    for name in ("train.csv", "holdout.csv"):
        (folder / name).write_text(f"t,f,pos_x\n{rows}\n")
    (folder / "sealed.json").write_text(seal(SEALED), encoding="ascii")
    return folder


def entry(folder: Path, text: str, **keys: Any) -> Path:
    """A TOML with one method ``mine`` that runs a script."""
    folder.mkdir(exist_ok=True)
    (folder / "mine.py").write_text(
        "import sys, os, json, time\ncase, answer = sys.argv[1:]\n" + text
    )
    more = "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())
    command = '["{python}", "{here}/mine.py", "{case}", "{answer}"]'
    file = folder / "mine.toml"
    file.write_text(f"[methods.mine]\ncommand = {command}\n{more}")
    return file


def answered(study: Study, tmp_path: Path, file: Path, name: str = "mine") -> dict[str, Any]:
    """The kept answer of a method after a run of the board."""
    argv = ["board.py", "--seeds", "0", "--kinds", "magnet", "--entry", str(file)]
    argv += ["-o", str(tmp_path / "cases"), "--results", str(tmp_path / "kept"), "--methods", name]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", argv)
        study["board"].main()
    (kept,) = (tmp_path / "kept" / study["methods"].folder_name(name)).glob("*mass.json")
    found: dict[str, Any] = json.loads(kept.read_text())
    return found


WRITE = "open(answer + '/diagnosis.json', 'w').write({!r})\n"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("sys.exit(3)", "ended with status 3"),
        ("sys.exit('no idea')", "ended with status 1: no idea"),
        ("pass", "there is no diagnosis.json"),
        (WRITE.format("\0\1garbage"), "diagnosis.json is no JSON"),
        (WRITE.format('{"verdict": "undecided", "found": [NaN]}'), "NaN is no number of JSON"),
        (WRITE.format("[" * 100_000), "diagnosis.json is no JSON"),
        (WRITE.format("[]"), "holds no object"),
        (WRITE.format('{"verdict": "sure"}'), "verdict is 'sure', not one of"),
        ("os.symlink(case + '/model.toml', answer + '/diagnosis.json')", "no ordinary file"),
        ("os.mkfifo(answer + '/diagnosis.json')", "no ordinary file"),
        ("os.mkdir(answer + '/diagnosis.json')", "no ordinary file"),
        (WRITE.format(" " * (5 * 2**20)), "at most 4194304 are read"),
        ("open(answer + '/x', 'wb').truncate(10**9)", "ended with s"),
        ("bytearray(10**9)", "MemoryError"),
        ("os.fork() or time.sleep(60); time.sleep(60)", "stopped after 1 s"),
    ],
    ids=range(15),
)
def test_a_hostile_entry_is_a_failure_with_a_reason(
    study: Study, case: Path, tmp_path: Path, text: str, reason: str
) -> None:
    begin = time.monotonic()
    file = entry(tmp_path / "entry", text, seconds=1 if "sleep" in text else 20, memory_mb=500)
    result = answered(study, tmp_path, file)
    assert reason in result["crash"]
    assert "diagnosis" not in result
    assert time.monotonic() - begin < 20
    (line,) = json.loads((tmp_path / "kept" / "board.json").read_text())["lines"]["mine"]
    assert (line["outcome"], line["reason"]) == ("failed", result["crash"])


def test_what_an_entry_leaves_running_is_ended(study: Study, case: Path, tmp_path: Path) -> None:
    pid = tmp_path / "pid"
    leave = f"if os.fork() == 0: open({str(pid)!r}, 'w').write(str(os.getpid())); time.sleep(60)\n"
    wait = f"while not os.path.exists({str(pid)!r}): time.sleep(0.01)\n"
    answered(study, tmp_path, entry(tmp_path / "entry", leave + wait))
    status = Path(f"/proc/{pid.read_text()}/stat")
    for _ in range(100):
        if not status.exists() or status.read_text().split(") ")[1][0] == "Z":
            return
        time.sleep(0.02)
    pytest.fail("it is still running")


def test_an_entry_sees_model_and_training_alone(study: Study, case: Path, tmp_path: Path) -> None:
    """Neither its folder nor, where the system can hide it, that of the cases has a seal."""
    seen = "".join(
        f"said.append(sorted(os.listdir({place})))\n"
        for place in ("case", "case + '/..'", repr(str(tmp_path / "cases")))
    )
    whole = "json.dumps({'verdict': 'undecided', 'sentence': json.dumps([said, dict(os.environ)])})"
    text = f"said = []\n{seen}open(answer + '/diagnosis.json', 'w').write({whole})"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("A_KEY_OF_THE_WORKPLACE", "secret")
        result = answered(study, tmp_path, entry(tmp_path / "entry", text))
    (own, above, cases), environment = json.loads(result["diagnosis"]["sentence"])
    assert own == ["model.toml", "train.csv"]
    assert above == ["answer", "case", "stderr.txt"]
    assert "A_KEY_OF_THE_WORKPLACE" not in environment
    assert case.name not in json.dumps(environment)
    assert (case / "sealed.json").exists()
    if not result["hidden"]:
        pytest.skip("this system lets no process have a file system of its own")
    assert cases == []


def test_no_seal_is_opened_before_the_last_answer(
    study: Study, case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = []

    def unseal(path: Path) -> dict[str, Any]:
        opened.append(len(list((tmp_path / "kept").glob("*/*mass.json"))))
        return SEALED

    monkeypatch.setattr(study["board"], "unseal", unseal)
    file = entry(tmp_path / "entry", WRITE.format(json.dumps(CLAIM)))
    file.write_text(file.read_text() + file.read_text().replace("mine]", "second]"))
    argv = ["board.py", "--seeds", "0", "--kinds", "magnet", "--methods", "mine,second"]
    argv += ["-o", str(tmp_path / "cases"), "--results", str(tmp_path / "kept")]
    monkeypatch.setattr("sys.argv", [*argv, "--entry", str(file), "--workers", "2"])
    study["board"].main()
    assert opened == [2, 2]


def test_an_answer_is_asked_for_once(study: Study, case: Path, tmp_path: Path) -> None:
    file = entry(tmp_path / "entry", WRITE.format(json.dumps(CLAIM)))
    answered(study, tmp_path, file)
    (kept,) = (tmp_path / "kept" / "mine").glob("*mass.json")
    before = kept.stat().st_mtime_ns
    (tmp_path / "entry" / "mine.py").write_text("raise SystemExit(1)")
    assert "diagnosis" in answered(study, tmp_path, file)
    assert kept.stat().st_mtime_ns == before
    file.write_text(file.read_text().replace("{answer}", "{answer}/"))
    with pytest.raises(SystemExit, match="written by another command of 'mine'"):
        answered(study, tmp_path, file)


def test_the_entry_of_the_readme_is_scored(study: Study, case: Path, tmp_path: Path) -> None:
    """A stranger has nothing but the page."""
    blocks = re.findall(r"```(toml|python)\n(.*?)```", README.read_text(encoding="utf-8"), re.S)
    texts = dict(blocks)
    folder = tmp_path / "stranger"
    folder.mkdir()
    (folder / "entry.py").write_text(texts["python"])
    (folder / "entry.toml").write_text(texts["toml"])
    name = next(iter(study["methods"].read([folder / "entry.toml"])))
    result = answered(study, tmp_path, folder / "entry.toml", name)
    assert result["diagnosis"]["verdict"] == "missing physics"
    (line,) = json.loads((tmp_path / "kept" / "board.json").read_text())["lines"][name]
    assert (line["outcome"], line["placed"]) == ("wrong", 1)
    assert f"| {name} | 1 | 0 | 0 | 1 (≤ 100%) |" in (tmp_path / "kept" / "board.md").read_text()


def test_a_corrected_model_is_run_apart_and_an_unchanged_one_once(
    study: Study, case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The run itself is a stand-in: it counts, and answers by what it was given."""
    judge, count = tmp_path / "judge.py", tmp_path / "entry" / "count"
    judge.write_text(
        "import json, os, sys\ncase, corrected, out = sys.argv[1:]\n"
        "assert sorted(os.listdir(case)) == ['holdout.csv', 'model.toml', 'train.csv']\n"
        f"open({str(count)!r}, 'a').write('x')\n"
        "beside = 'weights.npz' in os.listdir(os.path.dirname(corrected))\n"
        "open(out, 'w').write(json.dumps({'before': 0.1, 'after': 0.01 if beside else 0.1}))\n"
    )
    monkeypatch.setattr(study["board"], "UNSEEN", judge)
    said = WRITE.format(json.dumps({"verdict": "nothing missing"}))
    copy = "import shutil; shutil.copy(case + '/model.toml', answer + '/corrected.toml')\n"
    more = "open(answer + '/corrected.toml', 'a').write('# more')\n"
    weights = "open(answer + '/weights.npz', 'w').write('w')\n"
    for name, text, after, runs in (
        ("changed", said + copy + more + weights, 0.01, 1),
        ("same", said + copy, 0.1, 2),
        ("again", said + copy, 0.1, 2),
        ("none", said, None, 2),
    ):
        file = entry(tmp_path / "entry", text)
        file.write_text(file.read_text().replace("mine]", f"{name}]"))
        answered(study, tmp_path, file, name)
        (line,) = json.loads((tmp_path / "kept" / "board.json").read_text())["lines"][name]
        assert line["unseen"] == (None if after is None else [0.1, after])
        assert len(count.read_text()) == runs


def test_fresh_seeds_stay_those_of_the_folder(study: Study, tmp_path: Path) -> None:
    board, bench = study["board"], study["bench"]
    options = board.argparse.Namespace(fresh=5, seeds=[], results=tmp_path)
    first = board.seeds_asked(options, bench)
    assert len(set(first)) == 5
    assert all(bench.SEEDS[0] <= seed <= bench.SEEDS[1] for seed in first)
    assert board.seeds_asked(options, bench) == first


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "give either --seeds or --fresh"),
        (["--seeds", "0", "--fresh", "2"], "give either --seeds or --fresh"),
        (["--fresh", "1000000"], "--fresh 1000000: there are no more than"),
    ],
)
def test_options_that_say_nothing_are_refused(
    study: Study, tmp_path: Path, options: list[str], said: str
) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["board.py", *options, "--results", str(tmp_path)])
        with pytest.raises(SystemExit, match=said):
            study["board"].main()
        for wrong in (["--seeds", "a-b"], ["--seeds", "1", "--limit", "0"]):
            patch.setattr("sys.argv", ["board.py", *wrong])
            with pytest.raises(SystemExit) as raised:
                study["board"].main()
            assert raised.value.code == 2


def test_all_that_is_wrong_with_entries_is_said_at_once(study: Study, tmp_path: Path) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text(
        "[methods.symhyb]\ncommand = ['x', '{case}', '{answer}']\n"
        "[methods.'PySINDy laws']\ncommand = ['x', '{case}', '{answer}']\n"
        "[methods.'../up']\ncommand = ['x', '{case}', '{answer}']\n"
        "[methods.shell]\ncommand = 'rm -rf {case}'\n"
        "[methods.b]\ncommand = ['x', '{seal}']\nseconds = inf\nspeed = 1\n"
    )
    with pytest.raises(SystemExit) as raised:
        study["methods"].read([study["methods"].OURS, file, tmp_path / "absent.toml"])
    said = str(raised.value)
    for part in (
        "[methods.symhyb]: the name is taken",
        "[methods.../up]: a name has",
        "[methods.PySINDy laws]: the name is taken",
        "[methods.shell]: command = 'rm -rf {case}': give a list",
        "unknown placeholder {seal}",
        "command has no {case}",
        "seconds = inf",
        "unknown key 'speed'",
        "absent.toml",
    ):
        assert part in said
    with pytest.raises(SystemExit, match="no method nobody; there are symhyb"):
        study["methods"].chosen(study["methods"].read([study["methods"].OURS]), "nobody")


def test_our_methods_are_read(study: Study) -> None:
    known = study["methods"].read([study["methods"].OURS])
    chosen = study["methods"].chosen(known, "PySINDy-laws,network")
    assert [one.name for one in chosen] == ["PySINDy, laws", "network"]
    for one in known.values():
        assert Path(one.command[1]).is_file()
        assert "{case}" not in one.on(Path("/c"), Path("/a"))


def read(study: Study, folder: Path, **answer: Any) -> Any:
    """The answer that is read from one."""
    (folder / "diagnosis.json").write_text(json.dumps(answer))
    return study["answers"].read(folder / "diagnosis.json")


def test_every_wrong_number_and_name_of_an_answer_is_said(study: Study, tmp_path: Path) -> None:
    found = {"kind": "x" * 300, "place": {"on": ["a"]}, "parameters": {"k": {"value": 10**400}}}
    with pytest.raises(study["answers"].AnswerError) as raised:
        read(study, tmp_path, verdict="parameters", found=[found], classes={}, courses=[1])
    said = str(raised.value)
    for part in ("found[0].kind", "found[0].parameters.k.value", ".k.sd", "found[0].place"):
        assert part in said
    classes = [{"kind": "law", "place": {"on": "x"}, "probability": 1.5}]
    with pytest.raises(study["answers"].AnswerError, match=r"probability is '1\.5'"):
        read(study, tmp_path, verdict="undecided", classes=classes)


def test_an_answer_claims_nothing_by_a_verdict_or_deviation_that_claims_nothing(
    study: Study, tmp_path: Path
) -> None:
    """Else a list of all causes, each with an infinite deviation, would never be wrong."""

    def found(sd: float) -> list[dict[str, Any]]:
        number = {"k": {"value": 1.0, "sd": sd}}
        return [{"kind": "spring", "place": {"on": "x"}, "parameters": number}]

    faults = [{"channel": "f", "kind": "gain", "value": 1.1, "sd": sd} for sd in (0.01, 0.1)]
    said = read(study, tmp_path, verdict="undecided", found=found(0.1), measurement=faults)
    assert (said["found"], said["measurement"]) == ([], [])
    said = read(study, tmp_path, verdict="measurement", found=found(1e300), measurement=faults)
    assert (said["found"], said["measurement"]) == ([], faults[:1])
    assert read(study, tmp_path, verdict="parameters", found=found(0.1))["found"]


def test_a_line_counts_classes_numbers_and_probabilities(study: Study, tmp_path: Path) -> None:
    drawn = study["benches"].Drawn("0000-x-mass", tmp_path)

    def line(sealed: dict[str, Any], **said: Any) -> Any:
        empty = {"found": [], "parameters": [], "measurement": [], "classes": [], "sentence": ""}
        return study["bench"].line(drawn, {"diagnosis": {**empty, **said}}, {**SEALED, **sealed})

    classes = [{"kind": "law", "place": {"on": "x"}, "probability": 0.8}]
    right = line({}, verdict="undecided", classes=classes)
    assert (right.outcome, right.placed, right.named, right.stated) == (
        "right",
        1,
        1,
        ((0.8, True),),
    )
    for sd, covered in ((0.1, 1), (0.01, 0)):
        faults = [{"channel": "f", "kind": "dead_band", "value": 0.45, "sd": sd}]
        kind = {"classes": ["input"], "accepted": ["dead_band"], "place": "f"}
        sealed = {**kind, "facts": {"band": 0.48}}
        named = line(sealed, verdict="missing physics", measurement=faults)
        assert (named.counted, named.covered) == (1, covered)
    nothing = line({"classes": ["noise"]}, verdict="nothing missing")
    assert (nothing.outcome, nothing.wanted, nothing.complete) == ("right", 0, True)


def test_the_table_has_exact_bounds_and_no_words_of_the_wordless(study: Study) -> None:
    line = study["lines"].Line
    lines = [
        line(
            "a", "magnet", "right", 1, 1, 1, True, (), 2, 2, ((0.9, True),), (0.1, 0.01), 2.0, 1.0
        ),
        line("b", "magnet", "wrong", 1, 1, 0, False, ("w",), 0, 0, ((0.7, False),), (0.1, None)),
        line("c", "noise", "right", 0, unseen=(0.01, 0.005)),
    ]
    text = study["lines"].table({"one": lines, "mute": lines}, ["mute"])
    acts, nothing = text.split("**Nothing acts**")
    assert (
        "| one | 2 | 1 | 0 | 1 (≤ 97%) | 0 | 0 | 0 | 2 of 2 | 1 of 2 | 2 of 2 | 80%, 50% (2) "
        "| 1 of 2 | 1 of 2 | 0.5 |"
    ) in acts
    assert "| mute | 2 | – | – | – | – | – | 0 | – | – | – | – | 1 of 2 | 1 of 2 | 0.5 |" in acts
    assert "| one | 1 | 1 | 0 | 0 (≤ 95%) |" in nothing

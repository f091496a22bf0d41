"""The frozen set: its list follows its rule, its runs resume, its scores are right."""

import base64
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from tests.scripts import scripts

NAMES = ("cases", "run", "scoring", "compare")
FAKE = """\
import json, pathlib, sys
folder = pathlib.Path(sys.argv[sys.argv.index("-o") + 1])
if sys.argv[1] == "run":
    print("study.toml: no such file", file=sys.stderr)
    raise SystemExit(2)
if "00003" in sys.argv[2]:
    raise ValueError("shapes differ")
folder.mkdir()
said = {"verdict": "nothing missing", "found": [], "parameters": [], "measurement": []}
(folder / "diagnosis.json").write_text(json.dumps({**said, "alternatives": []}))
"""


@pytest.fixture(scope="module")
def study() -> Iterator[Mapping[str, ModuleType]]:
    """The modules of the set, which are scripts beside each other."""
    with scripts("frozen", NAMES) as found:
        yield found


def seal(**values: Any) -> str:
    """An answer as it lies beside a recording."""
    return json.dumps(
        {k: base64.b64encode(json.dumps(v).encode()).decode() for k, v in values.items()}
    )


@pytest.fixture
def drawn(study: Mapping[str, ModuleType], tmp_path: Path) -> Path:
    """A folder in which the first small cases lie drawn: drag is concealed in the even one."""
    effect = {"kind": "drag", "place": "x", "side": "both", "keys": {"drag": 0.8}, "share": 0.1}
    for name in ("00001-oscillator", "00002-duffing", "00003-duffing"):
        folder = tmp_path / "drawn" / name
        folder.mkdir(parents=True)
        effects = [] if name.startswith(("00001", "00003")) else [effect]
        plain = {"kind": "drag", "noise": 0.01, "parameters": {}, "faults": [], "rivals": []}
        (folder / "sealed.json").write_text(seal(effects=effects, **plain))
        (folder / "train.csv").touch()
    return tmp_path / "drawn"


def package(root: Path, code: str = FAKE) -> Path:
    """A checkout whose symhyb is ``code``."""
    (root / "symhyb").mkdir(parents=True)
    (root / "symhyb" / "__init__.py").touch()
    (root / "symhyb" / "__main__.py").write_text(code)
    return root


def diagnosis(
    *found: tuple[str, Any, dict[str, tuple[float, float]]], **more: Any
) -> dict[str, Any]:
    """What is reported of a case: kind, place, and value and sd by term of every found element."""
    elements = [
        {
            "kind": kind,
            "place": {"on": place} if isinstance(place, str) else {"between": place},
            "parameters": {k: {"term": k, "value": v, "sd": sd} for k, (v, sd) in terms.items()},
        }
        for kind, place, terms in found
    ]
    reported = {
        "verdict": "missing physics",
        "found": elements,
        "parameters": [],
        "measurement": [],
    }
    reported |= {"alternatives": [], **more}
    return {"commit": "abc", "code": "1", "seconds": 2.0, "cpu_seconds": 1.5, "diagnosis": reported}


def test_the_list_is_what_the_rule_gives(study: Mapping[str, ModuleType]) -> None:
    cases = study["cases"]
    listed = cases.listed()
    assert [c.seed for c in listed if c.seed is not None] == sorted(cases.chosen(cases.given_up()))
    assert max(c.seed for c in listed if c.seed is not None) < cases.FIRST_UNUSED
    groups = [case.group for case in listed]
    assert (groups.count("concealed"), groups.count("null")) == (54, 20)
    assert len({case.name for case in listed}) == len(listed)
    for case in listed:
        assert [case.seed is not None, bool(case.study), bool(case.example)].count(True) == 1
        if case.study:
            assert (cases.ROOT / "studies" / case.study / "expected.json").is_file()
    assert 20 <= sum(case.quick for case in listed) <= 28


def test_a_seed_without_a_draw_is_replaced_by_another(study: Mapping[str, ModuleType]) -> None:
    chosen, gone = study["cases"].chosen, study["cases"].given_up()
    assert gone
    for i, seed in enumerate(gone):  # the rule asked for it, with those before it given up
        assert seed in set(chosen(gone[:i]))
    whole, less = list(chosen(())), list(chosen((0,)))
    assert 0 in whole
    assert 0 not in less
    assert len(less) == len(whole)


def test_cases_without_their_recordings_are_skipped_in_a_sentence(
    study: Mapping[str, ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cases = study["cases"]
    monkeypatch.delenv("SYMHYB_DATA", raising=False)
    monkeypatch.delenv("SYMHYB_EXAMPLES", raising=False)
    said = {case.name: cases.missing(case) for case in cases.listed()}
    assert said["emps"] == (
        "skipped: SYMHYB_DATA does not name the folder of the public recordings"
    )
    assert said["example_cartpole"].startswith("skipped: SYMHYB_EXAMPLES does not name")
    assert said["oscillator"] == said["00000-oscillator"] == ""
    monkeypatch.setenv("SYMHYB_EXAMPLES", str(tmp_path))
    case = next(case for case in cases.listed() if case.name == "example_cartpole")
    assert cases.missing(case) == f"skipped: {tmp_path} holds no cartpole/truth.json"


def test_a_run_keeps_what_another_package_says_and_resumes(
    study: Mapping[str, ModuleType], drawn: Path, tmp_path: Path
) -> None:
    run = study["run"]
    other = run.package_at(package(tmp_path / "other"))
    results = tmp_path / "results"
    results.mkdir()
    names = "00002-duffing,00003-duffing,oscillator"
    cases = run.wanted(names, quick=False)
    assert [case.name for case in cases] == names.split(",")
    cache = run.warm(other, results, drawn)
    words = [run.one(case, other, results, drawn, cache) for case in cases]
    assert words[0].startswith("00002-duffing: nothing missing, ")
    kept = {case.name: json.loads((results / f"{case.name}.json").read_text()) for case in cases}
    assert kept["00002-duffing"]["status"] == 0
    assert kept["00002-duffing"]["cpu_seconds"] > 0
    assert "shapes differ" in kept["00003-duffing"]["crash"]
    assert kept["oscillator"]["sentence"] == "study.toml: no such file"
    assert run.waiting(cases, other, results, again=False) == []
    assert run.waiting(cases, other, results, again=True) == cases
    changed = run.package_at(package(tmp_path / "changed", FAKE + "# other\n"))
    with pytest.raises(SystemExit, match="holds results of other code"):
        run.waiting(cases, changed, results, again=False)
    rows = study["compare"].outcomes(results, drawn)
    assert [row.verdict for row in rows.values()] == ["nothing missing", "crash", "refused"]
    assert [row.refused for row in rows.values()] == [True, True, True]


def test_a_case_that_does_not_end_is_stopped(
    study: Mapping[str, ModuleType], drawn: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = study["run"]
    monkeypatch.setattr(run, "LIMIT_S", 0.5)
    slow = run.package_at(package(tmp_path / "slow", "import time\ntime.sleep(60)\n"))
    (case,) = run.wanted("00002-duffing", quick=False)
    (tmp_path / "cache").mkdir()
    reported = run.diagnose(case, slow, drawn, tmp_path / "cache")
    assert reported["crash"] == "not done after 0.5 s"
    assert reported["seconds"] < 20


def test_mistakes_are_reported_in_a_sentence(
    study: Mapping[str, ModuleType], tmp_path: Path
) -> None:
    with pytest.raises(SystemExit, match=r"no such case in cases\.toml: emsp"):
        study["run"].wanted("emps,emsp", quick=False)
    with pytest.raises(SystemExit, match="holds no folder symhyb"):
        study["run"].package_at(tmp_path)
    with pytest.raises(SystemExit, match="holds no results"):
        study["compare"].outcomes(tmp_path)


def scored(study: Mapping[str, ModuleType], name: str, reported: dict[str, Any]) -> Any:
    """The outcome of a listed case."""
    case = next(case for case in study["cases"].listed() if case.name == name)
    return study["scoring"].outcome(case, reported, Path())


def test_a_study_is_scored_by_its_expected_terms(study: Mapping[str, ModuleType]) -> None:
    rubbing = ("friction", "x", {"coulomb": (20.4, 0.1)})
    damper = ("damper", "x", {"damping": (203.0, 1.0)})
    push = ("constant", "x", {"constant": (2.0, 0.1)})
    row = scored(study, "emps", diagnosis(rubbing, damper, push))
    assert (row.wanted, row.named, row.complete, row.wrong) == (3, 3, True, ())
    assert (row.right, row.counted, row.cpu) == (2, 3, 1.5)
    more = scored(study, "emps", diagnosis(rubbing, damper, ("drag", "x", {"drag": (1.0, 0.1)})))
    assert (more.named, more.complete, more.wrong) == (2, False, ("drag @ x",))
    breaking = ("friction", "x", {"coulomb": (20.4, 0.1), "static": (30.0, 1.0)})
    shaped = scored(study, "emps", diagnosis(breaking, damper, push))
    assert (shaped.named, shaped.complete, shaped.wrong) == (3, False, ())


def test_one_of_several_expectations_is_enough(study: Mapping[str, ModuleType]) -> None:
    swing = ("friction", "phi", {"coulomb": (5.09e-4, 1e-6)})
    drag = ("drag", "phi", {"drag": (1.434e-5, 1e-7)})
    inertia = [{"name": "J", "value": 1.17e-4, "sd": 1e-7}]
    with_it = diagnosis(swing, drag, parameters=inertia)
    assert scored(study, "pendulum_single", with_it).wanted == 3
    assert scored(study, "pendulum_single", with_it).complete
    without = diagnosis(swing, drag)
    assert scored(study, "pendulum_single", without).complete
    assert scored(study, "oscillator", diagnosis()).wanted == 2
    assert not scored(study, "null", diagnosis()).complete  # the verdict has to be right too
    assert scored(study, "null", diagnosis(verdict="nothing missing")).complete


def test_an_example_is_scored_by_its_truth(
    study: Mapping[str, ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SYMHYB_EXAMPLES", str(tmp_path))
    (tmp_path / "quarter_car").mkdir()
    truth = {"found": {"hub~top.coulomb": 60.0, "s.damping": [900.0, 2300.0], "a~b": "some play"}}
    truth["parameters"] = {"k_s": 21.5}
    (tmp_path / "quarter_car" / "truth.json").write_text(json.dumps(truth))
    reported = diagnosis(
        ("friction", ["top", "hub"], {"coulomb": (61.0, 1.0)}),
        ("damper", "s", {"damping": (1600.0, 10.0)}),
        ("hysteresis", ["a", "b"], {"play": (0.1, 0.01)}),
        parameters=[{"name": "k_s", "value": 21.4, "sd": 0.01}],
    )
    row = scored(study, "example_quarter_car", reported)
    assert (row.wanted, row.named, row.complete) == (4, 4, True)
    assert (row.right, row.counted) == (1, 2)


def test_two_runs_are_compared_over_their_common_cases(study: Mapping[str, ModuleType]) -> None:
    compare, Outcome = study["compare"], study["scoring"].Outcome
    good = Outcome("a", "concealed", "abc", "missing physics", 2, 2, True, (), 3, 4, 4.0)
    wrong = Outcome(
        "a", "concealed", "def", "missing physics", 2, 1, False, ("drag @ x",), 1, 1, 4.0
    )
    null = Outcome("b", "null", "abc", "nothing missing", complete=True, cpu=2.0)
    slow = Outcome("b", "null", "def", "nothing missing", complete=True, cpu=8.0)
    text = compare.report(
        ["before", "after"], [{"a": good, "b": null, "c": null}, {"a": wrong, "b": slow}]
    )
    assert "before: commit abc\nafter: commit def" in text
    assert "| named | 2 of 2 | 1 of 2 |" in text
    assert "| with a wrong claim | 0 of 1 | 1 of 1 |" in text
    assert "| values right | 3 of 4 | 1 of 1 |" in text
    assert "| time computed, median | 2.0 s | 8.0 s |" in text
    assert "Changed outcomes: 1 of 2\n- a\n" in text
    assert "is:  missing physics; named 1 of 2; wrong drag @ x; values 1 of 1" in text
    assert "Much slower: 1\n- b: 2.0 s, now 8.0 s\nonly in before: c" in text
    with pytest.raises(SystemExit, match="no case in common"):
        compare.report(["before", "after"], [{"a": good}, {"b": slow}])

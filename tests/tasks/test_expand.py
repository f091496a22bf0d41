"""The tasks of a sweep: every combination, each with a key of what goes into it."""

from dataclasses import replace
from pathlib import Path

import pytest
from sweeps import SWEEP, write_sweep

from symhyb.errors import InputError
from symhyb.study.file import read_study
from symhyb.study.sweep import Noise, Subsets, Sweep
from symhyb.tasks import keys
from symhyb.tasks.expand import Task, chosen, tasks_of

PLAIN = SWEEP.partition("[sweep]")[0]


def tasks(folder: Path, text: str = SWEEP, recordings: int = 3) -> tuple[Task, ...]:
    return tasks_of(read_study(write_sweep(folder, text, recordings, samples=0)))


def problems(folder: Path, text: str, recordings: int = 3) -> list[str]:
    with pytest.raises(InputError) as caught:
        tasks(folder, text, recordings)
    return [str(one) for one in caught.value.problems]


def test_each_recording_meets_each_noise(tmp_path: Path) -> None:
    found = tasks(tmp_path)
    assert [one.name for one in found] == [
        f"recordings=r{i}.csv, noise={level}" for i in range(3) for level in ("0.0", "0.001")
    ]
    assert [one.study.noise for one in found[:2]] == [None, Noise(0.001)]
    assert all(one.study.sweep is None and len(one.study.train) == 1 for one in found)
    assert len({one.key for one in found}) == 6


def test_a_study_without_a_sweep_is_one_task(tmp_path: Path) -> None:
    (one,) = tasks(tmp_path, PLAIN)
    assert (one.name, one.settings, len(one.study.train)) == ("study", (), 3)


def test_a_grid_of_values_and_models(tmp_path: Path) -> None:
    write_sweep(tmp_path, samples=0)
    text = (tmp_path / "model.toml").read_text().replace("0.6", "0.7")
    (tmp_path / "other.toml").write_text(text)
    grid = '[sweep]\nmodels = ["model.toml", "other.toml"]\n[sweep.values]\nm = [1, 2]\nd = [0.5]\n'
    plain = PLAIN.replace('model = "model.toml"', "values = { k = 30, d = 9 }")
    found = tasks(tmp_path, plain + grid)
    assert [one.name for one in found] == [
        f"model={model}, values.m={m}, values.d=0.5"
        for model in ("model.toml", "other.toml")
        for m in ("1.0", "2.0")
    ]
    assert found[1].study.values == (("k", 30.0), ("d", 0.5), ("m", 2.0))
    assert found[2].study.model == tmp_path / "other.toml"


def test_groups_and_options(tmp_path: Path) -> None:
    (tmp_path / "list.csv").write_text(
        "file,groups.mount\nr0.csv,light\nr1.csv,heavy\nr2.csv,light\n"
    )
    text = PLAIN.replace('files = "r*.csv"', 'table = "list.csv"') + (
        '[sweep]\neach = "mount"\n[[sweep.options]]\nname = "own"\nown = ["d"]\n'
        '[[sweep.options]]\nname = "plain"\n'
    )
    found = tasks(tmp_path, text)
    assert [one.name for one in found] == [
        f"recordings={by}, options={name}" for by in ("light", "heavy") for name in ("own", "plain")
    ]
    assert [[s.name for s in one.study.train] for one in found[::2]] == [
        ["r0.csv", "r2.csv"],
        ["r1.csv"],
    ]
    assert [dict(one.study.own) for one in found[:2]] == [{"d": ""}, {}]


def test_random_subsets_differ_and_follow_from_the_seed(tmp_path: Path) -> None:
    study = read_study(write_sweep(tmp_path, PLAIN, 6, samples=0))

    def drawn(seed: int, count: int = 15) -> list[tuple[str, ...]]:
        swept = replace(study, sweep=Sweep(subsets=Subsets(4, count, seed)))
        return [tuple(one.name for one in task.study.train) for task in tasks_of(swept)]

    first = drawn(1)
    assert len(set(first)) == 15  # as many as there are
    assert all(len(part) == 4 and list(part) == sorted(part) for part in first)
    assert first == drawn(1)
    assert drawn(1, 5) == first[:5]
    assert drawn(2, 5) != first[:5]
    swept = replace(study, sweep=Sweep(subsets=Subsets(4, 16)))
    with pytest.raises(InputError, match="16 different subsets of 4 are wanted, but 6"):
        tasks_of(swept)


def test_stretches_of_one_file_have_names_of_their_own(tmp_path: Path) -> None:
    text = PLAIN.replace('files = "r*.csv"', 'file = "r0.csv"\nspan = [0, 3]')
    text += '[[train]]\nfile = "r0.csv"\nspan = [3, 6.5]\n[sweep]\neach = "recording"\n'
    names = [one.name for one in tasks(tmp_path, text)]
    assert names == ["recordings=r0.csv 0-3 s", "recordings=r0.csv 3-6.5 s"]


def test_the_key_is_that_of_what_goes_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = tasks(tmp_path / "a")
    again = tasks(tmp_path / "b", SWEEP.replace("a mass with friction", "another title"))
    assert [one.key for one in again] == [one.key for one in before]
    (tmp_path / "a" / "r1.csv").write_text("changed\n")
    changed = tasks_of(read_study(tmp_path / "a" / "study.toml"))
    assert [one.key == old.key for one, old in zip(changed, before, strict=True)] == [
        *(True, True, False, False, True, True)
    ]
    model = tmp_path / "b" / "model.toml"
    model.write_text(model.read_text().replace("0.6", "0.61"))
    other = {one.key for one in tasks_of(read_study(tmp_path / "b" / "study.toml"))}
    assert not other & {one.key for one in before}
    monkeypatch.setattr(keys, "__version__", "9.9")
    newer = {one.key for one in tasks(tmp_path / "c")}
    assert not newer & {one.key for one in before}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('files = "r*.csv"', 'files = "r*.csv"\nspan = [0, 9]'),
        ('files = "r*.csv"', 'files = "r*.csv"\nparameters = { d = 1 }'),
        ('files = "r*.csv"', 'files = "r*.csv"\ngroups = { mount = "a" }'),
        ("[[train]]", '[map]\nlaser = "x"\n[[train]]'),
        ("[[train]]", 'own = ["d"]\n[[train]]'),
        ("[[train]]", "values = { m = 2 }\n[[train]]"),
        ("[[train]]", 'budget = "9min"\n[[train]]'),
        ("[[train]]", "[finish]\nvalues = true\n[[train]]"),
        ("[[train]]", "[score]\nwindow_s = 1\n[[train]]"),
        ("[sweep]", '[[holdout]]\nfile = "model.toml"\n[sweep]'),
        ("0.001", "0.002"),
    ],
)
def test_whatever_is_said_of_a_task_changes_its_key(tmp_path: Path, old: str, new: str) -> None:
    first, second = tasks(tmp_path), tasks(tmp_path, SWEEP.replace(old, new, 1))
    assert first[1].key != second[1].key


def test_names_that_are_unknown_are_named_at_once(tmp_path: Path) -> None:
    (tmp_path / "list.csv").write_text(
        "file,groups.mount,parameters.mm,parameters.d\nr0.csv,light,1,1\nr1.csv,,1,\nr2.csv,a,1,1\n"
    )
    text = PLAIN.replace('files = "r*.csv"', 'table = "list.csv"')
    text = text.replace("[[train]]", 'own = { d = "mounts" }\nvalues = { c = 1 }\n[[train]]')
    text += '[sweep]\neach = "mount"\n[sweep.values]\nq = [1]\n'
    text += '[[holdout]]\nfile = "r2.csv"\nparameters = { mm = 1, d = 1 }\n'
    said = problems(tmp_path, text)
    for one in (
        "there is no parameter 'c'",
        "there is no parameter 'q'",
        "there is no parameter 'mm' in the model; did you mean 'm'? (of 4 recordings)",
        "parameters.d: is stated of other recordings, but not of 'r1.csv'",
        "own.d: no recording states its 'mounts'; did you mean 'mount'?",
        "sweep.each: 'mount' is not stated of 'r1.csv'",
        "r2.csv: holdout: is a training recording too",
    ):
        assert any(one in other for other in said), (one, said)
    assert len(said) == 7


def test_too_many_tasks_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("symhyb.tasks.expand.STUDY_TASKS", 5)
    assert "6 combinations are more than 5 tasks" in problems(tmp_path, SWEEP)[0]


def test_tasks_are_chosen_by_name_setting_or_key(tmp_path: Path) -> None:
    found = tasks(tmp_path)
    assert chosen(found, ()) == found
    assert chosen(found, ("recordings=r1*",)) == found[2:4]
    assert chosen(found, (found[5].name, found[0].key)) == (found[0], found[5])
    with pytest.raises(InputError, match=r"--only recordings=r7.csv: fits no task; did you mean"):
        chosen(found, ("noise=0.0", "recordings=r7.csv"))

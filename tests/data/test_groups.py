"""Groups of recordings: how they are stated, by hand, in tables and in study files."""

from pathlib import Path

import numpy as np
import pytest

import symhyb as sh
from symhyb.data.group_table import read_groups
from symhyb.data.groups import by_name, require_groups
from symhyb.study.file import read_study
from symhyb.study.run import read_all
from tests.known_weights import BARE

T = np.arange(0, 3, 0.01)


@pytest.fixture
def model() -> sh.Model:
    return sh.parse_model(BARE)


def run(model: sh.Model, name: str, **groups: str) -> sh.Recording:
    frame = {"t": T, "encoder": np.cos(9 * T)}
    return sh.Recording.from_frame(frame, model, name=name, groups=groups)


def test_a_recording_keeps_its_groups_and_says_them(model):
    one = run(model, "a", mount=" light ")
    assert one.groups == {"mount": "light"}
    assert one.crop(0.5, 2).groups == {"mount": "light"}
    assert "of the group mount = light" in one.notes


@pytest.mark.parametrize("label", ["", "  ", 3])
def test_a_label_is_a_text(model, label):
    frame = {"t": T, "encoder": np.cos(9 * T)}
    with pytest.raises(sh.InputError, match=r"groups.mount: must be the name of a group"):
        sh.Recording.from_frame(frame, model, groups={"mount": label})


def test_a_grouping_is_not_called_recording(model):
    with pytest.raises(sh.InputError, match="cannot be called 'recording'"):
        run(model, "a", recording="light")


def test_lists_and_mappings_say_what_is_shared_by_whom():
    assert by_name(["drag"]) == {"drag": ""}
    assert by_name({"drag": "recording", "coulomb": "mount"}) == {"drag": "", "coulomb": "mount"}


def wrong(*recordings: sh.Recording, unseen: tuple[sh.Recording, ...] = ()) -> str:
    with pytest.raises(sh.InputError) as found:
        require_groups(recordings, unseen, {"coulomb": "mount"})
    return str(found.value)


def test_a_misspelt_grouping_is_one_clear_error(model):
    said = wrong(run(model, "a", mont="light"), run(model, "b", mont="heavy"))
    assert "own.coulomb: is shared within groups of 'mount', but no recording states its" in said
    assert "did you mean 'mont'?" in said


def test_every_training_recording_is_of_a_group(model):
    said = wrong(run(model, "a", mount="light"), run(model, "b"), run(model, "c", mount="heavy"))
    assert said.startswith("b: groups.mount: is not stated here")


def test_groups_that_differ_in_case_and_spaces_alone_are_misspelt(model):
    first, second = run(model, "a", mount="Light"), run(model, "b", mount="heavy")
    said = wrong(first, second, unseen=(run(model, "c", mount="li ght"),))
    assert "'Light' and 'li ght' differ in case and spaces alone" in said


def test_one_group_of_all_shares_everything(model):
    assert "leave 'mount' out of own" in wrong(
        run(model, "a", mount="light"), run(model, "b", mount="light")
    )


def test_an_unseen_recording_may_be_of_a_group_that_is_not_known(model):
    known = [run(model, "a", mount="light"), run(model, "b", mount="heavy")]
    require_groups(known, [run(model, "c", mount="other"), run(model, "d")], {"c": "mount"})


def test_a_diagnosis_refuses_groups_that_are_not_stated(model):
    with pytest.raises(sh.InputError, match="no recording states its 'mount'"):
        sh.diagnose(model, run(model, "a"), own={"coulomb": "mount"})


def written(folder: Path, text: str) -> Path:
    file = folder / "groups.csv"
    file.write_text(text, encoding="utf-8")
    return file


def test_a_table_has_the_groups_of_recordings(tmp_path):
    table = read_groups(written(tmp_path, "recording;mount;day\na.csv;light;1\nb.csv;heavy;\n"))
    assert table.of("runs/a.csv") == {"mount": "light", "day": "1"}
    assert table.of("b.csv") == {"mount": "heavy"}
    with pytest.raises(sh.InputError, match=r"has no row for the recording 'c.csv'"):
        table.of("c.csv")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("recording,mount\n", "needs a header and a row"),
        ("name,mount\na.csv,x\n", "a column 'recording' with the names"),
        ("recording\na.csv\n", "has no column of a grouping"),
        ("recording,mount,mount\na.csv,x,y\n", "mount: has two columns"),
        ("recording,mount\na.csv,x\na.csv,y\n", "'a.csv' has a row already"),
        ("recording,mount\n,x\n", "names no recording"),
        ("recording,mount\na.csv,x,y\n", "has 3 cells below a header of 2"),
    ],
)
def test_what_is_wrong_with_a_table_is_said(tmp_path, text, said):
    with pytest.raises(sh.InputError, match=said):
        read_groups(written(tmp_path, text))


STUDY = """
symhyb = 1
model = "bare.toml"
own = OWN

[[train]]
file = "a.csv"
groups = { mount = "light" }

[[train]]
file = "b.csv"
groups = { mount = "heavy" }
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "bare.toml").write_text(BARE, encoding="utf-8")
    for name, rate in (("a.csv", 9), ("b.csv", 7)):
        rows = [f"{t:.2f},{np.cos(rate * t):.6f}" for t in T]
        (tmp_path / name).write_text("\n".join(["t,encoder", *rows]), encoding="utf-8")
    return tmp_path


def study_of(folder: Path, own: str) -> Path:
    file = folder / "study.toml"
    file.write_text(STUDY.replace("OWN", own), encoding="utf-8")
    return file


def test_a_study_states_groups_and_what_they_share(folder):
    study = read_study(study_of(folder, '{ coulomb = "mount", drag = "recording" }'))
    assert study.own == {"coulomb": "mount", "drag": ""}
    assert study.stated_own == {"coulomb": "mount", "drag": "recording"}
    train, _ = read_all(study, sh.read_model(folder / "bare.toml"))
    assert [one.groups["mount"] for one in train] == ["light", "heavy"]
    assert read_study(study_of(folder, '["drag"]')).stated_own == ["drag"]


def test_a_study_with_a_misspelt_grouping_is_refused(folder):
    study = read_study(study_of(folder, '{ coulomb = "mounts" }'))
    with pytest.raises(sh.InputError, match="did you mean 'mount'"):
        read_all(study, sh.read_model(folder / "bare.toml"))


@pytest.mark.parametrize("own", ["3", '["m", 3]', "{ coulomb = 3 }"])
def test_what_own_must_be_is_said(folder, own):
    with pytest.raises(sh.InputError, match="within which groups each is shared"):
        read_study(study_of(folder, own))

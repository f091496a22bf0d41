"""Our entries of the board, and how the bench of concealed effects scores answers on it."""

import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import symhyb as sh
from tests.concealed_bench import answer_of, reported
from tests.scripts import STUDIES, scripts

ENTRIES = ("common", "with_fit", "with_symbolic", "with_peers")
MASS = STUDIES / "outside" / "models" / "mass.toml"
Study = Mapping[str, ModuleType]


@pytest.fixture(scope="module")
def entries() -> Iterator[Study]:
    """Our entries as modules."""
    with scripts("board/entries", ENTRIES) as found:
        yield found


@pytest.fixture
def concealed() -> Iterator[Study]:
    """The scripts of the board with the bench of concealed effects."""
    with scripts("board", ("benches", "lines", "answers")) as found:
        yield {**found, "bench": found["benches"].bench_of("concealed")}


def test_concealed_cases_are_scored_as_their_bench_does(concealed: Study, tmp_path: Path) -> None:
    drawn = concealed["benches"].Drawn("00002-duffing", tmp_path)

    def line(result: dict[str, Any], **changes: Any) -> Any:
        return concealed["bench"].line(drawn, result, answer_of(**changes))

    hit = reported("drag", "x", "drag", 0.81, 0.01)
    hit["diagnosis"]["found"][0]["probability"] = 0.99
    right = line(hit)
    assert (right.outcome, right.placed, right.named, right.complete) == ("right", 1, 1, True)
    assert (right.covered, right.counted, right.stated) == (1, 1, ((0.99, True),))
    miss = reported("friction", "x", "coulomb", 0.5, 0.1)
    miss["diagnosis"]["found"][0]["probability"] = 0.97
    wrong = line(miss)
    assert (wrong.outcome, wrong.placed, wrong.named) == ("wrong", 1, 0)
    assert wrong.stated == ((0.97, False),)
    silent = {"found": [], "parameters": [], "measurement": [], "alternatives": []}
    for verdict, outcome in (("undecided", "refused"), ("nothing missing", "false nothing")):
        said = {"seconds": 1.0, "diagnosis": {"verdict": verdict, **silent}}
        assert line(said).outcome == outcome
        assert line(said, effects=[]).outcome == "right"
    assert line(hit, parameters={"k": 1.0}).outcome == "in part"
    crash = line({"seconds": 1.0, "crash": "ended with status 3"})
    assert (crash.outcome, crash.reason) == ("failed", "ended with status 3")


def test_concealed_cases_are_drawn_by_seed_and_kind(concealed: Study, tmp_path: Path) -> None:
    from plans import folder_of, plan_of

    for seed in (2, 3):
        folder = folder_of(seed, tmp_path)
        folder.mkdir()
        (folder / "sealed.json").write_text("{}", encoding="ascii")
    gone = folder_of(4, tmp_path)
    gone.mkdir()
    (gone / "discarded.json").write_text("{}", encoding="ascii")
    drawn = concealed["bench"].drawn
    assert [one.name[:5] for one in drawn([2, 3, 4], "", tmp_path)] == ["00002", "00003"]
    kind = plan_of(3).kind
    assert [one.name[:5] for one in drawn([2, 3, 4], kind, tmp_path)] == ["00003"]


def test_numbers_that_stand_for_each_other_are_set_back_one_by_one(entries: Study) -> None:
    """Two shares of one gain: alone each is clear, together none is."""
    asked = []

    def fit(free: list[str]) -> Any:
        asked.append(list(free))
        shared = {"f.gain", "x.gain"} <= set(free)
        sd = {"k": 5.0, "f.gain": 0.2 if shared else 0.01, "x.gain": 0.3 if shared else 0.01}
        value = {"k": 241.0, "f.gain": 1.1, "x.gain": 1.1}
        return SimpleNamespace(
            parameters=[SimpleNamespace(name=n, value=value[n], sd=sd[n]) for n in free]
        )

    neutral = {"k": 240.0, "f.gain": 1.0, "x.gain": 1.0}
    fitted = entries["with_fit"].eliminated(fit, ["k"], neutral)
    assert asked == [["k", "f.gain", "x.gain"], ["k", "f.gain"]]
    said = entries["with_fit"].claims(fitted.parameters, neutral)
    (fault,) = said["measurement"]
    assert (fault["channel"], fault["kind"], fault["value"]) == ("f", "gain", 1.1)
    assert (said["found"], said["parameters"]) == ([], [])


def test_joints_get_damping_friction_and_armature(entries: Study) -> None:
    text = MASS.read_text(encoding="utf-8") + entries["with_fit"].added("x", "m")
    model = sh.parse_model(text)
    assert [one.kind for one in model.elements][-3:] == ["damper", "friction", "added_mass"]
    number = SimpleNamespace(name="joint_added_mass_x.b_", value=0.3, sd=0.01)
    said = entries["with_fit"].claims([number], {number.name: 0.0})
    (found,) = said["found"]
    assert (found["kind"], found["place"]) == ("added_mass", {"on": "x"})
    assert found["parameters"]["mass"]["value"] == 0.3
    assert entries["with_fit"].added("v", "V").strip() == ""


def test_a_program_of_gplearn_is_written_as_a_formula(entries: Study) -> None:
    def node(name: str, arity: int) -> Any:
        return SimpleNamespace(name=name, arity=arity)

    program = [node("add", 2), node("mul", 2), 0, -1.5, node("sin", 1), 1]
    formula = entries["with_symbolic"].written(program)
    assert formula == "((x0 * (-1.5)) + sin(x1))"
    text = MASS.read_text(encoding="utf-8")
    columns = {"x": (2.0, "m"), "x'": (0.5, "m/s"), "f": (3.0, "N")}
    law = entries["with_symbolic"].law("x", "m", formula, 7.0, columns)
    assert "scale_*((((x/size0_) * (-1.5)) + sin((x'/size1_))))" in law
    assert "size2_" not in law
    assert sh.parse_model(text + law).elements[-1].kind == "law"


def test_a_formula_has_to_leave_less_than_nothing_does(entries: Study) -> None:
    random = np.random.default_rng(2)
    force = random.standard_normal(400)
    better = entries["with_symbolic"].better
    assert better(force, 0.5 * force)
    assert not better(force, 1.1 * force)
    assert not better(force, random.permutation(force))


def test_an_absent_package_is_said(
    entries: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(entries["with_symbolic"].importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(sys, "argv", ["with_symbolic.py", str(tmp_path), str(tmp_path), "pysr"])
    with pytest.raises(SystemExit, match="pysr is not installed"):
        entries["with_symbolic"].main()


def test_peers_answer_machines_of_either_bench_alone(
    entries: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    peers = entries["with_peers"]
    for folder in ("concealed", "outside"):
        monkeypatch.syspath_prepend(str(STUDIES / folder))
    text = MASS.read_text(encoding="utf-8")
    assert peers.system_of(text).name == "mass"
    assert (
        peers.system_of((STUDIES / "concealed/models/duffing.toml").read_text()).name == "duffing"
    )
    with pytest.raises(SystemExit, match="no machine whose equations"):
        peers.system_of(text.replace("240.0", "241.0"))
    number = {"value": 0.4, "sd": 0.01}
    found = [{"kind": "drag", "place": {"on": "x"}, "parameters": {"drag": number}}]
    said = {"found": found, "parameters": [{"name": "k", "value": 250.0, "sd": 1.0}]}
    model = sh.parse_model(peers.corrected(text, said))
    assert model.elements[-1].kind == "drag"
    assert {one.path: one.value for one in model.all_parameters()}["k"] == 250.0


def test_the_unseen_error_is_that_of_a_free_run(tmp_path: Path) -> None:
    """The recording is a run of the corrected model; nothing that brings code is run."""
    with scripts("board", ("unseen",)) as found:
        text = MASS.read_text(encoding="utf-8")
        (tmp_path / "model.toml").write_text(text)
        corrected = tmp_path / "corrected.toml"
        corrected.write_text(text.replace("value = 240.0", "value = 300.0"))
        t = np.arange(600) / 100
        f = 8 * np.sin(5 * t) + 5 * np.sin(11 * t + 1)
        rows = np.column_stack([t, f, _driven(t, f, 300.0)])
        np.savetxt(tmp_path / "holdout.csv", rows, delimiter=",", header="t,f,pos_x", comments="")
        errors = found["unseen"].missed(tmp_path, corrected)
        assert errors["before"] > 0.05
        assert errors["after"] < 1e-3
        corrected.write_text("[fmu]\nfile = 'x.fmu'\n")
        assert "error" in found["unseen"].missed(tmp_path, corrected)


def _driven(t: Any, f: Any, stiffness: float) -> Any:
    """The position of the mass by another integration."""
    from scipy.integrate import solve_ivp
    from scipy.interpolate import CubicSpline

    force = CubicSpline(t, f)

    def rate(time: float, x: Any) -> list[float]:
        return [x[1], (force(time) - stiffness * x[0] - 1.9 * x[1]) / 1.6]

    return solve_ivp(rate, (t[0], t[-1]), [0.0, 0.0], t_eval=t, rtol=1e-9, atol=1e-12).y[0]

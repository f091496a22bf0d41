"""The peers of the bench: right columns, claims in the form of a diagnosis, scored by one code."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.concealed_bench import FOLDER, Study, answer_of, modules


@pytest.fixture(scope="module")
def study() -> Iterator[Study]:
    """The modules of the bench."""
    with modules() as found:
        yield found


def exact(study: Study, name: str, effects: tuple[Any, ...], seed: int) -> tuple[Any, Any, Any]:
    """A system, its values and the exact motion with concealed forces, as a peer would want it."""
    plans, hidden, systems = study["plans"], study["hidden"], study["systems"]
    system = next(s for s in plans.SYSTEMS if s.name == name)
    random = np.random.default_rng(seed)
    signal = study["conceal"].signal_of(system, random, 1.0)
    plant = hidden.plant_of(system, hidden.Hidden(effects), signal)
    t = np.arange(0, 4, 1 / system.rate)
    start = np.zeros(2 * system.n)
    start[: len(system.start)] = system.start
    motion = study["plant"].simulate(plant, t, start)
    assert isinstance(system, systems.System)
    u = plant.recorded(t, motion.q, motion.v) if system.inputs else np.empty((0, t.size))
    cell = np.zeros_like(motion.q)
    if system.imposed:
        cell = study["plant"].reaction(plant, motion)[None]
    e = study["peer_library"].Estimate(t, motion.q, motion.v, motion.a, u, cell)
    return system, plant, e


@pytest.mark.parametrize(
    ("name", "place", "kind", "keys"),
    [
        ("rig", "x", "drag", {"drag": 40.0}),
        ("cartpole", "post-tip", "spring", {"cubic": 9.0}),
        ("cartpole", "phi", "damper", {"damping": 0.02}),
        ("cartpole", "s", "added_mass", {"mass": 0.05}),
        ("table", "y", "constant", {"constant": 0.7}),
    ],
)
def test_exact_motion_gives_exact_claims(
    study: Study, name: str, place: str, kind: str, keys: dict[str, float]
) -> None:
    effect = study["laws"].Effect(kind, place, keys)
    system, _, e = exact(study, name, (effect,), 3)
    regression = study["peer_regression"]
    points = place.split("-")
    for way in ("pysindy", "weak", "deltaf"):
        terms, rows = regression.regression(way, system, e, False, 40)
        value, spread = regression.sparse(regression.pack(*rows), 0.01)
        (found,) = study["peer_library"].spoken(terms, value, spread)
        assert found["place"] == ({"between": points} if len(points) > 1 else {"on": place}), way
        assert found["kind"] == kind, way
        values = {key: one["value"] for key, one in found["parameters"].items()}
        assert values == pytest.approx(keys, rel=0.02), way


def test_several_terms_of_a_place_are_one_claim(study: Study) -> None:
    library = study["peer_library"]
    nothing = lambda s, r, t: s  # noqa: E731
    stops = [
        library.Term("x", "gap", "stiffness", nothing, side, {"clearance": (edge, 0.01)})
        for side, edge in (("upper", 0.1), ("upper", 0.3), ("lower", 0.1))
    ]
    waves = [
        library.Term("x", "harmonic", key, nothing, "", {"frequency": (2.0, 0.01)})
        for key in ("sin", "cos")
    ]
    dampers = [library.Term("x", "damper", key, nothing) for key in ("damping", "asymmetry")]
    value, spread = np.array([3.0, 1.0, 0.0, 3.0, 4.0, 2.0, 1.0]), np.full(7, 0.1)
    gap, wave, damper = library.spoken([*stops, *waves, *dampers], value, spread)
    assert (gap["kind"], gap["options"]) == ("gap", {"side": "upper"})
    assert gap["parameters"]["clearance"]["value"] == pytest.approx(0.15)
    assert gap["parameters"]["stiffness"]["value"] == pytest.approx(4.0)
    assert wave["parameters"]["amplitude"]["value"] == pytest.approx(5.0)
    assert wave["parameters"]["phase"]["value"] == pytest.approx(np.arctan2(4, 3))
    assert damper["parameters"]["asymmetry"]["value"] == pytest.approx(0.5)
    both = library.spoken(stops, np.array([3.0, 0.0, 2.0]), spread[:3])
    assert both[0]["options"] == {"side": "both"}


def test_a_packed_regression_is_that_of_all_rows(study: Study) -> None:
    random = np.random.default_rng(1)
    columns = random.normal(size=(500, 4)) * [1.0, 100.0, 1e-3, 1.0]
    target = columns @ [0.5, 0.0, 400.0, 0.001] + 0.01 * random.normal(size=500)
    regression = study["peer_regression"]
    value, spread = regression.sparse(regression.pack(target, columns), 0.05)
    kept = columns[:, [0, 2]]
    fit = np.linalg.lstsq(kept, target, rcond=None)[0]
    assert value[[0, 2]] == pytest.approx(fit, rel=1e-3)
    assert not value[[1, 3]].any()
    left = target - kept @ fit
    cov = np.linalg.inv(kept.T @ kept) * np.sum(left**2) / 498
    assert spread[[0, 2]] == pytest.approx(np.sqrt(np.diag(cov)), rel=0.02)


def recorded(study: Study, name: str, effects: tuple[Any, ...], seed: int) -> Any:
    """What a stepwise fit sees: the exact motion with 0.5 % of white noise."""
    system, _, e = exact(study, name, effects, seed)
    random = np.random.default_rng(seed + 1)
    noise = 5e-3 * np.sqrt(np.mean(e.q**2, axis=1, keepdims=True))
    q = e.q + noise * random.standard_normal(e.q.shape)
    cell = None
    if system.imposed:
        q, level = e.q, 5e-3 * np.sqrt(np.mean(e.cell**2))
        cell = e.cell + level * random.standard_normal(e.cell.shape)
    return study["peer_motion"].Recorded(system, e.t, e.u, q, None, cell)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "kind", "key", "size"),
    [("duffing", "drag", "drag", 8.0), ("rig", "friction", "coulomb", 6.0)],
)
def test_the_stepwise_fit_finds_one_clear_term(
    study: Study, name: str, kind: str, key: str, size: float
) -> None:
    effect = study["laws"].Effect(kind, "x", {key: size})
    said = study["peer_stepwise"].stepwise(recorded(study, name, (effect,), 3))["diagnosis"]
    first = next(found for found in said["found"] if found["kind"] == kind)
    assert first["parameters"][key]["value"] == pytest.approx(size, rel=0.1)


@pytest.mark.slow
def test_the_stepwise_fit_leaves_a_whole_model_alone(study: Study) -> None:
    said = study["peer_stepwise"].stepwise(recorded(study, "oscillator", (), 5))["diagnosis"]
    assert (said["verdict"], said["found"], said["parameters"]) == ("nothing missing", [], [])


def test_claims_of_peers_are_scored_like_all_others(study: Study) -> None:
    library, peer = study["peer_library"], study["score"].score_peer
    terms = list(library._plain("x", True))
    value = np.array([0.8 if (t.kind, t.key) == ("drag", "drag") else 0.0 for t in terms])
    found = library.spoken(terms, value, np.full(len(terms), 0.01))
    said = {
        "verdict": "missing physics",
        "found": found,
        "parameters": [],
        "measurement": [],
        "alternatives": [],
    }
    reported = {"seconds": 0.2, "diagnosis": said, "fit": 0.4}
    row = peer("00002-duffing", reported, answer_of(), 1)
    assert (row.place, row.name, row.structure, row.wrong) == (1, 1, True, ())
    assert (row.covered, row.counted, row.cpu, row.fit) == (1, 1, 0.2, 0.4)
    null = peer("00003-duffing", reported, answer_of(effects=[]), 1)
    assert len(null.wrong) == 1
    silent = peer("00002-duffing", {"seconds": 1.0, "fit": 0.3}, answer_of(), 1)
    assert (silent.name, silent.wrong, silent.fit) == (0, (), 0.3)
    failed = peer("00002-duffing", {"seconds": 0.0, "crash": "singular"}, answer_of(), 1)
    assert (failed.name, failed.refused, failed.fit) == (0, True, 1.0)


def test_generators_and_peers_share_no_code_with_symhyb() -> None:
    using = {
        path.name
        for path in FOLDER.glob("*.py")
        if re.search(r"^\s*(import|from) symhyb", path.read_text(encoding="utf-8"), re.M)
    }
    assert using == {"diagnosing.py", "fleets.py", "score.py", "threshold.py"}


def test_tuning_takes_the_best_f1_and_the_best_quiet_setting(study: Study) -> None:
    tuning, Setting, peer = study["peer_tuning"], study["peers"].Setting, study["score"].score_peer
    claim = {"kind": "drag", "place": {"on": "x"}, "parameters": {}}
    wrong = {"kind": "damper", "place": {"on": "x"}, "parameters": {}}

    def rows(hits: int, alarms: int) -> list[Any]:
        def one(found: list[Any], answer: dict[str, Any]) -> Any:
            said = {
                "verdict": "",
                "found": found,
                "parameters": [],
                "measurement": [],
                "alternatives": [],
            }
            return peer(
                "00000-x", {"seconds": 1.0, "fit": 0.1 * hits, "diagnosis": said}, answer, 1
            )

        hidden = [one([claim] if i < hits else [], answer_of()) for i in range(10)]
        nulls = [one([wrong] if i < alarms else [], answer_of(effects=[])) for i in range(10)]
        return hidden + nulls

    settings = {
        Setting(p, threshold=threshold): rows(hits, alarms)
        for p in ("pysindy", "weak", "deltaf")
        for threshold, hits, alarms in ((0.01, 9, 3), (0.05, 5, 0), (0.1, 2, 0))
    }
    settings |= {Setting("mlp", hidden=(w,)): rows(w, 0) for w in (2, 5)}
    chosen = tuning.choose(settings)
    assert chosen["deltaf"]["setting"] == "deltaf plain 21 0.01"
    assert chosen["deltaf"]["f1"] == pytest.approx(2 * 9 / (10 + 9 + 3), abs=1e-3)
    assert chosen["deltaf (quiet)"]["setting"] == "deltaf plain 21 0.05"
    assert chosen["weak (quiet)"]["nulls"] == "0 of 10"
    assert chosen["mlp"]["setting"] == "mlp 21 2"


def test_peers_answer_a_drawn_case_and_go_on(
    study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The ripple of a rig; the network fits part of it, and what is there is not done again."""
    peers, draw = study["peers"], study["draw"]
    draw.write(10, tmp_path)
    (folder,) = peers.cases([10, 12], tmp_path)
    names = ("deltaf wide 21 0.1", "weak plain 60 0.1", "mlp 21 16")
    monkeypatch.setattr(peers, "chosen", lambda: [peers.of_name(name) for name in names])
    arguments = ["peers.py", "--seeds", "10", "-o", str(tmp_path), "--results", str(tmp_path / "p")]
    monkeypatch.setattr("sys.argv", arguments)
    peers.main()
    path = tmp_path / "p" / f"{folder.name}.json"
    said = json.loads(path.read_text())
    assert set(said) == set(names)
    assert {one["kind"] for one in said[names[0]]["diagnosis"]["found"]} == {"ripple"}
    assert said[names[0]]["fit"] < said["mlp 21 16"]["fit"] < 1.05
    row = study["score"].score_peer(
        folder.name, said[names[0]], study["seal"].unseal(folder / "sealed.json"), 1
    )
    assert row.name == 1
    before = path.stat().st_mtime_ns
    peers.main()
    assert path.stat().st_mtime_ns == before

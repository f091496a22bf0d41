"""The bench of what the vocabulary lacks: its generators, its seals, its scores."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy.signal import cont2discrete

import symhyb as sh
from symhyb.numeric.kernels.buffers import call
from tests.scripts import scripts

NAMES = (
    "draw",
    "kinds",
    "bare",
    "machines",
    "simulate",
    "visible",
    "outcomes",
    "score",
    "shared",
    "run",
)
Study = Mapping[str, ModuleType]


@pytest.fixture(scope="module")
def study() -> Iterator[Study]:
    """The modules of the bench, which are scripts beside each other."""
    with scripts("outside", NAMES) as found:
        yield found


def signal(study: Study, k: int = 1) -> Any:
    """Two lines for every input."""
    lines = np.array([[1.0, 2.0]] * k), np.array([0.7, 2.9]), np.array([[0.3, 1.1]] * k)
    return study["shared"].Signal(*lines)


def bare(study: Study, name: str, seconds: float = 2.0) -> Any:
    """A short run of a machine without a change."""
    system = study["machines"].MACHINES[name]
    values, start = system.values(), np.full(2 * system.n, 0.1)
    plant = study["simulate"].Plant(
        system, study["simulate"].Change(), values, signal(study, len(system.inputs))
    )
    t = np.arange(round(seconds * system.rate) + 1) / system.rate
    run = study["simulate"].simulate(plant, t, start)
    known = study["bare"].known_of(system, values, run.q, run.v, run.u)
    return study["bare"].Bare(system, values, t, run.q, run.v, run.u, known)


def changed(study: Study, kind: str, name: str) -> tuple[Any, Any, Any]:
    """The unchanged run of a machine, a change and the run with it."""
    without = bare(study, name)
    random = [np.random.default_rng([5, i]) for i in range(2)]
    change = study["kinds"].KINDS[kind].make(without, *random)
    k = len(without.system.inputs)
    plant = study["simulate"].Plant(without.system, change, without.values, signal(study, k))
    start = np.concatenate([without.q[:, 0], without.v[:, 0]])
    return without, change, study["simulate"].simulate(plant, without.t, start)


@pytest.mark.parametrize(
    "name", ["mass", "hardening", "pendulum", "axis", "chain", "cart", "gimbal"]
)
def test_equations_by_hand_are_those_of_the_model_file(study: Study, name: str) -> None:
    system = study["machines"].MACHINES[name]
    machine = sh.build(sh.read_model(system.folder / f"{name}.toml"), keep=False)
    random = np.random.default_rng(3)
    q, v = 0.1 * random.normal(size=(2, system.n))
    u, p = random.normal(size=len(system.inputs)), system.values()
    mine = np.linalg.solve(system.mass(p, q), system.forces(p, q, v, u).sum(axis=0))
    rest = np.zeros(system.n), np.empty(0)
    (theirs,) = call(machine.acceleration, (q, v, np.empty(0), u, 0.37, machine.values, *rest))
    assert mine == pytest.approx(theirs.ravel(), rel=1e-9)


def test_a_hidden_load_takes_the_energy_that_the_drive_gives(study: Study) -> None:
    without, change, run = changed(study, "hidden load", "mass")
    p, facts = without.values, change.facts
    w = 2 * np.pi * facts["frequency"]
    k, c = facts["mass"] * w**2, 2 * facts["zeta"] * facts["mass"] * w
    q, v, (x, rate) = run.q[0], run.v[0], run.z
    energy = p["m"] * v**2 + p["k"] * q**2 + facts["mass"] * rate**2 + k * (x - q) ** 2
    power = run.u[0] * v - p["d"] * v**2 - c * (rate - v) ** 2
    given = np.trapezoid(power, run.t)
    assert (energy[-1] - energy[0]) / 2 == pytest.approx(given, abs=2e-4 * np.abs(energy).max())
    assert np.abs(q - without.q[0]).max() > 0.01 * np.abs(q).max()


def test_a_lag_is_the_known_solution(study: Study) -> None:
    _, change, run = changed(study, "actuator lag", "mass")
    tau, lines = change.facts["tau"], signal(study)
    w, phase = 2 * np.pi * lines.frequency, lines.phase[0]
    waves = np.exp(1j * (np.outer(run.t, w) + phase)) / (1 + 1j * w * tau)
    steady = waves.imag @ lines.amplitude[0]
    exact = steady + (run.u[0, 0] - steady[0]) * np.exp(-run.t / tau)
    assert run.z[0] == pytest.approx(exact, abs=1e-7)


def test_a_held_input_is_the_exact_discrete_system(study: Study) -> None:
    without, change, run = changed(study, "held input", "mass")
    m, k, d = (without.values[name] for name in ("m", "k", "d"))
    system = np.array([[0, 1], [-k / m, -d / m]]), np.array([[0], [1 / m]]), np.eye(2), 0
    step = cont2discrete((*system[:3], np.zeros((2, 1))), 1 / without.system.rate)
    state = np.array([run.q[0, 0], run.v[0, 0]])
    for i in range(1, run.t.size):
        state = step[0] @ state + step[1][:, 0] * run.u[0, i - 1]
    assert state == pytest.approx([run.q[0, -1], run.v[0, -1]], rel=1e-6)
    assert np.all(run.u[0, 1 : change.hold] == run.u[0, 0])


@pytest.mark.slow
def test_every_kind_changes_every_machine_it_is_for(study: Study) -> None:
    runs = {name: bare(study, name, 11.0) for name in study["machines"].MACHINES}
    for kind in study["kinds"].TABLE:
        for name in kind.machines:
            without = runs[name]
            change = kind.make(without, *(np.random.default_rng([2, i]) for i in range(2)))
            assert altered(study, without, change) > 0, (kind.name, name)


def altered(study: Study, without: Any, change: Any) -> float:
    """How much a change moves along an unchanged run: slopes, readings or noise."""
    Plant, Change, t = study["simulate"].Plant, study["simulate"].Change, without.t
    if change.hold:
        return float(change.hold)
    random, sd = np.random.default_rng(1), without.q.std(axis=1)
    if change.taint is not None:
        tainted = change.taint(random, t, without.q, 0.01 * sd)
        return float(np.abs(tainted - without.q).max())
    if change.record is not None:
        return float(np.abs(change.record(random, t, without.u) - without.u).max())
    k = len(without.system.inputs)
    other, plain = (
        Plant(without.system, c, without.values, signal(study, k)) for c in (change, Change())
    )
    most, states = 0.0, []
    for i in range(0, t.size, 61):
        q, v, u = without.q[:, i], without.v[:, i], without.u[:, i]
        z = np.empty(0) if change.begin is None else 0.9 * change.begin(q, v, u) + 0.01
        y = np.concatenate([q, v, z])
        states.append(z)
        slope = other.slope(t[i], y)[: 2 * without.system.n]
        most = max(most, float(np.abs(slope - plain.slope(t[i], y[: 2 * q.size])).max()))
    if change.show is not None:
        z = np.array(states).T
        read = change.show(t[::61], without.q[:, ::61], z)
        most = max(most, float(np.abs(read - without.q[:, ::61]).max()))
    return most


def test_what_a_number_absorbs_is_not_beyond(study: Study) -> None:
    """A stiffness that is another one shows, and the fit of the simple causes takes it."""
    visible, system = study["visible"], study["machines"].MACHINES["mass"]
    values = system.values()
    plant = study["simulate"].Plant(
        system, study["simulate"].Change(), {**values, "k": values["k"] * 1.01}, signal(study)
    )
    t = np.arange(801) / system.rate
    run = study["simulate"].simulate(plant, t, np.array([0.05, 0.0]))
    windows = visible.Windows(system, t, run.q, run.v, run.u, True)
    known = study["bare"].known_of(system, values, run.q, run.v, run.u)
    snr, beyond = visible.visibility(windows, values, known, run.q, np.array([1e-5]))
    assert snr > 10
    assert beyond < 0.02 * snr
    same = visible.visibility(windows, plant.values, known, run.q, np.array([1e-5]))[0]
    assert same < 0.01


@pytest.mark.slow
def test_a_case_is_sealed_and_drawn_again_alike(study: Study, tmp_path: Path) -> None:
    draw, kind = study["draw"], study["kinds"].KINDS["noise growing"]
    folder = draw.write(kind, 0, tmp_path)
    answer = study["shared"].unseal(folder / "sealed.json")
    assert answer["kind"] == kind.name
    assert answer["values"] == {"k": 240.0, "d": 1.9}
    assert all(
        kind.name not in text for text in ((folder / "sealed.json").read_text(), str(folder))
    )
    model = sh.read_model(folder / "model.toml")
    assert sh.read_recording(folder / "train.csv", model).t.size == 3001
    again = draw.write(kind, 0, tmp_path / "again")
    assert (again / "train.csv").read_bytes() == (folder / "train.csv").read_bytes()


LAW = ("drag", "x", "drag", 0.8)


def answer_of(**changes: Any) -> dict[str, Any]:
    """An opened answer: a magnet at x, or what is changed of it."""
    plain = {
        "kind": "magnet",
        "machine": "mass",
        "classes": ["law"],
        "accepted": [],
        "place": "x",
        "law": None,
        "values": {"k": 240.0, "d": 1.9},
    }
    return {**plain, **changes}


def claim(kind: str, term: str, value: float, sd: float) -> dict[str, Any]:
    """An entry of ``found`` at x."""
    number = {"value": value, "sd": sd, "unit": "1", "term": term}
    return {"kind": kind, "place": {"on": "x"}, "parameters": {"b": number}}


def paired(kind: str, term: str, value: float, sd: float) -> dict[str, Any]:
    """An entry of ``found`` on the pair a and b."""
    return {**claim(kind, term, value, sd), "place": {"pair": ["a", "b"]}}


def stated(kind: str, probability: float = 0.9) -> list[dict[str, Any]]:
    """A class at x."""
    return [{"kind": kind, "place": {"on": "x"}, "probability": probability, "sentence": ""}]


def number(name: str, value: float, sd: float) -> dict[str, Any]:
    """An entry of ``parameters``."""
    return {"name": name, "was": 0.0, "value": value, "sd": sd, "unit": "1"}


FORCE, NULL = "missing physics", {"classes": ["noise"], "place": "", "kind": "noise heavy"}
DELAY = {"channel": "f", "kind": "delay", "value": 0.0025, "sd": 1e-5, "unit": "s"}
HELD = {
    "classes": ["input"],
    "accepted": ["held"],
    "place": "f",
    "kind": "held input",
    "facts": {"hold": 0.0025},
}
SLEW = {
    "classes": ["input", "lag"],
    "accepted": ["rate_limit", "lag"],
    "place": "f",
    "facts": {"rate": 226.0, "tau": 0.005},
}
RATE = {"channel": "f", "kind": "rate_limit", "value": 225.0, "sd": 0.5, "unit": "N/s"}
LAG = {"channel": "f", "kind": "lag", "value": 0.005, "sd": 1e-5, "unit": "s"}
STEP = {"classes": ["time-varying"], "place": "k", "facts": {"at": 3.1, "after": 227.2}}
BEGUN = {"verdict": "parameters", "places": [{"change": {"kind": "begins", "time_s": 3.2}}]}
RUNS = {"verdict": "parameters", "classes": [{"kind": "time-varying", "probability": 1.0}]}
RIDING = {
    "classes": ["hidden mode"],
    "accepted": ["mode"],
    "kind": "hidden load",
    "facts": {"mass": 0.2, "frequency": 2.5},
}
SKEW = {
    "classes": ["coupling"],
    "accepted": ["skew_spring"],
    "kind": "skew spring",
    "place": "a-b",
    "facts": {"amount": 0.4, "across": -0.4},
}
LISTED = {"law": LAW, "kind": "law, heavy"}


@pytest.mark.parametrize(
    ("answer", "reported", "outcome"),
    [
        ({}, {"verdict": FORCE, "found": [claim("spring", "cubic", -9.0, 0.1)]}, "wrong"),
        ({}, {"verdict": "undecided"}, "refused"),
        ({}, {"verdict": "undecided", "classes": stated("law")}, "class right"),
        ({}, {"verdict": "undecided", "classes": stated("law", 0.3)}, "refused"),
        ({}, {"verdict": "undecided", "classes": stated("lag")}, "refused"),
        ({}, {"verdict": FORCE, "classes": stated("law")}, "class right"),
        ({}, {"verdict": FORCE, "classes": stated("lag")}, "wrong"),
        ({}, {"verdict": "nothing missing"}, "false nothing"),
        ({}, {"verdict": "parameters", "parameters": [number("d", 2.1, 0.1)]}, "false nothing"),
        ({}, {"verdict": "parameters", "parameters": [number("d", 3.8, 0.04)]}, "wrong"),
        ({}, {"verdict": "measurement", "measurement": [DELAY]}, "wrong"),
        (
            {},
            {
                "verdict": FORCE,
                "classes": stated("law"),
                "found": [claim("friction", "coulomb", 0.1, 0.01)],
            },
            "wrong",
        ),
        (NULL, {"verdict": "nothing missing"}, "class right"),
        (NULL, {"verdict": "undecided"}, "refused"),
        (NULL, {"verdict": "parameters", "parameters": [number("k", 243.0, 2.0)]}, "class right"),
        (NULL, {"verdict": FORCE, "found": [claim("drag", "drag", 0.8, 0.1)]}, "wrong"),
        (HELD, {"verdict": "measurement", "measurement": [DELAY]}, "wrong"),
        (STEP, {"verdict": "parameters", "parameters": [number("k", 227.0, 0.5)]}, "false nothing"),
        (STEP, {**BEGUN, "parameters": [number("k", 227.0, 0.5)]}, "class right"),
        (STEP, {**BEGUN, "parameters": [number("k", 234.0, 0.5)]}, "wrong"),
        (STEP, {**RUNS, "courses": [{"parameter": "k"}]}, "class right"),
        (STEP, {**RUNS, "courses": [{"parameter": "d"}]}, "wrong"),
        ({}, {**RUNS, "courses": [{"parameter": "x"}]}, "wrong"),
        ({}, {"verdict": FORCE, "found": [claim("law", "coefficient", 0.7, 0.1)]}, "class right"),
        (
            HELD,
            {"verdict": "measurement", "measurement": [{**DELAY, "kind": "held"}]},
            "class right",
        ),
        (
            HELD,
            {"verdict": "measurement", "measurement": [{**DELAY, "kind": "held", "channel": "g"}]},
            "class right",  # one clock holds all inputs
        ),
        (
            HELD,
            {"verdict": "measurement", "measurement": [{**DELAY, "kind": "held", "value": 0.005}]},
            "wrong",
        ),
        (SLEW, {"verdict": FORCE, "measurement": [RATE, LAG]}, "class right"),
        (SLEW, {"verdict": FORCE, "measurement": [{**RATE, "sd": 0.2}, LAG]}, "wrong"),
        (SLEW, {"verdict": FORCE, "measurement": [{**RATE, "channel": "g"}]}, "wrong"),
        (SLEW, {"verdict": FORCE, "measurement": [{**RATE, "kind": "limit"}]}, "wrong"),
        ({**SLEW, "facts": {}}, {"verdict": FORCE, "measurement": [RATE]}, "wrong"),
        (
            {"accepted": ["gap"]},
            {"verdict": FORCE, "found": [claim("gap", "clearance", 0.1, 0.01)]},
            "class right",
        ),
        (
            RIDING,
            {"verdict": FORCE, "found": [claim("mode", "frequency", 2.51, 0.01)]},
            "class right",
        ),
        (RIDING, {"verdict": FORCE, "found": [claim("mode", "frequency", 2.6, 0.01)]}, "wrong"),
        (RIDING, {"verdict": FORCE, "found": [claim("added_mass", "mass", 0.2, 0.1)]}, "wrong"),
        (
            SKEW,
            {"verdict": FORCE, "found": [paired("skew_spring", "stiffness", 0.41, 0.01)]},
            "class right",
        ),
        (
            SKEW,
            {"verdict": FORCE, "found": [paired("skew_spring", "stiffness", -0.41, 0.01)]},
            "wrong",
        ),
        (
            SKEW,
            {"verdict": FORCE, "found": [paired("circulatory", "stiffness", -0.4, 0.01)]},
            "wrong",
        ),
        (
            SKEW,
            {"verdict": FORCE, "found": [claim("skew_spring", "stiffness", 0.4, 0.01)]},
            "wrong",
        ),
        (LISTED, {"verdict": FORCE, "found": [claim("drag", "drag", 0.7, 0.1)]}, "class right"),
        (LISTED, {"verdict": FORCE, "found": [claim("spring", "cubic", 0.7, 0.1)]}, "wrong"),
        (LISTED, {"verdict": "nothing missing"}, "false nothing"),
        (
            {},
            {"verdict": "measurement", "channels": [{"kind": "sign", "channels": ["f"]}]},
            "wrong",
        ),
    ],
)
def test_an_answer_gets_its_outcome(
    study: Study, answer: dict[str, Any], reported: dict[str, Any], outcome: str
) -> None:
    whole = {"found": [], "parameters": [], "measurement": [], "sentence": "", **reported}
    result = {"seconds": 1.0, "diagnosis": whole}
    row = study["outcomes"].score_case("0000", result, answer_of(**answer))
    assert row.outcome == outcome
    assert bool(row.wrong) == (outcome == "wrong")


def test_a_true_law_is_held_against_its_number_and_a_class_against_its_place(study: Study) -> None:
    def row(reported: dict[str, Any], **answer: Any) -> Any:
        whole = {"found": [], "parameters": [], "measurement": [], "sentence": "", **reported}
        result = {"seconds": 1.0, "diagnosis": whole}
        return study["outcomes"].score_case("0000", result, answer_of(**answer))

    for sd, covered in ((0.1, True), (0.02, False)):
        found = [claim("drag", "drag", 0.9, sd)]
        assert row({"verdict": FORCE, "found": found}, law=LAW).covered is covered
    for place, placed in (("x", True), ("y", False)):
        reported = {"verdict": "undecided", "classes": stated("law")}
        assert row(reported, place=place).placed is placed
    crash = study["outcomes"].score_case("0000", {"crash": "ended"}, answer_of())
    assert crash.outcome == "failed"


def test_a_report_counts_what_two_packages_did(study: Study, tmp_path: Path, capsys: Any) -> None:
    folder = tmp_path / "0000-abc-mass"
    folder.mkdir()
    sealed = study["shared"].seal(json.loads(json.dumps(answer_of())))
    (folder / "sealed.json").write_text(sealed, encoding="ascii")
    plain = {"found": [], "parameters": [], "measurement": [], "sentence": "It is so."}
    for name, verdict in (("old", "nothing missing"), ("new", "undecided")):
        (tmp_path / name).mkdir()
        result = {"seconds": 1.0, "cpu_seconds": 2.0, "diagnosis": {**plain, "verdict": verdict}}
        (tmp_path / name / f"{folder.name}.json").write_text(json.dumps(result))
    argv = ["score.py", "-o", str(tmp_path), "--results", str(tmp_path / "old")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", [*argv, str(tmp_path / "new")])
        study["score"].main()
    printed = capsys.readouterr().out
    assert "| magnet (law) | 1 | 0 | 0 | 0 | 1 | 0 |" in printed
    assert "magnet: false nothing → refused" in printed
    (row,) = json.loads((tmp_path / "new" / "rows.json").read_text())
    assert row["outcome"] == "refused"


def test_another_package_diagnoses_the_same_case_once(study: Study, tmp_path: Path) -> None:
    """The other package is one that fails, so that it cannot be mistaken for this one."""
    kind, package = study["kinds"].KINDS["magnet"], tmp_path / "other"
    folder = study["draw"].folder_of(kind, 0, tmp_path)
    for place in (folder, package / "symhyb"):
        place.mkdir(parents=True)
    (folder / "sealed.json").write_text(study["shared"].seal(answer_of()), encoding="ascii")
    (package / "symhyb" / "__init__.py").write_text("raise RuntimeError('the other package')\n")
    argv = ["run.py", "--seeds", "0", "--kinds", "magnet", "--package", str(package)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", [*argv, "-o", str(tmp_path), "--results", str(tmp_path / "r")])
        study["run"].main()
        (result,) = (tmp_path / "r").glob("*.json")
        assert "the other package" in json.loads(result.read_text())["crash"]
        before = result.stat().st_mtime_ns
        study["run"].main()
    assert result.stat().st_mtime_ns == before
    (row,) = study["score"].read(tmp_path, tmp_path / "r", [0])
    assert row.outcome == "failed"


def test_wilsons_interval_is_the_published_one(study: Study) -> None:
    """Newcombe 1998, table I, method 3: 81 of 263, and 0 of 20."""
    assert study["score"].wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)
    assert study["score"].wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=1e-4)

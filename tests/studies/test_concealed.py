"""The bench of concealed effects: its generators are right, its oracle is, its scores are."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import symhyb as sh
from symhyb.model.read import parse_model
from symhyb.numeric.kernels.buffers import call
from tests.concealed_bench import Study, answer_of, modules, reported, run

FORCES: dict[str, dict[str, float]] = {
    "spring": {"stiffness": 3.0, "quadratic": 2.0, "cubic": -1.5},
    "damper": {"damping": 0.7, "asymmetry": 0.4},
    "drag": {"drag": 0.9},
    "friction": {"coulomb": 0.3, "static": 0.5, "stribeck": 0.2},
    "gap": {"stiffness": 40.0, "clearance": 0.05},
    "constant": {"constant": 0.6},
    "harmonic": {"amplitude": 0.4, "frequency": 1.3, "phase": 0.5},
    "ripple": {"amplitude": 0.4, "period": 0.08, "phase": -0.5},
    "added_mass": {"mass": 0.2},
}


@pytest.fixture(scope="module")
def study() -> Iterator[Study]:
    """The modules of the bench."""
    with modules() as found:
        yield found


def still(study: Study, k: int) -> Any:
    """An excitation of nothing."""
    return study["plant"].Signal(np.zeros((k, 1)), np.ones(1), np.zeros((k, 1)))


def accelerations(
    study: Study, system: Any, effects: tuple[Any, ...], random: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """q'' by the equations of the generator and by the model file with the truth in it."""
    hidden = study["hidden"].Hidden(effects)
    k = max(len(system.inputs), 1)
    u = random.normal(size=k)
    signal = study["plant"].Signal(u[:, None], np.zeros(1), np.full((k, 1), np.pi / 2))
    plant = study["hidden"].plant_of(system, hidden, signal)
    q, v = 0.2 * random.normal(size=(2, system.n))
    y = np.concatenate([q, v, np.zeros(len(plant.memory))])
    rates = [float(plant.system.path(plant.values, q, e.place)[1] @ v) for e in plant.rubbing]
    modes = tuple(int(np.sign(r)) for r in rates)
    theirs = study["plant"].accelerate(plant, 0.37, y, modes)[0]
    names = study["hidden"].channels(system, False)
    text = study["truth"].truth_text(study["draw"].model_text(system, names), hidden)
    machine = sh.build(parse_model(text), keep=False)
    given = plant.recorded(0.37, q, v) if system.inputs else np.empty(0)
    z = np.zeros(len(plant.memory))
    arguments = (q, v, z, given, 0.37, machine.values, np.zeros(system.n), np.empty(0))
    (ours,) = call(machine.acceleration, arguments)
    return theirs, ours.ravel()


def test_every_system_obeys_the_equations_of_its_model_file(study: Study) -> None:
    random = np.random.default_rng(1)
    plans = study["plans"]
    for system in (*plans.SYSTEMS, *plans.ENGINE_SYSTEMS):
        if not system.imposed:
            theirs, ours = accelerations(study, system, (), random)
            assert theirs == pytest.approx(ours, rel=1e-9, abs=1e-9), system.name


@pytest.mark.parametrize("kind", FORCES)
def test_a_concealed_law_is_that_of_the_vocabulary(study: Study, kind: str) -> None:
    random = np.random.default_rng(2)
    plans, effect = study["plans"], study["laws"].Effect
    for system, place in (
        (plans.CARTPOLE, "s"),
        (plans.CARTPOLE, "post-tip"),
        (plans.THREE_MASSES, "p2-p3"),
        (plans.ARM, "post-tip"),
    ):
        theirs, ours = accelerations(study, system, (effect(kind, place, FORCES[kind]),), random)
        near = 1e-5 if kind == "friction" else 1e-6  # that of the model file is a steep tanh
        assert theirs == pytest.approx(ours, rel=near), (system.name, place)


def test_dry_friction_stops_where_the_closed_form_says(study: Study) -> None:
    """A mass that slides against friction alone stops after v²m/(2F), and then holds."""
    plant, systems = study["plant"], study["systems"]
    sled = systems.SLED
    drive = systems.Drive((0.1, 1.0), 1.0)
    sled = systems.System("sled", ("x",), sled.mass, sled.forces, drive)
    effect = study["laws"].Effect("friction", "x", {"coulomb": 19.0})
    machine = plant.Plant(sled, {"m": 95.0}, (effect,), still(study, 1), np.ones(1), np.zeros(1))
    motion = plant.simulate(machine, np.arange(0, 10, 0.01), np.array([0.0, 1.0]))
    assert motion.q[0, -1] == pytest.approx(95.0 / (2 * 19.0), rel=1e-9)
    assert abs(motion.v[0, -1]) < 1e-12
    assert motion.sticks == pytest.approx((10 - 4.75) / 10, abs=0.01)


def test_a_stuck_mass_is_released_where_the_force_reaches_its_static_level(study: Study) -> None:
    """The input grows like a slow sine: at 2 N the mass lets go."""
    plant, systems = study["plant"], study["systems"]
    signal = plant.Signal(np.array([[4.0]]), np.array([0.02]), np.zeros((1, 1)))
    keys = {"coulomb": 1.0, "static": 2.0, "stribeck": 0.05}
    effect = study["laws"].Effect("friction", "x", keys)
    values = systems.OSCILLATOR.values()
    machine = plant.Plant(systems.OSCILLATOR, values, (effect,), signal, np.ones(1), np.zeros(1))
    t = np.arange(0, 8, 0.001)
    motion = plant.simulate(machine, t, np.zeros(2))
    release = np.arcsin(0.5) / (2 * np.pi * 0.02)
    assert t[np.flatnonzero(np.abs(motion.v[0]) > 1e-9)[0]] == pytest.approx(release, abs=0.003)


def test_the_oracle_knows_the_deviation_of_a_linear_regression(study: Study) -> None:
    """On the rig the cell is linear in a constant force: its sd is σ/√N."""
    plans, oracle, hidden = study["plans"], study["oracle"], study["hidden"]
    effect = study["laws"].Effect("constant", "x", {"constant": 2.0})
    concealed = hidden.Hidden((effect,))
    t = np.arange(1000) / 200
    plant = hidden.plant_of(plans.RIG, concealed, still(study, 1))
    motion = study["plant"].simulate(plant, t, np.empty(0))
    run = oracle.Run(
        plans.RIG, concealed, plant, motion, np.empty((0, 1000)), ("cell",), np.array([0.5])
    )
    sd = oracle.deviations(run, oracle.look(run))
    assert sd == pytest.approx([0.5 / np.sqrt(1000) / 2.0], rel=1e-6)


@pytest.mark.thorough
def test_a_constant_force_has_the_offset_of_the_input_as_its_twin(study: Study) -> None:
    draw, plans = study["conceal"], study["plans"]
    case = next(
        case
        for seed in range(0, 4000, 32)
        if plans.plan_of(seed).kind in ("constant", "offset.input")
        and not isinstance(case := draw.draw(seed), int)
    )
    equals = [rival["instead"] for rival in case.rivals if rival["apart"] < 1e-6]
    assert {"channel": "f", "kind": "offset"} in equals or {
        "place": "x",
        "kind": "constant",
    } in equals


def test_a_seal_hides_and_opens(study: Study, tmp_path: Path) -> None:
    draw = study["draw"]
    folder = draw.write(10, tmp_path)
    assert folder is not None
    answer = study["seal"].unseal(folder / "sealed.json")
    assert answer["verdict"] == "missing physics"
    kind = answer["effects"][0]["kind"]
    assert kind not in (folder / "sealed.json").read_text()
    true = study["score"].true_text(folder, answer)
    assert f'kind = "{kind}"' in true
    assert parse_model(true).elements[-1].kind == kind
    again = draw.write(10, tmp_path / "again")
    assert (again / "train.csv").read_bytes() == (folder / "train.csv").read_bytes()


def test_scores_tell_hits_from_misses_twins_and_wrong_claims(study: Study) -> None:
    score = study["claims"].score_case
    hit = score("a", reported("drag", "x", "drag", 0.81, 0.01), answer_of(), 1)
    assert (hit.place, hit.name, hit.structure, hit.wrong) == (1, 1, True, ())
    assert (hit.covered, hit.counted) == (1, 1)
    wrong = score("a", reported("damper", "x", "damping", 0.8, 0.01), answer_of(), 1)
    assert (wrong.place, wrong.name, wrong.structure, len(wrong.wrong)) == (1, 0, False, 1)
    elsewhere = score("a", reported("drag", "y", "drag", 0.8, 0.01), answer_of(), 2)
    assert (elsewhere.place, elsewhere.name) == (0, 0)
    instead = {"place": "x", "kind": "damper"}
    partner = answer_of(rivals=[{"of": 0, "instead": instead, "apart": 1e-9, "evidence": 0.0}])
    assert score("a", reported("damper", "x", "damping", 0.8, 0.01), partner, 1).structure
    near = answer_of(rivals=[{"of": 0, "instead": instead, "apart": 1e-3, "evidence": 1.0}])
    assert not score("a", reported("damper", "x", "damping", 0.8, 0.01), near, 1).structure
    nothing = score("a", reported("drag", "x", "drag", 0.8, 0.01), answer_of(effects=[]), 1)
    assert len(nothing.wrong) == 1
    assert nothing.wanted == 0


def spring(place: str, **orders: float) -> dict[str, Any]:
    """A result that claims one spring, every order 1 % uncertain."""
    result = reported("spring", place, "", 0.0, 0.0)
    numbers = {k: {"value": v, "sd": abs(v) / 100, "term": k} for k, v in orders.items()}
    result["diagnosis"]["found"][0]["parameters"] = numbers
    return result


def springs(*orders: dict[str, float]) -> dict[str, Any]:
    """An opened answer with springs concealed on x, one for each set of orders."""
    plain = {"kind": "spring", "place": "x", "side": "both", "share": 0.1}
    return answer_of(effects=[{**plain, "keys": keys} for keys in orders])


def test_two_springs_at_one_place_are_one_element_and_two_causes(study: Study) -> None:
    """As in 01672: a cubic and a quadratic spring on x, named as one element with both."""
    score = study["claims"].score_case
    both = springs({"cubic": -10044.5}, {"quadratic": 2756.4})
    row = score("a", spring("x", quadratic=2757.4, cubic=-9970.0), both, 1)
    assert (row.place, row.name, row.structure, row.wrong, row.missed) == (2, 2, True, (), ())
    assert (row.covered, row.counted, row.hits) == (2, 2, (2, 2))
    one = score("a", spring("x", quadratic=2757.4), both, 1)
    assert (one.name, one.structure, one.hits, one.wrong) == (1, False, (1, 2), ())
    assert one.missed == ("spring(cubic=-1.004e+04) @ x",)
    more = score("a", spring("x", stiffness=3.0, quadratic=2757.4, cubic=-9970.0), both, 1)
    assert (more.name, more.structure, more.wrong) == (2, False, ())
    other = score("a", spring("x", stiffness=3.0), both, 1)
    assert (other.name, other.structure, len(other.wrong)) == (0, False, 1)
    elsewhere = score("a", spring("y", quadratic=2757.4, cubic=-9970.0), both, 2)
    assert (elsewhere.place, elsewhere.name, len(elsewhere.wrong)) == (0, 0, 1)


def test_one_spring_is_compared_as_a_whole(study: Study) -> None:
    """An order too many at a place with one concealed spring leaves the structure incomplete."""
    score = study["claims"].score_case
    row = score("a", spring("x", cubic=9.0, stiffness=0.1), springs({"cubic": 9.0}), 1)
    assert (row.name, row.structure, row.wrong) == (1, False, ())


@pytest.mark.parametrize(
    "seed",
    [
        *(pytest.param(seed, marks=pytest.mark.slow) for seed in (8, 10)),
        pytest.param(9, marks=pytest.mark.thorough),
    ],
)
def test_cases_are_diagnosed_and_scored(study: Study, tmp_path: Path, seed: int) -> None:
    """Drag of a sled, ripple of a rig, and a sled with nothing concealed."""
    scored = run(study, [seed], tmp_path, errors=True)
    assert scored.given_up == 0
    (row,) = scored.rows
    assert row.structure
    assert not row.wrong
    assert row.cpu > 0
    if row.wanted:
        assert row.error == pytest.approx(1.0, abs=0.1)


@pytest.mark.thorough
def test_a_fleet_has_one_machine_and_where_asked_one_run_with_more_of_the_force(
    study: Study,
) -> None:
    fleets = study["fleets"]
    alike, odd = fleets.drawn(3, odd=False), fleets.drawn(3, odd=True)
    assert len(alike.runs) == fleets.RUNS + 1
    (key,) = {fleets.KEYS[alike.plan.kind]}
    strengths = [[run.hidden.effects[0].keys[key] for run in case.runs] for case in (alike, odd)]
    assert len(set(strengths[0])) == 1
    expected = [strengths[0][0]] * len(odd.runs)
    expected[fleets.ODD] *= fleets.MORE
    assert strengths[1] == pytest.approx(expected)
    for one, other in zip(alike.runs, odd.runs, strict=True):
        assert np.array_equal(one.inputs, other.inputs)


def test_the_table_of_fleets_counts_false_alarms_and_odd_runs(study: Study, tmp_path: Path) -> None:
    fleets = study["fleets"]
    calm = {"verdict": "missing physics", "misfits": [], "changes": []}
    named = {**calm, "misfits": [f"run{fleets.ODD}.csv"]}
    other = {**calm, "misfits": ["run0.csv"], "changes": ["b is not constant"]}
    undecided = {**named, "verdict": "undecided"}
    rows = [(calm, named), (other, calm), (undecided, undecided)]
    for seed, (alike, odd) in enumerate(rows):
        (tmp_path / f"{seed:05d}.json").write_text(json.dumps({"alike": alike, "odd": odd}))
    lines = fleets.table(tmp_path, [0, 1, 2, 3]).splitlines()
    assert lines[0].startswith("3 machines")
    once = " 1 (at most 97.5%, 95 %) "
    assert lines[-2].split("|")[2:6] == [" 2 ", " – ", once, once]
    assert lines[-1].split("|")[2:4] == [" 2 ", " 1 "]

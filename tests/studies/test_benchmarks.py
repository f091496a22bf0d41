"""The benchmarks do what they say: small sizes, right answers, no clock."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from types import ModuleType

import casadi as ca
import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from sympy import Matrix, lambdify
from sympy.physics.mechanics import dynamicsymbols

import symhyb as sh
from symhyb.model.read import parse_model
from symhyb.numeric.kernels.compiled import find_compiler
from symhyb.study.file import read_study
from symhyb.tasks.expand import tasks_of
from tests.scripts import scripts

FOLDER = Path(__file__).parents[2] / "studies" / "benchmarks"
Study = Mapping[str, ModuleType]
NAMES = (
    "bench",
    "compiled",
    "forces",
    "growth",
    "links",
    "oscillators",
    "pages",
    "regression",
    "runs",
    "starting",
    "sticking",
    "timing",
    "trajectories",
    "workers",
    "streaming",
)


@pytest.fixture(scope="module")
def study() -> Iterator[Study]:
    """The modules of the benchmarks, which are scripts beside each other."""
    with scripts("benchmarks", NAMES) as found:
        yield found


def row(study: Study, value: float, bar: float | None, least: bool) -> object:
    return study["timing"].Row("part", "what", value, bar, least)


@pytest.mark.parametrize("relative", [True, False])
def test_contenders_derive_the_same_equations(study: Study, relative: bool) -> None:
    assert study["links"].apart(4, relative) < 1e-13


def test_sympy_derives_the_equations_of_absolute_angles_too(
    study: Study,
) -> None:
    """LagrangesMethod at one state, against symhyb: M and forcing = −k."""
    links, n = study["links"], 3
    mass, forcing = links.lagrange(n)
    model = links.model_of(n, False)
    p = [item.si for item in model.all_parameters()]
    q, v = np.random.default_rng(5).normal(size=(2, n + 1))
    names = dynamicsymbols(f"q0:{n + 1}")
    rates = [name.diff() for name in names]
    values = dict(zip(["g", *(f"m{i}" for i in range(n + 1)), "l1", "l2", "l3"], p, strict=True))
    free = sorted(Matrix([mass, forcing.T]).free_symbols - {dynamicsymbols._t}, key=str)
    given = [*rates, *names, dynamicsymbols("f"), *free]
    numbers = [*v, *q, 0.7, *(values[symbol.name] for symbol in free)]
    theirs = [np.asarray(lambdify(given, part)(*numbers), float) for part in (mass, forcing)]
    ours = [part.full() for part in links.lowered(model)(q, v, 0.7, 0.0, p)]
    assert ours[0] == pytest.approx(theirs[0], rel=1e-12)
    assert ours[1] == pytest.approx(-theirs[1], rel=1e-12)


def test_a_chain_of_links_is_lowered_with_about_the_instructions_of_a_careful_hand(
    study: Study,
) -> None:
    """The bar is 1.6 times; before sums were shared it was five times with twelve links."""
    links = study["links"]
    for relative in (True, False):
        ours = links.lowered(links.model_of(8, relative)).n_instructions()
        assert ours < 1.6 * links.by_hand(8, relative).n_instructions()


def test_the_loop_of_one_step_integrations_makes_the_same_run(
    study: Study,
) -> None:
    oscillators = study["oscillators"]
    machine, scenario = oscillators.machine_of(), oscillators.scenario_of(0.5, 101)
    rate = oscillators.right_side()
    truth = oscillators.reference(rate, scenario.t)
    loop = oscillators.one_step_loop(machine, scenario.t, np.abs(truth).max(axis=0))
    assert oscillators.error(loop(), truth) < 1e-5
    assert oscillators.error(oscillators.lsoda(rate, scenario.t, 1e-8, 1e-10), truth) < 1e-6


def test_contenders_of_the_force_give_the_same_numbers(study: Study) -> None:
    forces = study["forces"]
    machine = forces.oscillator()
    arguments = forces.arguments_of(machine, 1000)
    (ours,) = forces.along(machine.discrepancy, arguments, forces.HELD)
    (line,) = forces.straight_line(machine.discrepancy, arguments)
    assert ours[:, 0] == pytest.approx(line, rel=1e-12, abs=1e-12)
    assert ours == pytest.approx(forces.whole_arrays(machine, arguments), rel=1e-12, abs=1e-12)


def test_a_force_is_measured_in_a_process_of_its_own(study: Study) -> None:
    times = study["forces"].apart("pendulum", 2000, 1, SYMHYB_CC="")
    assert set(times) == {"ours", "numpy"}
    assert all(seconds > 0 for seconds in times.values())


@pytest.mark.slow
def test_rows_of_regression_name_their_bars(study: Study) -> None:
    rows = study["regression"].rows(2000, 200, 3, 1)
    assert [r.bar for r in rows] == [20, None, 0.05, 200]
    assert all(np.isfinite(r.value) and r.value > 0 for r in rows)


def test_contenders_of_the_regression_find_the_same_true_terms(
    study: Study,
) -> None:
    regression = study["regression"]
    candidates = regression.candidates_of(5000)
    matrix, right = regression.stored(candidates)
    assert matrix.shape == (5000, 100)
    ours = regression.regress(candidates, regression.optimizer())
    theirs = regression.plain(matrix, right)
    assert np.abs(ours - theirs).max() < 1e-10 * np.abs(theirs).max()
    found = {candidates.names[i]: ours[0, i] for i in np.flatnonzero(ours[0])}
    assert found == pytest.approx(regression.TRUE, rel=0.1)


def test_contenders_of_the_matching_find_the_planted_parameters(
    study: Study,
) -> None:
    """To within four deviations as ours states them; IPOPT's are no larger."""
    trajectories = study["trajectories"]
    given = trajectories.record(2001)
    ours = trajectories.matched(given)()
    reach = 4 * np.sqrt(np.diag(ours.covariance))
    assert np.all(np.abs(ours.values - trajectories.TRUE) < reach)
    assert np.all(np.abs(trajectories.shooting(given)() - trajectories.TRUE) < reach)
    assert np.all(reach < 0.5 * trajectories.TRUE)


@pytest.mark.slow
def test_rows_of_matching_name_their_bars(study: Study) -> None:
    rows = study["trajectories"].rows((2000, 3000), 1)
    assert [r.bar for r in rows] == [3, 1.5]
    assert all(np.isfinite(r.value) and r.value > 0 for r in rows)


@pytest.mark.skipif(find_compiler() is None, reason="no C compiler")
@pytest.mark.slow
def test_contenders_of_the_compiled_path_give_the_same_numbers(
    study: Study,
) -> None:
    compiled, oscillators = study["compiled"], study["oscillators"]
    machine, scenario = oscillators.machine_of(), oscillators.scenario_of(0.5, 101)
    truth = oscillators.reference(oscillators.right_side(), scenario.t)
    theirs = compiled.cvodes(machine, scenario.t, np.abs(truth).max(axis=0))()
    assert theirs == pytest.approx(truth, abs=1e-6)
    rows = compiled.run_rows(0.5, 51, 1) + compiled.gradient_rows(20, 41, 1)
    assert [r.bar for r in rows] == [15, None, 5]
    assert all(np.isfinite(r.value) and r.value > 0 for r in rows)
    assert "(explicit)" in rows[0].note
    pytest.importorskip("pinocchio")
    times, apart = compiled.right_sides(3, 50, 1)
    assert apart < 1e-12
    assert set(times) == {"ours", "aba"}


@pytest.mark.slow
def test_rows_of_simulation_name_their_bars(study: Study) -> None:
    oscillators = study["oscillators"]
    rows = oscillators.run_rows(0.5, 51, 1) + oscillators.sweep_rows(3, 0.1, 11, 1)
    assert [r.bar for r in rows] == [2.5, None, 50, 1.7, None]
    assert all(np.isfinite(r.value) and r.value > 0 for r in rows)


@pytest.mark.slow
def test_rows_of_exact_friction_name_their_bars(study: Study) -> None:
    rows = study["sticking"].rows(2.0, 201, 1)
    assert [r.bar for r in rows] == [5.0, 1e-6, 1.0] * 2
    assert all(r.met for r in rows if r.unit != "×")


@pytest.mark.slow
def test_rows_of_derivation_name_their_bars(study: Study) -> None:
    rows = study["links"].rows(2, 3, 1)
    bars = sorted(r.bar for r in rows if r.bar)
    assert bars == [1.6, 1.6, 4, 4, 30, 30, 200, 200]
    assert all(r.value > 0 for r in rows)


@pytest.mark.parametrize(
    ("value", "bar", "least", "met", "verdict"),
    [
        (3.0, 2.5, True, True, "met"),
        (2.0, 2.5, True, False, "missed by a factor of 1.25"),
        (3.0, 4.0, False, True, "met"),
        (6.0, 4.0, False, False, "missed by a factor of 1.50"),
        (6.0, None, False, None, ""),
    ],
)
def test_a_bar_is_met_or_missed(
    study: Study,
    value: float,
    bar: float | None,
    least: bool,
    met: bool | None,
    verdict: str,
) -> None:
    line = row(study, value, bar, least)
    assert (line.met, line.verdict) == (met, verdict)


def test_the_page_keeps_what_stands_around_the_table(study: Study) -> None:
    bench = study["bench"]
    table = bench.page_table([row(study, 2.0, 2.5, True)], {"processor": "of glass"})
    page = bench.replaced(f"# Page\n{bench.BEGIN}\nold\n{bench.END}\nbelow\n", table)
    assert page.startswith("# Page\n")
    assert page.endswith("below\n")
    assert "old" not in page
    assert "Measured on: processor of glass." in page
    assert "| what | 2 | ≥ 2.5 | missed by a factor of 1.25 |  |" in page
    with pytest.raises(ValueError, match="lacks the marks"):
        bench.replaced("# Page\n", table)


def test_the_page_shows_the_results_that_are_kept(study: Study) -> None:
    bench = study["bench"]
    kept = json.loads((FOLDER / "results.json").read_text(encoding="utf-8"))
    rows = []
    for entry in kept["rows"]:
        met = entry.pop("met")
        rows.append(study["timing"].Row(**entry))
        assert rows[-1].met == met
    assert bench.page_table(rows, kept["machine"]) in bench.PAGE.read_text(encoding="utf-8")


def test_one_part_is_kept_beside_the_others_of_the_same_machine(
    study: Study,
) -> None:
    bench, old = study["bench"], [row(study, 1.0, None, False), row(study, 2.0, 2.5, True)]
    kept = {
        "machine": {"processor": "of glass", "date": "2001-01-01"},
        "rows": [
            {**asdict(old[0]), "part": "other", "met": None},
            {**asdict(old[1]), "met": False},
        ],
    }
    new = row(study, 3.0, 2.5, True)
    rows = bench.beside([new], kept, {"processor": "of glass"})
    assert [(r.part, r.value) for r in rows] == [("other", 1.0), ("part", 3.0)]
    with pytest.raises(ValueError, match=r"were measured on .*of glass.* these on .*of stone"):
        bench.beside([new], kept, {"processor": "of stone"})


@pytest.mark.parametrize("name", ["read_model", "build", "simulate"])
def test_what_simulates_loads_nothing_that_diagnoses(study: Study, name: str) -> None:
    """A fresh interpreter, after a public name has been asked for."""
    absent = ("pysindy", "sklearn", "matplotlib", "pandas", "scipy.signal", "joblib")
    code = f"import sys, symhyb; symhyb.{name}; print(*({set(absent)!r} & sys.modules.keys()))"
    done = study["starting"].started(code)()
    assert done.stdout.decode().split() == []


def test_the_machine_is_described_without_names(study: Study) -> None:
    reported = study["timing"].machine()
    assert reported["casadi"] == ca.__version__
    assert "cores" in reported["processor"]
    assert "/" not in "".join(reported.values())


@pytest.mark.parametrize("masses", [1, 3])
def test_the_chain_moves_as_its_equations_say(study: Study, masses: int) -> None:
    """What is recorded, differentiated twice, against the forces of the model and the damper."""
    growth = study["growth"]
    table = growth.recorded(masses, 3000, noise=0.0)
    t, push, x = table[:, 0], table[:, 1], table[:, 2:]
    spline = make_interp_spline(t, x, k=7)
    v, a = (spline.derivative(order)(t)[50:-50] for order in (1, 2))
    x, left = x[50:-50], np.zeros((len(t) - 100, masses))
    left[:, 0] = push[50:-50]
    for i in range(masses):
        stretch = x[:, i] - (x[:, i - 1] if i else 0), v[:, i] - (v[:, i - 1] if i else 0)
        force = growth.STIFFNESS * stretch[0] + growth.DAMPING * stretch[1]
        left[:, i] -= force
        if i:
            left[:, i - 1] += force
    left[:, masses // 2] -= growth.CONCEALED * v[:, masses // 2]
    assert growth.MASS * a == pytest.approx(left, abs=2e-3 * np.abs(left).max())
    assert len(parse_model(growth.chain(masses)).coordinates) == masses


def test_every_model_has_a_run_and_its_inputs_move(study: Study) -> None:
    runs = study["runs"]
    assert set(runs.SIZES) | set(runs.MEANS) <= set(runs.names())
    for name in ("six_joint_arm", "quarter_car", "pendulum"):
        machine, scenario = runs.scenario_of(name, 1.0)
        assert scenario.u.shape == (scenario.t_u.size, len(machine.model.inputs))
        assert (np.ptp(scenario.u, axis=0) > 0).all()
        if scenario.given is not None:  # places, speeds and accelerations go together
            q, v, a = scenario.given.T
            assert v[1:-1] == pytest.approx((q[2:] - q[:-2]) * runs.RATE / 2, rel=1e-2, abs=1e-2)
            assert a[1:-1] == pytest.approx((v[2:] - v[:-2]) * runs.RATE / 2, rel=1e-2, abs=1e-1)


def test_a_run_is_held_against_each_method(study: Study) -> None:
    runs = study["runs"]
    row = runs.row("pendulum", 1.0)
    assert row.bar is None or row.bar == 2.0
    assert all(f"{method} " in row.note for method in ("explicit", "bdf", "adams"))
    assert "early" not in row.note
    assert runs.row("rig_alone", 1.0) is None


@pytest.mark.browser
def test_a_page_counts_as_open_once_its_scripts_have_run(study: Study, tmp_path: Path) -> None:
    page = tmp_path / "busy.html"
    wait = "const end = performance.now() + 400; while (performance.now() < end) {}"
    page.write_text(f"<script>addEventListener('load', () => {{ {wait} }})</script>")
    assert study["pages"].opened(page, 1) >= 0.4


def test_the_study_of_the_workers_has_as_many_tasks_as_wanted(study: Study, tmp_path: Path) -> None:
    tasks = tasks_of(read_study(study["workers"].written(tmp_path, 5)))
    assert len({one.key for one in tasks}) == 5
    assert [one.study.noise.seed for one in tasks] == list(range(5))


@pytest.mark.slow
def test_the_day_of_the_arm_is_that_of_its_model_but_for_the_friction(
    study: Study, tmp_path: Path
) -> None:
    streaming = study["streaming"]
    path = tmp_path / "day.parquet"
    streaming.write_day(path, 20_000)
    model = sh.read_model(streaming.MODEL)
    day = sh.read_recording(path, model)
    assert len(day) == 20_000
    gap = sh.compare(model, day)
    size = np.sqrt(np.mean(gap.force**2, axis=0))
    assert size[0] < 0.01 * np.sqrt(np.mean(gap.applied[:, 0] ** 2))
    assert size[1] == pytest.approx(streaming.COULOMB, rel=0.03)

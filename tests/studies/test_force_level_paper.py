"""The paper's comparison: its reference and its hosts are right, its page says what was kept."""

from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest

from tests.scripts import scripts

NAMES = ("truth", "learn", "hosts", "run", "tables", "cart_pole")


@pytest.fixture(scope="module")
def study() -> Iterator[SimpleNamespace]:
    """The scripts of the study as modules."""
    with scripts("force_level_paper", NAMES) as found:
        yield SimpleNamespace(**found)


def test_friction_takes_its_work_and_holds_the_mass_where_it_must(study: SimpleNamespace) -> None:
    """Without drag and drive, c q⁴/4 falls by F_c times the way at every reversal, until
    c |q|³ ≤ F_c."""
    it = study.truth.Oscillator(1.0, 5.0, 0.0, 0.02, 0.9, study.truth.Drive(0.0, 1.0))
    t = study.truth.times()
    q, v, a = study.truth.simulate(it.plant(it.drive), t, np.array([0.9]), np.zeros(1))
    stored = v[:, 0] ** 2 / 2 + it.c * q[:, 0] ** 4 / 4
    # between two samples without a reversal the way is the change of place
    same = np.sign(v[1:, 0]) * np.sign(v[:-1, 0]) > 0
    way = np.abs(np.diff(q[:, 0]))
    assert np.diff(stored)[same] == pytest.approx(-it.coulomb * way[same], abs=1e-10)
    assert (np.diff(stored) <= 1e-12).all()
    assert v[-1, 0] == 0
    assert a[-1, 0] == 0
    assert it.c * abs(q[-1, 0]) ** 3 <= it.coulomb


def test_a_mass_at_rest_is_torn_off_when_the_drive_exceeds_friction(study: SimpleNamespace) -> None:
    it = study.truth.Oscillator(1.0, 5.0, 0.3, 0.02, 0.0, study.truth.Drive(0.4, 0.25))
    t = study.truth.times(2.0)
    v = study.truth.simulate(it.plant(it.drive), t, np.zeros(1), np.zeros(1))[1][:, 0]
    torn = np.arcsin(it.coulomb / 0.4) / (2 * np.pi * 0.25)
    assert (v[t < torn] == 0).all()
    assert (v[(t > torn + 0.02) & (t < 1.0)] > 0).all()


@pytest.mark.parametrize("host", ["Exudyn", "MuJoCo"])
def test_a_host_moves_as_the_reference_does(study: SimpleNamespace, host: str) -> None:
    """Alone, with the true force asked within its stages, and with one held over its steps."""
    truth, hosts = study.truth, study.hosts
    it = truth.draw(0).machine
    t, start = truth.times(1.0), np.array([it.q0])
    machine = hosts.oscillator_in(host, it, it.drive)
    bare = truth.simulate(it.plant(it.drive, complete=False), t, start, np.zeros(1))
    q, v = machine.run(None, t, 1e-3)
    assert truth.rmse(q, bare[0]) < 1e-9
    assert truth.rmse(v, bare[1]) < 1e-9
    whole = truth.simulate(it.plant(it.drive), t, start, np.zeros(1))
    asked: list[float] = []

    def missing(now: float, q: np.ndarray, v: np.ndarray) -> list[float]:
        asked.append(now)
        return [float(it.missing(np.array(v))[0])]

    errors = []
    for held in (False, True):
        law = hosts.Law(missing, lambda t, h: asked.append(t), held)
        errors.append(truth.rmse(machine.run(law, t, 1e-2)[0], whole[0]))
    apart = truth.rmse(bare[0], whole[0])
    assert errors[0] < 0.02 * apart
    assert errors[0] < errors[1] < 0.2 * apart
    assert len(asked) > 500  # every stage of a hundred steps, and every step twice


@pytest.mark.parametrize("host", ["Exudyn", "MuJoCo"])
def test_a_host_with_two_coordinates_does_too(study: SimpleNamespace, host: str) -> None:
    truth, own = study.truth, study.cart_pole
    t = truth.times(0.5)
    exact = truth.simulate(own.plant(own.DRIVE), t, own.START, np.zeros(2))

    def missing(now: float, q: np.ndarray, v: np.ndarray) -> list[float]:
        return [-own.COULOMB * float(np.sign(v[0])), -own.DRAG * float(abs(v[1]) * v[1])]

    law = study.hosts.Law(missing, lambda t, h: None, False)
    q, _ = own.host_of(host, own.DRIVE).run(law, t, 1e-3)
    assert truth.rmse(q, exact[0]) < 1e-4


def test_the_model_lacks_what_the_reference_has(study: SimpleNamespace) -> None:
    """ΔF of the exact motion along the model is the drag and the friction that were left out, and
    the samples are split as they are said to be."""
    truth, learn = study.truth, study.learn
    it = truth.draw(0).machine
    data = truth.recorded(it, 0, 5.0)
    assert data.train.sum() == round(0.7 * data.t.size)
    assert np.std(data.q - data.exact[0]) == pytest.approx(data.sd[0, 0], rel=0.1)
    machine = learn.sh.build(learn.model_of(it, it.drive, data))
    course = learn.measured_course(machine, data.t, data.exact, np.empty((data.t.size, 0)))
    force = learn.lacking(machine, course, "force")[:, 0]
    moving = np.abs(data.exact[1][:, 0]) > 0
    assert force[moving] == pytest.approx(it.missing(data.exact[1])[moving, 0], abs=1e-9)
    nets = learn.default_networks(machine, course, "force", 0)
    assert nets.rows[0].layers[0].activation == "relu"
    assert nets.rows[0].layers[0].bias.size == 10
    assert truth.nrmse(learn.values_along(machine, course, nets)[:, 0], force) < 0.05


def test_the_page_holds_what_the_files_say(study: SimpleNamespace) -> None:
    """Nothing in the section of results is typed by hand."""
    tables = study.tables
    page = tables.README.read_text(encoding="utf-8")
    assert tables.between_marks(page, tables.text(tables.read())) == page


def test_what_runs_away_is_worse_than_everything(study: SimpleNamespace) -> None:
    tables = study.tables
    assert tables.spread([0.1, 0.2, 0.3]) == "0.2 (0.15 – 0.25)"
    assert tables.middle([0.1, None, None]) == np.inf
    assert tables.spread([0.1, None, None]).startswith("runs away")
    assert study.run.rounded({"a": [float("nan"), 0.123456, 3]}) == {"a": [None, 0.1235, 3]}


@pytest.mark.thorough
def test_a_set_from_end_to_end(study: SimpleNamespace) -> None:
    """One set of parameters through every learner, formulation, host and coupling."""
    reported = study.run.one(0, steps=(1e-3,), excitations=2)
    assert study.tables.right(reported["learned"])
    first, second = reported["simulated"].values()
    assert first["sparse"]["force"][0] < reported["noise"][0]
    assert second["default"]["force"][0] > 5 * second["sparse"]["force"][0]
    for row in study.learn.ROWS:
        for host in study.hosts.HOSTS:
            made = reported["hosts"][row][host]
            off = [made[c]["0.001"]["coupling"][0] for c in study.hosts.COUPLINGS]
            whole = first["alone"]["force"][0]
            assert off[0] == pytest.approx(off[2], abs=1e-9)  # CasADi and model exchange
            assert off[2] < 1e-3 * whole
            assert off[2] < off[1] < 0.01 * whole
    # a network is no law: it cannot do what its noisy samples do not say
    floor = reported["nrmse"]["noise"]["force"][1]
    assert all(reported["nrmse"][row]["force"][1] > 0.9 * floor for row in study.learn.ROWS)
    assert reported["nrmse"]["sparse"]["force"][1] < 1.2 * floor

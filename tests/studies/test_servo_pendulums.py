"""The free falls of a hobby servo: what is read of them, the fits by hand, and that a model whose
weight and length each recording knows falls as these fits do."""

from collections.abc import Iterator, Mapping
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

import symhyb as sh
from symhyb.data.refresh import refresh
from tests.absent import absent
from tests.scripts import scripts

NAMES = ("falls", "by_hand", "diagnose", "ladder")
BY_HAND = np.array([0.00677, 0.00827, 0.01721, 0.4389, 0.0])  # J, c, F, mu, d of losses with load
BY_MOUNT = np.array(  # c and F of every mount, beside J 0.0095 and mu 0.2447
    [
        [0.0188, 0.0324, 0.0155, 0.0437, 0.0103, 0.0377, 0.0321, 0.0287],
        [0.0183, 0.0128, 0.0285, 0.0367, 0.0388, 0.0303, 0.0442, 0.0910],
    ]
)
BY_MOUNT_LATE = np.array(  # the same beside J 0.01075 and a beginning 20.96 ms late, without mu
    [
        [0.0330, 0.05293, 0.03268, 0.07021, 0.03085, 0.07044, 0.05582, 0.06357],
        [0.02243, 0.01915, 0.03359, 0.04706, 0.04421, 0.03783, 0.0536, 0.1132],
    ]
)
LOAD = "m*g*l*sin(q)"


@pytest.fixture(scope="module")
def parts() -> Iterator[Mapping[str, ModuleType]]:
    """The scripts of the study, beside each other."""
    with scripts("servo_pendulums", NAMES) as found:
        yield found


@pytest.fixture(scope="module")
def study(parts) -> ModuleType:
    """The diagnosis of the study, which has the other scripts."""
    return parts["diagnose"]


@pytest.fixture(scope="module")
def falls(study):
    folder = study.folder_of_runs()
    if folder is None:
        absent("set SYMHYB_DATA to a folder that holds servo_pendulums")
    return study.read_falls(folder)


@pytest.fixture(scope="module")
def with_losses(study) -> sh.Model:
    """The model with the losses that were fitted by hand."""
    inertia, damping, dry, share = (f"{value:.6g}" for value in BY_HAND[:4])
    text = study.MODEL.read_text(encoding="utf-8")
    text += f"""
[elements.rotor]
kind = "added_mass"
on = "q"
mass = "J"

[elements.loss]
kind = "damper"
on = "q"
damping = "c"

[elements.gear]
kind = "friction"
on = "q"
coulomb = "F"
transition = "w"
load_coefficient = "mu"
load = "{LOAD}"
"""
    numbers = f"""[parameters]
J = {{ value = {inertia}, unit = "kg*m^2" }}
c = {{ value = {damping}, unit = "N*m*s/rad" }}
F = {{ value = {dry}, unit = "N*m" }}
w = {{ value = 0.02, unit = "rad/s" }}
mu = {{ value = {share}, unit = "1" }}
"""
    return sh.parse_model(text.replace("[parameters]\n", numbers, 1))


def test_falls_are_split_before_anything_is_learned(study, falls):
    learned, unseen = study.split(falls)
    assert (len(falls), len(learned), len(unseen)) == (192, 96, 96)
    assert not {fall.run for fall in learned} & {fall.run for fall in unseen}
    for part in (learned, unseen):
        assert len({(fall.mass, fall.length) for fall in part}) == 8
    chosen = study.chosen(learned, 2)
    assert len(chosen) == 16
    assert len({(fall.mass, fall.length) for fall in chosen}) == 8


def test_read_errors_of_the_encoder_are_left_missing(falls):
    misread = {fall.run: int(np.isnan(fall.q).sum()) for fall in falls if np.isnan(fall.q).any()}
    assert misread == {146: 1, 769: 1}  # those of 322 and 1029 come after three seconds
    for fall in falls:
        assert np.nanmax(np.abs(fall.q)) < 1.7
        assert (np.diff(fall.t) > 0).all()


def test_the_errors_by_hand_are_those_that_the_page_says(study, falls):
    _, unseen = study.split(falls)
    assert 1e3 * study.error(np.zeros(5), unseen) == pytest.approx(1081, abs=1)
    assert 1e3 * study.error(BY_HAND, unseen) == pytest.approx(59.7, abs=0.2)


def test_an_arm_that_is_let_go_late_waits_and_falls_the_same(parts):
    mass, length, start = np.array([0.5, 1.1]), np.array([0.15, 0.1]), np.array([-1.5, -1.2])
    numbers = np.array([0.01, 0.03, 0.04, 0.1, 0.0])[:, None] * np.ones(2)
    simulated = parts["by_hand"].simulated
    prompt = simulated(numbers, mass, length, start, 100)
    numbers[4] = 0.03  # s: three of the angles
    late = simulated(numbers, mass, length, start, 100)
    np.testing.assert_array_equal(late[:, :4], start[:, None] * np.ones(4))
    np.testing.assert_allclose(late[:, 3:], prompt[:, :-3], atol=1e-12)
    numbers[4] = 0.0304
    between = simulated(numbers, mass, length, start, 100)
    assert np.abs(between - late).max() < 0.0005 * np.abs(np.gradient(prompt, 0.01)[1]).max()


def test_friction_of_each_mount_halves_the_errors_on_unseen_falls(study, falls):
    _, unseen = study.split(falls)
    ones = np.ones(8)
    numbers = np.array([0.0095 * ones, *BY_MOUNT, 0.2447 * ones, 0 * ones])
    assert 1e3 * study.error(numbers[:, study.mounts(unseen)], unseen) == pytest.approx(
        26.4, abs=0.3
    )
    late = np.array([0.01075 * ones, *BY_MOUNT_LATE, 0 * ones, 0.02096 * ones])
    assert 1e3 * study.error(late[:, study.mounts(unseen)], unseen) == pytest.approx(26.4, abs=0.3)
    swapped = numbers[:, study.mounts(unseen)[::-1]]
    assert 1e3 * study.error(swapped, unseen) > 60


@pytest.mark.slow
def test_the_encoder_is_refreshed_every_eight_milliseconds(study, falls):
    """The sentence of the page on the clock of the encoder."""
    learned, _ = study.split(falls)
    found = refresh([(fall.t, fall.q) for fall in study.chosen(learned, 1)])
    assert found is not None
    assert found.period == pytest.approx(8.0e-3, rel=3e-3)
    explained = [one for one in found.each if one is not None]
    assert len(explained) >= 6
    assert all(one.after < (2e-3) ** 2 for one in explained)


def test_the_model_falls_with_the_weight_that_each_recording_knows(study, falls, with_losses):
    _, unseen = study.split(falls)
    some = study.chosen(unseen, 1)
    wanted = study.error(BY_HAND, some)
    assert study.open_loop(with_losses, some) == pytest.approx(wanted, rel=0.02)


@pytest.mark.slow
def test_inertia_and_friction_by_load_are_named_on_simulated_falls(study, with_losses):
    """Four falls of such a machine, each with its known weight, and nothing that no law states."""
    bare = sh.read_model(study.MODEL)
    acting = {"J": 0.007, "c": 0.0, "F": 0.01, "w": 0.002, "mu": 0.2}
    falls = []
    for i, (mass, length) in enumerate(((0.535, 0.1), (0.741, 0.15), (1.168, 0.1), (0.969, 0.15))):
        known = {"m": mass, "l": length}
        run = sh.simulate(with_losses, end=3.0, step=0.01, parameters={**known, **acting})
        noise = 2e-3 * np.random.default_rng(i).standard_normal(run.t.size)
        frame = {"t": run.t, "encoder": run.y[:, 0] + noise}
        falls.append(sh.Recording.from_frame(frame, bare, name=f"fall {i}", parameters=known))
    diagnosis = sh.diagnose(bare, falls)
    assert diagnosis.verdict == "missing physics"
    found = {one.element.kind: one for one in diagnosis.found}
    assert set(found) == {"added_mass", "friction"}
    truth = {"mass": 0.007, "coulomb": 0.01, "load_coefficient": 0.2}
    for one in found.values():
        for estimate in one.estimates:
            wanted = truth.pop(estimate.term)
            assert estimate.value == pytest.approx(wanted, rel=0.05)
            assert abs(estimate.value - wanted) < 4 * estimate.sd
    assert not truth


def falling(ladder: ModuleType, numbers: np.ndarray, count: int) -> list[SimpleNamespace]:
    """Two falls of one mount, simulated with M4."""
    mass, length, start = np.full(2, 0.6), np.full(2, 0.12), np.array([1.2, 0.5])
    angles = ladder.simulated(numbers[:5], mass, length, start, count, numbers[5:])
    t = np.arange(count) * 0.01
    return [SimpleNamespace(t=t, q=row, mass=0.6, length=0.12) for row in angles]


RISING = np.array([0.01, 0.03, 0.02, 0.0, 0.0, 0.1, 0.0, 0.5, 1.5])


def test_friction_that_rises_towards_rest_holds_an_arm_earlier(parts, monkeypatch) -> None:
    ladder = parts["ladder"]
    monkeypatch.setattr(parts["by_hand"], "LASTS", 0.8)
    falls = falling(ladder, RISING, 80)
    assert ladder.error(RISING, falls) < 1e-12
    without = RISING * [1, 1, 1, 1, 1, 0, 0, 1, 1]
    assert ladder.error(without, falls) > 0.01
    one = np.array([0.6]), np.array([0.12]), np.array([1.2]), 80
    plain = ladder.simulated(without[:5], *one)
    assert ladder.simulated(without[:5], *one, without[5:]) == pytest.approx(plain)


@pytest.mark.slow
def test_the_ladder_finds_friction_that_rises_towards_rest(parts, monkeypatch) -> None:
    ladder = parts["ladder"]
    monkeypatch.setattr(parts["by_hand"], "LASTS", 0.8)
    falls = falling(ladder, RISING, 80)
    errors = {
        name: ladder.error(ladder.fitted(falls, ladder.MODELS[name]), falls)
        for name in ("M1", "M2")
    }
    assert errors["M1"] > 0.003
    assert errors["M2"] < 1e-3

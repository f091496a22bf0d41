r"""A coupling of two coordinates becomes laws of the pair; one that acts one way does not.

^ b          M q'' = −K q − D q' + by_place·q + by_rate·q' + u, exactly, by SciPy
└──▶ a
"""

import numpy as np
import pytest
from scipy.signal import lsim

from symhyb.correction.adequacy.beyond import NOTHING
from symhyb.correction.adequacy.judge import Adequacy, adequacy
from symhyb.correction.adequacy.named_coupling import couplings_instead, one_way, pair_of
from symhyb.correction.adequacy.pairs import coupled, pair_forces, pair_size
from symhyb.correction.adequacy.recorded import Recorded, recorded
from symhyb.correction.adequacy.structure import Generic, Likely
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.trajectory import grouped, refine
from symhyb.data.recording import Recording
from symhyb.judgement import ACCURACY
from symhyb.model.read import parse_model
from symhyb.model.types import On, Pair
from tests.pushed import STEP, pushing

PLATE = """\
symhyb = 1
[coordinates]
a = { unit = "rad" }
b = { unit = "rad" }
[parameters]
J_a = { value = 1.0, unit = "kg*m^2" }
J_b = { value = 1.3, unit = "kg*m^2" }
k_a = { value = 25.0, unit = "N*m/rad", sd = 0.5 }
k_b = { value = 40.0, unit = "N*m/rad", sd = 0.8 }
d = { value = 0.6, unit = "N*m*s/rad", sd = 0.1 }
[inputs]
t_a = { unit = "N*m" }
t_b = { unit = "N*m" }
[energy]
kinetic = "J_a*a'**2/2 + J_b*b'**2/2"
[elements]
spring_a = { kind = "spring", on = "a", stiffness = "k_a" }
spring_b = { kind = "spring", on = "b", stiffness = "k_b" }
bearing_a = { kind = "damper", on = "a", damping = "d" }
bearing_b = { kind = "damper", on = "b", damping = "d" }
motor_a = { kind = "torque", on = "a", torque = "t_a" }
motor_b = { kind = "torque", on = "b", torque = "t_b" }
[sensors]
pos_a = { measures = "a", unit = "rad" }
pos_b = { measures = "b", unit = "rad" }
"""
NOISE = 1e-3
TURN = np.array([[0.0, 1.0], [-1.0, 0.0]])
PAIR = Pair("a", "b")


def tilted(
    seed: int, by_place: np.ndarray = 0 * TURN, by_rate: np.ndarray = 0 * TURN, samples: int = 900
) -> Recording:
    """The plate with forces of each coordinate by the other."""
    inverse = np.diag([1.0, 1 / 1.3])
    own = np.diag([25.0, 40.0])
    top = np.hstack([np.zeros((2, 2)), np.eye(2)])
    A = np.vstack(
        [top, np.hstack([inverse @ (by_place - own), inverse @ (by_rate - 0.6 * np.eye(2))])]
    )
    B = np.vstack([np.zeros((2, 2)), inverse])
    t = STEP * np.arange(samples)
    random = np.random.default_rng(seed)
    u = np.column_stack([pushing(random, t), pushing(random, t)])
    _, q, _ = lsim((A, B, np.eye(2, 4), np.zeros((2, 2))), u, t)
    seen = q + NOISE * np.random.default_rng(900 + seed).standard_normal(q.shape)
    sensors = {"pos_a": seen[:, 0], "pos_b": seen[:, 1]}
    return Recording("made.csv", t, {"t_a": u[:, 0], "t_b": u[:, 1]}, sensors, (), "")


def judged(recording: Recording) -> tuple[Recorded, Adequacy]:
    """The judgement of the plate as it is."""
    prepared = prepare(parse_model(PLATE), recording)
    setting = settle(prepared)
    cuts = setting.stages[-1].cuts
    final = refine(prepared.model, (), (), cuts, setting.sd)
    ground = recorded(prepared, setting)
    assert ground is not None
    return ground, adequacy(prepared, setting, final, (final, cuts))


CASES = {
    "gyroscopic": (0 * TURN, 0.5 * TURN, {"gyroscopic": 0.5}),
    "circulatory": (-2.0 * TURN, 0 * TURN, {"circulatory": -2.0}),
    "skew": (-1.5 * np.abs(TURN), 0 * TURN, {"skew_spring": 1.5}),
    "both": (-1.5 * np.abs(TURN), 0.5 * TURN, {"gyroscopic": 0.5, "skew_spring": 1.5}),
    "damper": (0 * TURN, -0.4 * np.abs(TURN), {"skew_damper": 0.4}),
}


@pytest.mark.parametrize(
    "case", [one if one == "both" else pytest.param(one, marks=pytest.mark.slow) for one in CASES]
)
def test_what_couples_two_coordinates_has_its_name_and_its_number(case: str) -> None:
    by_place, by_rate, true = CASES[case]
    ground, found = judged(tilted(3, by_place, by_rate))
    assert pair_of(found) == PAIR
    answer = couplings_instead(ground, found)
    assert answer is not None
    assert {cause.kind for cause in answer.causes} == true.keys()
    spread = np.sqrt(np.diag(answer.fit.covariance))
    for i, (cause, row) in enumerate(zip(answer.causes, grouped(answer), strict=True)):
        assert cause.place == PAIR
        (value,) = row.values()
        deviation = np.hypot(spread[i], ACCURACY * value)
        assert abs(value - true[cause.kind]) < 3.5 * deviation < 0.1 * abs(value)
    assert answer.evidence > found.by_class.evidence  # type: ignore[union-attr]
    assert not one_way(answer, PAIR)


def test_what_acts_one_way_stays_the_class() -> None:
    """A force on a by the place of b and none back: half of it is a coupling spring, half of it
    circulatory, and it is neither."""
    ground, found = judged(tilted(5, by_place=np.array([[0.0, 3.0], [0.0, 0.0]])))
    assert pair_of(found) == PAIR
    assert couplings_instead(ground, found) is None


def test_where_nothing_acts_there_is_no_pair() -> None:
    ground, found = judged(tilted(7))
    assert pair_of(found) is None
    assert couplings_instead(ground, found) is None


def test_the_force_of_one_unit_is_that_of_the_law() -> None:
    ground, _ = judged(tilted(7, samples=300))
    (item,) = ground.items
    course, rows = item.course(ground.windows.machine), item.rows[0]
    (force,) = pair_forces(ground, coupled("gyroscopic", PAIR))
    assert force == pytest.approx(course.v[rows] @ TURN.T)
    share = np.sqrt(np.mean(force**2, axis=0)) / ground.scale
    assert pair_size(ground, coupled("gyroscopic", PAIR)) == pytest.approx(1 / share.max())


def test_a_class_at_an_input_is_no_pair() -> None:
    generic = Generic("coupling", "t_a", (), np.ones(1))
    assert pair_of(Adequacy(NOTHING, (Likely(generic, 1.0),))) is None
    at_one = Generic("coupling", On("a"), (), np.ones(1), other="b")
    assert pair_of(Adequacy(NOTHING, (Likely(at_one, 1.0),))) == PAIR
    assert pair_of(Adequacy(NOTHING, (Likely(at_one, 0.9),))) is None
    assert pair_of(Adequacy(NOTHING, (Likely(at_one, 1.0, whole=False),))) is None

"""The score of a structure: an exact marginal likelihood where everything is linear and normal."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from symhyb.correction.adequacy.classes.catalogue import classes_of
from symhyb.correction.adequacy.classes.columns import LENGTHS
from symhyb.correction.adequacy.curves.prior import of_curve
from symhyb.correction.adequacy.evidence import (
    APART,
    candidates,
    classes,
    evidence,
    priors,
    strength_scales,
)
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, fitted, tracks_of
from symhyb.discrepancy.likelihood.fit import FAILED, SETTLED
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import Extra, white_problem
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws.curve import value_name
from symhyb.model.types import On
from symhyb.numeric.kernels.buffers import Array
from tests.builders import DRIVEN_MASS
from tests.pushed import NOISE, pushed, pushed_model, setting_of

CERTAIN_MODEL = DRIVEN_MASS.replace(", sd = 0.5", "")


def cause_of(setting: Recorded, kind: str, *terms: str) -> Hypothesis:
    """The first candidate of a kind with these terms, or on this path."""
    (found, *_) = (
        cause
        for cause in setting.hypotheses
        if cause.kind == kind and terms in (cause.terms, (cause.path,)) and not cause.shape
    )
    return found


def scored(setting: Recorded, causes: list[Hypothesis], *rows: dict[str, float]) -> Fitted:
    found = fitted(setting, causes, rows, setting.first_noise(slow=True))
    return replace(found, evidence=evidence(setting, found))


def white_noise() -> NoiseModel:
    return NoiseModel(np.zeros(1), 1.0, np.array([NOISE]), np.zeros(1), 1.0)


@pytest.fixture(scope="module")
def offset() -> Recorded:
    """A model without uncertain numbers and a recording under a constant force of 0.3 N."""
    return setting_of(pushed_model(CERTAIN_MODEL), pushed(1, beside=np.full(600, 0.3)))


def exact(setting: Recorded, trial: Fitted, prior: Array | None = None) -> float:
    """ln of the marginal likelihood with all numbers of a trial integrated out under their priors,
    of the covariance ``prior``, if that is given, from its white problem at none of them:
    residual = −columns·θ + unit noise."""
    mean, spread = priors(setting, trial)
    assert not np.any(mean)
    none = replace(trial.fit, values=np.zeros_like(mean))
    tracks = tracks_of(setting, replace(trial, p=trial.machine.values, fit=none, each=()))
    parts = [white_problem(at, trial.fit.noise) for at in tracks]
    residual = np.concatenate([part[0] for part in parts])
    given = np.zeros((residual.size, mean.size))
    rows = np.cumsum([0, *(part[0].size for part in parts)])
    for i, (_, columns, _) in enumerate(parts):
        own = list(trial.owned[i]) if trial.owned else slice(None)
        given[rows[i] : rows[i + 1], own] = columns
    prior = np.diag(spread**2) if prior is None else prior
    covariance = np.eye(residual.size) + given @ prior @ given.T
    wide = multivariate_normal(np.zeros(residual.size), covariance).logpdf(residual)
    return float(wide - 0.5 * sum(part[2] for part in parts))


def prices(setting: Recorded, trial: Fitted) -> float:
    """What the score takes off for sizes of noise and for causes."""
    fit = trial.fit
    odds = len(trial.causes) * np.log(candidates(setting))
    odds += 0 if trial.extra is None else np.log(classes(setting) * trial.extra.tried)
    return float(0.5 * fit.noise.numbers * np.log(fit.count) + odds)


@pytest.mark.parametrize(
    "kinds", [("constant",), ("offset f",), ("constant", "offset laser"), ("offset laser",)]
)
def test_it_is_the_exact_marginal_likelihood_of_a_linear_problem(
    offset: Recorded, kinds: tuple[str, ...]
) -> None:
    """A constant force and offsets of channels under known noise, alone and all but alike."""
    causes = [
        cause_of(offset, "constant", "constant")
        if kind == "constant"
        else cause_of(offset, "offset", f"{kind.split()[1]}.offset")
        for kind in kinds
    ]
    rows = [{"constant" if cause.place else "value": 0.0} for cause in causes]
    trial = fitted(offset, causes, rows, white_noise(), known_noise=True)
    score = evidence(offset, trial) + prices(offset, trial)
    assert score == pytest.approx(exact(offset, trial), abs=0.1)
    base = fitted(offset, (), (), white_noise(), known_noise=True)
    assert score > base.fit.logl + 50


def test_by_reference_a_number_costs_what_one_sample_says_of_it(offset: Recorded) -> None:
    (constant,) = causes = [cause_of(offset, "constant", "constant")]
    assert constant.numbers == 1
    trial = fitted(offset, causes, [{"constant": 0.0}], white_noise(), known_noise=True)
    score = evidence(offset, trial, by_reference=True) + prices(offset, trial)
    assert score == pytest.approx(trial.fit.logl - 0.5 * np.log(trial.fit.count + 1), abs=1e-9)


def test_the_coefficients_of_a_class_are_integrated_out_exactly(offset: Recorded) -> None:
    random = np.random.default_rng(3)
    (item,) = offset.items
    size = item.block.t.size
    columns = np.cumsum(random.standard_normal((size, 1, 4)), axis=0) / 20
    extra = Extra(columns, np.zeros((size, 1, 4)))
    generic = Generic("law", "x", (extra,), np.array([0.5, 1.0, 1e-3, 0.2]))
    trial = fitted(offset, (), (), white_noise(), known_noise=True, extra=generic)
    score = evidence(offset, trial) + prices(offset, trial)
    assert score == pytest.approx(exact(offset, trial), abs=0.1)
    assert np.linalg.norm(trial.fit.values) > 0.01


@pytest.mark.parametrize("through_zero", [False, True])
def test_the_values_of_a_curve_lie_along_a_smooth_line(
    offset: Recorded, through_zero: bool
) -> None:
    """Eight points, of which a recording of 0.3 N shows few: values are moved by the prior."""
    (item,) = offset.items
    course = item.course(offset.windows.machine)
    speed = course.v[:, 0]
    x = [float(v) for v in np.unique(np.append(np.linspace(speed.min(), speed.max(), 7), 0.0))]
    keys = [value_name(i) for i, at in enumerate(x) if not (through_zero and at == 0)]
    points = tuple((at, 0.1 * at, 0.0) for at in x)
    over = (("over", "rate"),)
    curve = Hypothesis(
        "curve", On("x"), tuple(keys), (False,) * len(keys), options=over, points=points
    )
    row = {key: 0.1 * at for key, (at, _, _) in curve.unknown.items()}
    trial = fitted(offset, [curve], [row], white_noise(), known_noise=True)
    score = evidence(offset, trial) + prices(offset, trial)
    (_, size), found = (row[0] for row in priors(offset, trial)), []
    for length in LENGTHS:
        prior = size**2 * of_curve(curve, length)
        found.append(exact(offset, trial, prior))
    # its columns are those along the fitted trajectory, which each of the priors moves a little
    assert score == pytest.approx(max(found) - np.log(len(LENGTHS)), abs=1.0)
    apart = exact(offset, trial, size**2 * np.eye(len(keys)))
    assert max(found) > apart + 4


def two_forces(first: float, second: float) -> tuple[Recorded, Hypothesis]:
    """Two recordings under a constant force each, and that force with a strength for each."""
    model = pushed_model(CERTAIN_MODEL)
    pair = [pushed(seed, beside=np.full(600, one)) for seed, one in ((1, first), (2, second))]
    setting = setting_of(model, *(replace(one, name=f"{i}") for i, one in enumerate(pair)))
    constant = cause_of(setting, "constant", "constant")
    return setting, replace(constant, own=("constant",))


@pytest.mark.slow
@pytest.mark.parametrize("forces", [(0.3, 0.31), (0.3, -0.2), (0.3, 0.0)])
def test_own_strengths_are_those_of_one_population(forces: tuple[float, float]) -> None:
    """A mean that is known as a shared strength is, and the likeliest of some sizes by which the
    recordings differ from it."""
    setting, own = two_forces(*forces)
    rows = [{"constant@0": 0.0, "constant@1": 0.0, "constant": 0.0}]
    trial = fitted(setting, [own], rows, white_noise(), known_noise=True)
    assert trial.fit.values == pytest.approx(forces, abs=0.02)
    score = evidence(setting, trial) + prices(setting, trial)
    (_, spread), found = priors(setting, trial), []
    for apart in APART:
        prior = np.outer(spread, spread) * (1.0 + apart**2 * np.eye(2))
        found.append(exact(setting, trial, prior))
    assert score == pytest.approx(max(found) - np.log(len(APART)), abs=0.1)
    likeliest = APART[int(np.argmax(found))]
    near = abs(forces[0] - forces[1]) / float(spread[0])
    assert likeliest == APART[0] or near / 5 < likeliest < 5 * near


LEVER = (
    CERTAIN_MODEL.replace("[inputs]", 'r = { value = 1e-3, unit = "1" }\n[inputs]')
    .replace('at = ["x", "0"]', 'at = ["r*x", "0"]')
    .replace('measures = "x"', 'measures = "r*x"')
    .replace("value = 25.0", "value = 25e-6")
    .replace("value = 0.6", "value = 0.6e-6")
    .replace('force = "f"', 'force = "r*f"')
)
IN_MILLIMETRES = CERTAIN_MODEL.replace('x = { unit = "m" }', 'x = { unit = "mm" }')


@pytest.mark.parametrize("text", [LEVER, IN_MILLIMETRES], ids=["lever", "unit"])
def test_differences_do_not_depend_on_the_scale_of_a_coordinate(text: str) -> None:
    recording = pushed(4, damping=1.0, beside=np.full(600, 0.2))
    found = []
    for model in (CERTAIN_MODEL, text):
        setting = setting_of(pushed_model(model), recording)
        scale = 1e-3 if model is LEVER else 1.0
        rows = {"damping": 0.3 * scale**2}, {"constant": 0.1 * scale}
        damping = cause_of(setting, "damper", "damping")
        constant = cause_of(setting, "constant", "constant")
        none = scored(setting, [])
        one = scored(setting, [damping], rows[0])
        both = scored(setting, [damping, constant], *rows)
        found.append([one.evidence - none.evidence, both.evidence - one.evidence])
    assert found[1] == pytest.approx(found[0], abs=SETTLED)  # where a fit ends
    assert min(found[0]) > 5


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_cause_that_does_nothing_lowers_it(seed: int) -> None:
    setting = setting_of(pushed_model(), pushed(seed))
    none = scored(setting, [])
    for kind, key, begin in (
        ("constant", "constant", 0.1),
        ("damper", "damping", 0.1),
        ("spring", "cubic", 10.0),
        ("drag", "drag", 0.1),
    ):
        one = scored(setting, [cause_of(setting, kind, key)], {key: begin})
        assert one.fit.logl >= none.fit.logl - 0.5  # it fits no worse ...
        assert one.evidence < none.evidence - 2  # ... and is not worth its price


@pytest.mark.parametrize("seed", [3, 4, 6])
def test_noise_that_is_white_is_priced_as_one_number(seed: int) -> None:
    """From sizes that the first passes leave near their maximum."""
    setting = setting_of(pushed_model(), pushed(seed))
    assert scored(setting, []).fit.noise.numbers == 1


def test_a_fit_that_failed_has_none(offset: Recorded) -> None:
    one = scored(offset, [])
    assert np.isfinite(one.evidence)
    assert evidence(offset, replace(one, fit=replace(one.fit, reason=FAILED))) == -np.inf


def test_every_number_has_the_prior_that_is_stated(offset: Recorded) -> None:
    stated = setting_of(pushed_model(), pushed(1))
    plain = scored(stated, [])
    assert [row.tolist() for row in priors(stated, plain)] == [[25.0], [0.5]]
    # the strength of a law: what makes the force that moves its place
    mean, spread = priors(
        offset, scored(offset, [cause_of(offset, "constant", "constant")], {"constant": 0.1})
    )
    assert (mean[0], spread[0]) == pytest.approx((0.0, offset.scale[0]))
    (item,) = offset.items
    course = item.course(offset.windows.machine)
    assert offset.scale[0] == pytest.approx(float(np.std(course.a)), rel=0.1)  # of a mass of 1 kg
    sizes = strength_scales(offset)
    cubic = next(size for name, size in sizes.items() if name[3] == "cubic")
    rms = float(np.sqrt(np.mean((cubic * course.q[:, 0] ** 3) ** 2)))
    assert rms == pytest.approx(offset.scale[0], rel=0.05)


def test_every_class_is_counted(offset: Recorded) -> None:
    """A price of ln of how many there are holds if all are counted."""
    stated = setting_of(pushed_model(), pushed(1))
    for setting in (offset, stated):
        assert classes(setting) == len(classes_of(setting))
    assert classes(stated) == classes(offset) + 1
    families = {cause.family for cause in offset.hypotheses}
    assert candidates(offset) == len(families) < len(offset.hypotheses)

"""The joint posterior of claimed numbers: deviations as stated, correlations as fitted."""

import builtins
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from builders import DRIVEN_MASS
from fakes import friction

import symhyb as sh
from symhyb.correction.naming.findings import Named
from symhyb.correction.naming.joint import posterior_of
from symhyb.discrepancy.posterior import Posterior
from symhyb.discrepancy.results import Measurement, Reestimated
from symhyb.model.types import On

MODEL = sh.parse_model(DRIVEN_MASS)
ANSWER = replace(
    friction(0.5),
    parameters=(Reestimated("k", 25.0, 27.0, 0.2, "N/m"),),
    measurement=(Measurement("laser", "gain", 1.02, 0.001, "1"),),
)
PATHS = ("laser.gain", "cause1.coulomb", "cause0.drag", "k")
FITTED = np.array(
    [
        [1e-6, 0.0, 1e-5, 0.0],
        [0.0, 9e-6, 0.0, -2.4e-4],
        [1e-5, 0.0, 1.0, 0.0],
        [0.0, -2.4e-4, 0.0, 1e-2],
    ]
)


def fitted(**changes: object) -> SimpleNamespace:
    """A fit of a drag that is not claimed, friction, a parameter and a gain."""
    causes = [SimpleNamespace(keys=("drag",)), SimpleNamespace(keys=("coulomb",))]
    parts = {"paths": PATHS, "owned": (), "causes": causes} | changes
    return SimpleNamespace(fit=SimpleNamespace(covariance=parts.pop("cov", FITTED)), **parts)


ITEMS = (Named("friction", On("q"), (1,), {"coulomb": (0.5, 0.003)}),)


def joint(**changes: object) -> Posterior | None:
    return posterior_of(MODEL, fitted(**changes), ITEMS, ANSWER)


def test_deviations_are_stated_and_correlations_fitted() -> None:
    found = joint()
    assert found.names == ("found_friction.coulomb", "k", "laser.gain")
    assert found.units == ("N", "N/m", "1")
    assert found.correlations.names == ("found_friction.F_c", "k", "laser.gain")
    np.testing.assert_array_equal(found.correlations.matrix, found.correlation)
    np.testing.assert_array_equal(found.mean, [0.5, 27.0, 1.02])
    np.testing.assert_allclose(found.sd, [0.006, 0.2, 0.001])
    np.testing.assert_allclose(
        found.correlation, [[1, -0.8, 0], [-0.8, 1, 0], [0, 0, 1]], atol=1e-12
    )


def test_numbers_of_the_first_recording_stand_for_those_of_all() -> None:
    """Each of two recordings has its own k: the last number of the fit is that of the second."""
    wider = np.zeros((5, 5))
    wider[:4, :4], wider[4, 4] = FITTED, 1.0
    found = joint(cov=wider, owned=((0, 1, 2, 3), (0, 1, 2, 4)))
    np.testing.assert_allclose(found.correlation[0, 1], -0.8)


def test_what_is_not_known_together_has_no_posterior() -> None:
    assert joint(cov=np.full((4, 4), np.nan)) is None
    assert joint(paths=("a", "b", "c", "d")) is None
    assert posterior_of(MODEL, fitted(), ITEMS, sh.Diagnosis("undecided", "")) is None
    assert posterior_of(MODEL, fitted(), (), ANSWER) is None  # friction that was not fitted
    with pytest.raises(sh.InputError, match=r"no number is claimed \(undecided\)"):
        sh.Diagnosis("undecided", "").to_arviz()


def test_draws_have_the_mean_and_the_covariance() -> None:
    found = joint()
    drawn = found.sample(200_000, seed=3)
    np.testing.assert_allclose(drawn.mean(axis=0), found.mean, atol=5 * found.sd.max() / 400)
    np.testing.assert_allclose(np.corrcoef(drawn.T), found.correlation, atol=0.01)
    np.testing.assert_allclose(drawn.std(axis=0), found.sd, rtol=0.01)
    np.testing.assert_array_equal(found.sample(3, seed=3), found.sample(3, seed=3))


def test_arviz_gets_a_variable_a_number_with_its_unit() -> None:
    answer = replace(ANSWER, posterior=joint())
    tree = answer.to_arviz(draws=500, chains=2, seed=1)
    group = tree["posterior"]
    assert set(group.data_vars) == {"found_friction.coulomb", "k", "laser.gain"}
    assert group["k"].shape == (2, 500)
    assert group["k"].attrs["units"] == "N/m"
    drawn = joint().sample(1000, 1)
    np.testing.assert_array_equal(group["k"].values.ravel(), drawn[:, 1])
    both = np.corrcoef(group["k"].values.ravel(), group["found_friction.coulomb"].values.ravel())
    assert both[0, 1] == pytest.approx(-0.8, abs=0.05)


def test_without_arviz_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: object) -> object:
        if name == "arviz_base":
            raise ModuleNotFoundError("No module named 'arviz_base'", name=name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(sh.InputError, match=r'pip install "symhyb\[arviz\]"'):
        joint().to_arviz()

"""Forces of stretch and rate that no listed law is: a product of two curves, and a sum of them."""

import numpy as np
import pytest

import symhyb as sh
from tests.pushed import pushed_model, resisted


def loss(v: float) -> float:
    return float(np.arcsinh(3 * v))


def more_there(x: float) -> float:
    """Of a loss that acts near one place."""
    return float(np.exp(-((x - 0.05) ** 2) / 0.3**2))


def held(x: float) -> float:
    return float(np.expm1(4 * x))


@pytest.mark.thorough
def test_a_loss_that_changes_with_place_is_a_product() -> None:
    model, run = pushed_model(), resisted(2, lambda x, v: 0.4 * loss(v) * more_there(x), 2000)
    diagnosis = sh.diagnose(model, run)
    (found,) = diagnosis.found
    assert found.element.by_stretch is not None
    assert "changes with the stretch" in diagnosis.sentence
    corrected = sh.apply(model, diagnosis.found)
    verdict = sh.judge(model, corrected, on=run)
    before, after = (
        scores.free_run_nrmse.values() for scores in (verdict.train.before, verdict.train.after)
    )
    assert all(b < 0.1 * a for a, b in zip(before, after, strict=True) if a and b)


@pytest.mark.thorough
def test_a_spring_and_a_loss_without_names_are_two_curves() -> None:
    model, run = pushed_model(), resisted(2, lambda x, v: held(x) + 1.5 * loss(v))
    diagnosis = sh.diagnose(model, run)
    kinds = {(one.element.kind, one.element.option("over", "")) for one in diagnosis.found}
    assert ("curve", "stretch") in kinds
    assert len(diagnosis.found) == 2
    verdict = sh.judge(model, sh.apply(model, diagnosis.found), on=run)
    before, after = (
        scores.free_run_nrmse.values() for scores in (verdict.train.before, verdict.train.after)
    )
    assert all(b < 0.1 * a for a, b in zip(before, after, strict=True) if a and b)

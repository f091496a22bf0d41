"""Proposals of the weak form: what PySINDy finds on all rows, found without storing them."""

import numpy as np
import pytest
from pysindy.optimizers import STLSQ
from rigs import spring_model, spring_recording

from symhyb.correction.learning import sparse
from symhyb.correction.search.preparing import prepare, settle
from symhyb.numeric.kernels.factor import factor_of


def test_the_weak_form_is_regressed_without_storing_its_rows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    prepared = prepare(spring_model(), spring_recording(5, {"drag": 2.0}, duration=6.0))
    setting = settle(prepared)
    given = prepared.machine, setting.library, setting.stages[0].cuts
    band = 5 / prepared.shortest
    whole = list(sparse.weak_rows(*given[:2], given[2][0], band))
    monkeypatch.setattr(sparse, "BLOCK", 1)
    parts = list(sparse.weak_rows(*given[:2], given[2][0], band))
    assert len(parts) == len(given[2][0].rows) > len(whole)
    rows = np.concatenate(whole)
    assert np.concatenate(parts) == pytest.approx(rows, rel=1e-12, abs=1e-14)

    seen = np.linalg.norm(rows, axis=0) > 0
    unit = rows[:, seen] / np.linalg.norm(rows[:, seen], axis=0)
    factor = factor_of(lambda: [unit], [f"c{i}" for i in range(unit.shape[1])])
    for threshold in sparse.THRESHOLDS:
        plain = STLSQ(threshold=threshold, alpha=1e-8, max_iter=30).fit(unit[:, :-1], unit[:, -1:])
        ours = sparse.fitted(factor, STLSQ(threshold=threshold, alpha=1e-8, max_iter=30))
        assert np.array_equal(ours != 0, plain.coef_ != 0)
        assert np.abs(ours - plain.coef_).max() < 1e-6 * np.abs(plain.coef_).max()

    proposed = sparse.propose(*given, band)
    assert proposed
    for subset in proposed:
        values = np.zeros(rows.shape[1] - 1)
        values[[c for i in subset.causes for c in setting.library.columns[i]]] = subset.values
        left = float(np.sum((rows[:, -1] - rows[:, :-1] @ values) ** 2))
        assert subset.chi2 == pytest.approx(left, rel=1e-9)


def test_rows_that_are_not_finite_propose_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    prepared = prepare(spring_model(), spring_recording(5, {"drag": 2.0}, duration=6.0))
    setting = settle(prepared)
    columns = sum(map(len, setting.library.columns))
    monkeypatch.setattr(sparse, "weak_rows", lambda *_: iter([np.full((9, columns + 1), np.nan)]))
    cuts = setting.stages[0].cuts
    assert sparse.propose(prepared.machine, setting.library, cuts, 5 / prepared.shortest) == ()

"""No manoeuvre is designed where each trial of one would fit many causes."""

from types import SimpleNamespace
from typing import Any

import pytest

from symhyb.correction.advice import advice
from symhyb.correction.advice.manoeuvre import Rivals


@pytest.mark.parametrize(
    ("first", "second", "designed"), [(2, 2, True), (6, 2, False), (2, 6, False)]
)
def test_structures_of_many_causes_get_no_manoeuvre(
    monkeypatch: pytest.MonkeyPatch, first: int, second: int, designed: bool
) -> None:
    def trial(count: int) -> Any:
        return SimpleNamespace(causes=tuple(range(count)))

    class DesignedError(Exception):
        pass

    def design(*_: object) -> None:
        raise DesignedError

    pair = Rivals(trial(first), trial(second), ("one", "another"))
    monkeypatch.setattr(advice, "_pairs", lambda _: [pair])
    monkeypatch.setattr(advice, "design", design)
    nothing: Any = None
    prepared: Any = SimpleNamespace(model=SimpleNamespace(inputs=()))
    if designed:
        with pytest.raises(DesignedError):
            advice.advise(prepared, nothing, nothing)
    else:
        assert advice.advise(prepared, nothing, nothing) == (None, None)

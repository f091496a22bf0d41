"""Results made by hand, and the model that they are about."""

from collections.abc import Callable

import pytest
from made_results import ALL_VERDICTS, CASES

from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.model.expression import parse_expression
from symhyb.model.types import Coordinate, Model, Sensor
from symhyb.units import parse_unit


@pytest.fixture(scope="session")
def model() -> Model:
    unit = parse_unit
    return Model(
        "Slide on a rail, driven by a motor",
        (Coordinate("q", unit("m")), Coordinate("phi", unit("rad"))),
        sensors=(
            Sensor("encoder", parse_expression("q"), unit("mm")),
            Sensor("tacho", parse_expression("phi'"), unit("rad/s")),
        ),
        energy_unit=unit("J"),
    )


@pytest.fixture(params=ALL_VERDICTS)
def case(request: pytest.FixtureRequest) -> tuple[Diagnosis, Verdict]:
    """Each of the synthetic results in turn."""
    return CASES[request.param]()


@pytest.fixture
def cases() -> dict[str, Callable[[], tuple[Diagnosis, Verdict]]]:
    """The synthetic results by name."""
    return CASES

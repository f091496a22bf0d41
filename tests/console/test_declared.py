"""What a checked model declares, printed."""

import pytest

from symhyb.console.model import HELD_SHOWN, print_model
from symhyb.model.read import parse_model

MASS = """
symhyb = 1
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 2.0, sd = 0.5, unit = "kg" }
"""
MORE = """
[bodies.mass]
mass = "m"
at = ["x", "0"]
[sensors]
laser = { measures = "x", unit = "m" }
"""


def printed(held: int, capsys: pytest.CaptureFixture[str]) -> str:
    others = "".join(f'k_{i} = {{ value = {i}, unit = "N/m" }}\n' for i in range(held))
    print_model(parse_model(MASS + others + MORE))
    (line,) = (row for row in capsys.readouterr().out.splitlines() if "parameters:" in row)
    return line.strip()


def test_every_parameter_is_printed_where_they_are_few(capsys: pytest.CaptureFixture[str]) -> None:
    line = printed(HELD_SHOWN, capsys)
    assert line.startswith("parameters: m = 2.0 ± 0.5 kg, k_0 = 0 N/m (held)")
    assert line.endswith(f"k_{HELD_SHOWN - 1} = {HELD_SHOWN - 1} N/m (held)")


def test_of_many_those_that_may_be_off_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    line = printed(HELD_SHOWN + 1, capsys)
    assert (
        line == f"parameters: m = 2.0 ± 0.5 kg, {HELD_SHOWN + 1} that are held (--json lists them)"
    )

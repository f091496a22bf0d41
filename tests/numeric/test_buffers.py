"""CasADi functions on NumPy memory: the same numbers in the same places."""

import casadi as ca
import numpy as np
import pytest

from symhyb.numeric.kernels.buffers import call, mean_of_seen

x, y = ca.SX.sym("x", 2), ca.SX.sym("y")
BOTH = ca.Function("both", [x, y], [ca.densify(ca.diag(x) * y), x[0] + y], ["x", "y"], ["A", "b"])


def test_outputs_come_transposed_with_rows_last() -> None:
    matrix = ca.Function(
        "matrix", [x], [ca.vertcat(ca.horzcat(1, 2, 3), ca.horzcat(x[0], x[1], 6))]
    )
    (result,) = call(matrix, [np.array([4.0, 5.0])])
    assert result.tolist() == [[1, 4], [2, 5], [3, 6]]


def test_arguments_may_be_strided_whole_numbers_or_scalars() -> None:
    strided = np.arange(8).reshape(2, 4)[:, 1]
    a, b = call(BOTH, [strided, 2])
    assert a.tolist() == [[2, 0], [0, 10]]
    assert b.tolist() == [[3]]


def test_a_wrong_number_of_entries_is_said_with_the_name_of_the_argument() -> None:
    with pytest.raises(ValueError, match=r"both: argument x has 3 entries, needs 2"):
        call(BOTH, [np.zeros(3), 1.0])


def test_an_empty_output_is_empty() -> None:
    empty = ca.Function("empty", [x], [ca.SX(0, 1)])
    assert call(empty, [np.zeros(2)])[0].shape == (1, 0)


def test_a_mean_leaves_out_what_is_missing_and_says_where_nothing_is_left() -> None:
    values = np.array([[1.0, np.nan, np.nan], [3.0, 5.0, np.nan]])
    np.testing.assert_array_equal(mean_of_seen(values), [2.0, 5.0, np.nan])
    np.testing.assert_array_equal(mean_of_seen(values, axis=1), [1.0, 4.0])
    np.testing.assert_array_equal(mean_of_seen(np.array([[np.inf], [1.0]])), [np.inf])

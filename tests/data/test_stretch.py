"""A stretch of a recording: its samples and its notes."""

import numpy as np

from symhyb.data.recording import Recording
from symhyb.data.thin import stretch


def test_a_stretch_has_the_samples_of_its_rows() -> None:
    t = np.arange(10.0)
    whole = Recording("run", t, {"f": 2 * t}, {"x": -t}, ("noted",))
    part = stretch(whole, slice(3, 7))
    np.testing.assert_array_equal(part.t, [3, 4, 5, 6])
    np.testing.assert_array_equal(part.inputs["f"], [6, 8, 10, 12])
    np.testing.assert_array_equal(part.sensors["x"], [-3, -4, -5, -6])
    assert part.notes == ("noted",)

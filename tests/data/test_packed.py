"""What is handed to a process apart comes out as it went in, and is nothing that runs."""

import io

import numpy as np
import pytest

from symhyb.data.hosts.packed import packed, unpacked


def test_words_and_arrays_come_out_as_they_went_in() -> None:
    words = {"file": "ärm.xml", "places": [["q", "v", ""]], "masses": [1.5]}
    t, data = np.linspace(0, 1, 5), np.frombuffer(b"<mujoco/>", np.uint8)
    said, arrays = unpacked(packed(words, t=t, data=data, none=np.zeros((3, 0))))
    assert said == words
    assert set(arrays) == {"t", "data", "none"}
    np.testing.assert_array_equal(arrays["t"], t)
    assert arrays["data"].tobytes() == b"<mujoco/>"
    assert arrays["none"].shape == (3, 0)


def test_objects_are_refused() -> None:
    out = io.BytesIO()
    np.savez(out, words=np.array([object()], dtype=object))
    with pytest.raises(ValueError, match="allow_pickle"):
        unpacked(out.getvalue())

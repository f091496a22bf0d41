"""Linear algebra on one thread, and as it was afterwards."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from symhyb.numeric.kernels.compiled import find_compiler
from symhyb.numeric.kernels.threads import one_thread


def threads() -> set[int]:
    return {int(library["num_threads"]) for library in threadpool_info()}


def test_libraries_use_one_thread_within_and_what_they_used_afterwards() -> None:
    assert np.ones(2) @ np.ones(2) == 2  # the library of linear algebra is there
    with threadpool_limits(2):
        before = threads()
        with one_thread():
            assert threads() == {1}
        assert threads() == before


BESIDE = """
import shutil, sys, threading
from pathlib import Path
from symhyb.numeric.kernels.compiled import file_of, loaded
from symhyb.numeric.kernels.threads import one_thread

file, folder = file_of("int one(void) { return 1; }"), Path(sys.argv[1])
copies = [Path(shutil.copy(file, folder / f"{number}.so")) for number in range(300)]
with one_thread():  # imports what it needs
    pass
loading = threading.Thread(target=lambda: [loaded(copy) for copy in copies])
loading.start()
while loading.is_alive():
    with one_thread():
        pass
"""


@pytest.mark.skipif(find_compiler() is None, reason="needs a C compiler")
def test_libraries_may_be_loaded_beside(tmp_path: Path) -> None:
    """Listing libraries locks their list and calls Python, loading one waits for that list."""
    command = [sys.executable, "-c", BESIDE, str(tmp_path)]
    subprocess.run(command, check=True, timeout=300)

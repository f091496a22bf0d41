"""What is not needed is not imported; what is needed and missing is one sentence with the cure."""

import subprocess
import sys

import pytest

from symhyb.data.formats import read_table
from symhyb.errors import InputError

EXTRAS = ("h5py", "pyarrow.parquet", "openpyxl", "xlrd", "asammdf")


@pytest.mark.parametrize(
    ("name", "content", "module", "extra"),
    [
        ("run.mat", b"\x89HDF\r\n\x1a\n", "h5py", "mat73"),
        ("run.parquet", b"PAR1PAR1", "pyarrow", "parquet"),
        ("run.xlsx", b"PK\x03\x04", "openpyxl", "excel"),
        ("run.xls", b"\xd0\xcf\x11\xe0", "xlrd", "excel"),
        ("run.mf4", b"MDF     4.10", "asammdf", "mdf"),
    ],
)
def test_a_missing_package_is_named_with_its_cure(write, monkeypatch, name, content, module, extra):
    monkeypatch.setitem(sys.modules, module, None)
    cure = rf'needs the package {module}, which .*; run: pip install "symhyb\[{extra}\]"$'
    with pytest.raises(InputError, match=cure) as caught:
        read_table(write(name, content))
    assert len(caught.value.problems) == 1


def test_reading_text_imports_no_other_reader(write):
    path = write("run.csv", "t,x\n0,1\n1,2\n")
    code = (
        "import sys; from symhyb.data.formats import read_table; import symhyb.data;"
        f" read_table({str(path)!r}); print([name for name in {EXTRAS!r} if name in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_listing_recordings_loads_no_table_library():
    code = "import sys; from symhyb.data import listing; listing(); print('pandas' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"

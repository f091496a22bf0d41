"""What is not needed is not imported; what is needed and missing is one sentence with the cure."""

import subprocess
import sys

import pytest

from symhyb.data.files.bag_file import read_bag
from symhyb.data.files.mat_file import read_mat
from symhyb.data.files.mdf_file import read_mdf
from symhyb.data.files.parquet_file import read_parquet
from symhyb.data.files.sheet_file import read_excel
from symhyb.data.files.tdms_file import read_tdms
from symhyb.data.files.ulog_file import read_ulog
from symhyb.errors import InputError

EXTRAS = (
    *("h5py", "pyarrow.parquet", "openpyxl", "xlrd"),
    *("asammdf", "rosbags", "pyulog", "nptdms"),
)


@pytest.mark.parametrize(
    ("reader", "content", "module", "extra"),
    [
        (read_mat, b"\x89HDF\r\n\x1a\n", "h5py", "mat73"),
        (read_parquet, b"PAR1PAR1", "pyarrow", "parquet"),
        (read_excel, b"PK\x03\x04", "openpyxl", "excel"),
        (read_excel, b"\xd0\xcf\x11\xe0", "xlrd", "excel"),
        (read_mdf, b"MDF     4.10", "asammdf", "mdf"),
        (read_bag, b"#ROSBAG V2.0\n", "rosbags", "rosbag"),
        (read_ulog, b"ULog\x01\x12\x35", "pyulog", "ulog"),
        (read_tdms, b"TDSm", "nptdms", "tdms"),
    ],
)
def test_a_missing_package_is_named_with_its_cure(monkeypatch, reader, content, module, extra):
    monkeypatch.setitem(sys.modules, module, None)
    cure = rf'needs the package {module}, which .*; run: pip install "symhyb\[{extra}\]"$'
    with pytest.raises(InputError, match=cure) as caught:
        reader(content, "run")
    assert len(caught.value.problems) == 1


def test_reading_text_imports_no_other_reader(write):
    path = write("run.csv", "t,x\n0,1\n1,2\n")
    code = (
        "import sys; from symhyb.data.files.formats import read_table; import symhyb.data;"
        f" read_table({str(path)!r}); print([name for name in {EXTRAS!r} if name in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_listing_recordings_loads_no_table_library():
    code = "import sys; from symhyb.data import listing; listing(); print('pandas' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"

"""The limits of what a person may give, all of them; docs/reliability.md lists them.

They lie far beyond what a machine or a rig needs. What goes beyond is refused by a sentence that
names the limit, so that no file keeps a computer busy or fills its memory.
"""

import os
from pathlib import Path

from symhyb.errors import InputError, Problem

TEXT_BYTES = 1_000_000  # a model, a study or expectations: people write them
WEIGHTS_BYTES = 50_000_000  # the weights of a network
RECORDING_BYTES = 4 << 30
CURVE_BYTES = 100_000  # a file with the points of a characteristic curve, or of a map
CURVE_POINTS = 100  # of it: each costs a dozen operations wherever the curve is evaluated
MAP_PLACES = 50  # along each axis of a map: its points cost two operations each
EXPRESSION_LETTERS = 2000
EXPRESSION_DEPTH = 60  # levels of parentheses and functions
UNIT_LETTERS = 100
COORDINATES = 500  # of a machine, and its declared states, each
HANGING_DEEP = 100  # bodies in space that hang on each other, one below the other
DECLARED = 2000  # parameters of a machine, inputs, points, bodies, elements, each
COLUMNS = 10_000  # of a recording
ROWS = 20_000_000  # of it
STRUCTURES_DEEP = 12  # structures within structures of a recording
VARIABLE_NUMBERS = 200_000_000  # in one variable of an HDF5 file, which may claim more than it has
PACKED_LEAST, PACKED_TIMES = 10_000_000, 200  # bytes that an archive unpacks to, or times its own
VALUE = 1e100  # SI: what is larger is no measurement, but a logger's word for a missing one
LASTING, SHORT = 1e11, 1e-9  # s, 3000 years and a nanosecond: how long a recording may last
ROBOT_BYTES = 20_000_000  # of a robot from another program, without its meshes
ROBOT_NUMBER = 1e12  # SI; the largest in it
FMU_BYTES, FMU_UNPACKED = 500_000_000, 2_000_000_000  # of an FMU, and of what it unpacks to
XML_DEEP = 100  # elements of XML in each other
STUDY_RECORDINGS = 20_000  # of a study, training and unseen ones each
STUDY_TASKS = 100_000  # of the sweep of a study
RUN_ROWS = 5_000_000  # of a simulation
DIAGNOSIS_BYTES = 50_000_000  # of a diagnosis.json that is read again
REPORT_BYTES = 50_000_000  # of the report beside it

# A process that reads a format with a native parser gets, beside so much for each byte of the file:
READER_MEMORY, READER_MEMORY_EACH = 1536 << 20, 16  # bytes
READER_SECONDS, READER_BYTES_A_SECOND = 8, 200_000  # s of a processor; how fast it reads at least
READER_WAITS = 4  # times these seconds, by the clock
FMU_SECONDS, FMU_CALLS_A_SECOND = 30, 2_000  # s of a processor; how often an FMU answers at least


def content_of(path: str | os.PathLike[str], most: int, what: str = "") -> bytes:
    """The bytes of a file of at most ``most`` bytes; ``what`` it is begins the sentence of a
    problem.

    Raises:
        InputError: there is no such file, it is no plain file, too large, or cannot be read.
    """
    file, begin = Path(path), f"{what}: " if what else ""
    try:
        if file.is_dir():
            reason = "is a folder, not a file"
        elif not file.exists():
            reason = "there is no such file"
        elif not file.is_file():
            reason = "is no plain file"
        else:
            with open(file, "rb") as stream:  # read(most + 1) would claim so much memory at once
                data = stream.read() if os.fstat(stream.fileno()).st_size <= most else None
            if data is not None and len(data) <= most:
                return data
            reason = f"is larger than {_size_text(most)}"
    except (OSError, ValueError) as error:
        reason = f"cannot be read: {getattr(error, 'strerror', None) or error}"
    raise InputError(Problem(begin + reason, file=str(path)))


def text_of(path: str | os.PathLike[str], encoding: str = "utf-8-sig") -> str:
    """The text of a file that a person wrote; ``utf-8`` keeps a byte order mark.

    Raises:
        InputError: it cannot be read, is no UTF-8, or empty.
    """
    data = content_of(path, TEXT_BYTES)
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        said = "is not UTF-8 text; save the file as UTF-8"
        raise InputError(Problem(said, file=str(path), line=line)) from None
    if not text.strip("\ufeff \t\r\n"):
        raise InputError(Problem("the file is empty", file=str(path)))
    return text


def _size_text(size: int) -> str:
    return f"{size / 2**30:.3g} GiB" if size >= 2**30 else f"{size / 1e6:.3g} MB"

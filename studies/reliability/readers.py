"""What strangers' files meet: every reader with its corpus, its words, and the errors it may raise.

Readers with a native parser run inside :mod:`symhyb.data.files.apart` in a process of their own
with limits. Here they run without it, to be quick: what they may do there (end by a signal, run
out of memory) is *contained* and counted apart from failures.
"""

import io
import json
import re
import tempfile
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from random import Random

import numpy as np
from grammar import expression, unit
from mutate import of_bytes, of_json, of_toml, of_zip

from symhyb.errors import InputError, Problem
from symhyb.imports.deliver import Order, model_of
from symhyb.imports.urdf import parse_urdf
from symhyb.model.expression import ExpressionError, parse_expression, show
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.network import evaluated, parsed
from symhyb.study.expected import read_expected
from symhyb.study.file import read_study
from symhyb.units import UnitError, parse_unit

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
CURVED = """symhyb = 1
[coordinates]
x = { unit = "m" }
[energy]
kinetic = "m*x'**2/2"
[parameters]
m = { value = 1, unit = "kg" }
[elements.strut]
kind = "curve"
on = "x"
over = "rate"
file = "points.csv"
"""
MAPPED = CURVED.replace('"curve"', '"map"').replace('over = "rate"', 'units = ["mm", "m/s", "N"]')
Make = Callable[[Random, bytes, Sequence[bytes]], bytes]


@dataclass(frozen=True, slots=True)
class Reader:
    """A reader under test: ``take`` reads an input and raises one of ``errors`` or nothing;
    ``make`` changes an input of the ``corpus``; ``native`` readers are kept apart in symhyb, and
    ``share`` is how many of the inputs asked for a slow one gets."""

    name: str
    take: Callable[[bytes], None]
    corpus: Callable[[], Sequence[bytes]]
    make: Make = of_bytes
    words: Sequence[bytes] = (b"",)
    errors: tuple[type[Exception], ...] = field(default=())
    native: bool = False
    share: float = 1.0


def _text(data: bytes) -> str:
    return data.decode(errors="replace")


def _model(data: bytes) -> None:
    parse_model(_text(data), "model.toml")


def _machine(data: bytes) -> None:
    build(parse_model(_text(data), "model.toml"))


def _robot(data: bytes) -> None:
    model_of(parse_urdf(data, "robot.urdf"), Order(floating=len(data) % 2 == 0))


def _unit(data: bytes) -> None:
    try:
        parse_unit(_text(data))
    except UnitError as error:
        raise InputError(Problem(str(error))) from None


def _expression(data: bytes) -> None:
    try:
        show(parse_expression(_text(data)).tree)
    except ExpressionError as error:
        raise InputError(Problem(str(error))) from None


def _in_a_file(name: str, read: Callable[[Path], object]) -> Callable[[bytes], None]:
    def take(data: bytes) -> None:
        with tempfile.TemporaryDirectory() as folder:
            for other in ("model.toml", "a.csv", "b.csv"):
                (Path(folder) / other).touch()
            path = Path(folder) / name
            path.write_bytes(data)
            read(path)

    return take


def _weights(data: bytes) -> None:
    weights = parsed(data, "weights.json")
    evaluated(weights, np.zeros((3, weights.mean.size)))


def _curve(data: bytes) -> None:
    """A file of points beside a model that names it."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "points.csv").write_bytes(data)
        parse_model(CURVED, str(Path(folder) / "model.toml"))


def _map(data: bytes) -> None:
    """A file with the grid of a map beside a model that names it."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "points.csv").write_bytes(data)
        parse_model(MAPPED, str(Path(folder) / "model.toml"))


def _table(module: str, function: str, name: str) -> Callable[[bytes], None]:
    def take(data: bytes) -> None:
        getattr(import_module(f"symhyb.data.files.{module}"), function)(data, name)

    return take


def _models(largest: int) -> Sequence[bytes]:
    files = sorted((ROOT / "models").glob("*.toml"))
    return [file.read_bytes() for file in files if file.stat().st_size < largest]


def _kept(pattern: str) -> Sequence[bytes]:
    """The corpus: what once failed, and what readers are to see."""
    return [file.read_bytes() for file in sorted((HERE / "corpus").glob(pattern))]


def _studies() -> Sequence[bytes]:
    """The studies of this repository, with files that lie beside them in the test."""
    texts = [file.read_text() for file in sorted((ROOT / "studies").glob("*/study*.toml"))]
    near = [re.sub(r'model( *)= "[^"]*"', r'model\1= "model.toml"', text) for text in texts]
    near = [re.sub(r'file( *)= "[^"#]*', r'file\1= "a.csv', text) for text in near]
    return [text.encode() for text in near]


def _expectations() -> Sequence[bytes]:
    return [file.read_bytes() for file in sorted((ROOT / "studies").glob("*/expected.json"))]


@cache
def _columns() -> dict[str, np.ndarray]:
    t = np.arange(40) / 100
    return {"t": t, "f [N]": np.sin(9 * t), "laser": np.round(np.cos(t), 3), "note": t > 0.2}


def _csv() -> Sequence[bytes]:
    plain = "\n".join(
        [
            ",".join(_columns()),
            *(",".join(map(str, row)) for row in zip(*_columns().values(), strict=True)),
        ]
    )
    german = plain.replace(",", ";").replace(".", ",")
    dated = "time,x\n2024-03-01 10:00:00.00,1\n2024-03-01 10:00:00.01,2\n"
    return [
        *(one.encode() for one in (plain, german, dated, "# rig 3\n# 1 Hz\n" + plain)),
        *_kept("*.csv"),
    ]


def _points() -> Sequence[bytes]:
    plain = "speed [m/s],force [N]\n-0.5,-610\n# at rest\n0,0\n.5,5.5e2\n1,700\n"
    return [plain.encode(), plain.replace(",", ";").encode(), *_kept("points*.csv")]


def _grids() -> Sequence[bytes]:
    plain = "mm,-0.5,0,.5\n-40,-610,0,5.5e2\n# at rest\n0,-9,0,7\n40,-1e3,2,700\n"
    return [plain.encode(), plain.replace(",", ";").encode(), *_kept("grid*.csv")]


def _json() -> Sequence[bytes]:
    columns = {name: values.tolist() for name, values in _columns().items()}
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    nested = {"run": [{"t": columns["t"], "x": {"value": columns["laser"], "unit": "mm"}}] * 2}
    return [*(json.dumps(one).encode() for one in (columns, rows, nested)), *_kept("*.json")]


def _written(save: Callable[[io.BytesIO], object]) -> bytes:
    stream = io.BytesIO()
    save(stream)
    return stream.getvalue()


@cache
def _mat() -> Sequence[bytes]:
    from scipy.io import savemat

    numbers = {"t": _columns()["t"], "x": _columns()["laser"]}
    cells = np.empty(2, dtype=object)
    cells[:] = [numbers["t"], numbers["x"]]
    nested = {"run": {"Time": numbers["t"], "Y": {"Data": numbers["x"], "name": "x"}}, "c": cells}
    ways = [(content, small) for content in (numbers, nested) for small in (False, True)]
    return [
        *(
            _written(partial(savemat, mdict=content, do_compression=small))
            for content, small in ways
        ),
        *_kept("*.mat"),
    ]


@cache
def _mat73() -> Sequence[bytes]:
    import h5py

    def save(stream: io.BytesIO) -> None:
        with h5py.File(stream, "w", userblock_size=512) as file:
            for name, values in (("t", _columns()["t"]), ("x", _columns()["laser"])):
                file[name] = values[None]
                file[name].attrs["MATLAB_class"] = np.bytes_(b"double")
            group = file.create_group("run")
            group.create_dataset("y", data=np.arange(9.0)[None], compression="gzip")

    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    return [(head + _written(save)[len(head) :])]


@cache
def _parquet() -> Sequence[bytes]:
    import pyarrow as pa
    import pyarrow.parquet as pq

    table, ways = pa.table(dict(_columns())), ("none", "snappy", "gzip")
    return [_written(partial(pq.write_table, table, compression=way)) for way in ways]


@cache
def _excel() -> Sequence[bytes]:
    import pandas as pd

    return [_written(lambda s: pd.DataFrame(_columns()).to_excel(s, index=False))]


@cache
def _mdf() -> Sequence[bytes]:
    from asammdf import MDF, Signal

    found = []
    for version in ("3.30", "4.10"):
        with tempfile.TemporaryDirectory() as folder, MDF(version=version) as mdf:
            t = _columns()["t"]
            mdf.append([Signal(np.sin(9 * t), t, name="f", unit="N"), Signal(t, t, name="x")])
            path = mdf.save(Path(folder) / "a", overwrite=True)
            found.append(Path(path).read_bytes())
    return found


@cache
def _bags() -> Sequence[bytes]:
    """A topic of joints and one of a number, in every kind of bag."""
    from rosbags import rosbag1, rosbag2
    from rosbags.typesys import Stores, get_typestore

    found = []
    for suffix in (".bag", ".mcap", ".db3"):
        ros2 = suffix != ".bag"
        store = get_typestore(Stores.ROS2_HUMBLE if ros2 else Stores.ROS1_NOETIC)
        write = store.serialize_cdr if ros2 else store.serialize_ros1
        types, joints, number = store.types, "sensor_msgs/msg/JointState", "std_msgs/msg/Float64"
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"a{'' if ros2 else suffix}"
            plugins = rosbag2.StoragePlugin
            plugin = plugins.MCAP if suffix == ".mcap" else plugins.SQLITE3
            writer = (
                rosbag2.Writer(path, version=9, storage_plugin=plugin)
                if ros2
                else rosbag1.Writer(path)
            )
            with writer as bag:
                states = bag.add_connection("/arm", joints, typestore=store)
                force = bag.add_connection("/f", number, typestore=store)
                for k, x in enumerate(_columns()["laser"]):
                    stamp = types["builtin_interfaces/msg/Time"](9, 10_000_000 * k)
                    more = {} if ros2 else {"seq": k}
                    head = types["std_msgs/msg/Header"](**more, stamp=stamp, frame_id="a")
                    none, one = np.empty(0), np.array([x, -x])
                    message = types[joints](head, ["a", "b"], one, none, none)
                    time = 9_000_000_000 + 10_000_000 * k
                    bag.write(states, time, write(message, joints))
                    bag.write(force, time, write(types[number](float(x)), number))
            kept = path if path.is_file() else next(path.glob(f"*{suffix}"))
            found.append(kept.read_bytes())
    return found


def _ulog() -> Sequence[bytes]:
    def record(kind: str, data: bytes) -> bytes:
        return len(data).to_bytes(2, "little") + kind.encode() + data

    log = b"ULog\x01\x12\x35\x01" + bytes(8) + record("B", bytes(40))
    log += record("F", b"rod:uint64_t timestamp;uint64_t timestamp_sample;esc[2] e;")
    log += record("F", b"esc:float rpm;") + record("A", bytes(3) + b"rod")
    for k, x in enumerate(_columns()["laser"]):
        times = np.array([10_000 * k + 900, 10_000 * k], "<u8").tobytes()
        log += record("D", bytes(2) + times + np.array([x, 1], "<f4").tobytes())
    return [log]


@cache
def _tdms() -> Sequence[bytes]:
    from nptdms import ChannelObject, TdmsWriter

    about = {"wf_increment": 0.01, "wf_start_offset": 0.0, "unit_string": "mm"}
    made = [ChannelObject("A", "x", _columns()["laser"], about), ChannelObject("B", "y", [1, 2])]

    def save(stream: io.BytesIO) -> None:
        with TdmsWriter(stream) as writer:
            writer.write_segment(made)

    return [_written(save)]


def _rpc() -> Sequence[bytes]:
    head = {
        **{"FORMAT": "BINARY_IEEE_LITTLE_END", "NUM_HEADER_BLOCKS": 3, "NUM_PARAMS": 12},
        **{"FILE_TYPE": "TIME_HISTORY", "DATA_TYPE": "SHORT_INTEGER", "DELTA_T": 0.01},
        **{"CHANNELS": 1, "FRAMES": 2, "PTS_PER_FRAME": 16, "PTS_PER_GROUP": 32},
        **{"DESC.CHAN_1": "x", "SCALE.CHAN_1": 0.5},
    }
    records = [
        key.encode().ljust(32, b"\0") + f"{v}".encode().ljust(96, b"\0") for key, v in head.items()
    ]
    return [b"".join(records).ljust(1536, b"\0") + np.arange(32, dtype="<i2").tobytes()]


def _grammatical(make: Callable[[Random], str]) -> Make:
    def made(random: Random, data: bytes, words: Sequence[bytes]) -> bytes:
        text = make(random).encode()
        return of_bytes(random, text, words) if random.random() < 0.4 else text

    return made


def _words_of_models() -> Sequence[bytes]:
    tables: list[bytes] = []
    for data in _models(10_000):
        for line in data.splitlines():
            tables += [line, line.split(b"=")[0].strip()]
    return sorted(set(tables)) or (b"",)


SIGNS = tuple(b"+ - * / ** ( ) ' \" , . [ ] { } = # \n \\ e9 1e400 NaN inf - 0x 1_0".split(b" "))


def _words_of_robots() -> Sequence[bytes]:
    text = b"".join(_kept("*.urdf"))
    tags, values = (set(re.findall(form, text)) for form in (rb"</?[^<>]*>", rb'\w+="[^"]*"'))
    return [*sorted(tags | values), b"<!DOCTYPE a>", b"&lt;", b"&#10;", b"0", b"-1", b"1e300"]


def readers() -> tuple[Reader, ...]:
    """Every reader of what a stranger may send."""
    refuses, words = (InputError,), (*SIGNS, *_words_of_models())

    def small() -> Sequence[bytes]:
        return [*_models(2_700), *_kept("model*.toml")]

    def native(
        name: str,
        module: str,
        function: str,
        corpus: Callable[[], Sequence[bytes]],
        make: Make = of_bytes,
    ) -> Reader:
        take = _table(module, function, f"sent.{name}")
        return Reader(name, take, corpus, make, SIGNS, (*refuses, MemoryError), True)

    return (
        Reader("unit", _unit, lambda: [b"N*m"], _grammatical(unit), SIGNS, refuses),
        Reader(
            "expression", _expression, lambda: [b"k*x"], _grammatical(expression), SIGNS, refuses
        ),
        Reader(
            "model",
            _model,
            lambda: [*_models(10_000), *_kept("model*.toml")],
            of_toml,
            words,
            refuses,
        ),
        Reader("machine", _machine, small, of_toml, words, refuses),
        Reader(
            "urdf",
            _robot,
            lambda: _kept("*.urdf"),
            of_bytes,
            (*SIGNS, *_words_of_robots()),
            refuses,
        ),
        Reader("study", _in_a_file("study.toml", read_study), _studies, of_toml, SIGNS, refuses),
        Reader(
            "expected",
            _in_a_file("expected.json", read_expected),
            _expectations,
            of_json,
            SIGNS,
            refuses,
        ),
        Reader("weights", _weights, lambda: _kept("weights.json"), of_json, SIGNS, refuses),
        Reader("curve", _curve, _points, of_bytes, SIGNS, refuses),
        Reader("map", _map, _grids, of_bytes, SIGNS, refuses),
        Reader("csv", _table("csv_file", "read_csv", "sent.csv"), _csv, of_bytes, SIGNS, refuses),
        Reader(
            "json", _table("json_file", "read_json", "sent.json"), _json, of_json, SIGNS, refuses
        ),
        Reader("rpc", _table("rpc_file", "read_rpc", "sent.rsp"), _rpc, of_bytes, SIGNS, refuses),
        native("mat", "mat_file", "read_mat", _mat),
        native("mat73", "mat_file", "read_mat", _mat73),
        native("parquet", "parquet_file", "read_parquet", _parquet),
        replace(native("xlsx", "sheet_file", "read_excel", _excel, of_zip), share=0.25),
        replace(native("mf4", "mdf_file", "read_mdf", _mdf), share=0.05),
        replace(native("bag", "bag_file", "read_bag", _bags), share=0.1),
        replace(native("ulg", "ulog_file", "read_ulog", _ulog), share=0.25),
        replace(native("tdms", "tdms_file", "read_tdms", _tdms), share=0.25),
    )


def an_input(reader: Reader, number: int) -> bytes:
    """Input ``number`` of a reader."""
    random = Random(f"{reader.name} {number}")
    corpus = reader.corpus()
    data = corpus[number % len(corpus)]
    try:
        return reader.make(random, data, reader.words)
    except (tomllib.TOMLDecodeError, ValueError, RecursionError):
        return of_bytes(random, data, reader.words)  # a kept input that is no tree of values

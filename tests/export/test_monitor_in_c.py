"""A monitor in C says what symhyb watch says: the same blocks, alarms, causes and sizes."""

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from command import Call

from symhyb.data.recording import Recording
from symhyb.data.thin import stretch
from symhyb.errors import InputError
from symhyb.export.functions.monitored import monitored
from symhyb.export.monitor.constants import constants_of
from symhyb.export.monitor.files import monitor_files
from symhyb.export.monitor.held import require_monitored
from symhyb.model.read import parse_model
from symhyb.monitoring.begun import Begun, begun
from symhyb.monitoring.events import Event
from symhyb.monitoring.feed import Feed
from symhyb.monitoring.gauge import block_of
from symhyb.monitoring.watching import Watch, watch
from tests.monitored import (
    answered,
    cart,
    cart_begun,
    compiled,
    made,
    rows_of,
    scores_of,
)
from tests.monitoring.test_watching import REFERENCE_S, rows
from tests.pushed import DRIVEN_MASS, STEP, STIFFNESS, pushed_model

CLOSE = 1e-9
FIRST = round(REFERENCE_S / STEP)


def read(lines: tuple[str, ...]) -> Recording:
    feed = Feed(pushed_model(), None, "rig.csv")
    for line in ("t,f,laser", *lines):
        feed.take(line)
    return feed.piece(len(lines))


@cache
def reference() -> Begun:
    return begun(pushed_model(), read(rows(1)[:FIRST]), 1.0, "good.csv")


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(reference(), tmp_path_factory.mktemp("monitor"))


def require_the_same(found: Begun, recording: Recording, lines: list[str], blocks: int) -> None:
    """Information, score and motion of blocks as Python has them: a score within a share of its own
    deviation, the rest of itself."""
    scores = scores_of(lines)
    assert len(scores) >= blocks
    for i, row in enumerate(scores[:blocks]):
        block = block_of(
            found.gauge, stretch(recording, slice(i * found.rows, (i + 1) * found.rows))
        )
        assert block is not None
        shown = np.diag(block.information)
        np.testing.assert_allclose(row[:2], [block.start_s, block.end_s])
        np.testing.assert_allclose(row[2], block.motion, rtol=CLOSE)
        np.testing.assert_allclose(row[3::2], shown, rtol=CLOSE)
        off = np.abs(row[4::2] - block.score)
        assert np.all(off <= CLOSE * np.maximum(np.sqrt(shown), np.abs(block.score)))


def test_every_block_is_reduced_as_python_does_it(program: Path) -> None:
    recording = read(rows(2)[FIRST:])
    _, lines = answered(program, rows_of(recording), "--blocks")
    require_the_same(reference(), recording, lines, 10)


@pytest.mark.parametrize(
    "change",
    [{}, {"stiffness": 1.1 * STIFFNESS}, pytest.param({"damping": 1.6}, marks=pytest.mark.slow)],
)
def test_alarms_come_at_the_same_sample_with_the_same_cause(
    program: Path, change: dict[str, float]
) -> None:
    later = rows(2, **change)[FIRST:]
    lines = ["t,f,laser", *rows(1)[:FIRST], *later]
    events = [
        e
        for e in watch(Watch(pushed_model(), REFERENCE_S), lines)
        if e.kind in ("changed", "named")
    ]
    status, said = answered(program, "\n".join(["t,f,laser", *later]))
    assert status == int(bool(change))
    assert len(events) == len(said) == 2 * bool(change)
    for event, line in zip(events, said, strict=True):
        require_the_same_event(event, line)


def require_the_same_event(event: Event, line: str) -> None:
    number = r"([-+.\de]+)"
    found = re.fullmatch(
        rf"{number} s  (.*) since {number} s: (.*?)((?:, \S+ by .*?)+) \((\d+) % likely(.*)\)", line
    )
    assert found is not None
    assert float(found[1]) == pytest.approx(event.at_s)
    assert found[2] == f"{'something' if event.kind == 'changed' else 'what'} has changed"
    assert float(found[3]) == pytest.approx(event.since_s)
    assert found[4] == event.cause
    amounts = re.findall(rf", \S+ by {number} \+- {number}", found[5])
    for (value, sd), amount in zip(amounts, event.amounts, strict=True):
        assert float(value) == pytest.approx(amount.value, rel=CLOSE)
        assert float(sd) == pytest.approx(amount.sd, rel=CLOSE)
    assert event.probability is not None
    assert float(found[6]) == round(100 * event.probability)
    assert found[7] == "".join(f"; or {rival}" for rival in event.rivals)


def test_after_a_name_it_is_silent(program: Path) -> None:
    later = rows(2, stiffness=1.1 * STIFFNESS)[FIRST:]
    again = [f"{float(row.split(',', 1)[0]) + 60:.4f},{row.split(',', 1)[1]}" for row in later]
    assert answered(program, "\n".join([*later, *again])) == answered(program, "\n".join(later))


def test_a_number_that_is_none_costs_its_block_and_no_more(program: Path) -> None:
    later = [*rows(1)[FIRST:]]
    later[150] = f"{later[150].rsplit(',', 1)[0]},nan"
    status, said = answered(program, "\n".join(later))
    assert status == 0
    assert [line.split("  ")[1] for line in said] == ["a block cannot be read"]


def test_time_that_goes_back_is_said(program: Path) -> None:
    rows_of_blocks = rows(1)[FIRST : FIRST + 6 * reference().rows]
    status, said = answered(program, "\n".join([*rows_of_blocks, *rows_of_blocks]))
    assert status == 0
    assert [line.split("  ")[1] for line in said] == ["time went back"]


@pytest.mark.parametrize("row", ["30.0,1", "30.0,1,2,3", "30.0,x,2", "x" * 100_000])
def test_a_row_that_is_wrong_ends_the_program(program: Path, row: str) -> None:
    status, said = answered(program, f"{rows(1)[FIRST]}\n{row}\n")
    assert status == 2
    assert said == ["row 2: does not hold 3 numbers between commas"]


def test_constants_fit_together() -> None:
    found = constants_of(reference())
    sizes, arrays, integers = found.sizes, found.arrays, found.integers
    columns = reference().gauge.setting.library.columns
    assert sizes["N_C"] == sum(map(len, columns))
    assert sizes["N_COLUMNS"] == sizes["N_C"] + sizes["N_F"] == len(integers["KNOWN"])
    assert arrays["CUMULANT"].size == sizes["N_BOUNDS"] * sizes["N_TILTS"] * sizes["N_COLUMNS"]
    assert arrays["CLUSTERED"].size == sizes["N_BOUNDS"] * sizes["N_LENGTHS"] * sizes["N_COLUMNS"]
    assert len(integers["COLUMN"]) == sizes["N_NUMBERS"] == len(found.amounts)
    assert integers["FIRST"][-1] == len(integers["COLUMN"])
    assert integers["PAIR"][-1] == sizes["N_PAIRS"]
    assert found.motion == (0,)
    assert found.steep == ()
    assert all(np.isfinite(one).all() for one in arrays.values())


def test_the_functions_are_dense_and_have_names_of_their_own() -> None:
    setting = reference().gauge.setting
    made = monitored(setting.windows, setting.library, (0,), ())
    names = [function.name() for function in made.functions]
    assert len(set(names)) == len(names)
    assert {"model_step", "model_forces", "model_sense"} <= set(names)
    assert "model_pathways" not in names
    outputs = [(f, i) for f in made.functions for i in range(f.n_out())]
    assert all(f.sparsity_out(i).is_dense() for f, i in outputs)
    assert made.sizes()["SZ_ARG"] >= 8


def test_the_code_allocates_nothing_opens_nothing_and_is_always_the_same() -> None:
    files = monitor_files(reference(), "rig", "good.csv", 1.0)
    assert files == monitor_files(reference(), "rig", "good.csv", 1.0)
    assert not re.search(r"\b(malloc|calloc|realloc|free|fopen|printf)\b", files["rig.c"])
    assert sorted(files) == ["README.md", "rig.c", "rig.h", "rig_main.c"]
    assert not re.search(r"@[A-Z_]+@", "".join(files.values()))


def test_everything_that_has_no_monitor_in_c_is_said_at_once() -> None:
    text = DRIVEN_MASS.replace('f = { unit = "N" }', 'f = { unit = "N", between = "held" }')
    text = text.replace('unit = "m" }\n', 'unit = "m", delay = { value = 5, unit = "ms" } }\n')
    text = text.replace(
        'x = { unit = "m", delay = { value = 5, unit = "ms" } }', 'x = { unit = "m" }'
    )
    with pytest.raises(InputError) as refused:
        require_monitored(parse_model(text, "held.toml"), ("x",))
    said = "\n".join(map(str, refused.value.problems))
    assert "held.toml: inputs.f: is held between its samples" in said
    assert "held.toml: sensors.laser: has a delay" in said
    assert "held.toml: coordinates.x: no sensor shows its place" in said


def test_the_command_line_writes_a_monitor(tmp_path: Path, symhyb: Call) -> None:
    model, good = tmp_path / "mass.toml", tmp_path / "good.csv"
    model.write_text(DRIVEN_MASS, encoding="utf-8")
    good.write_text("\n".join(["t,push,laser", *rows(1)[:FIRST]]), encoding="utf-8")
    order = ("export", model, "--to", "monitor", "--recording", good, "-o", tmp_path / "rig")
    done = symhyb(*order, "--map", "f=push")
    assert (done.status, done.err) == (0, "")
    assert "rig.h, rig.c, rig_main.c, README.md" in done.out
    program = compiled(tmp_path / "rig", "rig")
    status, _ = answered(program, "\n".join(rows(2, stiffness=1.1 * STIFFNESS)[FIRST:]))
    assert status == 1


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--to", "monitor"), "--to monitor goes with --recording FILE"),
        (("--to", "c", "--recording", "good.csv"), "no other form does"),
        (("--to", "monitor", "--recording", "good.csv", "--whole"), "leave out --element"),
        (
            ("--to", "monitor", "--recording", "good.csv", "--name", "3"),
            "names files and functions",
        ),
        (("--to", "monitor", "--recording", "none.csv"), "none.csv"),
    ],
)
def test_an_order_that_cannot_be_met_writes_nothing(
    options: tuple[str, ...], said: str, tmp_path: Path, symhyb: Call
) -> None:
    model, output = tmp_path / "mass.toml", tmp_path / "rig"
    model.write_text(DRIVEN_MASS, encoding="utf-8")
    done = symhyb("export", model, *options, "-o", output)
    assert done.status != 0
    assert said in done.err
    assert not output.exists()


@pytest.mark.thorough
def test_two_coordinates_steep_friction_a_bent_sensor_and_memory(tmp_path: Path) -> None:
    later = stretch(cart(3), slice(8000, None))
    program = made(cart_begun(), tmp_path)
    status, lines = answered(program, rows_of(later), "--blocks")
    assert status == 0
    require_the_same(cart_begun(), later, lines, len(later) // cart_begun().rows)
    reference = rows_of(
        stretch(cart(3), slice(0, 8000))
    )  # from rest; it does not differ from itself
    assert answered(program, reference) == (0, [])
    checks = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    watched = compiled(tmp_path, "monitor", *checks)
    assert answered(watched, rows_of(stretch(later, slice(0, 400))))[0] == 0


@pytest.mark.slow
def test_samples_that_are_averaged(tmp_path: Path) -> None:
    recording = cart_like(60.0)
    found = begun(pushed_model(), stretch(recording, slice(0, 20_000)), 1.0, "good.csv")
    assert found.gauge.thinning > 1
    later = stretch(recording, slice(20_000, None))
    status, lines = answered(made(found, tmp_path), rows_of(later), "--blocks")
    assert status == 0
    require_the_same(found, later, lines, len(later) // found.rows)


def cart_like(seconds: float) -> Recording:
    """The pushed mass at 500 Hz."""
    from scipy.signal import lsim

    from tests.pushed import DAMPING, NOISE, pushing

    random = np.random.default_rng(7)
    t = np.arange(0, seconds, 0.002)
    force = pushing(random, t)
    _, x, _ = lsim(([1.0], [1.0, DAMPING, STIFFNESS]), force, t)
    seen = x + NOISE * random.standard_normal(t.size)
    return Recording("fast.csv", t, {"f": force}, {"laser": seen}, (), "")

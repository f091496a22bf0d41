"""MDF measurements: groups are parts with times of their own, units are those of the channels."""

import numpy as np
import pytest

from symhyb.data.files.formats import read_table
from symhyb.data.files.mdf_file import read_mdf
from symhyb.data.recording import read_recording
from symhyb.errors import InputError

asammdf = pytest.importorskip("asammdf", reason="the extra mdf is not installed")


def signal(name, values, t, unit="", **more):
    return asammdf.Signal(np.asarray(values), np.asarray(t), name=name, unit=unit, **more)


@pytest.fixture
def content(tmp_path):
    """The bytes of an MDF file with these groups of signals."""

    def content_of(*groups, version="4.10"):
        with asammdf.MDF(version=version) as measurement:
            for group in groups:
                measurement.append(group, common_timebase=True)
            path = measurement.save(tmp_path / "made", overwrite=True)
        return path.read_bytes()

    return content_of


@pytest.fixture
def one_group(signals):
    t = signals["t"]
    units = {"f": "N", "laser": "um", "accel": ""}
    scale = {"f": 1, "laser": 1000, "accel": 1}
    return [signal(n, scale[n] * signals[n], t, units[n]) for n in units]


@pytest.mark.parametrize(("version", "name"), [("4.10", "run.mf4"), ("3.30", "run.mdf")])
def test_a_group_is_read_with_its_times_and_units(
    model, write, content, one_group, signals, version, name
):
    recording = read_recording(write(name, content(one_group, version=version)), model)
    np.testing.assert_allclose(recording.t, signals["t"])
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] / 1e3)
    np.testing.assert_allclose(recording.inputs["f"], signals["f"])
    assert recording.notes == ()


@pytest.mark.slow
def test_groups_of_different_rates_are_merged(model, write, content, signals):
    t, slow = signals["t"], signals["t"][::10]
    path = write(
        "run.mf4",
        content(
            [signal("f", signals["f"], t, "N"), signal("laser", signals["laser"], t, "mm")],
            [signal("accel", signals["accel"][::10], slow, "m/s^2")],
        ),
    )
    recording = read_recording(path, model)
    np.testing.assert_allclose(recording.t, t)
    measured = np.isfinite(recording.sensors["accel"])
    assert np.flatnonzero(measured).tolist() == list(range(0, 100, 10))
    assert "sensor accel: 10 Hz beside rows at 100 Hz; missing in between" in recording.notes
    assert read_table(f"{path}#2").names() == ["t", "accel"]


def test_samples_flagged_as_invalid_are_missing(model, write, content, one_group):
    bits = np.zeros(100, dtype=bool)
    bits[40:50] = True
    laser = signal("laser", one_group[1].samples, one_group[1].timestamps, "um")
    laser.invalidation_bits = asammdf.signal.InvalidationArray(bits)
    recording = read_recording(
        write("run.mf4", content([one_group[0], laser, one_group[2]])), model
    )
    assert np.isnan(recording.sensors["laser"]).nonzero()[0].tolist() == list(range(40, 50))


def test_texts_are_said_and_left_out_and_unknown_units_ignored(model, write, content, one_group):
    t = one_group[0].timestamps
    odd = signal("accel", one_group[2].samples, t, "furlong%")
    words = signal("state", np.array([b"on"] * 100), t, encoding="utf-8")
    recording = read_recording(write("run.mf4", content([*one_group[:2], odd, words])), model)
    assert recording.notes == ("channel state is no vector of numbers: left out",)
    np.testing.assert_allclose(recording.sensors["accel"], odd.samples)


@pytest.mark.parametrize("junk", [b"t,f\n0,1\n", b"\x89HDF" + b"\0" * 900])
def test_what_is_no_mdf_file(write, junk):
    with pytest.raises(InputError, match="is not an MDF file, although its name says so"):
        read_table(write("run.mf4", junk))


@pytest.mark.slow
def test_cuts_and_damage_are_one_sentence_or_the_same_values(write, content, one_group):
    whole = content(one_group)
    names = read_table(write("run.mf4", whole)).names()
    said = []
    for length in [64, len(whole) // 2, len(whole) - 500]:
        try:
            read_table(write("run.mf4", whole[:length]))
        except InputError as error:
            said.append(str(error))
    assert len(said) == 3, names
    assert all("damaged or cut off MDF file" in text for text in said)


def test_a_measurement_without_a_sample(write, content, one_group):
    empty = [signal(s.name, s.samples[:0], s.timestamps[:0]) for s in one_group]
    with pytest.raises(InputError, match="holds no channel with numbers and times"):
        read_table(write("run.mf4", content(empty)))


@pytest.mark.slow
def test_damage_inside_is_a_sentence_and_nothing_is_printed(write, content, one_group, capfd):
    whole, said = content(one_group), []
    for place in range(64, len(whole), 211):
        broken = bytearray(whole)
        broken[place] ^= 0xF1
        try:
            read_mdf(bytes(broken), "run.mf4")
        except InputError as error:
            said.append(str(error))
    assert said
    assert all("\n" not in text for text in said)
    table = read_table(write("run.mf4", whole.replace(b"</HDcomment>", b"</HDcommenX>")))
    assert "the file is damaged in places, channels may be missing" in table.notes[0]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("version", ["4.10", "3.30"])
def test_a_formula_of_a_file_is_not_run(model, write, content, one_group, tmp_path, version):
    """asammdf would run it as Python; the channel is left out, with a note."""
    from asammdf.blocks.conversion_utils import from_dict

    marker = tmp_path / "ran"
    f, laser, accel = one_group
    speed = signal("speed", accel.samples, accel.timestamps)
    speed.conversion = from_dict({"formula": f"[open('{marker}','w').write('x'), X][1]"})
    made = content([f, laser, accel, speed], version=version)
    marker.unlink(missing_ok=True)  # what writes the file may run it
    recording = read_recording(write("run.mf4", made), model)
    assert not marker.exists()
    assert "channel speed is converted by a formula of the file, which is not run" in " ".join(
        read_table(write("again.mf4", made)).notes
    )
    assert set(recording.sensors) == {"laser", "accel"}
    assert not marker.exists()


def test_a_rational_conversion_is_computed(write, content, signals):
    """By arithmetic alone, without what a formula would be run with."""
    from asammdf.blocks.conversion_utils import from_dict

    made = signal("f", signals["f"], signals["t"], "N")
    factors = {"P1": 0.5, "P2": 2.0, "P3": 1.0, "P4": 0.0, "P5": 0.1, "P6": 4.0}
    made.conversion = from_dict({f.lower(): value for f, value in factors.items()} | factors)
    table = read_table(write("run.mf4", content([made])))
    x = np.asarray(signals["f"])
    read = next(column.values for column in table.columns if column.header.startswith("f"))
    np.testing.assert_allclose(read, (0.5 * x**2 + 2 * x + 1) / (0.1 * x + 4))

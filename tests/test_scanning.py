"""One passage along a long recording: ΔF by stretches, laws for the whole, what is unlike."""

import numpy as np
import pytest
from command import caller
from rigs import DAMPING, MASS, STIFFNESS, spring_model

from symhyb import scanning
from symhyb.console.scanned import scan_facts, scan_table
from symhyb.errors import InputError
from symhyb.model.write import write_model
from symhyb.scanning import scan

DRAG, COULOMB, FROM = 3.0, 1.5, 240.0


def columns_of(duration, noise=1e-5, sticky_from=np.inf):
    """Time, force and place: a motion is chosen, and the force that it takes is computed."""
    t = np.arange(0, duration, 0.005)
    lines = np.array([0.35, 0.6, 0.85, 1.3, 1.7])
    angles = 2 * np.pi * lines * t[:, None] + np.array([0.1, 1.4, 2.2, 4.0, 5.1])
    rates = 2 * np.pi * lines
    x = 0.05 * np.sin(angles).sum(axis=1)
    v = 0.05 * (rates * np.cos(angles)).sum(axis=1)
    a = -0.05 * (rates**2 * np.sin(angles)).sum(axis=1)
    f = MASS * a + STIFFNESS * x + DAMPING * v + DRAG * np.abs(v) * v
    f += COULOMB * np.sign(v) * (t >= sticky_from)
    return t, f, x + noise * np.random.default_rng(1).standard_normal(t.size)


@pytest.fixture
def symhyb(monkeypatch, capsys):
    return caller(monkeypatch, capsys)


@pytest.fixture
def written(tmp_path):
    """The path of a CSV file of these columns."""

    def write(t, f, x, name="day.csv"):
        path = tmp_path / name
        table = np.column_stack([t, f, x])
        np.savetxt(path, table, "%.9g", ",", header="t,f,laser", comments="")
        return path

    return write


@pytest.mark.slow
def test_what_is_lacking_is_named_and_every_stretch_has_it(written):
    found = scan(spring_model(), written(*columns_of(120)), stretches=6)
    (law,) = found.proposed
    assert law.hypothesis.kind == "drag"
    assert law.values["drag"] == pytest.approx(DRAG, rel=0.01)
    assert found.unlike == ()
    assert 3 <= len(found.stretches) <= 6
    assert found.stretches[0].start == 0
    assert found.stretches[-1].end == pytest.approx(120, abs=0.1)
    pairs = zip(found.stretches, found.stretches[1:], strict=False)
    assert all(one.end == pytest.approx(other.start) for one, other in pairs)
    t, _, x = columns_of(120)
    v = np.gradient(x, t)
    lacking = [one.force[0] for one in found.stretches]
    assert np.mean(lacking) == pytest.approx(DRAG * np.sqrt(np.mean(v**4)), rel=0.03)


@pytest.mark.slow
def test_a_stretch_in_which_more_acts_is_unlike_the_others(written):
    path = written(*columns_of(300, sticky_from=FROM))
    found = scan(spring_model(), path, stretches=10)
    assert found.unlike
    assert all(one.end > FROM for one in found.unlike)
    facts = scan_facts(found)
    assert [one["unlike"] for one in facts["stretches"]].count(True) == len(found.unlike)
    rows = scan_table(found).splitlines()
    assert rows[0] == "start [s],end [s],lacking x [N],applied x [N],left x [N]"
    assert len(rows) == 1 + len(found.stretches)


@pytest.mark.slow
def test_pieces_make_no_difference(written, monkeypatch):
    path = written(*columns_of(100))
    whole = scan(spring_model(), path)
    monkeypatch.setattr(scanning, "FORCES_MOST", 1)  # pieces as short as windows allow
    parts = scan(spring_model(), path)
    assert parts.samples == pytest.approx(whole.samples, abs=parts.averaged * 20)
    pairs = zip(whole.stretches, parts.stretches, strict=True)
    for one, other in pairs:
        np.testing.assert_allclose(other.force, one.force, rtol=0.01)
        np.testing.assert_allclose(other.applied, one.applied, rtol=0.01)
    for one, other in zip(whole.proposed, parts.proposed, strict=True):
        assert other.hypothesis.kind == one.hypothesis.kind
        assert other.values["drag"] == pytest.approx(one.values["drag"], rel=0.01)


def test_nothing_is_proposed_where_nothing_lacks(written):
    t, f, x = columns_of(60)
    v = np.gradient(x, t)
    model = spring_model()
    spotless = written(t, f - DRAG * np.abs(v) * v, x)
    found = scan(model, spotless)
    assert all(one.force[0] < 0.02 * one.applied[0] for one in found.stretches)


@pytest.mark.slow
def test_the_verb_says_what_to_do_next(written, tmp_path, symhyb):
    path = written(*columns_of(300, sticky_from=FROM))
    model, table = tmp_path / "rig.toml", tmp_path / "stretches.csv"
    write_model(spring_model(), model)
    done = symhyb("scan", model, path, "--stretches", 10, "--csv", table)
    assert done.status == 0, done.err
    assert "drag on x" in done.out
    assert "unlike the others" in done.out
    assert f"next: symhyb diagnose {model} {path} --start " in done.out
    assert table.read_text().startswith("start [s]")
    again = symhyb("scan", model, path, "--csv", table)
    assert again.status == 2
    assert "--force" in again.err


def test_stretches_are_counted_from_one(written):
    with pytest.raises(InputError, match="at least 1"):
        scan(spring_model(), written(*columns_of(20)), stretches=0)

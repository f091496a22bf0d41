"""A law between two coordinates is found where no element of the model stands."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rewritings import chains, multisine

import symhyb as sh
from symhyb.model.types import On


@pytest.mark.slow
def test_friction_between_two_masses_is_found_where_nobody_named_a_place(tmp_path: Path) -> None:
    """The model has the link as a potential energy and as laws on each mass."""
    (way,) = (way for way in chains() if way.name == "energy and laws")
    t = np.arange(0, 20, 0.002)  # finer than what is recorded, for the push is smooth
    push = multisine(t, 8.0, seed=1)
    true = way.with_law("friction", "link", coulomb=0.8, transition=1e-4)
    run = true.simulated(t, [0.0, 0.0], [0.0, 0.0], push[:, None])
    dense = way.recorded(run, {"f": push}, noise=0.005, seed=2)
    recording = replace(
        dense,
        t=dense.t[::5],
        inputs={name: values[::5] for name, values in dense.inputs.items()},
        sensors={name: values[::5] for name, values in dense.sensors.items()},
    )
    diagnosis = sh.diagnose(way.model, recording)
    assert diagnosis.verdict == "missing physics"
    (found,) = diagnosis.found
    assert found.element.kind == "friction"
    assert found.element.place == On("y - x")
    (level,) = (one for one in found.estimates if one.term == "coulomb")
    assert level.value == pytest.approx(0.8, rel=0.03)
    assert found.sentence.startswith("On y − x, dry (Coulomb) friction of")
    assert "resists the relative motion" in found.sentence
    corrected = sh.apply(way.model, diagnosis.found)
    sh.write_model(corrected, tmp_path / "corrected.toml")
    again = sh.read_model(tmp_path / "corrected.toml")
    assert again.elements[-1].place == On("y - x")
    verdict = sh.judge(way.model, corrected, on=recording)
    sh.write_report(tmp_path / "report.html", diagnosis, verdict)
    sh.write_diagnosis(tmp_path / "diagnosis.json", diagnosis, verdict)
    reported = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))
    assert [one["place"] for one in reported["found"]] == [{"on": "y - x"}]
    assert {"on": "y - x"} in [one["place"] for one in reported["places"]]

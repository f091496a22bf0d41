"""An interrupted diagnosis says what it knows by then."""

import re

import numpy as np
import pytest
from builders import damper, oscillator, push, recording, spring

import symhyb as sh
from symhyb.console.terminal import progress
from symhyb.correction.search.so_far import fits_best, if_interrupted
from symhyb.fault import SO_FAR

INPUTS = {"f": {"unit": "N"}}


def test_an_interruption_keeps_what_was_known() -> None:
    with (
        pytest.raises(KeyboardInterrupt) as outer,
        if_interrupted(lambda: "much"),
        if_interrupted(lambda: "nothing"),
    ):
        raise KeyboardInterrupt
    assert outer.value.__notes__ == [SO_FAR + "nothing", SO_FAR + "much"]
    with pytest.raises(KeyboardInterrupt) as silent, if_interrupted(lambda: ""):
        raise KeyboardInterrupt
    assert not hasattr(silent.value, "__notes__")


def test_the_terminal_is_told_once_and_by_the_innermost(capsys: pytest.CaptureFixture[str]) -> None:
    def work() -> None:
        with progress() as say, if_interrupted(lambda: "outer"):
            say("weighing")
            with if_interrupted(lambda: "inner"):
                raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work()
    err = capsys.readouterr().err
    assert err == "note: interrupted at this step: weighing\nnote: so far: inner\n"


def test_a_search_that_is_interrupted_names_the_best_structure_so_far() -> None:
    t = np.arange(0, 12, 0.01)
    known = {"hold": spring("k"), "motor": push("f")}
    model = oscillator(known, {"k": (40.0, "N/m")}, inputs=INPUTS)
    true = oscillator(
        {**known, "rail": damper("d")},
        {"k": (40.0, "N/m"), "d": (3.0, "N*s/m")},
        inputs=INPUTS,
    )
    force = 5 * np.sin(3 * t) + 4 * np.sin(7.3 * t)
    machine = sh.build(true)
    run = sh.simulate(machine, sh.Scenario(t, np.zeros(1), np.zeros(1), t, force[:, None]))
    noise = 1e-3 * np.random.default_rng(1).standard_normal(t.size)
    tried: list[str] = []

    def stop(line: str) -> None:
        tried.append(line)
        if line == "estimating values":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        sh.diagnose(model, recording(t, {"f": force}, place=run.y[:, 0] + noise), say=stop)
    (note,) = stopped.value.__notes__
    assert note.startswith("so far: damper (damping) on x fits best of the ")
    ((value, sd),) = re.findall(r"noise \(damping ([\d.]+) ± ([\d.]+) N·s/m; not judged", note)
    assert abs(float(value) - 3.0) < 4 * float(sd)


def test_one_structure_is_counted_as_one() -> None:
    fit = type("Fit", (), {"scale": 4.0})()
    best = type("Best", (), {"fit": fit, "name": "the model as it is", "causes": ()})()
    said = "the model as it is fits best of the structure that was tried, and leaves 2 times"
    assert fits_best(best, 1) == f"{said} the noise"

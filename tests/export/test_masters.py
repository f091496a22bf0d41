"""Host and correction as two FMUs for co-simulation, coupled by masters that are not ours.

libcosim and ecos step all their members side by side and exchange afterwards, so a force arrives
one step late; the same exchange, written out here, must give the same motion.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from builders import oscillator, push
from fmus import get, loaded, put, started, written
from test_coupled import END, error, law

from symhyb.export.spec import Spec, spec_of

pytestmark = pytest.mark.masters

Master = Callable[[Path, Path], np.ndarray]

H = 1e-2
STEPS = round(END / H)


@cache
def host() -> Spec:
    """The mass on its cubic spring under its harmonic force, and an input for what it lacks."""
    model = oscillator(
        {
            "cubic": {"kind": "spring", "on": "x", "cubic": "c"},
            "drive": {"kind": "harmonic", "on": "x", "amplitude": "a", "frequency": "f"},
            "missing": push("dF"),
        },
        parameters={
            "m": (1.0, "kg"),
            "c": (5.0, "N/m^3"),
            "a": (5.0, "N"),
            "f": (1.0, "Hz"),
        },
        inputs={"dF": {"unit": "N"}},
        start=0.5,
    )
    return spec_of(model, "host", whole=True)


def reference(spec: Spec, name: str) -> int:
    return next(v.reference for v in spec.variables if v.name == name)


def side_by_side(one: Path, other: Path, fmi: int) -> np.ndarray:
    """Both are stepped, then each is given what the other one has. The position, m, after each of
    the steps, as from every function here."""
    place, speed, force = (reference(host(), n) for n in ("q.x", "v.x", "u.dF"))
    seen, answer = reference(law(), "v.x"), reference(law(), "dF.x")
    out = []
    with loaded(one, fmi) as machine, loaded(other, fmi) as missing:
        pair = started(machine, fmi), started(missing, fmi)

        def exchange() -> None:
            rate, correction = get(machine, fmi, [speed]), get(missing, fmi, [answer])
            put(missing, fmi, [seen], rate)
            put(machine, fmi, [force], correction)

        exchange()
        for i in range(STEPS):
            for member in pair:
                member.doStep(i * H, H)
            exchange()
            out.append(get(machine, fmi, [place])[0])
    return np.array(out)


def by_libcosim(one: Path, other: Path) -> np.ndarray:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.ERROR)
    run = CosimExecution.from_step_size(round(H * 1e9))
    members = [CosimLocalSlave(str(p), n) for p, n in ((one, "machine"), (other, "missing"))]
    machine, missing = (run.add_local_slave(m) for m in members)
    run.connect_real_variables(machine, reference(host(), "v.x"), missing, reference(law(), "v.x"))
    run.connect_real_variables(
        missing, reference(law(), "dF.x"), machine, reference(host(), "u.dF")
    )
    seen = CosimObserver.create_last_value()
    run.add_observer(seen)
    out = []
    for _ in range(STEPS):
        assert run.step()
        out.append(seen.last_real_values(machine, [reference(host(), "q.x")])[0])
    return np.array(out)


def by_ecos(one: Path, other: Path) -> np.ndarray:
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    structure.add_model("machine", str(one))
    structure.add_model("missing", str(other))
    structure.make_real_connection("machine::v.x", "missing::v.x")
    structure.make_real_connection("missing::dF.x", "machine::u.dF")
    out = []
    with EcosSimulation(structure=structure, step_size=H) as run:
        run.init()
        for _ in range(STEPS):
            run.step()
            out.append(run.get_real("machine::q.x"))
    return np.array(out)


@pytest.mark.parametrize(("master", "fmi"), [(by_libcosim, 2), (by_ecos, 2), (by_ecos, 3)])
def test_a_master_that_is_not_ours_moves_the_machine_as_the_same_exchange_by_hand(
    master: Master, fmi: int, tmp_path: Path
) -> None:
    """A force that is one step of 10 ms late leaves 1.2 % of the error without a correction."""
    pair = written(tmp_path, host(), fmi), written(tmp_path, law(), fmi)
    expected = side_by_side(*pair, fmi)
    np.testing.assert_allclose(master(*pair), expected, rtol=0, atol=1e-9)
    left = error(np.r_[0.5, expected][:, None])
    assert 1e-3 < left < 0.02

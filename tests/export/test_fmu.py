"""An FMU is what it says: valid, bit by bit the law that was found, differentiable, restorable."""

import math
import tempfile
import threading
import zipfile
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmus import (
    doubles,
    element,
    get,
    jacobian,
    loaded,
    machine,
    network,
    places,
    put,
    started,
    whole,
    written,
)
from scipy.integrate import solve_ivp

from symhyb.errors import InputError
from symhyb.export.c_code import samples
from symhyb.export.fmu import fmu
from symhyb.export.pack import archive
from symhyb.export.spec import spec_of
from symhyb.numeric.kernels.buffers import call

POINTS = 20_000
SPECS = {"element": element, "whole": whole}


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, int], Path]:
    folder = tmp_path_factory.mktemp("fmus")
    return {
        (name, fmi): written(folder, made(), fmi) for name, made in SPECS.items() for fmi in (2, 3)
    }


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", SPECS)
def test_fmpy_finds_no_problem(fmus, name: str, fmi: int) -> None:
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(fmus[name, fmi])) == []


@pytest.mark.parametrize("fmi", [2, 3])
def test_every_point_is_that_of_symhyb_bit_by_bit(fmus, fmi: int) -> None:
    spec = element()
    at, (t, x, u) = places(spec), samples(spec, POINTS, seed=3)
    with loaded(fmus["element", fmi], fmi, "me") as instance:
        started(instance, fmi)
        instance.enterContinuousTimeMode() if fmi == 3 else None
        worst = 0.0
        for i in range(POINTS):
            instance.setTime(t[i])
            put(instance, fmi, at.input, list(u[i]))
            state = (doubles(x[i]), x.shape[1])
            instance.setContinuousStates(*state)
            made = get(instance, fmi, at.rate + at.output)
            reported = np.concatenate(spec.exported.evaluate(t[i], x[i], u[i], spec.exported.p))
            worst = max(worst, float(np.abs(made - reported).max()))
    assert worst == 0.0


def test_a_large_network_is_small_code_and_the_same_bit_by_bit(tmp_path: Path) -> None:
    """2 inputs and twice 64 units: less than 200 kB, and in C what CasADi computes."""
    spec = network(tmp_path)
    path = written(tmp_path, spec, 2)
    assert path.stat().st_size < 200_000
    at, (_, _, u) = places(spec), samples(spec, 300, seed=17)
    e = spec.exported
    with loaded(path, 2) as instance:
        started(instance, 2)
        for i in range(300):
            put(instance, 2, at.input, list(u[i]))
            assert get(instance, 2, at.output) == list(e.evaluate(0.0, e.x, u[i], e.p)[1])
        made = instance.getDirectionalDerivative(at.output[:1], at.input[1:], [1.0])
    slope = [e.evaluate(0.0, e.x, u[-1] + [0, step], e.p)[1][0] for step in (1e-6, -1e-6)]
    assert made[0] == pytest.approx((slope[0] - slope[1]) / 2e-6, rel=1e-4, abs=1e-4)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", SPECS)
def test_derivatives_along_every_known_are_those_of_the_law(fmus, name: str, fmi: int) -> None:
    spec = SPECS[name]()
    at, (t, x, u) = places(spec), samples(spec, 1, seed=5)
    known, unknown = at.state + at.input + at.parameter, at.rate + at.output
    with loaded(fmus[name, fmi], fmi, "me") as instance:
        started(instance, fmi)
        instance.setTime(t[0])
        put(instance, fmi, at.input, list(u[0]))
        instance.setContinuousStates(doubles(x[0]), x.shape[1])
        made = np.array(
            [instance.getDirectionalDerivative(unknown, [one], [1.0]) for one in known]
        ).T
        if fmi == 3:
            back = np.array(
                [
                    instance.getAdjointDerivative([one], known, [1.0], nSensitivity=len(known))
                    for one in unknown
                ]
            )
            assert back == pytest.approx(made, rel=1e-13, abs=1e-13)
    e = spec.exported
    here = (t[0], x[0], u[0], e.p)
    seeds = np.eye(1 + x.shape[1] + u.shape[1] + e.p.size)[1:]
    exact = np.array(
        [np.concatenate([a.reshape(-1) for a in call(e.forward, (*here, s))]) for s in seeds]
    ).T
    assert np.array_equal(made, exact)
    rough = jacobian(spec, t[0], x[0], u[0])[:, 1:]
    assert exact == pytest.approx(rough, rel=1e-4, abs=1e-4 * np.abs(rough).max())


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(("kind", "bar"), [("CoSimulation", 2e-5), ("ModelExchange", 1e-6)])
def test_the_whole_machine_moves_as_its_equations_say(
    fmus, fmi: int, kind: str, bar: float
) -> None:
    from fmpy import simulate_fmu

    t = np.linspace(0, 2, 201)
    run = simulate_fmu(
        str(fmus["whole", fmi]),
        fmi_type=kind,
        stop_time=2.0,
        output_interval=0.01,
        relative_tolerance=1e-8,
        input=np.array([(0.0, 2.0), (2.0, 2.0)], dtype=[("time", float), ("u.f", float)]),
    )

    def rate(_: float, y: np.ndarray) -> list[float]:
        x, v, z = y
        force = 2 - 40 * x - 200 * x**3 - 0.4 * abs(v) * v - 0.5 * math.tanh(v / 1e-3)
        return [v, (force - 20 * (x - z)) / 1.2, (x - z) * 20 / 3]

    reported = solve_ivp(rate, (0, 2), [0.1, 0, 0.1], "Radau", t, rtol=1e-11, atol=1e-13)
    rms = np.sqrt(np.mean((run["q.x"] - reported.y[0]) ** 2))
    assert rms < bar * np.ptp(reported.y[0])


@pytest.mark.parametrize("fmi", [2, 3])
def test_casadi_reads_it_again_with_the_same_values_and_slopes(fmus, fmi: int) -> None:
    spec = whole()
    with tempfile.TemporaryDirectory() as folder:
        with zipfile.ZipFile(fmus["whole", fmi]) as packed:
            packed.extractall(folder)
        dae = ca.DaeBuilder("d", folder)
        again = dae.create("f", ["x", "u", "p"], ["ode", "y"])
        (_, x, u), e = samples(spec, 1, seed=7), spec.exported
        order_x, order_u = dae.x(), dae.u()
        states = [f"{kind}.{name}" for kind, name in e.states]
        start = [x[0][states.index(name)] for name in order_x]
        assert order_u == ["u.f"]
        p = [dict(zip((f"p.{n}" for _, n in e.parameters), e.p, strict=True))[n] for n in dae.p()]
        rates, y = again(start, u[0], p)
        reported = e.evaluate(0.0, x[0], u[0], e.p)
        back = [order_x.index(name) for name in states]
        assert np.array_equal(np.array(rates).reshape(-1)[back], reported[0])
        named = dict(zip(dae.y(), np.array(y).reshape(-1), strict=True))
        assert named["y.place"] == reported[1][0]
        slope = np.array(again.factory("j", ["x", "u", "p"], ["jac:ode:x"])(start, u[0], p))
        rough = jacobian(spec, 0.0, x[0], u[0])[:3, 1:4]
        assert slope[np.ix_(back, back)] == pytest.approx(rough, rel=1e-4, abs=1e-4)


def test_two_builds_are_the_same_byte_by_byte() -> None:
    first, second = (fmu(element(), 2, platforms=("linux64",)) for _ in range(2))
    assert first == second


@pytest.mark.parametrize("fmi", [2, 3])
def test_steps_are_taken_again_from_a_saved_state_bit_by_bit(fmus, fmi: int) -> None:
    at = places(whole())
    with loaded(fmus["whole", fmi], fmi) as instance:
        started(instance, fmi)
        put(instance, fmi, at.input, [1.5])
        instance.doStep(0.0, 0.1)
        form = "FMUstate" if fmi == 2 else "FMUState"
        state = getattr(instance, f"get{form}")()
        write = "serialize"
        stored = getattr(instance, f"{write}{form}")(state)
        instance.doStep(0.1, 0.2)
        once = get(instance, fmi, at.state + at.output)
        getattr(instance, f"set{form}")(state)
        instance.doStep(0.1, 0.2)
        assert get(instance, fmi, at.state + at.output) == once
        again = getattr(instance, ("deSerialize" if fmi == 2 else "deserialize") + form)(stored)
        getattr(instance, f"set{form}")(again)
        instance.doStep(0.1, 0.2)
        assert get(instance, fmi, at.state + at.output) == once
        for held in (state, again):
            getattr(instance, f"free{form}")(held)
        instance.reset()
        started(instance, fmi)
        put(instance, fmi, at.input, [1.5])
        instance.doStep(0.0, 0.1)
        instance.doStep(0.1, 0.2)
        assert get(instance, fmi, at.state + at.output) == once


def test_instances_on_threads_do_not_see_each_other(fmus) -> None:
    at, results = places(whole()), {}

    def work(number: int) -> None:
        with loaded(fmus["whole", 2], 2) as instance:
            started(instance, 2)
            put(instance, 2, at.input, [float(number % 2)])
            for i in range(50):
                instance.doStep(i * 0.01, 0.01)
            results[number] = get(instance, 2, at.state)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results[0] == results[2]
    assert results[1] == results[3]
    assert results[0] != results[1]


@pytest.mark.parametrize("fmi", [2, 3])
def test_what_is_no_number_is_refused_and_not_taken(fmus, fmi: int) -> None:
    at = places(element())
    with loaded(fmus["element", fmi], fmi) as instance:
        started(instance, fmi)
        before = get(instance, fmi, at.output)
        with pytest.raises(FMICallException):
            put(instance, fmi, at.input[:1], [math.nan])
        assert get(instance, fmi, at.output) == before


@pytest.mark.parametrize("fmi", [2, 3])
def test_calls_out_of_turn_are_errors(fmus, fmi: int) -> None:
    at = places(element())
    with loaded(fmus["element", fmi], fmi) as instance:
        for early in (lambda: instance.doStep(0.0, 0.1), lambda: get(instance, fmi, at.output)):
            with pytest.raises(FMICallException):
                early()
        started(instance, fmi)
        with pytest.raises(FMICallException):
            put(instance, fmi, at.output, [1.0])
        with pytest.raises(FMICallException):
            instance.doStep(1.0, 0.1)
        with pytest.raises(FMICallException):
            instance.exitInitializationMode()
        instance.doStep(0.0, 0.1)
        instance.terminate()
        with pytest.raises(FMICallException):
            instance.doStep(0.1, 0.1)


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_inner_state_begins_at_rest_where_the_host_begins(fmus, fmi: int) -> None:
    spec = element()
    at = places(spec)
    with loaded(fmus["element", fmi], fmi) as instance:
        if fmi == 2:
            instance.setupExperiment(startTime=0.0)
        put(instance, fmi, at.input, [0.7, 0.0])
        started_at = instance.enterInitializationMode
        started_at() if fmi == 2 else started_at(startTime=0.0)
        instance.exitInitializationMode()
        assert get(instance, fmi, at.state) == [0.7]
        assert get(instance, fmi, at.output) == [0.0]


def test_a_parameter_may_be_tuned_between_steps(fmus) -> None:
    spec = element()
    at = places(spec)
    names = [name for _, name in spec.exported.parameters]
    with loaded(fmus["element", 2], 2) as instance:
        started(instance, 2)
        put(instance, 2, at.input, [0.1, 2.0])
        before = get(instance, 2, at.output)[0]
        put(instance, 2, [at.parameter[names.index("b")]], [1.4])
        assert get(instance, 2, at.output)[0] == pytest.approx(before - 1.0 * 2.0**2, rel=1e-14)


def test_other_weights_unknown_units_and_a_wrong_guid_are_seen(fmus, tmp_path: Path) -> None:
    """The checks above can fail."""
    from fmpy.validation import validate_fmu

    with zipfile.ZipFile(fmus["element", 2]) as packed:
        files = {name: packed.read(name) for name in packed.namelist()}
    text = files["modelDescription.xml"].decode()
    bare = text.replace('<Unit name="m/s">', '<Unit name="knot">')
    assert bare != text
    odd = tmp_path / "odd.fmu"
    odd.write_bytes(archive({**files, "modelDescription.xml": bare}))
    assert validate_fmu(str(odd)) != []
    key = text.split('guid="')[1][:10]
    odd.write_bytes(archive({**files, "modelDescription.xml": text.replace(key, "{00000000-")}))
    with pytest.raises(Exception, match=r"[Ii]nstantiate"), loaded(odd, 2):
        pass
    spec, (t, x, u) = element(), samples(element(), 1)
    e = spec.exported
    reported = e.evaluate(t[0], x[0], u[0], e.p)[1]
    assert e.evaluate(t[0], x[0], u[0], e.p * (1 + 1e-12))[1] != reported


def test_kinds_versions_and_platforms_that_do_not_exist_are_refused() -> None:
    spec = element()
    for order in ({"fmi": 1}, {"kinds": ("se",)}, {"kinds": ()}, {"platforms": ("amiga",)}):
        with pytest.raises(InputError, match=r"known|needs"):
            fmu(spec, **order)


def test_one_kind_alone_is_possible(tmp_path: Path) -> None:
    from fmpy import read_model_description

    spec = spec_of(machine(), "alone", ("drag",))
    path = written(tmp_path, spec, 2, fmu(spec, 2, ("me",), ("linux64",)))
    described = read_model_description(str(path))
    assert described.coSimulation is None
    assert described.modelExchange.modelIdentifier == "alone"

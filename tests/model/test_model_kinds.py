"""Every kind of the vocabulary in a file: read at every place, written back, and mistakes."""

from dataclasses import replace

import pytest

from symhyb.errors import InputError
from symhyb.model.curves import Curve
from symhyb.model.diff import changes
from symhyb.model.expression import parse_expression
from symhyb.model.maps import Map
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.types import At, Between, Element, Model, Network, On, Pair, Parameter
from symhyb.model.vocabulary import KINDS, Key, curve_units, key_unit, map_units
from symhyb.model.write import append_elements, replace_parameters
from symhyb.units import parse_unit

BASE = """\
symhyb = 1
[coordinates]
x = { unit = "mm" }
phi = { unit = "rad" }
[parameters]
m = { value = 2, unit = "kg" }
n = { value = 2, unit = "1" }
c = { value = 2, unit = "N" }
k = { value = 2, unit = "N/m" }
d = { value = 2, unit = "N*s/m" }
w = { value = 2, unit = "m/s" }
b = { value = 2, unit = "1/m^2" }
nothing = { value = 0, unit = "m" }
[inputs]
f = { unit = "N" }
[points]
a = ["0", "0"]
b = { body = "block", at = ["0", "0"] }
[bodies.block]
mass = "m"
at = ["x", "0"]
"""
HASH = "0123456789abcdef" * 4
PLACES = {"on": On("x"), "between": Between("a", "b"), "at": At("b"), "pair": Pair("x", "phi")}
SAID = {"pair": "on x and phi"}  # a place in words, where they are not its key


def problems(text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_model(text, "file")
    return [str(problem) for problem in caught.value.problems]


def full_element(model: Model, name: str, kind: str, where: str) -> Element:
    """An element with every key that its place can have, each a parameter of its own."""
    declared, place = KINDS[kind], PLACES[where]
    own: list[Parameter] = []
    values = []
    keys = [key for key in declared.keys if where in key.placements and not key.choices]
    keys = [key for key in keys if not (key.signal and key.name == "torque")]  # force says it
    for index, key in enumerate(keys):
        for part in parts(key, where):
            unit = key_unit(model, kind, part, place, 2.0)
            value = 2.0 if key.name == "exponent" else 0.5 + index / 3
            own.append(Parameter(part.replace(".", "_"), value, unit, owner=name))
            values.append((part, parse_expression(part.replace(".", "_"))))
    options = tuple((key.name, key.choices[0]) for key in declared.keys if key.choices)
    network = None
    if kind == "network":
        seen = (parse_expression("x"), parse_expression("x' + f/c*w"))
        network = Network("nets/a.npz", HASH, seen, ((-0.1, 1 / 3), (-2.0, 1e-300)))
    curve = None
    if kind == "curve":
        points = ((-0.1, -1 / 3), (0.0, 1e-300), (2 / 3, 7.0))
        units = curve_units(model, place, options)
        curve = Curve(f"elements.{name}", points, units, "linear", "hold")
    grid = None
    if kind == "map":
        rows = ((-1 / 3, 1e-300), (7.0, 2 / 3), (0.1, 0.0))
        places = (-0.1, 0.0, 2 / 3), (-1.0, 1 / 3)
        grid = Map(f"elements.{name}", *places, rows, map_units(model, place), "hold")
    found = (("by", "test"),)
    more = (tuple(values), tuple(own), found, "all", options, network, curve)
    return Element(name, kind, place, *more, map=grid)


def parts(key: Key, where: str) -> list[str]:
    vector = key.vector and where == "at"
    return [f"{key.name}.x", f"{key.name}.y"] if vector else [key.name]


CASES = [
    (kind.name, where)
    for kind in KINDS.values()
    for where in kind.placements
    if kind.name != "torque"
]


@pytest.mark.parametrize(("kind", "where"), CASES)
def test_every_kind_is_written_and_read_at_every_place(kind: str, where: str) -> None:
    model = parse_model(BASE)
    element = full_element(model, f"found_{kind}", kind, where)
    corrected = append_elements(model, [element])
    (found,) = corrected.elements
    assert corrected.text.startswith(BASE)
    assert replace(found, parameters=()) == replace(element, parameters=())
    for before, after in zip(element.parameters, found.parameters, strict=True):
        assert replace(after, value=before.value) == before
        assert after.value == pytest.approx(before.value, rel=1e-14, abs=0.0)
    bare = replace(corrected, text="")
    assert replace(parse_model(render(bare)), text="") == bare
    (sentence,) = changes(model, corrected)
    assert sentence.startswith(f"+ element found_{kind}: {kind} {SAID.get(where, where)}")
    for _, word in element.options:
        assert word in sentence


@pytest.mark.parametrize(("kind", "where"), CASES)
def test_a_key_that_the_kind_does_not_have_is_refused(kind: str, where: str) -> None:
    model = append_elements(parse_model(BASE), [full_element(parse_model(BASE), "e", kind, where)])
    wrong = model.text.replace(f'kind = "{kind}"', "", 1)
    assert wrong.count("[elements.e]\n") == 1
    text = model.text.replace("[elements.e]\n", '[elements.e]\nviscosity = "d"\n', 1)
    (problem,) = problems(text)
    assert "elements.e.viscosity: 'viscosity' is not a key here; " in problem


def test_a_torque_turns_an_angle() -> None:
    text = BASE + '[elements.motor]\nkind = "torque"\non = "phi"\ntorque = "c*nothing"\n'
    assert parse_model(text).elements[0].value("torque") == parse_expression("c*nothing")


def test_a_vector_is_a_list_at_a_point_alone() -> None:
    text = BASE + '[elements.e]\nkind = "harmonic"\nat = "b"\nfrequency = 3\namplitude = ["c", 0]\n'
    element = parse_model(text.replace("frequency = 3", 'frequency = "3*w/nothing"')).elements[0]
    assert [key for key, _ in element.values] == ["amplitude.x", "amplitude.y", "frequency"]
    (problem,) = problems(text)
    assert "'3.0' is 1, needs 1/s" in problem
    text = text.replace("frequency = 3", 'frequency = "3*w/nothing"')
    assert "must be a list of two" in problems(text.replace('["c", 0]', '"c"'))[0]
    assert "must be an expression" in problems(text.replace('at = "b"\nf', 'on = "x"\nf'))[0]


def faulty(keys: str, place: str = 'on = "x"') -> list[str]:
    return problems(BASE + f"[elements.e]\n{place}\n{keys}\n")


ONE_FAULT = {
    "side": (
        'kind = "gap"\nstiffness = "k"\nside = "uper"',
        "elements.e.side: 'uper' is not a word for it; did you mean 'upper'?",
    ),
    "side far": (
        'kind = "gap"\nstiffness = "k"\nside = "left"',
        "'left' is not a word for it; it is one of upper, lower, both",
    ),
    "side number": ('kind = "gap"\nstiffness = "k"\nside = 1', "must be text in quotes"),
    "clearance unit": ('kind = "gap"\nstiffness = "k"\nclearance = "c"', "'c' is N, needs m"),
    "needs": ('kind = "harmonic"\namplitude = "c"', "kind 'harmonic' needs 'frequency'"),
    "needs period": ('kind = "ripple"\namplitude = "c"', "kind 'ripple' needs 'period'"),
    "needs damping": ('kind = "relaxation"\nstiffness = "k"', "'relaxation' needs 'damping'"),
    "needs stiffness": ('kind = "friction_dynamic"\ncoulomb = "c"', "needs 'stiffness'"),
    "needs misspelt": ('kind = "ripple"\namplitude = "c"\nperid = 3', "did you mean 'period'"),
    "needs coulomb": (
        'kind = "friction_dynamic"\nstiffness = "k"\nstatic = "c"\nstribeck = "w"',
        "kind 'friction_dynamic' needs 'coulomb'",
    ),
    "level zero": ('kind = "friction_dynamic"\nstiffness = "k"\ncoulomb = 0', "law divides by it"),
    "level missing": ('kind = "friction_dynamic"\nstiffness = "k"', "'coulomb' or 'static'"),
    "strength": ('kind = "added_mass"', "kind 'added_mass' needs 'mass'"),
    "stribeck": (
        'kind = "friction_dynamic"\nstiffness = "k"\nstatic = "c"\ncoulomb = "c"',
        "'static' needs 'stribeck'",
    ),
    "load alone": (
        'kind = "friction"\ncoulomb = "c"\nload = "f"',
        "'load' needs 'load_coefficient': friction grows by load_coefficient*abs(load)",
    ),
    "around nothing": (
        'kind = "friction"\ncoulomb = "c"\naround = "nothing"',
        "'around' needs 'slope': friction changes by slope*(s - around)",
    ),
    "slope of nothing": (
        'kind = "friction"\nstatic = "c"\nstribeck = "w"\nslope = "k"',
        "'slope' needs 'coulomb': friction changes by slope*(s - around)",
    ),
    "no flow": ('kind = "flow_lift"\nlift = "d/w"', "kind 'flow_lift' needs 'flow'"),
    "added input": (
        'kind = "added_mass"\nmass = "m*f/c"',
        "f is an input, on which an added mass cannot depend",
    ),
    "added time": ('kind = "added_mass"\nmass = "m*sin(t*w/nothing)"', "cannot depend on the time"),
    "added unit": ('kind = "added_mass"\nmass = "k"', "'k' is N/m, needs kg"),
    "period zero": (
        'kind = "ripple"\namplitude = "c"\nperiod = "nothing"',
        "elements.e.period: 'nothing' is 0; the law divides by it",
    ),
    "damping zero": ('kind = "relaxation"\nstiffness = "k"\ndamping = 0', "the law divides by it"),
    "exponent hides": (
        'kind = "hysteresis"\nstiffness = "k"\nbeta = "b"\nexponent = "2*n"',
        "elements.e.exponent: '2*n' is a unit that hides in an exponent: that of"
        " beta and gamma follows from it; it must be a number or one parameter",
    ),
    "exponent time": ('kind = "hysteresis"\nstiffness = "k"\nexponent = "f/c"', "that hides in an"),
    "exponent small": (
        'kind = "hysteresis"\nstiffness = "k"\nexponent = 0.5',
        "'0.5' is 0.5; it must be at least 1",
    ),
    "exponent negative": ('kind = "hysteresis"\nstiffness = "k"\nexponent = -2', "at least 1"),
    "exponent high": ('kind = "hysteresis"\nstiffness = "k"\nexponent = 21', "and at most 20"),
    "exponent unit": ('kind = "hysteresis"\nstiffness = "k"\nexponent = "m"', "is kg, needs 1"),
    "beta unit": ('kind = "hysteresis"\nstiffness = "k"\nbeta = "b"', "'b' is 1/m^2, needs 1/m"),
    "beta power": (
        'kind = "hysteresis"\nstiffness = "k"\ngamma = "b"\nexponent = 1.5',
        "elements.e.gamma: 'b' is 1/m^2, needs 1/m^(3/2)",
    ),
    "power of a law": (
        'kind = "law"\nforce = "k*x**n"',
        "'x' is in mm, so its power must be a whole number or a simple fraction",
    ),
}


@pytest.mark.parametrize(("keys", "sentence"), ONE_FAULT.values(), ids=ONE_FAULT)
def test_one_fault_is_one_problem(keys: str, sentence: str) -> None:
    (problem,) = faulty(keys)
    assert sentence in problem


@pytest.mark.parametrize("kind", ["spring", "gap", "hysteresis", "friction_dynamic", "relaxation"])
def test_laws_with_memory_or_store_cannot_stand_at_a_point(kind: str) -> None:
    found = faulty(f'kind = "{kind}"\nstiffness = "k"', 'at = "b"')
    assert f"kind '{kind}' cannot stand 'at'; it needs 'on' or 'between'" in found[0]


def test_at_a_point_a_force_has_no_side() -> None:
    (problem,) = faulty('kind = "damper"\ndamping = "d"\nasymmetry = 0.1', 'at = "b"')
    assert "'asymmetry' is for an element 'on' or 'between', not 'at'" in problem


def hysteresis(exponent: str, beta: str) -> str:
    keys = f'kind = "hysteresis"\non = "x"\nstiffness = "k"\nbeta = "e"\nexponent = {exponent}'
    own = f'[elements.e.parameters]\ne = {{ value = 1, unit = "{beta}" }}\n'
    return BASE + f"[elements.e]\n{keys}\n{own}"


@pytest.mark.parametrize(
    ("exponent", "beta"),
    [("1", "1/mm"), ('"n"', "1/m^2"), ("1.5", "1/m^1.5"), ("3.0", "1/mm^3")],
)
def test_the_unit_of_beta_follows_the_exponent(exponent: str, beta: str) -> None:
    assert parse_model(hysteresis(exponent, beta)).elements[0].kind == "hysteresis"
    (problem,) = problems(hysteresis(exponent, "1/m^4"))
    assert "'e' is 1/m^4, needs 1/m" in problem


def test_a_re_estimated_exponent_keeps_the_unit_that_was_written() -> None:
    model = parse_model(hysteresis('"n"', "1/m^2"))
    once = replace_parameters(model, {"n": (1.37, 0.1)})
    twice = replace_parameters(once, {"n": (1.42, 0.05)})
    assert [parameter.value for parameter in twice.parameters if parameter.name == "n"] == [1.42]
    wrong = twice.text.replace('e = { value = 1, unit = "1/m^2"', 'e = { value = 1, unit = "1/s"')
    assert "'e' is 1/s, needs 1/m^(17/12)" in problems(wrong)[0]


def test_an_exponent_between_the_powers_of_units_counts_in_si() -> None:
    model = parse_model(hysteresis("1.37", "1/m^(11/8)"))
    assert model.elements[0].parameters[0].si == 1.0
    (problem,) = problems(hysteresis("1.37", "1/mm^(11/8)"))
    assert "is in 1/mm^(11/8); with an exponent of 1.37 it must be in SI: 1/m^(11/8)" in problem


def test_gap_keeps_its_side() -> None:
    text = BASE + '[elements.e]\nkind = "gap"\non = "x"\nstiffness = "k"\n'
    assert parse_model(text).elements[0].option("side", "both") == "both"
    upper = parse_model(text + 'side = "upper"\n')
    assert upper.elements[0].option("side", "both") == "upper"
    assert changes(parse_model(text), upper) == ("~ element e: side unset -> upper",)


NETWORK = f"""
[elements.e]
kind = "network"
on = "x"
weights = "rest.npz"
sha256 = "{HASH}"
inputs = ["x", "x'", "sin(phi)*f"]
trust = [[-1, 1], [-2.5, 2.5], [0, 1e3]]
"""


def test_a_network_says_its_file_and_its_box() -> None:
    (element,) = parse_model(BASE + NETWORK).elements
    assert element.network == Network(
        "rest.npz",
        HASH,
        tuple(parse_expression(text) for text in ("x", "x'", "sin(phi)*f")),
        ((-1.0, 1.0), (-2.5, 2.5), (0.0, 1000.0)),
    )
    moved = parse_model(BASE + NETWORK.replace("2.5]", "3]"))
    assert changes(parse_model(BASE + NETWORK), moved) == (
        "~ element e: trust -1 to 1, -2.5 to 2.5, 0 to 1000 -> -1 to 1, -2.5 to 3, 0 to 1000",
    )


NETWORK_FAULTS = {
    "weights missing": ('weights = "rest.npz"\n', "", "'weights' is missing"),
    "weights absolute": ('"rest.npz"', '"/etc/passwd"', "'/etc/passwd' must be a file beside"),
    "weights above": ('"rest.npz"', '"a/../../rest.npz"', "a relative name without '..'"),
    "weights windows": ('"rest.npz"', "'C:\\rest.npz'", "must be a file beside the model file"),
    "weights backslash": ('"rest.npz"', "'..\\rest.npz'", "must be a file beside the model file"),
    "weights empty": ('"rest.npz"', '""', "must be a file beside the model file"),
    "hash short": (HASH, HASH[1:], "must be 64 hexadecimal digits"),
    "hash letters": (HASH, "g" * 64, "must be 64 hexadecimal digits"),
    "hash missing": (f'sha256 = "{HASH}"\n', "", "'sha256' is missing"),
    "inputs missing": ("inputs =", "input =", "did you mean 'inputs'"),
    "inputs empty": ('["x", "x\'", "sin(phi)*f"]', "[]", "must be a list of expressions"),
    "inputs text": ('["x", "x\'", "sin(phi)*f"]', '"x"', "a list of expressions, not the text"),
    "inputs wrong": (
        '"x\'"',
        "\"x''\"",
        "x'' is an acceleration, on which what a network sees cannot depend",
    ),
    "inputs unit": ("sin(phi)", "sin(x)", "sin() needs a plain number, but 'x' is in mm"),
    "inputs reading": ('"x\'"', '"distance(a, b)"', "only sensors may use distance(...)"),
    "trust missing": ("trust = [[-1, 1], [-2.5, 2.5], [0, 1e3]]", "", "'trust' is missing"),
    "trust few": (", [0, 1e3]", "", "has 2 ranges for 3 inputs; give one each"),
    "trust text": ("[0, 1e3]", '"all"', "must be [low, high], not the text 'all'"),
    "trust swapped": ("[0, 1e3]", "[1e3, 0]", "[1000, 0] is empty: low must be below high"),
    "trust infinite": ("1e3", "inf", "must be finite"),
    "at": ('on = "x"', 'at = "b"', "kind 'network' cannot stand 'at'"),
    "key": ('on = "x"', 'on = "x"\nstiffness = "k"', "'stiffness' is not a key here"),
}


@pytest.mark.parametrize(("old", "new", "sentence"), NETWORK_FAULTS.values(), ids=NETWORK_FAULTS)
def test_a_wrong_network_is_one_problem(old: str, new: str, sentence: str) -> None:
    assert old in NETWORK
    (problem,) = problems(BASE + NETWORK.replace(old, new, 1))
    assert "elements.e" in problem
    assert sentence in problem


def test_network_keys_are_for_networks() -> None:
    (problem,) = faulty('kind = "spring"\nstiffness = "k"\nweights = "rest.npz"')
    assert "'weights' is not a key here" in problem


def test_units_of_keys_read_back() -> None:
    """Every unit that the vocabulary writes is one that a file may state."""
    model = parse_model(BASE)
    for kind, where in CASES:
        for key in KINDS[kind].keys:
            if where in key.placements:
                unit = key_unit(model, kind, key.name, PLACES[where], 1.5)
                assert parse_unit(unit.text) == unit

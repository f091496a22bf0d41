"""Reading model files: what comes out, and every class of mistake with its line."""

from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.model.expression import Name, parse_expression
from symhyb.model.read import parse_model, read_model
from symhyb.model.types import At, Between, Model, On

MODELS = Path(__file__).parents[2] / "models"

BASE = """\
symhyb = 1
title = "base"
[coordinates]
x = { unit = "m", start = 0.1, start_rate = -2, about = "place" }
phi = { unit = "rad" }
[parameters]
m = { value = 2, unit = "kg" }
J = { value = 0.1, unit = "kg*m^2" }
k = { value = 3.0, unit = "N/mm", sd = 0.5, was = 2.5 }
d = { value = 0.1, unit = "N*s/m" }
g = { value = 9.81, unit = "m/s^2" }
[inputs]
f = { unit = "kN", gain = 1.02, delay = { value = 3, sd = 0.1, unit = "ms" } }
[points]
a = ["x", "0"]
b = ["0", "-2*x"]
[bodies.mass]
mass = "m"
at = "a"
inertia = "J"
angle = "phi"
[elements.spring]
kind = "spring"
on = "x"
stiffness = "k"
[elements.shaker]
kind = "force"
on = "x"
force = "f"
[sensors]
laser = { measures = "x", unit = "mm", sd = 0.02, offset = 0.5 }
"""


def problems(text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_model(text, "file")
    assert caught.value.problems
    return [str(problem) for problem in caught.value.problems]


def base_with(old: str, new: str) -> str:
    assert old in BASE
    return BASE.replace(old, new, 1)


def test_everything_declared_comes_out() -> None:
    model = parse_model(BASE, "base.toml")
    assert (model.title, model.file, model.text) == ("base", "base.toml", BASE)
    x, phi = model.coordinates
    assert (x.start, x.start_rate, x.about) == (0.1, -2.0, "place")
    assert phi.unit.is_angle
    k = model.parameters[2]
    assert (k.value, k.si, k.sd, k.si_sd, k.was) == (3.0, 3000.0, 0.5, 500.0, 2.5)
    (body,) = model.bodies
    assert body.at == model.points[0].at
    assert body.inertia == parse_expression("J")
    spring, shaker = model.elements
    assert spring.place == On("x")
    assert spring.value("stiffness") == parse_expression("k")
    assert spring.value("cubic") is None
    assert shaker.value("force") == parse_expression("f")
    assert model.energy_unit.text == "J"


def test_channels_carry_gain_offset_and_delay_as_parameters() -> None:
    model = parse_model(BASE)
    f, laser = model.inputs[0], model.sensors[0]
    assert f.gain is not None
    assert f.delay is not None
    assert (f.gain.path, f.gain.value, f.gain.sd) == ("f.gain", 1.02, None)
    assert (f.delay.si, f.delay.si_sd) == pytest.approx((3e-3, 1e-4))
    assert f.offset is None
    assert laser.offset is not None
    assert laser.offset.si == pytest.approx(0.5e-3)
    paths = [parameter.path for parameter in model.all_parameters()]
    assert paths == ["m", "J", "k", "d", "g", "f.gain", "f.delay", "laser.offset"]


def test_own_parameters_shadow_those_of_the_model() -> None:
    text = BASE + (
        '[elements.found]\nkind = "damper"\nbetween = ["a", "b"]\ndamping = "k"\n'
        'found = { by = "sparse", nrmse = [0.2, 0.1] }\n'
        '[elements.found.parameters]\nk = { value = 1, unit = "N*s/m" }\n'
    )
    element = parse_model(text).elements[-1]
    assert element.place == Between("a", "b")
    assert element.parameters[0].path == "found.k"
    assert dict(element.found) == {"by": "sparse", "nrmse": (0.2, 0.1)}


def test_a_force_at_a_point_has_two_components() -> None:
    text = BASE + '[elements.wind]\nkind = "law"\nat = "b"\nforce = ["-d*x\'", 0]\n'
    wind = parse_model(text).elements[-1]
    assert wind.place == At("b")
    assert [key for key, _ in wind.values] == ["force.x", "force.y"]


def test_energy_and_gravity() -> None:
    text = base_with("[coordinates]", 'gravity = ["0", "-g"]\n[coordinates]') + (
        '[energy]\nkinetic = "m*x\'**2*phi**2/2"\npotential = "m*g*x"\n'
    )
    model = parse_model(text)
    assert model.gravity == (parse_expression("0"), parse_expression("-g"))
    assert model.energy.kinetic is not None


VOLTS = """\
symhyb = 1
[coordinates]
y = { unit = "V" }
[parameters]
m = { value = 4e-6, unit = "s^2" }
d = { value = 2e-4, unit = "s" }
[inputs]
u = { unit = "V" }
[bodies.circuit]
mass = "m"
at = ["y", "0"]
[elements.loss]
kind = "damper"
on = "y"
damping = "d"
[elements.drive]
kind = "force"
on = "y"
force = "u"
[sensors]
V2 = { measures = "y", unit = "mV" }
"""


def test_volts_work() -> None:
    assert parse_model(VOLTS).energy_unit.text == "V^2"
    (problem,) = problems(VOLTS.replace('2e-4, unit = "s"', '2e-4, unit = "V"'))
    assert "'d' is V, needs s" in problem


def test_energy_of_other_coordinates_may_come_from_the_kinetic_energy() -> None:
    text = VOLTS.replace('[bodies.circuit]\nmass = "m"\nat = ["y", "0"]', "[energy]").replace(
        "[elements.loss]", 'kinetic = "m*y\'**2/2"\n[elements.loss]'
    )
    assert parse_model(text).energy_unit.same_dimension(parse_model(VOLTS).energy_unit)


def test_energies_that_disagree_are_said() -> None:
    (problem,) = problems(VOLTS + '[energy]\npotential = "y"\n')
    assert "'y' is V, needs V^2" in problem


def test_a_byte_order_mark_and_crlf_are_read() -> None:
    model = parse_model("\ufeff" + BASE.replace("\n", "\r\n"))
    assert model.coordinates == parse_model(BASE).coordinates


FIVE = """\
symhyb = 1
title = "five faults"
[coordinates]
x = { unit = "m", strat = 0.0 }
[parameters]
m = { value = 1.0, unit = "kg" }
k = { value = "980", unit = "N/m" }
[bodies.mass]
mass = "m"
at = ["x", "0"]
[elements.damper]
kind = "damper"
on = "x"
damping = "k"
[elements.spring]
kind = "sprin"
on = "x"
[sensors]
laser = { measures = "xx", unit = "m" }
"""


def test_five_faults_are_five_problems_in_the_order_of_the_file(tmp_path: Path) -> None:
    file = tmp_path / "five.toml"
    file.write_text(FIVE)
    with pytest.raises(InputError) as caught:
        read_model(file)
    assert str(caught.value).splitlines() == [
        f"{file}:4: coordinates.x.strat: 'strat' is not a key here; did you mean 'start'?",
        f"{file}:7: parameters.k.value: must be a number, not the text '980'",
        f"{file}:14: elements.damper.damping: 'k' is N/m, needs N*s/m",
        f"{file}:16: elements.spring.kind: 'sprin' is not a known kind; did you mean 'spring'?",
        f"{file}:19: sensors.laser.measures: 'xx' is not a known name; did you mean 'x'?",
    ]


ONE_FAULT = {
    "format missing": ("symhyb = 1\n", "", "does not state its format"),
    "format newer": ("symhyb = 1", "symhyb = 2", "file:1: symhyb: format 2 is newer"),
    "format text": ("symhyb = 1", 'symhyb = "1"', "must be the number 1, not the text '1'"),
    "section unknown": ("[sensors]", "[sensor]", "did you mean 'sensors'"),
    "section misspelt": ("[parameters]", "[paramters]", "file:6: paramters: 'paramters'"),
    "key near": ('angle = "phi"\n', 'angle = "phi"\nrotation = []\n', "did you mean 'rotations'?"),
    "imposed text": (
        'phi = { unit = "rad"',
        'phi = { imposed = "x", unit = "rad"',
        "must be true or false, not the text 'x'",
    ),
    "section no table": ('title = "base"', "energy = 3", "must be a table, not the number 3"),
    "unit missing": ('m = { value = 2, unit = "kg" }', "m = { value = 2 }", "'unit' is missing"),
    "unit misspelt": ("value = 2, unit", "value = 2, unti", "did you mean 'unit'"),
    "unit unknown": ('"N*s/m"', '"Vs/m"', "did you mean 'V*s'"),
    "unit empty": ('"N*s/m"', '""', "unit is empty"),
    "value missing": ('value = 0.1, unit = "N*s/m"', 'unit = "N*s/m"', "'value' is missing"),
    "value true": ("value = 9.81", "value = true", "not the truth value true"),
    "value nan": ("value = 9.81", "value = nan", "must be finite"),
    "value inf": ("value = 9.81", "value = -inf", "must be finite"),
    "value huge": ("value = 9.81", "value = 1" + "0" * 400, "must be finite"),
    "start text": ("start = 0.1", 'start = "0"', "must be a number, not the text '0'"),
    "sd zero": ("sd = 0.5", "sd = 0", "must be positive, not 0"),
    "sd negative": ("sd = 0.02", "sd = -0.02", "must be positive"),
    "mass negative": ("m = { value = 2", "m = { value = -2", "'m' is -2 kg; it must be positive"),
    "mass zero": ('mass = "m"', 'mass = "0"', "is 0; it must be positive"),
    "mass unit": ('mass = "m"', 'mass = "k"', "'k' is N/mm, needs kg"),
    "mass moving": ('mass = "m"', 'mass = "m*x"', "'m*x' is kg*m, needs kg"),
    "mass of a speed": (
        'mass = "m"',
        'mass = "m*x\'"',
        "x' is a speed, on which a mass or inertia",
    ),
    "inertia unit": ('inertia = "J"', 'inertia = "m"', "'m' is kg, needs kg*m^2"),
    "inertia alone": ('angle = "phi"\n', "", "has 'inertia' but no 'angle'"),
    "angle alone": ('inertia = "J"\n', "", "has 'angle' but no 'inertia'"),
    "angle unit": ('angle = "phi"', 'angle = "x"', "'x' is m, needs 1"),
    "body point": ('at = "a"', 'at = "aa"', "'aa' is not a known point; did you mean 'a'"),
    "body place": ('at = "a"', 'at = ["x"]', "a list of two expressions, not a list of 1"),
    "body nowhere": ('at = "a"\n', "", "'at' is missing"),
    "no body": (
        '[bodies.mass]\nmass = "m"\nat = "a"\ninertia = "J"\nangle = "phi"\n',
        "",
        "nothing has a mass",
    ),
    "name twice": ("[inputs]", '[inputs]\nx = { unit = "N" }', "'x' is already declared in"),
    "name stated twice": ("[inputs]", "[[inputs]]\n[inputs]", "a name is stated twice"),
    "name reserved": ("d = {", "pi = {", "'pi' is a reserved name"),
    "name time": ("d = {", "t = {", "'t' is a reserved name"),
    "name function": ("d = {", "exp = {", "'exp' is a reserved name"),
    "name keyword": ("d = {", "lambda = {", "'lambda' is a reserved name"),
    "name no name": ("d = {", '"d-1" = {', "'d-1' is not a name"),
    "sensor time": ("laser = {", "t = {", "the time column"),
    "point speed": ('b = ["0", "-2*x"]', 'b = ["0", "x\'"]', "x' is a speed, on which a position"),
    "point input": ('b = ["0", "-2*x"]', 'b = ["0", "f"]', "f is an input, on which a position"),
    "point units": ('b = ["0", "-2*x"]', 'b = ["x", "m"]', "two components differ: m and kg"),
    "kind missing": ('kind = "spring"\n', "", "'kind' is missing"),
    "kind misspelt": ('kind = "spring"', 'kind = "gapp"', "did you mean 'gap'"),
    "point rough": (
        'b = ["0", "-2*x"]',
        'b = ["0", "max(x, 0)"]',
        "'max(x, 0)' has no smooth speed, which a position needs",
    ),
    "angle rough": ('angle = "phi"', 'angle = "2*abs(phi)"', "'abs(phi)' has no smooth speed"),
    "place rough": ('at = "a"', 'at = ["x", "x*sign(t)"]', "'sign(t)' has no smooth speed"),
    "place missing": ('on = "x"\nstiffness', "stiffness", "the place is missing: 'on' or"),
    "places": ('on = "x"\nst', 'on = "x"\nat = "a"\nst', "stands 'on' and 'at'"),
    "place wrong": ('on = "x"\nst', 'at = "a"\nst', "kind 'spring' cannot stand 'at'"),
    "place itself": ('on = "x"\nst', 'between = ["a", "a"]\nst', "from the point 'a' to itself"),
    "place no pair": ('on = "x"\nst', 'between = "a"\nst', "must be a list of two points"),
    "place unknown": ('on = "x"\nst', 'on = "xx"\nst', "'xx' is not a known coordinate"),
    "point unknown": ('on = "x"\nst', 'between = ["a", "bb"]\nst', "'bb' is not a known point"),
    "key unknown": ('stiffness = "k"', 'stifness = "k"', "did you mean 'stiffness'"),
    "key misplaced": ('stiffness = "k"', 'stiffness = "k"\nlength = "x"', "'length' is for an"),
    "key moving": ('stiffness = "k"', 'stiffness = "k*x/x"', "a coefficient cannot depend on"),
    "key list": ('stiffness = "k"', "stiffness = [1]", "must be an expression in quotes"),
    "strength missing": ('stiffness = "k"\n', "", "needs 'stiffness' or 'quadratic' or 'cubic'"),
    "force unit": ('force = "f"', 'force = "f*x"', "'f*x' is kN*m, needs N"),
    "force acceleration": ('force = "f"', "force = \"m*x''\"", "x'' is an acceleration"),
    "force of rate": ('force = "f"', 'force = "f\'"', "f': only coordinates have derivatives"),
    "force unknown": ('force = "f"', 'force = "ff"', "'ff' is not a known name; did you mean 'f'"),
    "force call": ('force = "f"', 'force = "open(f)"', "'open' is not a known function"),
    "force attribute": ('force = "f"', 'force = "f.real"', "'f.real' is not allowed"),
    "sensor unit": ('unit = "mm"', 'unit = "V"', "'x' is m, needs V"),
    "sensor of nothing": (
        'measures = "x", unit = "mm"',
        'measures = "k", unit = "N/m"',
        "measures no coordinate",
    ),
    "sensor without": ('measures = "x", ', "", "'measures' is missing"),
    "gain zero": ("gain = 1.02", "gain = 0", "must not be 0"),
    "gain text": ("gain = 1.02", 'gain = "1"', "must be a number"),
    "delay unit": ('unit = "ms"', 'unit = "m"', "is in m, needs s"),
    "own unit": ("[inputs]", '[energy]\nkinetic = "m*x\'"\n[inputs]', "needs J"),
    "energy speed": ("[inputs]", '[energy]\npotential = "k*x*x\'"\n[inputs]', "x' is a speed"),
    "energy input": ("[inputs]", '[energy]\npotential = "f*x"\n[inputs]', "f is an input"),
    "gravity unit": ("[coordinates]", 'gravity = ["0", "m"]\n[coordinates]', "needs m/s^2"),
    "gravity one": ("[coordinates]", 'gravity = "g"\n[coordinates]', "a list of two expressions"),
    "title number": ('title = "base"', "title = 3", "must be text in quotes, not the number 3"),
}


@pytest.mark.parametrize(("old", "new", "sentence"), ONE_FAULT.values(), ids=ONE_FAULT)
def test_one_fault_is_one_problem(old: str, new: str, sentence: str) -> None:
    (problem,) = problems(base_with(old, new))
    assert sentence in problem


def test_a_problem_stands_at_its_line() -> None:
    text = base_with('force = "f"', 'force = "ff"')
    line = text.splitlines().index('force = "ff"') + 1
    assert problems(text)[0].startswith(f"file:{line}: elements.shaker.force: ")


def test_static_friction_needs_its_speed() -> None:
    text = BASE + '[elements.rub]\nkind = "friction"\non = "x"\nstatic = "d"\ncoulomb = "k*x"\n'
    found = problems(text)
    assert any("'static' needs 'stribeck'" in problem for problem in found)
    assert any("'d' is N*s/m, needs N" in problem for problem in found)


def test_a_broken_coordinate_or_point_does_not_cascade() -> None:
    assert len(problems(base_with('x = { unit = "m"', 'x = { unit = "mxm"'))) == 1
    text = base_with('a = ["x", "0"]', 'a = ["x +", "0"]') + (
        '[elements.rope]\nkind = "spring"\nbetween = ["a", "b"]\nstiffness = "k"\n'
    )
    assert len(problems(text)) == 1


def test_parameters_of_two_channels_may_not_share_a_path() -> None:
    text = base_with("laser = { ", "f = { gain = 1, ")
    assert "another 'f.gain' is stated elsewhere" in problems(text)[0]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "the file is empty"),
        (b" \n\n", "the file is empty"),
        (b"symhyb = 1\n\xff\xfe", ":2: is not UTF-8 text"),
        (b"symhyb = 1\n[coordinates\n", ":2: is not valid TOML"),
        (b'a = 1\n\n"', ":3: is not valid TOML"),
        (b"a = " + b"9" * 5000, "is not valid TOML"),
        (b"a = " + b"[" * 5000 + b"]" * 5000, "nested too deeply"),
        (b"#" * 1_000_001, "larger than 1 MB"),
    ],
    ids=["empty", "blank", "utf8", "table", "string", "digits", "nested", "large"],
)
def test_unreadable_files_are_one_problem(tmp_path: Path, content: bytes, sentence: str) -> None:
    file = tmp_path / "model.toml"
    file.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_model(file)
    (problem,) = caught.value.problems
    assert str(problem).startswith(str(file))
    assert sentence in str(problem)


def test_missing_files_and_directories_are_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        read_model(tmp_path / "nothing.toml")
    with pytest.raises(InputError, match="is a folder, not a file"):
        read_model(tmp_path)
    with pytest.raises(InputError, match=r"there is no such file|cannot be read"):
        read_model("a\0b.toml")


@pytest.mark.parametrize("name", ["oscillator", "duffing", "emps", "pendulum", "cartpole"])
def test_shipped_models_are_read_and_explain_themselves(name: str) -> None:
    model = read_model(MODELS / f"{name}.toml")
    assert model.title
    assert model.sensors
    assert all(parameter.about for parameter in model.parameters)
    assert model.text.startswith("# ")


def test_the_model_of_the_demonstration_conceals_what_takes_energy() -> None:
    model: Model = read_model(MODELS / "oscillator.toml")
    assert [element.kind for element in model.elements] == ["spring", "force"]
    assert model.elements[0].value("cubic") == parse_expression("c")
    assert model.coordinates[0].name == "q"
    assert {sensor.name: sensor.measures.tree for sensor in model.sensors} == {
        "position": Name("q"),
        "speed": Name("q", 1),
    }
    assert [channel.name for channel in model.inputs] == ["f"]

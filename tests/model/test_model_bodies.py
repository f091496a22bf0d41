"""Bodies hung on bodies, points on bodies, imposed motion: what comes out, and mistakes."""

from dataclasses import replace

import pytest

from symhyb.errors import InputError
from symhyb.model.diff import changes
from symhyb.model.expression import parse_expression
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.types import Body, Model, Point

ARM = """\
symhyb = 1
gravity = ["0", "-g"]
[coordinates]
alpha = { unit = "rad" }
beta = { unit = "deg" }
r = { unit = "mm" }
[parameters]
m = { value = 2, unit = "kg" }
J = { value = 0.1, unit = "kg*m^2" }
l = { value = 300, unit = "mm" }
g = { value = 9.81, unit = "m/s^2" }
[points]
post = ["0", "l"]
elbow = { body = "upper", at = ["l", "0"], about = "where the lower arm turns" }
middle = { body = "lower", at = ["l/2", "0"] }
hand = { body = "lower", at = ["l", "0"] }
[bodies.upper]
joint = "post"
mass = "m"
at = ["l/2", "0"]
inertia = "J"
angle = "alpha"
[bodies.lower]
parent = "upper"
joint = "elbow"
mass = "m"
at = "middle"
inertia = "J"
angle = "beta"
[bodies.slider]
parent = "lower"
joint = ["r", "0"]
mass = "m"
[bodies.load]
mass = "m"
at = "hand"
"""


def pair(first: str, second: str) -> tuple[object, object]:
    return parse_expression(first), parse_expression(second)


def body(model: Model, name: str) -> Body:
    return next(body for body in model.bodies if body.name == name)


def problems(text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_model(text, "file")
    return [str(problem) for problem in caught.value.problems]


def arm_with(old: str, new: str) -> str:
    assert old in ARM
    return ARM.replace(old, new, 1)


def test_a_chain_of_bodies_comes_out_with_joints_and_axes() -> None:
    model = parse_model(ARM)
    upper, lower = body(model, "upper"), body(model, "lower")
    assert (upper.parent, upper.joint, upper.at) == ("", pair("0", "l"), pair("l/2", "0"))
    assert (lower.parent, lower.joint) == ("upper", pair("l", "0"))
    assert lower.at == pair("l/2", "0")
    assert lower.angle == parse_expression("beta")
    assert model.energy_unit.text == "J"
    assert model.points[1] == Point("elbow", pair("l", "0"), "upper", "where the lower arm turns")


def test_a_point_mass_rides_in_the_axes_of_its_parent() -> None:
    slider = body(parse_model(ARM), "slider")
    assert (slider.parent, slider.joint) == ("lower", pair("r", "0"))
    assert (slider.at, slider.inertia, slider.angle) == (pair("0", "0"), None, None)


def test_a_point_of_a_body_carries_a_point_mass() -> None:
    load = body(parse_model(ARM), "load")
    assert (load.parent, load.joint, load.at) == ("lower", pair("l", "0"), pair("0", "0"))


def test_a_parent_alone_means_its_origin() -> None:
    text = ARM + '[bodies.disc]\nparent = "upper"\nmass = "m"\ninertia = "J"\n'
    disc = body(parse_model(text), "disc")
    assert (disc.joint, disc.at, disc.angle) == (pair("0", "0"), pair("0", "0"), None)


def test_a_hung_point_mass_may_turn() -> None:
    text = ARM + '[bodies.bob]\njoint = ["0", "0"]\nmass = "m"\nangle = "alpha"\nat = ["l", "0"]\n'
    bob = body(parse_model(text), "bob")
    assert (bob.parent, bob.inertia) == ("", None)
    assert bob.angle == parse_expression("alpha")


def test_a_chain_is_rendered_and_compared() -> None:
    model = parse_model(ARM)
    bare = replace(model, text="")
    assert replace(parse_model(render(bare)), text="") == bare
    assert 'elbow  = { body = "upper", at = ["l", "0"], about' in render(bare)
    shifted = parse_model(
        arm_with('joint = ["r", "0"]', 'joint = ["2*r", "0"]')
        .replace('joint = "post"', 'joint = ["0", "2*l"]')
        .replace('hand = { body = "lower"', 'hand = { body = "upper"')
    )
    assert changes(model, shifted) == (
        "~ point hand: body lower -> upper",
        "~ body upper: joint (0, l) -> (0, 2*l)",
        "~ body slider: joint (r, 0) -> (2*r, 0)",
        "~ body load: parent lower -> upper",
    )


ONE_FAULT = {
    "parent unknown": (
        'parent = "upper"\njoint = "elbow"',
        'parent = "uper"\njoint = ["l", "0"]',
        "bodies.lower.parent: 'uper' is not a known body; did you mean 'upper'",
    ),
    "parent number": ('parent = "lower"', "parent = 1", "must be text in quotes"),
    "itself": (
        'parent = "lower"\n',
        'parent = "slider"\n',
        "bodies.slider.parent: hangs on itself; a chain of bodies must begin",
    ),
    "circle": (
        'joint = "post"\n',
        'parent = "slider"\n',
        "hangs on itself: upper -> slider -> lower -> upper; a chain",
    ),
    "joint unknown": (
        'joint = "elbow"',
        'joint = "elbw"',
        "bodies.lower.joint: 'elbw' is not a known point; did you mean 'elbow'",
    ),
    "joint of the child": (
        'joint = "elbow"',
        'joint = "middle"',
        "'middle' is fixed to this body itself; a joint is a point of what",
    ),
    "joint elsewhere": (
        'joint = ["r", "0"]',
        'joint = "elbow"',
        "'elbow' is fixed to the body 'upper', not to 'lower'; write parent =",
    ),
    "joint on ground": (
        'joint = "elbow"',
        'joint = "post"',
        "'post' is not fixed to 'upper'; leave 'parent' out, or declare",
    ),
    "joint without parent": ('parent = "upper"\n', "", 'not to the ground; write parent = "upper"'),
    "joint list": ('joint = ["r", "0"]', 'joint = ["r"]', "a list of two expressions"),
    "joint speed": (
        'joint = ["r", "0"]',
        'joint = ["r\'", "0"]',
        "bodies.slider.joint: r' is a speed, on which a position cannot depend",
    ),
    "joint rough": ('joint = ["r", "0"]', 'joint = ["abs(r)", "0"]', "no smooth speed"),
    "joint unit": (
        'joint = ["r", "0"]',
        'joint = ["alpha", "0"]',
        "bodies.slider.joint: is in rad; what is fixed to a body needs lengths",
    ),
    "own axes unit": ('at = ["l/2", "0"]', 'at = ["m", "0"]', "is in kg; what is fixed to a body"),
    "own axes point": (
        'at = "middle"',
        'at = "elbow"',
        "'elbow' is fixed to the body 'upper'; the centre of a body that hangs",
    ),
    "own axes ground": ('at = "middle"', 'at = "post"', "'post' is fixed to the ground; the"),
    "angle unit": ('angle = "beta"', 'angle = "r"', "'r' is mm, needs 1"),
    "mass unit": (
        'joint = ["r", "0"]\nmass = "m"',
        'joint = ["r", "0"]\nmass = "J"',
        "bodies.slider.mass: 'J' is kg*m^2, needs kg",
    ),
    "inertia alone": (
        'inertia = "J"\nangle = "alpha"',
        'inertia = "J"',
        "has 'inertia' but no 'angle'",
    ),
    "point body": (
        'hand = { body = "lower"',
        'hand = { body = "lowr"',
        "points.hand.body: 'lowr' is not a known body; did you mean 'lower'",
    ),
    "point body number": (
        'hand = { body = "lower"',
        "hand = { body = 1",
        "points.hand.body: must be text in quotes",
    ),
    "point unit": ('at = ["l", "0"] }', 'at = ["m", "0"] }', "is in kg; what is fixed to a body"),
    "point key": ('hand = { body = "lower", at', 'hand = { bdy = "lower", at', "did you mean"),
    "point nowhere": (', at = ["l", "0"] }', " }", "'at' is missing"),
    "point number": ('post = ["0", "l"]', "post = 3", "a table with 'body' and 'at', not the"),
    "turning on a point": (
        'at = "hand"',
        'at = "hand"\ninertia = "J"\nangle = "beta"',
        'write parent = "lower" and joint = "hand" instead',
    ),
    "on its own point": (
        'hand = { body = "lower"',
        'hand = { body = "load"',
        "its place follows from this body, not the reverse",
    ),
}


@pytest.mark.parametrize(("old", "new", "sentence"), ONE_FAULT.values(), ids=ONE_FAULT)
def test_one_fault_is_one_problem(old: str, new: str, sentence: str) -> None:
    (problem,) = problems(arm_with(old, new))
    assert sentence in problem


def test_two_circles_are_two_problems() -> None:
    text = ARM + '[bodies.a]\nparent = "a"\nmass = "m"\n[bodies.b]\nparent = "c"\nmass = "m"\n'
    text += '[bodies.c]\nparent = "b"\nmass = "m"\n[bodies.d]\nparent = "c"\nmass = "m"\n'
    assert [problem.split(": ", 1)[1] for problem in problems(text)] == [
        "bodies.a.parent: hangs on itself; a chain of bodies must begin at the ground",
        "bodies.b.parent: hangs on itself: b -> c -> b; a chain of bodies must begin at the ground",
    ]


def test_volts_cannot_carry_a_body() -> None:
    text = """\
symhyb = 1
[coordinates]
y = { unit = "V" }
[parameters]
c = { value = 1, unit = "s^2" }
m = { value = 1, unit = "kg" }
[bodies.circuit]
mass = "c"
at = ["y", "0"]
[bodies.bob]
parent = "circuit"
mass = "m"
"""
    assert any(
        "the body 'circuit' is in V; what it carries needs lengths" in problem
        for problem in problems(text)
    )


RIG = """\
symhyb = 1
[coordinates]
x = { unit = "mm", imposed = true, start = 2.0 }
[parameters]
d = { value = 3, unit = "N*s/m" }
[elements.damper]
kind = "damper"
on = "x"
damping = "d"
[sensors]
cell = { measures = "reaction(x)", unit = "N" }
"""


def test_a_rig_with_imposed_motion_needs_no_mass() -> None:
    model = parse_model(RIG)
    (x,) = model.coordinates
    assert (x.imposed, x.start) == (True, 2.0)
    assert model.energy_unit.text == "J"
    bare = replace(model, text="")
    assert replace(parse_model(render(bare)), text="") == bare


def test_a_free_coordinate_needs_a_mass() -> None:
    free = RIG.replace("imposed = true", "imposed = false").replace("reaction(x)", "force(damper)")
    (problem,) = problems(free)
    assert "nothing has a mass" in problem
    added = '[elements.water]\nkind = "added_mass"\non = "x"\nmass = 2.0e0\n'
    assert "'2.0' is 1, needs kg" in problems(free + added)[0]
    held = free.replace("[elements", 'm = { value = 1, unit = "kg" }\n[elements', 1)
    text = held + added.replace("2.0e0", '"m"')
    assert not parse_model(text).coordinates[0].imposed


def test_imposed_motion_is_compared() -> None:
    free = RIG.replace("imposed = true, ", "") + '[energy]\nkinetic = "d*x*x\'"\n'
    both = free.replace("reaction(x)", "d*x'")
    imposed = both.replace('"mm"', '"mm", imposed = true')
    assert changes(parse_model(both), parse_model(imposed)) == (
        "~ coordinate x: imposed unset -> true",
    )


def test_an_imposed_voltage_needs_an_energy() -> None:
    text = RIG.replace('"mm"', '"V"').replace("N*s/m", "s").replace('unit = "N"', 'unit = "V"')
    (problem,) = problems(text)
    assert "the unit of energy cannot be told" in problem
    stated = '[energy]\npotential = "x**2/2"\n'
    assert parse_model(text + stated).energy_unit.text == "V^2"


def test_a_frame_and_a_rotor_may_have_no_mass() -> None:
    """A body that hangs may have the mass 0 if others hang on it or it has inertia."""
    upper, lower, slider = (f"[bodies.{name}]\n" for name in ("upper", "lower", "slider"))

    def without(head: str, text: str = ARM) -> str:
        before, after = text.split(head)
        return before + head + after.replace('mass = "m"', 'mass = "0"', 1)

    assert body(parse_model(without(upper)), "upper").mass.text == "0"
    frame = without(upper).replace('at = ["l/2", "0"]\ninertia = "J"\n', "", 1)
    assert body(parse_model(frame), "upper").inertia is None
    assert parse_model(without(lower))
    with pytest.raises(InputError, match=r"bodies\.slider\.mass: is 0; it must be positive"):
        parse_model(without(slider))
    with pytest.raises(InputError, match=r"bodies\.load\.mass: is 0; it must be positive"):
        parse_model(without("[bodies.load]\n"))

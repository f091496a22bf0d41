"""Numbers become parameters, right angles stay as they are, and names are met once."""

from math import pi

import pytest
from robots import joint, link, robot

from symhyb.imports.draft import Draft, Names, drafted, unit_of
from symhyb.imports.reduction import reduced
from symhyb.imports.urdf import parse_urdf


@pytest.fixture
def draft() -> Draft:
    return Draft(Names({}, {}))


def test_a_number_is_a_parameter_and_nothing_is_0(draft: Draft) -> None:
    assert draft.number("m", 2.0, "kg", "mass") == "m"
    assert draft.number("x", 0.0, "m", "nowhere") == "0"
    ((name, value, unit, about),) = (
        (p.name, p.value, p.unit.text, p.about) for p in draft.parameters
    )
    assert (name, value, unit, about) == ("m", 2.0, "kg", "mass")


@pytest.mark.parametrize(
    ("angle", "text"),
    [
        (0.0, "0"),
        (pi / 2, "pi/2"),
        (-1.57079632679, "-pi/2"),
        (pi, "pi"),
        (-pi, "pi"),
        (1.5 * pi, "-pi/2"),
        (-1.5 * pi, "pi/2"),
        (4 * pi, "0"),
        (1.5708, "a"),
    ],
)
def test_right_angles_are_written_as_they_are(draft: Draft, angle: float, text: str) -> None:
    assert draft.angle("a", angle, "an angle") == text
    assert len(draft.parameters) == (text == "a")


def test_names_of_joints_and_links_and_units() -> None:
    text = robot(
        *(link(name) for name in ("arm", "t", "c d")),
        joint("arm", "revolute", "arm", "t"),
        joint("c-d", "prismatic", "t", "c d"),
    )
    bodies = reduced(parse_urdf(text.encode())).bodies
    found = drafted(bodies)
    assert dict(found.names.joints) == {"arm": "arm", "c-d": "c_d"}
    assert dict(found.names.links) == {"t": "link_t", "c d": "c_d"}
    assert dict(found.units) == {"arm": "rad", "c-d": "m"}
    assert [unit_of(body) for body in bodies] == ["rad", "m"]
    assert list(found.names.changed) == [
        ("joint", "c-d", "c_d"),
        ("link", "t", "link_t"),
        ("link", "c d", "c_d"),
    ]

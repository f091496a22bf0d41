"""What comments say of joints, and which notes belong to a model."""

from robots import joint, link, robot

from symhyb.imports.declare import declare
from symhyb.imports.narrate import comments, notes
from symhyb.imports.reduction import Wish, reduced
from symhyb.imports.urdf import parse_urdf

IMPOSSIBLE = (1.0, 0.0, 0.0, 1.0, 0.0, 3.0)
TEXT = robot(
    link("a", tensor=IMPOSSIBLE),
    *(link(name) for name in "bcde"),
    joint("lead", "revolute", "a", "b", axis=(0, 0, -1)),
    joint("slide", "prismatic", "b", "c", axis=(0, 1, 0)),
    joint("plate", "planar", "a", "d"),
    joint("back", "continuous", "c", "e", more='<mimic joint="lead" multiplier="-2" offset="1"/>'),
)


def head(wish: Wish | None = None) -> list[str]:
    read = parse_urdf(TEXT.encode())
    found = reduced(read, wish)
    return list(comments(read, found, declare(read, found))[""])


def test_each_joint_is_a_line_of_the_tree() -> None:
    assert head()[:8] == [
        "robot, from a URDF with 5 links: 5 coordinates",
        "",
        "ground: a",
        "`- lead, revolute about -z: b",
        "   `- slide, prismatic along y: c",
        "      `- back, continuous about z, -2*lead + 1: e",
        "`- plate, planar across z: d",
        "",
    ]


def test_a_free_root_is_the_first_body() -> None:
    found = head(Wish(("slide",), free=True))
    assert found[2:5] == ["ground", "`- a, floating: a", "   `- slide, prismatic along y: c"]
    assert any(line.startswith("Locked: lead at 0, back at 1.") for line in found)


def test_repairs_of_what_stands_on_the_ground_are_not_told() -> None:
    read = parse_urdf(TEXT.encode())
    for wish, count in ((Wish(), 0), (Wish(free=True), 1)):
        found = reduced(read, wish)
        assert len(notes(read, found, declare(read, found))) == count

"""Places of XML elements in a text, and small changes of it."""

import pytest

from symhyb.export.robot.spans import (
    changed,
    comment,
    end_of_tag,
    first_inside,
    last_inside,
    spans_of,
    with_attributes,
)

TEXT = """<a>
  <!-- ß → > --> <b x='1>0' y = "2"><c/></b>\r
\t<b/>
</a>"""


def test_spans_are_where_the_elements_stand() -> None:
    root = spans_of(TEXT)
    first, second = root.every("b")
    assert TEXT[first.begin : first.inside] == "<b x='1>0' y = \"2\">"
    assert TEXT[first.inside : first.end] == "<c/>"
    assert TEXT[second.begin : second.inside] == "<b/>"
    assert second.inside == second.end
    assert TEXT[root.inside :].endswith("</a>")
    assert TEXT[root.end :] == "</a>"
    assert first.first("c") is not None
    assert first.first("d") is None


def test_attributes_change_in_place_or_come_last() -> None:
    first, second = spans_of(TEXT).every("b")
    changes = [
        with_attributes(TEXT, first, {"x": "5", "z": "6"}),
        with_attributes(TEXT, second, {"x": "7"}),
    ]
    done = changed(TEXT, changes)
    assert '<b x="5" y = "2" z="6"><c/></b>' in done
    assert '<b x="7"/>' in done
    assert spans_of(done).every("b")[0].attributes == {"x": "5", "y": "2", "z": "6"}


def test_attributes_can_go() -> None:
    first, _ = spans_of(TEXT).every("b")
    assert '<b y = "2"><c/></b>' in changed(TEXT, [with_attributes(TEXT, first, {}, ["x", "z"])])


def test_lines_come_into_an_element_at_its_begin_or_end() -> None:
    text = "<a>\n  <b>\n    <c/>\n  </b>\n  <d />\n</a>"
    _, (b,), (d,) = (spans_of(text).every(tag) for tag in "abd")
    done = changed(text, [*first_inside(text, b, ["<x/>"]), *last_inside(text, b, ["<y/>"])])
    assert "<b>\n    <x/>\n    <c/>\n    <y/>\n  </b>" in done
    assert "  <d>\n    <x/>\n  </d>\n" in changed(text, first_inside(text, d, ["<x/>"]))
    assert last_inside(text, d, []) == []


def test_a_tag_that_never_ends_ends_with_the_text() -> None:
    assert end_of_tag('<b x="', 0) == 6


@pytest.mark.parametrize("text", ["a -- b", "---", "ends with -", "line\nbreak\x1b"])
def test_a_comment_is_well_formed(text: str) -> None:
    assert spans_of(f"<a>{comment(text)}</a>").tag == "a"
    assert "\n" not in comment(text)

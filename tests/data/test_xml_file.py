"""XML is read as plain values with lines; what could hurt is refused by a sentence."""

import sys

import pytest

from symhyb.data.files.xml_file import parse_xml
from symhyb.errors import InputError
from symhyb.limits import XML_DEEP


def refusal(text: str | bytes) -> str:
    with pytest.raises(InputError) as error:
        parse_xml(text.encode() if isinstance(text, str) else text, "robot.urdf")
    assert len(error.value.problems) == 1
    return str(error.value)


def test_elements_have_attributes_children_text_and_lines() -> None:
    root = parse_xml(b'<a x="1">\n<b y="2"/>\n <b> text </b><c/></a>', "f")
    assert (root.tag, dict(root.attributes), root.line) == ("a", {"x": "1"}, 1)
    assert [(child.tag, child.line) for child in root.children] == [("b", 2), ("b", 3), ("c", 3)]
    assert [child.text for child in root.all("b")] == ["", "text"]
    assert root.first("c") is root.children[2]
    assert root.first("d") is None


def test_ignored_elements_are_left_out_with_all_that_is_in_them() -> None:
    root = parse_xml(b"<a><mesh><b/>text</mesh><b/></a>", "f", frozenset({"mesh"}))
    assert [child.tag for child in root.children] == ["b"]
    assert root.text == ""
    assert parse_xml(b"<mesh/>", "f", frozenset({"mesh"})).tag == "mesh"


BOMB = '<!DOCTYPE a [<!ENTITY x "ha"><!ENTITY y "&x;&x;&x;">]>\n<a>&y;</a>'
OUTSIDE = '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>\n<a>&x;</a>'
ELSEWHERE = '<!DOCTYPE a SYSTEM "http://127.0.0.1:1/a.dtd">\n<a/>'


@pytest.mark.parametrize("text", [BOMB, OUTSIDE, ELSEWHERE])
def test_document_types_and_entities_are_refused(text: str) -> None:
    assert "declares a document type or entities" in refusal(text)
    assert refusal(text).startswith("robot.urdf:1: ")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<a>\n<b>\n</a>", "robot.urdf:3: is not well-formed XML: mismatched tag"),
        ("<a>&x;</a>", "is not well-formed XML: undefined entity"),
        ("", "is not well-formed XML: no element found"),
        ("no XML", "robot.urdf:1: is not well-formed XML"),
        (b"\xff\xfe\x00", "XML"),
        (b'<?xml version="1.0" encoding="martian"?><a/>', "XML: unknown encoding"),
        (b"<a>\x00</a>", "is not well-formed XML"),
    ],
)
def test_what_is_no_xml_is_said_with_its_line(text: str | bytes, said: str) -> None:
    assert said in refusal(text)


@pytest.mark.parametrize("deep", [XML_DEEP + 1, 200_000])
def test_elements_lie_so_deep_and_no_deeper(deep: int) -> None:
    parse_xml(b"<a>" * XML_DEEP + b"</a>" * XML_DEEP, "f")
    assert f"more than {XML_DEEP} deep" in refusal("<a>" * deep)


def test_ignored_elements_lie_no_deeper_either() -> None:
    with pytest.raises(InputError, match="deep"):
        parse_xml(b"<m>" * 1000, "f", frozenset({"m"}))


def test_without_the_package_its_name_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "defusedxml.sax", None)
    assert 'pip install "symhyb[urdf]"' in refusal("<a/>")

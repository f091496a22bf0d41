"""Where names stand in a TOML text, against what tomllib reads."""

import tomllib

from symhyb.model.source import scan

AWKWARD = '''\
# a comment with [brackets] and "quotes"
top."in quotes" = 3 # not = a key
literal = 'a # {' # comment
multi = """a
[not.a.table]
"key" = \\""" end""""
list = [1, # c ]
  "]", { z = 1 }, [2],
]
[ table . inner ]
key = { a.b = 1, c = { d = "}" }, e = [1] }
[[many]]
when=1979-05-27 07:32:00 # date
raw = \'\'\'it's''\'\'\'
empty = ""
'''


def test_spans_hold_the_values_that_tomllib_reads() -> None:
    tomllib.loads(AWKWARD)
    source = scan(AWKWARD)
    spans = {path: AWKWARD[entry.start : entry.end] for path, entry in source.entries.items()}
    assert spans["top", "in quotes"] == "3"
    assert spans[("literal",)] == "'a # {'"
    assert spans[("multi",)].endswith('end""""')
    assert spans["table", "inner", "key", "a", "b"] == "1"
    assert spans["table", "inner", "key", "c", "d"] == '"}"'
    assert spans["many[1]", "when"] == "1979-05-27 07:32:00"
    assert spans["many[1]", "raw"].endswith("''" + "'''")
    assert spans["many[1]", "empty"] == '""'
    assert ("not", "a", "table") not in spans


def test_lines_count_from_one_and_fall_back_to_the_table_around() -> None:
    source = scan(AWKWARD)
    assert source.line("top", "in quotes") == 2
    assert source.line("list") == 7
    assert source.line("table", "inner", "key", "c") == 11
    assert source.line("table", "inner", "missing") == 10
    assert source.line("nowhere") == 0


def test_tables_of_arrays_are_numbered_within_each_other() -> None:
    lines = ["[[a]]", "k = 1", "[a.t]", "k = 2", "[[a.b]]", "[[a.b]]", "k = 3", "[[a]]", "[[a.b]]"]
    source = scan("\n".join([*lines, "k = 4", "[c]", "k = [{ x = 5 }]"]))
    assert source.line("a[1]", "k") == 2
    assert source.line("a[1]", "t", "k") == 4
    assert source.line("a[1]", "b[2]", "k") == 7
    assert source.line("a[2]", "b[1]", "k") == 10
    assert source.line("a[2]", "missing") == 8
    assert source.line("a[1]", "b[3]") == 1
    assert source.line("c", "k[1]", "x") == 12  # braces in an array have no names


def test_crlf_counts_as_one_line() -> None:
    assert scan("a = 1\r\nb = 2\r\n").line("b") == 2


def test_offsets_tell_the_last_part_of_a_dotted_key() -> None:
    text = "[t]\nk.value = 3\n"
    entry = scan(text).entries["t", "k", "value"]
    assert text[entry.key : entry.last] == "k."
    assert not entry.inline

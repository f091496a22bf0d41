"""The numbers that decide: few, each in one module with its source, and nowhere else.

Every constant of ``symhyb/judgement.py`` stands in the table of docs/method/numbers.md with the
words that stand beside it, and ``correction`` and ``discrepancy`` compare with nothing else where a
judgement stands. What else they compare with is listed here by its kind.
"""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "symhyb"
METHOD = ROOT / "docs" / "method"
MOST_CONSTANTS = 60
ROOMS = ("correction", "discrepancy")

# constants of other modules in comparisons, with what they are: limits of work, tolerances of the
# numerics, where a search begins and ends, and what is shown. None decides what is claimed.
OTHERS = {
    "correction/calibration.py": {"FAR": "iteration"},
    "correction/adequacy/classes/columns.py": {"FINEST": "numerics", "PUSHED": "numerics"},
    "correction/adequacy/recorded.py": {"SAMPLES_LEAST": "work"},
    "correction/adequacy/ways.py": {"SAMPLES_LEAST": "work"},
    "correction/adequacy/curves/fitted_curve.py": {"STANDS": "iteration"},
    "correction/adequacy/curves/product.py": {"STANDS": "iteration"},
    "correction/adequacy/named_mode.py": {"BEGINNINGS": "work"},
    "correction/adequacy/curves/points.py": {"POINTS_MOST": "work", "PATIENCE": "work"},
    "correction/adequacy/in_time/placing.py": {
        "POINTS_MOST": "work",
        "PATIENCE": "work",
        "SHORTEST": "numerics: of samples",
    },
    "correction/naming/course_words.py": {"SHORTEST": "display", "_SHORT": "display"},
    "correction/advice/advice.py": {"ODDS_SHOWN": "display"},
    "correction/learning/factor.py": {
        "CONDITION_MOST": "numerics",
        "CONSTANT": "numerics",
        "DEPENDENT": "numerics",
        "LOST": "numerics",
    },
    "correction/learning/library.py": {"DEGREE_MOST": "work", "COUPLED": "work"},
    "correction/learning/network.py": {"PATIENCE": "work", "FOLDS": "work"},
    "correction/learning/choosing.py": {"UNSEEN": "numerics"},
    "correction/learning/formulations.py": {"UNSEEN": "numerics"},
    "correction/learning/orthogonal.py": {"DEPENDENT": "numerics"},
    "discrepancy/fitting/normal.py": {"DEPENDENT": "numerics", "NARROW": "numerics"},
    "discrepancy/places/points.py": {"PARALLEL": "numerics"},
    "discrepancy/recorded/even.py": {"JITTER": "numerics", "LINEAR": "numerics"},
    "correction/naming/findings.py": {"SKEW": "bound of a key, which the laws state"},
    "correction/naming/textbook.py": {"_LINEAR": "numerics"},
    "correction/search/clocks.py": {"STANDS": "iteration"},
    "correction/search/decide.py": {"LARGEST": "work"},
    "correction/search/exchanges.py": {"TRIED": "work", "OUT": "work"},
    "correction/search/selection.py": {
        "CONDITION": "numerics",
        "TOGETHER": "work",
        "UNSEEN": "numerics",
    },
    "correction/search/wholes.py": {"LARGEST": "work"},
    "correction/search/branches.py": {"BRANCHES_MOST": "work", "APART": "where a search begins"},
    "correction/search/lines.py": {"NARROW": "bound of a key, which the laws state"},
    "correction/search/twins.py": {"PARALLEL": "numerics"},
    "correction/verdict/whole.py": {"SAMPLES_MOST": "work"},
    "discrepancy/checks/balance.py": {"STANDING": "numerics"},
    "discrepancy/checks/first_checks.py": {"SAMPLES_MOST": "work"},
    "discrepancy/checks/modes.py": {
        "FREE": "numerics",
        "BALANCED": "numerics",
        "ROUNDED": "numerics",
        "LENGTH": "numerics",
    },
    "discrepancy/checks/response.py": {"SEGMENTS": "how windows are laid"},
    "discrepancy/checks/suspicion.py": {"SAMPLES_MOST": "work"},
    "discrepancy/evidence.py": {"CONFIDENCE": "display"},
    "discrepancy/fitting/bands.py": {"SAMPLES_MOST": "work", "ELEMENTS_MOST": "work"},
    "discrepancy/fitting/initialised.py": {"LEAST": "what published scores ask for"},
    "discrepancy/fitting/matching.py": {
        "DAMPING_MOST": "iteration",
        "SETTLED": "iteration",
        "ROUNDS": "iteration",
    },
    "discrepancy/fitting/scores.py": {"RUN_SHARES": "where a fit begins", "WINDOWS_MOST": "work"},
    "discrepancy/fitting/squares.py": {"LANES": "work"},
    "discrepancy/likelihood/fit.py": {"FAR": "iteration"},
    "discrepancy/places/memoryless.py": {"CUBIC_MOST": "work", "CHOSEN": "work"},
    "discrepancy/places/stretches.py": {
        "MOST_COORDINATES": "work",
        "LEAST": "numerics",
        "PARALLEL": "numerics",
    },
    "discrepancy/recorded/knots.py": {"WORSE_MOST": "work", "LONG": "work"},
    "discrepancy/recorded/local.py": {"UNRESOLVED": "numerics: of differences"},
    "discrepancy/recorded/runs.py": {
        "WINDOWS_MOST": "work",
        "BEND_SHARE": "numerics",
        "COORDINATES_FEW": "work",
        "STEPS_MOST": "work",
        "WINDOWS_WORSE": "numerics",
    },
    "discrepancy/recorded/splines.py": {"SWING_MOST": "numerics: two samples a period"},
    "discrepancy/recorded/windows.py": {
        "GAP": "how windows are laid",
        "SAMPLES_LEAST": "how windows are laid",
        "SLOW_SHARE": "where steps are finer",
        "STILL": "where steps are finer",
        "EVEN": "numerics: of times",
        "SWUNG": "how windows are laid",
    },
    "discrepancy/words/amounts.py": {"_EXACT": "display", "_PLAIN_FROM": "display"},
    "discrepancy/words/occurrence_words.py": {"BURSTS_NAMED": "display"},
}

# numbers without a name in comparisons, beside 0, 1, 2 and what rounding leaves
NUMBERS = {
    ("correction/adequacy/channel_noise.py", 0.5): "½ ln N, the price of a number",
    ("correction/adequacy/clock_jitter.py", 0.5): "½ ln N, the price of a number",
    ("correction/learning/energy.py", 3): "a gap in time",
    ("correction/learning/library.py", 3): "derivatives of a sine of third order",
    ("discrepancy/checks/repeats.py", 0.5): "half a sample: the same times",
    ("discrepancy/checks/suspicion.py", 1.001): "the same factor, rounded",
    ("discrepancy/checks/suspicion.py", 6): "digits of a logarithm",
    ("discrepancy/fitting/matching.py", 1e-4): "iteration",
    ("discrepancy/fitting/scores.py", 0.45): "of the rate: what a filter can cut",
    ("discrepancy/likelihood/horizon.py", 0.5): "½ ln N, the price of a number",
    ("discrepancy/places/locate.py", 0.003): "display: the end of a drawn spectrum",
    ("discrepancy/places/locate.py", 0.99): "a quantile in place of a maximum",
    ("discrepancy/places/occurrence.py", 0.5): "half a sample: even times",
    ("discrepancy/places/occurrence.py", 1.5): "windows beside a moment",
    ("discrepancy/places/occurrence.py", 1e300): "numerics: in place of infinity",
    ("discrepancy/recorded/ends.py", 4): "ends are half of a motion",
    ("discrepancy/recorded/motion.py", 0.15): "free samples that a criterion asks for",
    ("discrepancy/recorded/motion.py", 4): "knots that a spline needs",
    ("discrepancy/recorded/windows.py", 0.05): "the tail of an autocorrelation",
    ("discrepancy/recorded/windows.py", 0.75): "a quantile",
    ("discrepancy/recorded/windows.py", 3): "every third window is held",
    ("discrepancy/recorded/windows.py", 7): "samples about a reversal",
    ("discrepancy/recorded/windows.py", 20): "room for what is cut off at the ends",
    ("discrepancy/words/amounts.py", 0.995): "display",
    ("discrepancy/words/amounts.py", 0.999): "display",
    ("discrepancy/words/amounts.py", 1e-4): "display",
    ("discrepancy/words/amounts.py", 1e-3): "display",
    ("discrepancy/words/amounts.py", 1e6): "display",
}


class Constant(NamedTuple):
    """A constant with the question it belongs to, its value as it is written, and its words."""

    question: str
    name: str
    value: str
    meaning: str
    source: str


@cache
def constants() -> tuple[Constant, ...]:
    """All of ``symhyb/judgement.py``, in its order."""
    text = (PACKAGE / "judgement.py").read_text(encoding="utf-8")
    found, question, meaning, source = [], "", "", ""
    for line in text.splitlines():
        if line.startswith("# source: "):
            source = line.removeprefix("# source: ")
        elif re.match("# [A-Z]", line):
            question = line.removeprefix("# ")
        elif line.startswith("# "):
            meaning = line.removeprefix("# ")
        elif match := re.fullmatch(r"([A-Z_]+) = (.+)", line):
            found.append(Constant(question, *match.groups(), meaning, source))
            meaning = source = ""
    return tuple(found)


def table() -> str:
    """The constants as docs/method/numbers.md shows them."""
    lines = ["| constant | value | meaning | source |", "|---|---|---|---|"]
    question = ""
    for one in constants():
        if one.question != question:
            question = one.question
            lines.append(f"| **{question}** | | | |")
        lines.append(f"| `{one.name}` | {one.value} | {one.meaning} | {one.source} |")
    return "\n".join(lines)


def judgements() -> frozenset[str]:
    return frozenset(one.name for one in constants())


def compared(module: str) -> Iterator[ast.expr]:
    """Every name and number in a comparison of a module."""
    tree = ast.parse((PACKAGE / module).read_text(encoding="utf-8"))
    for compare in ast.walk(tree):
        if isinstance(compare, ast.Compare):
            yield from (node for node in ast.walk(compare) if isinstance(node, ast.expr))


def numeric(value: object) -> bool:
    """Whether a constant, wherever it is defined, is a number or several."""
    many = isinstance(value, tuple | list)
    each = list(value) if many else [value]  # type: ignore[call-overload]
    return bool(each) and all(isinstance(v, int | float) and not isinstance(v, bool) for v in each)


def modules() -> list[str]:
    paths = (path for room in ROOMS for path in (PACKAGE / room).rglob("*.py"))
    return sorted(path.relative_to(PACKAGE).as_posix() for path in paths)


def test_each_has_a_meaning_and_a_source_and_they_are_few() -> None:
    assert 0 < len(constants()) <= MOST_CONSTANTS
    for one in constants():
        assert all(one), one
    tree = ast.parse((PACKAGE / "judgement.py").read_text(encoding="utf-8"))
    assert judgements() == {
        target.id
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    }


def test_the_table_of_the_method_is_the_module() -> None:
    page = METHOD / "numbers.md"
    assert table() in page.read_text(encoding="utf-8"), f"{page} should have\n{table()}"


def test_the_method_names_no_other_constant() -> None:
    text = "\n".join(page.read_text(encoding="utf-8") for page in METHOD.glob("*.md"))
    brackets = re.findall(r"\[([^\]]*`[^\]]*)\](?!\()", text)
    named = {name for group in brackets for name in re.findall(r"`([A-Z][A-Z_]+)`", group)}
    assert named <= judgements()


def test_each_decides_something() -> None:
    rest = "\n".join(
        path.read_text(encoding="utf-8")
        for path in PACKAGE.rglob("*.py")
        if path.name != "judgement.py"
    )
    assert [name for name in judgements() if not re.search(rf"\b{name}\b", rest)] == []


@pytest.mark.parametrize("module", modules())
def test_nothing_else_decides(module: str) -> None:
    from importlib import import_module

    loaded = import_module("symhyb." + module.removesuffix(".py").replace("/", "."))
    known = OTHERS.get(module, {})
    for node in compared(module):
        if isinstance(node, ast.Name) and re.fullmatch("_?[A-Z][A-Z_]{2,}", node.id):
            mine = node.id in judgements() or node.id in known
            assert mine or not numeric(getattr(loaded, node.id, None)), f"{module}: {node.id}"
        value = node.value if isinstance(node, ast.Constant) else None
        if isinstance(value, int | float) and abs(value) > 1e-6 and value not in (0, 1, 2):
            assert (module, value) in NUMBERS, f"{module}:{node.lineno}: {value}"


def test_the_list_of_others_is_no_longer_than_it_must_be() -> None:
    for module, names in OTHERS.items():
        used = {node.id for node in compared(module) if isinstance(node, ast.Name)}
        assert set(names) <= used, module
    for module, value in NUMBERS:
        found = {node.value for node in compared(module) if isinstance(node, ast.Constant)}
        assert value in found, (module, value)


def test_no_module_has_a_constant_of_the_same_name() -> None:
    for module in modules():
        for node in ast.parse((PACKAGE / module).read_text(encoding="utf-8")).body:
            if isinstance(node, ast.Assign):
                names = {n.id for n in ast.walk(node.targets[0]) if isinstance(n, ast.Name)}
                assert not names & judgements(), module

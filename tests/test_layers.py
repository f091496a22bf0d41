"""The shape of the package: layers, libraries in their rooms, nothing that runs a file as code.

The contracts of ``pyproject.toml`` say which layer and which library may be seen from where; the
rest of this file says what they cannot.
"""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest
from parsed import ROOT, sources

RUNS_CODE = frozenset({"eval", "exec", "compile", "__import__", "sympify", "parse_expr"})
LOADS_CODE = frozenset({"pickle", "dill", "cloudpickle", "shelve", "marshal", "joblib.load"})
FROM_SYMHYB = re.compile(r"^[ \t]*from symhyb[\w.]* import (?:\([^)]*\)|[^(\n]+)", re.M)


@cache
def imported(tree: ast.AST) -> tuple[str, ...]:
    """Dotted names of all imports, at the top of a file or inside a function."""
    found: list[str] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            found += (f"{node.module}.{alias.name}" for alias in node.names)
    return tuple(found)


def imports(tree: ast.AST, library: str) -> bool:
    return any(f"{name}.".startswith(f"{library}.") for name in imported(tree))


def files_importing(library: str) -> set[str]:
    return {file for file, tree in sources().items() if imports(tree, library)}


def unsafe(tree: ast.AST) -> Iterator[str]:
    """What turns text or bytes of a file into running code, each with its line."""
    yield from (f"import of {library}" for library in sorted(LOADS_CODE) if imports(tree, library))
    yield from (name for name in imported(tree) if name.split(".")[-1] in RUNS_CODE - {"compile"})
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name) if name in RUNS_CODE:
                yield f"line {node.lineno}: {name}"
            case ast.Attribute(attr=name) if name in RUNS_CODE - {"compile"}:
                yield f"line {node.lineno}: {name}"  # not re.compile, which compiles patterns
            case ast.keyword(arg="allow_pickle", value=ast.Constant(value=True)):
                yield f"line {node.lineno}: allow_pickle=True"


def test_contracts_of_the_import_linter_hold() -> None:
    lint_imports = Path(sys.executable).with_name("lint-imports")
    done = subprocess.run(
        [lint_imports, "--no-logo", "--no-cache"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_exactly_one_file_sees_both_sympy_and_casadi() -> None:
    assert files_importing("sympy") & files_importing("casadi") == {
        "symhyb/numeric/lowered/translate.py"
    }


def test_neural_networks_stay_in_their_room() -> None:
    assert files_importing("sklearn.neural_network") <= {"symhyb/correction/learning/network.py"}


def test_every_name_that_scripts_tests_and_pages_import_is_there() -> None:
    """A script that no test runs would break unseen when something is renamed."""
    texts = [
        (file, file.read_text(encoding="utf-8"))
        for file in (*ROOT.glob("studies/**/*.py"), *ROOT.glob("tests/**/*.py"))
    ]
    for page in [ROOT / "README.md", *ROOT.glob("docs/**/*.md"), *ROOT.glob("studies/**/*.md")]:
        code = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
        texts += [(page, text) for text in code]
    named = {
        (str(module), alias.name): file.relative_to(ROOT)
        for file, text in texts
        for module, alias in from_symhyb(text)
    }
    missing = [
        f"{file}: {module}.{name}"
        for (module, name), file in named.items()
        if not hasattr(import_module(module), name) and find_spec(f"{module}.{name}") is None
    ]
    assert len(named) > 100
    assert missing == []


def from_symhyb(text: str) -> Iterator[tuple[str, ast.alias]]:
    """Modules of the package with the names that a text imports from them."""
    for statement in FROM_SYMHYB.findall(text):
        (node,) = ast.parse(statement.strip()).body
        assert isinstance(node, ast.ImportFrom)
        yield from ((str(node.module), alias) for alias in node.names)


def test_no_file_runs_text_or_bytes_as_code() -> None:
    found = {file: list(unsafe(tree)) for file, tree in sources().items()}
    assert {file: lines for file, lines in found.items() if lines} == {}


@pytest.mark.parametrize(
    "text",
    [
        "eval('1')",
        "f = exec",
        "sp.sympify(x)",
        "from sympy.parsing.sympy_parser import parse_expr as p\np(x)",
        "import pickle",
        "def f():\n    from pickle import loads",
        "from joblib import load",
        "np.load(x, allow_pickle=True)",
        "builtins.eval(x)",
    ],
)
def test_unsafe_code_would_be_seen(text: str) -> None:
    assert list(unsafe(ast.parse(text)))


@pytest.mark.parametrize(
    "text", ["re.compile('a')", "casadi.Function('f', [x], [y])", "np.load(x, allow_pickle=False)"]
)
def test_safe_code_is_let_through(text: str) -> None:
    assert not list(unsafe(ast.parse(text)))

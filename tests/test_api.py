"""What every public name owes its reader: a docstring, and for arrays their shape and unit.

Also that ``import symhyb`` and ``symhyb --help`` answer at once, without the heavy libraries.
"""

import ast
import importlib
import inspect
import pkgutil
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import symhyb

HEAVY = ("sympy", "casadi", "pysindy", "sklearn", "matplotlib", "scipy", "pandas", "xarray")
MOST_NAMES = 33

# A shape is letters and numbers in parentheses, (n), (N,), (m, 2n), (N-1, 3), or said in words.
LETTER = r"\d*Σ?[A-Za-z]"
ENTRY = rf"(?:{LETTER}|\d+)(?: ?[-−+·*] ?(?:{LETTER}|\d+))?"
SHAPE = re.compile(rf"\({ENTRY}(?:, ?(?:{ENTRY}|\w+|…))*,?\)|\bshapes?\b")
UNIT = re.compile(
    r"\bSI\b|\bunits?\b|\bdimensionless\b|\[[^\]]+\]"
    r"|(?<=[ ,])(?:s|m|N|rad|Hz|J|N·m|m/s|m/s²|rad/s|1/s)(?=[.,;:)\s]|$)"
)


@cache
def modules() -> tuple[ModuleType, ...]:
    """Every module of the package."""
    names = sorted(info.name for info in pkgutil.walk_packages(symhyb.__path__, "symhyb."))
    return (symhyb, *(importlib.import_module(name) for name in names))


def public() -> Iterator[tuple[str, Any, str]]:
    """Public functions, classes and methods where they are defined: name, object, docstring of
    the class that a method belongs to."""
    for module in modules():
        for name, thing in vars(module).items():
            defined_here = getattr(thing, "__module__", None) == module.__name__
            if name.startswith("_") or not defined_here or not callable(thing):
                continue
            path = f"{module.__name__}.{name}"
            if inspect.isclass(thing):
                yield path, thing, ""
                for own, method in methods(thing):
                    yield f"{path}.{own}", method, docstring(thing)
            elif inspect.isfunction(inspect.unwrap(thing)):
                yield path, inspect.unwrap(thing), ""


def methods(cls: type) -> Iterator[tuple[str, Any]]:
    for name, thing in vars(cls).items():
        function = thing.fget if isinstance(thing, property) else getattr(thing, "__func__", thing)
        if not name.startswith("_") and inspect.isfunction(function):
            yield name, function


def docstring(thing: Any) -> str:
    """The docstring that the source states; the one that dataclasses make up does not count."""
    doc = inspect.cleandoc(thing.__doc__ or "")
    return "" if doc.startswith(f"{thing.__name__}(") else doc


def arrays(thing: Any) -> list[str]:
    """The annotations that are arrays: of parameters and result, or of fields."""
    stated = (repr(annotation) for annotation in inspect.get_annotations(thing).values())
    return [text for text in stated if re.search(r"ndarray|NDArray", text)]


def loaded_after(code: str) -> set[str]:
    """The heavy libraries that a fresh interpreter has loaded after running ``code``."""
    report = f"import sys; print('\\nloaded', *(set({HEAVY!r}) & sys.modules.keys()))"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{report}"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return set(done.stdout.splitlines()[-1].split()[1:])


def test_every_public_name_has_a_docstring() -> None:
    lacking = [name for name, thing, _ in public() if not docstring(thing)]
    assert not lacking, "\n".join(lacking)


def test_every_module_says_what_it_is_for() -> None:
    assert [module.__name__ for module in modules() if not module.__doc__] == []


def test_arrays_come_with_shape_and_unit() -> None:
    """Flags and indices are plain numbers; what holds floating-point numbers has a unit."""
    lacking = []
    for name, thing, context in public():
        said = f"{docstring(thing)}\n{context}"
        if arrays(thing) and not SHAPE.search(said):
            lacking.append(f"{name} states no shape")
        elif "float64" in "".join(arrays(thing)) and not UNIT.search(SHAPE.sub("", said)):
            lacking.append(f"{name} states no unit")
    assert not lacking, "\n".join(lacking)


@pytest.mark.parametrize(
    "text", ["(N,)", "(n)", "(N, n)", "(m, 2n)", "(N − 1, 3)", "(N, places)", "shape as t"]
)
def test_shapes_are_recognised(text: str) -> None:
    assert SHAPE.search(f"Positions {text} in SI.")


@pytest.mark.parametrize("text", ["coherent SI", "(N,) s, increasing", "[rad/s]", "dimensionless"])
def test_units_are_recognised(text: str) -> None:
    assert UNIT.search(text)


@pytest.mark.parametrize("text", ["Fit (see above) to data.", "Give the window (or none)."])
def test_parentheses_are_not_shapes(text: str) -> None:
    assert not SHAPE.search(text)


def test_exported_names_exist_and_are_few() -> None:
    assert len(symhyb.__all__) <= MOST_NAMES
    assert set(symhyb.__all__) <= set(dir(symhyb))
    assert [name for name in symhyb.__all__ if getattr(symhyb, name, None) is None] == []


def test_a_name_that_is_not_exported_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = symhyb.no_such_name


def test_type_checkers_are_told_of_the_same_names_from_the_same_places() -> None:
    """``__init__.pyi`` says what ``__init__`` imports when it is first used."""
    folder = Path(symhyb.__file__).parent
    tree = ast.parse((folder / "__init__.pyi").read_text(encoding="utf-8"))
    said = {
        alias.name: node.module
        for node in tree.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.name == alias.asname
    }
    assert said == symhyb._HOME
    (listed,) = (
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__"
    )
    assert ast.literal_eval(listed) == list(symhyb.__all__)
    assert (folder / "py.typed").is_file()


def test_importing_symhyb_loads_nothing_heavy() -> None:
    assert loaded_after("import symhyb") == set()


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys\n"
        "from symhyb.cli.app import main\n"
        "sys.argv = ['symhyb', '--help']\n"
        "try:\n    main()\nexcept SystemExit as stop:\n    assert not stop.code, stop.code"
    )
    assert loaded_after(code) == set()

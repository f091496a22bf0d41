"""The package as syntax trees, parsed once for all tests that look at its text."""

import ast
import gc
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parent.parent


@cache
def sources() -> dict[str, ast.Module]:
    """Every file of the package by its path inside the repository."""
    gc.disable()  # trees are large and kept: collections while they grow take most of the time
    try:
        return {
            file.relative_to(ROOT).as_posix(): ast.parse(file.read_text(encoding="utf-8"))
            for file in sorted(ROOT.glob("symhyb/**/*.py"))
        }
    finally:
        gc.enable()
        gc.freeze()

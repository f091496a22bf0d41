"""Readers of other projects that not everybody needs: imported when a file asks for them."""

from importlib import import_module
from typing import Any

from symhyb.data.files.table import refusal


def needed(module: str, extra: str, file: str) -> Any:
    """Import ``module``, which the optional dependencies ``extra`` bring.

    Raises:
        InputError: it is not installed, or cannot be loaded.
    """
    try:
        return import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        missing = isinstance(error, ModuleNotFoundError) and error.name == package
        why = "which is not installed" if missing else f"which cannot be loaded ({error})"
        cure = f'pip install "symhyb[{extra}]"'
        raise refusal(file, f"needs the package {package}, {why}; run: {cure}") from error


def first_line(said: object) -> str:
    """The first line of what a reader said, as an error or as text; empty where it said nothing."""
    return (str(said).splitlines() or [""])[0]

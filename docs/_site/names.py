"""Reference of public names: which stand on which page, and the text that autodoc fills."""

import importlib
import inspect
from collections.abc import Iterator, Sequence
from typing import Any

import symhyb


def home(name: str) -> str:
    """The module in which a name of ``symhyb.__all__`` is defined."""
    return str(getattr(symhyb, name).__module__)


def within(module: str, room: str) -> bool:
    """Whether a module is a room, or in it."""
    return module == room or module.startswith(f"{room}.")


def exported(rooms: Sequence[str]) -> list[str]:
    """The names of ``symhyb.__all__`` with their home in one of the rooms: functions, then
    classes, each in the order of the alphabet."""
    names = [name for name in symhyb.__all__ if any(within(home(name), room) for room in rooms)]
    return sorted(names, key=lambda name: (inspect.isclass(getattr(symhyb, name)), name))


def defined(module: str) -> Iterator[tuple[str, Any]]:
    """The public functions and classes that a module defines, in the order of its text, without
    those that ``symhyb`` exports."""
    known = {id(getattr(symhyb, name)) for name in symhyb.__all__}
    for name, thing in vars(importlib.import_module(module)).items():
        own = getattr(thing, "__module__", None) == module
        if own and callable(thing) and not name.startswith("_") and id(thing) not in known:
            yield name, thing


def names_text(rooms: Sequence[str], modules: Sequence[str] = (), also: Sequence[str] = ()) -> str:
    """The page of some rooms, of all that some modules define, and of single paths, as MyST."""
    lines = [entry(f"symhyb.{name}", getattr(symhyb, name)) for name in exported(rooms)]
    for module in modules:
        lines += [entry(f"{module}.{name}", thing) for name, thing in defined(module)]
    for path in also:
        module, _, name = path.rpartition(".")
        lines.append(entry(path, getattr(importlib.import_module(module), name)))
    return "\n".join(lines)


def entry(path: str, thing: Any) -> str:
    """What autodoc is told of one name."""
    kind = "autofunction"
    if inspect.isclass(thing):
        kind = "autoexception" if issubclass(thing, Exception) else "autoclass"
    options = "".join(f"   :{option}\n" for option in shown(thing))
    return f"```{{eval-rst}}\n.. {kind}:: {path}\n{options}```\n"


def shown(thing: Any) -> Iterator[str]:
    """What of a class is shown: its members, if they are not those that a library asks for, and
    its call."""
    if not inspect.isclass(thing):
        return
    if all(base.__module__.split(".")[0] in ("symhyb", "builtins") for base in thing.__mro__):
        yield "members:"
        if "__call__" in vars(thing):
            yield "special-members: __call__"

"""Reference of the command line, from the help that each verb prints."""

import inspect
import re
from collections.abc import Iterator
from typing import Any

from typer.main import get_command

from symhyb.cli.app import app

UNFORMATTED = "\b"  # before a paragraph whose lines stay as they are


def verbs_text() -> str:
    """All verbs as MyST, each with its usage, what it does, its arguments and options."""
    root = get_command(app)
    return "\n\n".join(section(verb, path) for path, verb in verbs(root, "symhyb"))


def verbs(command: Any, path: str) -> Iterator[tuple[str, Any]]:
    """The verbs below a command, each with what is typed for it; groups are followed."""
    for name, inner in command.commands.items():
        if inner.hidden:
            continue
        if hasattr(inner, "commands"):
            yield from verbs(inner, f"{path} {name}")
        else:
            yield f"{path} {name}", inner


def section(command: Any, path: str) -> str:
    """One verb."""
    context = command.context_class(command, info_name=path)
    parts = [f"## `{path}`", *paragraphs(command.help or "")]
    usage = " ".join((path, *command.collect_usage_pieces(context)))
    parts.insert(2, f"```console\n$ {usage}\n```")
    records = [
        (is_option(one), one.get_help_record(context)) for one in command.get_params(context)
    ]
    for heading, wanted in (("argument", False), ("option", True)):
        rows = [record for option, record in records if record and option is wanted]
        if rows:
            parts.append(table(heading, rows))
    return "\n\n".join(parts)


def is_option(parameter: Any) -> bool:
    """Whether a parameter is given by its name."""
    return bool(parameter.param_type_name == "option")


def paragraphs(text: str) -> Iterator[str]:
    """The paragraphs of a help text; those whose lines stay as they are become code."""
    for paragraph in re.split(r"\n\s*\n", inspect.cleandoc(text)):
        lines = paragraph.splitlines()
        if lines[0].strip() != UNFORMATTED:
            yield plain(" ".join(line.strip() for line in lines))
            continue
        title = lines[1].strip()
        kept = inspect.cleandoc("\n".join(["", *lines[2:]]))
        yield f"{title}\n\n```console\n{kept}\n```"


def table(heading: str, rows: list[tuple[str, str]]) -> str:
    """A table of parameters and what they mean."""
    lines = [f"| {heading} | meaning |", "|---|---|"]
    for name, meaning in rows:
        written = re.sub(r" <.*>$", "", name).replace(
            "|", r"\|"
        )  # the type, of which help says more
        lines.append(f"| `{written}` | {plain(meaning)} |")
    return "\n".join(lines)


def plain(text: str) -> str:
    """A sentence whose signs mean nothing to Markdown, with option names as code."""
    escaped = re.sub(r"([\\`*_{}\[\]<>|#])", r"\\\1", " ".join(text.split()))
    return re.sub(r"(?<![\w-])(--[a-z-]+[a-z])", r"`\1`", escaped)

"""The text of a first model file: numbers that were given, guesses that say so, columns as sensors.

The parameters of a template stand in one line each; that is what is changed here.
"""

import re
from collections.abc import Mapping, Sequence

from symhyb.drafting.columns import Role
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.source import scan

GUESS = "guessed"
_PARAMETER = re.compile(
    r'(?P<name>\w+)\s*= \{ value = (?P<value>[^,]+), unit = "(?P<unit>[^"]*)"'
    r"(?:, sd = (?P<sd>[^,]+))?, about = (?P<about>\".*\") \}"
)
_NUMBER = re.compile(r"\s*(?P<name>\w+)\s*=\s*(?P<value>[^±+]+?)\s*(?:(?:±|\+-)\s*(?P<sd>.+?))?\s*")

Number = tuple[float, float | None]


def read_numbers(options: Sequence[str]) -> dict[str, Number]:
    """Values and deviations from ``k=1200``, ``k=1200±50`` or ``k=1200+-50``.

    Raises:
        InputError: every option that is none.
    """
    found: dict[str, Number] = {}
    problems = []
    for text in options:
        match = _NUMBER.fullmatch(text)
        try:
            if match is None or match["name"] in found:
                raise ValueError
            sd = None if match["sd"] is None else float(match["sd"])
            value = float(match["value"])
            if not abs(value) < 1e300 or (sd is not None and not 0 < sd < 1e300):
                raise ValueError
            found[match["name"]] = value, sd
        except ValueError:
            text = f"--set {text}"
            problems.append(Problem("write it once, as NAME=NUMBER or NAME=NUMBER±SD", text))
    if problems:
        raise InputError(problems)
    return found


def parameters_of(text: str) -> dict[str, tuple[float, float | None, str, str]]:
    """The parameters of a template: value, deviation, unit and what they are, by name."""
    found = {}
    for line in text.splitlines():
        match = _PARAMETER.fullmatch(line)
        if match is not None:
            sd = None if match["sd"] is None else float(match["sd"])
            about = match["about"].strip('"')
            found[match["name"]] = float(match["value"]), sd, match["unit"], about
    return found


def with_numbers(text: str, numbers: Mapping[str, Number]) -> str:
    """The text with these numbers; all others say that they are guessed.

    Raises:
        InputError: names that are no parameters of the template.
    """
    known = parameters_of(text)
    problems = [
        Problem(f"there is no parameter '{name}'{did_you_mean(name, list(known))}", f"--set {name}")
        for name in numbers
        if name not in known
    ]
    if problems:
        raise InputError(problems)
    return "\n".join(_numbered(line, numbers) for line in text.split("\n"))


def _numbered(line: str, numbers: Mapping[str, Number]) -> str:
    match = _PARAMETER.fullmatch(line)
    if match is None:
        return line
    if match["name"] == "g" and "g" not in numbers:  # the same for everybody
        return line
    if match["name"] not in numbers:
        return f"{line}  # {GUESS}: put in your own"
    value, sd = numbers[match["name"]]
    known = "" if sd is None else f", sd = {sd!r}"
    head = line[: match.start("value")]
    unit, about = match["unit"], match["about"]
    return f'{head}{value!r}, unit = "{unit}"{known}, about = {about} }}'


def without_zeros(text: str, numbers: Mapping[str, Number]) -> str:
    """The text of a line of bodies without the springs and dampers that are 0."""
    gone = [name for name, (value, _) in numbers.items() if value == 0 and name[:2] in ("k_", "d_")]
    for name in gone:
        what = "spring" if name.startswith("k_") else "damper"
        text = re.sub(rf"\[elements\.{what}_{name[2:]}\]\n(?:.+\n)*\n?", "", text)
        text = re.sub(rf"(?m)^{name} = .*\n", "", text)
    return text


def with_columns(text: str, roles: Sequence[Role], file: str) -> str:
    """The text with the columns of a recording as its sensors, and how they are mapped."""
    sensors = [_sensor_line(role) for role in roles if role.kind == "sensor"]
    others = [
        f'# column "{_plain(role.column)}" is not used: {role.guessed}'
        for role in roles
        if role.kind == "none"
    ]
    head, _, _ = text.partition("\n[sensors]")
    lines = [head, f"[sensors]                             # columns of {_plain(file)}"]
    lines += [*sensors, *others]
    inputs = [role for role in roles if role.kind == "input"]
    if inputs:
        lines += ["", "# Inputs in this recording:"]
        lines += [f"#   {_input_line(role)}" for role in inputs]
    maps = map_options(roles)
    if maps:
        lines += ["", "# Read this recording with:", *(f"#   {_plain(one)}" for one in maps)]
    return "\n".join([*lines, ""])


def map_options(roles: Sequence[Role]) -> list[str]:
    """The options that find the columns whose names are not those of the model."""
    return [f"--map {_quoted(f'{role.name}={role.source}')}" for role in roles if role.source]


def _sensor_line(role: Role) -> str:
    about = f'column \\"{_toml(role.column)}\\"' if role.source else f"column {role.column}"
    line = (
        f'{role.name} = {{ measures = "{role.measures}", unit = "{role.unit}", about = "{about}" }}'
    )
    return f"{line}  # {GUESS}: {role.guessed}" if role.guessed else line


def _input_line(role: Role) -> str:
    said = f'{role.name} is column "{_plain(role.column)}"'
    return f"{said}  ({GUESS}: {role.guessed})" if role.guessed else said


def _plain(text: str) -> str:
    """A text for a comment: one line, printable."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def _toml(text: str) -> str:
    return _plain(text).replace("\\", "\\\\").replace('"', '\\"')


def _quoted(text: str) -> str:
    """A word of a shell."""
    plain = re.fullmatch(r"[\w=.,/:+-]+", text, re.ASCII)
    return text if plain else "'" + text.replace("'", "'\\''") + "'"


def with_title(text: str, title: str) -> str:
    """The text with another title."""
    entry = scan(text).entries[("title",)]
    return f'{text[: entry.start]}"{_toml(title)}"{text[entry.end :]}'

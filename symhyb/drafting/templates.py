"""Model files to begin with: shipped ones, and lines of masses or rotors made from coordinates."""

import re
from collections.abc import Sequence
from importlib.resources import files

from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.units import UnitError, parse_unit

TEMPLATES = ("oscillator", "quarter_car", "drive", "pendulum", "backlash", "cart_pole")
_COORDINATE = re.compile(r"\s*([A-Za-z]\w*)\s*(?:\[([^\]]+)\])?\s*")


def template_text(name: str) -> str:
    """The text of a shipped template.

    Raises:
        InputError: there is none of that name.
    """
    if name not in TEMPLATES:
        raise InputError(Problem(f"there is no template '{name}'{did_you_mean(name, TEMPLATES)}"))
    folder = files("symhyb.drafting") / "templates"
    return (folder / f"{name}.toml").read_text(encoding="utf-8")


def summary(name: str) -> str:
    """The first line of a template: what it is."""
    return template_text(name).splitlines()[0].removeprefix("# ")


def read_coordinates(texts: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Names and units from texts as ``x [m]`` or ``phi [rad]``; without a unit it is m.

    Raises:
        InputError: every text that is none, and units that are neither lengths nor angles.
    """
    found, problems = list[tuple[str, str]](), list[Problem]()
    for text in texts:
        match = _COORDINATE.fullmatch(text)
        if match is None:
            problems.append(
                Problem("write it as NAME [UNIT], as in 'x [m]'", f"--coordinate {text}")
            )
            continue
        name, unit = match[1], (match[2] or "m").strip()
        try:
            parsed = parse_unit(unit)
        except UnitError as error:
            problems.append(Problem(str(error), f"--coordinate {text}"))
            continue
        if not any(parsed.same_dimension(parse_unit(one)) for one in ("m", "rad")):
            said = f"'{unit}' is neither a length nor an angle"
            problems.append(Problem(said, f"--coordinate {text}"))
        if name in [known for known, _ in found]:
            problems.append(Problem(f"'{name}' stands twice", f"--coordinate {text}"))
        found.append((name, unit))
    if problems:
        raise InputError(problems)
    return tuple(found)


def line_text(coordinates: Sequence[tuple[str, str]]) -> str:
    """The model of masses or rotors in a line, one a coordinate: each on a spring and a damper to
    the ground and to the one before, each with a force or torque that acts on it."""
    head = [
        "# Bodies in a line, one a coordinate: springs and dampers to the ground and in between.",
        "#",
        "#   ground --/\\/\\/--[ first ]--/\\/\\/--[ second ]-- ...   to the right is positive",
        "#",
        "# Take out what your machine does not have, and write what it has besides.",
        "",
        "symhyb = 1",
        'title  = "Bodies in a line"',
        "",
        "[coordinates]",
    ]
    head += [f'{name} = {{ unit = "{unit}", start = 0.0 }}' for name, unit in coordinates]
    numbers = ["", "[parameters]                          # sd: may be estimated. No sd: held."]
    inputs, parts, sensors = ["", "[inputs]"], list[str](), ["", "[sensors]"]
    before = ""
    for name, unit in coordinates:
        turns = parse_unit(unit).same_dimension(parse_unit("rad"))
        numbers += _numbers(name, turns, before and _same_kind(coordinates, before, name))
        force = "torque" if turns else "force"
        inputs.append(
            f'{force}_{name} = {{ unit = "{"N*m" if turns else "N"}", about = "on {name}" }}'
        )
        parts += _body(name, turns)
        parts += _pair(name, name, "")
        if before and _same_kind(coordinates, before, name):
            parts += _pair(f"{before}_{name}", f"{name} - {before}", f"{before}_{name}")
        parts += _element(f"drive_{name}", force, name, (force, f"{force}_{name}"))
        sensors.append(f'sensor_{name} = {{ measures = "{name}", unit = "{unit}" }}')
        before = name
    return "\n".join([*head, *numbers, *inputs, *parts, *sensors, ""])


def _same_kind(coordinates: Sequence[tuple[str, str]], first: str, second: str) -> str:
    """The first name, if both coordinates are lengths or both angles, else nothing."""
    units = {name: parse_unit(unit) for name, unit in coordinates}
    return first if units[first].same_dimension(units[second]) else ""


def _numbers(name: str, turns: bool, before: str) -> list[str]:
    k, d = ("N*m/rad", "N*m*s/rad") if turns else ("N/m", "N*s/m")
    lines = [_number(f"m_{name}", 1.0, "kg", None, f"mass of the body of {name}")]
    if turns:
        lines.append(_number(f"J_{name}", 0.01, "kg*m^2", None, f"inertia of the body of {name}"))
    for key, unit, value in (("k", k, 100.0), ("d", d, 1.0)):
        what = "spring" if key == "k" else "damper"
        about = f"{what} from {name} to the ground; 0 for none"
        lines.append(_number(f"{key}_{name}", value, unit, value / 2, about))
        if before:
            about = f"{what} between {before} and {name}; 0 for none"
            lines.append(_number(f"{key}_{before}_{name}", value, unit, value / 2, about))
    return lines


def _number(name: str, value: float, unit: str, sd: float | None, about: str) -> str:
    known = "" if sd is None else f", sd = {sd}"
    return f'{name} = {{ value = {value}, unit = "{unit}"{known}, about = "{about}" }}'


def _body(name: str, turns: bool) -> list[str]:
    place = '["0", "0"]' if turns else f'["{name}", "0"]'
    lines = ["", f"[bodies.body_{name}]", f'mass = "m_{name}"', f"at   = {place}"]
    return [*lines, f'inertia = "J_{name}"', f'angle = "{name}"'] if turns else lines


def _pair(name: str, place: str, suffix: str) -> list[str]:
    """A spring and a damper side by side."""
    end = suffix or name
    spring = _element(f"spring_{end}", "spring", place, ("stiffness", f"k_{end}"))
    return spring + _element(f"damper_{end}", "damper", place, ("damping", f"d_{end}"))


def _element(name: str, kind: str, place: str, entry: tuple[str, str]) -> list[str]:
    key, value = entry
    return ["", f"[elements.{name}]", f'kind = "{kind}"', f'on   = "{place}"', f'{key} = "{value}"']

"""The model file with what was concealed written into it: for scores against the truth."""

import re
import tomllib

from hidden import Hidden
from laws import Effect

DIMENSIONS = {  # powers of force, stretch and time
    "stiffness": (1, -1, 0),
    "quadratic": (1, -2, 0),
    "cubic": (1, -3, 0),
    "damping": (1, -1, 1),
    "micro_damping": (1, -1, 1),
    "asymmetry": (0, 0, 0),
    "drag": (1, -2, 2),
    "coulomb": (1, 0, 0),
    "static": (1, 0, 0),
    "stribeck": (0, 1, -1),
    "clearance": (0, 1, 0),
    "beta": (0, -1, 0),
    "gamma": (0, -1, 0),
    "constant": (1, 0, 0),
    "amplitude": (1, 0, 0),
    "frequency": (0, 0, -1),
    "phase": (0, 0, 0),
    "period": (0, 1, 0),
}


def truth_text(text: str, hidden: Hidden) -> str:
    """The text of a model file with the true parameters, channels and elements."""
    length = {
        tuple(element["between"]): element["length"]
        for element in tomllib.loads(text)["elements"].values()
        if "between" in element and "length" in element
    }
    for name, value in hidden.parameters.items():
        text = _with(text, name, r"(value = )[^,]+", rf"\g<1>{value!r}")
    for fault in hidden.faults:
        text = _with(text, fault.channel, r"( \})$", f", {fault.kind} = {fault.value!r} }}")
    coordinates = tomllib.loads(text)["coordinates"]
    units = {name: entry["unit"] for name, entry in coordinates.items()}
    elements = [_element(i, effect, length, units) for i, effect in enumerate(hidden.effects)]
    return text + "".join(elements)


def _with(text: str, name: str, pattern: str, by: str) -> str:
    """The text with a pattern replaced in the one line that declares ``name``."""
    lines = text.splitlines()
    (row,) = (i for i, line in enumerate(lines) if line.startswith(f"{name} = {{"))
    lines[row] = re.sub(pattern, by, lines[row], count=1)
    return "\n".join(lines) + "\n"


def _element(
    index: int, effect: Effect, length: dict[tuple[str, ...], str], units: dict[str, str]
) -> str:
    name = f"concealed{index}"
    lines = ["", f"[elements.{name}]", f'kind = "{effect.kind}"']
    points = tuple(effect.place.split("-"))
    stretch = units.get(effect.place, "m")
    if len(points) == 2:
        lines.append(f'between = ["{points[0]}", "{points[1]}"]')
        if points in length and effect.kind not in ("damper", "drag", "friction"):
            lines.append(f'length = "{length[points]}"')
    else:
        lines.append(f'on = "{effect.place}"')
    if effect.kind == "gap":
        lines.append(f'side = "{effect.side}"')
    lines += [f'{key} = "{key}_"' for key in effect.keys]
    lines.append(f"[elements.{name}.parameters]")
    for key, value in effect.keys.items():
        lines.append(
            f'{key}_ = {{ value = {float(value)!r}, unit = "{_unit(effect, key, stretch)}" }}'
        )
    return "\n".join(lines) + "\n"


def _unit(effect: Effect, key: str, stretch: str) -> str:
    """The unit of a key at a place with stretches in m, rad or V."""
    if (effect.kind, key) == ("added_mass", "mass"):
        return {"m": "kg", "rad": "kg*m^2", "V": "s^2"}[stretch]
    force, length, time = DIMENSIONS[key]
    own = {"m": "N", "rad": "N*m", "V": "V"}[stretch]
    factors = [
        f"({unit})^{power}"
        for unit, power in ((own, force), (stretch, length), ("s", time))
        if power
    ]
    return "*".join(factors) or "1"

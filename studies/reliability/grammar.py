"""Expressions and units as their grammars allow them, and a little beyond."""

from random import Random

NAMES = ("x", "x'", "x''", "q", "q'", "u", "f", "k", "m", "d", "t", "pi", "phi", "s", "r", "y1'")
FUNCTIONS = (
    "sin",
    "cos",
    "tan",
    "exp",
    "log",
    "sqrt",
    "abs",
    "sign",
    "tanh",
    "atan2",
    "min",
    "max",
)
LITERALS = ("0", "1", "2", "-1", "0.5", "1e308", "1e-320", "9**9", "10**400", "1e999", "3j", "0x1f")
UNITS = ("m", "N", "kg", "s", "rad", "deg", "mm", "km", "V", "A", "ohm", "degC", "Hz", "lbf", "1")
POWERS = ("", "", "^2", "^-1", "**2", "^0.5", "^1/2", "^(3/2)", "^99", "^-9999", "^1e9", "²", "^^2")


def expression(random: Random, depth: int = 0) -> str:
    """An expression: mostly sound, now and then one that no one would write."""
    kind = random.randrange(10)
    if depth > random.choice((2, 3, 4, 6, 30)) or kind < 3:
        return random.choice(NAMES if random.random() < 0.7 else LITERALS)
    inner = [expression(random, depth + 1) for _ in range(2)]
    if kind < 7:
        return f"({inner[0]}) {random.choice('+-*/')} {inner[1]}"
    if kind < 8:
        return f"({inner[0]})**{random.choice((*LITERALS, inner[1], '2', '3', '(1/2)', '500'))}"
    if random.random() < 0.05:
        word = random.choice(("curve", "map"))
        return f"{word}({random.choice(NAMES)}, {', '.join(inner[: random.choice((1, 2))])})"
    name = random.choice(FUNCTIONS)
    return f"{name}({inner[0]}{', ' + inner[1] if random.random() < 0.2 else ''})"


def unit(random: Random) -> str:
    """A unit, most often one that can be read."""
    parts = [random.choice(UNITS) + random.choice(POWERS) for _ in range(random.randrange(1, 5))]
    return random.choice(("*", "*", "/", " ", "·", "**", "")).join(parts)

"""The law of a found element as text, with the keys that are set and no others."""

from collections.abc import Collection, Sequence

from symhyb.model.vocabulary import KINDS

_LEVEL = "g = coulomb + (static - coulomb)*exp(-(s'/stribeck)^2)"


def law_text(kind: str, keys: Collection[str], options: Sequence[tuple[str, str]] = ()) -> str:
    """The law of a kind with the keys that are set: ``coulomb*tanh(s'/transition)``.

    ``options`` are the words of an element (the ``side`` of a gap). The rate of an inner state z
    and a level g stand behind the force, after commas.
    """
    sided = "*(1 + asymmetry*sgn(s'))" if "asymmetry" in keys else ""
    match kind:
        case "spring":
            terms = KINDS[kind].law.split(" + ")
            return " + ".join(term for term in terms if term.split("*")[0] in keys)
        case "damper":
            return f"damping*s'{sided}"
        case "friction":
            level, rest = ("g", f", {_LEVEL}") if "static" in keys else ("coulomb", "")
            return f"{level}*tanh(s'/transition){sided}{rest}"
        case "gap":
            return _gap(keys, dict(options).get("side", "both"))
        case "hysteresis":
            return _hysteresis(keys)
        case "friction_dynamic":
            level, rest = ("g", f", {_LEVEL}") if "static" in keys else ("coulomb", "")
            force = "stiffness*z" + (" + micro_damping*z'" if "micro_damping" in keys else "")
            return f"{force}, z' = s' - stiffness*abs(s')*z/{level}{rest}"
        case "relaxation":
            return f"{KINDS[kind].law}, {KINDS[kind].state}"
    return KINDS[kind].law


def _gap(keys: Collection[str], side: str) -> str:
    upper, lower = ("s - clearance", "s + clearance") if "clearance" in keys else ("s", "s")
    if "damping" in keys:  # in contact only, and never pulling
        pressed = [
            f"max(stiffness*({upper}) + damping*s', 0)*({upper} > 0)",
            f"min(stiffness*({lower}) + damping*s', 0)*({lower} < 0)",
        ]
    else:
        pressed = [f"stiffness*max({upper}, 0)", f"stiffness*min({lower}, 0)"]
    chosen = {"upper": pressed[:1], "lower": pressed[1:]}.get(side, pressed)
    return " + ".join(chosen)


def _hysteresis(keys: Collection[str]) -> str:
    force = "stiffness*dead(z, play)" if "play" in keys else "stiffness*z"
    turned, grown = ("abs(z)^(n-1)*z", "abs(z)^n") if "exponent" in keys else ("z", "abs(z)")
    rate = "s'"
    rate += f" - beta*abs(s')*{turned}" if "beta" in keys else ""
    rate += f" - gamma*s'*{grown}" if "gamma" in keys else ""
    return f"{force}, z' = {rate}" + (", n = exponent" if "exponent" in keys else "")

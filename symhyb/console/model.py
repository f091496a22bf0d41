"""What a checked model declares, printed and as plain values."""

from collections.abc import Sequence
from typing import Any

from symhyb.discrepancy.words.amounts import quantity_text
from symhyb.model.constraints import Constraint
from symhyb.model.types import Model, Parameter, place_text

HELD_SHOWN = 30  # parameters without an sd


def print_model(model: Model) -> None:
    """Print what a checked model declares."""
    said = {
        "coordinates": [f"{q.name} [{q.unit}]" for q in model.coordinates],
        "parameters": _parameters(model.all_parameters()),
        "inputs": [f"{item.name} [{item.unit}]" for item in model.inputs],
        "bodies": [body.name for body in model.bodies],
        "constraints": [_constraint(item) for item in model.constraints],
        "curves": [f"{c.name} ({len(c.points)} points)" for c in model.all_curves()],
        "maps": [f"{m.name} ({len(m.x)} by {len(m.y)} places)" for m in model.all_maps()],
        "elements": [f"{e.name} ({e.kind} {place_text(e.place)})" for e in model.elements],
        "sensors": [f"{s.name} [{s.unit}] measures {s.measures}" for s in model.sensors],
    }
    print(
        f"{model.file}: no problem found", *([f"  {model.title}"] if model.title else []), sep="\n"
    )
    for section, parts in said.items():
        if parts:
            print(f"  {section}: {', '.join(parts)}")


def _constraint(item: Constraint) -> str:
    of = f" of {' and '.join(item.names)}" if item.names else ""
    return f"{item.name} ({item.kind}{of})"


def model_facts(model: Model) -> dict[str, Any]:
    """Give what a checked model declares as plain values, by section and name."""
    return {
        "file": model.file,
        "title": model.title,
        "coordinates": {q.name: {"unit": q.unit.text} for q in model.coordinates},
        "parameters": {
            p.path: {"value": p.value, "sd": p.sd, "unit": p.unit.text}
            for p in model.all_parameters()
        },
        "inputs": {item.name: {"unit": item.unit.text} for item in model.inputs},
        "bodies": [body.name for body in model.bodies],
        "constraints": {
            item.name: {"kind": item.kind, "of": list(item.names)} for item in model.constraints
        },
        "curves": {
            c.name: {"points": len(c.points), "units": [unit.text for unit in c.units]}
            for c in model.all_curves()
        },
        "maps": {
            m.name: {"places": [len(m.x), len(m.y)], "units": [unit.text for unit in m.units]}
            for m in model.all_maps()
        },
        "elements": {
            e.name: {"kind": e.kind, "place": place_text(e.place)} for e in model.elements
        },
        "sensors": {
            s.name: {"unit": s.unit.text, "measures": s.measures.text} for s in model.sensors
        },
    }


def _parameters(all_of_them: Sequence[Parameter]) -> list[str]:
    """Each with its value; of a machine with many those that may be off, and how many are held."""
    held = sum(one.sd is None for one in all_of_them)
    if held <= HELD_SHOWN:
        return [_parameter(one) for one in all_of_them]
    return [
        *(_parameter(one) for one in all_of_them if one.sd is not None),
        f"{held} that are held (--json lists them)",
    ]


def _parameter(parameter: Parameter) -> str:
    value = quantity_text(parameter.value, parameter.unit.text, parameter.sd, digits=8)
    return f"{parameter.path} = {value}" + (" (held)" if parameter.sd is None else "")

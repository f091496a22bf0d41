"""Models of this project as FMUs: the same machine, and a model file that can see no more of it
than states, inputs, parameters and between which places parts stretch."""

from dataclasses import replace
from pathlib import Path

from symhyb.discrepancy.places.placements import places_of
from symhyb.export.fmu import fmu
from symhyb.export.spec import spec_of
from symhyb.model.expression import parse_expression, readings
from symhyb.model.fmu import Fmu, FmuPlace
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.types import Between, Element, Energy, Input, Model, On, Place
from symhyb.model.vocabulary import force_unit


def as_fmu(model: Model, folder: Path, fmi: int = 2, kinds: tuple[str, ...] = ("me",)) -> Model:
    """The model as an FMU in ``folder`` with an input of force on every coordinate, and the model
    file beside it that names its variables, with the sensors that show coordinates and a spring of
    strength 0 on every stretch that is not a coordinate."""
    names = [c.name for c in model.coordinates]
    pushes = tuple(Input(f"push_{name}", force_unit(model, On(name))) for name in names)
    forces = tuple(
        Element(f"push_{name}", "force", On(name), (("force", parse_expression(f"push_{name}")),))
        for name in names
    )
    pushed = replace(
        model, inputs=(*model.inputs, *pushes), elements=(*model.elements, *forces), text=""
    )
    folder.mkdir(exist_ok=True)
    spec = spec_of(pushed, "machine", whole=True)
    data = fmu(spec, fmi, platforms=("linux64",), kinds=kinds)
    (folder / "machine.fmu").write_bytes(data)
    known = {v.name for v in spec.of_role("parameter")}
    named = Fmu(
        "machine.fmu",
        tuple(FmuPlace(name, f"q.{name}", f"v.{name}", f"u.push_{name}") for name in names),
        tuple((item.name, f"u.{item.name}") for item in model.inputs),
        tuple((p.name, f"p.{p.name}") for p in model.parameters if f"p.{p.name}" in known),
    )
    stretches = [p for p in places_of(model) if not (isinstance(p, On) and p.plain)]
    ends = {e for p in stretches if isinstance(p, Between) for e in (p.first, p.second)}
    bare = replace(
        model,
        fmu=named,
        inputs=tuple(replace(i, gain=None, offset=None) for i in model.inputs),
        sensors=tuple(s for s in model.sensors if not readings(s.measures)),
        bodies=(),
        points=tuple(point for point in model.points if point.name in ends),
        elements=tuple(_idle(model, f"stretch{i}", one) for i, one in enumerate(stretches, 1)),
        constraints=(),
        energy=Energy(),
        gravity=None,
        curves=(),
        text="",
    )
    path = folder / "machine.toml"
    path.write_text(render(bare), encoding="utf-8")
    return parse_model(path.read_text(encoding="utf-8"), str(path))


def _idle(model: Model, name: str, place: Place) -> Element:
    """A spring of strength 0: the place is known, with the length that the model has there, and
    nothing acts."""
    there = (dict(e.values).get("length") for e in model.elements if e.place == place)
    length = tuple(("length", value) for value in there if value is not None)[:1]
    return Element(name, "spring", place, (("stiffness", parse_expression("0")), *length))

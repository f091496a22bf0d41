"""modelDescription.xml of an FMU, FMI 2.0 and 3.0: variables and what depends on what.

Sources: FMI 2.0.4, section 2.2; FMI 3.0.1, section 2.4.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from symhyb.export.functions.exported import Flags
from symhyb.export.spec import Spec, Variable
from symhyb.units import Unit

KINDS = {"cs": "CoSimulation", "me": "ModelExchange"}
STEP = 1e-3  # s, proposed to importers
_SI = ("m", "kg", "s", "A", "K", "mol", "cd")


def model_description(spec: Spec, fmi: int, token: str, kinds: Sequence[str]) -> str:
    """The description as XML text."""
    counted = {"numberOfEventIndicators": str(spec.exported.indicators)}
    root = ET.Element(
        "fmiModelDescription",
        {
            "fmiVersion": f"{fmi}.0",
            "modelName": spec.identifier,
            "guid" if fmi == 2 else "instantiationToken": token,
            "description": spec.title,
            "generationTool": f"symhyb {_version()}",
            "variableNamingConvention": "structured",
            **(counted if fmi == 2 and spec.events else {}),
        },
    )
    for kind in sorted(kinds, key=["me", "cs"].index):
        _interface(root, spec, fmi, kind)
    units = ET.SubElement(root, "UnitDefinitions")
    for unit in _units(spec.variables):
        _unit(ET.SubElement(units, "Unit", name=unit.text), unit)
    ET.SubElement(ET.SubElement(root, "LogCategories"), "Category", name="logStatusError").set(
        "description", "why a call was refused or failed"
    )
    ET.SubElement(root, "DefaultExperiment", startTime="0.0", stepSize=repr(STEP))
    variables = ET.SubElement(root, "ModelVariables")
    for variable in listed(spec, fmi):
        (_variable2 if fmi == 2 else _variable3)(variables, spec, variable)
    _structure(ET.SubElement(root, "ModelStructure"), spec, fmi)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, "unicode") + "\n"


def build_description(spec: Spec) -> str:
    """sources/buildDescription.xml, by which FMI 3.0 says how to compile."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    build = ET.SubElement(root, "BuildConfiguration", modelIdentifier=spec.identifier)
    sources = ET.SubElement(build, "SourceFileSet", language="C99")
    ET.SubElement(sources, "SourceFile", name=f"{spec.identifier}.c")
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, "unicode") + "\n"


def listed(spec: Spec, fmi: int) -> tuple[Variable, ...]:
    """The variables that are listed: FMI 3 asks for the time, FMI 2 does well without it."""
    return tuple(v for v in spec.variables if fmi == 3 or v.role != "time")


def _version() -> str:
    try:
        return version("symhyb")
    except PackageNotFoundError:
        return ""


def _interface(root: ET.Element, spec: Spec, fmi: int, kind: str) -> None:
    can = ["canHandleVariableCommunicationStepSize"] if kind == "cs" else []
    if fmi == 3:
        can += ["canGetAndSetFMUState", "canSerializeFMUState"]
        can += ["providesDirectionalDerivatives", "providesAdjointDerivatives"]
        can += ["needsCompletedIntegratorStep"] if spec.events else []
    else:
        can += ["canInterpolateInputs"] if kind == "cs" else []
        can += ["canNotUseMemoryManagementFunctions", "canGetAndSetFMUstate"]
        can += ["canSerializeFMUstate", "providesDirectionalDerivative"]
    traits = {"modelIdentifier": spec.identifier, **dict.fromkeys(can, "true")}
    interface = ET.SubElement(root, KINDS[kind], traits)
    if fmi == 2:
        sources = ET.SubElement(interface, "SourceFiles")
        ET.SubElement(sources, "File", name=f"{spec.identifier}.c")


def _units(variables: Iterable[Variable]) -> list[Unit]:
    return list({v.unit.text: v.unit for v in variables if v.unit.text != "1"}.values())


def _unit(element: ET.Element, unit: Unit) -> None:
    """Base units in whole powers; the standard knows no others."""
    if any(power.denominator != 1 for power in unit.dimension):
        return
    powers = {
        name: str(int(power)) for name, power in zip(_SI, unit.dimension, strict=True) if power
    }
    if unit.is_angle:
        powers["rad"] = "1"
    ET.SubElement(element, "BaseUnit", powers)


def _traits(spec: Spec, variable: Variable) -> dict[str, str]:
    match variable.role:
        case "input":
            return {"causality": "input", "variability": "continuous"}
        case "output":
            return {"causality": "output", "variability": "continuous", "initial": "calculated"}
        case "parameter":
            return {"causality": "parameter", "variability": "tunable", "initial": "exact"}
        case "time":
            return {"causality": "independent", "variability": "continuous"}
        case "mode":
            return {"causality": "local", "variability": "discrete", "initial": "calculated"}
        case "rate" | "indicator":
            return {"causality": "local", "variability": "continuous", "initial": "calculated"}
    inner = variable in spec.inner
    return {
        "causality": "local" if inner else "output",
        "variability": "continuous",
        "initial": "calculated" if inner else "exact",
    }


def _numbers(spec: Spec, variable: Variable) -> dict[str, str]:
    """Unit, start (not of what is calculated), state of a rate and nominal value."""
    more = {} if variable.unit.text == "1" else {"unit": variable.unit.text}
    if _traits(spec, variable).get("initial") != "calculated" and variable.role != "time":
        more["start"] = repr(variable.start)
    if variable.role == "rate":  # FMI 2 counts variables from 1, references count the time as 0
        more["derivative"] = str(variable.of)
    if variable in spec.inner:
        more["nominal"] = repr(spec.nominal(variable))
    return more


def _variable2(parent: ET.Element, spec: Spec, variable: Variable) -> None:
    scalar = ET.SubElement(parent, "ScalarVariable", _head(spec, variable))
    ET.SubElement(scalar, "Real", _numbers(spec, variable))


def _variable3(parent: ET.Element, spec: Spec, variable: Variable) -> None:
    ET.SubElement(parent, "Float64", _head(spec, variable) | _numbers(spec, variable))


def _head(spec: Spec, variable: Variable) -> dict[str, str]:
    head = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "description": variable.about,
    }
    return head | _traits(spec, variable)


def _structure(structure: ET.Element, spec: Spec, fmi: int) -> None:
    running, starting = _running(spec), _starting(spec)
    states = spec.of_role("state")
    exact = [v for v in states if v not in spec.inner]
    outputs = [*spec.of_role("output"), *exact]
    rates = list(spec.of_role("rate"))
    first = sorted([*spec.of_role("output"), *spec.inner, *rates], key=lambda v: v.reference)

    def entry(parent: ET.Element, tag: str, variable: Variable, known: Sequence[int]) -> None:
        key = "index" if fmi == 2 else "valueReference"
        ET.SubElement(
            parent, tag, {key: str(variable.reference), "dependencies": " ".join(map(str, known))}
        )

    if fmi == 2:
        for tag, group, table in (
            ("Outputs", outputs, running),
            ("Derivatives", rates, running),
            ("InitialUnknowns", first, starting),
        ):
            if group:
                inside = ET.SubElement(structure, tag)
                for variable in group:
                    entry(inside, "Unknown", variable, table[variable.reference])
        return
    for tag, group, table in (
        ("Output", outputs, running),
        ("ContinuousStateDerivative", rates, running),
        ("InitialUnknown", first, starting),
    ):
        for variable in group:
            entry(structure, tag, variable, table[variable.reference])
    for variable in spec.of_role("indicator"):
        entry(structure, "EventIndicator", variable, running[variable.reference])


def _running(spec: Spec) -> dict[int, list[int]]:
    """Of what is computed, and of states: the inputs and states they depend on, by reference."""
    by_x, by_u, _ = spec.exported.dependencies()
    states, inputs = spec.of_role("state"), spec.of_role("input")
    made = {}
    for row, variable in enumerate(_computed(spec)):
        known = [*_named(inputs, by_u[row]), *_named(states, by_x[row])]
        made[variable.reference] = sorted(known)
    return made | {state.reference: [state.reference] for state in states}


def _computed(spec: Spec) -> tuple[Variable, ...]:
    """The rows of what is computed from states and inputs."""
    return (*spec.of_role("rate"), *spec.of_role("output"), *spec.of_role("indicator"))


def _starting(spec: Spec) -> dict[int, list[int]]:
    """The same at the start, where inner states follow from the rest, and parameters count."""
    here, resting = spec.exported.dependencies(), spec.exported.rest_dependencies()
    inner, states = len(spec.inner), spec.of_role("state")
    exact = states[: len(states) - inner]
    by_z = here[0][:, len(exact) :].astype(int)
    groups = (exact, spec.of_role("input"), spec.of_role("parameter"))
    rows = [*_computed(spec), *spec.inner]
    made: dict[int, list[int]] = {v.reference: [] for v in rows}
    for group, direct, rest in zip(groups, here, resting, strict=True):
        size = len(group)
        through = (by_z @ rest[:, :size].astype(int)) > 0
        table = np.vstack([direct[:, :size] | through, rest[:, :size]])
        for variable, flags in zip(rows, table, strict=True):
            made[variable.reference] += _named(group, flags)
    return {reference: sorted(known) for reference, known in made.items()}


def _named(variables: Sequence[Variable], flags: Flags) -> list[int]:
    return [v.reference for v, flag in zip(variables, flags, strict=True) if flag]

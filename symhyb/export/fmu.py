"""An FMU: description, sources and libraries in one archive.

Source: FMI 2.0.4 and 3.0.1, https://fmi-standard.org.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

from symhyb.errors import InputError, Problem
from symhyb.export.build import PLATFORMS, headers, require_platforms, shared_library
from symhyb.export.c_code import fmu_code, token_of
from symhyb.export.description import KINDS, build_description, model_description
from symhyb.export.pack import archive
from symhyb.export.spec import Spec

VERSIONS = (2, 3)


def fmu(
    spec: Spec,
    fmi: int = 2,
    kinds: Sequence[str] | None = None,
    platforms: Sequence[str] = (),
) -> bytes:
    """The archive of an FMU for co-simulation (``cs``) and model exchange (``me``, with events that
    alone), with libraries for the ``platforms`` (default: all that can be compiled for here) and
    the sources.

    The same export gives the same bytes, with the same compilers.

    Raises:
        InputError: a version, kind or platform that is not known, no compiler, or a kind that
            cannot have events.
    """
    kinds = kinds_of(spec.events, kinds)
    _require(fmi, kinds)
    chosen = require_platforms(platforms)
    headers()
    token = token_of(fmu_code(spec, fmi, "") + model_description(spec, fmi, "", kinds))
    code, name = fmu_code(spec, fmi, token), spec.identifier
    files: dict[str, str | bytes] = {
        "modelDescription.xml": model_description(spec, fmi, token, kinds),
        f"sources/{name}.c": code,
    }
    if fmi == 3:
        files["sources/buildDescription.xml"] = build_description(spec)
    with ThreadPoolExecutor(max(len(chosen), 1)) as side_by_side:
        made = side_by_side.map(lambda target: shared_library(code, name, target), chosen)
    for target, library in zip(chosen, made, strict=True):
        at = PLATFORMS[target]
        folder = at.fmi2 if fmi == 2 else at.fmi3
        files[f"binaries/{folder}/{name}{at.suffix}"] = library
    return archive(files)


def kinds_of(events: bool, kinds: Sequence[str] | None) -> Sequence[str]:
    """The kinds of an FMU: those asked for, else all that there can be.

    Raises:
        InputError: co-simulation with events.
    """
    if kinds is None:
        return ("me",) if events else ("cs", "me")
    if events and "cs" in kinds:
        text = (
            "events are located by the solver of an importer, in model exchange; co-simulation "
            "brings its own and needs none: ask for --kinds me, or leave out --events"
        )
        raise InputError(Problem(text))
    return kinds


def _require(fmi: int, kinds: Sequence[str]) -> None:
    problems = []
    if fmi not in VERSIONS:
        problems.append(Problem(f"FMI {fmi} is not known; known: 2, 3"))
    unknown = [kind for kind in kinds if kind not in KINDS]
    problems += [Problem(f"'{kind}' is no kind of FMU; known: cs, me") for kind in unknown]
    if not kinds:
        problems.append(Problem("an FMU needs a kind: cs, me or both"))
    if problems:
        raise InputError(problems)

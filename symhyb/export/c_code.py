"""C of an export: the core that an FMU wraps, and plain C with a header and a check of itself."""

import hashlib
import re
from collections.abc import Iterable, Mapping
from importlib.resources import files

import numpy as np

from symhyb.export.functions.exported import c_source, functions
from symhyb.export.spec import Spec
from symhyb.numeric.kernels.buffers import Array

SAMPLES = 20
TOLERANCE = 1e-13  # of the largest value: other C libraries round tanh and exp differently


def part(name: str, events: bool = False) -> str:
    """A C file of this package. What stands under ``#ifdef EVENTS`` is there with ``events``
    alone: code that can do without is the same as if there were no such thing."""
    text = (files("symhyb.export") / name).read_text(encoding="utf-8")
    return re.sub(
        r"#ifdef EVENTS\n(.*?)(?:#else\n(.*?))?#endif\n",
        lambda found: (found[1] if events else found[2]) or "",
        text,
        flags=re.DOTALL,
    )


def filled(name: str, values: Mapping[str, str]) -> str:
    """A C file of this package with ``values`` in place of its @KEYS@."""
    text = part(name)
    for key, value in values.items():
        text = text.replace(f"@{key}@", value)
    return text


_PLAIN = str.maketrans({"*": "·", "\\": "/"})


def model_code(spec: Spec) -> str:
    """The functions of the model and their sizes, C99."""
    exported = spec.exported
    made = functions(exported)
    sizes = {
        "N_U": len(exported.inputs),
        "N_Y": len(exported.outputs),
        "N_X": len(exported.states),
        "N_Z": exported.inner,
        "N_P": len(exported.parameters),
        **({"N_I": exported.indicators, "N_M": len(exported.ways)} if exported.ways else {}),
        "SZ_ARG": max(5, *(f.sz_arg() for f in made)),
        "SZ_RES": max(2, *(f.sz_res() for f in made)),
        "SZ_IW": max(1, *(f.sz_iw() for f in made)),
        "SZ_W": max(1, *(f.sz_w() for f in made)),
    }
    lines = [
        f"/* {spec.identifier}: {comment(spec.title)}. Everything is in SI. */",
        "#define CASADI_SYMBOL_EXPORT static inline /* no warnings about what is not called */",
        c_source(exported, spec.identifier),
        *(f"#define {name} {size}" for name, size in sizes.items()),
    ]
    return "\n".join(lines) + "\n"


def token_of(text: str) -> str:
    """The name by which an importer knows that description and code belong together."""
    digest = hashlib.sha256(text.encode()).hexdigest()
    return f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"


def fmu_code(spec: Spec, fmi: int, token: str) -> str:
    """One C file that is the whole FMU; the headers of the standard are not part of it."""
    stamp = int(hashlib.sha256(token.encode()).hexdigest()[:13], 16)
    nominal = [spec.nominal(v) for v in spec.of_role("state")]
    return "\n".join(
        (
            f"#define FMI{fmi}_FUNCTION_PREFIX_WANTED {spec.identifier}_",
            model_code(spec),
            f'#define TOKEN "{token}"',
            f"#define STAMP {stamp}.0",
            array("START", (v.start for v in spec.variables)),
            array("NOMINAL", nominal),
            *([array("WAYS", spec.exported.ways)] if spec.events else []),
            part("core.c", spec.events),
            part(f"fmi{fmi}.c", spec.events),
        )
    )


def c_files(spec: Spec) -> dict[str, str]:
    """Plain C: header, code, and a program that checks the code on stored samples."""
    name = spec.identifier
    return {
        f"{name}.h": _header(spec),
        f"{name}.c": _plain(spec),
        f"{name}_check.c": _check(spec),
    }


def _header(spec: Spec) -> str:
    name, upper = spec.identifier, spec.identifier.upper()
    e = spec.exported
    sizes = (("NX", e.states), ("NU", e.inputs), ("NY", e.outputs), ("NP", e.parameters))
    listed = [
        f"   {v.role:9} {v.name} [{v.unit.text}] {comment(v.about)}"
        for v in spec.variables
        if v.role not in ("time", "rate")
    ]
    sign = (
        [] if spec.whole else ["   The outputs dF act: a host adds +dF to its applied forces.", ""]
    )
    return "\n".join(
        (
            f"/* {name}: {comment(spec.title)}",
            "",
            "     x', y = f(t, x, u, p)      in SI, arrays in this order:",
            "",
            *listed,
            "",
            *sign,
            "   Safe to call from several threads; nothing is global. */",
            f"#ifndef {upper}_H",
            f"#define {upper}_H",
            *(f"#define {upper}_{size} {len(names)}" for size, names in sizes),
            '#ifdef __cplusplus\nextern "C" {\n#endif',
            f"extern const double {name}_p[{max(1, len(e.parameters))}]; /* values found */",
            f"extern const double {name}_x[{max(1, len(e.states))}]; /* where states start */",
            f"int {name}_eval(double t, const double *x, const double *u, const double *p,",
            "    double *dx, double *y); /* 0, or 1 where a value is not finite */",
            f"void {name}_rest(double t, const double *u, const double *p, double *x);",
            "    /* sets the inner states in x to those of a machine that stands still */",
            f"void {name}_forward(double t, const double *x, const double *u, const double *p,",
            "    const double *seed, double *dx, double *y); /* along a seed (t, x, u, p) */",
            "#ifdef __cplusplus\n}\n#endif",
            "#endif",
            "",
        )
    )


def _plain(spec: Spec) -> str:
    name, e = spec.identifier, spec.exported
    values = array(f"{name}_p", e.p, "const double"), array(f"{name}_x", e.x, "const double")
    return "\n".join(
        (
            f'#include "{name}.h"',
            model_code(spec),
            *values,
            part("plain.c").replace("NAME", name),
        )
    )


def samples(spec: Spec, count: int, seed: int = 1) -> tuple[Array, Array, Array]:
    """Random t (N,), x (N, X) and u (N, U) about their starts, N = ``count``, SI."""
    rng, e = np.random.default_rng(seed), spec.exported
    t = rng.uniform(0, 10, count)
    x = e.x + rng.normal(0, 1, (count, e.x.size)) * np.maximum(np.abs(e.x), 0.1)
    u = e.u + rng.normal(0, 1, (count, e.u.size)) * np.maximum(np.abs(e.u), 1.0)
    return t, x, u


def _check(spec: Spec) -> str:
    """The program that compares the code with values computed at export."""
    name, e = spec.identifier, spec.exported
    t, x, u = samples(spec, SAMPLES)
    rows = []
    for i in range(SAMPLES):
        rates, y = e.evaluate(t[i], x[i], u[i], e.p)
        rows.append(np.concatenate([[t[i]], x[i], u[i], rates, y]))
    return "\n".join(
        (
            f"/* Compile with {name}.c and run: says how well the code agrees with symhyb. */",
            f'#include "{name}.h"',
            f"enum {{ NX = {e.x.size}, NU = {e.u.size}, NY = {len(e.outputs)}, "
            f"SAMPLES = {SAMPLES} }};",
            f"#define ALLOWED {TOLERANCE:g}",
            array("SAMPLE", np.concatenate(rows)),
            part("check.c").replace("NAME", name),
        )
    )


def array(name: str, values: Iterable[float], kind: str = "static const double") -> str:
    """A C array; never of length 0, which C does not know."""
    listed = [repr(float(value)) for value in values] or ["0.0"]
    lines = [", ".join(listed[i : i + 6]) for i in range(0, len(listed), 6)]
    return f"{kind} {name}[{len(listed)}] = {{\n  " + ",\n  ".join(lines) + "\n};"


def comment(text: str) -> str:
    """Text that stays within a comment: without stars it cannot end one, without backslashes and
    trigraphs (``??/``) it cannot join lines, and what cannot be printed is a space."""
    shown = "".join(letter if letter.isprintable() else " " for letter in text)
    return re.sub(r"\?(?=\?)", "? ", " ".join(shown.translate(_PLAIN).split()))

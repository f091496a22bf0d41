"""Machines that other programs made into FMUs: a cart with a pendulum from Modelica (rumoca, FMI 2)
and from Python (pythonfmu3, FMI 3), and two masses from matrices (qfmu, FMI 2).

The owner's FMU lacks a force that the FMU of the real machine has. FMPy runs that one, noise is
added, and symhyb diagnoses the recording with the owner's. What drives the real cart is written
into its FMU, for FMPy holds inputs over the steps of its solver. The masses swing freely. Keeps one
JSON a case; resumable.

    python studies/fmu/foreign.py [--makers rumoca pythonfmu3 qfmu] --seeds 1-2 [-o build/foreign]
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import fmpy
import numpy as np
import pandas as pd

import symhyb as sh
from symhyb.data.hosts.fmu_answers import TRUST

HERE = Path(__file__).parent
sys.path.append(str(HERE.parent / "concealed"))

from plans import seeds_of  # noqa: E402

SECONDS, STEP = 15.0, 0.005
NOISE = 1e-3  # m and rad, of both sensors
LINES = np.linspace(0.3, 4.0, 12)  # Hz, of the force on the machine

MODELICA = """model Cart "A cart on a spring, from which a pendulum hangs"
  parameter Real M = 2.0; parameter Real m = 0.7; parameter Real l = 0.5;
  parameter Real k = 60.0; parameter Real g = 9.81;
  input Real f; input Real fx; input Real tau;
  Real x(start = 0.1); Real phi(start = 0.3); Real v; Real w;
equation
  der(x) = v;
  der(phi) = w;
  (M + m)*der(v) + m*l*cos(phi)*der(w) = m*l*sin(phi)*w*w - k*x + f + fx + (LAW_X);
  m*l*cos(phi)*der(v) + m*l*l*der(w) = -m*g*l*sin(phi) + tau + (LAW_PHI);
end Cart;
"""
PYTHON = '''from math import cos, sin, tanh

from pythonfmu3 import Float64, Fmi3Causality, Fmi3SlaveBase, Fmi3Variability, ModelExchange

PARAMETERS = {"M": 2.0, "m": 0.7, "l": 0.5, "k": 60.0, "g": 9.81}


class Cart(Fmi3SlaveBase, ModelExchange):
    """A cart on a spring, from which a pendulum hangs."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time = 0.0
        self.x, self.phi, self.v, self.w = 0.1, 0.3, 0.0, 0.0
        self.dx, self.dphi, self.dv, self.dw = 0.0, 0.0, 0.0, 0.0
        self.f, self.fx, self.tau = 0.0, 0.0, 0.0
        moving, fixed = Fmi3Variability.continuous, Fmi3Variability.fixed
        self.register_variable(
            Float64("time", causality=Fmi3Causality.independent, variability=moving)
        )
        for name in ("x", "phi", "v", "w"):
            self.register_variable(
                Float64(name, causality=Fmi3Causality.output, variability=moving)
            )
        for k, name in enumerate(("dx", "dphi", "dv", "dw"), start=1):
            self.register_variable(
                Float64(name, causality=Fmi3Causality.local, variability=moving, derivative=k)
            )
        for name in ("f", "fx", "tau"):
            self.register_variable(
                Float64(name, causality=Fmi3Causality.input, variability=moving)
            )
        for name, value in PARAMETERS.items():
            setattr(self, name, value)
            self.register_variable(
                Float64(name, causality=Fmi3Causality.parameter, variability=fixed)
            )

    def get_continuous_state_derivatives(self):
        x, phi, v, w = self.x, self.phi, self.v, self.w
        ml, a, b = self.m * self.l, self.M + self.m, self.m * self.l * self.l
        c = ml * cos(phi)
        p = ml * sin(phi) * w * w - self.k * x + self.f + self.fx + (LAW_X)
        q = -ml * self.g * sin(phi) + self.tau + (LAW_PHI)
        d = a * b - c * c
        self.dx, self.dphi, self.dv, self.dw = v, w, (b * p - c * q) / d, (a * q - c * p) / d
        return [self.dx, self.dphi, self.dv, self.dw]
'''
CART = """symhyb = 1
title = "A cart with a pendulum, from {maker}"
[fmu]
file = "closed.fmu"
[fmu.coordinates]
x = {{ position = "x", rate = "v", force = "fx" }}
phi = {{ position = "phi", rate = "w", force = "tau" }}
[fmu.inputs]
f = "f"
[fmu.parameters]
k = "k"
[coordinates]
x = {{ unit = "m" }}
phi = {{ unit = "rad" }}
[parameters]
k = {{ value = 60.0, sd = 1.0, unit = "N/m" }}
[inputs]
f = {{ unit = "N" }}
[sensors]
x = {{ measures = "x", unit = "m" }}
phi = {{ measures = "phi", unit = "rad" }}
"""
MASSES = """symhyb = 1
title = "Two masses between springs, from qfmu"
[fmu]
file = "closed.fmu"
[fmu.coordinates]
x = { position = "x1", rate = "x3", force = "u1" }
y = { position = "x2", rate = "x4", force = "u2" }
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
[sensors]
x = { measures = "x", unit = "m" }
y = { measures = "y", unit = "m" }
"""
NOTHING, TIED = "nothing", "viscous damping between the masses"
LAWS = {  # what the real cart has in addition: on the cart, on the pendulum; SI, in both languages
    NOTHING: ("0", "0"),
    "dry friction on the cart": ("-1.0*tanh(v/0.002)", "0"),
    "quadratic drag on the pendulum": ("0", "-0.03*w*abs(w)"),
    "hardening spring on the cart": ("-800*x*x*x", "0"),
}


class Maker(NamedTuple):
    """A program: how it makes an FMU with a law and a drive, those laws, the model file, by column
    of the recording the variable of the FMU, and whether the drive is recorded."""

    make: Callable[[str, str, Path], Path]
    laws: tuple[str, ...]
    text: str
    columns: dict[str, str]
    driven: bool


def of_rumoca(law: str, drive: str, folder: Path) -> Path:
    """The cart by rumoca, built by the script that it writes."""
    import rumoca

    on_cart, on_pendulum = LAWS[law]
    text = MODELICA.replace("LAW_X", on_cart + drive.replace("TIME", "time"))
    text = text.replace("LAW_PHI", on_pendulum)
    rumoca.Session().loads(text, model="Cart").codegen("fmi2").save_all(str(folder))
    subprocess.run(["sh", "build.sh"], cwd=folder, check=True, capture_output=True)
    return folder / "Cart.fmu"


def of_pythonfmu3(law: str, drive: str, folder: Path) -> Path:
    """The cart by pythonfmu3, which packs the Python that computes it; in one process scripts of
    the same name are one module, so that each has its own."""
    from pythonfmu3.builder import FmuBuilder

    on_cart, on_pendulum = LAWS[law]
    script = folder / f"{folder.parent.name}_{folder.name}.py"
    text = PYTHON.replace("LAW_X", on_cart + drive.replace("TIME", "self.time"))
    script.write_text(text.replace("LAW_PHI", on_pendulum), encoding="utf-8")
    return Path(FmuBuilder.build_FMU(script, dest=folder, needsExecutionTool="false"))


def of_qfmu(law: str, _: str, folder: Path) -> Path:
    """Masses of 2 and 1 kg on springs of 300, 200 and 150 N/m, by the program qfmu."""
    inertia = np.diag([2.0, 1.0])
    stiffness = np.array([[500.0, -200.0], [-200.0, 350.0]])
    damping = 1.5 * (law == TIED) * np.array([[1.0, -1.0], [-1.0, 1.0]])
    inverse, zero = np.linalg.inv(inertia), np.zeros((2, 2))
    matrices = {
        "-A": np.block([[zero, np.eye(2)], [-inverse @ stiffness, -inverse @ damping]]),
        "-B": np.vstack([zero, inverse]),
        "-C": np.eye(4),
        "-x0": np.array([0.05, -0.02, 0.0, 0.0]),
    }
    words = [word for key, value in matrices.items() for word in (key, json.dumps(value.tolist()))]
    target = folder / "masses.fmu"
    command = ["qfmu", "ss", *words, "-o", str(target)]
    subprocess.run(command, check=True, capture_output=True)
    return target


MAKERS = {
    "rumoca": Maker(
        of_rumoca, tuple(LAWS), CART.format(maker="rumoca"), {"x": "x", "phi": "phi"}, True
    ),
    "pythonfmu3": Maker(
        of_pythonfmu3, tuple(LAWS), CART.format(maker="pythonfmu3"), {"x": "x", "phi": "phi"}, True
    ),
    "qfmu": Maker(of_qfmu, (NOTHING, TIED), MASSES, {"x": "x1", "y": "x2"}, False),
}


def drive_of(lines: np.ndarray) -> str:
    """Lines (L, 2) of 3 N, each a frequency in rad/s and a phase, as an expression in TIME."""
    return "".join(f" + 3*sin({w!r}*TIME + {phase!r})" for w, phase in lines.tolist())


def recorded(
    fmu: Path, maker: Maker, lines: np.ndarray, random: np.random.Generator
) -> pd.DataFrame:
    """What sensors show of the FMU of the real machine."""
    ran = fmpy.simulate_fmu(
        str(fmu),
        validate=False,
        fmi_type="ModelExchange",
        stop_time=SECONDS,
        output_interval=STEP,
        relative_tolerance=1e-9,
        output=list(maker.columns.values()),
        record_events=False,
    )
    shown = {
        name: ran[variable] + NOISE * random.standard_normal(len(ran))
        for name, variable in maker.columns.items()
    }
    run = pd.DataFrame({"t": ran["time"], **shown}).set_index("t")
    if maker.driven:
        run["f"] = 3 * np.sin(lines[:, 0] * run.index.to_numpy()[:, None] + lines[:, 1]).sum(axis=1)
    return run


def one(name: str, law: str, seed: int, folder: Path) -> dict[str, Any]:
    """The owner's FMU and that of the real machine, a recording, and what is named."""
    maker, random = MAKERS[name], np.random.default_rng(seed)
    lines = np.column_stack([2 * np.pi * LINES, random.uniform(0, 2 * np.pi, LINES.size)])
    for part, which, driven in (("closed", NOTHING, ""), ("real", law, drive_of(lines))):
        (folder / part).mkdir(parents=True, exist_ok=True)
        maker.make(which, driven, folder / part).replace(folder / f"{part}.fmu")
    (folder / "machine.toml").write_text(maker.text, encoding="utf-8")
    recorded(folder / "real.fmu", maker, lines, random).to_csv(folder / "run.csv")
    model = sh.read_model(folder / "machine.toml")
    begin = time.perf_counter()
    diagnosis = sh.diagnose(model, sh.read_recording(folder / "run.csv", model))
    return {
        "maker": name,
        "law": law,
        "seed": seed,
        "verdict": diagnosis.verdict,
        "sentence": diagnosis.sentence,
        "seconds": round(time.perf_counter() - begin, 1),
    }


def main() -> None:
    """Run cases and print a line a case."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--makers", nargs="+", default=list(MAKERS), choices=list(MAKERS))
    parser.add_argument("--seeds", default="1")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/foreign"))
    options = parser.parse_args()
    os.environ[TRUST] = "1"  # they are made here
    for name in options.makers:
        for number, law in enumerate(MAKERS[name].laws):
            for seed in seeds_of(options.seeds):
                folder = options.output / f"{name}_{number}_{seed}"
                kept = folder / "result.json"
                if not kept.exists():
                    row = one(name, law, seed, folder)
                    kept.write_text(json.dumps(row, indent=1) + "\n", encoding="utf-8")
                row = json.loads(kept.read_text(encoding="utf-8"))
                print(name, f"{law}:", row["sentence"], f"({row['seconds']} s)", flush=True)


if __name__ == "__main__":
    main()

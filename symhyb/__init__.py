"""symhyb: find, name and model the physics that a mechanical model leaves out.

Names are imported when first used, so ``import symhyb`` costs nothing; ``__init__.pyi`` says the
same to type checkers and editors.
"""

from importlib import import_module
from typing import Any

_HOMES = {
    "symhyb.model.read": ("parse_model", "read_model"),
    "symhyb.model.write": ("write_model",),
    "symhyb.model.diff": ("diff",),
    "symhyb.mechanics.methods.from_sympy": ("from_sympy",),
    "symhyb.model.types": ("Model",),
    "symhyb.data.recording": ("Recording", "read_recording"),
    "symhyb.numeric.lowered.machine": ("Machine", "build"),
    "symhyb.running": ("simulate",),
    "symhyb.numeric.runs.scenario": ("Scenario",),
    "symhyb.optimisation.rollout": ("Rollout",),
    "symhyb.optimisation.objective": ("Objective",),
    "symhyb.discrepancy.recorded.residual": ("Discrepancy", "compare"),
    "symhyb.discrepancy.results": ("Diagnosis", "Found", "Verdict"),
    "symhyb.discrepancy.fitting.judge": ("judge",),
    "symhyb.correction.apply": ("apply",),
    "symhyb.correction.finish": ("finished",),
    "symhyb.correction.learning.remainder": ("remainder",),
    "symhyb.correction.learning.network": ("train_network",),
    "symhyb.diagnosis": ("diagnose",),
    "symhyb.learning": ("learn",),
    "symhyb.study.run": ("run_study",),
    "symhyb.report.files": ("write_diagnosis", "write_report", "write_simulation"),
    "symhyb.errors": ("InputError", "NumericsError", "Problem"),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__version__ = "0.1.0"
__all__ = (
    "Diagnosis",
    "Discrepancy",
    "Found",
    "InputError",
    "Machine",
    "Model",
    "NumericsError",
    "Objective",
    "Problem",
    "Recording",
    "Rollout",
    "Scenario",
    "Verdict",
    "apply",
    "build",
    "compare",
    "diagnose",
    "diff",
    "finished",
    "from_sympy",
    "judge",
    "learn",
    "parse_model",
    "read_model",
    "read_recording",
    "remainder",
    "run_study",
    "simulate",
    "train_network",
    "write_diagnosis",
    "write_model",
    "write_report",
    "write_simulation",
)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'symhyb' has no attribute '{name}'")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted((*globals(), *_HOME))

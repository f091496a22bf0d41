from symhyb.correction.apply import apply as apply
from symhyb.correction.finish import finished as finished
from symhyb.correction.learning.network import train_network as train_network
from symhyb.correction.learning.remainder import remainder as remainder
from symhyb.data.recording import Recording as Recording
from symhyb.data.recording import read_recording as read_recording
from symhyb.diagnosis import diagnose as diagnose
from symhyb.discrepancy.fitting.judge import judge as judge
from symhyb.discrepancy.recorded.residual import Discrepancy as Discrepancy
from symhyb.discrepancy.recorded.residual import compare as compare
from symhyb.discrepancy.results import Diagnosis as Diagnosis
from symhyb.discrepancy.results import Found as Found
from symhyb.discrepancy.results import Verdict as Verdict
from symhyb.errors import InputError as InputError
from symhyb.errors import NumericsError as NumericsError
from symhyb.errors import Problem as Problem
from symhyb.learning import learn as learn
from symhyb.mechanics.methods.from_sympy import from_sympy as from_sympy
from symhyb.model.diff import diff as diff
from symhyb.model.read import parse_model as parse_model
from symhyb.model.read import read_model as read_model
from symhyb.model.types import Model as Model
from symhyb.model.write import write_model as write_model
from symhyb.numeric.lowered.machine import Machine as Machine
from symhyb.numeric.lowered.machine import build as build
from symhyb.numeric.runs.scenario import Scenario as Scenario
from symhyb.optimisation.objective import Objective as Objective
from symhyb.optimisation.rollout import Rollout as Rollout
from symhyb.report.files import write_diagnosis as write_diagnosis
from symhyb.report.files import write_report as write_report
from symhyb.report.files import write_simulation as write_simulation
from symhyb.running import simulate as simulate
from symhyb.study.run import run_study as run_study

__version__: str
__all__ = [
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
]

"""What this bench takes from the bench of concealed effects, whose scripts lie in ../concealed.

That folder goes to the end of the path, so that scripts of the same name here come first.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "concealed"))

from claims import Claim, alternatives, claimed  # noqa: E402
from conceal import signal_of, start_of  # noqa: E402
from diagnosing import commit, diagnose  # noqa: E402
from laws import Array  # noqa: E402
from plans import seeds_of  # noqa: E402
from plant import Signal, UnboundedError  # noqa: E402
from seal import seal, unseal  # noqa: E402
from systems import Drive, System, Values, constant_mass, parts  # noqa: E402

__all__ = [
    "HERE",
    "Array",
    "Claim",
    "Drive",
    "Signal",
    "System",
    "UnboundedError",
    "Values",
    "alternatives",
    "claimed",
    "commit",
    "constant_mass",
    "diagnose",
    "parts",
    "seal",
    "seeds_of",
    "signal_of",
    "start_of",
    "unseal",
]

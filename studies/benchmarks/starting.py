"""How long it takes until symhyb is there, against the libraries that it stands on."""

import subprocess
import sys
from collections.abc import Callable

from timing import Row, in_turns, middle, milliseconds

HELP = "import sys; sys.argv = ['symhyb', '--help']; from symhyb.cli.app import main; main()"
PROGRAMS = {
    "help": HELP,
    "sympy": "import sympy",
    "symhyb": "import symhyb",
    "casadi, numpy": "import casadi, numpy",
    "simulate": "import symhyb; symhyb.simulate",
}


def started(program: str) -> Callable[[], object]:
    """Run a program in a fresh interpreter."""
    return lambda: subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)


def rows(repeats: int = 15) -> list[Row]:
    """Bars of starting."""
    times = middle(in_turns({name: started(code) for name, code in PROGRAMS.items()}, repeats))

    def against(ours: str, theirs: str) -> tuple[float, str]:
        note = f"{milliseconds(times[ours])}, {milliseconds(times[theirs])}"
        return times[ours] / times[theirs], note

    shown, shown_note = against("help", "sympy")
    loaded, loaded_note = against("symhyb", "casadi, numpy")
    ready, ready_note = against("simulate", "casadi, numpy")
    part = "start-up"
    return [
        Row(part, "symhyb --help over import sympy", shown, 0.7, False, "×", shown_note),
        Row(part, "import symhyb over import casadi, numpy", loaded, 1.3, False, "×", loaded_note),
        Row(part, "the same with symhyb.simulate asked for", ready, None, False, "×", ready_note),
    ]

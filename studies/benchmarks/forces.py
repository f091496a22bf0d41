r"""ΔF along ten million samples, against the rate at which memory is copied and against NumPy.

    ΔF = m a + c q + d v + R tanh(v/w) − u          (q, v, a, u, t) -> ΔF, 48 bytes a sample

Where there is a compiler the time may be twice that of copying as many bytes; without one NumPy is
the measure, whole arrays at a time. Each case runs in a process of its own, for its own memory and
compiler:

    python studies/benchmarks/forces.py compiled 10000000 9
"""

import json
import os
import resource
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from timing import Row, Work, in_turns, middle, milliseconds

from symhyb.model.read import parse_model, read_model
from symhyb.numeric.kernels.instructions import NOTHING, program
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.kernels.vector_numpy import WORK
from symhyb.numeric.lowered.machine import Machine, build

Array = NDArray[np.float64]
MODELS = Path(__file__).parents[2] / "models"
TEXT = """
symhyb = 1
title = "oscillator"
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 1.0, unit = "kg" }
c = { value = 100.0, unit = "N/m" }
d = { value = 0.5, unit = "N*s/m" }
R = { value = 0.4905, unit = "N" }
w = { value = 1e-3, unit = "m/s" }
[inputs]
f = { unit = "N" }
[bodies]
block = { mass = "m", at = ["x", "0"] }
[elements]
spring = { kind = "spring", on = "x", stiffness = "c" }
damper = { kind = "damper", on = "x", damping = "d" }
rail = { kind = "friction", on = "x", coulomb = "R", transition = "w" }
shaker = { kind = "force", on = "x", force = "f" }
"""
HELD = (6,)  # the parameters


def oscillator() -> Machine:
    """One coordinate, one input."""
    return build(parse_model(TEXT, "oscillator.toml"))


def arguments_of(machine: Machine, samples: int) -> list[Array]:
    """A motion (N, rows each) in the order of ``machine.discrepancy``: q, v, a, z, u, t, p."""
    rng, function = np.random.default_rng(3), machine.discrepancy
    rows = [function.size1_in(i) for i in range(function.n_in() - 1)]
    return [*(rng.uniform(-1.0, 1.0, (samples, wide)) for wide in rows), machine.values]


def whole_arrays(machine: Machine, arguments: Sequence[Array]) -> Array:
    """ΔF of the oscillator as one writes it in NumPy."""
    q, v, a, _, u, _, (m, c, d, level, width) = arguments
    return np.asarray(m * a + c * q + d * v + level * np.tanh(v / width) - u)


def straight_line(function: ca.Function, arguments: Sequence[Array]) -> list[Array]:
    """Any function in NumPy, instruction by instruction, whole arrays at a time."""
    code = program(function)
    assert code is not None
    values: dict[int, Array] = {}
    for value, i, entry in code.loads:
        values[value] = arguments[i][entry] if i in HELD else arguments[i][:, entry]
    values.update({value: np.float64(number) for value, number in code.constants})
    for value, operation, left, right in code.steps:
        work = WORK[operation]
        values[value] = (
            work(values[left]) if right == NOTHING else work(values[left], values[right])
        )
    return [values[value] for _, _, value in code.stores]


def measured(case: str, samples: int, repeats: int) -> dict[str, float]:
    """Times in s, and for the case *compiled* memory as a share of inputs and outputs."""
    if case == "compiled":
        return _compiled(oscillator(), samples, repeats)
    machine = oscillator() if case == "oscillator" else build(read_model(MODELS / f"{case}.toml"))
    function, arguments = machine.discrepancy, arguments_of(machine, samples)
    contenders: dict[str, Work] = {
        "ours": lambda: along(function, arguments, HELD),
        "numpy": lambda: straight_line(function, arguments),
    }
    if case == "oscillator":
        contenders["written"] = lambda: whole_arrays(machine, arguments)
    return middle(in_turns(contenders, repeats))


def _compiled(machine: Machine, samples: int, repeats: int) -> dict[str, float]:
    function, small = machine.discrepancy, arguments_of(machine, 3_000_000)
    along(function, small, HELD)  # the first use of a machine pays for what is compiled
    del small
    before = _resident()
    arguments = arguments_of(machine, samples)
    held = sum(a.nbytes for a in arguments) + 8 * samples * function.size1_out(0)
    along(function, arguments, HELD)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 - before
    source = np.ones(held // 16)  # reading and writing half as much moves as many bytes
    target = np.ones_like(source)
    contenders: dict[str, Work] = {
        "ours": lambda: along(function, arguments, HELD),
        "copy": lambda: np.copyto(target, source),
        "copy to new": lambda: source.copy(),
    }
    return {**middle(in_turns(contenders, repeats)), "memory": peak / held}


def _resident() -> int:
    """Bytes of memory that this process occupies."""
    pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[1]
    return int(pages) * resource.getpagesize()


def apart(case: str, samples: int, repeats: int, **settings: str) -> dict[str, float]:
    """:func:`measured` in a process of its own, with these environment variables."""
    command = [sys.executable, __file__, case, str(samples), str(repeats)]
    environment = {**os.environ, **settings}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    result: dict[str, float] = json.loads(done.stdout)
    return result


def rows(samples: int = 10_000_000, repeats: int = 9) -> list[Row]:
    """Bars of ΔF over a long recording."""
    name = f"ΔF, {samples:.0e} samples".replace("e+0", "e")
    fast = apart("compiled", samples, repeats)
    slow = apart("oscillator", samples, repeats, SYMHYB_CC="")
    small = apart("oscillator", samples, repeats, SYMHYB_CC="", NUMPY_MADVISE_HUGEPAGE="0")
    times = milliseconds(fast["ours"]), milliseconds(fast["copy"])
    result = [
        Row(
            name,
            "oscillator, with a compiler: rate over the rate of a copy",
            fast["copy"] / fast["ours"],
            0.5,
            True,
            "×",
            f"{times[0]}; copy {times[1]}",
        ),
        Row(
            name,
            "the same over the rate of a copy into new memory, which is what a result is",
            fast["copy to new"] / fast["ours"],
            None,
            True,
            "×",
            milliseconds(fast["copy to new"]),
        ),
        Row(name, "peak of memory over inputs and output", fast["memory"], 2, False, "×"),
        Row(
            name,
            "oscillator, without a compiler: time of NumPy, the same instructions on whole "
            "arrays, over ours",
            slow["numpy"] / slow["ours"],
            4,
            True,
            "×",
            f"{milliseconds(slow['numpy'])}, {milliseconds(slow['ours'])}",
        ),
        Row(
            name,
            "the same with the law written by hand in NumPy",
            slow["written"] / slow["ours"],
            None,
            True,
            "×",
            milliseconds(slow["written"]),
        ),
        Row(
            name,
            "the first of these where NumPy gets no huge pages of memory",
            small["numpy"] / small["ours"],
            None,
            True,
            "×",
            f"{milliseconds(small['numpy'])}, {milliseconds(small['ours'])}",
        ),
    ]
    fewer = samples // 10
    for case in ("pendulum", "double_pendulum", "pendulum_on_cart", "quarter_car"):
        other = apart(case, fewer, repeats, SYMHYB_CC="")
        result.append(
            Row(
                name,
                f"{case.replace('_', ' ')}, the same over a tenth of the samples",
                other["numpy"] / other["ours"],
                1,
                True,
                "×",
                f"{milliseconds(other['numpy'])}, {milliseconds(other['ours'])}",
            )
        )
    return result


if __name__ == "__main__":
    print(json.dumps(measured(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))))

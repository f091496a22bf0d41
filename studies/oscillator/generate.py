"""Make the concealed recordings of the oscillator, with dry friction solved exactly.

    m q'' + c q^3 + d |q'| q' + m g mu sgn q' = f(t)

    --> q, f         the spring and the friction both act against q and q'
    [ m ]~~ c q^3 ~~|

Needs NumPy and SciPy and nothing else, least of all the program that is to be judged by it.
Between two reversals the right-hand side is smooth, so DOP853 is exact to its tolerance there;
every reversal, stick and release is located as an event, not smeared by a smooth sign.

    python studies/oscillator/generate.py           # writes beside this file
    python studies/oscillator/generate.py --null    # nothing concealed: writes studies/null
"""

import argparse
import base64
import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

HERE = Path(__file__).resolve().parent
SAMPLE_RATE = 100.0  # Hz
NOISE = 0.015  # standard deviation of the noise, as a part of the maximum of its channel
TOLERANCES = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-12, "max_step": 0.01}


@dataclass(frozen=True, slots=True)
class Oscillator:
    """The law that makes the recordings: kg, N/m^3, N*s^2/m^2, N."""

    mass: float = 1.0
    cubic: float = 100.0
    drag: float = 0.8
    coulomb: float = 0.4905  # m g mu = 1 kg * 9.81 m/s^2 * 0.05


@dataclass(frozen=True, slots=True)
class Run:
    """One recording: ``amplitude`` N, ``frequency`` Hz, ``duration`` and ``burst`` s.

    With ``burst`` the force swells and fades within that time and is zero afterwards; without it
    the sine lasts to the end.
    """

    file: str
    amplitude: float
    frequency: float
    duration: float
    seed: int
    burst: float | None = None

    def force(self, t: np.ndarray | float) -> np.ndarray | float:
        """The applied force in N at times ``t`` in s."""
        sine = self.amplitude * np.sin(2 * np.pi * self.frequency * t)
        if self.burst is None:
            return sine
        swell = np.sin(np.pi * np.minimum(t, self.burst) / self.burst) ** 2
        return sine * swell


# Chosen before any diagnosis was run: near and above the resonance of the hard spring, so that the
# mass slides most of the time and passes through many speeds on the way to its steady orbit.
CONCEALED = (
    Run("train.csv", amplitude=5.0, frequency=0.5, duration=40.0, seed=20240501),
    Run("holdout.csv", amplitude=3.5, frequency=0.7, duration=20.0, seed=20240502),
)
# Nothing dissipates here: a burst near the resonance leaves a free oscillation for good.
NULL = (
    Run("train.csv", amplitude=2.0, frequency=0.5, duration=20.0, seed=20240503, burst=6.0),
    Run("holdout.csv", amplitude=3.0, frequency=0.6, duration=20.0, seed=20240504, burst=8.0),
)


def simulate(law: Oscillator, run: Run, t: np.ndarray) -> np.ndarray:
    """Solve the oscillator from rest; returns position and speed as (2, N) at the times ``t``."""
    out = np.zeros((2, t.size))
    now, state = t[0], np.zeros(2)
    while now < t[-1]:
        direction = _direction(law, run, now, state)
        later, state_later, solution = _segment(law, run, now, t[-1], state, direction)
        inside = (t >= now) & (t <= later)
        out[:, inside] = solution(t[inside])
        now, state = later, state_later
    return out


def _net(law: Oscillator, run: Run, t: float, q: float) -> float:
    """The force that friction has to hold, in N."""
    return float(run.force(t)) - law.cubic * q**3


def _direction(law: Oscillator, run: Run, t: float, state: np.ndarray) -> int:
    """Say which way the mass slides: +1, -1, or 0 when it sticks."""
    q, v = state
    if law.coulomb == 0.0:
        return 1  # nothing depends on the direction
    if v != 0.0:
        return int(np.sign(v))
    net = _net(law, run, t, q)
    # A release is located where |net| = coulomb to rounding: the margin keeps it from sticking on.
    return int(np.sign(net)) if abs(net) > law.coulomb * (1 - 1e-12) else 0


Solution = Callable[[np.ndarray], np.ndarray]


def _segment(
    law: Oscillator, run: Run, start: float, end: float, state: np.ndarray, direction: int
) -> tuple[float, np.ndarray, Solution]:
    """Solve until the next reversal or release; returns its time, the state there, the solution."""

    def slide(t: float, y: np.ndarray) -> list[float]:
        q, v = y
        resisting = law.drag * abs(v) * v + law.coulomb * direction
        return [v, (_net(law, run, t, q) - resisting) / law.mass]

    def stick(t: float, y: np.ndarray) -> list[float]:
        return [0.0, 0.0]

    def reversal(t: float, y: np.ndarray) -> float:
        return float(y[1]) * direction

    def release(t: float, y: np.ndarray) -> float:
        return law.coulomb - abs(_net(law, run, t, y[0]))

    event = reversal if direction else release
    event.terminal, event.direction = True, -1
    found = solve_ivp(
        slide if direction else stick,
        (start, end),
        state,
        dense_output=True,
        events=event if law.coulomb else None,
        **TOLERANCES,
    )
    if not found.success:
        raise RuntimeError(f"{run.file}: {found.message}")
    last = found.y[:, -1].copy()
    if found.status == 1:
        last[1] = 0.0  # the event says so, to rounding
    return float(found.t[-1]), last, found.sol


def record(law: Oscillator, run: Run) -> np.ndarray:
    """Return t [s], f [N], position [m], speed [m/s] as (N, 4); noise is on the last two alone."""
    t = np.arange(round(run.duration * SAMPLE_RATE) + 1) / SAMPLE_RATE
    clean = simulate(law, run, t)
    noise = np.random.default_rng(run.seed).standard_normal(clean.shape)
    measured = clean + NOISE * np.abs(clean).max(axis=1, keepdims=True) * noise
    return np.column_stack([t, run.force(t), *measured])


def answer(law: Oscillator) -> dict[str, object]:
    """Return what was concealed: keys are place.term, values in SI."""
    terms = {"q.coulomb": law.coulomb, "q.drag": law.drag}
    found = {term: value for term, value in terms.items() if value}
    return {
        "verdict": "missing physics" if found else "nothing missing",
        "found": found,
        "note": "Coulomb friction [N] and drag quadratic in speed [N*s^2/m^2]; keys are place.term",
    }


def seal(values: dict[str, object]) -> str:
    """Encode each value, so that nobody reads the answer by chance."""
    encoded = {
        key: base64.b64encode(json.dumps(value).encode()).decode() for key, value in values.items()
    }
    return json.dumps(encoded, indent=1) + "\n"


def write(law: Oscillator, runs: tuple[Run, ...], folder: Path) -> None:
    """Write the recordings and the sealed answer into ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    for run in runs:
        np.savetxt(
            folder / run.file,
            record(law, run),
            fmt="%.8g",
            delimiter=",",
            header="t,f,position,speed",
            comments="",
        )
    sealed = seal(answer(law))
    (folder / "sealed.json").write_text(sealed, encoding="ascii", newline="\n")
    print(f"{folder.name}/sealed.json has SHA-256 {hashlib.sha256(sealed.encode()).hexdigest()}")


def main() -> None:
    """Write the concealed recordings, or with ``--null`` those with nothing concealed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--null", action="store_true", help="conceal nothing; writes studies/null")
    parser.add_argument("-o", "--output", type=Path, help="folder; default: beside this file")
    options = parser.parse_args()
    if options.null:
        write(Oscillator(drag=0.0, coulomb=0.0), NULL, options.output or HERE.parent / "null")
    else:
        write(Oscillator(), CONCEALED, options.output or HERE)


if __name__ == "__main__":
    main()

"""What every seed asks for: the system, what is concealed, noise and sensing, before any draw.

Odd seeds conceal nothing; systems take turns. Seeds from 10000 on are for the machines whose
equations come from MuJoCo.
"""

from argparse import ArgumentParser
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from arm import ARM
from chains import FOUR_MASSES, QUARTER_CAR, ROTOR, SIX_MASSES, THREE_MASSES, TWO_MASSES
from effects import DULL, FORCES, NULLS
from systems import (
    CARTPOLE,
    DOUBLE_PENDULUM,
    DUFFING,
    OSCILLATOR,
    PENDULUM,
    RIG,
    SLED,
    TABLE,
    TWO_INERTIAS,
    VOLTS,
    System,
)

SYSTEMS = (
    OSCILLATOR,
    DUFFING,
    VOLTS,
    PENDULUM,
    SLED,
    RIG,
    CARTPOLE,
    DOUBLE_PENDULUM,
    TWO_INERTIAS,
    TABLE,
    QUARTER_CAR,
    TWO_MASSES,
    THREE_MASSES,
    ROTOR,
    FOUR_MASSES,
    SIX_MASSES,
)
ENGINE_SYSTEMS = (ARM,)
ENGINE_SEEDS = 10000  # the first of them
NOISES = (0.001, 0.005, 0.01, 0.02, 0.05, 0.1)
NOISE_WEIGHTS = (0.1, 0.15, 0.4, 0.1, 0.15, 0.1)


@dataclass(frozen=True, slots=True)
class Plan:
    """What a seed asks for, before anything is simulated."""

    seed: int
    system: System
    kind: str  # one of FORCES, DULL, NULLS, "two", "mixed"
    noise: float
    complete: bool  # rates are sensed too
    masked: bool


def system_of(seed: int) -> tuple[System, int]:
    """The system of a seed, and how often it had its turn before."""
    systems, pair = SYSTEMS, seed // 2
    if seed >= ENGINE_SEEDS:
        systems, pair = ENGINE_SYSTEMS, (seed - ENGINE_SEEDS) // 2
    turn, place = divmod(pair, len(systems))
    return systems[place], turn


def plan_of(seed: int) -> Plan:
    """The plan of a seed: odd seeds conceal nothing, systems take turns."""
    random = np.random.default_rng([seed, 1])
    system, _ = system_of(seed)
    if seed % 2:
        kind = str(random.choice(NULLS))
    else:
        sort = random.choice(["force", "dull", "two", "mixed"], p=[0.62, 0.16, 0.15, 0.07])
        kinds = {"force": FORCES, "dull": DULL}.get(sort, (sort,))
        kind = str(random.choice(kinds))
    noise = float(random.choice(NOISES, p=NOISE_WEIGHTS))
    complete, masked = bool(random.random() < 0.4), bool(random.random() < 0.25)
    return Plan(seed, system, kind, noise, complete, masked)


def size_of(coordinates: int) -> int:
    """The class of a system: 0 with one coordinate, 1 with two or three, 2 with more."""
    return 0 if coordinates == 1 else 1 if coordinates < 4 else 2


def in_turn(seed: int, shares: tuple[float, ...]) -> bool:
    """Whether a seed is among the ``shares`` of its class of systems that are run, spread evenly
    over the turns; it depends on the seed alone, so that nothing can be chosen afterwards."""
    system, turn = system_of(seed)
    share = shares[size_of(system.n)]
    return int((turn + 1) * share + 1e-9) > int(turn * share + 1e-9)


def folder_of(seed: int, build: Path) -> Path:
    """Where the case of a seed lies; the name does not tell the answer."""
    return build / f"{seed:05d}-{system_of(seed)[0].name}"


@dataclass(frozen=True, slots=True)
class Sort:
    """What is made of a plan: ``harder`` recordings, and whether incomplete draws are kept."""

    harder: bool = False
    keep_hard: bool = False

    @property
    def build(self) -> Path:
        """The folder of such cases."""
        return Path("build/concealed" + "-harder" * self.harder + "-kept" * self.keep_hard)


PLAIN = Sort()


def add_sort(parser: ArgumentParser) -> None:
    """The options that choose the sort of cases, and their folder."""
    parser.add_argument(
        "--harder", action="store_true", help="coloured noise, held inputs or an unmeasured force"
    )
    parser.add_argument(
        "--keep-hard", action="store_true", help="keep incomplete draws, which may be refused"
    )
    parser.add_argument(
        "-o", "--output", type=Path, help="default: build/concealed and the sort of the cases"
    )


def seeds_of(text: str) -> list[int]:
    """``0-9,20`` as numbers, both ends included."""
    found: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        found.extend(range(int(first), int(last or first) + 1))
    return found

"""What a force law is: one frozen value that holds all that the program knows of one kind.

A kind of element is one file of this package. The model format, the equations, the search for what
is missing and the sentences of a report look up here what they need to know of it.
"""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Literal

from symhyb.laws.maths import Action, Coupling, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import Candidate, Reach
from symhyb.laws.variants import Variants, no_variants

Energy = Literal["conservative", "dissipative", "active"]
Placement = Literal["on", "between", "at", "pair"]
Switch = Literal["", "holds", "touches"]
STRETCHED: tuple[Placement, ...] = ("on", "between")
ANYWHERE: tuple[Placement, ...] = ("on", "between", "at")
PAIRED: tuple[Placement, ...] = ("pair",)
SHAPE_REACH = 30.0  # a refined key stays within this factor of where it was tried

Fitted = Mapping[str, tuple[float, float]]
"""Values and deviations by key, SI; the deviation of a number that was not fitted is NaN."""


@dataclass(frozen=True, slots=True)
class Key:
    """One entry of a law: a coefficient or an expression with its unit, default and bounds.

    The unit is [force]^``force`` · [stretch]^``stretch`` · s^``time`` at the place. ``default`` is
    the expression of an unset key: a number, another key, or None where unset has its own meaning
    (said in ``about``). ``placements``: where the key may be written. ``signal`` marks the
    expression of a force, which may use the motion, where other keys are coefficients. ``choices``
    are the words of a key that takes one of them. A ``vector`` is a list of two at a point.
    ``exponent`` names the key whose value n multiplies the power of [stretch].

    Of a value, SI: ``lower`` and ``upper`` are what physics allows; a shape that is refined stays
    within the factor ``reach`` of where it was tried, and not below so many times another key as
    ``above`` says; ``divides`` means that it must not be 0, ``exact`` that no gain of a sensor can
    feign it (a time or a place), ``either_sign`` that a variant may take the other sign too,
    ``inertia`` that it is a mass, which is in kg. ``listed`` are values at which another law of
    the list says the same: a value that does not stand out of them is not named. A ``quoted`` one
    is said in words though it was set and not fitted.

    In words: ``symbol`` is its usual letter, ``noun`` what it is as the subject of a sentence,
    ``label`` the same in a list behind a law, ``spoken`` its unit in SI and as it is read out.
    """

    name: str
    force: int
    stretch: int
    time: int
    default: str | None = "0"
    about: str = ""
    placements: tuple[Placement, ...] = ANYWHERE
    signal: bool = False
    choices: tuple[str, ...] = ()
    vector: bool = False
    exponent: str = ""
    lower: float = -inf
    upper: float = inf
    reach: float = SHAPE_REACH
    above: tuple[str, float] | None = None
    divides: bool = False
    exact: bool = False
    either_sign: bool = False
    listed: tuple[float, ...] = ()
    quoted: bool = False
    inertia: bool = False
    symbol: str = ""
    noun: str = ""
    label: str = ""
    spoken: tuple[str, str] = ("", "")

    def plain(self, values: Mapping[str, float]) -> float | None:
        """The value at which a law with this key is the one without it, given the other ``values``:
        its default, None where the default is no number."""
        if self.default is None:
            return None
        try:
            return float(self.default)
        except ValueError:
            return values.get(self.default, 0.0)


LENGTH = Key(
    "length",
    0,
    1,
    0,
    "0",
    "stretch is counted from this distance",
    ("between",),
    symbol="l_0",
    label="slack length",
)


def _same(terms: Mapping[str, float]) -> dict[str, float]:
    return dict(terms)


@dataclass(frozen=True, slots=True)
class Terms:
    """How the unknowns in which a force is linear become keys, where the two are not the same.

    ``keys`` are the keys that stand in their place, by term; ``read`` turns values of the terms
    into values of the keys; ``probes`` are keys that make a term 1 and the others next to nothing,
    where ``read`` cannot; a law with one of the terms ``added`` is a variant of the plain law.
    """

    keys: Mapping[str, str] = field(default_factory=dict)
    read: Callable[[Mapping[str, float]], dict[str, float]] = _same
    probes: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    added: tuple[str, ...] = ()


def nothing_tried(_: Reach) -> Iterable[Candidate]:
    """The candidates of a law that the diagnosis does not look for."""
    return ()


def no_phrase(_: Numbers, __: Options) -> Phrase | None:
    """The phrase of a law that is named with all its numbers."""
    return None


def as_fitted(values: Fitted) -> dict[str, tuple[float, float]]:
    """Values and deviations as they were fitted."""
    return dict(values)


@dataclass(frozen=True, slots=True)
class State:
    """An inner state: its ``name``, its ``rate`` for people, and its unit at the place:
    that of the stretch (``time`` 0) or of its rate (−1)."""

    name: str
    rate: str
    time: Literal[0, -1] = 0

    @property
    def text(self) -> str:
        """The law of the state: ``z' = …``."""
        return f"{self.name}' = {self.rate}"


@dataclass(frozen=True, slots=True, eq=False)
class Law:
    """A force law, by sections: what a model file writes, mechanics, search, words, tests.

    ``law`` is F for people, ``words`` name the physics (``torque_words`` on an angle, where they
    differ), ``strengths`` are the keys of which at least one must be set (exactly one where they
    are signals), ``needs`` the keys that have no sensible default. ``states`` are the inner states
    of one with a memory.

    ``action`` computes F and what goes with it; None of a force that is filled in at lowering, and
    of a law of a pair, which has a ``coupling``: what two stretches do to each other.
    ``steep`` laws need finer steps near reversals, ``stiff`` ones an implicit method; ``dry`` is
    friction that can hold still, ``smoothed_over`` the key that says over which speed it turns
    over (where that is fitted, the law is bent). ``switch`` says as what an exact simulation treats
    its corner: a friction that *holds*, or a stop that *touches*. ``weighs``: gravity acts on its
    mass; ``turns``: its mass is an inertia, and turns with the body to which its point is fixed.

    ``candidates`` are the shapes that are tried at a place, ``variants`` what is tried where one of
    them was found. ``at_rest``: candidates also where nothing moves.
    ``of_state`` is False of what is no function of stretch and rate; ``steady`` laws do not change
    on the way (one that seems to stands in for something else). ``joins``: what was found of it at
    one place is one element. ``several`` may act at one place, as the branches of a ladder
    do. ``bent`` laws take on shapes between those of simpler ones, beside
    which they are tried only where these leave more than noise. ``subject`` names the law of which
    this is another form.

    ``phrase`` words a found effect; ``resists`` is the key whose sign says whether it resists the
    motion or drives it, ``pushes`` the one whose sign says which way it acts; ``critical`` a key
    that is worth comparing with critical damping; ``formula`` is the law with the keys that are
    set, ``widened`` what deviations must be widened by.

    ``example`` are values of the keys, SI, with which the law is tested.
    """

    name: str
    keys: tuple[Key, ...]
    energy: Energy
    words: str
    law: str
    strengths: tuple[str, ...]
    placements: tuple[Placement, ...] = STRETCHED
    needs: tuple[str, ...] = ()
    states: tuple[State, ...] = ()

    action: Callable[[Maths, Motion, Values, Options], Action] | None = None
    coupling: Callable[[Motion, Motion, Values], Coupling] | None = None
    steep: bool = False
    stiff: bool = False
    dry: bool = False
    smoothed_over: str = ""
    switch: Switch = ""
    weighs: bool = False
    turns: bool = False

    candidates: Callable[[Reach], Iterable[Candidate]] = nothing_tried
    variants: Variants = no_variants
    terms: Terms = field(default_factory=Terms)
    at_rest: bool = False
    of_state: bool = True
    steady: bool = False
    joins: bool = False
    several: bool = False
    bent: bool = False
    subject: str = ""

    phrase: Callable[[Numbers, Options], Phrase | None] = no_phrase
    resists: str = ""
    pushes: str = ""
    critical: str = ""
    torque_words: str = ""
    formula: Callable[[Collection[str], Options], str] | None = None
    widened: Callable[[Fitted], dict[str, tuple[float, float]]] = as_fitted

    example: Mapping[str, float] = field(default_factory=dict)

    @property
    def passive(self) -> bool:
        """Whether the force resists (Q = −(∂s/∂q)ᵀF) instead of pushing."""
        return self.energy != "active"

    @property
    def inertial(self) -> bool:
        """Whether the force belongs to a mass that moves with the place: it depends on the
        acceleration."""
        return any(key.inertia for key in self.keys) and not self.states

    def key(self, name: str) -> Key | None:
        """The key of that name, None if the law has no such key."""
        return next((key for key in self.keys if key.name == name), None)

    def text(self, keys: Collection[str], options: Options) -> str:
        """The law with the ``keys`` that are set and no others, and the rates of its states."""
        if self.formula is not None:
            return self.formula(keys, options)
        return ", ".join([self.law, *(state.text for state in self.states)])
